#include "oracle/grid_pool.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace pd::oracle::grid {

namespace {

using scenes::Random;

Int3 random_point(int units, Random& random) {
  return {random.integer(0, units), random.integer(0, units), random.integer(0, units)};
}

Int3 random_vector(int units, Random& random) {
  const Int3 from = random_point(units, random);
  return random_point(units, random) - from;
}

bool on_grid(const Int3& p, int units) {
  const auto ok = [&](std::int32_t c) { return c >= 0 && c <= units; };
  return ok(p.x) && ok(p.y) && ok(p.z);
}

Int3 times(std::int32_t k, const Int3& v) { return {k * v.x, k * v.y, k * v.z}; }

/// At most `count` points of origin + i u + j v on the grid.
std::vector<Int3> lattice_points(int count, int units, const Int3& origin, const Int3& u, const Int3& v,
                                 Random& random) {
  std::vector<Int3> points{origin};
  for (int tries = 0; tries < 200 && static_cast<int>(points.size()) < count; ++tries) {
    const Int3 along_v = times(random.integer(-units, units), v);
    const Int3 p = origin + times(random.integer(-units, units), u) + along_v;
    if (on_grid(p, units)) points.push_back(p);
  }
  return points;
}

/// One of the coordinate and diagonal directions, or any.
Int3 short_vector(Random& random) {
  return random.integer(0, 2) == 0 ? random_vector(3, random) : random_vector(1, random);
}

std::vector<Int3> box(int units, Random& random) {
  const Int3 p = random_point(units - 1, random);
  const Int3 q{random.integer(p.x + 1, units), random.integer(p.y + 1, units), random.integer(p.z + 1, units)};
  std::vector<Int3> points;
  for (int bits = 0; bits < 8; ++bits) {
    points.push_back({(bits & 1) != 0 ? q.x : p.x, (bits & 2) != 0 ? q.y : p.y, (bits & 4) != 0 ? q.z : p.z});
  }
  return points;
}

/// Three or four points of a plane, and the same moved: upright or leaning.
std::vector<Int3> prism(int units, Random& random) {
  const int corners = random.integer(3, 4);
  for (;;) {
    std::vector<Int3> points;
    for (int k = 0; k < corners; ++k) {
      points.push_back({random.integer(0, units), random.integer(0, units), random.integer(0, units - 1)});
      if (random.integer(0, 3) != 0) points.back().z = points.front().z;
    }
    const Int3 along = random.integer(0, 1) == 0 ? Int3{0, 0, 1} : short_vector(random);
    for (int k = 0; k < corners; ++k) points.push_back(points[static_cast<std::size_t>(k)] + along);
    if (std::all_of(points.begin(), points.end(), [&](const Int3& p) { return on_grid(p, units); })) return points;
  }
}

/// Points of their own, then some that repeat others or lie between them.
std::vector<Int3> hull(int units, Random& random) {
  const int count = random.integer(4, kMostPoints);
  std::vector<Int3> points;
  const auto any = [&] {
    return points[static_cast<std::size_t>(random.integer(0, static_cast<int>(points.size()) - 1))];
  };
  while (static_cast<int>(points.size()) < count) {
    const int how = points.size() < 4 ? 9 : random.integer(0, 9);
    if (how == 0) {
      points.push_back(any());
    } else if (how <= 2) {
      const Int3 end = any();
      const Int3 sum = end + any();
      points.push_back({sum.x / 2, sum.y / 2, sum.z / 2});
    } else if (how == 3) {
      const Int3 opposite = any(), next = any();
      const Int3 p = next + any() - opposite;  // a corner of a parallelogram
      if (on_grid(p, units)) points.push_back(p);
    } else {
      points.push_back(random_point(units, random));
    }
  }
  return points;
}

std::vector<Int3> points_of(Kind kind, int units, Random& random) {
  switch (kind) {
    case Kind::point: {
      const Int3 point = random_point(units, random);
      return std::vector<Int3>(static_cast<std::size_t>(random.integer(1, 3)), point);
    }
    case Kind::segment: {
      const Int3 along = short_vector(random);
      const Int3 origin = random_point(units, random);
      return lattice_points(random.integer(2, 5), units, origin, along, Int3{}, random);
    }
    case Kind::polygon: {
      const Int3 v = short_vector(random), u = short_vector(random);
      const Int3 origin = random_point(units, random);
      return lattice_points(random.integer(3, kMostPoints), units, origin, u, v, random);
    }
    case Kind::tetrahedron:
      return {random_point(units, random), random_point(units, random), random_point(units, random),
              random_point(units, random)};
    case Kind::box:
      return box(units, random);
    case Kind::prism:
      return prism(units, random);
    case Kind::hull:
      break;
  }
  return hull(units, random);
}

ConvexShape shape_of(const std::vector<Int3>& points) {
  std::vector<Vec3> vertices;
  for (const Int3& p : points) vertices.push_back(p.to_vec3());
  const auto built = ConvexPolytope::from_points(vertices);
  if (!built) throw std::runtime_error("hull refused: " + built.error().message);
  return ConvexShape(*built);
}

Kind kind_of(Kind made, const Body& body) {
  static constexpr Kind kFlat[] = {Kind::point, Kind::segment, Kind::polygon};
  if (body.dimension < 3) return kFlat[body.dimension];
  return body.vertices.size() == 4 ? Kind::tetrahedron : made;
}

/// The rotation of a pose: as a quaternion where its numbers are halves, by `as_quaternion`, else as a matrix.
Pose pose_of(const Placement& at, bool as_quaternion) {
  const Vec3 t(static_cast<double>(at.translation[0]), static_cast<double>(at.translation[1]),
               static_cast<double>(at.translation[2]));
  const Mat3 m = axis_rotations()[static_cast<std::size_t>(at.rotation)].matrix();
  if (as_quaternion && m.trace() == 0) {  // a third of a turn about a diagonal
    const auto pose =
        Pose::from_quaternion({0.5, (m(2, 1) - m(1, 2)) / 2, (m(0, 2) - m(2, 0)) / 2, (m(1, 0) - m(0, 1)) / 2}, t);
    if (!pose) throw std::runtime_error("pose refused: " + pose.error().message);
    return *pose;
  }
  const auto pose = Pose::from_matrix(m, t);
  if (!pose) throw std::runtime_error("pose refused: " + pose.error().message);
  return *pose;
}

struct Range {
  std::array<int, 3> low;
  std::array<int, 3> high;
};
Range range_of(const Body& body, int rotation) {
  Range r{{99, 99, 99}, {-99, -99, -99}};
  for (const Int3& v : body.vertices) {
    const Int3 p = axis_rotations()[static_cast<std::size_t>(rotation)].apply(v);
    const std::array<int, 3> c{p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      r.low[k] = std::min(r.low[k], c[k]);
      r.high[k] = std::max(r.high[k], c[k]);
    }
  }
  return r;
}

using Json = nlohmann::ordered_json;

Json json_of(const Body& body) {
  Json vertices = Json::array();
  for (const Int3& p : body.points) vertices.push_back({p.x, p.y, p.z});
  return {{"type", "convex"}, {"vertices", std::move(vertices)}};
}

Json json_of(const Placement& at, const Pose& pose) {
  Json j = {{"translation", {at.translation[0], at.translation[1], at.translation[2]}}};
  if (pose.is_quaternion()) {
    j["quaternion_wxyz"] = pose.quaternion_wxyz();
    return j;
  }
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rows.push_back(static_cast<int>(pose.rotation()(row, column)));
  }
  j["rotation_row_major"] = std::move(rows);
  return j;
}

