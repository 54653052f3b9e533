#include "bench/pairs/pair_source.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/agarwal_families.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {

namespace {

using scenes::DepthClass;
using scenes::PairFamily;

struct Sizes {
  PairFamily family;
  std::vector<int> all;
  std::vector<int> quick;
  Variant variant = Variant::own;

  [[nodiscard]] std::string_view name() const { return name_of({family, 0, DepthClass::deep, variant}); }
};

/// Boxes have 8 vertices whatever is asked for.
const std::vector<Sizes>& known() {
  static const std::vector<Sizes> sizes = {
      {PairFamily::box, {8}, {8}},
      {PairFamily::cubes, {8}, {8}},
      {PairFamily::sphere, {8, 32, 128, 512, 2048}, {8, 32, 128}},
      {PairFamily::needle, {8, 32, 128, 512}, {128}},
      {PairFamily::prism, {32, 128, 512}, {128}},
      {PairFamily::grid, {8, 32, 128, 512}, {128}},
      {PairFamily::roofs, {32, 128, 512}, {32}},
      {PairFamily::roofs, {8, 32, 128, 512}, {}, Variant::jittered},
      {PairFamily::sphere, {32, 128, 512, 2048}, {}, Variant::ellipsoid},
      {PairFamily::sphere, {8, 32, 128, 512}, {}, Variant::flat},
      {PairFamily::cubes, {8}, {}, Variant::nearly_aligned},
      {PairFamily::cubes, {8}, {}, Variant::resting},
  };
  return sizes;
}

bool holds(const std::vector<int>& values, int value) {
  return values.empty() || std::find(values.begin(), values.end(), value) != values.end();
}

Draw aligned_cubes(const Cell& cell, std::uint64_t seed, std::uint64_t number) {
  const DepthClass depth = cell.depth;
  scenes::Random random(seed * 0x9E3779B97F4A7C15ULL + number * 0xD1B54A32D192ED03ULL + 17);
  const auto extents = [&] { return Vec3(random.integer_point(1, 8) / 8.0); };
  const Vec3 a = extents();
  const Vec3 b = extents();
  Vec3 offset = Vec3::Zero();
  if (depth != DepthClass::deep) {
    const double overlap = depth == DepthClass::shallow ? 1.0 / 64 : 1.0 / 8;
    const int axis = random.integer(0, 2);
    for (int k = 0; k < 3; ++k) {
      // The other two axes overlap by more, so that this one is the way out.
      const int room = static_cast<int>(8 * (a[k] + b[k])) - 1;
      offset[k] = k == axis ? a[k] + b[k] - overlap : random.integer(-room, room) / 8.0;
    }
    if (random.integer(0, 1) != 0) offset[axis] = -offset[axis];
  }
  Draw d{{ConvexShape(*ConvexPolytope::box(a)), ConvexShape(*ConvexPolytope::box(b))},
         Pose(),
         Pose::from_trusted_matrix(Mat3::Identity(), offset)};
  if (cell.variant == Variant::nearly_aligned) {
    const Vec3 half_turn = 5e-8 * random.direction();
    d.pose_b = *Pose::from_quaternion({1, half_turn.x(), half_turn.y(), half_turn.z()}, offset);
  }
  return d;
}

/// A lies on B, anywhere on its upper face but for its rim.
Draw boxes_at_rest(const Cell& cell, std::uint64_t seed, std::uint64_t number) {
  scenes::Random random(seed * 0x9E3779B97F4A7C15ULL + number * 0xD1B54A32D192ED03ULL + 29);
  const auto extents = [&] { return random.point(0.1, 1); };
  const Vec3 a = extents();
  const Vec3 b = extents();
  const double sunk = cell.depth == DepthClass::shallow ? 1e-6 : cell.depth == DepthClass::mid ? 1e-4 : 1e-2;
  const double y = random.uniform(-0.9, 0.9) * b.y();
  const Vec3 place(random.uniform(-0.9, 0.9) * b.x(), y, a.z() + b.z() - sunk);
  const double t = random.uniform(-1, 1), length = std::hypot(1, t);
  return {{ConvexShape(*ConvexPolytope::box(a)), ConvexShape(*ConvexPolytope::box(b))},
          *Pose::from_quaternion({1 / length, 0, 0, t / length}, place),
          Pose()};
}

Draw crossed_roofs(const Cell& cell, std::uint64_t seed, std::uint64_t number) {
  const double overlap = cell.depth == DepthClass::shallow ? 0.01 : cell.depth == DepthClass::mid ? 0.1 : 1;
  const auto make = cell.variant == Variant::jittered ? scenes::jittered_roofs : scenes::crossed_roofs;
  const scenes::PolytopePair pair =
      make(cell.vertices, overlap, seed * 0x9E3779B97F4A7C15ULL + number * 0xD1B54A32D192ED03ULL);
  return {{ConvexShape(pair.a), ConvexShape(pair.b)}, pair.pose_a, pair.pose_b};
}

/// What is parallel stays so to the last bit where both rotations are by right angles.
void turn(Draw& draw, const std::array<double, 4>& quaternion) {
  const Mat3 rotation = Pose::from_quaternion(quaternion, Vec3::Zero())->rotation();
  for (Pose* pose : {&draw.pose_a, &draw.pose_b}) {
    *pose = Pose::from_trusted_matrix(rotation * pose->rotation(), rotation * pose->translation());
  }
}

/// Moves a body's points into a random frame, rounds them to single precision and moves the pose back. False if they
/// make no body.
bool store_as_file(ConvexShape& shape, Pose& pose, scenes::Random& random) {
  const Mat3 turn = Pose::from_quaternion(random.quaternion(), Vec3::Zero())->rotation();
  const Vec3 shift = random.point(-1, 1);
  scenes::Points points = vertices_of(shape);
  for (Vec3& p : points) p = scenes::to_single(Vec3(turn * p + shift));
  const auto stored = ConvexPolytope::from_points(points);
  if (!stored) return false;
  shape = ConvexShape(*stored);
  const Mat3 rotation = pose.rotation() * turn.transpose();
  pose = Pose::from_trusted_matrix(rotation, pose.translation() - rotation * shift);
  return true;
}

}  // namespace

