/// @file
/// Reads numbers of mesh formats that are stored as bytes, one after the other, in either byte order.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

#include "support/refusal.hpp"

namespace pd::query {

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Returns how many bytes a number takes.
inline int size_of(NumberType type) {
  switch (type) {
    case NumberType::int8:
    case NumberType::uint8:
      return 1;
    case NumberType::int16:
    case NumberType::uint16:
      return 2;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4;
    case NumberType::float64:
      return 8;
  }
  return 0;
}

class BinaryNumbers {
 public:
  BinaryNumbers(std::string_view bytes, bool big_endian) : rest_(bytes), big_endian_(big_endian) {}
  double next(NumberType type) {
    const auto size = static_cast<std::size_t>(size_of(type));
    if (rest_.size() < size) refuse("unreadable_file", "the file ends too early", "");
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = big_endian_ ? i : size - 1 - i;
      word = word << 8 | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(size);
    switch (type) {
      case NumberType::int8:
        return static_cast<std::int8_t>(word);
      case NumberType::uint8:
        return static_cast<std::uint8_t>(word);
      case NumberType::int16:
        return static_cast<std::int16_t>(word);
      case NumberType::uint16:
        return static_cast<std::uint16_t>(word);
      case NumberType::int32:
        return static_cast<std::int32_t>(word);
      case NumberType::uint32:
        return static_cast<std::uint32_t>(word);
      case NumberType::float32:
        return double{std::bit_cast<float>(static_cast<std::uint32_t>(word))};
      case NumberType::float64:
        return std::bit_cast<double>(word);
    }
    return 0;
  }

 private:
  std::string_view rest_;
  bool big_endian_;
};

}  // namespace pd::query
