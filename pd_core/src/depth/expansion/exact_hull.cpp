#include "depth/expansion/exact_hull.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/double_double.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

Vec3DD exact_difference(const Vec3& a, const Vec3& b) {
  return {two_sum(a.x(), -b.x()), two_sum(a.y(), -b.y()), two_sum(a.z(), -b.z())};
}

}  // namespace

void ExactSurface::clear() {
  vertices.clear();
  faces_.clear();
  heap_.clear();
}

bool ExactSurface::sees(std::int32_t v, const Face& f) const {
  return orient3d(at(f.v[0]), at(f.v[1]), at(f.v[2]), at(v)) > 0;
}

void ExactSurface::add_face(std::int32_t a, std::int32_t b, std::int32_t c) {
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

bool ExactSurface::start() {
  const std::size_t n = vertices.size();
  // The two farthest apart, the farthest from their line, and whatever lies off that plane: large volumes first.
  const auto bring = [&](std::size_t to, auto&& measure) {
    std::size_t best = to;
    for (std::size_t i = to + 1; i < n; ++i) {
      if (measure(vertices[i].x) > measure(vertices[best].x)) best = i;
    }
    std::swap(vertices[to], vertices[best]);
  };
  if (n < 4) return false;
  const Vec3 first = vertices[0].x;
  bring(1, [&](const Vec3& x) { return (x - first).squaredNorm(); });
  const Vec3 along = vertices[1].x - first;
  bring(2, [&](const Vec3& x) { return (x - first).cross(along).squaredNorm(); });
  const Vec3 normal = along.cross(vertices[2].x - first);
  bring(3, [&](const Vec3& x) { return std::abs((x - first).dot(normal)); });
  const int side = orient3d(at(0), at(1), at(2), at(3));
  if (side == 0) return false;
  // Face 0 1 2 must have vertex 3 behind it.
  if (side > 0) std::swap(vertices[1], vertices[2]);
  vertices.resize(4);
  static constexpr std::int32_t kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  static constexpr std::int32_t kBeyond[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
  for (int f = 0; f < 4; ++f) {
    add_face(kFaces[f][0], kFaces[f][1], kFaces[f][2]);
    std::copy(std::begin(kBeyond[f]), std::end(kBeyond[f]), std::begin(faces_.back().adj));
  }
  return true;
}

bool ExactSurface::insert(int from) {
  const auto v = static_cast<std::int32_t>(vertices.size()) - 1;
  const auto face_at = [&](std::int32_t f) -> Face& { return faces_[static_cast<std::size_t>(f)]; };
  if (!sees(v, face_at(from))) return false;
  visible_.assign(1, from);
  face_at(from).alive = false;
  const auto first_new = static_cast<std::int32_t>(faces_.size());
  for (std::size_t i = 0; i < visible_.size(); ++i) {
    for (int e = 0; e < 3; ++e) {
      const std::int32_t g = face_at(visible_[i]).adj[e];
      if (!face_at(g).alive || !sees(v, face_at(g))) continue;
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
  // The border is one loop: the new faces follow each other round v.
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

int ExactSurface::nearest() {
  while (!faces_[static_cast<std::size_t>(heap_.front().face)].alive) {
    std::pop_heap(heap_.begin(), heap_.end(), [](const Entry& x, const Entry& y) { return x.distance > y.distance; });
    heap_.pop_back();
  }
  return heap_.front().face;
}

}  // namespace pd::detail
