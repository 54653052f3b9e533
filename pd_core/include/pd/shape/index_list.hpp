/// @file
/// Lists of indices that take 1, 2 or 4 bytes each. A polytope of up to 44 vertices in general position has fewer than
/// 256 half-edges, so that its whole surface is stored in single bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>

namespace pd {

/// How many bytes an index takes. Every index is read as four bytes and masked, without a branch. So three readable
/// bytes must follow a list. A machine that stores the highest byte first always takes four bytes.
class IndexWidth {
 public:
  static constexpr std::size_t kReadableBehind = 3;

  constexpr IndexWidth() = default;
  /// The least width for indices from 0 to `most`. Four bytes also hold negative ones.
  static constexpr IndexWidth up_to(std::int64_t most) {
    if (std::endian::native != std::endian::little || most > 0xFFFF) return {};
    return most > 0xFF ? IndexWidth{0xFFFF, 1} : IndexWidth{0xFF, 0};
  }

  [[nodiscard, gnu::always_inline]] std::int32_t read(const std::byte* list, std::size_t i) const {
    std::uint32_t word = 0;
    std::memcpy(&word, list + (i << shift_), sizeof(word));
    return static_cast<std::int32_t>(word & mask_);
  }
  void write(std::byte* list, std::size_t i, std::int32_t index) const {
    std::memcpy(list + (i << shift_), &index, bytes());
  }
  [[nodiscard]] std::size_t bytes() const { return std::size_t{1} << shift_; }

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
    Iterator(const std::byte* list, std::size_t i, IndexWidth width) : list_(list), i_(i), width_(width) {}
    std::int32_t operator*() const { return width_.read(list_, i_); }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++i_;
      return before;
    }
    bool operator==(const Iterator& other) const { return i_ == other.i_; }

   private:
    const std::byte* list_ = nullptr;
    std::size_t i_ = 0;
    IndexWidth width_;
  };

  /// The indices `begin` <= i < `end` of a longer list.
  IndexList(const std::byte* list, std::int32_t begin, std::int32_t end, IndexWidth width)
      : list_(list), begin_(static_cast<std::size_t>(begin)), end_(static_cast<std::size_t>(end)), width_(width) {}

  [[nodiscard]] std::size_t size() const { return end_ - begin_; }
  [[nodiscard]] bool empty() const { return begin_ == end_; }
  [[nodiscard]] std::int32_t operator[](std::size_t i) const { return width_.read(list_, begin_ + i); }
  [[nodiscard]] std::int32_t front() const { return width_.read(list_, begin_); }
  [[nodiscard]] std::int32_t back() const { return width_.read(list_, end_ - 1); }
  [[nodiscard]] Iterator begin() const { return {list_, begin_, width_}; }
  [[nodiscard]] Iterator end() const { return {list_, end_, width_}; }

 private:
  const std::byte* list_;
  std::size_t begin_;
  std::size_t end_;
  IndexWidth width_;
};

}  // namespace pd