std::string_view name_of(const Cell& cell) {
  switch (cell.variant) {
    case Variant::own:
      return scenes::to_string(cell.family);
    case Variant::jittered:
      return "jittered_roofs";
    case Variant::ellipsoid:
      return "ellipsoid";
    case Variant::flat:
      return "flat";
    case Variant::nearly_aligned:
      return "cubes1e-7";
    case Variant::resting:
      return "resting";
  }
  return {};
}

Vec3 extreme(const ConvexShape& shape, const Mat3& rotation, const Vec3& direction) {
  const scenes::Points points = vertices_of(shape);
  const Vec3 local = rotation.transpose() * direction;
  return rotation * *std::max_element(points.begin(), points.end(),
                                      [&](const Vec3& p, const Vec3& q) { return p.dot(local) < q.dot(local); });
}

Extent extent_of(const scenes::Points& points) {
  Vec3 low = points[0];
  Vec3 high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {0.5 * (low + high), high - low};
}

Draw placed(const Bodies& bodies, double size, DepthClass depth, scenes::Random& random) {
  const Pose a = random.pose(Vec3::Zero());
  const Pose b = random.pose(Vec3::Zero());
  const Vec3 d = random.direction();
  Vec3 t;
  if (depth == DepthClass::deep) {
    t = a.apply(extent_of(vertices_of(bodies.a)).middle) - b.apply(extent_of(vertices_of(bodies.b)).middle) +
        1e-3 * size * d;
  } else {
    const double share = depth == DepthClass::shallow ? 0.01 : 0.1;
    t = extreme(bodies.a, a.rotation(), d) - extreme(bodies.b, b.rotation(), -d) - share * size * d;
  }
  return {bodies, a, *Pose::from_quaternion(b.quaternion_wxyz(), t)};
}

