/// @file
/// The tree behind a ComposedBody, and its supports and ellipsoids in the space with one coordinate more for every
/// equation.
///
/// A node of E equations stands for a body in R^(D + E): its value x, then the residuals of its intersections. An
/// intersection of parts has the value of its first part and the residuals x_1 - x_i, i >= 2. The point of a hull lies
/// on one part; the residuals of the others are zero there, so that a mixture with all residuals zero is one of points
/// whose own residuals are zero.
#pragma once

#include <memory>
#include <vector>

#include "dimension/backends/width_structure.hpp"
#include "dimension/support_body.hpp"
#include "pd/dimension/composed_body.hpp"

namespace pd::dimension::detail {

enum class ComposedKind { leaf, sum, hull, intersection };

struct ComposedNode;
using Composed = std::shared_ptr<const ComposedNode>;

struct ComposedNode {
  ComposedKind kind = ComposedKind::leaf;
  int dimension = 0;
  PreparedBody body;  ///< of a leaf
  AnyMap map;         ///< of a leaf
  AnyVector centre;   ///< of a leaf: that of its sandwich, mapped
  /// Of a leaf: the lower triangular root of its inner ellipsoid, mapped; the outer one is the sandwich's ratio larger.
  AnyMatrix inner;
  std::vector<Composed> parts;  ///< of the others
  int equations = 0;
  double epsilon = 0;
  double magnitude = 0;  ///< largest |coordinate| in the parts, or larger
  /// A leaf's supports fall short by at most epsilon of h about the centre of its sandwich (the contract of the
  /// backends), and so do those of sums, about the sum of the centres; of hulls only by epsilon of the width.
  bool radial = true;
  bool consistent = true;  ///< every leaf answers from one fixed set

  /// Supports in the direction (v, u): writes the value and the residuals, returns <v, value> + <u, residuals>.
  double support(const AnyVector& v, const double* u, AnyVector& value, double* residuals,
                 QueryCounters& counters) const;
  /// `ComposedBody<D>::support`. Requires equations == 0.
  AnySupport support(const AnyVector& v, QueryCounters& counters) const;

  /// The ellipsoids of the image under (value, residuals) -> entry * value + residuals at the coordinates from
  /// `first_residual` on.
  [[nodiscard]] EllipsoidBounds bounds(const LiftedMatrix& entry, Eigen::Index first_residual) const;
};

/// `ComposedBody<D>::of`
Expected<Composed> leaf_of(PreparedBody body, const AnyMap& map);
/// `ComposedBody<D>::sum_of` and its like. Requires a kind other than a leaf.
Expected<Composed> composed_of(ComposedKind kind, std::vector<Composed> parts);

}  // namespace pd::dimension::detail
