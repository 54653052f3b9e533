#include "shape/mesh/welded_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace pd::detail {

namespace {

/// Of each point the lowest index of an equal one. -0 equals 0.
std::vector<std::int32_t> representatives(std::span<const Vec3> points, std::int64_t& distinct) {
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t i) {
    const Vec3& p = points[static_cast<std::size_t>(i)];
    return std::tuple(p.x(), p.y(), p.z());
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    const auto a = key(i), b = key(j);
    return a < b || (a == b && i < j);
  });
  std::vector<std::int32_t> lowest(points.size());
  distinct = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool repeats = k > 0 && key(order[k]) == key(order[k - 1]);
    if (!repeats) ++distinct;
    lowest[static_cast<std::size_t>(order[k])] = repeats ? lowest[static_cast<std::size_t>(order[k - 1])] : order[k];
  }
  return lowest;
}

}  // namespace

WeldedMesh weld(const MeshView& mesh) {
  WeldedMesh welded;
  welded.points = mesh.points;
  const std::vector<std::int32_t> lowest = representatives(mesh.points, welded.distinct);
  welded.corners.reserve(mesh.corners.size());
  for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
    const std::size_t begin = welded.corners.size();
    for (auto k = static_cast<std::size_t>(mesh.offsets[f]); k < static_cast<std::size_t>(mesh.offsets[f + 1]); ++k) {
      const std::int32_t vertex = lowest[static_cast<std::size_t>(mesh.corners[k])];
      if (welded.corners.size() == begin || welded.corners.back() != vertex) welded.corners.push_back(vertex);
    }
    while (welded.corners.size() > begin + 1 && welded.corners.back() == welded.corners[begin]) {
      welded.corners.pop_back();
    }
    if (welded.corners.size() < begin + 3) welded.corners.resize(begin);
    welded.face_of.resize(welded.corners.size(), static_cast<std::int32_t>(f));
    welded.offsets.push_back(static_cast<std::int32_t>(welded.corners.size()));
  }
  return welded;
}

std::vector<EdgeUse> sorted_edges(const WeldedMesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(mesh.corners.size());
  for (std::int32_t c = 0; c < static_cast<std::int32_t>(mesh.corners.size()); ++c) {
    const auto [low, high] = std::minmax({mesh.vertex(c), mesh.vertex(mesh.next(c))});
    uses.push_back({low, high, c});
  }
  sort_edges(
      uses, [](const EdgeUse& a, const EdgeUse& b) { return std::tie(a.high, a.corner) < std::tie(b.high, b.corner); });
  return uses;
}

}  // namespace pd::detail
