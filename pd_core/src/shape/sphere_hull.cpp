#include "pd/shape/sphere_hull.hpp"

#include <algorithm>

namespace pd {

Vec3 SphereHull::support(const Vec3& direction) const {
  const double length = direction.norm();
  const Sphere* best = nullptr;
  double farthest = 0;
  for (const Sphere& s : *spheres_) {
    const double reach = s.centre.dot(direction) + s.radius * length;
    if (best == nullptr || reach > farthest) {
      best = &s;
      farthest = reach;
    }
  }
  return length > 0 ? Vec3(best->centre + (best->radius / length) * direction) : best->centre;
}

bool operator==(const SphereHull& x, const SphereHull& y) {
  if (x.spheres_ == y.spheres_) return true;
  return std::equal(x.spheres_->begin(), x.spheres_->end(), y.spheres_->begin(), y.spheres_->end(),
                    [](const Sphere& p, const Sphere& q) { return p.centre == q.centre && p.radius == q.radius; });
}

}  // namespace pd
