#include "pd/render/image.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace pd::render {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

/// Area weights of the source cells below one target cell, along one axis.
struct Span {
  int first;
  std::vector<float> weights;
};

std::vector<Span> area_spans(int source, int target) {
  std::vector<Span> spans;
  spans.reserve(static_cast<std::size_t>(target));
  const double ratio = static_cast<double>(source) / target;
  for (int i = 0; i < target; ++i) {
    const double begin = i * ratio;
    const double end = std::min<double>((i + 1) * ratio, source);
    Span span{std::min(static_cast<int>(begin), source - 1), {}};
    for (int cell = span.first; cell < source && cell < end; ++cell) {
      span.weights.push_back(
          static_cast<float>((std::min<double>(cell + 1, end) - std::max<double>(cell, begin)) / (end - begin)));
    }
    spans.push_back(std::move(span));
  }
  return spans;
}

}  // namespace

Image::Image(Size size, Colour fill) : size_(size) {
  assert(size.width >= 1 && size.height >= 1);
  bytes_.resize(4 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  const std::uint8_t pixel[4] = {to_byte(fill.r), to_byte(fill.g), to_byte(fill.b), 255};
  for (std::size_t i = 0; i < bytes_.size(); i += 4) {
    std::memcpy(bytes_.data() + i, pixel, 4);
  }
}

void Image::paste(const Image& source, int x, int y) {
  const int left = std::max(0, x);
  const int right = std::min(width(), x + source.width());
  for (int row = std::max(0, y); row < std::min(height(), y + source.height()) && left < right; ++row) {
    std::memcpy(pixel(left, row), source.pixel(left - x, row - y), 4 * static_cast<std::size_t>(right - left));
  }
}

Image resized(const Image& source, Size size) {
  Image result(size);
  const std::vector<Span> columns = area_spans(source.width(), size.width);
  const std::vector<Span> rows = area_spans(source.height(), size.height);
  std::vector<float> line(4 * static_cast<std::size_t>(source.width()));
  for (int y = 0; y < size.height; ++y) {
    const Span& row = rows[static_cast<std::size_t>(y)];
    std::fill(line.begin(), line.end(), 0.0f);
    for (std::size_t k = 0; k < row.weights.size(); ++k) {
      const std::uint8_t* in = source.pixel(0, row.first + static_cast<int>(k));
      for (std::size_t i = 0; i < line.size(); ++i) {
        line[i] += row.weights[k] * in[i];
      }
    }
    for (int x = 0; x < size.width; ++x) {
      const Span& column = columns[static_cast<std::size_t>(x)];
      for (std::size_t channel = 0; channel < 4; ++channel) {
        float sum = 0;
        for (std::size_t k = 0; k < column.weights.size(); ++k) {
          sum += column.weights[k] * line[4 * (static_cast<std::size_t>(column.first) + k) + channel];
        }
        result.pixel(x, y)[channel] = to_byte(sum / 255);
      }
    }
  }
  return result;
}

ImageDifference difference(const Image& a, const Image& b) {
  assert(a.size() == b.size());
  ImageDifference result;
  double sum = 0;
  for (std::size_t i = 0; i < a.bytes().size(); ++i) {
    if (i % 4 != 3) {
      const int gap = std::abs(int{a.bytes()[i]} - int{b.bytes()[i]});
      sum += gap;
      result.largest = std::max(result.largest, gap);
    }
  }
  result.mean = a.bytes().empty() ? 0 : sum / (0.75 * static_cast<double>(a.bytes().size()));
  return result;
}

}  // namespace pd::render
