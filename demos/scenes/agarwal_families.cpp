#include "scenes/agarwal_families.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pd::scenes {

namespace {

/// Upside down and turned by a right angle: (x, y, z) -> (y, x, -z).
Mat3 crossing() {
  Mat3 m = Mat3::Zero();
  m(0, 1) = m(1, 0) = 1;
  m(2, 2) = -1;
  return m;
}

ConvexPolytope hull(const Points& points) { return *ConvexPolytope::from_points(points); }

double top_of(const ConvexPolytope& body) {
  double top = body.z()[0];
  for (int v = 1; v < body.num_vertices(); ++v) top = std::max(top, body.z()[v]);
  return top;
}

/// Both bodies with the top of their own frames upward; B is crossed over A.
PolytopePair crossed(const Points& a, const Points& b, const Vec3& shift, double overlap) {
  PolytopePair pair{hull(a), hull(b), Pose(), Pose()};
  const Vec3 t(shift.x(), shift.y(), top_of(pair.a) + top_of(pair.b) - overlap);
  pair.pose_b = Pose::from_trusted_matrix(crossing(), t);
  return pair;
}

/// Point of the circle of radius 1 + jitter about (0, -1) with the outward normal (slope, 1): no difference of nearly
/// equal numbers, so that arcs of any flatness keep their curvature in doubles.
struct ArcPoint {
  double x;
  double z;
};
ArcPoint on_circle(double slope, double jitter) {
  const double length = std::sqrt(1 + slope * slope);
  return {(1 + jitter) * slope / length, jitter / length - slope * slope / (length * (1 + length))};
}

/// One body of the round patch, its arc in the plane y = 0 with the top in the origin.
Points patch_body(int m, const PatchShape& shape, Random& random) {
  const double eta = shape.eta;
  const double step = 2 * eta / m;  // m edges, m + 1 corners
  const double steep = 1.2 * eta;   // slope of the faces on both sides of the arc
  constexpr double kReach = 4;
  Points points;
  const auto corner = [&](double x, double y, double z) {
    points.emplace_back(x, y, z);
    const double far = kReach * (1 - 0.01 * random.uniform());
    points.emplace_back(x, y + far, z - steep * far);
  };
  // An edge has length `step` nearly: corners off the plane by `tilt * step^2 / eta` turn it by `tilt * step / eta`.
  const double sideways = shape.tilt * step * step / (2 * eta);
  for (int i = 0; i <= m; ++i) {
    const double jitter = shape.jitter * step * step * random.uniform(-0.5, 0.5);
    const ArcPoint p = on_circle(-eta + step * i, jitter);
    corner(p.x, sideways > 0 ? sideways * random.uniform(-1, 1) : 0, p.z);
  }
  // Beyond its ends the arc goes on along tangents, a little steeper, so that no way out beside it is shorter.
  const ArcPoint end = on_circle(eta, 0);
  for (const double side : {-1.0, 1.0}) corner(side * (end.x + 0.5), 0, end.z - 0.5 * eta - step);
  points.emplace_back(0, -1, -steep);
  points.emplace_back(0, kReach + 1, -(kReach + 2) * steep);
  for (const double y : {-1.0, kReach + 1}) points.emplace_back(0, y, -kReach * steep - 4);
  return points;
}

/// One of the jittered roofs, its arc in the plane y = 0 and as high as the origin.
Points jittered_roof(int n, Random& random) {
  constexpr double kSlope = 0.2679491924311227;  // tan 15 degrees
  constexpr double kFar = 4;
  Points points;
  const double step = 2 * kSlope / (n - 5);
  for (int i = 0; i < n - 4; ++i) {
    const ArcPoint p = on_circle(-kSlope + step * (i + 0.25 * random.uniform(-1, 1)), 0);
    points.emplace_back(p.x, 0, p.z);
  }
  for (const double x : {-kFar, kFar}) {
    for (const double y : {-kFar, kFar}) points.emplace_back(x, y, -1.5 * kSlope * kFar);
  }
  return points;
}

double power_of_two_above(double x) {
  double p = 1;
  while (p < x) p *= 2;
  return p;
}

/// A simple polytope with `facets` facets, flat along y, all of whose vertices lie on its shadow in the plane y = 0,
/// and all edges of the shadow but one face upward.
///
/// It is {f(z) >= y >= |x|} with f concave of `facets - 2` pieces: both ends of each ridge of f lie on the shadow |x| =
/// f(z), one on each of the planes y = |x|. The first piece of f rises with slope 1, the others fall with slopes below
/// -3/2, so that after the shear x - 3/2 z one edge alone faces down. All numbers are dyadic with few digits: the
/// facets are exactly flat.
Points shadow_polytope(int facets, double thickness) {
  const int falls = facets - 3;
  const double parts = power_of_two_above(falls);
  std::vector<double> height(static_cast<std::size_t>(falls) + 1, 0.0);
  for (int k = falls - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    height[i] = height[i + 1] + (2 + 2 * static_cast<double>(k) / parts) / parts;
  }
  Points points;
  const auto add = [&](double x, double z, double f) { points.emplace_back(x - 1.5 * z, thickness * f, z); };
  add(0, -height[0], 0);
  for (int k = 0; k < falls; ++k) {
    const double f = height[static_cast<std::size_t>(k)];
    for (const double side : {-1.0, 1.0}) add(side * f, k / parts, f);
  }
  add(0, falls / parts, 0);
  return points;
}

Pose turned(Random& random) { return random.pose(Vec3::Zero()); }

/// Unit balls about the origins of their frames: B comes down on the line on which the two extreme points meet at first
/// and the centres at last, at overlap 2.
PolytopePair stacked_balls(const Points& a, const Points& b, double overlap, Random& random) {
  PolytopePair pair{hull(a), hull(b), turned(random), turned(random)};
  const auto extreme = [](const ConvexPolytope& body, const Pose& pose, double side) {
    Vec3 best = pose.apply(body.vertex(0));
    for (int v = 1; v < body.num_vertices(); ++v) {
      const Vec3 p = pose.apply(body.vertex(v));
      if (side * p.z() > side * best.z()) best = p;
    }
    return best;
  };
  const Vec3 meeting = extreme(pair.a, pair.pose_a, 1) - extreme(pair.b, pair.pose_b, -1);
  pair.pose_b = *Pose::from_quaternion(pair.pose_b.quaternion_wxyz(), meeting * (1 - overlap / 2));
  return pair;
}

Points spiral_ball(int n) {
  // Fibonacci's spiral: equal areas between heights, turns by the golden section.
  constexpr double kGolden = 0.6180339887498949;
  Points points;
  for (int i = 0; i < n; ++i) {
    const double z = (2.0 * i + 1) / n - 1;
    const double radius = std::sqrt(1 - z * z);
    const Turn t = turn(kGolden * i);
    points.emplace_back(radius * t.cosine, radius * t.sine, z);
  }
  return points;
}

struct Entry {
  AgarwalFamily family;
  std::string_view name;
  bool quadratic;
};
constexpr Entry kEntries[] = {
    {AgarwalFamily::lens, "lens", true},
    {AgarwalFamily::patch, "patch", true},
    {AgarwalFamily::low_patch, "low_patch", true},
    {AgarwalFamily::flat_patch, "flat_patch", true},
    {AgarwalFamily::tilt_noise, "tilt_noise", true},
    {AgarwalFamily::low_tilt_noise, "low_tilt_noise", true},
    {AgarwalFamily::flat_tilt_noise, "flat_tilt_noise", true},
    {AgarwalFamily::crossed_roofs, "crossed_roofs", true},
    {AgarwalFamily::fogel_halperin_weibel, "fogel_halperin_weibel", true},
    {AgarwalFamily::sphere_hulls, "sphere_hulls", false},
    {AgarwalFamily::balls, "balls", false},
};
constexpr AgarwalFamily kFamilies[] = {AgarwalFamily::lens,
                                       AgarwalFamily::patch,
                                       AgarwalFamily::low_patch,
                                       AgarwalFamily::flat_patch,
                                       AgarwalFamily::tilt_noise,
                                       AgarwalFamily::low_tilt_noise,
                                       AgarwalFamily::flat_tilt_noise,
                                       AgarwalFamily::crossed_roofs,
                                       AgarwalFamily::fogel_halperin_weibel,
                                       AgarwalFamily::sphere_hulls,
                                       AgarwalFamily::balls};

}  // namespace

