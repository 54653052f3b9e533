#include "oracle/member_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pd::oracle {

namespace {

using Real = long double;
using Vec3R = Eigen::Matrix<Real, 3, 1>;

Real from_segment(const Vec3R& p, const Vec3R& a, const Vec3R& b) {
  const Vec3R e = b - a;
  const Real squared = e.squaredNorm();
  const Real t = squared > 0 ? std::clamp((p - a).dot(e) / squared, Real(0), Real(1)) : Real(0);
  return (a + t * e - p).norm();
}

Real from_triangle(const Vec3R& p, const Vec3R& a, const Vec3R& b, const Vec3R& c) {
  const Vec3R n = (b - a).cross(c - a);
  const Real sides = std::min({from_segment(p, a, b), from_segment(p, b, c), from_segment(p, c, a)});
  if (!(n.squaredNorm() > 0)) return sides;
  const auto left_of = [&](const Vec3R& x, const Vec3R& y) { return (y - x).cross(p - x).dot(n) >= 0; };
  return left_of(a, b) && left_of(b, c) && left_of(c, a) ? std::abs((p - a).dot(n)) / n.norm() : sides;
}

/// In the plane: of the point (x, y) from the rectangle |x| <= w, |y| <= h.
Real from_rectangle(Real x, Real y, Real w, Real h) {
  return std::hypot(std::max(std::abs(x) - w, Real(0)), std::max(std::abs(y) - h, Real(0)));
}

struct DistanceTo {
  Vec3R p;

  Real operator()(const ConvexPolytope& polytope) const {
    const auto vertex = [&](int v) { return Vec3R(polytope.vertex(v).cast<Real>()); };
    if (polytope.affine_dimension() == 0) return (p - vertex(0)).norm();
    if (polytope.affine_dimension() == 1) return from_segment(p, vertex(0), vertex(1));
    Real least = INFINITY;
    bool inside = polytope.affine_dimension() == 3;
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const auto loop = polytope.facet_vertices(f);
      const Vec3R a = vertex(loop[0]);
      const Vec3R outward = polytope.facet_normal(f).cast<Real>();
      inside &= (p - a).dot(outward) <= 0;
      for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
        least = std::min(least, from_triangle(p, a, vertex(loop[k]), vertex(loop[k + 1])));
      }
    }
    return inside ? 0 : least;
  }

  /// The foot is x_i = r_i^2 p_i / (r_i^2 + t) for the t >= 0 that puts it on the surface.
  Real operator()(const Ellipsoid& e) const {
    const Vec3R r = e.radii.cast<Real>();
    const auto value = [&](Real t) {
      Real sum = 0;
      for (int i = 0; i < 3; ++i) {
        const Real q = r[i] * p[i] / (r[i] * r[i] + t);
        sum += q * q;
      }
      return sum - 1;
    };
    if (value(0) <= 0) return 0;
    Real low = 0, high = r.maxCoeff() * p.norm();
    for (int k = 0; k < 4000 && high > low; ++k) {
      const Real middle = low > 0 && high > 4 * low ? std::sqrt(low * high) : (low + high) / 2;
      if (middle <= low || middle >= high) break;
      (value(middle) > 0 ? low : high) = middle;
    }
    Vec3R off;
    for (int i = 0; i < 3; ++i) off[i] = p[i] * (high / (r[i] * r[i] + high));
    return off.norm();
  }

  Real operator()(const Cylinder& c) const {
    return from_rectangle(radial(c.axis), p[c.axis], static_cast<Real>(c.radius), static_cast<Real>(c.half_height));
  }

  Real operator()(const Cone& c) const {
    const Vec3R at(radial(c.axis), p[c.axis], 0);
    const auto r = static_cast<Real>(c.radius), h = static_cast<Real>(c.half_height);
    const Vec3R apex(0, h, 0), rim(r, -h, 0), foot(0, -h, 0);
    if (at.y() >= -h && (at.y() - h) * r + 2 * h * at.x() <= 0) return 0;
    return std::min(from_segment(at, apex, rim), from_segment(at, rim, foot));
  }

  /// The greatest height above a supporting plane, by pattern search: it is concave on the half sphere of directions.
  Real operator()(const SphereHull& hull) const {
    const auto height = [&](const Vec3R& n) {
      Real support = -INFINITY;
      for (const Sphere& s : hull.spheres()) {
        support = std::max(support, s.centre.cast<Real>().dot(n) + static_cast<Real>(s.radius));
      }
      return p.dot(n) - support;
    };
    std::vector<Vec3R> directions;
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 2; ++y) {
        for (int z = -2; z <= 2; ++z) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2) {
            directions.push_back(Vec3R(Real(x), Real(y), Real(z)).normalized());
          }
        }
      }
    }
    Vec3R best = *std::max_element(directions.begin(), directions.end(),
                                   [&](const Vec3R& m, const Vec3R& n) { return height(m) < height(n); });
    Real highest = height(best);
    constexpr int kMoves = 24;  // of one length: what rounding seems to gain is endless
    for (Real step = 0.5L; step > 1e-12L; step /= 2) {
      for (int move = 0; move < kMoves; ++move) {
        const Vec3R from = best;
        for (const Vec3R& d : directions) {
          const Vec3R tried = (from + step * d).normalized();
          if (const Real value = height(tried); value > highest) {
            best = tried;
            highest = value;
          }
        }
        if (best == from) break;
      }
    }
    return std::max(highest, Real(0));
  }

 private:
  [[nodiscard]] Real radial(int axis) const { return std::hypot(p[(axis + 1) % 3], p[(axis + 2) % 3]); }
};

}  // namespace

long double distance_outside(const PosedShape& body, const Vec3& point) {
  // Smooth bodies stand by the nearest rotation, polytopes by the stored numbers, which rotate but for rounding.
  const Mat3 rotation = body.shape->polytope() != nullptr ? body.pose.rotation() : body.pose.nearest_rotation();
  const Vec3R local = rotation.transpose().cast<Real>() * (point.cast<Real>() - body.pose.translation().cast<Real>());
  const Real core = std::visit(DistanceTo{local}, body.shape->core());
  return std::max(core - static_cast<Real>(body.shape->margin()), Real(0));
}

}  // namespace pd::oracle
