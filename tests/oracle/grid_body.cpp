#include "oracle/grid_body.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

namespace pd::oracle::grid {

namespace {

void insert_once(std::vector<Int3>& set, const Int3& v) {
  if (std::find(set.begin(), set.end(), v) == set.end()) set.push_back(v);
}

/// The half-space that holds all points, its boundary through one of them across `normal`; false where there is none.
bool supports(const std::vector<Int3>& points, const Int3& normal, const Int3& through) {
  return std::all_of(points.begin(), points.end(),
                     [&](const Int3& p) { return dot(normal, p) <= dot(normal, through); });
}

void insert_half_space(Body& body, const Int3& normal, const Int3& through) {
  const HalfSpace h{normal, dot(normal, through)};
  const auto same = [&](const HalfSpace& other) { return other.normal == h.normal; };
  if (std::none_of(body.inside.begin(), body.inside.end(), same)) body.inside.push_back(h);
}

/// The rank of vectors.
int rank(const std::vector<Int3>& vectors) {
  Int3 first;
  Int3 normal;
  for (const Int3& v : vectors) {
    if (first.is_zero()) first = v;
    if (normal.is_zero()) normal = cross(first, v);
    if (dot(normal, v) != 0) return 3;
  }
  return first.is_zero() ? 0 : (normal.is_zero() ? 1 : 2);
}

/// Normals of the half-spaces whose boundary holds all the given points.
std::vector<Int3> normals_at(const Body& body, std::initializer_list<Int3> points) {
  std::vector<Int3> normals;
  for (const HalfSpace& h : body.inside) {
    const auto on = [&](const Int3& p) { return dot(h.normal, p) == h.offset; };
    if (std::all_of(points.begin(), points.end(), on)) normals.push_back(h.normal);
  }
  return normals;
}

/// Planes through three of the points that have all points on one side.
void find_half_spaces_of_solid(Body& body, const std::vector<Int3>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const Int3 c = cross(points[j] - points[i], points[k] - points[i]);
        if (c.is_zero()) continue;
        for (const Int3& n : {primitive(c), -primitive(c)}) {
          if (supports(points, n, points[i])) insert_half_space(body, n, points[i]);
        }
      }
    }
  }
  for (const HalfSpace& h : body.inside) body.normals.push_back(h.normal);
}

/// The plane from both sides, and in it the lines through two of the points that have all points on one side.
void find_half_spaces_of_polygon(Body& body, const std::vector<Int3>& points) {
  Int3 normal;
  for (const Int3& p : points) {
    for (const Int3& q : points) {
      if (normal.is_zero()) normal = cross(p - points[0], q - points[0]);
    }
  }
  normal = primitive(normal);
  body.normals = {normal, -normal};
  for (const Int3& n : body.normals) insert_half_space(body, n, points[0]);
  for (const Int3& p : points) {
    for (const Int3& q : points) {
      if (p == q) continue;
      const Int3 m = primitive(cross(q - p, normal));
      if (supports(points, m, p)) insert_half_space(body, m, p);
    }
  }
}

/// A line from two sides twice, and its ends. For a point: the three axes.
void find_half_spaces_of_line(Body& body, const std::vector<Int3>& points, const Int3& along) {
  const Int3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Int3> across;
  for (const Int3& axis : axes) {
    const Int3 n = along.is_zero() ? axis : cross(along, axis);
    if (!n.is_zero()) across.push_back(primitive(n));
  }
  if (!along.is_zero()) across.push_back(primitive(along));
  for (const Int3& n : across) {
    for (const Int3& p : points) {
      if (supports(points, n, p)) insert_half_space(body, n, p);
      if (supports(points, -n, p)) insert_half_space(body, -n, p);
    }
  }
}

}  // namespace

Int3 primitive(const Int3& v) {
  const std::int32_t divisor = std::gcd(std::gcd(v.x, v.y), v.z);
  return {v.x / divisor, v.y / divisor, v.z / divisor};
}

Body make_body(std::span<const Int3> given) {
  const auto off_grid = [](std::int32_t c) { return c < 0 || c > kMostUnits; };
  if (given.empty() || given.size() > kMostPoints) throw std::invalid_argument("1 to 8 points make a grid body");
  Body body;
  body.points.assign(given.begin(), given.end());
  std::vector<Int3> points;
  for (const Int3& p : given) {
    if (off_grid(p.x) || off_grid(p.y) || off_grid(p.z)) throw std::invalid_argument("a point off the grid");
    insert_once(points, p);
  }
  std::vector<Int3> differences;
  for (const Int3& p : points) differences.push_back(p - points[0]);
  body.dimension = rank(differences);
  switch (body.dimension) {
    case 3:
      find_half_spaces_of_solid(body, points);
      break;
    case 2:
      find_half_spaces_of_polygon(body, points);
      break;
    default:
      find_half_spaces_of_line(body, points, differences.back());
  }
  // A face of dimension d lies on boundaries whose normals span 3 - d dimensions.
  for (const Int3& p : points) {
    if (rank(normals_at(body, {p})) == 3) body.vertices.push_back(p);
  }
  for (std::size_t i = 0; i < body.vertices.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Int3& p = body.vertices[i];
      const Int3& q = body.vertices[j];
      if (rank(normals_at(body, {p, q})) != 2) continue;
      const Int3 d = primitive(p - q);
      insert_once(body.directions, std::max(d, -d));
    }
  }
  return body;
}

Mat3 AxisRotation::matrix() const {
  Mat3 m = Mat3::Zero();
  for (int row = 0; row < 3; ++row) {
    m(row, axis[static_cast<std::size_t>(row)]) = sign[static_cast<std::size_t>(row)];
  }
  return m;
}

const std::array<AxisRotation, kAxisRotations>& axis_rotations() {
  static const std::array<AxisRotation, kAxisRotations> all = [] {
    std::array<AxisRotation, kAxisRotations> found{};
    std::size_t count = 0;
    std::array<int, 3> axis{0, 1, 2};
    do {
      for (int bits = 0; bits < 8; ++bits) {
        const AxisRotation r{axis, {bits & 1 ? -1 : 1, bits & 2 ? -1 : 1, bits & 4 ? -1 : 1}};
        if (r.matrix().determinant() > 0) found[count++] = r;
      }
    } while (std::next_permutation(axis.begin(), axis.end()));
    return found;
  }();
  return all;
}

}  // namespace pd::oracle::grid
