#include "depth/distance/gjk_exact.hpp"

#include "depth/difference/support_double_double.hpp"
#include "depth/distance/closest_search.hpp"
#include "depth/distance/simplex_of_numbers.hpp"

namespace pd::detail {

namespace {

using SimplexDoubleDouble = SimplexOfNumbers<DoubleDouble, VertexPair>;
using ExactSimplex = SimplexOfNumbers<Dyadic, VertexPair>;

class SearchInDoubleDouble {
 public:
  explicit SearchInDoubleDouble(const PosedPair& pair) : pair_(pair), error_(4 * pair.vector_error_dd()) {}

  [[nodiscard]] SimplexDoubleDouble::Corner corner(const VertexPair& v) const {
    return {v, pair_.approximate_dd(PairVector::point(v.a, v.b))};
  }
  bool has_reached(const SimplexDoubleDouble& simplex) {
    const auto& nearest = simplex.nearest();
    const DoubleDouble length = sqrt(nearest.squared / nearest.scale);
    length_ = to_double(length);
    if (!(length_ > error_) || steps_++ == kMostSteps) return true;
    toward_ = scaled(nearest.point, DoubleDouble{-1, 0} / (nearest.scale * length));
    return false;
  }
  [[nodiscard]] SimplexDoubleDouble::Corner support(const SimplexDoubleDouble& /*simplex*/) const {
    return corner(support_double_double(pair_, toward_));
  }
  [[nodiscard]] bool goes_on(const SimplexDoubleDouble& /*simplex*/, const SimplexDoubleDouble::Corner& s) const {
    return to_double(dot(toward_, s.x)) > error_ - length_;
  }

 private:
  /// Each step comes nearer, as far as double-double tells: more than any pair was seen to take.
  static constexpr int kMostSteps = 100;

  const PosedPair& pair_;
  const double error_;
  double length_ = 0;
  Vec3DD toward_;
  int steps_ = 0;
};

class ExactSearch {
 public:
  explicit ExactSearch(const PosedPair& pair) : pair_(pair) {}

  [[nodiscard]] ExactSimplex::Corner corner(const VertexPair& v) const {
    return {v, pair_.exact(PairVector::point(v.a, v.b))};
  }
  static bool has_reached(const ExactSimplex& simplex) { return simplex.nearest().squared.sign() == 0; }
  [[nodiscard]] ExactSimplex::Corner support(const ExactSimplex& simplex) const {
    const Dyadic3& y = simplex.nearest().point;
    const ExactDirection toward(Dyadic3{-y.x, -y.y, -y.z});
    return corner({support_face_a(pair_, toward).front(), support_face_b(pair_, toward).front()});
  }
  /// A vertex that lies on the plane through the nearest point shows that P lies behind it.
  static bool goes_on(const ExactSimplex& simplex, const ExactSimplex::Corner& s) {
    return dot(simplex.nearest().point, s.x - simplex.corner(0).x).sign() < 0;
  }

 private:
  const PosedPair& pair_;
};

}  // namespace

ClosestSimplex closest_simplex(const PosedPair& pair, std::span<const VertexPair> start) {
  SearchInDoubleDouble search(pair);
  SimplexDoubleDouble simplex(search.corner(start[0]));
  for (const VertexPair& v : start.subspan(1)) {
    if (simplex.nearest().count < 4) simplex.add(search.corner(v));
  }
  search_closest_point(search, simplex);
  ClosestSimplex out{{}, simplex.nearest().count};
  for (int i = 0; i < out.count; ++i) out.vertices[static_cast<std::size_t>(i)] = simplex.corner(i).vertex;
  return out;
}

ExactClosestPoint exact_closest_point(const PosedPair& pair, const VertexPair* start, int count) {
  const ClosestSimplex begin = closest_simplex(pair, std::span(start, static_cast<std::size_t>(count)));
  const ExactSearch search(pair);
  std::array<ExactSimplex::Corner, 4> corners;
  const auto size = static_cast<std::size_t>(begin.count);
  for (std::size_t i = 0; i < size; ++i) corners[i] = search.corner(begin.vertices[i]);
  ExactSimplex simplex(corners[0]);
  simplex.take(std::span(corners).first(size));
  search_closest_point(search, simplex);

  const ExactSimplex::Face& nearest = simplex.nearest();
  ExactClosestPoint result;
  result.count = nearest.count;
  result.apart = !ExactSearch::has_reached(simplex);
  // Ratios of big numbers: both are brought to the same exponent before rounding.
  const int shift = nearest.scale.exponent() + static_cast<int>(msb(nearest.scale.mantissa()));
  for (int i = 0; i < nearest.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    result.simplex[k] = simplex.corner(i).vertex;
    result.weights[k] = nearest.weights[k].scaled(-shift).to_double() / nearest.scale.scaled(-shift).to_double();
  }
  if (result.apart) {
    result.point = nearest.point;
    result.scale = nearest.scale * pair.homogeneous_factor();
  }
  return result;
}

}  // namespace pd::detail