PolytopePair lens_pair(int m, double eta, double overlap) {
  Points points;
  for (int i = 0; i <= m; ++i) {
    const ArcPoint p = on_circle(-eta + 2 * eta * i / m, 0);
    for (const double y : {-1.0, 1.0}) points.emplace_back(p.x, y, p.z);
  }
  return crossed(points, points, Vec3::Zero(), overlap);
}

PolytopePair round_patch(int m, const PatchShape& shape, double overlap, std::uint64_t seed) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 29);
  const Points a = patch_body(m, shape, random);
  const Points b = patch_body(m, shape, random);
  const double step = 2 * shape.eta / m;
  const double y = step * step * random.uniform(-1, 1);
  const Vec3 shift(step * step * random.uniform(-1, 1), y, 0);
  return crossed(a, b, shift, overlap);
}

PolytopePair crossed_roofs(int n, double overlap, std::uint64_t seed) {
  return round_patch((n - 10) / 2, {0.1, 0.2, 0}, overlap, seed);
}

PolytopePair jittered_roofs(int n, double overlap, std::uint64_t seed) {
  Random random(seed);
  const Points a = jittered_roof(n, random), b = jittered_roof(n, random);
  const Vec3 shift = 1e-3 * random.point(-1, 1);
  return crossed(a, b, shift, overlap + shift.z());
}

