/// @file
/// The hull of the points that matter, made anew from a surface that is no longer convex.
#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

namespace {

/// A rebuilt surface takes four vertices to enclose the rest and this many of those that matter most. Measured on
/// coherent frames: with 6 more supports are asked for, with 24 inserting them costs more than asking.
constexpr std::size_t kRebuiltVertices = 10;

}  // namespace

bool InnerSurface::rebuild(double flat) {
  const SpreadPoints spread = spread_vertices();
  if (!(spread.six_volumes > flat)) return false;
  // What lies on the nearest faces decides, and the newest vertex, wherever it is.
  const std::size_t count = vertices.size();
  nearness_.assign(count, {kRemoved, 0});
  for (std::size_t i = 0; i < count; ++i) nearness_[i].vertex = static_cast<std::int32_t>(i);
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] == kRemoved) continue;  // free slots name vertices of earlier surfaces
    for (const std::int32_t v : triangles_[f].v) nearness_[v].key = std::min(nearness_[v].key, keys_[f]);
  }
  nearness_.back().key = std::numeric_limits<double>::lowest();
  for (const std::int32_t i : spread.ids) nearness_[i].key = kRemoved;
  const std::size_t near = std::min(count, kRebuiltVertices);
  std::partial_sort(nearness_.begin(), nearness_.begin() + static_cast<std::ptrdiff_t>(near), nearness_.end(),
                    [](const NearVertex& x, const NearVertex& y) {
                      return x.key < y.key || (x.key == y.key && x.vertex < y.vertex);
                    });
  kept_.clear();
  for (const std::int32_t i : spread.ids) kept_.push_back(vertices[i]);
  for (std::size_t i = 0; i < near && nearness_[i].key < kRemoved; ++i) kept_.push_back(vertices[nearness_[i].vertex]);
  std::swap(vertices, kept_);
  clear_faces();
  if (!start_tetrahedron(flat)) return false;
  for (int v = 4; v < static_cast<int>(vertices.size()); ++v) {
    const int f = first_face_below(vertices[v].x);
    // Where rounding forbids it, the vertex is left inside.
    if (f >= 0) (void)insert(f, v);
  }
  return true;
}

int InnerSurface::first_face_below(const Vec3& x) {
  for (int from = 0; from < slots_; from += 64) {
    const PlaneArrays block{nx_.data() + from, ny_.data() + from, nz_.data() + from, levels_.data() + from,
                            keys_.data() + from};
    const std::uint64_t below = planes_below(block, std::min(64, slots_ - from), x.x(), x.y(), x.z());
    if (below != 0) return from + std::countr_zero(below);
  }
  return -1;
}

}  // namespace pd::detail
