/// @file
/// What a thread inside a call works with: query buffers, converted triangles, the shapes it met last, its counters.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/union_contact/covered_contact.hpp"
#include "pd/union_contact/union_exit.hpp"
#include "pieces/near_pieces.hpp"
#include "shapes/pair_answer.hpp"
#include "shapes/triangle_cache.hpp"
#include "shapes/triangles_around.hpp"

namespace pd::detail {

/// Written by the thread that holds the buffers, read by anyone: no thread waits for another to count.
class Counter {
 public:
  void add(std::int64_t n = 1) { value_.store(value_.load(std::memory_order_relaxed) + n, std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t read() const { return value_.load(std::memory_order_relaxed); }
  void reset() { value_.store(0, std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> value_{0};
};

struct SolverCounters {
  Counter calls, overlapping, touching, separated, warm, unsupported, fallback, refused_poses, support_calls,
      nanoseconds, exact_signs, wider, covered, skipped_triangles, deep_unions, deep_unions_nearly, deep_unions_left;
};

/// Base of the buffers that a room above needs in a call. The room makes them when it first needs them.
struct WorkingMemory {
  WorkingMemory() = default;
  virtual ~WorkingMemory() = default;
  WorkingMemory(const WorkingMemory&) = delete;
  WorkingMemory& operator=(const WorkingMemory&) = delete;
};

struct ThreadBuffers {
  std::size_t place = 0;  ///< in the pool
  Scratch scratch;
  ManifoldScratch manifold;
  PairAnswer answer;  ///< of `ContactAlgorithm`
  CoverBuffers cover;
  NearPieces near;  ///< of the pair at hand
  UnionExit union_exit;
  TriangleCache triangles;
  TrianglesAround around;  ///< the body of the pair at hand
  SolverCounters counters;
  unsigned queries = 0;  ///< for sampling the clock
  /// The shapes of the last pair without a memory of its own: a hull on a mesh meets one triangle after another.
  std::array<std::shared_ptr<CachedShape>, 2> recent;
  std::unique_ptr<WorkingMemory> unions;  ///< of `UnionAlgorithm`
};

/// Counts contacts that were dropped or changed for what lies around them; most often there are none.
inline void count_covered(int contacts, ThreadBuffers& buffers) {
  if (contacts > 0) buffers.counters.covered.add(contacts);
}

/// A pool of buffers: as many as there were threads inside a call at once. Taking is one exchange of a pointer, and
/// giving back is a store, as long as no more than kSlots threads are inside calls.
class ThreadBufferPool {
 public:
  /// Gives the buffers back at the end of its scope.
  class Lease {
   public:
    Lease(ThreadBufferPool& pool, ThreadBuffers* buffers) : pool_(pool), buffers_(buffers) {}
    ~Lease() { pool_.give_back(buffers_); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ThreadBuffers* operator->() { return buffers_; }
    ThreadBuffers& operator*() { return *buffers_; }

   private:
    ThreadBufferPool& pool_;
    ThreadBuffers* buffers_;
  };

  Lease lease() {
    for (std::atomic<ThreadBuffers*>& slot : idle_) {
      if (slot.load(std::memory_order_relaxed) != nullptr) {
        if (ThreadBuffers* buffers = slot.exchange(nullptr, std::memory_order_acquire)) {
          return {*this, buffers};
        }
      }
    }
    const std::lock_guard lock(mutex_);
    if (!overflow_.empty()) {
      ThreadBuffers* buffers = overflow_.back();
      overflow_.pop_back();
      return {*this, buffers};
    }
    all_.push_back(std::make_unique<ThreadBuffers>());
    all_.back()->place = all_.size() - 1;
    return {*this, all_.back().get()};
  }

  /// Every buffer there is, those in use included: for counters.
  template <class Visit>
  void for_each(Visit&& visit) {
    const std::lock_guard lock(mutex_);
    for (const auto& buffers : all_) {
      visit(*buffers);
    }
  }

  /// Frees all of them. Requires: no thread is inside a call.
  void clear() {
    const std::lock_guard lock(mutex_);
    for (auto& slot : idle_) {
      slot.store(nullptr, std::memory_order_relaxed);
    }
    overflow_.clear();
    all_.clear();
  }

 private:
  static constexpr std::size_t kSlots = 16;

  void give_back(ThreadBuffers* buffers) {
    // Each slot has one owner, so that nobody else writes to it while its buffers are lent.
    if (buffers->place < kSlots) {
      idle_[buffers->place].store(buffers, std::memory_order_release);
      return;
    }
    const std::lock_guard lock(mutex_);
    overflow_.push_back(buffers);
  }

  std::array<std::atomic<ThreadBuffers*>, kSlots> idle_{};
  std::mutex mutex_;
  std::vector<ThreadBuffers*> overflow_;
  std::vector<std::unique_ptr<ThreadBuffers>> all_;
};

}  // namespace pd::detail
