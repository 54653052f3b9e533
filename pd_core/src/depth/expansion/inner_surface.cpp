#include "depth/expansion/inner_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pd::detail {

namespace {

/// Room for an ordinary query, made at once, so that the first one does not grow it piece by piece.
constexpr int kFirstRoom = 192;

constexpr std::array<SurfaceTriangle, 4> tetrahedron_triangles() {
  std::array<SurfaceTriangle, 4> out{};
  for (std::size_t f = 0; f < 4; ++f) {
    for (std::size_t e = 0; e < 3; ++e) {
      out[f].v[e] = kTetrahedronFaces[f][e];
      out[f].adj[e] = 4 * kTetrahedronBeyond[f][e].face + kTetrahedronBeyond[f][e].edge;
    }
  }
  return out;
}

/// The first corners of all four, the second ones, the third ones.
constexpr std::array<std::array<std::int32_t, kPlaneLanes>, 3> corners_by_place(
    const std::array<SurfaceTriangle, 4>& faces) {
  std::array<std::array<std::int32_t, kPlaneLanes>, 3> out{};
  for (std::size_t place = 0; place < 3; ++place) {
    for (std::size_t f = 0; f < 4; ++f) out[place][f] = faces[f].v[place];
  }
  return out;
}

}  // namespace

void InnerSurface::clear() {
  if (room_ == 0) make_room(kFirstRoom);
  clear_faces();
  vertices.clear();
}

void InnerSurface::clear_faces() {
  std::fill_n(keys_.begin(), slots_, kRemoved);
  std::fill_n(levels_.begin(), slots_, kRemoved);
  free_.clear();
  slots_ = 0;
  in_use_ = 0;
  append_mode_ = true;
  if constexpr (kValidate) checked_insertions_ = 0;  // the same checks in every search
}

void InnerSurface::make_room(int count) {
  if (room_ == 0) {
    for (auto* points : {&vertices, &kept_}) points->reserve(kFirstRoom);
    for (auto* numbers : {&face_numbers_, &vertex_numbers_}) numbers->reserve(kFirstRoom);
    free_.reserve(kFirstRoom / 2);
    nearness_.reserve(kFirstRoom);
  }
  const int wanted = padded_to_block(2 * count + kPlaneBlock);
  const auto room = static_cast<std::size_t>(wanted);
  triangles_.resize(room);
  for (auto* values : {&nx_, &ny_, &nz_}) values->resize(room, 0);
  levels_.resize(room, kRemoved);
  keys_.resize(room, kRemoved);
  removed_bits_.resize(room / 64 + 1, 0);
  for (auto* ids : {&from_, &to_, &outside_, &removed_}) ids->resize(room);
  for (auto* values : {&fan_nx_, &fan_ny_, &fan_nz_, &fan_levels_, &fan_keys_}) values->resize(room);
  room_ = wanted;  // last: an allocation that fails leaves lists of several sizes
}

void InnerSurface::compute_planes() {
  // The horizon's lists are free: they serve for the corners.
  for (int f = 0; f < slots_; ++f) {
    from_[f] = triangles_[f].v[0];
    to_[f] = triangles_[f].v[1];
    outside_[f] = triangles_[f].v[2];
  }
  const int padded = padded_to_block(slots_);
  for (int f = slots_; f < padded; ++f) from_[f] = to_[f] = outside_[f] = 0;
  triangle_planes(vertices.data()->x.data(), {from_.data(), to_.data(), outside_.data()}, 0, slots_, planes());
  std::fill(keys_.begin() + slots_, keys_.begin() + padded, kRemoved);
  std::fill(levels_.begin() + slots_, levels_.begin() + padded, kRemoved);
  nearest_ = least_key(keys_.data(), slots_);
}

bool InnerSurface::start_tetrahedron(double flat) {
  const Vec3& p = vertices[0].x;
  const double volume = (vertices[1].x - p).cross(vertices[2].x - p).dot(vertices[3].x - p);
  if (!(std::abs(volume) > flat)) return false;
  // Face 0 1 2 must have vertex 3 behind it.
  if (volume > 0) std::swap(vertices[1], vertices[2]);
  static constexpr std::array<SurfaceTriangle, 4> kFaces = tetrahedron_triangles();
  reserve(4);
  std::copy(kFaces.begin(), kFaces.end(), triangles_.begin());
  slots_ = in_use_ = 4;
  static constexpr auto kCorners = corners_by_place(kFaces);
  triangle_planes(vertices.data()->x.data(), {kCorners[0].data(), kCorners[1].data(), kCorners[2].data()}, 0, 4,
                  planes());
  nearest_ = least_key(keys_.data(), 4);
  return true;
}

SpreadPoints InnerSurface::spread_vertices() const {
  return spread_points(static_cast<std::int32_t>(vertices.size()),
                       [this](std::int32_t i) -> const Vec3& { return vertices[i].x; });
}

bool InnerSurface::start_from_spread_vertices(double flat) {
  const SpreadPoints spread = spread_vertices();
  if (!(spread.six_volumes > flat)) return false;
  kept_.clear();
  for (const std::int32_t i : spread.ids) kept_.push_back(vertices[i]);
  std::swap(vertices, kept_);
  return start_tetrahedron(flat);
}

}  // namespace pd::detail
