/// @file
/// Whether a surface is what its proof takes for granted (inner_surface.hpp): the invariants of an expanding polytope.
///
/// Built with the option PD_VALIDATE (the sanitizer preset sets it), every surface is checked after each insertion up
/// to 64 faces and beyond them after a quarter as many insertions as it has faces, and a broken one ends the program.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "depth/expansion/surface_snapshot.hpp"

namespace pd::detail {

enum class SurfaceRule : std::uint8_t {
  links,    ///< ids are in range, and what lies across an edge has the face across that edge
  senses,   ///< the two faces of an edge run along it in opposite senses, and a face has three corners
  keys,     ///< the corners of a face lie beyond its distance along its normal, up to rounding
  nearest,  ///< no face is nearer than the one named so
  winding,  ///< once every distance is positive for certain, the surface winds around the origin at least once
  convex    ///< no vertex of a neighbour lies above a face, exactly
};
[[nodiscard]] std::string_view to_string(SurfaceRule rule);

struct SurfaceFault {
  SurfaceRule rule;
  int face = -1;  ///< the first that breaks it, -1 where the whole does
};

/// The first rule that a surface breaks, in the order above, or nothing.
/// @param convex  whether the surface is one that promises to be.
/// Time O(faces); allocates nothing.
[[nodiscard]] std::optional<SurfaceFault> find_fault(const SurfaceSnapshot& surface, bool convex);

#ifdef PD_VALIDATE
inline constexpr bool kValidate = true;
#else
inline constexpr bool kValidate = false;
#endif

/// Up to this many faces a surface is checked after every insertion. Beyond, the checks of a surface that grows to n
/// faces take O(n log n) in all.
inline constexpr int kAlwaysCheckedFaces = 64;
inline constexpr int kFacesPerInsertion = 4;
inline constexpr std::size_t kSnapshotRoom = 4096;

/// Says on stderr what is broken and ends the program.
[[noreturn]] void report_fault(const SurfaceSnapshot& surface, const SurfaceFault& fault);

/// Under PD_VALIDATE, after an insertion: `Surface` offers `size()` and `snapshot(SurfaceSnapshot&)`.
template <class Surface>
void validate_after_insertion(const Surface& surface, bool convex, int& insertions) {
  if (surface.size() > kAlwaysCheckedFaces && ++insertions < surface.size() / kFacesPerInsertion) return;
  insertions = 0;
  // Tests count allocations: what a first query leaves has room for later, larger surfaces.
  static thread_local SurfaceSnapshot snapshot;
  snapshot.reserve(kSnapshotRoom);
  surface.snapshot(snapshot);
  if (const auto fault = find_fault(snapshot, convex)) report_fault(snapshot, *fault);
}

}  // namespace pd::detail
