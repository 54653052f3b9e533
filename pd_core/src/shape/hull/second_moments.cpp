#include "shape/hull/second_moments.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pd::detail {

namespace {

/// Of a ball's volume; what is flatter is measured by its vertices, since rounding would have a say in its volume.
constexpr double kLeastVolume = 0x1p-30;

/// Sums of products of coordinates, symmetric.
struct Moments {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(double weight, const Vec3& p) {
    const Vec3 weighted = weight * p;
    xx += weighted.x() * p.x();
    yy += weighted.y() * p.y();
    zz += weighted.z() * p.z();
    xy += weighted.x() * p.y();
    xz += weighted.x() * p.z();
    yz += weighted.y() * p.z();
  }
  [[nodiscard]] Mat3 matrix(double factor) const {
    Mat3 out;
    out << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return factor * out;
  }
};

}  // namespace

Mat3 second_moments(const ConvexPolytope::Storage& body) {
  int exponent = 0;
  (void)std::frexp(body.radius, &exponent);
  // Bodies below its range keep moments of 0, which round to 0 in any case.
  const double scale = std::ldexp(1.0, -std::max(exponent, -1000));
  const Vec3 centre = body.centre;
  const auto from_centre = [&](std::int32_t v) -> Vec3 {
    return scale * (Vec3(body.x[v], body.y[v], body.z[v]) - centre);
  };
  const auto in_lengths = [&](const Mat3& scaled) { return Mat3(scaled / scale / scale); };

  double volume = 0;  // six times, of tetrahedra from the centre to the facets' triangles
  Vec3 leaning = Vec3::Zero();
  Moments moments;
  for (std::int32_t f = 0; f < body.num_facets && body.affine_dimension == 3; ++f) {
    const auto corner = [&](std::int32_t i) { return from_centre(body.index(body.facet_vertices, i)); };
    const std::int32_t end = body.facet_offset(f + 1);
    std::int32_t i = body.facet_offset(f);
    const Vec3 p = corner(i);
    Vec3 q = corner(i + 1);
    Vec3 pq = p + q;
    for (i += 2; i < end; ++i) {
      const Vec3 r = corner(i);
      const Vec3 qr = q + r, rp = r + p;
      const double six_volumes = p.cross(q).dot(r);
      volume += six_volumes;
      leaning += six_volumes * (pq + r);
      // A tetrahedron with a corner in the origin: V / 5 of the squares of its triangle's midpoints.
      moments.add(six_volumes, pq);
      moments.add(six_volumes, qr);
      moments.add(six_volumes, rp);
      q = r;
      pq = rp;
    }
  }
  if (volume > kLeastVolume) {
    const Vec3 centroid = leaning / (4 * volume);
    return in_lengths(moments.matrix(1 / (20 * volume)) - centroid * centroid.transpose());
  }
  Moments of_vertices;
  for (std::int32_t v = 0; v < body.num_vertices; ++v) {
    of_vertices.add(1, from_centre(v));
  }
  return in_lengths(of_vertices.matrix(1.0 / body.num_vertices));
}

bool is_elongated(const Mat3& second_moments) {
  const double mean = second_moments.trace() / 3;
  // Divided first: third powers leave the range of doubles before squares do.
  return (second_moments / mean).determinant() < 0.5;
}

}  // namespace pd::detail
