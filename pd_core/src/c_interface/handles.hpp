/// @file
/// The structs behind the opaque types of `pdepth.h`, and the border that no exception crosses.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c_interface/allocation.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/solid/solid_parts.hpp"
#include "pdepth/pdepth.h"

namespace pd::c_interface {

/// The small WebAssembly module answers for convex bodies alone. The linker then drops what only compounds need.
#ifdef PD_CONVEX_ALONE
inline constexpr bool kHasCompounds = false;
#else
inline constexpr bool kHasCompounds = true;
#endif

/// A refusal on its way to the border.
struct Refused {
  pdepth_status status;
  std::string message;
  std::string where;
};

[[noreturn]] void refuse(pdepth_status status, std::string message, std::string where);
/// An error of the core, found in an argument. @param argument  empty where the core's own place says it all.
[[noreturn]] void refuse(const Error& error, std::string_view argument);

template <class T>
T value_of(Expected<T>&& expected, std::string_view argument) {
  if (!expected) refuse(expected.error(), argument);
  return std::move(expected).value();
}

template <class T>
T& given(T* pointer, const char* argument) {
  if (pointer == nullptr) refuse(PDEPTH_NULL_ARGUMENT, "must not be NULL", argument);
  return *pointer;
}

/// The point at the origin, which every context shares.
[[nodiscard]] const ConvexShape& origin_shape();

/// The last failure, in memory of its own, so that it can be told where memory has run out.
struct ErrorRecord {
  pdepth_status status = PDEPTH_OK;
  char message[384] = "";
  char where[128] = "";

  /// Takes the exception under way, and returns its status. @param row  of a batch, or -1.
  pdepth_status take_exception(std::int64_t row) noexcept;

 private:
  void set(pdepth_status code, std::string_view text, std::string_view place, std::int64_t row) noexcept;
};

/// The buffers of one thread.
struct Workspace {
  Scratch scratch;
  ManifoldScratch manifold;
};

/// Something that one thread uses at a time.
class Use {
 public:
  explicit Use(std::atomic<bool>& flag) noexcept
      : flag_(flag.exchange(true, std::memory_order_acquire) ? nullptr : &flag) {}
  ~Use() {
    if (flag_ != nullptr) flag_->store(false, std::memory_order_release);
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  [[nodiscard]] bool granted() const { return flag_ != nullptr; }

 private:
  std::atomic<bool>* flag_;
};

/// A solid that a closed mesh bounds, and its convex parts, which are cut when a query first needs them.
class SolidBody {
 public:
  /// @param source  of the memory, now and later.
  SolidBody(MeshSolid mesh, const MemorySource& source) : mesh_(std::move(mesh)), source_(source) {}
  [[nodiscard]] const MeshSolid& mesh() const { return mesh_; }
  /// Refuses a solid with too many parts. @param argument  that the refusal names
  [[nodiscard]] const SolidParts& parts(const char* argument) const;

 private:
  MeshSolid mesh_;
  MemorySource source_;
  mutable std::mutex cutting_;
  mutable std::optional<Expected<SolidParts>> parts_;
};

}  // namespace pd::c_interface

struct pdepth_context {
  pd::c_interface::MemorySource source;
  std::atomic<bool> in_use{false};
  pd::c_interface::ErrorRecord error;
  /// The calling thread's own first, then those of the other threads of a batch.
  std::vector<std::unique_ptr<pd::c_interface::Workspace>> workspaces;
};

struct pdepth_shape {
  std::atomic<std::int64_t> references{1};
  std::optional<pd::Compound> made;                 ///< nothing: a solid
  std::optional<pd::c_interface::SolidBody> solid;  ///< nothing: a convex shape or a compound
  bool is_convex;

  pdepth_shape(pd::Compound body, bool convex) : made(std::move(body)), is_convex(convex) {}
  pdepth_shape(pd::MeshSolid mesh, const pd::c_interface::MemorySource& source) : is_convex(false) {
    solid.emplace(std::move(mesh), source);
  }
  /// The convex body, or nullptr for a compound or a solid.
  [[nodiscard]] const pd::ConvexShape* convex() const { return is_convex ? &made->parts().front().shape : nullptr; }
  /// The body as a union of convex shapes. Refuses a solid whose parts no doubles hold.
  [[nodiscard]] const pd::Compound& whole(const char* argument) const;
  /// For drawing: the parts of a solid lie in it, up to rounding.
  [[nodiscard]] const pd::Compound& drawn(const char* argument) const {
    return solid ? solid->parts(argument).inner() : *made;
  }
};

struct pdepth_pair {
  std::atomic<bool> in_use{false};
  pd::WarmCertificate certificate;
  pd::WarmUnion of_unions;
};

namespace pd::c_interface {

/// Runs `call()` with the context's allocator, and turns whatever it throws into a status.
template <class Call>
pdepth_status at_border(pdepth_context* context, Call&& call) noexcept {
  if (context == nullptr) return PDEPTH_NULL_ARGUMENT;
  const Use use(context->in_use);
  if (!use.granted()) return PDEPTH_IN_USE;
  const AllocationScope scope(context->source);
  try {
    call();
    return PDEPTH_OK;
  } catch (...) {
    return context->error.take_exception(-1);
  }
}

[[nodiscard]] inline Workspace& workspace_of(pdepth_context& context) { return *context.workspaces.front(); }

}  // namespace pd::c_interface
