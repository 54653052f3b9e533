#include "oracle/curved_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pd::oracle {

namespace {

/// Cosines of the eight directions of the compass; the sine is the cosine of the direction six further on.
constexpr long double kDiagonal = 0.70710678118654752440L;
constexpr long double kCompass[8] = {1, kDiagonal, 0, -kDiagonal, -1, -kDiagonal, 0, kDiagonal};

Vec3L unit(const Vec3L& v) {
  const long double length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / length, v.y / length, v.z / length};
}

/// A body's core in its own frame, its pose and its margin.
class Support {
 public:
  explicit Support(const PosedShape& posed) : shape_(*posed.shape), pose_(posed.pose) {
    // Smooth bodies stand by the nearest rotation, polytopes by the stored numbers.
    rotation_ = shape_.polytope() != nullptr ? pose_.rotation() : pose_.nearest_rotation();
  }

  /// max over the body of <x, n>, for unit n.
  [[nodiscard]] long double operator()(const Vec3L& n) const {
    long double local[3];
    for (int j = 0; j < 3; ++j) {
      local[j] = static_cast<long double>(rotation_(0, j)) * n.x + static_cast<long double>(rotation_(1, j)) * n.y +
                 static_cast<long double>(rotation_(2, j)) * n.z;
    }
    const Vec3& t = pose_.translation();
    const long double shift = static_cast<long double>(t.x()) * n.x + static_cast<long double>(t.y()) * n.y +
                              static_cast<long double>(t.z()) * n.z;
    return shift + core(local) + static_cast<long double>(shape_.margin());
  }

 private:
  [[nodiscard]] long double core(const long double (&n)[3]) const {
    if (const ConvexPolytope* p = shape_.polytope()) {
      long double best = -INFINITY;
      for (int v = 0; v < p->num_vertices(); ++v) {
        const long double d = static_cast<long double>(p->x()[v]) * n[0] + static_cast<long double>(p->y()[v]) * n[1] +
                              static_cast<long double>(p->z()[v]) * n[2];
        best = std::max(best, d);
      }
      return best;
    }
    if (const auto* e = std::get_if<Ellipsoid>(&shape_.core())) {
      const long double x = n[0] * static_cast<long double>(e->radii.x());
      const long double y = n[1] * static_cast<long double>(e->radii.y());
      const long double z = n[2] * static_cast<long double>(e->radii.z());
      return std::sqrt(x * x + y * y + z * z);
    }
    if (const auto* hull = std::get_if<SphereHull>(&shape_.core())) {
      long double best = -INFINITY;
      for (const Sphere& s : hull->spheres()) {
        long double reach = static_cast<long double>(s.radius) * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < 3; ++i) reach += static_cast<long double>(s.centre[i]) * n[i];
        best = std::max(best, reach);
      }
      return best;
    }
    const auto* cylinder = std::get_if<Cylinder>(&shape_.core());
    const auto* cone = std::get_if<Cone>(&shape_.core());
    const int axis = cylinder != nullptr ? cylinder->axis : cone->axis;
    const long double across = std::sqrt(n[(axis + 1) % 3] * n[(axis + 1) % 3] + n[(axis + 2) % 3] * n[(axis + 2) % 3]);
    if (cylinder != nullptr) {
      return static_cast<long double>(cylinder->radius) * across +
             static_cast<long double>(cylinder->half_height) * std::abs(n[axis]);
    }
    const auto h = static_cast<long double>(cone->half_height);
    return std::max(h * n[axis], static_cast<long double>(cone->radius) * across - h * n[axis]);
  }

  const ConvexShape& shape_;
  const Pose& pose_;
  Mat3 rotation_;
};

}  // namespace

long double difference_support(const PosedShape& a, const PosedShape& b, const Vec3& direction) {
  const Vec3L n = unit({direction.x(), direction.y(), direction.z()});
  return Support(b)(n) + Support(a)({-n.x, -n.y, -n.z});
}

Sweep sweep_directions(const PosedShape& a, const PosedShape& b, int directions, int refined) {
  const Support support_a(a);
  const Support support_b(b);
  const auto value = [&](const Vec3L& n) { return support_b(n) + support_a({-n.x, -n.y, -n.z}); };

  // Fibonacci points on the sphere, and the axes.
  std::vector<Sweep> samples;
  const long double golden = 2.39996322972865332223L;
  for (int i = 0; i < directions; ++i) {
    const long double z = 1 - (2 * static_cast<long double>(i) + 1) / directions;
    const long double r = std::sqrt(1 - z * z);
    const Vec3L n{r * std::cos(golden * i), r * std::sin(golden * i), z};
    samples.push_back({value(n), n});
  }
  for (int k = 0; k < 6; ++k) {
    const long double s = k % 2 == 0 ? 1 : -1;
    const Vec3L n{k / 2 == 0 ? s : 0, k / 2 == 1 ? s : 0, k / 2 == 2 ? s : 0};
    samples.push_back({value(n), n});
  }
  std::sort(samples.begin(), samples.end(), [](const Sweep& p, const Sweep& q) { return p.least < q.least; });

  Sweep best = samples[0];
  for (int start = 0; start < std::min(refined, static_cast<int>(samples.size())); ++start) {
    Sweep here = samples[static_cast<std::size_t>(start)];
    // Pattern search on the tangent plane: eight steps round the compass, halved when none goes down.
    long double step = 4 / std::sqrt(static_cast<long double>(directions));
    for (int moves = 0; step > 1e-12L && moves < 1000; ++moves) {
      const Vec3L& n = here.direction;
      const Vec3L other = std::abs(n.x) < 0.6L ? Vec3L{1, 0, 0} : Vec3L{0, 1, 0};
      const Vec3L u =
          unit({n.y * other.z - n.z * other.y, n.z * other.x - n.x * other.z, n.x * other.y - n.y * other.x});
      const Vec3L v{n.y * u.z - n.z * u.y, n.z * u.x - n.x * u.z, n.x * u.y - n.y * u.x};
      Sweep next = here;
      for (int k = 0; k < 8; ++k) {
        const long double c = step * kCompass[k];
        const long double s = step * kCompass[(k + 6) % 8];
        const Vec3L m = unit({n.x + c * u.x + s * v.x, n.y + c * u.y + s * v.y, n.z + c * u.z + s * v.z});
        const long double h = value(m);
        if (h < next.least) next = {h, m};
      }
      if (next.least < here.least) {
        here = next;
      } else {
        step /= 2;
      }
    }
    if (here.least < best.least) best = here;
  }
  return best;
}

}  // namespace pd::oracle
