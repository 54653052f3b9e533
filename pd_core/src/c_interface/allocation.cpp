#include "c_interface/allocation.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

namespace pd::c_interface {

namespace {

/// Stands directly before the memory that it describes.
struct alignas(16) BlockHeader {
  void (*release)(void* user, void* block, std::size_t bytes, std::size_t alignment);
  void* user;
  void* block;
  std::size_t bytes;
  std::size_t alignment;
};

thread_local const MemorySource* current_source = nullptr;

void* allocate_by_malloc(void*, std::size_t bytes, std::size_t alignment) {
  if (alignment <= alignof(std::max_align_t)) return std::malloc(bytes);
  return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

void release_by_free(void*, void* block, std::size_t, std::size_t) { std::free(block); }

void* allocate(std::size_t bytes, std::size_t alignment) {
  alignment = std::max(alignment, alignof(BlockHeader));
  const std::size_t before = (sizeof(BlockHeader) + alignment - 1) / alignment * alignment;
  if (bytes > std::numeric_limits<std::size_t>::max() / 2 - before) throw std::bad_alloc();
  const MemorySource& source = current_source != nullptr ? *current_source : malloc_source();
  const std::size_t whole = before + bytes;
  void* const block = source.allocate(source.user, whole, alignment);
  if (block == nullptr) throw std::bad_alloc();
  // Vector instructions would trap at a block that is not aligned as asked.
  if (reinterpret_cast<std::uintptr_t>(block) % alignment != 0) {
    source.release(source.user, block, whole, alignment);
    throw std::bad_alloc();
  }
  char* const memory = static_cast<char*>(block) + before;
  new (memory - sizeof(BlockHeader)) BlockHeader{source.release, source.user, block, whole, alignment};
  return memory;
}

void* allocate_or_null(std::size_t bytes, std::size_t alignment) noexcept {
  try {
    return allocate(bytes, alignment);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void release(void* memory) {
  if (memory == nullptr) return;
  const BlockHeader header = *reinterpret_cast<const BlockHeader*>(static_cast<char*>(memory) - sizeof(BlockHeader));
  header.release(header.user, header.block, header.bytes, header.alignment);
}

}  // namespace

const MemorySource& malloc_source() {
  static constexpr MemorySource kMalloc{nullptr, &allocate_by_malloc, &release_by_free};
  return kMalloc;
}

AllocationScope::AllocationScope(const MemorySource& source) noexcept
    : source_of_thread_(&current_source), previous_(*source_of_thread_) {
  *source_of_thread_ = &source;
}

AllocationScope::~AllocationScope() { *source_of_thread_ = previous_; }

}  // namespace pd::c_interface

namespace {
constexpr std::size_t kDefaultAlignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;
}

// Every form that a program may replace: where the sanitizers bring forms of their own, the others would not match
// them.
void* operator new(std::size_t bytes) { return pd::c_interface::allocate(bytes, kDefaultAlignment); }
void* operator new[](std::size_t bytes) { return pd::c_interface::allocate(bytes, kDefaultAlignment); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return pd::c_interface::allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return pd::c_interface::allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return pd::c_interface::allocate_or_null(bytes, kDefaultAlignment);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return pd::c_interface::allocate_or_null(bytes, kDefaultAlignment);
}
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return pd::c_interface::allocate_or_null(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return pd::c_interface::allocate_or_null(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { pd::c_interface::release(memory); }
void operator delete[](void* memory) noexcept { pd::c_interface::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { pd::c_interface::release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { pd::c_interface::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { pd::c_interface::release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { pd::c_interface::release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { pd::c_interface::release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { pd::c_interface::release(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { pd::c_interface::release(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { pd::c_interface::release(memory); }
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
  pd::c_interface::release(memory);
}
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
  pd::c_interface::release(memory);
}
