/// @file
/// A query about two polytopes asks its stages in the order of this table. A row says which bodies, methods, brackets
/// and memory a stage is for, and what it needs from the search. The page docs/one_query.md prints the table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

enum class Bodies : std::uint8_t {
  any,
  few_vertices,  ///< supports scan all vertices; not two boxes
  few_facets     ///< two solids of up to 32 vertices and 64 facets (`gauss_sat_applies`)
};

/// A stage needs this of the surface inside P, which is grown when a stage asks for it first.
enum class Needs : std::uint8_t {
  nothing,
  surface,
  round_origin,  ///< the origin lies inside of it for certain
  certified,     ///< its nearest face ended the search
  over_budget    ///< the search stopped because many facets are nearly as near, the origin inside
};

/// Returns the bit of a bracket in `Stage::brackets`.
constexpr std::uint8_t bit_of(Bracket bracket) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(bracket));
}

/// A stage does not check again what its row says.
struct Stage {
  std::string_view name;
  /// Answers, or passes on and leaves nothing behind but statistics.
  bool (*answer)(PolytopeQuery&, PenetrationDepth&);
  Bodies bodies;
  bool automatic;  ///< only if `Method::automatic` is asked for
  std::uint8_t brackets;
  bool warm;  ///< only with a warm certificate
  Needs needs;
};

/// Returns the table, in order. The last stage always answers.
[[nodiscard]] std::span<const Stage> stages();

/// Returns the words of docs/one_query.md.
[[nodiscard]] std::string_view name_of(Bodies bodies);
[[nodiscard]] std::string_view name_of(Needs needs);

/// Asks the stages one after the other and returns the one that answered. Requires a size `within_range`, and a method
/// that searches.
const Stage& answer_by_stages(PolytopeQuery& query, PenetrationDepth& out);

}  // namespace pd::detail
