#include "depth/expansion/search_report.hpp"

#include <utility>

namespace pd::detail {

namespace {

std::string_view outcome_of(ExpansionStatus status) {
  switch (status) {
    case ExpansionStatus::certified:
      return "certified";
    case ExpansionStatus::separated:
      return "separated";
    case ExpansionStatus::touching:
      return "touching";
    case ExpansionStatus::undecided:
      return "undecided";
    case ExpansionStatus::over_budget:
      return "over budget";
  }
  return "";
}

}  // namespace

void report_step(const SearchWatch& watch, std::string_view arithmetic, int number, const SurfaceSnapshot& surface,
                 double lower, double upper, const Vec3& unit_normal, const Vec3& support) {
  const double side = watch.mirrored ? -1 : 1;
  SearchStep step;
  step.arithmetic = arithmetic;
  step.number = number;
  for (const Vec3& x : surface.points) step.vertices.push_back(side * x);
  for (const SurfaceSnapshot::Face& f : surface.faces) {
    step.faces.push_back({f.v[0], f.v[1], f.v[2]});
    // A reflection in the origin turns a face's sense.
    if (watch.mirrored) std::swap(step.faces.back()[1], step.faces.back()[2]);
    step.distances.push_back(f.distance);
  }
  step.nearest = surface.nearest;
  step.normal = side * unit_normal;
  step.support = side * support;
  step.lower = lower;
  step.upper = upper;
  watch.observer->on_step(step);
}

void report_end(const SearchWatch& watch, std::string_view arithmetic, const ExpansionResult& result) {
  const double side = watch.mirrored ? -1 : 1;
  watch.observer->on_end(
      {arithmetic, outcome_of(result.status), result.lower, result.upper, Vec3(side * result.normal)});
}

}  // namespace pd::detail
