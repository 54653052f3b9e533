#include "pd/structure/normal_diagram.hpp"

#include <cmath>
#include <vector>

#include "numeric/dyadic.hpp"
#include "shape/support/polytope_support.hpp"
#include "structure/exact_climb.hpp"

namespace pd {

namespace {

/// Sign of <v[to] - v[from], direction>, exact.
int sign_along(const ConvexPolytope& polytope, int from, int to, const Vec3& direction) {
  const Vec3 step = polytope.vertex(to) - polytope.vertex(from);
  const double value = step.dot(direction);
  double size = 0;
  for (int i = 0; i < 3; ++i) size += std::abs(step[i] * direction[i]);
  // One rounding of each difference, one of each product, two of the sums.
  if (std::isfinite(value) && std::abs(value) > 0x1p-50 * size + 0x1p-1000) return value > 0 ? 1 : -1;
  return dot(detail::to_dyadic(polytope.vertex(to)) - detail::to_dyadic(polytope.vertex(from)),
             detail::to_dyadic(direction))
      .sign();
}

}  // namespace

int NormalDiagram::locate(const Vec3& direction) const {
  const Vec3 scaled = direction / direction.cwiseAbs().maxCoeff();
  const auto sign = [&](int from, int to) { return sign_along(*polytope_, from, to, direction); };
  const int extreme = detail::climb_exactly(*polytope_, detail::support_vertex(*polytope_, scaled, -1), sign);
  std::vector<std::int32_t> stack;
  return detail::lowest_of_face(*polytope_, extreme, sign, stack);
}

}  // namespace pd