Expected<std::vector<Cell>> choose_cells(const std::vector<std::string>& families, const std::vector<int>& vertices,
                                         bool quick) {
  for (const std::string& name : families) {
    const bool there = std::any_of(known().begin(), known().end(), [&](const Sizes& s) { return s.name() == name; });
    if (!there) {
      return Error{ErrorCode::bad_value, "no family of this name: " + name, "--families"};
    }
  }
  std::vector<Cell> cells;
  for (const Sizes& s : known()) {
    const std::string name(s.name());
    if (!families.empty() && std::find(families.begin(), families.end(), name) == families.end()) continue;
    const bool fixed = s.all.size() == 1;
    // Quick leaves out what it has no size of.
    const std::vector<int>& sizes = !vertices.empty() && !fixed ? vertices : quick ? s.quick : s.all;
    for (const int n : sizes) {
      if (!holds(vertices, n)) continue;
      for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
        cells.push_back({s.family, n, depth, s.variant});
      }
    }
  }
  if (cells.empty()) return Error{ErrorCode::bad_value, "no pair has this family and size", "--vertices"};
  return cells;
}

std::optional<Draw> draw(const Cell& cell, std::uint64_t seed, std::uint64_t number) {
  if (cell.from_files) {
    Cell own = cell;
    own.from_files = false;
    std::optional<Draw> d = draw(own, seed, number);
    scenes::Random random(seed * 0x9E3779B97F4A7C15ULL + number * 0xD1B54A32D192ED03ULL + 31);
    if (!d || !store_as_file(d->bodies.a, d->pose_a, random) || !store_as_file(d->bodies.b, d->pose_b, random)) {
      return std::nullopt;
    }
    return d;
  }
  if (cell.turned &&
      (cell.family == PairFamily::cubes || cell.family == PairFamily::roofs || cell.family == PairFamily::grid)) {
    Cell upright = cell;
    upright.turned = false;
    std::optional<Draw> d = draw(upright, seed, number);
    if (d) turn(*d, scenes::Random(seed * 0x9E3779B97F4A7C15ULL + number * 0xD1B54A32D192ED03ULL + 23).quaternion());
    return d;
  }
  if (cell.variant == Variant::resting) return boxes_at_rest(cell, seed, number);
  if (cell.family == PairFamily::cubes) return aligned_cubes(cell, seed, number);
  if (cell.family == PairFamily::roofs) return crossed_roofs(cell, seed, number);
  scenes::PointPair pair = scenes::make_pair(cell.family, cell.vertices, cell.depth, seed * 1000003 + number);
  const bool pressed = cell.variant == Variant::ellipsoid || cell.variant == Variant::flat;
  if (pressed) {
    const Vec3 semi_axes = cell.variant == Variant::flat ? Vec3(1, 1, 0.01) : Vec3(1, 0.5, 0.25);
    for (scenes::Points* points : {&pair.a, &pair.b}) {
      for (Vec3& p : *points) p = semi_axes.cwiseProduct(p);
    }
  }
  const auto a = ConvexPolytope::from_points(pair.a);
  const auto b = ConvexPolytope::from_points(pair.b);
  if (!a || !b) return std::nullopt;
  Draw d{{ConvexShape(*a), ConvexShape(*b)}, pair.pose_a, pair.pose_b};
  // Lenses of four corners lie on one side of their origin: the scenes' own deep place only makes them touch.
  if (cell.family == PairFamily::grid && cell.vertices == 8 && cell.depth == DepthClass::deep) {
    const Vec3 t = d.pose_a.apply(extent_of(pair.a).middle) - d.pose_b.rotation() * extent_of(pair.b).middle;
    d.pose_b = Pose::from_trusted_matrix(d.pose_b.rotation(), t);
  }
  if (cell.family != PairFamily::needle && !pressed) return d;
  scenes::Random random(seed + number * 0xD1B54A32D192ED03ULL);
  return placed(d.bodies, extent_of(pair.a).size.minCoeff(), cell.depth, random);
}

}  // namespace pd::bench
