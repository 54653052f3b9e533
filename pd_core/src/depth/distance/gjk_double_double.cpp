#include "depth/distance/gjk_double_double.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

Vec3 rounded(const Vec3DD& v) { return {to_double(v.x), to_double(v.y), to_double(v.z)}; }
bool less(const DoubleDouble& a, const DoubleDouble& b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }

/// The nearest point of a simplex' affine hull, where it lies in the relative interior.
struct ClosestOfFace {
  DoubleDouble squared{std::numeric_limits<double>::infinity(), 0};
  Vec3DD point;
  int members[4] = {0, 0, 0, 0};
  double weights[4] = {0, 0, 0, 0};
  int count = 0;
};

class Simplex {
 public:
  explicit Simplex(const DifferenceVertex& first) {
    vertices_[0] = first;
    closest_.count = 1;
    closest_.weights[0] = 1;
    closest_.point = widened(first.x);
    closest_.squared = dot(closest_.point, closest_.point);
  }

  [[nodiscard]] const ClosestOfFace& closest() const { return closest_; }
  [[nodiscard]] const DifferenceVertex& vertex(int i) const { return vertices_[i]; }

  /// Adds a vertex and keeps the face nearest to the origin. False when none with the new vertex is nearer.
  bool add(const DifferenceVertex& s) {
    const int count = closest_.count;
    vertices_[count] = s;
    for (int i = 0; i <= count; ++i) x_[i] = widened(vertices_[i].x);
    ClosestOfFace best;
    best.squared = closest_.squared;
    consider_vertex(best, count);
    for (int i = 0; i < count; ++i) {
      consider_edge(best, i, count);
      for (int j = i + 1; j < count; ++j) consider_triangle(best, i, j, count);
    }
    if (count == 3) consider_inside(best);
    if (best.count == 0) return false;
    for (int i = 0; i < best.count; ++i) vertices_[i] = vertices_[best.members[i]];
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

  DifferenceVertex vertices_[4];
  Vec3DD x_[4];
  ClosestOfFace closest_;
};

}  // namespace

template <class Difference>
ClosestPointWithNormal closest_point_double_double(const Difference& difference, const DifferenceVertex& first,
                                                   double relative, const BracketWidth& width, int max_steps,
                                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  const double rounding = 8 * kUnitRoundoff * difference.reach();
  const double upper_error = difference.point_error() + rounding;
  const double lower_error = difference.point_error() + difference.support_error() + rounding;
  const DifferenceVertex far = difference.support(difference.centre(), nullptr);
  ++support_calls;
  double largest = std::max(first.x.cwiseAbs().maxCoeff(), far.x.cwiseAbs().maxCoeff());
  Simplex simplex(first);
  ClosestPointWithNormal out;
  ClosestPoint& r = out.nearest;
  r.upper = std::numeric_limits<double>::infinity();
  r.lower = -r.upper;
  out.normal = Vec3::UnitX();
  for (int step = 0;; ++step) {
    const ClosestOfFace& closest = simplex.closest();
    const double length = to_double(sqrt(closest.squared));
    // Each closest is nearer than the last.
    r.upper = length + upper_error;
    r.point = rounded(closest.point);
    r.count = closest.count;
    double total = 0;
    for (int i = 0; i < closest.count; ++i) total += closest.weights[i];
    for (int i = 0; i < closest.count; ++i) {
      r.simplex[i] = simplex.vertex(i);
      r.weights[i] = closest.weights[i] / total;
    }
    if (!(length > lower_error)) return out;
    const Vec3 toward = -r.point.normalized();
    const DifferenceVertex s = difference.certified_support(toward, difference.support(toward, nullptr), stack);
    ++support_calls;
    largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
    const double height = -s.x.dot(toward);
    if (height - lower_error > r.lower) {
      r.lower = height - lower_error;
      out.normal = toward;
    }
    r.certified =
        r.lower > 0 && (r.upper - r.lower <= width.limit(largest) || width.is_within(relative, r.lower, r.upper));
    // What the formula's own rounding makes of a support on the simplex is no progress.
    if (r.certified || length - height <= 0.5 * rounding || step >= max_steps || !simplex.add(s)) return out;
  }
}

template ClosestPointWithNormal closest_point_double_double(const SmoothDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);
template ClosestPointWithNormal closest_point_double_double(const PolytopeDifference&, const DifferenceVertex&, double,
                                                            const BracketWidth&, int, std::vector<std::int32_t>&,
                                                            std::int64_t&);

}  // namespace pd::detail
