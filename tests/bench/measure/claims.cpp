#include "bench/measure/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace pd::bench {

namespace {

std::string figure_text(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == std::round(value) && std::abs(value) < 1e9) return fmt::format("{:.0f}", value);
  return fmt::format("{:.4g}", value);
}

std::string exponent_text(const PowerLaw& fit) {
  if (!std::isfinite(fit.exponent)) return "-";
  if (!std::isfinite(fit.low)) return fmt::format("{:.2f}", fit.exponent);
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", fit.exponent, fit.low, fit.high);
}

std::string range_of(const Growth& growth) {
  if (growth.x.empty()) return growth.variable + ": none";
  return fmt::format("{} = {:g}..{:g}", growth.variable, growth.x.front(), growth.x.back());
}

/// Commas separate columns, so that none may stand in a field.
std::string field(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  return text;
}

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

Finding finding_of(const Claim& claim, Growth growth) {
  Finding finding{claim, growth.family, growth.counter, range_of(growth), growth.y.empty() ? 0 : growth.y.back()};
  finding.fit = fit_power_law(growth.x, growth.y);
  finding.growth = std::move(growth);
  return finding;
}

}  // namespace

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] > 0 && y[i] > 0 && std::isfinite(x[i]) && std::isfinite(y[i])) {
      points.emplace_back(std::log(x[i]), std::log(y[i]));
    }
  }
  PowerLaw law;
  law.points = static_cast<int>(points.size());
  const auto count = static_cast<double>(points.size());
  double mean_x = 0, mean_y = 0;
  for (const auto& [lx, ly] : points) {
    mean_x += lx / count;
    mean_y += ly / count;
  }
  double xx = 0, xy = 0;
  for (const auto& [lx, ly] : points) {
    xx += (lx - mean_x) * (lx - mean_x);
    xy += (lx - mean_x) * (ly - mean_y);
  }
  if (points.size() < 2 || !(xx > 0)) return law;
  law.exponent = xy / xx;
  const auto& [last_x, last_y] = points.back();
  const auto& [before_x, before_y] = points[points.size() - 2];
  if (last_x > before_x) law.last = (last_y - before_y) / (last_x - before_x);
  if (points.size() < 3) return law;
  double residual = 0;
  for (const auto& [lx, ly] : points) {
    const double r = ly - mean_y - law.exponent * (lx - mean_x);
    residual += r * r;
  }
  const boost::math::students_t_distribution<double> student(count - 2);
  const double half = boost::math::quantile(student, 0.975) * std::sqrt(residual / (count - 2) / xx);
  law.low = law.exponent - half;
  law.high = law.exponent + half;
  return law;
}

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::undecided:
      return "undecided";
    case Verdict::fails:
      return "FAILS";
    case Verdict::reported:
      break;
  }
  return "reported";
}

void ClaimTable::add_growth(const Claim& claim, Growth growth, std::optional<double> most) {
  Finding finding = finding_of(claim, std::move(growth));
  if (most) {
    finding.bound = fmt::format("exponent <= {:g}", *most);
    const double low = std::isfinite(finding.fit.low) ? finding.fit.low : finding.fit.exponent;
    const double high = std::isfinite(finding.fit.high) ? finding.fit.high : finding.fit.exponent;
    finding.verdict = high <= *most ? Verdict::holds : low > *most ? Verdict::fails : Verdict::undecided;
  }
  print(finding);
  findings_.push_back(std::move(finding));
}

void ClaimTable::add_order(const Claim& claim, Growth growth, double expected, double slack) {
  Finding finding = finding_of(claim, std::move(growth));
  finding.bound = fmt::format("exponent {:g} +- {:g}", expected, slack);
  finding.verdict = std::abs(finding.fit.exponent - expected) <= slack ? Verdict::holds : Verdict::fails;
  print(finding);
  findings_.push_back(std::move(finding));
}

void ClaimTable::add_value(const Claim& claim, std::string family, std::string counter, std::string range,
                           double figure, std::optional<double> most) {
  Finding finding{claim, std::move(family), std::move(counter), std::move(range), figure};
  if (most) {
    finding.bound = fmt::format("<= {:g}", *most);
    finding.verdict = figure <= *most ? Verdict::holds : Verdict::fails;
  }
  print(finding);
  findings_.push_back(std::move(finding));
}

std::vector<Finding> ClaimTable::by_claim() const {
  std::vector<std::string> names;
  for (const Finding& f : findings_) {
    if (std::find(names.begin(), names.end(), f.claim.name) == names.end()) names.push_back(f.claim.name);
  }
  std::vector<Finding> sorted;
  for (const std::string& name : names) {
    std::copy_if(findings_.begin(), findings_.end(), std::back_inserter(sorted),
                 [&](const Finding& f) { return f.claim.name == name; });
  }
  return sorted;
}

int ClaimTable::failures() const {
  return static_cast<int>(
      std::count_if(findings_.begin(), findings_.end(), [](const Finding& f) { return f.verdict == Verdict::fails; }));
}

void ClaimTable::print(const Finding& f) const {
  if (findings_.empty() || findings_.back().claim.name != f.claim.name) {
    fmt::print("\n{}: {}\n", f.claim.name, f.claim.statement);
    fmt::print("  {:<24} {:<34} {:<20} {:>11} {:>19} {:>7}  {:<22} {}\n", "family", "counter", "range", "figure",
               "exponent", "last", "bound", "verdict");
  }
  fmt::print("  {:<24} {:<34} {:<20} {:>11} {:>19} {:>7}  {:<22} {}\n", f.family, f.counter, f.range,
             figure_text(f.figure), exponent_text(f.fit),
             std::isfinite(f.fit.last) ? fmt::format("{:.2f}", f.fit.last) : "-", f.bound, to_string(f.verdict));
  std::fflush(stdout);
}

std::string to_csv(const std::vector<Finding>& findings) {
  const auto number = [](double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : std::string(); };
  std::string text = "claim,family,counter,range,figure,exponent,low,high,last_doubling,bound,verdict\n";
  for (const Finding& f : findings) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", field(f.claim.name), field(f.family), field(f.counter),
                        field(f.range), number(f.figure), number(f.fit.exponent), number(f.fit.low), number(f.fit.high),
                        number(f.fit.last), field(f.bound), to_string(f.verdict));
  }
  return text;
}

std::string points_csv(const std::vector<Finding>& findings) {
  std::string text = "claim,family,counter,variable,x,y\n";
  for (const Finding& f : findings) {
    for (std::size_t i = 0; i < f.growth.x.size(); ++i) {
      text += fmt::format("{},{},{},{},{},{}\n", field(f.claim.name), field(f.family), field(f.counter),
                          field(f.growth.variable), f.growth.x[i], f.growth.y[i]);
    }
  }
  return text;
}

std::string to_markdown(const std::vector<Finding>& findings, const std::string& preamble) {
  std::string text = preamble;
  const Finding* last = nullptr;
  for (const Finding& f : findings) {
    if (last == nullptr || last->claim.name != f.claim.name) {
      text += fmt::format("\n## {}\n\n{}\n\n", f.claim.name, f.claim.statement);
      text += "| family | counter | range | figure | exponent, 95 % | last doubling | bound | verdict |\n";
      text += "|---|---|---|---:|---:|---:|---|---|\n";
    }
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", cell(f.family), cell(f.counter), cell(f.range),
                        figure_text(f.figure), exponent_text(f.fit),
                        std::isfinite(f.fit.last) ? fmt::format("{:.2f}", f.fit.last) : "-", cell(f.bound),
                        to_string(f.verdict));
    last = &f;
  }
  return text;
}

}  // namespace pd::bench
