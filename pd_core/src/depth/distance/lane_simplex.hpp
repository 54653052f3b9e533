/// @file
/// A simplex of the search for a closest point (closest_search.hpp), solved in lanes of doubles (simplex_lanes.hpp).
#pragma once

#include <cmath>

#include "depth/difference/polytope_difference.hpp"
#include "depth/distance/nearest_of_few.hpp"
#include "depth/distance/simplex_lanes.hpp"

namespace pd::detail {

class LaneSimplex {
 public:
  /// Adds a corner and keeps the face nearest to the origin. False, and nothing done, if that is not nearer; false
  /// also if the origin lies in the tetrahedron with the corner, up to rounding.
  bool add(const DifferenceVertex& s) {
    NearestLaneFace next = face_;
    if (!add_to_face(next, {s.x.x(), s.x.y(), s.x.z(), s.a, s.b})) {
      encloses_ = true;
      return false;
    }
    Vec3 point = Vec3::Zero();
    for (int i = 0; i < next.count; ++i) {
      const LanePoint& p = next.corners[i];
      point += next.weights[i] * Vec3(p.x, p.y, p.z);
    }
    if (face_.count > 0 && !(point.squaredNorm() < point_.squaredNorm())) return false;
    face_ = next;
    point_ = point;
    return true;
  }

  [[nodiscard]] bool encloses() const { return encloses_; }
  /// Up to three.
  [[nodiscard]] int count() const { return face_.count; }
  [[nodiscard]] DifferenceVertex corner(int i) const {
    const LanePoint& p = face_.corners[i];
    return {{p.x, p.y, p.z}, p.a, p.b};
  }
  [[nodiscard]] double weight(int i) const { return face_.weights[i]; }
  [[nodiscard]] bool has_corner(const DifferenceVertex& s) const {
    for (int i = 0; i < face_.count; ++i) {
      if (face_.corners[i].a == s.a && face_.corners[i].b == s.b) return true;
    }
    return false;
  }
  /// The point nearest to the origin.
  [[nodiscard]] const Vec3& point() const { return point_; }
  /// Unit; from that point to the origin, across the face. Zero at the origin.
  [[nodiscard]] Vec3 toward() const {
    const Vec3 across(face_.toward.x, face_.toward.y, face_.toward.z);
    // Where powers of lengths are no doubles it is no unit vector.
    return std::abs(across.squaredNorm() - 1) <= 0x1p-48 ? across : Vec3(-point_.normalized());
  }

 private:
  NearestLaneFace face_{};
  Vec3 point_ = Vec3::Zero();
  bool encloses_ = false;
};

}  // namespace pd::detail
