/// @file
/// The hash of everything that is found by content: shapes, triangles, corners.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace pd::detail {

/// A running number that changes with the bits of what is added.
class MixedBits {
 public:
  explicit MixedBits(std::uint64_t begin = 0xCBF29CE484222325ULL) : value_(begin) {}
  MixedBits& add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x9E3779B97F4A7C15ULL;
    value_ ^= value_ >> 32U;
    return *this;
  }
  MixedBits& add(double x) { return add(std::bit_cast<std::uint64_t>(x)); }
  MixedBits& add(float x) { return add(std::uint64_t{std::bit_cast<std::uint32_t>(x)}); }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// For tables by arrays of numbers.
struct HashOfArray {
  template <class Number, std::size_t kSize>
  std::size_t operator()(const std::array<Number, kSize>& numbers) const {
    MixedBits bits;
    for (const Number x : numbers) bits.add(x);
    return static_cast<std::size_t>(bits.value());
  }
};

}  // namespace pd::detail
