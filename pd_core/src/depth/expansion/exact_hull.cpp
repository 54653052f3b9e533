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
  faces_.clear();
  heap_.clear();
  if constexpr (kValidate) checked_insertions_ = 0;
}

bool ExactHull::is_visible(const Face& f, std::int32_t v) const {
  return orient3d(at(f.v[0]), at(f.v[1]), at(f.v[2]), at(v)) > 0;
}

void ExactHull::add_face(std::int32_t a, std::int32_t b, std::int32_t c) {
  const Vec3DD n = cross(exact_difference(at(b), at(a)), exact_difference(at(c), at(a)));
  const DoubleDouble length = sqrt(dot(n, n));
  const Vec3& p = at(a);
  const DoubleDouble height = (n.x * p.x() + n.y * p.y() + n.z * p.z()) / length;
  const auto index = static_cast<std::int32_t>(faces_.size());
  faces_.push_back({{a, b, c},
                    {-1, -1, -1},
                    Vec3(to_double(n.x / length), to_double(n.y / length), to_double(n.z / length)),
                    to_double(height),
                    true});
  heap_.push_back({to_double(height), index});
  std::push_heap(heap_.begin(), heap_.end(), [](const Entry& x, const Entry& y) { return x.distance > y.distance; });
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
  for (int f = 0; f < 4; ++f) {
    add_face(kTetrahedronFaces[f][0], kTetrahedronFaces[f][1], kTetrahedronFaces[f][2]);
    for (int e = 0; e < 3; ++e) faces_.back().adj[e] = kTetrahedronBeyond[f][e].face;
  }
  return true;
}

bool ExactHull::insert(int from) {
  const bool inserted = insert_vertex(from);
  if constexpr (kValidate) {
    if (inserted) validate_after_insertion(*this, true, checked_insertions_);
  }
  return inserted;
}

bool ExactHull::insert_vertex(int from) {
  const auto v = static_cast<std::int32_t>(vertices.size()) - 1;
  const auto face_at = [&](std::int32_t f) -> Face& { return faces_[static_cast<std::size_t>(f)]; };
  if (!is_visible(face_at(from), v)) return false;
  visible_.assign(1, from);
  face_at(from).alive = false;
  const auto first_new = static_cast<std::int32_t>(faces_.size());
  for (std::size_t i = 0; i < visible_.size(); ++i) {
    for (int e = 0; e < 3; ++e) {
      const std::int32_t g = face_at(visible_[i]).adj[e];
      if (!face_at(g).alive || !is_visible(face_at(g), v)) continue;
      face_at(g).alive = false;
      visible_.push_back(g);
    }
  }
  for (const std::int32_t f : visible_) {
    for (int e = 0; e < 3; ++e) {
      const std::int32_t g = face_at(f).adj[e];
      if (!face_at(g).alive) continue;
      const std::int32_t a = face_at(f).v[e];
      const std::int32_t b = face_at(f).v[(e + 1) % 3];
      const auto index = static_cast<std::int32_t>(faces_.size());
      add_face(a, b, v);
      faces_.back().adj[0] = g;
      for (int i = 0; i < 3; ++i) {
        if (face_at(g).v[i] == b) face_at(g).adj[i] = index;
      }
    }
  }
  // The border is one loop: the new faces follow each other around v.
  const auto end = static_cast<std::int32_t>(faces_.size());
  for (std::int32_t f = first_new; f < end; ++f) {
    for (std::int32_t g = first_new; g < end; ++g) {
      if (face_at(g).v[0] == face_at(f).v[1]) {
        face_at(f).adj[1] = g;
        face_at(g).adj[2] = f;
      }
    }
  }
  return true;
}

int ExactHull::nearest() {
  while (!faces_[static_cast<std::size_t>(heap_.front().face)].alive) {
    std::pop_heap(heap_.begin(), heap_.end(), [](const Entry& x, const Entry& y) { return x.distance > y.distance; });
    heap_.pop_back();
  }
  return heap_.front().face;
}

int ExactHull::size() const {
  return static_cast<int>(std::count_if(faces_.begin(), faces_.end(), [](const Face& f) { return f.alive; }));
}

void ExactHull::snapshot(SurfaceSnapshot& out) const {
  out.clear();
  for (const DifferenceVertex& v : vertices) out.points.push_back(v.x);
  std::vector<std::int32_t>& number = out.numbers;
  number.assign(faces_.size(), -1);
  std::int32_t count = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    if (faces_[f].alive) number[f] = count++;
  }
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& from = faces_[f];
    if (!from.alive) continue;
    SurfaceSnapshot::Face to{{from.v[0], from.v[1], from.v[2]}, {-1, -1, -1}, from.unit_normal, from.distance};
    for (int e = 0; e < 3; ++e) {
      const auto g = static_cast<std::size_t>(from.adj[e]);
      if (g >= faces_.size() || !faces_[g].alive) continue;
      // The edge of the neighbour that begins where this one ends.
      const std::int32_t* const first = faces_[g].v;
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
