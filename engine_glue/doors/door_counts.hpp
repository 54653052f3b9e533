/// @file
/// Counts of a door: each thread writes its own, and anyone reads their sum. The first refusal of each kind is named.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

namespace pd::detail {

/// @tparam Report  the door's public counts: answered, contact_points, conversions, left and first
template <class Report>
class DoorCounts {
 public:
  static constexpr std::size_t kKinds = std::tuple_size_v<decltype(Report::left)>;

  static DoorCounts& instance() {
    static DoorCounts counts;
    return counts;
  }
  DoorCounts() = default;
  DoorCounts(const DoorCounts&) = delete;
  DoorCounts& operator=(const DoorCounts&) = delete;

  /// The counts of one thread. Only that thread writes them; anyone reads them.
  class Thread {
   public:
    explicit Thread(DoorCounts& all) : all_(all) {
      const std::scoped_lock lock(all_.mutex_);
      next_ = std::exchange(all_.threads_, this);
    }
    ~Thread() {
      const std::scoped_lock lock(all_.mutex_);
      add_to(all_.ended_, all_.generation_);
      for (Thread** place = &all_.threads_; *place != nullptr; place = &(*place)->next_) {
        if (*place == this) {
          *place = next_;
          break;
        }
      }
    }
    Thread(const Thread&) = delete;
    Thread& operator=(const Thread&) = delete;

    void answered(std::int64_t points) {
      add(answered_, 1);
      add(points_, points);
    }
    void converted(std::int64_t shapes) { add(conversions_, shapes); }
    void left(std::size_t kind) { add(left_[kind], 1); }

   private:
    friend class DoorCounts;

    static void add(std::atomic<std::int64_t>& counter, std::int64_t n) {
      counter.store(counter.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
    }
    void begin(std::int64_t now) {
      if (generation_.load(std::memory_order_relaxed) == now) return;
      for (auto* counter : {&answered_, &points_, &conversions_}) counter->store(0, std::memory_order_relaxed);
      for (auto& counter : left_) counter.store(0, std::memory_order_relaxed);
      generation_.store(now, std::memory_order_release);
    }
    void add_to(Report& report, std::int64_t now) const {
      if (generation_.load(std::memory_order_acquire) != now) return;
      report.answered += answered_.load(std::memory_order_relaxed);
      report.contact_points += points_.load(std::memory_order_relaxed);
      report.conversions += conversions_.load(std::memory_order_relaxed);
      for (std::size_t i = 0; i < kKinds; ++i) report.left[i] += left_[i].load(std::memory_order_relaxed);
    }

    DoorCounts& all_;
    std::atomic<std::int64_t> generation_{-1}, answered_{0}, points_{0}, conversions_{0};
    std::array<std::atomic<std::int64_t>, kKinds> left_{};
    Thread* next_ = nullptr;
  };

  /// The counts of the calling thread.
  Thread& here() {
    thread_local Thread thread(instance());
    thread.begin(generation_.load(std::memory_order_relaxed));
    return thread;
  }

  /// Starts the report afresh.
  void restart() {
    const std::scoped_lock lock(mutex_);
    generation_.fetch_add(1);
    ended_ = {};
    named_ = {};
  }

  /// The sum of all threads. Time O(threads).
  [[nodiscard]] Report report() {
    const std::scoped_lock lock(mutex_);
    Report sum = ended_;
    for (const Thread* thread = threads_; thread != nullptr; thread = thread->next_) thread->add_to(sum, generation_);
    return sum;
  }

  /// Keeps the text of the first refusal of a kind. @return true for the first
  bool first_of(std::size_t kind, const std::string& text) {
    const std::scoped_lock lock(mutex_);
    if (std::exchange(named_[kind], true)) return false;
    ended_.first[kind] = text;
    return true;
  }

 private:
  std::atomic<std::int64_t> generation_{0};  ///< of the report; counts of an earlier generation are void
  std::mutex mutex_;                         ///< guards what follows
  Thread* threads_ = nullptr;
  Report ended_;  ///< of threads that have ended, and the texts
  std::array<bool, kKinds> named_{};
};

}  // namespace pd::detail
