#include "text/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace pd::render::detail {
namespace {

std::string formatted(const char* format, double value, int digits = 0) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, digits, value);
  return text.data();
}

/// "10⁻³" for decades outside 0.01 .. 10000, plain figures inside.
std::string decade_text(int power) {
  if (power >= -2 && power <= 4) {
    return formatted("%.*f", std::pow(10.0, power), std::max(0, -power));
  }
  constexpr std::array<const char*, 10> kRaised = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                                   "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = "10";
  if (power < 0) {
    text += "\u207b";
  }
  for (const char digit : std::to_string(std::abs(power))) {
    text += kRaised[static_cast<std::size_t>(digit - '0')];
  }
  return text;
}

Axis linear_axis(double lower, double upper, bool from_zero, int wanted) {
  if (from_zero) {
    lower = std::min(lower, 0.0);
    upper = std::max(upper, 0.0);
  }
  if (!(upper > lower)) {
    const double slack = lower != 0 ? 0.5 * std::abs(lower) : 1;
    lower -= from_zero ? 0 : slack;
    upper += slack;
  }
  const double rough = (upper - lower) / wanted;
  const int power = static_cast<int>(std::floor(std::log10(rough)));
  const double share = rough / std::pow(10.0, power);
  const int mantissa = share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10;
  const double step = mantissa * std::pow(10.0, power);
  // Whole multiples: the slack of a millionth keeps a range that ends on a tick from gaining another.
  const auto first = static_cast<long long>(std::floor(lower / step + 1e-6));
  const auto last = static_cast<long long>(std::ceil(upper / step - 1e-6));
  Axis axis{Scale::linear, static_cast<double>(first) * step, static_cast<double>(last) * step, {}};
  const int digits = std::max(0, -(power + (mantissa == 10 ? 1 : 0)));
  const bool plain = digits <= 6 && power <= 6;
  for (long long i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    axis.ticks.push_back({value, plain ? formatted("%.*f", value, digits) : formatted("%.*g", value, 4)});
  }
  return axis;
}

Axis logarithmic_axis(double lower, double upper) {
  int first = static_cast<int>(std::floor(std::log10(lower) + 1e-9));
  int last = static_cast<int>(std::ceil(std::log10(upper) - 1e-9));
  if (last <= first) {
    last = first + 1;
  }
  Axis axis{Scale::logarithmic, std::pow(10.0, first), std::pow(10.0, last), {}};
  const int every = std::max(1, (last - first + 7) / 8);
  for (int power = first; power <= last; ++power) {
    axis.ticks.push_back({std::pow(10.0, power), (power - first) % every == 0 ? decade_text(power) : ""});
    for (int k = 2; k < 10 && power < last && every == 1; ++k) {
      axis.ticks.push_back({k * std::pow(10.0, power), ""});
    }
  }
  return axis;
}

}  // namespace

double Axis::place(double value) const {
  return scale == Scale::linear ? (value - lower) / (upper - lower)
                                : (std::log10(value) - std::log10(lower)) / (std::log10(upper) - std::log10(lower));
}

Axis make_axis(Scale scale, double lower, double upper, bool from_zero, int wanted) {
  return scale == Scale::linear ? linear_axis(lower, upper, from_zero, wanted) : logarithmic_axis(lower, upper);
}

}  // namespace pd::render::detail
