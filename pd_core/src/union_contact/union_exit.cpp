#include "pd/union_contact/union_exit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compound/part_pairs.hpp"
#include "compound/union_boundary.hpp"
#include "pd/contact/farthest_point.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/union_contact/union_piece.hpp"

namespace pd {

namespace {

/// Returns the hull of a smooth core's support points in the 26 directions to the faces, edges and corners of a cube.
/// It lies inside of the core.
std::optional<ConvexShape> inner_polytope(const ConvexShape& shape) {
  std::vector<Vec3> points;
  const PosedShape at_home{&shape, Pose()};
  for (int i = 0; i < 27; ++i) {
    const Vec3 way(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!way.isZero()) points.push_back(farthest_point(at_home, -way.normalized()));
  }
  auto hull = ConvexPolytope::from_points(points);
  if (!hull) return std::nullopt;
  auto rounded = ConvexShape(std::move(hull.value())).with_margin(shape.margin());
  if (!rounded) return std::nullopt;
  return std::move(rounded.value());
}

std::vector<detail::Box> boxes_of(const std::vector<PosedShape>& pieces) {
  std::vector<detail::Box> boxes;
  boxes.reserve(pieces.size());
  for (const PosedShape& piece : pieces) boxes.push_back(detail::bounding_box(piece));
  return boxes;
}

}  // namespace

bool UnionExit::stand_in(std::span<const PosedShape> given, std::vector<PosedShape>& pieces) {
  pieces.assign(given.begin(), given.end());
  for (PosedShape& piece : pieces) {
    if (piece.shape->polytope() != nullptr) continue;
    auto inner = inner_polytope(*piece.shape);
    if (!inner) return false;
    piece.shape = &inner_.emplace_back(std::move(*inner));
  }
  return true;
}

UnionExit::Outcome UnionExit::find(std::span<const PosedShape> of_a, std::span<const PosedShape> of_b,
                                   const Limits& limits, Scratch& scratch, Way& way) {
  inner_.clear();
  if (!stand_in(of_a, a_) || !stand_in(of_b, b_)) return Outcome::over_budget;
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  settings.contact_tolerance = 0;
  for (const PosedShape& a : a_) {
    for (const PosedShape& b : b_) {
      settings.contact_tolerance = std::max(settings.contact_tolerance, seam_slack(a, b, limits.pose_rounding));
    }
  }
  const double slack = settings.contact_tolerance;
  auto differences = detail::PartDifferences::find(a_, boxes_of(a_), b_, boxes_of(b_), 0, HUGE_VAL, limits.max_facets);
  bool inside_one = false;
  const auto measure = [&](std::size_t k) -> detail::UnionBoundary::SignedDistance {
    const PosedShape& a = a_[static_cast<std::size_t>(differences.pieces()[k].part_a)];
    const PosedShape& b = b_[static_cast<std::size_t>(differences.pieces()[k].part_b)];
    const PenetrationDepth depth = penetration_depth(a, b, scratch, settings);
    const double margins = a.shape->margin() + b.shape->margin();
    const bool apart = depth.contact == ContactClass::separated;
    const double most = margins + (apart ? depth.distance_upper : -depth.lower);
    inside_one = inside_one || -most > slack;
    return {margins + (apart ? depth.distance_lower : -depth.upper), most};
  };
  const auto nearest = detail::UnionBoundary(differences).nearest_past_seams(slack, measure);
  if (differences.limit_exceeded()) return Outcome::over_budget;
  if (!nearest || !inside_one) return Outcome::apart;
  const detail::PartDifference& last = differences.pieces()[nearest->piece];
  way = {nearest->x, static_cast<std::size_t>(last.part_a), static_cast<std::size_t>(last.part_b)};
  return Outcome::found;
}

}  // namespace pd
