/// @file
/// A pool of query buffers: as many as there were threads inside a call at once.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::detail {

struct ThreadBuffers {
  Scratch scratch;
  ManifoldScratch manifold;
};

class ThreadBufferPool {
 public:
  /// Gives the buffers back at the end of its scope.
  class Lease {
   public:
    Lease(ThreadBufferPool& pool, std::unique_ptr<ThreadBuffers> buffers) : pool_(pool), buffers_(std::move(buffers)) {}
    ~Lease() { pool_.give_back(std::move(buffers_)); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ThreadBuffers* operator->() { return buffers_.get(); }

   private:
    ThreadBufferPool& pool_;
    std::unique_ptr<ThreadBuffers> buffers_;
  };

  Lease lease() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto buffers = std::move(idle_.back());
        idle_.pop_back();
        return {*this, std::move(buffers)};
      }
    }
    return {*this, std::make_unique<ThreadBuffers>()};
  }

 private:
  void give_back(std::unique_ptr<ThreadBuffers> buffers) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(buffers));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<ThreadBuffers>> idle_;
};

}  // namespace pd::detail
