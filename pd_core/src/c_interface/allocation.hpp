/// @file
/// Memory of the C interface: operator new and delete of the shared library, local to it by its version script.
///
/// Each block keeps in front of it who takes it back, so that it may be released by any thread and outside of any call.
/// A block's source is that of the call under way on the thread; outside of calls it is malloc.
#pragma once

#include <cstddef>

namespace pd::c_interface {

struct MemorySource {
  void* user;
  void* (*allocate)(void* user, std::size_t bytes, std::size_t alignment);
  void (*release)(void* user, void* block, std::size_t bytes, std::size_t alignment);
};

[[nodiscard]] const MemorySource& malloc_source();

/// While it lives, the calling thread allocates from `source`, which must outlive it.
class AllocationScope {
 public:
  explicit AllocationScope(const MemorySource& source) noexcept;
  ~AllocationScope();
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

 private:
  const MemorySource** source_of_thread_;  ///< looked up once
  const MemorySource* previous_;
};

}  // namespace pd::c_interface
