#include <algorithm>
#include <cmath>

#include "scenes/shape_families.hpp"
#include "scenes/single_precision.hpp"

namespace pd::scenes {

namespace {

Vec3 rotate(const Pose& pose, const Vec3& p) { return pose.rotation() * p; }

Pose quaternion_pose(Random& random, const Vec3& translation) { return random.pose(translation); }

Pose matrix_pose(const Mat3& rotation, const Vec3& translation) { return *Pose::from_matrix(rotation, translation); }

/// One of the 24 rotations of the cube: exact in both forms.
Mat3 right_angles(Random& random) {
  Mat3 m = Mat3::Zero();
  const int first = random.integer(0, 2);
  const int second = (first + random.integer(1, 2)) % 3;
  m(first, 0) = random.integer(0, 1) != 0 ? 1 : -1;
  m(second, 1) = random.integer(0, 1) != 0 ? 1 : -1;
  const Vec3 x = m.col(0);
  const Vec3 y = m.col(1);
  m.col(2) = Vec3(x.y() * y.z() - x.z() * y.y(), x.z() * y.x() - x.x() * y.z(), x.x() * y.y() - x.y() * y.x());
  return m;
}

/// A rotation by a small angle about a random axis, to rounding.
std::array<double, 4> small_rotation(Random& random, double angle) {
  const Vec3 axis = random.direction() * (angle / 2);
  const double length = std::sqrt(1 + axis.squaredNorm());
  return {1 / length, axis.x() / length, axis.y() / length, axis.z() / length};
}

Vec3 extreme(const Points& points, const Pose& pose, const Vec3& direction) {
  Vec3 best = rotate(pose, points[0]);
  for (const Vec3& p : points) {
    const Vec3 q = rotate(pose, p);
    if (q.dot(direction) > best.dot(direction)) best = q;
  }
  return best;
}

double size_of(const Points& points) {
  Vec3 low = points[0];
  Vec3 high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

Pose moved(const Pose& pose, const Vec3& translation) {
  return pose.is_quaternion() ? *Pose::from_quaternion(pose.quaternion_wxyz(), translation)
                              : Pose::from_trusted_matrix(pose.rotation(), translation);
}

/// Moves B so that the two support points of a random direction meet, then by the wanted share of the smaller size.
void place(PointPair& pair, DepthClass depth, Random& random) {
  const double size =
      std::max(std::min(size_of(pair.a), size_of(pair.b)), 0.01 * std::max(size_of(pair.a), size_of(pair.b)));
  const Vec3 base = pair.pose_a.translation();
  if (depth == DepthClass::deep) {
    Vec3 centre_a = Vec3::Zero();
    Vec3 centre_b = Vec3::Zero();
    for (const Vec3& p : pair.a) centre_a += p / static_cast<double>(pair.a.size());
    for (const Vec3& p : pair.b) centre_b += p / static_cast<double>(pair.b.size());
    const Vec3 t =
        base + rotate(pair.pose_a, centre_a) - rotate(pair.pose_b, centre_b) + 1e-3 * size * random.direction();
    pair.pose_b = moved(pair.pose_b, t);
    return;
  }
  const double share = depth == DepthClass::gap ? -0.01 : depth == DepthClass::shallow ? 0.01 : 0.1;
  const Vec3 d = random.direction();
  const Vec3 t = base + extreme(pair.a, pair.pose_a, d) - extreme(pair.b, pair.pose_b, -d) - share * size * d;
  pair.pose_b = moved(pair.pose_b, t);
}

/// Both bodies in random rotations.
PointPair placed(Points a, Points b, DepthClass depth, Random& random) {
  PointPair pair{std::move(a), std::move(b), {}, {}};
  const double distance = random.uniform(0, 2);
  const Vec3 translation = random.direction() * distance;
  pair.pose_a = quaternion_pose(random, translation);
  pair.pose_b = quaternion_pose(random, Vec3::Zero());
  place(pair, depth, random);
  return pair;
}

/// Two bodies that `draw()` makes, B first.
template <typename Draw>
PointPair placed(const Draw& draw, DepthClass depth, Random& random) {
  Points b = draw();
  return placed(draw(), std::move(b), depth, random);
}

Vec3 random_extents(Random& random) {
  const double x = random.uniform(0.2, 1);
  const double y = random.uniform(0.2, 1);
  return {x, y, random.uniform(0.2, 1)};
}

/// A stands below, B comes from above, turned by a right angle about z and upside down: the profiles cross.
/// Deep means the same place when `nested`, else by 1 (where the facets of two roofs are all nearly tied).
PointPair crossed(Points a, Points b, DepthClass depth, bool nested, Random& random) {
  PointPair pair{std::move(a), std::move(b), {}, {}};
  Mat3 m = Mat3::Zero();
  m(0, 1) = 1;
  m(1, 0) = 1;
  m(2, 2) = -1;
  double contact_height = 0;
  for (const Points* body : {&pair.a, &pair.b}) {
    double top = 0;
    for (const Vec3& p : *body) top = std::max(top, p.z());
    contact_height += top;
  }
  const double overlap = depth == DepthClass::gap       ? -0.01
                         : depth == DepthClass::shallow ? 0.01
                         : depth == DepthClass::mid     ? 0.1
                         : nested                       ? contact_height
                                                        : 1;
  const double y = 0.02 * random.uniform(-1, 1);
  pair.pose_b = matrix_pose(m, Vec3(0.02 * random.uniform(-1, 1), y, contact_height - overlap));
  return pair;
}

/// Two crossed roofs, B's drawn first.
PointPair crossed_roofs(int n, const RoofShape& shape, DepthClass depth, Random& random) {
  Points b = roof(n, shape, random);
  return crossed(roof(n, shape, random), std::move(b), depth, false, random);
}

PointPair near_aligned(DepthClass depth, Random& random) {
  static constexpr double kAngles[] = {0, 1e-16, 1e-12, 1e-8, 1e-5};
  PointPair pair{box(random_extents(random)), box(random_extents(random)), {}, {}};
  pair.pose_a = quaternion_pose(random, Vec3::Zero());
  // B's rotation is A's times a small one, in doubles: parallel up to rounding at least.
  const auto q = pair.pose_a.quaternion_wxyz();
  const auto r = small_rotation(random, kAngles[random.integer(0, 4)]);
  const std::array<double, 4> product = {
      q[0] * r[0] - q[1] * r[1] - q[2] * r[2] - q[3] * r[3], q[0] * r[1] + q[1] * r[0] + q[2] * r[3] - q[3] * r[2],
      q[0] * r[2] - q[1] * r[3] + q[2] * r[0] + q[3] * r[1], q[0] * r[3] + q[1] * r[2] - q[2] * r[1] + q[3] * r[0]};
  pair.pose_b = *Pose::from_quaternion(product, Vec3::Zero());
  place(pair, depth, random);
  return pair;
}

/// Integer bodies in right-angled poses, touching at two extreme points of an integer direction, or overlapping and
/// apart by whole units; `nudge` ulps of the translation away from it.
PointPair kissing(int n, bool nudged, Random& random) {
  const int range = random.integer(1, 6);
  PointPair pair{integer_points(n, range, random), integer_points(n, range, random), {}, {}};
  if (random.integer(0, 2) == 0) pair.a = box(random.integer_point(1, 4));
  if (random.integer(0, 2) == 0) pair.b = box(random.integer_point(1, 4));
  const Vec3 place_a = random.integer_point(-9, 9);
  pair.pose_a = matrix_pose(right_angles(random), place_a);
  pair.pose_b = matrix_pose(right_angles(random), Vec3::Zero());
  Vec3 d = random.integer_point(-3, 3);
  if (d.squaredNorm() == 0) d = Vec3::UnitZ();
  Vec3 t = pair.pose_a.translation() + extreme(pair.a, pair.pose_a, d) - extreme(pair.b, pair.pose_b, -d);
  if (nudged) {
    const int k = random.integer(0, 2);
    t[k] = random.integer(0, 1) != 0 ? std::nextafter(t[k], 1e3) : std::nextafter(t[k], -1e3);
    if (std::abs(t[k]) < 1e-300) t[k] = random.integer(0, 1) != 0 ? 0x1p-52 : -0x1p-52;
  }
  // A power of two keeps every sum exact.
  const double scale = std::ldexp(1.0, random.integer(-30, 30));
  for (Vec3& p : pair.a) p *= scale;
  for (Vec3& p : pair.b) p *= scale;
  pair.pose_a = moved(pair.pose_a, pair.pose_a.translation() * scale);
  pair.pose_b = moved(pair.pose_b, t * scale);
  return pair;
}

PointPair equal_bodies(int n, DepthClass depth, Random& random) {
  const int kind = random.integer(0, 2);
  Points body = kind == 0 ? box(random_extents(random)) : kind == 1 ? prism(n) : sphere_hull(n, random);
  PointPair pair{body, body, quaternion_pose(random, random.direction()), {}};
  pair.pose_b = pair.pose_a;
  if (depth == DepthClass::mid) {
    std::reverse(pair.b.begin(), pair.b.end());  // the same set in another order
  } else if (depth != DepthClass::deep) {
    place(pair, depth, random);
  }
  return pair;
}

PointPair integer_grid(int n, DepthClass depth, Random& random) {
  const int range = random.integer(1, 8);
  PointPair pair{integer_points(n, range, random), integer_points(n, range, random), {}, {}};
  if (random.integer(0, 1) != 0) pair.a = box(random.integer_point(1, 8));
  const int reach = depth == DepthClass::gap ? 3 * range : depth == DepthClass::deep ? 0 : range;
  const Vec3 t = random.integer_point(-reach, reach);
  pair.pose_a = matrix_pose(right_angles(random), Vec3::Zero());
  pair.pose_b = matrix_pose(right_angles(random), t);
  return pair;
}

PointPair scaled(int n, DepthClass depth, Random& random) {
  static constexpr double kScales[] = {1e-300, 1e-250, 1e-200, 1e-150, 1e-100, 1e-30, 1e-9, 1e9, 1e30, 1e100, 1e150};
  Points b = random.integer(0, 1) != 0 ? box(random_extents(random)) : sphere_hull(n, random);
  PointPair pair = placed(sphere_hull(n, random), std::move(b), depth, random);
  const double scale = kScales[random.integer(0, 10)];
  for (Vec3& p : pair.a) p *= scale;
  for (Vec3& p : pair.b) p *= scale;
  pair.pose_a = moved(pair.pose_a, pair.pose_a.translation() * scale);
  pair.pose_b = moved(pair.pose_b, pair.pose_b.translation() * scale);
  return pair;
}

PointPair far_translation(int n, DepthClass depth, Random& random) {
  static constexpr double kFar[] = {1e3, 1e6, 1e9, 1e12};
  PointPair pair{sphere_hull(n, random), box(random_extents(random)), {}, {}};
  const double far = kFar[random.integer(0, 3)];
  pair.pose_a = quaternion_pose(random, random.direction() * far);
  pair.pose_b = quaternion_pose(random, Vec3::Zero());
  if (random.integer(0, 3) == 0) {
    // Far from its own origin as well.
    const double from_origin = kFar[random.integer(0, 1)];
    const Vec3 shift = random.direction() * from_origin;
    for (Vec3& p : pair.b) p += shift;
  }
  place(pair, depth, random);
  return pair;
}

PointPair single_precision(int n, DepthClass depth, Random& random) {
  Points b = sphere_hull(n, random);
  Points a = random.integer(0, 1) != 0 ? box(random_extents(random)) : sphere_hull(n, random);
  PointPair pair = placed(std::move(a), std::move(b), depth, random);
  for (Vec3& p : pair.a) p = to_single(p);
  for (Vec3& p : pair.b) p = to_single(p);
  pair.pose_a = to_single(pair.pose_a);
  pair.pose_b = to_single(pair.pose_b);
  return pair;
}

/// A small body against one that is up to 1e40 times as large.
PointPair mixed_scales(int n, DepthClass depth, Random& random) {
  static constexpr double kRatios[] = {1e-3, 1e-6, 1e-9, 1e-15, 1e-20, 1e-40};
  PointPair pair{sphere_hull(n, random), box(random_extents(random)), {}, {}};
  const double ratio = kRatios[random.integer(0, 5)];
  for (Vec3& p : random.integer(0, 1) != 0 ? pair.a : pair.b) p *= ratio;
  pair.pose_a = quaternion_pose(random, Vec3::Zero());
  pair.pose_b = quaternion_pose(random, Vec3::Zero());
  place(pair, depth, random);
  return pair;
}

/// Boxes and prisms whose every coordinate is off by an ulp or two: facets nearly coplanar, edges nearly parallel.
PointPair ulp_noise(int n, DepthClass depth, Random& random) {
  PointPair pair{random.integer(0, 1) != 0 ? box(random_extents(random)) : prism(n),
                 random.integer(0, 1) != 0 ? box(random_extents(random)) : prism(n),
                 {},
                 {}};
  for (Points* body : {&pair.a, &pair.b}) {
    for (Vec3& p : *body) {
      for (int k = 0; k < 3; ++k) {
        for (int step = random.integer(0, 2); step > 0; --step) p[k] = std::nextafter(p[k], 2 * random.uniform(-1, 1));
      }
    }
  }
  if (random.integer(0, 1) != 0) {
    pair.pose_a = quaternion_pose(random, random.direction());
    pair.pose_b = *Pose::from_quaternion(pair.pose_a.quaternion_wxyz(), Vec3::Zero());
  }
  place(pair, depth, random);
  return pair;
}

/// A body against itself, turned and moved by almost nothing.
PointPair near_equal(int n, DepthClass depth, Random& random) {
  static constexpr double kSteps[] = {1e-15, 1e-12, 1e-8, 1e-4};
  PointPair pair{sphere_hull(n, random), {}, {}, {}};
  if (depth == DepthClass::shallow) pair.a = box(random_extents(random));
  if (depth == DepthClass::mid) pair.a = prism(n);
  pair.b = pair.a;
  const double step = kSteps[random.integer(0, 3)];
  const Vec3 translation = step * random.direction();
  pair.pose_b = *Pose::from_quaternion(small_rotation(random, step), translation);
  if (depth == DepthClass::gap) place(pair, depth, random);
  return pair;
}

/// Boxes aligned on a grid of eighths.
PointPair cubes(DepthClass depth, Random& random) {
  const auto eighths = [&](int low, int high) { return Vec3(random.integer_point(low, high) / 8.0); };
  PointPair pair;
  pair.a = box(eighths(1, 8));
  pair.b = box(eighths(1, 8));
  pair.pose_b = matrix_pose(Mat3::Identity(), depth == DepthClass::deep ? Vec3(Vec3::Zero()) : eighths(-9, 9));
  return pair;
}

PointPair slivers(int n, DepthClass depth, Random& random) {
  static constexpr double kThickness[] = {1e-3, 1e-6, 1e-9, 1e-12};
  Points a = sliver(n, kThickness[random.integer(0, 3)], random);
  Points b = random.integer(0, 1) != 0 ? sliver(n, kThickness[random.integer(0, 3)], random) : sphere_hull(n, random);
  return placed(std::move(a), std::move(b), depth, random);
}

PointPair polygons(int n, DepthClass depth, Random& random) {
  Points a = polygon(std::max(3, n), random);
  Points b = random.integer(0, 1) != 0 ? polygon(std::max(3, n), random) : sphere_hull(n, random);
  return placed(std::move(a), std::move(b), depth, random);
}

/// A segment against another, a polygon or a body.
PointPair segments(int n, DepthClass depth, Random& random) {
  const Vec3 d = random.direction();
  const int other = random.integer(0, 2);
  Points b = other == 0   ? Points{Vec3(random.direction()), Vec3(random.direction())}
             : other == 1 ? polygon(std::max(3, n), random)
                          : sphere_hull(n, random);
  return placed({-d, d}, std::move(b), depth, random);
}

/// A point against itself, one of the other's points, a polygon or a body.
PointPair points(int n, DepthClass depth, Random& random) {
  Points a = {random.direction()};
  const int other = random.integer(0, 3);
  Points b = other == 0 ? Points{a[0]} : other == 1 ? polygon(std::max(3, n), random) : cloud(n, random);
  PointPair pair{std::move(a), std::move(b), {}, {}};
  if (other == 0) return pair;
  if (other == 3) {
    pair.a = {pair.b[0]};  // often a vertex
    return pair;
  }
  pair.pose_a = quaternion_pose(random, Vec3::Zero());
  pair.pose_b = quaternion_pose(random, Vec3::Zero());
  place(pair, depth, random);
  return pair;
}

/// Two prisms about parallel axes, turned about them: many edges exactly or nearly parallel.
PointPair parallel_edges(int n, DepthClass depth, Random& random) {
  PointPair pair{prism(n), prism(n), {}, {}};
  const Turn t = turn(random.integer(0, 1) != 0 ? random.uniform() : 0.25 * random.integer(0, 3));
  Mat3 m = Mat3::Identity();
  m(0, 0) = m(1, 1) = t.cosine;
  m(1, 0) = t.sine;
  m(0, 1) = -t.sine;
  pair.pose_b = matrix_pose(m, Vec3::Zero());
  place(pair, depth, random);
  return pair;
}

constexpr std::string_view kFamilyNames[] = {"box",
                                             "cubes",
                                             "sphere",
                                             "needle",
                                             "prism",
                                             "grid",
                                             "patch",
                                             "roofs",
                                             "tilted_roofs",
                                             "slivers",
                                             "polygons",
                                             "segments",
                                             "points",
                                             "clouds",
                                             "near_aligned_boxes",
                                             "parallel_edges",
                                             "kissing",
                                             "near_kissing",
                                             "equal_bodies",
                                             "integer_grid",
                                             "scales",
                                             "far_translations",
                                             "single_precision",
                                             "mixed_scales",
                                             "ulp_noise",
                                             "near_equal_bodies"};
static_assert(std::size(kFamilyNames) == kPairFamilies);
constexpr std::string_view kDepthNames[] = {"gap", "shallow", "mid", "deep"};

}  // namespace

std::string_view to_string(PairFamily family) { return kFamilyNames[static_cast<std::size_t>(family)]; }
std::string_view to_string(DepthClass depth) { return kDepthNames[static_cast<std::size_t>(depth)]; }

PointPair make_pair(PairFamily family, int n, DepthClass depth, std::uint64_t seed) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(family) * 1000003 +
                static_cast<std::uint64_t>(depth));
  random.next();
  switch (family) {
    case PairFamily::box:
      return placed([&] { return box(random_extents(random)); }, depth, random);
    case PairFamily::cubes:
      return cubes(depth, random);
    case PairFamily::sphere:
      return placed([&] { return sphere_hull(n, random); }, depth, random);
    case PairFamily::needle:
      return placed([&] { return needle(n, random); }, depth, random);
    case PairFamily::prism:
      return placed(prism(n), prism(n), depth, random);
    case PairFamily::grid:
      return crossed(lens(n, 0.5), lens(n, 0.5), depth, true, random);
    case PairFamily::patch:
      return crossed_roofs(n, {0.5, 0.2, 0}, depth, random);
    case PairFamily::roofs:
      return crossed_roofs(n, {0.1, 0.2, 0}, depth, random);
    case PairFamily::tilted_roofs:
      return crossed_roofs(n, {0.5, 0.2, 0.2}, depth, random);
    case PairFamily::slivers:
      return slivers(n, depth, random);
    case PairFamily::polygons:
      return polygons(n, depth, random);
    case PairFamily::segments:
      return segments(n, depth, random);
    case PairFamily::points:
      return points(n, depth, random);
    case PairFamily::clouds:
      return placed([&] { return cloud(n, random); }, depth, random);
    case PairFamily::near_aligned_boxes:
      return near_aligned(depth, random);
    case PairFamily::parallel_edges:
      return parallel_edges(n, depth, random);
    case PairFamily::kissing:
      return kissing(n, false, random);
    case PairFamily::near_kissing:
      return kissing(n, true, random);
    case PairFamily::equal_bodies:
      return equal_bodies(n, depth, random);
    case PairFamily::integer_grid:
      return integer_grid(n, depth, random);
    case PairFamily::scales:
      return scaled(n, depth, random);
    case PairFamily::far_translations:
      return far_translation(n, depth, random);
    case PairFamily::single_precision:
      return single_precision(n, depth, random);
    case PairFamily::mixed_scales:
      return mixed_scales(n, depth, random);
    case PairFamily::ulp_noise:
      return ulp_noise(n, depth, random);
    case PairFamily::near_equal_bodies:
      return near_equal(n, depth, random);
  }
  return {};
}

}  // namespace pd::scenes
