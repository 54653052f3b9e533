/// @file
/// Two posed bodies and a method out of bytes, judged by the laws of a depth: its bracket, the swap, powers of two, and
/// that the translation as stored separates.
#include <algorithm>
#include <optional>

#include "fuzz/input.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::fuzz {

namespace {

bool finite(const PenetrationDepth& r) {
  return std::isfinite(r.depth) && std::isfinite(r.lower) && std::isfinite(r.upper) && std::isfinite(r.distance) &&
         std::isfinite(r.distance_lower) && std::isfinite(r.distance_upper) && r.translation.allFinite() &&
         r.normal.allFinite() && r.witness_a.allFinite() && r.witness_b.allFinite();
}

/// What each answer must be by itself.
void judge(const PenetrationDepth& r) {
  PD_LAW(finite(r));
  PD_LAW(std::abs(r.normal.norm() - 1) < 1e-14);
  PD_LAW(r.lower <= r.depth && r.depth <= r.upper);
  PD_LAW(r.distance_lower <= r.distance && r.distance <= r.distance_upper);
  PD_LAW(r.lower >= 0 && r.distance_lower >= 0);
  if (r.contact != ContactClass::overlapping) PD_LAW(r.upper == 0 && r.translation.isZero(0));
  if (r.contact != ContactClass::separated) PD_LAW(r.distance_upper == 0);
}

double size_of(const ConvexShape& shape) {
  struct {
    double operator()(const ConvexPolytope& p) const { return p.max_abs_coordinate(); }
    double operator()(const Ellipsoid& e) const { return e.radii.maxCoeff(); }
    double operator()(const Cylinder& c) const { return std::max(c.radius, c.half_height); }
    double operator()(const Cone& c) const { return std::max(c.radius, c.half_height); }
    double operator()(const SphereHull& hull) const {
      double most = 0;
      for (const Sphere& s : hull.spheres()) most = std::max(most, s.centre.cwiseAbs().maxCoeff() + s.radius);
      return most;
    }
  } core;
  return std::max(std::visit(core, shape.core()), shape.margin());
}

bool smooth(const ConvexShape& shape) { return shape.polytope() == nullptr; }

/// The length below which a pair's answer says nothing: the promise of curved bodies, or the rounding of polytopes'.
double noise(const PosedShape& a, const PosedShape& b) {
  const double size = std::max(
      {size_of(*a.shape), size_of(*b.shape), (b.pose.translation() - a.pose.translation()).cwiseAbs().maxCoeff()});
  return (smooth(*a.shape) || smooth(*b.shape) ? 1e-11 : 1e-14) * size + 0x1p-1070;
}

/// The signed depth of both answers may be one number.
void agree(const PenetrationDepth& x, const PenetrationDepth& y, double slack) {
  const auto low = [](const PenetrationDepth& r) {
    return r.contact == ContactClass::separated ? -r.distance_upper : r.lower;
  };
  const auto high = [](const PenetrationDepth& r) {
    return r.contact == ContactClass::separated ? -r.distance_lower : r.upper;
  };
  PD_LAW(low(x) <= high(y) + slack);
  PD_LAW(low(y) <= high(x) + slack);
}

void judge_pair(const PosedShape& a, const PosedShape& b, const DepthSettings& settings) {
  Scratch scratch;
  const PenetrationDepth r = penetration_depth(a, b, scratch, settings);
  judge(r);
  const bool polytopes = !smooth(*a.shape) && !smooth(*b.shape);
  const double slack = noise(a, b);
  if (settings.method == Method::automatic && polytopes) PD_LAW(r.upper - r.lower <= 64 * slack);

  // The swap: the same number, the opposite way.
  const PenetrationDepth swapped = penetration_depth(b, a, scratch, settings);
  PD_LAW(swapped.contact == r.contact && swapped.lower == r.lower && swapped.upper == r.upper);
  PD_LAW(swapped.distance == r.distance);

  // The translation separates, exactly for polytopes.
  if (r.contact == ContactClass::overlapping && polytopes && settings.method == Method::automatic) {
    const auto there = point_in_difference(a, b, r.translation, scratch);
    PD_LAW(!there || *there != ContactClass::overlapping);
  }
  // Every method finds the same number.
  if (settings.method != Method::automatic) agree(r, penetration_depth(a, b, scratch), slack);

  // The other queries end, and fit.
  const auto ray = directional_depth(a, b, r.normal, scratch);
  if (ray) {
    // Sizes too far from each other leave no upper bound: infinity, which the protocol refuses by name.
    PD_LAW(ray->lower <= ray->depth && ray->depth <= ray->upper);
    if (r.contact == ContactClass::overlapping && ray->contact == r.contact) PD_LAW(ray->upper >= r.lower - slack);
  }
  ManifoldScratch manifolds;
  const ContactManifold manifold = contact_manifold(a, b, r, 0.1, manifolds);
  for (int i = 0; i < manifold.count; ++i) {
    const ContactPoint& point = manifold.points[static_cast<std::size_t>(i)];
    PD_LAW(point.position_a.allFinite() && point.position_b.allFinite() && std::isfinite(point.depth));
  }
}

}  // namespace

}  // namespace pd::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pd;
  fuzz::Input input({data, size});
  const int method = input.choice(6);
  const auto a = fuzz::read_shape(input), b = fuzz::read_shape(input);
  const auto pose_a = fuzz::read_pose(input), pose_b = fuzz::read_pose(input);
  if (!a || !b || !pose_a || !pose_b) return 0;
  DepthSettings settings;
  settings.method = static_cast<Method>(method);
  if (!supports(settings.method, *a, *b)) settings.method = Method::automatic;
  // Up to 100,000 rays with exact signs: minutes where exponents are wild.
  if (settings.method == Method::grid && a->polytope() && b->polytope()) settings.method = Method::automatic;
  if (settings.method == Method::grid || settings.method == Method::shallow) settings.delta = 0.25;
  // The class of a pair that the range of doubles cannot hold is not asked for: the protocol refuses its answer.
  const double largest = 1e300;
  const double extent = std::max({fuzz::size_of(*a), fuzz::size_of(*b), pose_a->translation().cwiseAbs().maxCoeff(),
                                  pose_b->translation().cwiseAbs().maxCoeff()});
  if (extent > largest / 16) return 0;
  fuzz::judge_pair({&*a, *pose_a}, {&*b, *pose_b}, settings);
  return 0;
}
