#include "oracle/body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

namespace pd::oracle {

/// A triangle of the growing surface; neighbour[i] lies across corner[i] -> corner[i + 1].
struct Body::Face {
  int corner[3];
  int neighbour[3];
};

namespace {

/// A point in long double, relative error 2^-63 in each coordinate, |coordinate| <= 1.
struct Fine {
  long double x, y, z;
};
Fine operator-(const Fine& a, const Fine& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
long double norm(const Fine& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
Vec3 divided(const Fine& v, long double s) {
  return {static_cast<double>(v.x / s), static_cast<double>(v.y / s), static_cast<double>(v.z / s)};
}
/// The unit vector within 2^-50, or false where the difference has lost too many bits: it errs by 2^-61.
bool unit_of(const Fine& v, Vec3& unit) {
  const long double length = norm(v);
  if (!(length > 0x1p-9L)) return false;
  unit = divided(v, length);
  return true;
}
/// The same for a cross product: each factor errs by 2^-61, the product by less than 2^-59 (|u| + |v|).
bool unit_cross(const Fine& u, const Fine& v, Vec3& unit) {
  const Fine n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  const long double length = norm(n);
  if (!(length > 0x1p-7L * (norm(u) + norm(v)))) return false;
  unit = divided(n, length);
  return true;
}

/// Sign of the orientation of 2D points by dropping the axis in which `normal` is not zero.
Integer planar_area(const IVec& a, const IVec& b, const IVec& c, const IVec& normal) {
  return dot(cross(b - a, c - a), normal);
}

}  // namespace

// Sign of det(b - a, c - a, d - a): > 0 when d lies above the plane of a, b, c seen counter-clockwise.
int Body::orientation(int a, int b, int c, int d) const {
  const Vec3 u = relative[b] - relative[a];
  const Vec3 v = relative[c] - relative[a];
  const Vec3 w = relative[d] - relative[a];
  const double det = u.cross(v).dot(w);
  // |relative| <= 1 with error 2^-52, so each difference is at most 2 with error 2^-50.4; six products of three factors
  // err by less than 6 * 3 * 4 * 2^-50.4 + 6 * 8 * 5 * 2^-53 < 2^-43.
  if (std::abs(det) > 0x1p-42) return det > 0 ? 1 : -1;
  return dot(cross(exact[b] - exact[a], exact[c] - exact[a]), exact[d] - exact[a]).sign();
}

Body::Body(std::span<const Vec3> points) : reference(points[0]) {
  std::vector<Scaled> coordinates;
  coordinates.reserve(points.size() * 3);
  const Scaled origin[3] = {to_scaled(points[0].x()), to_scaled(points[0].y()), to_scaled(points[0].z())};
  bool any = false;
  for (const Vec3& p : points) {
    for (int k = 0; k < 3; ++k) {
      coordinates.push_back(to_scaled(p[k]) - origin[k]);
      const Scaled& s = coordinates.back();
      if (!s.mantissa.is_zero()) {
        const int low =
            s.exponent + static_cast<int>(boost::multiprecision::lsb(boost::multiprecision::abs(s.mantissa)));
        exponent = any ? std::min(exponent, low) : low;
        any = true;
      }
    }
  }
  const auto integer = [&](const Scaled& s) {
    if (s.mantissa.is_zero()) return Integer(0);
    const int left = s.exponent - exponent;
    return left >= 0 ? Integer(s.mantissa << left) : Integer(s.mantissa >> -left);
  };
  int top = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    exact.push_back({integer(coordinates[3 * i]), integer(coordinates[3 * i + 1]), integer(coordinates[3 * i + 2])});
    for (const Integer* c : {&exact.back().x, &exact.back().y, &exact.back().z}) {
      if (!c->is_zero()) {
        top = std::max(top, static_cast<int>(boost::multiprecision::msb(boost::multiprecision::abs(*c))) + 1);
      }
    }
  }
  scale_exponent = exponent + top;
  for (const IVec& p : exact) relative.emplace_back(to_double(p.x, -top), to_double(p.y, -top), to_double(p.z, -top));

  int start[4] = {0, -1, -1, -1};
  const int n = static_cast<int>(points.size());
  for (int i = 1; i < n && start[1] < 0; ++i) {
    if (!is_zero(exact[i])) start[1] = i;
  }
  for (int i = 1; i < n && start[1] >= 0 && start[2] < 0; ++i) {
    if (!is_zero(cross(exact[start[1]], exact[i]))) start[2] = i;
  }
  for (int i = 1; i < n && start[2] >= 0 && start[3] < 0; ++i) {
    if (orientation(0, start[1], start[2], i) != 0) start[3] = i;
  }
  dimension = start[1] < 0 ? 0 : start[2] < 0 ? 1 : start[3] < 0 ? 2 : 3;
  if (dimension == 3) {
    build_solid(start);
  } else {
    build_flat();
  }
  finish();
}

void Body::build_flat() {
  const int n = static_cast<int>(exact.size());
  if (dimension == 0) {
    vertices = {0};
    return;
  }
  if (dimension == 1) {
    IVec along;
    for (int i = 1; i < n && is_zero(along); ++i) along = exact[i];
    int low = 0;
    int high = 0;
    for (int i = 1; i < n; ++i) {
      if (dot(exact[i], along) < dot(exact[low], along)) low = i;
      if (dot(exact[i], along) > dot(exact[high], along)) high = i;
    }
    edges.push_back({low, high, -1, -1, 0});
    return;
  }
  // Gift wrapping in the plane: from the lexicographically least point, always the most clockwise next one, the
  // farthest of collinear ones.
  IVec normal;
  for (int i = 1; i < n && is_zero(normal); ++i) {
    for (int j = 1; j < i && is_zero(normal); ++j) normal = cross(exact[j], exact[i]);
  }
  int first = 0;
  const auto less = [&](int i, int j) {
    return std::tie(exact[i].x, exact[i].y, exact[i].z) < std::tie(exact[j].x, exact[j].y, exact[j].z);
  };
  for (int i = 1; i < n; ++i) {
    if (less(i, first)) first = i;
  }
  std::vector<int> loop;
  int current = first;
  do {
    loop.push_back(current);
    int next = -1;
    for (int i = 0; i < n; ++i) {
      if (is_zero(exact[i] - exact[current])) continue;
      if (next < 0) {
        next = i;
        continue;
      }
      const int side = planar_area(exact[current], exact[next], exact[i], normal).sign();
      const IVec to_i = exact[i] - exact[current];
      const IVec to_next = exact[next] - exact[current];
      if (side < 0 || (side == 0 && dot(to_i, to_i) > dot(to_next, to_next))) next = i;
    }
    current = next;
  } while (!is_zero(exact[current] - exact[first]));
  const int count = static_cast<int>(loop.size());
  facets.push_back({{loop[0], loop[1], loop[2]}, Vec3::Zero()});
  facets.push_back({{loop[0], loop[2], loop[1]}, Vec3::Zero()});
  for (int i = 0; i < count; ++i) edges.push_back({loop[i], loop[(i + 1) % count], 0, 1, 0});
  for (int i = 1; i + 1 < count; ++i) {
    triangles.push_back({{loop[0], loop[i], loop[i + 1]}, 0});
    triangles.push_back({{loop[0], loop[i + 1], loop[i]}, 1});
  }
}

/// Adds a point to the hull. It sees a face only strictly: coplanar points then extend a facet by coplanar triangles
/// (their horizon edge is never collinear with the point, because the visible face beside it is not coplanar with it).
void Body::insert_point(int p, std::vector<Face>& faces, std::vector<int>& alive) const {
  std::vector<char> visible(faces.size(), 0);
  bool outside = false;
  for (const int f : alive) {
    visible[f] = orientation(faces[f].corner[0], faces[f].corner[1], faces[f].corner[2], p) > 0;
    outside = outside || visible[f];
  }
  if (!outside) return;
  std::map<int, int> starting_at;  // horizon vertex -> new face whose horizon edge leaves it
  std::vector<int> created;
  for (const int f : alive) {
    if (!visible[f]) continue;
    for (int k = 0; k < 3; ++k) {
      const int other = faces[f].neighbour[k];
      if (visible[other]) continue;
      const int from = faces[f].corner[k];
      const int to = faces[f].corner[(k + 1) % 3];
      const int index = static_cast<int>(faces.size());
      faces.push_back({{from, to, p}, {other, -1, -1}});
      for (int& back : faces[other].neighbour) {
        if (back == f && faces[other].corner[&back - faces[other].neighbour] == to) back = index;
      }
      starting_at[from] = index;
      created.push_back(index);
    }
  }
  for (const int f : created) {
    const int next = starting_at.at(faces[f].corner[1]);
    faces[f].neighbour[1] = next;
    faces[next].neighbour[2] = f;
  }
  std::erase_if(alive, [&](int f) { return visible[f] != 0; });
  alive.insert(alive.end(), created.begin(), created.end());
}

/// Adds one facet for each set of coplanar neighbours. @return [faces] the facet of each.
std::vector<int> Body::merge_coplanar(const std::vector<Face>& faces, const std::vector<int>& alive) {
  std::vector<int> facet_of(faces.size(), -1);
  for (const int seed : alive) {
    if (facet_of[seed] >= 0) continue;
    const int id = static_cast<int>(facets.size());
    const int* c = faces[seed].corner;
    facets.push_back({{c[0], c[1], c[2]}, Vec3::Zero()});
    std::vector<int> stack = {seed};
    facet_of[seed] = id;
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (const int g : faces[f].neighbour) {
        if (facet_of[g] >= 0) continue;
        const bool coplanar = std::all_of(faces[g].corner, faces[g].corner + 3,
                                          [&](int v) { return orientation(c[0], c[1], c[2], v) == 0; });
        if (coplanar) {
          facet_of[g] = id;
          stack.push_back(g);
        }
      }
    }
  }
  return facet_of;
}

/// Incremental hull from a tetrahedron.
void Body::build_solid(const int (&start)[4]) {
  std::vector<Face> faces;
  int t[4] = {start[0], start[1], start[2], start[3]};
  if (orientation(t[0], t[1], t[2], t[3]) > 0) std::swap(t[1], t[2]);
  faces.push_back({{t[0], t[1], t[2]}, {1, 2, 3}});
  faces.push_back({{t[1], t[0], t[3]}, {0, 3, 2}});
  faces.push_back({{t[2], t[1], t[3]}, {0, 1, 3}});
  faces.push_back({{t[0], t[2], t[3]}, {0, 2, 1}});
  std::vector<int> alive = {0, 1, 2, 3};
  for (int p = 0; p < static_cast<int>(exact.size()); ++p) {
    if (std::find(std::begin(start), std::end(start), p) == std::end(start)) insert_point(p, faces, alive);
  }
  const std::vector<int> facet_of = merge_coplanar(faces, alive);
  for (const int f : alive) {
    const int* c = faces[f].corner;
    triangles.push_back({{c[0], c[1], c[2]}, facet_of[f]});
    for (int k = 0; k < 3; ++k) {
      const int g = faces[f].neighbour[k];
      if (f < g && facet_of[f] != facet_of[g]) edges.push_back({c[k], c[(k + 1) % 3], facet_of[f], facet_of[g], 0});
    }
  }
}

void Body::finish() {
  std::vector<Fine> fine;
  const int top = scale_exponent - exponent;
  for (const IVec& p : exact) {
    fine.push_back({to_long_double(p.x, -top), to_long_double(p.y, -top), to_long_double(p.z, -top)});
  }
  for (Facet& f : facets) {
    const int* c = f.corner;
    if (unit_cross(fine[c[1]] - fine[c[0]], fine[c[2]] - fine[c[0]], f.unit_normal)) continue;
    f.unit_normal = to_unit(cross(exact[c[1]] - exact[c[0]], exact[c[2]] - exact[c[0]]));
  }
  std::multimap<double, int> known;  // |x| of a class's unit vector -> class
  for (Edge& e : edges) {
    vertices.push_back(e.from);
    vertices.push_back(e.to);
    Vec3 unit;
    if (!unit_of(fine[e.to] - fine[e.from], unit)) unit = to_unit(exact[e.to] - exact[e.from]);
    edge_units.push_back(unit);
    e.direction = -1;
    const double key = std::abs(unit.x());
    for (auto it = known.lower_bound(key - 0x1p-40); it != known.end() && it->first < key + 0x1p-40; ++it) {
      const Edge& other = edges[direction_edges[it->second]];
      if (unit.cross(edge_units[direction_edges[it->second]]).squaredNorm() > 0x1p-90) continue;
      if (!is_zero(cross(exact[e.to] - exact[e.from], exact[other.to] - exact[other.from]))) continue;
      e.direction = it->second;
      break;
    }
    if (e.direction >= 0 && unit.dot(edge_units[direction_edges[e.direction]]) < 0) {
      std::swap(e.from, e.to);
      std::swap(e.left, e.right);
      edge_units.back() = -unit;
    }
    if (e.direction < 0) {
      e.direction = num_directions++;
      direction_edges.push_back(static_cast<int>(&e - edges.data()));
      known.emplace(key, e.direction);
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

}  // namespace pd::oracle
