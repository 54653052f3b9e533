/// @file
/// Answers about a union of parts from the uncovered facets of the P_ij: what depth, directional depth and the place of
/// a point share.
#pragma once

#include <optional>

#include "compound/part_pairs.hpp"
#include "compound/union_boundary.hpp"
#include "pd/compound/compound_depth.hpp"

namespace pd::detail {

/// bad_value, or nothing.
[[nodiscard]] std::optional<Error> refuse_settings(const UnionSettings& settings);

/// v * 2^exponent.
[[nodiscard]] Vec3 scaled(const Vec3& v, int exponent);

class UnionMemory;

class FacetsAnswer {
 public:
  using Where = UnionBoundary::BoundaryPoint;

  /// Refers to all of them.
  FacetsAnswer(const UnionPair& pair, const UnionSettings& settings, UnionStatistics& work)
      : pair_(pair), settings_(settings), work_(work) {}

  /// Finds the P_ij that come within `reach` of the origin; searches make those that they need.
  void find(double reach);

  /// Class of a union whose pairs touch at best: a placement on walls of zero width is inside. Finds the P_ij there.
  /// @param where  the boundary point that the origin is, if it is one.
  [[nodiscard]] Expected<ContactClass> class_of_touching(std::optional<Where>& where);

  [[nodiscard]] UnionBoundary& boundary() { return *boundary_; }
  /// Returns limit_exceeded if the P_ij that were made have more than `max_facets` facets: the answer is lost.
  [[nodiscard]] std::optional<Error> refused() const {
    return differences_->limit_exceeded() ? std::optional(too_many_facets()) : std::nullopt;
  }

  /// Adds what was done; called once for each set of P_ij.
  void count();

  [[nodiscard]] const PartDifference& piece(const Where& where) const { return differences_->pieces()[where.piece]; }
  [[nodiscard]] const DifferenceFacet& facet(const Where& where) const { return piece(where).facets[where.facet]; }
  /// Outward, unit.
  [[nodiscard]] Vec3 normal(const Where& where) const {
    return differences_->planes().normal(where.polygon.plane).normalized();
  }

  [[nodiscard]] std::int64_t exact_signs() const { return exact_signs_; }

  /// The depth of unions whose interiors meet, from the boundary point nearest to the origin. @return limit_exceeded.
  /// @param reach  a placement at this distance is free.
  [[nodiscard]] std::optional<Error> solve_overlapping(double known_lower, double reach, UnionMemory* memory,
                                                       UnionDepth& out);

  /// The features of the facet at a point of it, as the protocol names them: a vertex stands for a larger face that is
  /// parallel to the other body's facet.
  void features(const Where& where, Feature& on_a, Feature& on_b) const;

 private:
  void set_overlapping(const UnionBoundary::Nearest& nearest, UnionDepth& out) const;
  [[nodiscard]] Error too_many_facets() const;
  void set_witnesses(const Where& where, UnionDepth& out) const;

  const UnionPair& pair_;
  const UnionSettings& settings_;
  UnionStatistics& work_;
  std::int64_t exact_signs_ = 0;
  std::optional<PartDifferences> differences_;
  std::optional<UnionBoundary> boundary_;
};

}  // namespace pd::detail
