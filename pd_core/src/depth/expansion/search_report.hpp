/// @file
/// Shows a search to its observer. Everything here is off the hot path: a search that nobody observes compares a
/// pointer with null once a step.
#pragma once

#include "depth/expansion/expansion_goal.hpp"
#include "depth/expansion/surface_snapshot.hpp"
#include "pd/depth/search_observer.hpp"

namespace pd::detail {

/// Who observes, and how what he is shown must be turned.
struct SearchWatch {
  SearchObserver* observer = nullptr;
  bool mirrored = false;  ///< the pair is solved with A and B exchanged: on -P

  [[nodiscard]] explicit operator bool() const { return observer != nullptr; }
};

inline constexpr std::string_view kDoubleArithmetic = "double";
inline constexpr std::string_view kExactHullArithmetic = "exact hull";
inline constexpr std::string_view kExactArithmetic = "exact";

/// @param nearest  the bounds and the face that the step began with, `support` of P in its normal.
void report_step(const SearchWatch& watch, std::string_view arithmetic, int number, const SurfaceSnapshot& surface,
                 double lower, double upper, const Vec3& unit_normal, const Vec3& support);
void report_end(const SearchWatch& watch, std::string_view arithmetic, const ExpansionResult& result);

/// The same from a surface that offers `snapshot(SurfaceSnapshot&)`.
template <class Surface>
[[gnu::cold, gnu::noinline]] void report_step(const SearchWatch& watch, std::string_view arithmetic, int number,
                                              const Surface& surface, const ExpansionResult& result,
                                              const Vec3& unit_normal, const Vec3& support) {
  SurfaceSnapshot snapshot;
  surface.snapshot(snapshot);
  report_step(watch, arithmetic, number, snapshot, result.lower, result.upper, unit_normal, support);
}

}  // namespace pd::detail
