#include "depth/rays/far_portal.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "depth/difference/exact_support.hpp"

namespace pd::detail {

FarPortal::FarPortal(const DirectionSigns& ray) : ray_(ray), pair_(ray.pair()) {
  int largest = 0;
  ray.scaled().cwiseAbs().maxCoeff(&largest);
  Vec3 x = Vec3::Unit((largest + 1) % 3), y = Vec3::Unit((largest + 2) % 3);
  if (ray.scaled()[largest] < 0) std::swap(x, y);
  around_ = {x, y, -x - y};
  for (std::int32_t k = 0; k < 3; ++k) corners_[static_cast<std::size_t>(k)] = {-1, k};
}

PortalPlane FarPortal::plane() const {
  PortalPlane plane;
  plane.of_portal = true;
  std::size_t far = 0, last_far = 3, real = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_far(i)) {
      ++far;
      last_far = i;
    } else {
      real = i;
    }
  }
  plane.corner = real;
  const double error = pair_.vector_error();
  const auto step = [&](std::size_t from, std::size_t to) {
    return PairVector::difference(corners_[from].a, corners_[from].b, corners_[to].a, corners_[to].b);
  };
  const auto around = [&](std::size_t i) { return around_[static_cast<std::size_t>(corners_[i].b)]; };
  if (far == 3) {
    plane.exact = ray_.exact();
    plane.rounded = {ray_.scaled(), 0};
  } else if (far == 2) {
    // (z_j - v) x (z_k - v) = M^3 d x (g_j - g_k) + ...
    const Vec3 across = around((real + 1) % 3) - around((real + 2) % 3);
    plane.exact = cross(ray_.exact(), to_dyadic(across));
    plane.rounded = rounded_cross(ray_.scaled(), 0, across, 0);
  } else if (far == 1) {
    // (w - v) x (z - v) = M^2 d x (w - v) + M (w - v) x g + ...
    plane.kind = PortalPlane::Kind::parallel;
    plane.w = step((last_far + 1) % 3, (last_far + 2) % 3);
    plane.rounded = rounded_cross(ray_.scaled(), 0, pair_.approximate(plane.w), error);
    if (plane.rounded.vector.cwiseAbs().maxCoeff() > plane.rounded.error) return plane;
    const Dyadic3 w = pair_.exact(plane.w);
    plane.exact = cross(ray_.exact(), w);
    if (plane.exact.x.sign() == 0 && plane.exact.y.sign() == 0 && plane.exact.z.sign() == 0) {
      plane.exact = cross(w, to_dyadic(around(last_far)));
    }
    plane.kind = PortalPlane::Kind::fixed;
    plane.rounded = {ExactDirection(plane.exact).unit, 0x1p-50};
  } else {
    plane.kind = PortalPlane::Kind::spanned;
    plane.u = step(0, 1);
    plane.w = step(0, 2);
    plane.rounded = rounded_cross(pair_.approximate(plane.u), error, pair_.approximate(plane.w), error);
    if (plane.rounded.vector.cwiseAbs().maxCoeff() <= 4 * plane.rounded.error) {
      // A needle of a triangle: its normal in doubles would lead the descent nowhere.
      plane.kind = PortalPlane::Kind::fixed;
      plane.exact = cross(pair_.exact(plane.u), pair_.exact(plane.w));
      plane.rounded = {ExactDirection(plane.exact).unit, 0x1p-50};
    }
  }
  return plane;
}

bool FarPortal::is_side(const PairVector& edge) const {
  if (edge.a_to == edge.a_from && edge.b_to == edge.b_from) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexPair &x = corners_[i], &y = corners_[(i + 1) % 3];
    if (x.a < 0 || y.a < 0) continue;
    const auto same = [](std::int32_t to, std::int32_t from, std::int32_t v, std::int32_t w) {
      return (to == v && from == w) || (to == w && from == v);
    };
    if (edge.b_to < 0 && x.b == y.b && same(edge.a_to, edge.a_from, x.a, y.a)) return true;
    if (edge.a_to < 0 && x.a == y.a && same(edge.b_to, edge.b_from, x.b, y.b)) return true;
  }
  return false;
}

bool FarPortal::completes_parallelogram(const VertexPair& s) const {
  const auto balanced = [](std::int32_t s_, std::int32_t opposite, std::int32_t x, std::int32_t y) {
    return (s_ == x && opposite == y) || (s_ == y && opposite == x);
  };
  if (has_far_corner()) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexPair &opposite = corners_[i], &x = corners_[(i + 1) % 3], &y = corners_[(i + 2) % 3];
    if (balanced(s.a, opposite.a, x.a, y.a) && balanced(s.b, opposite.b, x.b, y.b)) return true;
  }
  return false;
}

int FarPortal::sign(const PortalPlane& plane, const PairVector& edge) const {
  ++signs_asked_;
  const Vec3& n = plane.rounded.vector;
  const Vec3 e = pair_.approximate(edge);
  const double size = n.cwiseAbs().sum(), value = e.dot(n);
  // As in exact_support.hpp.
  const double bound = e.cwiseAbs().sum() * (plane.rounded.error + 0x1p-51 * size) +
                       pair_.vector_error() * (size + 3 * plane.rounded.error);
  if (std::abs(value) > bound * (1 + 0x1p-48) + 0x1p-900) return value > 0 ? 1 : -1;
  // The portal's own sides lie in its plane, and a step may lead nowhere: no arithmetic is spent on those zeros.
  if (plane.of_portal && is_side(edge)) return 0;
  switch (plane.kind) {
    case PortalPlane::Kind::spanned:
      return pair_.sign_determinant(edge, plane.u, plane.w);
    case PortalPlane::Kind::parallel:
      return ray_.turn(plane.w, edge);
    case PortalPlane::Kind::fixed:
      break;
  }
  return dot(pair_.exact(edge), plane.exact).sign();
}

bool FarPortal::beyond(const PortalPlane& plane, const VertexPair& s) const {
  if (plane.corner == 3) return true;
  const VertexPair& c = corners_[plane.corner];
  for (std::size_t i = 0; i < 3; ++i) {
    if (corners_[i].a == s.a && corners_[i].b == s.b) return false;
  }
  if (plane.of_portal && completes_parallelogram(s)) return false;
  return sign(plane, PairVector::difference(c.a, c.b, s.a, s.b)) > 0;
}

void FarPortal::replace(const VertexPair& s) {
  const std::array<int, 3> sides{side(corners_[0], s), side(corners_[1], s), side(corners_[2], s)};
  for (std::size_t i = 0; i < 3; ++i) {
    if (sides[i] < 0 && sides[(i + 1) % 3] > 0) {
      corners_[(i + 2) % 3] = s;
      return;
    }
  }
  assert(false);
}

int FarPortal::side(const VertexPair& x, const VertexPair& y) const {
  ++signs_asked_;
  if (x.a >= 0) return ray_.side(x, y);
  // det(z_k - o, y - o, d) = M det(g_k, y - o, d) + ...; the moved line decides where that is 0, as in
  // DirectionSigns::side.
  const Vec3& g = around_[static_cast<std::size_t>(x.b)];
  return ray_.side_of_far(g, y);
}

}  // namespace pd::detail
