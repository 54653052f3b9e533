#include "c_interface/handles.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <new>

#include "c_interface/reading.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::c_interface {

namespace {

constexpr int kCoreCodes = static_cast<int>(ErrorCode::limit_exceeded) + 1;
static_assert(static_cast<int>(ErrorCode::bad_value) + 1 == PDEPTH_BAD_VALUE);
static_assert(static_cast<int>(ErrorCode::bad_faces) + 1 == PDEPTH_BAD_FACES);
static_assert(kCoreCodes == PDEPTH_LIMIT_EXCEEDED);

/// Cuts the text where the array ends.
template <std::size_t N>
void copy_text(std::string_view text, char (&out)[N]) {
  const std::size_t length = std::min(text.size(), N - 1);
  std::copy_n(text.data(), length, out);
  out[length] = '\0';
}

/// The core keeps the surface of a cube and a triangle for good. They are made here, outside of any call, so that they
/// do not come from a caller's allocator, which may be gone when the process ends.
void make_lasting_shapes() {
  static_cast<void>(origin_shape());
  static const bool made = [] {
    const std::array<Vec3, 3> triangle{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
    return ConvexPolytope::box({1, 1, 1}).has_value() && ConvexPolytope::from_points(triangle).has_value();
  }();
  if (!made) refuse(PDEPTH_INTERNAL, "no cube could be made", "");
}

}  // namespace

const ConvexShape& origin_shape() {
  static const ConvexShape origin = [] {
    const std::array<Vec3, 1> point{Vec3::Zero()};
    return ConvexShape(value_of(ConvexPolytope::from_points(point), ""));
  }();
  return origin;
}

void refuse(pdepth_status status, std::string message, std::string where) {
  throw Refused{status, std::move(message), std::move(where)};
}

void refuse(const Error& error, std::string_view argument) {
  std::string where(argument);
  if (!where.empty() && !error.where.empty()) where += ".";
  refuse(static_cast<int>(error.code) + 1, error.message, where + error.where);
}

void ErrorRecord::set(pdepth_status code, std::string_view text, std::string_view place, std::int64_t row) noexcept {
  status = code;
  copy_text(text, message);
  // A row has no other question: its fields stand alone.
  constexpr std::string_view kQuestion = "question";
  if (row >= 0 && place.starts_with(kQuestion)) {
    place.remove_prefix(kQuestion.size());
    if (place.starts_with('.')) place.remove_prefix(1);
  }
  if (row < 0) {
    copy_text(place, where);
    return;
  }
  std::snprintf(where, sizeof where, "rows[%lld]%s%.*s", static_cast<long long>(row), place.empty() ? "" : ".",
                static_cast<int>(place.size()), place.data());
}

const SolidParts& SolidBody::parts(const char* argument) const {
  if (!kHasCompounds) refuse(PDEPTH_UNSUPPORTED, "the module for convex bodies cuts no solids", argument);
  const std::scoped_lock lock(cutting_);
  if (!parts_) {
    // The caller's own source may be gone before this body is.
    const AllocationScope scope(source_);
    parts_.emplace(SolidParts::from_solid(mesh_));
  }
  if (!*parts_) refuse(parts_->error(), argument);
  return **parts_;
}

pdepth_status ErrorRecord::take_exception(std::int64_t row) noexcept {
  try {
    throw;
  } catch (const Refused& refused) {
    set(refused.status, refused.message, refused.where, row);
  } catch (const std::bad_alloc&) {
    set(PDEPTH_OUT_OF_MEMORY, "the allocator has no more memory", "", row);
  } catch (const std::exception& error) {
    set(PDEPTH_INTERNAL, error.what(), "", row);
  } catch (...) {
    set(PDEPTH_INTERNAL, "an unknown exception", "", row);
  }
  return status;
}

}  // namespace pd::c_interface

const pd::Compound& pdepth_shape::whole(const char* argument) const {
  if (!solid) return *made;
  const pd::SolidParts& parts = solid->parts(argument);
  if (!parts.exact()) {
    pd::c_interface::refuse(PDEPTH_UNSUPPORTED,
                            "this needs the solid as convex parts, whose corners no doubles hold here; depth and apart "
                            "of solids and convex shapes need none",
                            argument);
  }
  return parts.inner();
}

using namespace pd::c_interface;  // NOLINT(google-build-using-namespace): the functions of C stand in no namespace

int32_t pdepth_version(void) {
  return 10000 * PDEPTH_VERSION_MAJOR + 100 * PDEPTH_VERSION_MINOR + PDEPTH_VERSION_PATCH;
}

const char* pdepth_status_name(pdepth_status status) {
  switch (status) {
    case PDEPTH_OK:
      return "ok";
    case PDEPTH_NULL_ARGUMENT:
      return "null_argument";
    case PDEPTH_OUT_OF_MEMORY:
      return "out_of_memory";
    case PDEPTH_IN_USE:
      return "in_use";
    case PDEPTH_INTERNAL:
      return "internal";
    default:
      // The core's words end with a zero, since they are literals.
      return status >= 1 && status <= kCoreCodes ? to_string(static_cast<pd::ErrorCode>(status - 1)).data() : "unknown";
  }
}

pdepth_status pdepth_last_error(const pdepth_context* context, pdepth_error* error) {
  if (context == nullptr || error == nullptr) return PDEPTH_NULL_ARGUMENT;
  *error = {context->error.status, 0, context->error.message, context->error.where};
  return PDEPTH_OK;
}

pdepth_status pdepth_context_create(const pdepth_allocator* allocator, pdepth_context** context) {
  if (context == nullptr) return PDEPTH_NULL_ARGUMENT;
  MemorySource source = malloc_source();
  if (allocator != nullptr) {
    if (allocator->size < sizeof(pdepth_allocator) || allocator->size > kMostSize) return PDEPTH_BAD_VALUE;
    if (allocator->reserved != 0) return PDEPTH_BAD_VALUE;
    if (allocator->allocate == nullptr || allocator->release == nullptr) return PDEPTH_NULL_ARGUMENT;
    source = {allocator->user, allocator->allocate, allocator->release};
  }
  ErrorRecord untold;
  try {
    make_lasting_shapes();
    const AllocationScope scope(source);
    auto made = std::make_unique<pdepth_context>();
    made->source = source;
    made->workspaces.push_back(std::make_unique<Workspace>());
    *context = made.release();
    return PDEPTH_OK;
  } catch (...) {
    return untold.take_exception(-1);
  }
}

void pdepth_context_destroy(pdepth_context* context) { delete context; }

void pdepth_shape_retain(pdepth_shape* shape) {
  if (shape != nullptr) shape->references.fetch_add(1, std::memory_order_relaxed);
}

void pdepth_shape_release(pdepth_shape* shape) {
  if (shape != nullptr && shape->references.fetch_sub(1, std::memory_order_acq_rel) == 1) delete shape;
}

pdepth_status pdepth_pair_create(pdepth_context* context, pdepth_pair** pair) {
  return at_border(context, [&] { given(pair, "pair") = new pdepth_pair; });
}

pdepth_status pdepth_pair_clear(pdepth_context* context, pdepth_pair* pair) {
  return at_border(context, [&] {
    const Use use(given(pair, "pair").in_use);
    if (!use.granted()) refuse(PDEPTH_IN_USE, "another thread uses the pair", "pair");
    pair->certificate.clear();
    pair->of_unions.clear();
  });
}

void pdepth_pair_destroy(pdepth_pair* pair) { delete pair; }
