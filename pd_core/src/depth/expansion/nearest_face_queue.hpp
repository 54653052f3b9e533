/// @file
/// The nearest face of a large surface: a heap of keys in which faces that are gone stay until they come up.
///
/// Small surfaces scan their keys instead (plane_kernels.hpp, `least_key`), which costs less up to some 450 faces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pd::detail {

class NearestFaceQueue {
 public:
  /// Whether it is in use.
  [[nodiscard]] bool active() const { return active_; }
  void clear() {
    heap_.clear();
    active_ = false;
  }
  /// Room for so many slots.
  void reserve(std::size_t slots) { stamps_.resize(slots, 0); }

  /// Begins with the faces whose keys are finite.
  void start(const double* keys, int slots, double removed) {
    active_ = true;
    heap_.clear();
    for (int f = 0; f < slots; ++f) {
      if (keys[f] != removed) heap_.push_back({keys[f], f, stamps_[static_cast<std::size_t>(f)]});
    }
    std::make_heap(heap_.begin(), heap_.end(), later);
  }
  void push(int f, double key) {
    heap_.push_back({key, f, stamps_[static_cast<std::size_t>(f)]});
    std::push_heap(heap_.begin(), heap_.end(), later);
  }
  /// The face in this slot is gone; its slot may be taken by another one.
  void remove(int f) { ++stamps_[static_cast<std::size_t>(f)]; }
  /// The face with the least key, of several the one in the lowest slot. Requires one that is not removed.
  int nearest() {
    while (heap_.front().stamp != stamps_[static_cast<std::size_t>(heap_.front().face)]) {
      std::pop_heap(heap_.begin(), heap_.end(), later);
      heap_.pop_back();
    }
    return heap_.front().face;
  }

 private:
  struct Entry {
    double key;
    std::int32_t face;
    std::uint32_t stamp;
  };
  static bool later(const Entry& x, const Entry& y) { return x.key > y.key || (x.key == y.key && x.face > y.face); }

  std::vector<Entry> heap_;
  std::vector<std::uint32_t> stamps_;  ///< counts the faces that a slot has held
  bool active_ = false;
};

}  // namespace pd::detail
