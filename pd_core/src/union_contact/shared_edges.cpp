#include "pd/union_contact/shared_edges.hpp"

#include <bit>

namespace pd {

namespace {

/// Of equal corners the same; 0 and -0 may differ, and then share nothing.
std::uint64_t key(const Vec3& corner) {
  std::uint64_t number = 0;
  for (int i = 0; i < 3; ++i) number = (number ^ std::bit_cast<std::uint64_t>(corner[i])) * 0x9E3779B97F4A7C15ULL;
  return number ^ number >> 32U;
}

}  // namespace

void SharedEdges::find() {
  known_ = true;
  const std::size_t count = 3 * triangles_.size();
  twins_.assign(count, -1);
  edges_.resize(count);
  first_.assign(std::bit_ceil(count + 1), -1);
  std::int32_t edge = 0;
  for (const std::array<Vec3, 3>& triangle : triangles_) {
    const std::uint64_t keys[3] = {key(triangle[0]), key(triangle[1]), key(triangle[2])};
    for (std::size_t i = 0; i < 3; ++i, ++edge) {
      const std::size_t end = i < 2 ? i + 1 : 0;
      // The same whichever way the edge is run along.
      const std::uint64_t both = keys[i] + keys[end];
      std::int32_t& place = first_[both & (first_.size() - 1)];
      edges_[static_cast<std::size_t>(edge)] = {both, &triangle[i], &triangle[end], place};
      for (std::int32_t other = place; other >= 0; other = edges_[static_cast<std::size_t>(other)].next) {
        const Edge& met = edges_[static_cast<std::size_t>(other)];
        if (met.both != both) continue;
        const bool back = same(triangle[i], *met.end) && same(triangle[end], *met.begin);
        if (!back && !(same(triangle[i], *met.begin) && same(triangle[end], *met.end))) continue;
        twins_[static_cast<std::size_t>(edge)] = other;
        std::int32_t& twin = twins_[static_cast<std::size_t>(other)];
        if (twin < 0) twin = edge;
        break;
      }
      place = edge;
    }
  }
}

}  // namespace pd
