/// @file
/// Bodies composed of others as the protocol writes them: {"sum_of"}, {"hull_of"}, {"intersection_of"}, lists of
/// bodies.
#pragma once

#include "pd/dimension/composed_body.hpp"
#include "protocol/dimension_body.hpp"

namespace pd::query {

/// True if a body is composed of others.
[[nodiscard]] bool is_composed(const Node& body);

/// The dimension of the first body met.
/// @throws Refusal: those of `read_dimension`; limit_exceeded for too deep a nesting, bad_value for an empty list.
[[nodiscard]] int composed_dimension(const Node& body, const Limits& limits, int nesting = 0);

/// The share of epsilon and the structure with which the bodies inside are built.
struct Preparation {
  double epsilon;
  dimension::Backend backend;
};

/// A body, composed or not, over structures.
template <int D>
[[nodiscard]] dimension::ComposedBody<D> read_composed(const Node& body, const Limits& limits,
                                                       const Preparation& preparation, int nesting = 0);

/// Writes that a budget of operations ended first, and the epsilon that the answer still keeps.
void write_reached(double epsilon, JsonWriter& answer);

/// The answer of `ask(share)`, structures inside built for a share of epsilon: a quarter for sums. Hulls ask for more,
/// by the shape of the whole, which is known once it stands, and intersections by how thin they are.
template <class Ask>
auto with_fine_structures(double epsilon, const Ask& ask) {
  double share = epsilon / 4;
  auto found = ask(share);
  const auto too_coarse = [&] {
    return !found && found.error().code == ErrorCode::bad_value && found.error().where == "epsilon" && epsilon >= 1e-5;
  };
  for (int attempt = 1; attempt < 4 && too_coarse(); ++attempt) found = ask(share /= 8);
  return found;
}

}  // namespace pd::query
