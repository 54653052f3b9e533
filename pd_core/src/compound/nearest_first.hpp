/// @file
/// The queue of the searches in a union: the item with the least key comes first, of equal keys the one that came
/// first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace pd::detail {

template <class Item>
class NearestFirst {
 public:
  void push(double key, Item item) {
    waiting_.push_back({key, order_++, std::move(item)});
    std::push_heap(waiting_.begin(), waiting_.end(), later);
  }
  /// Requires an item, as `least_key` does.
  Item pop() {
    std::pop_heap(waiting_.begin(), waiting_.end(), later);
    Item item = std::move(waiting_.back().item);
    waiting_.pop_back();
    return item;
  }
  [[nodiscard]] double least_key() const { return waiting_.front().key; }
  [[nodiscard]] bool empty() const { return waiting_.empty(); }
  void clear() { waiting_.clear(); }

 private:
  struct Waiting {
    double key;
    std::int64_t order;
    Item item;
  };
  static bool later(const Waiting& x, const Waiting& y) { return x.key != y.key ? x.key > y.key : x.order > y.order; }

  std::vector<Waiting> waiting_;  ///< a heap
  std::int64_t order_ = 0;
};

}  // namespace pd::detail
