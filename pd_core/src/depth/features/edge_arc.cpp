#include "depth/features/edge_arc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd::detail {

namespace {

/// Steps of Newton's method to the bottom of an arc; most need two.
constexpr int kMostArcSteps = 6;
/// Of what the height may still fall: the foot is off by the root of it, which the last step makes small.
constexpr double kFlatBottom = 0x1p-16;
/// Cosine of the widest part of an arc that is looked at in one: combinations of its ends are no longer than 2.
constexpr double kWidestArc = -0.5;
constexpr double kNoFloor = -std::numeric_limits<double>::infinity();

}  // namespace

EdgeArc::EdgeArc(const RevolvedCore& core, const Vec3& point, const Vec3& along, const Vec3& from, const Vec3& to)
    : core_(core), u_(from), end_x_(from.dot(to)) {
  // Of a sharp edge the normals are nearly opposite, and only the edge tells their plane.
  Vec3 across = end_x_ < 0 ? Vec3(along.cross(from)) : Vec3(to - end_x_ * from);
  if (across.dot(to) < 0) across = -across;
  w_ = across / across.norm();
  end_y_ = to.dot(w_);
  point_u_ = point.dot(u_);
  point_w_ = point.dot(w_);
  axis_u_ = core.axis.dot(u_);
  axis_w_ = core.axis.dot(w_);
  axis_edge_ = core.axis.dot(u_.cross(w_));
}

double EdgeArc::search(double slack, int& touches_left, LeastHeight& least) {
  // Normals closer than this span no plane that is known.
  if (!(end_y_ > 0x1p-30)) return kNoFloor;
  slack_ = slack;
  touches_left_ = &touches_left;
  least_ = &least;
  const Touch from = touch(1, 0), to = touch(end_x_, end_y_);
  if (end_x_ > kWidestArc) return between_parts(from, to);
  const double x = 1 + end_x_, y = end_y_, length = std::sqrt(x * x + y * y);
  const Touch middle = touch(x / length, y / length);
  note(middle, false);
  return std::min(between_parts(from, middle), between_parts(middle, to));
}

EdgeArc::Part EdgeArc::part_at(double along, double across) const {
  const bool upper = core_.pointed ? 2 * core_.half_height * along > core_.radius * across : !(along < 0);
  return upper ? Part::upper : Part::lower_rim;
}

EdgeArc::Touch EdgeArc::touch(double x, double y, Part part) const {
  Touch at{x, y, 0, 0, 0, 0, 0, part, false};
  at.along = x * axis_u_ + y * axis_w_;
  at.turned = x * axis_w_ - y * axis_u_;
  // Not by 1 - along^2, which is lost where the direction runs along the axis.
  at.across = std::sqrt(at.turned * at.turned + axis_edge_ * axis_edge_);
  const double z = part == Part::upper ? core_.half_height : -core_.half_height;
  at.height = x * point_u_ + y * point_w_ + z * at.along;
  at.slope = x * point_w_ - y * point_u_ + z * at.turned;
  if (part == Part::upper && core_.pointed) return at;
  at.height += core_.radius * at.across;
  if (at.across > 0) at.slope -= core_.radius * at.along * at.turned / at.across;
  return at;
}

EdgeArc::Touch EdgeArc::touch(double x, double y) const {
  const double turned = x * axis_w_ - y * axis_u_;
  return touch(x, y, part_at(x * axis_u_ + y * axis_w_, std::sqrt(turned * turned + axis_edge_ * axis_edge_)));
}

bool EdgeArc::is_between(const Touch& from, const Touch& to, double x, double y) {
  return from.x * y - from.y * x > 0 && x * to.y - y * to.x > 0;
}

double EdgeArc::curvature_radius(double across) const {
  return core_.radius * axis_edge_ * axis_edge_ / (across * across * across);
}

/// Where both are on one rim.
double EdgeArc::least_curvature_radius(const Touch& from, const Touch& to) const {
  const double across = from.along * to.along < 0 ? 1 : std::max(from.across, to.across);
  return across > 0 ? curvature_radius(across) : 0;
}

double EdgeArc::floor_between(const Touch& from, const Touch& to, double (&middle)[2]) const {
  const double least = std::min(from.height, to.height);
  const double curved = least_curvature_radius(from, to);
  const double kept = std::min(curved, least);
  // The two supports, less the disc.
  const double from_x = (from.height - kept) * from.x - from.slope * from.y;
  const double from_y = (from.height - kept) * from.y + from.slope * from.x;
  const double to_x = (to.height - kept) * to.x - to.slope * to.y;
  const double to_y = (to.height - kept) * to.y + to.slope * to.x;
  middle[0] = to_y - from_y;
  middle[1] = from_x - to_x;
  // Supports of a convex shadow have the direction across their chord between theirs, unless they are one up to
  // rounding.
  if (!is_between(from, to, middle[0], middle[1])) return least;
  const double length = std::sqrt(middle[0] * middle[0] + middle[1] * middle[1]);
  const double chord = std::min(from_x * middle[0] + from_y * middle[1], to_x * middle[0] + to_y * middle[1]) / length;
  double floor = kept + (chord < 0 ? 2 * chord : chord);
  const auto by_comparison = [&](const Touch& end, double inwards) {
    const double spare = curved - end.height;
    if (!(spare >= 0)) return;
    const double fall = std::min(0.0, inwards);
    floor = std::max(floor, end.height - (fall < 0 ? std::sqrt(spare * spare + fall * fall) - spare : 0));
  };
  by_comparison(from, from.slope);
  by_comparison(to, -to.slope);
  return std::min(floor, least);
}

