#include "shape/mesh/triangle_crossings.hpp"

#include <algorithm>
#include <utility>

#include "pd/numeric/predicates.hpp"
#include "shape/mesh/triangle_tree.hpp"

namespace pd::detail {

namespace {

using Triangle = std::array<Vec3, 3>;
using Flat = std::array<double, 2>;

// ---- in the plane of a triangle ----------------------------------------------------------------------------------

/// The coordinate plane on which the triangle's shadow has an area.
int dropped_axis(const Triangle& t) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (orient2d({t[0][u], t[0][v]}, {t[1][u], t[1][v]}, {t[2][u], t[2][v]}) != 0) return axis;
  }
  return 0;
}

Flat shadow(const Vec3& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

bool in_flat_triangle(const Flat& p, const std::array<Flat, 3>& t) {
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orient2d(t[k], t[(k + 1) % 3], p);
    left = left || side > 0;
    right = right || side < 0;
  }
  return !(left && right);
}

bool between(double x, double a, double b) { return std::min(a, b) <= x && x <= std::max(a, b); }

/// Closed segments.
bool flat_segments_meet(const Flat& p, const Flat& q, const Flat& a, const Flat& b) {
  const int pa = orient2d(p, q, a), pb = orient2d(p, q, b), ap = orient2d(a, b, p), aq = orient2d(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) return true;
  const auto on = [](int side, const Flat& x, const Flat& u, const Flat& v) {
    return side == 0 && between(x[0], u[0], v[0]) && between(x[1], u[1], v[1]);
  };
  return on(pa, a, p, q) || on(pb, b, p, q) || on(ap, p, a, b) || on(aq, q, a, b);
}

/// A segment in the plane of a triangle, both closed.
bool flat_segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) {
  const int axis = dropped_axis(t);
  const Flat u = shadow(p, axis), v = shadow(q, axis);
  const std::array<Flat, 3> flat = {shadow(t[0], axis), shadow(t[1], axis), shadow(t[2], axis)};
  if (in_flat_triangle(u, flat)) return true;
  for (std::size_t k = 0; k < 3; ++k) {
    if (flat_segments_meet(u, v, flat[k], flat[(k + 1) % 3])) return true;
  }
  return false;
}

// ---- in space ----------------------------------------------------------------------------------------------------

/// A segment and a triangle, both closed.
bool segment_meets(const Vec3& p, const Vec3& q, const Triangle& t) {
  const int above_p = orient3d(t[0], t[1], t[2], p), above_q = orient3d(t[0], t[1], t[2], q);
  if (above_p * above_q > 0) return false;
  if (above_p == 0 && above_q == 0) return flat_segment_meets(p, q, t);
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orient3d(p, q, t[k], t[(k + 1) % 3]);
    left = left || side > 0;
    right = right || side < 0;
  }
  return !(left && right);
}

Triangle corners(std::span<const Vec3> points, const FaceTriangle& t) {
  const auto point = [&](std::size_t k) { return points[static_cast<std::size_t>(t.vertices[k])]; };
  return {point(0), point(1), point(2)};
}

bool has_vertex(const FaceTriangle& t, std::int32_t v) {
  return v == t.vertices[0] || v == t.vertices[1] || v == t.vertices[2];
}

/// The triangle with the vertices that the other has, too, first; the order is kept else. Nothing is allocated, since
/// this is asked for millions of pairs.
FaceTriangle shared_first(FaceTriangle t, const FaceTriangle& other) {
  const std::array<std::int32_t, 3> vertices = t.vertices;
  std::size_t at = 0;
  for (const bool shared : {true, false}) {
    for (const std::int32_t v : vertices) {
      if (has_vertex(other, v) == shared) t.vertices[at++] = v;
    }
  }
  return t;
}

int count_shared(const FaceTriangle& s, const FaceTriangle& t) {
  int shared = 0;
  for (const std::int32_t v : s.vertices) shared += has_vertex(t, v);
  return shared;
}

}  // namespace

