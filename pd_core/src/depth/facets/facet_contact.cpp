#include "depth/facets/facet_contact.hpp"

namespace pd::detail {

namespace {

/// A million times more than rotations in single precision turn an edge against a facet's plane, whose cofactors keep
/// them together: 2^-40 covers rounding in doubles a thousandfold.
constexpr double kSteep = 0x1p-40;

}  // namespace

bool is_supporting_facet(const ConvexPolytope& polytope, int facet) {
  const Vec3& normal = polytope.facet_normal(facet);
  const auto loop = polytope.facet_vertices(facet);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::int32_t before = loop[i == 0 ? loop.size() - 1 : i - 1];
    const std::int32_t after = loop[i + 1 == loop.size() ? 0 : i + 1];
    for (const std::int32_t other : polytope.neighbours(loop[i])) {
      if (other == before || other == after) continue;
      const Vec3 edge = polytope.vertex(other) - polytope.vertex(loop[i]);
      if (!(edge.dot(normal) < -kSteep * edge.norm())) return false;
    }
  }
  return true;
}

}  // namespace pd::detail
