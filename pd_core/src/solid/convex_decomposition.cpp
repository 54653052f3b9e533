#include "pd/solid/convex_decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "numeric/floating_point_guard.hpp"
#include "solid/cut_parts.hpp"

namespace pd {

namespace {

double solid_volume(const MeshSolid& solid) {
  const TriangleNode& root = solid.nodes().front();
  const Vec3 centre = 0.5 * root.low + 0.5 * root.high;
  double sum = 0;
  for (const MeshSolid::Triangle& t : solid.triangles()) {
    const auto seen = [&](std::size_t k) -> Vec3 { return solid.vertex(t.vertices[k]) - centre; };
    sum += seen(0).dot(seen(1).cross(seen(2))) / 6;
  }
  return sum;
}

}  // namespace

Expected<SolidDecomposition> decompose(const MeshSolid& solid, const DecompositionSettings& settings) {
  if (!(settings.error > 0) || !std::isfinite(settings.error)) {
    return Error{ErrorCode::bad_value, "must be finite and greater than 0", "error"};
  }
  if (settings.max_parts < 1) return Error{ErrorCode::bad_value, "must be 1 or more", "max_parts"};
  if (settings.max_steps < 1) return Error{ErrorCode::bad_value, "must be 1 or more", "max_steps"};
  const detail::FloatingPointGuard guard;
  detail::CutParts found =
      settings.inside ? detail::inner_parts(solid, settings) : detail::outer_parts(solid, settings);
  if (found.parts.empty()) {
    return Error{ErrorCode::limit_exceeded, "the solid is thinner than rounding everywhere", ""};
  }
  std::vector<Compound::Part> shapes;
  double error = 0, volume = 0;
  for (detail::SolidPart& part : found.parts) {
    error = std::max(error, part.error);
    volume += detail::volume_of(part.polytope);
    shapes.push_back({std::move(part.polytope), Pose()});
  }
  return SolidDecomposition{*Compound::from_parts(std::move(shapes)),
                            error,
                            error <= settings.error,
                            found.steps,
                            solid_volume(solid),
                            volume};
}

}  // namespace pd