bool cross(std::span<const Vec3> points, const FaceTriangle& s, const FaceTriangle& t) {
  const int shared = count_shared(s, t);
  if (shared == 3) return true;
  const Triangle a = corners(points, shared_first(s, t)), b = corners(points, shared_first(t, s));
  if (shared == 0) {
    // Of two triangles that meet, an edge of one meets the other.
    for (std::size_t k = 0; k < 3; ++k) {
      if (segment_meets(a[k], a[(k + 1) % 3], b) || segment_meets(b[k], b[(k + 1) % 3], a)) return true;
    }
    return false;
  }
  // What two triangles share beyond a common vertex reaches the edge opposite to it in one of them.
  if (shared == 1) return segment_meets(a[1], a[2], b) || segment_meets(b[1], b[2], a);
  // Beyond a common edge they share something only when one lies folded upon the other.
  if (orient3d(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = dropped_axis(a);
  const Flat u = shadow(a[0], axis), v = shadow(a[1], axis);
  return orient2d(u, v, shadow(a[2], axis)) == orient2d(u, v, shadow(b[2], axis));
}

namespace {

/// Pairs of triangles whose boxes meet, found in one tree.
class CrossingSearch {
 public:
  CrossingSearch(std::span<const Vec3> points, const std::vector<FaceTriangle>& triangles, std::int64_t budget,
                 const std::function<void(std::int32_t, std::int32_t)>& found)
      : points_(points), triangles_(triangles), budget_(budget), found_(found) {
    boxes_.reserve(triangles.size());
    for (const FaceTriangle& triangle : triangles) boxes_.push_back(box_of(points, triangle.vertices));
    tree_ = TriangleTree(boxes_);
  }

  bool search() {
    if (!tree_.nodes().empty()) within(0);
    return budget_ >= 0;
  }

 private:
  using Node = TriangleTree::Node;
  [[nodiscard]] const Node& node(std::int32_t at) const { return tree_.nodes()[static_cast<std::size_t>(at)]; }
  [[nodiscard]] std::size_t triangle(std::int32_t place) const {
    return static_cast<std::size_t>(tree_.order()[static_cast<std::size_t>(place)]);
  }

  void test(std::int32_t i, std::int32_t j) {
    if (--budget_ < 0) return;
    const std::size_t at = triangle(i), other = triangle(j);
    const FaceTriangle &s = triangles_[at], &t = triangles_[other];
    if (s.face != t.face && boxes_[at].meets(boxes_[other]) && cross(points_, s, t)) {
      found_(std::min(s.face, t.face), std::max(s.face, t.face));
    }
  }

  /// Pairs inside of one node.
  void within(std::int32_t at) {
    const Node& inner = node(at);
    if (inner.is_leaf()) {
      for (std::int32_t i = inner.first; i < inner.last; ++i) {
        for (std::int32_t j = i + 1; j < inner.last; ++j) test(i, j);
      }
      return;
    }
    within(inner.left);
    within(inner.right);
    between_nodes(inner.left, inner.right);
  }

  void between_nodes(std::int32_t a, std::int32_t b) {
    if (--budget_ < 0) return;
    const Node &s = node(a), &t = node(b);
    if (!TriangleBox{s.low, s.high}.meets({t.low, t.high})) return;
    if (s.is_leaf() && t.is_leaf()) {
      for (std::int32_t i = s.first; i < s.last; ++i) {
        for (std::int32_t j = t.first; j < t.last; ++j) test(i, j);
      }
      return;
    }
    const bool split_first = !s.is_leaf() && (t.is_leaf() || s.last - s.first >= t.last - t.first);
    if (split_first) {
      between_nodes(s.left, b);
      between_nodes(s.right, b);
    } else {
      between_nodes(a, t.left);
      between_nodes(a, t.right);
    }
  }

  std::span<const Vec3> points_;
  const std::vector<FaceTriangle>& triangles_;
  std::int64_t budget_;
  const std::function<void(std::int32_t, std::int32_t)>& found_;
  std::vector<TriangleBox> boxes_;
  TriangleTree tree_;
};

}  // namespace

bool find_crossings(std::span<const Vec3> points, const std::vector<FaceTriangle>& triangles, std::int64_t budget,
                    const std::function<void(std::int32_t, std::int32_t)>& found) {
  return CrossingSearch(points, triangles, budget, found).search();
}

}  // namespace pd::detail
