/// @file
/// Bodies of the line protocol that may be non-convex: compounds and star-shaped bodies, and every convex shape as a
/// compound of one part.
#pragma once

#include <vector>

#include "pd/shape/compound.hpp"
#include "pd/shape/feature.hpp"
#include "protocol/shape_reader.hpp"

namespace pd::query {

/// A body as the caller knows it.
struct NamedBody {
  Compound compound;
  /// One for each part, in the order of the compound (nested parts in the order in which they stand in the line; the
  /// faces of a star-shaped body): the shape with the caller's vertex ids, margins not included.
  std::vector<NamedShape> parts;

  /// The caller's ids of a feature of a part. The centre of a star-shaped body has none.
  [[nodiscard]] std::vector<int> feature_ids(int part, const Feature& feature) const;
};

/// True if "a" or "b" of a line names a body that is not convex.
[[nodiscard]] bool names_non_convex(const Node& line);

/// Reads any shape. Compounds nest kMaxCompoundNesting deep.
[[nodiscard]] NamedBody read_body(const Node& node, const Limits& limits);

}  // namespace pd::query
