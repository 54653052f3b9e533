/// @file
/// The surface as plain data, and its invariants.
#include "depth/expansion/inner_surface.hpp"
#include "depth/expansion/surface_check.hpp"
#include "depth/expansion/surface_snapshot.hpp"

namespace pd::detail {

void InnerSurface::snapshot(SurfaceSnapshot& out) const {
  out.clear();
  for (const DifferenceVertex& v : vertices) out.points.push_back(v.x);
  std::vector<std::int32_t>& number = out.numbers;  // of a slot's face
  number.assign(static_cast<std::size_t>(slots_), -1);
  std::int32_t count = 0;
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] != kRemoved) number[static_cast<std::size_t>(f)] = count++;
  }
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] == kRemoved) continue;
    const SurfaceTriangle& from = triangles_[f];
    SurfaceSnapshot::Face to{{from.v[0], from.v[1], from.v[2]}, {-1, -1, -1}, normal(f), signed_root(keys_[f])};
    for (int e = 0; e < 3; ++e) {
      const std::int32_t g = from.adj[e] >> 2;
      if (g >= 0 && g < slots_ && keys_[g] != kRemoved) {
        to.adj[e] = 4 * number[static_cast<std::size_t>(g)] + (from.adj[e] & 3);
      }
    }
    out.faces.push_back(to);
  }
  if (nearest_ < slots_) out.nearest = number[static_cast<std::size_t>(nearest_)];
}

std::optional<SurfaceFault> InnerSurface::validate() const {
  SurfaceSnapshot all;
  snapshot(all);
  if (static_cast<int>(all.faces.size()) != in_use_) return SurfaceFault{SurfaceRule::links, -1};
  return find_fault(all, false);
}

}  // namespace pd::detail
