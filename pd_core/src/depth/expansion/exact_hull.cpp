#include "depth/expansion/exact_hull.hpp"

#include <algorithm>
#include <cmath>

#include "depth/expansion/tetrahedron.hpp"
#include "numeric/double_double.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

Vec3DD exact_difference(const Vec3& a, const Vec3& b) {
  return {two_sum(a.x(), -b.x()), two_sum(a.y(), -b.y()), two_sum(a.z(), -b.z())};
}

}  // namespace

void ExactHull::clear() {
  vertices.clear();
  clear_faces();
  if constexpr (kValidate) checked_insertions_ = 0;
}

int ExactHull::side(int f, int v) const {
  const Face& face = this->face(f);
  return orient3d(at(face.v[0]), at(face.v[1]), at(face.v[2]), at(v));
}

void ExactHull::measure(Face& f) const {
  const Vec3& p = at(f.v[0]);
  const Vec3DD n = cross(exact_difference(at(f.v[1]), p), exact_difference(at(f.v[2]), p));
  const DoubleDouble length = sqrt(dot(n, n));
  f.unit_normal = {to_double(n.x / length), to_double(n.y / length), to_double(n.z / length)};
  f.distance = to_double((n.x * p.x() + n.y * p.y() + n.z * p.z()) / length);
}

bool ExactHull::start() {
  const SpreadPoints spread = spread_points(static_cast<std::int32_t>(vertices.size()),
                                            [this](std::int32_t i) -> const Vec3& { return at(i); });
  const auto [i, j, k, l] = spread.ids;
  const int side = orient3d(at(i), at(j), at(k), at(l));
  if (side == 0) return false;
  // Face 0 1 2 must have vertex 3 behind it.
  const auto vertex = [this](std::int32_t id) { return vertices[static_cast<std::size_t>(id)]; };
  const DifferenceVertex corners[4] = {vertex(i), vertex(side > 0 ? k : j), vertex(side > 0 ? j : k), vertex(l)};
  vertices.assign(corners, corners + 4);
  start_tetrahedron([this](Face& f) { measure(f); });
  return true;
}

bool ExactHull::insert(int from) {
  const int v = static_cast<int>(vertices.size()) - 1;
  if (side(from, v) <= 0) return false;
  replace_below(from, v, [this](Face& f) { measure(f); });
  if constexpr (kValidate) validate_after_insertion(*this, true, checked_insertions_);
  return true;
}

int ExactHull::nearest() const {
  int nearest = -1;
  for (int f = 0; f < slots(); ++f) {
    if (face(f).alive && (nearest < 0 || face(f).distance < face(nearest).distance)) nearest = f;
  }
  return nearest;
}

int ExactHull::size() const {
  return static_cast<int>(std::count_if(faces().begin(), faces().end(), [](const Face& f) { return f.alive; }));
}

void ExactHull::snapshot(SurfaceSnapshot& out) const {
  out.clear();
  for (const DifferenceVertex& v : vertices) out.points.push_back(v.x);
  std::vector<std::int32_t>& number = out.numbers;
  number.assign(faces().size(), -1);
  std::int32_t count = 0;
  for (std::size_t f = 0; f < faces().size(); ++f) {
    if (faces()[f].alive) number[f] = count++;
  }
  for (std::size_t f = 0; f < faces().size(); ++f) {
    const Face& from = faces()[f];
    if (!from.alive) continue;
    SurfaceSnapshot::Face to{{from.v[0], from.v[1], from.v[2]}, {-1, -1, -1}, from.unit_normal, from.distance};
    for (int e = 0; e < 3; ++e) {
      const auto g = static_cast<std::size_t>(from.adj[e]);
      if (g >= faces().size() || !faces()[g].alive) continue;
      // The edge of the neighbour that begins where this one ends.
      const std::int32_t* const first = faces()[g].v;
      const auto edge = static_cast<std::int32_t>(std::find(first, first + 3, from.v[(e + 1) % 3]) - first);
      to.adj[e] = 4 * number[g] + edge;
    }
    if (out.nearest < 0 || to.distance < out.faces[static_cast<std::size_t>(out.nearest)].distance) {
      out.nearest = static_cast<int>(out.faces.size());
    }
    out.faces.push_back(to);
  }
}

std::optional<SurfaceFault> ExactHull::validate() const {
  SurfaceSnapshot all;
  snapshot(all);
  return find_fault(all, true);
}

}  // namespace pd::detail