PolytopePair fogel_halperin_weibel(int facets_a, int facets_b, double overlap) {
  const double parts = power_of_two_above(std::max(facets_a, facets_b));
  const double thickness = 1 / (16 * parts);
  PolytopePair pair =
      crossed(shadow_polytope(facets_a, thickness), shadow_polytope(facets_b, thickness), Vec3::Zero(), overlap);
  // The point of each body half an overlap below its top, on the way to its centre: the two meet in one.
  const auto below_top = [&](const ConvexPolytope& body) {
    int top = 0;
    for (int v = 1; v < body.num_vertices(); ++v) top = body.z()[v] > body.z()[top] ? v : top;
    const Vec3 way = body.centre() - body.vertex(top);
    return Vec3(body.vertex(top) - way * (overlap / 2 / way.z()));
  };
  const Vec3 t = below_top(pair.a) - crossing() * below_top(pair.b);
  pair.pose_b = Pose::from_trusted_matrix(crossing(), t);
  return pair;
}

PolytopePair sphere_hulls(int n, double overlap, std::uint64_t seed) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 31);
  const Points a = sphere_hull(n, random);
  const Points b = sphere_hull(n, random);
  return stacked_balls(a, b, overlap, random);
}

PolytopePair ball_pair(int n, double overlap, std::uint64_t seed) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 37);
  return stacked_balls(spiral_ball(n), spiral_ball(n), overlap, random);
}

std::span<const AgarwalFamily> agarwal_families() { return kFamilies; }

std::string_view to_string(AgarwalFamily family) { return kEntries[static_cast<std::size_t>(family)].name; }

bool is_quadratic(AgarwalFamily family) { return kEntries[static_cast<std::size_t>(family)].quadratic; }

PolytopePair make_agarwal_pair(AgarwalFamily family, int m, DepthClass depth, std::uint64_t seed) {
  const auto overlap = [&](double deep) {
    return depth == DepthClass::gap       ? -0.01
           : depth == DepthClass::shallow ? 0.01
           : depth == DepthClass::mid     ? 0.1
                                          : deep;
  };
  switch (family) {
    case AgarwalFamily::lens:
      return lens_pair(m, 0.5, overlap(0.105));
    case AgarwalFamily::patch:
      return round_patch(m, {0.5, 0.2, 0}, overlap(1), seed);
    case AgarwalFamily::low_patch:
      return round_patch(m, {0.1, 0.2, 0}, overlap(1), seed);
    case AgarwalFamily::flat_patch:
      return round_patch(m, {1.0 / m, 0.2, 0}, overlap(1), seed);
    case AgarwalFamily::tilt_noise:
      return round_patch(m, {0.5, 0.2, 0.2}, overlap(1), seed);
    case AgarwalFamily::low_tilt_noise:
      return round_patch(m, {0.1, 0.2, 0.2}, overlap(1), seed);
    case AgarwalFamily::flat_tilt_noise:
      return round_patch(m, {4.0 / m, 0.2, 0.2}, overlap(1), seed);
    case AgarwalFamily::crossed_roofs:
      return crossed_roofs(2 * m + 10, overlap(1), seed);
    case AgarwalFamily::fogel_halperin_weibel:
      return fogel_halperin_weibel(m, m, overlap(0.5));
    case AgarwalFamily::sphere_hulls:
      return sphere_hulls(m, overlap(2), seed);
    case AgarwalFamily::balls:
      return ball_pair(m, overlap(2), seed);
  }
  return lens_pair(m, 0.5, overlap(0.105));
}

}  // namespace pd::scenes
