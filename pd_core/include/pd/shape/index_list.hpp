/// @file
/// Lists of indices that take 1, 2 or 4 bytes each. A polytope of up to 44 vertices in general position has fewer than
/// 256 half-edges, so that its whole surface is stored in single bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "pd/numeric/language.hpp"

namespace pd {

/// How many bytes an index takes. Every index is read as four bytes, of which the others are dropped without a branch.
/// So three readable bytes must follow a list.
class IndexWidth {
 public:
  static constexpr std::size_t kReadableBehind = 3;

  constexpr IndexWidth() = default;
  /// The least width for indices from 0 to `most`. Four bytes also hold negative ones.
  static constexpr IndexWidth up_to(std::int64_t most) {
    if (most > 0xFFFF) return {};
    return most > 0xFF ? IndexWidth{0xFFFF, 1} : IndexWidth{0xFF, 0};
  }

  [[nodiscard, gnu::always_inline]] std::int32_t read(const std::byte* list, std::size_t i) const {
    std::uint32_t word = 0;
    std::memcpy(&word, list + offset(i), sizeof(word));
    if constexpr (std::endian::native == std::endian::little) return static_cast<std::int32_t>(word & mask_);
    return static_cast<std::int32_t>(word >> (32 - 8 * bytes()));
  }
  void write(std::byte* list, std::size_t i, std::int32_t index) const {
    std::byte* const at = list + offset(i);
    if (shift_ == 0) {
      *at = static_cast<std::byte>(index);
    } else if (shift_ == 1) {
      const auto two_bytes = static_cast<std::uint16_t>(index);
      std::memcpy(at, &two_bytes, sizeof(two_bytes));
    } else {
      std::memcpy(at, &index, sizeof(index));
    }
  }
  [[nodiscard]] std::size_t bytes() const { return std::size_t{1} << shift_; }
  [[nodiscard, gnu::always_inline]] std::size_t offset(std::size_t i) const { return i << shift_; }

 private:
  constexpr IndexWidth(std::uint32_t mask, std::uint32_t shift) : mask_(mask), shift_(shift) {}

  std::uint32_t mask_ = 0xFFFFFFFF;
  std::uint32_t shift_ = 2;
};

/// Indices in a row. Refers to the body that stores them.
class IndexList {
 public:
  class Iterator {
   public:
    using value_type = std::int32_t;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = std::int32_t;
    using iterator_category = std::input_iterator_tag;

    Iterator() = default;
    Iterator(const std::byte* at, IndexWidth width) : at_(at), width_(width) {}
    std::int32_t operator*() const { return width_.read(at_, 0); }
    Iterator& operator++() {
      at_ += width_.bytes();
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const std::byte* at_ = nullptr;
    IndexWidth width_;
  };

  /// The indices `begin` <= i < `end` of a longer list.
  IndexList(const std::byte* list, std::int32_t begin, std::int32_t end, IndexWidth width)
      : first_(list + width.offset(static_cast<std::size_t>(begin))),
        size_(static_cast<std::size_t>(end - begin)),
        width_(width) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::int32_t operator[](std::size_t i) const { return width_.read(first_, i); }
  [[nodiscard]] std::int32_t front() const { return width_.read(first_, 0); }
  [[nodiscard]] std::int32_t back() const { return width_.read(first_, size_ - 1); }
  [[nodiscard]] Iterator begin() const { return {first_, width_}; }
  [[nodiscard]] Iterator end() const { return {first_ + width_.offset(size_), width_}; }

 private:
  const std::byte* first_;
  std::size_t size_;
  IndexWidth width_;
};

}  // namespace pd