void EdgeArc::note(const Touch& at, bool on_mantle) {
  --*touches_left_;
  if (!(at.height < least_->height)) return;
  // The bodies are apart, and no more need be known.
  if (at.height < 0) *touches_left_ = 0;
  *least_ = {at.height, at.x * u_ + at.y * w_, on_mantle};
}

/// Cut where the farthest part of the core changes.
double EdgeArc::between_parts(const Touch& from, const Touch& to) {
  const double in_plane = std::sqrt(axis_u_ * axis_u_ + axis_w_ * axis_w_);
  if (from.part == to.part) {
    // A rim at both ends and the apex in between, where the arc runs past the axis.
    const bool past_apex = core_.pointed && from.part == Part::lower_rim && from.turned > 0 && to.turned < 0 &&
                           part_at(in_plane, std::abs(axis_edge_)) == Part::upper;
    if (!past_apex) return between(from, to);
    const Touch middle = touch(axis_u_ / in_plane, axis_w_ / in_plane, Part::upper);
    note(middle, false);
    return std::min(between_parts(from, middle), between_parts(middle, to));
  }
  const double aside = std::sqrt(std::max(0.0, in_plane * in_plane - core_.kink * core_.kink));
  for (const double sign : {1.0, -1.0}) {
    double x = core_.kink * axis_u_ - sign * aside * axis_w_, y = core_.kink * axis_w_ + sign * aside * axis_u_;
    const double length = std::sqrt(x * x + y * y);
    if (!(length > 0)) break;
    x /= length;
    y /= length;
    if (!is_between(from, to, x, y)) continue;
    const Touch before = touch(x, y, from.part), behind = touch(x, y, to.part);
    note(before, true);
    note(behind, true);
    return std::min(between(from, before), between(behind, to));
  }
  // One of the ends lies on the change up to rounding, or the whole arc does. No part is farther than P.
  const Touch to_as_from = touch(to.x, to.y, from.part), from_as_to = touch(from.x, from.y, to.part);
  return to.height - to_as_from.height <= from.height - from_as_to.height ? between(from, to_as_from)
                                                                          : between(from_as_to, to);
}

/// Between two directions of the same part.
double EdgeArc::between(const Touch& from, const Touch& to) {
  if (core_.pointed && from.part == Part::upper) return std::min(from.height, to.height);
  double middle[2];
  const double floor = floor_between(from, to, middle);
  if (floor >= least_->height - slack_) return floor;
  if (*touches_left_ <= 0) return kNoFloor;
  if (from.slope < 0 && to.slope > 0 && !from.is_bottom && !to.is_bottom) {
    const Touch low = bottom(from, to);
    const double spare = least_curvature_radius(from, to) - low.height;
    if (spare > 0) {
      const double found = low.height - (std::sqrt(spare * spare + low.slope * low.slope) - spare);
      if (found >= least_->height - slack_) return found;
    }
    return std::min(between(from, low), between(low, to));
  }
  const double length = std::sqrt(middle[0] * middle[0] + middle[1] * middle[1]);
  const Touch next = touch(middle[0] / length, middle[1] / length, from.part);
  note(next, false);
  return std::min(between(from, next), between(next, to));
}

/// By Newton's method from where the slopes of both ends meet.
EdgeArc::Touch EdgeArc::bottom(const Touch& from, const Touch& to) {
  const double share = from.slope / (from.slope - to.slope);
  double x = from.x + share * (to.x - from.x), y = from.y + share * (to.y - from.y);
  Touch low = from;
  for (int step = 0; step < kMostArcSteps; ++step) {
    const double length = std::sqrt(x * x + y * y);
    x /= length;
    y /= length;
    if (!is_between(from, to, x, y)) break;
    low = touch(x, y, from.part);
    note(low, false);
    const double bend = curvature_radius(low.across) - low.height;
    if (!(bend > 0) || low.slope * low.slope <= kFlatBottom * slack_ * bend) break;
    const double turn = -low.slope / bend;
    x = low.x - turn * low.y;
    y = low.y + turn * low.x;
  }
  low.is_bottom = true;
  return low;
}

}  // namespace pd::detail