constexpr std::string_view kKindNames[] = {"point", "segment", "polygon", "tetrahedron", "box", "prism", "hull"};
static_assert(std::size(kKindNames) == kKinds);

}  // namespace

std::string_view to_string(Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

Pool::Pool(int size, std::uint64_t seed) {
  Random random(seed * 0x9E3779B97F4A7C15ULL + 1);
  for (int i = 0; i < size; ++i) {
    const auto made = static_cast<Kind>(i % kKinds);
    const int units = random.integer(2, kMostUnits);
    std::vector<Int3> points = points_of(made, units, random);
    for (std::size_t k = points.size(); k-- > 1;) {
      std::swap(points[k], points[static_cast<std::size_t>(random.integer(0, static_cast<int>(k)))]);
    }
    Body body = make_body(points);
    std::vector<Int3> other(points.rbegin(), points.rend());
    std::rotate(other.begin(), other.begin() + random.integer(0, static_cast<int>(other.size()) - 1), other.end());
    const Kind kind = kind_of(made, body);
    bodies_.push_back({kind, std::move(body), shape_of(points), shape_of(other)});
  }
}

DrawnPair Pool::draw(std::uint64_t seed, std::int64_t i) const {
  Random random(seed * 0xD1B54A32D192ED03ULL + static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15ULL);
  random.next();
  const int last = static_cast<int>(bodies_.size()) - 1;
  const PooledBody& a = bodies_[static_cast<std::size_t>(random.integer(0, last))];
  const bool twins = random.integer(0, 15) == 0;
  const PooledBody& b = twins ? a : bodies_[static_cast<std::size_t>(random.integer(0, last))];
  Placement at_a;
  Placement at_b;
  at_a.rotation = random.integer(0, kAxisRotations - 1);
  at_b.rotation = twins && random.integer(0, 1) == 0 ? at_a.rotation : random.integer(0, kAxisRotations - 1);
  const bool far = random.integer(0, 15) == 0;
  const int far_exponent = random.integer(4, 39);
  const Range range_a = range_of(a.body, at_a.rotation);
  const Range range_b = range_of(b.body, at_b.rotation);
  const bool near_middle = random.integer(0, 3) != 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t reach = far ? std::int64_t{1} << far_exponent : 2;
    at_a.translation[k] = static_cast<std::int64_t>(static_cast<double>(reach) * random.uniform(-1, 1));
    int low = range_a.low[k] - range_b.high[k] - 1;
    int high = range_a.high[k] - range_b.low[k] + 1;
    if (near_middle) {
      const int quarter = (high - low + 3) / 4;
      low += quarter;
      high -= quarter;
    }
    at_b.translation[k] = at_a.translation[k] + random.integer(low, high);
  }
  const bool as_quaternion = random.integer(0, 1) == 0;
  return {&a, &b, {&a.body, at_a}, {&b.body, at_b}, pose_of(at_a, as_quaternion), pose_of(at_b, as_quaternion)};
}

std::string protocol_line(const DrawnPair& pair) {
  return Json{{"query", "depth"},
              {"a", json_of(*pair.placed_a.body)},
              {"pose_a", json_of(pair.placed_a.at, pair.pose_a)},
              {"b", json_of(*pair.placed_b.body)},
              {"pose_b", json_of(pair.placed_b.at, pair.pose_b)}}
      .dump();
}

}  // namespace pd::oracle::grid
