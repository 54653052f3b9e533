#include "depth/distance/gjk_double_double.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/double_double.hpp"

namespace pd::detail {

namespace {

Vec3DD widened(const Vec3& v) { return {{v.x(), 0}, {v.y(), 0}, {v.z(), 0}}; }
Vec3DD scaled(const Vec3DD& v, const DoubleDouble& s) { return {v.x * s, v.y * s, v.z * s}; }
Vec3 rounded(const Vec3DD& v) { return {to_double(v.x), to_double(v.y), to_double(v.z)}; }
bool less(const DoubleDouble& a, const DoubleDouble& b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }

/// The nearest point of a simplex' affine hull, where it lies in the relative interior.
struct Foot {
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
    foot_.count = 1;
    foot_.weights[0] = 1;
    foot_.point = widened(first.x);
    foot_.squared = dot(foot_.point, foot_.point);
  }

  [[nodiscard]] const Foot& foot() const { return foot_; }
  [[nodiscard]] const DifferenceVertex& vertex(int i) const { return vertices_[i]; }

  /// Adds a vertex and keeps the face nearest to the origin. False when none with the new vertex is nearer.
  bool add(const DifferenceVertex& s) {
    const int count = foot_.count;
    vertices_[count] = s;
    for (int i = 0; i <= count; ++i) x_[i] = widened(vertices_[i].x);
    Foot best;
    best.squared = foot_.squared;
    consider_vertex(best, count);
    for (int i = 0; i < count; ++i) {
      consider_edge(best, i, count);
      for (int j = i + 1; j < count; ++j) consider_triangle(best, i, j, count);
    }
    if (count == 3) consider_inside(best);
    if (best.count == 0) return false;
    for (int i = 0; i < best.count; ++i) vertices_[i] = vertices_[best.members[i]];
    foot_ = best;
    return true;
  }

 private:
  void take(Foot& best, const Foot& foot) const {
    if (less(foot.squared, best.squared)) best = foot;
  }
  void consider_vertex(Foot& best, int i) const { take(best, {dot(x_[i], x_[i]), x_[i], {i}, {1}, 1}); }
  void consider_edge(Foot& best, int i, int j) const {
    const Vec3DD e = x_[j] - x_[i];
    const DoubleDouble squared = dot(e, e);
    if (!(squared.hi > 0)) return;
    const double wi = to_double(dot(x_[j], e) / squared), wj = -to_double(dot(x_[i], e) / squared);
    if (!(wi > 0 && wj > 0)) return;
    const Vec3DD foot = scaled(cross(e, cross(x_[i], e)), DoubleDouble{1, 0} / squared);
    take(best, {dot(foot, foot), foot, {i, j}, {wi, wj}, 2});
  }
  void consider_triangle(Foot& best, int i, int j, int k) const {
    const Vec3DD n = cross(x_[j] - x_[i], x_[k] - x_[i]);
    const DoubleDouble squared = dot(n, n);
    if (!(squared.hi > 0)) return;
    const double wi = to_double(dot(n, cross(x_[j], x_[k])) / squared);
    const double wj = to_double(dot(n, cross(x_[k], x_[i])) / squared);
    const double wk = to_double(dot(n, cross(x_[i], x_[j])) / squared);
    if (!(wi > 0 && wj > 0 && wk > 0)) return;
    const Vec3DD foot = scaled(n, dot(n, x_[i]) / squared);
    take(best, {dot(foot, foot), foot, {i, j, k}, {wi, wj, wk}, 3});
  }
  /// The origin in the tetrahedron: its weights are the volumes that it spans with the faces, all of one sign.
  void consider_inside(Foot& best) const {
    const DoubleDouble volumes[4] = {dot(x_[1], cross(x_[2], x_[3])), -dot(x_[0], cross(x_[2], x_[3])),
                                     dot(x_[0], cross(x_[1], x_[3])), -dot(x_[0], cross(x_[1], x_[2]))};
    Foot inside{{0, 0}, widened(Vec3::Zero()), {0, 1, 2, 3}, {}, 4};
    for (int i = 0; i < 4; ++i) {
      inside.weights[i] = std::abs(to_double(volumes[i]));
      if (!(inside.weights[i] > 0) || (volumes[i].hi > 0) != (volumes[0].hi > 0)) return;
    }
    take(best, inside);
  }

  DifferenceVertex vertices_[4];
  Vec3DD x_[4];
  Foot foot_;
};

}  // namespace

SmoothNearest smooth_nearest(const SmoothDifference& difference, const DifferenceVertex& first, double relative,
                             double absolute, std::int64_t& support_calls) {
  const double rounding = 8 * PolytopeDifference::kHalfUlp * difference.reach();
  const double upper_error = difference.point_error() + rounding;
  const double lower_error = difference.point_error() + difference.support_error() + rounding;
  const DifferenceVertex far = difference.support(difference.centre(), nullptr);
  ++support_calls;
  double largest = std::max(first.x.cwiseAbs().maxCoeff(), far.x.cwiseAbs().maxCoeff());
  Simplex simplex(first);
  SmoothNearest out;
  NearestResult& r = out.nearest;
  r.upper = std::numeric_limits<double>::infinity();
  r.lower = -r.upper;
  out.normal = Vec3::UnitX();
  for (;;) {
    const Foot& foot = simplex.foot();
    const double length = to_double(sqrt(foot.squared));
    // Each foot is nearer than the last.
    r.upper = length + upper_error;
    r.point = rounded(foot.point);
    r.count = foot.count;
    double total = 0;
    for (int i = 0; i < foot.count; ++i) total += foot.weights[i];
    for (int i = 0; i < foot.count; ++i) {
      r.simplex[i] = simplex.vertex(i);
      r.weights[i] = foot.weights[i] / total;
    }
    if (!(length > lower_error)) return out;
    const Vec3 toward = -r.point.normalized();
    const DifferenceVertex s = difference.support(toward, nullptr);
    ++support_calls;
    largest = std::max(largest, s.x.cwiseAbs().maxCoeff());
    const double height = -s.x.dot(toward);
    if (height - lower_error > r.lower) {
      r.lower = height - lower_error;
      out.normal = toward;
    }
    r.certified = r.lower > 0 && (r.upper - r.lower <= absolute * largest || r.upper <= (1 + relative) * r.lower);
    // What the formula's own rounding makes of a support on the simplex is no progress.
    if (r.certified || length - height <= 0.5 * rounding || !simplex.add(s)) return out;
  }
}

}  // namespace pd::detail
