/// @file
/// A simplex of the search for a closest point (Gilbert, Johnson, Keerthi 1988), solved in double-double.
#pragma once

#include <cmath>
#include <limits>

#include "numeric/vector_double_double.hpp"

namespace pd::detail {

inline bool less(const DoubleDouble& a, const DoubleDouble& b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }

/// The nearest point of a simplex' affine hull, where it lies in the relative interior.
struct ClosestOfFace {
  DoubleDouble squared{std::numeric_limits<double>::infinity(), 0};
  Vec3DD point;
  int members[4] = {0, 0, 0, 0};
  double weights[4] = {0, 0, 0, 0};
  int count = 0;
};

/// Of up to four vertices, which are whatever the caller knows them by.
template <class Vertex>
class SimplexDoubleDouble {
 public:
  SimplexDoubleDouble(const Vertex& first, const Vec3DD& x) {
    vertices_[0] = first;
    x_[0] = x;
    closest_.count = 1;
    closest_.weights[0] = 1;
    closest_.point = x;
    closest_.squared = dot(closest_.point, closest_.point);
  }

  [[nodiscard]] const ClosestOfFace& closest() const { return closest_; }
  [[nodiscard]] const Vertex& vertex(int i) const { return vertices_[i]; }

  /// Adds a vertex and keeps the face nearest to the origin. False when none with the new vertex is nearer.
  bool add(const Vertex& s, const Vec3DD& x) {
    const int count = closest_.count;
    vertices_[count] = s;
    x_[count] = x;
    ClosestOfFace best;
    best.squared = closest_.squared;
    consider_vertex(best, count);
    for (int i = 0; i < count; ++i) {
      consider_edge(best, i, count);
      for (int j = i + 1; j < count; ++j) consider_triangle(best, i, j, count);
    }
    if (count == 3) consider_inside(best);
    if (best.count == 0) return false;
    // Members ascend.
    for (int i = 0; i < best.count; ++i) {
      vertices_[i] = vertices_[best.members[i]];
      x_[i] = x_[best.members[i]];
    }
    closest_ = best;
    return true;
  }

 private:
  void take(ClosestOfFace& best, const ClosestOfFace& closest) const {
    if (less(closest.squared, best.squared)) best = closest;
  }
  void consider_vertex(ClosestOfFace& best, int i) const { take(best, {dot(x_[i], x_[i]), x_[i], {i}, {1}, 1}); }
  void consider_edge(ClosestOfFace& best, int i, int j) const {
    const Vec3DD e = x_[j] - x_[i];
    const DoubleDouble squared = dot(e, e);
    if (!(squared.hi > 0)) return;
    const double wi = to_double(dot(x_[j], e) / squared), wj = -to_double(dot(x_[i], e) / squared);
    if (!(wi > 0 && wj > 0)) return;
    const Vec3DD closest = scaled(cross(e, cross(x_[i], e)), DoubleDouble{1, 0} / squared);
    take(best, {dot(closest, closest), closest, {i, j}, {wi, wj}, 2});
  }
  void consider_triangle(ClosestOfFace& best, int i, int j, int k) const {
    const Vec3DD n = cross(x_[j] - x_[i], x_[k] - x_[i]);
    const DoubleDouble squared = dot(n, n);
    if (!(squared.hi > 0)) return;
    const double wi = to_double(dot(n, cross(x_[j], x_[k])) / squared);
    const double wj = to_double(dot(n, cross(x_[k], x_[i])) / squared);
    const double wk = to_double(dot(n, cross(x_[i], x_[j])) / squared);
    if (!(wi > 0 && wj > 0 && wk > 0)) return;
    const Vec3DD closest = scaled(n, dot(n, x_[i]) / squared);
    take(best, {dot(closest, closest), closest, {i, j, k}, {wi, wj, wk}, 3});
  }
  /// The origin in the tetrahedron: its weights are the volumes that it spans with the faces, all of one sign.
  void consider_inside(ClosestOfFace& best) const {
    const DoubleDouble volumes[4] = {dot(x_[1], cross(x_[2], x_[3])), -dot(x_[0], cross(x_[2], x_[3])),
                                     dot(x_[0], cross(x_[1], x_[3])), -dot(x_[0], cross(x_[1], x_[2]))};
    ClosestOfFace inside{{0, 0}, widened(Vec3::Zero()), {0, 1, 2, 3}, {}, 4};
    for (int i = 0; i < 4; ++i) {
      inside.weights[i] = std::abs(to_double(volumes[i]));
      if (!(inside.weights[i] > 0) || (volumes[i].hi > 0) != (volumes[0].hi > 0)) return;
    }
    take(best, inside);
  }

  Vertex vertices_[4];
  Vec3DD x_[4];
  ClosestOfFace closest_;
};

}  // namespace pd::detail
