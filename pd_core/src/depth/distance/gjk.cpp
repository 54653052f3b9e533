#include "depth/distance/gjk.hpp"

#include <algorithm>
#include <limits>

#include "numeric/instruction_sets.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// The faces of a simplex that were looked at, and the nearest point among them.
class NearestOfFaces {
 public:
  explicit NearestOfFaces(const DifferenceVertex* simplex) : s_(simplex) {}

  PD_INLINE void vertex(int i) { take<1>({i}, {1.0}); }

  PD_INLINE void edge(int i, int j) {
    const Vec3 e = s_[j].x - s_[i].x;
    // Each weight from its own end keeps both accurate.
    take<2>({i, j}, {s_[j].x.dot(e), -s_[i].x.dot(e)});
  }

  /// False where the origin's projection lies outside.
  PD_INLINE bool triangle(int i, int j, int k) {
    const Vec3 n = (s_[j].x - s_[i].x).cross(s_[k].x - s_[i].x);
    return take<3>({i, j, k},
                   {n.dot(s_[j].x.cross(s_[k].x)), n.dot(s_[k].x.cross(s_[i].x)), n.dot(s_[i].x.cross(s_[j].x))});
  }

  /// Keeps the face of the nearest point in the simplex, which it was made from; returns the point.
  Vec3 keep(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4]) const {
    for (int i = 0; i < count_; ++i) {
      simplex[i] = simplex[members_[i]];  // members ascend, so nothing is overwritten before it is read
      weights[i] = weights_[i];
    }
    count = count_;
    return point_;
  }

 private:
  /// Weights up to a factor. False where one is not positive.
  template <int Count>
  PD_INLINE bool take(const int (&members)[Count], const double (&weights)[Count]) {
    double total = 0;
    for (int i = 0; i < Count; ++i) {
      if (!(weights[i] > 0)) return false;
      total += weights[i];
    }
    const double share = 1 / total;
    // Weights are fourth powers of lengths, which leave the range of doubles before lengths do.
    if (!(share > 0 && share < std::numeric_limits<double>::infinity())) return false;
    // Whatever rounding did to the weights of a near-degenerate simplex, the point is a convex combination of P's.
    double shares[Count];
    Vec3 point = Vec3::Zero();
    for (int i = 0; i < Count; ++i) {
      shares[i] = weights[i] * share;
      point += shares[i] * s_[members[i]].x;
    }
    const double squared = point.squaredNorm();
    if (!(squared < squared_)) return true;
    squared_ = squared;
    point_ = point;
    count_ = Count;
    for (int i = 0; i < Count; ++i) {
      members_[i] = members[i];
      weights_[i] = shares[i];
    }
    return true;
  }

  const DifferenceVertex* s_;
  double squared_ = std::numeric_limits<double>::infinity();
  Vec3 point_ = Vec3::Zero();
  int count_ = 0;
  int members_[3];
  double weights_[3];
};

/// No angle at the first corner below 2^-10.
bool is_well_shaped(const DifferenceVertex* s) {
  const Vec3 u = s[1].x - s[0].x, v = s[2].x - s[0].x;
  return u.cross(v).squaredNorm() > 0x1p-20 * u.squaredNorm() * v.squaredNorm();
}

/// Certain only beyond rounding: four nearly coplanar points enclose nothing.
bool inside_tetrahedron(const DifferenceVertex* s) {
  double size = 0;
  for (int i = 0; i < 4; ++i) size = std::max(size, s[i].x.cwiseAbs().maxCoeff());
  const double noise = 256 * kUnitRoundoff * size * size * size;
  const double volume = (s[1].x - s[0].x).cross(s[2].x - s[0].x).dot(s[3].x - s[0].x);
  const double side = volume < 0 ? -1 : 1;
  const auto inside = [&](double v) { return side * v > noise; };
  return inside(s[1].x.cross(s[2].x).dot(s[3].x)) && inside(-s[0].x.cross(s[2].x).dot(s[3].x)) &&
         inside(s[0].x.cross(s[1].x).dot(s[3].x)) && inside(-s[0].x.cross(s[1].x).dot(s[2].x));
}

/// @tparam kOfNewest  only faces with the last point.
template <bool kOfNewest>
Vec3 nearest_on(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4], bool planar) {
  if (count == 4 && !planar && inside_tetrahedron(simplex)) {
    weights[0] = weights[1] = weights[2] = weights[3] = 0.25;
    return Vec3::Zero();
  }
  NearestOfFaces nearest(simplex);
  const auto asked = [newest = count - 1](int last) { return !kOfNewest || last == newest; };
  // A triangle that holds the projection holds the nearest point: bodies at rest end here. In a slender one
  // rounding may say so, too.
  const bool inside = count == 3 && is_well_shaped(simplex) && nearest.triangle(0, 1, 2);
  for (int i = 0; i < count && !inside; ++i) {
    if (asked(i)) nearest.vertex(i);
    for (int j = i + 1; j < count; ++j) {
      if (asked(j)) nearest.edge(i, j);
      for (int k = j + 1; k < count; ++k) {
        if (asked(k)) nearest.triangle(i, j, k);
      }
    }
  }
  return nearest.keep(simplex, count, weights);
}

}  // namespace

Vec3 closest_point_on_simplex(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4], bool planar) {
  return nearest_on<false>(simplex, count, weights, planar);
}

Vec3 closest_point_with_newest(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4]) {
  return nearest_on<true>(simplex, count, weights, false);
}

}  // namespace pd::detail
