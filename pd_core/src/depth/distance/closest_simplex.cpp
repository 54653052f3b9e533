#include "depth/distance/closest_simplex.hpp"

#include "depth/difference/support_double_double.hpp"
#include "depth/distance/simplex_double_double.hpp"

namespace pd::detail {

ClosestSimplex closest_simplex(const PosedPair& pair, std::span<const VertexPair> start) {
  // Each step comes nearer, as far as double-double tells: this many are more than any pair was seen to take.
  constexpr int kMaxSteps = 100;
  const auto place = [&](const VertexPair& v) { return pair.approximate_dd(PairVector::point(v.a, v.b)); };
  const double error = 4 * pair.vector_error_dd();
  SimplexDoubleDouble<VertexPair> simplex(start[0], place(start[0]));
  const auto length = [&] { return to_double(sqrt(simplex.closest().squared)); };
  for (const VertexPair& v : start.subspan(1)) {
    if (length() > error) simplex.add(v, place(v));
  }
  for (int step = 0; step < kMaxSteps && length() > error; ++step) {
    const Vec3DD toward = scaled(simplex.closest().point, DoubleDouble{-1 / length(), 0});
    const VertexPair next = support_double_double(pair, toward);
    const Vec3DD x = place(next);
    if (!(to_double(dot(toward, x)) > error - length()) || !simplex.add(next, x)) break;
  }
  ClosestSimplex out{{}, simplex.closest().count};
  for (int i = 0; i < out.count; ++i) out.vertices[static_cast<std::size_t>(i)] = simplex.vertex(i);
  return out;
}

}  // namespace pd::detail
