/// @file
/// Shows an expanding polytope step by step to whoever wants to see a search: to draw it, to write it to a file,
/// to find out why it took long.
///
/// Given to `observe_searches`. A search that is observed answers the same bits; one that is not pays a comparison a
/// step.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd {

/// One pass of the search, before its support is inserted: the polytope inside P = B + (-A), its face nearest to the
/// origin and the support of P in that face's normal. Lengths in the unit of the input, points relative to the origin
/// of P; A and B as the caller named them.
struct SearchStep {
  std::string_view arithmetic;  ///< "double", "exact hull" (exact signs on points in doubles) or "exact" (exact points)
  int number = 0;               ///< from 0 in every search; a query may need more than one
  std::vector<Vec3> vertices;   ///< points of P in the order in which they were found; not all need be used by a face
  std::vector<std::array<std::int32_t, 3>> faces;  ///< counter-clockwise from outside
  std::vector<double> distances;                   ///< by face: of its plane from the origin, signed, rounded down
  int nearest = 0;                                 ///< index of the face with the least distance
  Vec3 normal = Vec3::UnitX();                     ///< of that face, unit, outward
  Vec3 support = Vec3::Zero();                     ///< of P in that direction
  double lower = 0;                                ///< bounds of the depth so far; lower may be negative
  double upper = 0;                                ///< infinite while nothing is known
};

/// How a search ended.
struct SearchEnd {
  std::string_view arithmetic;
  /// "certified", "separated", "touching", "undecided" (more precise arithmetic goes on) or "over budget" (too many
  /// facets are nearly tied: another method goes on).
  std::string_view outcome;
  double lower = 0;
  double upper = 0;
  Vec3 normal = Vec3::UnitX();
};

class SearchObserver {
 public:
  virtual ~SearchObserver() = default;
  virtual void on_step(const SearchStep& step) = 0;
  virtual void on_end(const SearchEnd& end) = 0;
};

class Scratch;

/// From now on every search by an expanding polytope in a query with this scratch is shown to `observer`, which must
/// outlive its use; null: to nobody. Polytopes and smooth bodies under the methods automatic, expansion and
/// decomposition search that way; what a warm certificate makes needless is not done for the observer's sake.
void observe_searches(Scratch& scratch, SearchObserver* observer);

}  // namespace pd
