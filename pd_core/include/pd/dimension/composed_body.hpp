/// @file
/// Bodies made of preprocessed ones: affine images, Minkowski sums, hulls of unions, intersections ([M] section 1.4).
/// None is built: a composition answers supports from those of its parts.
///
/// h_{LK + t}(v) = h_K(L^T v) + <t, v>;  h_{A + B} = h_A + h_B;  h_{hull(A, B)} = max(h_A, h_B). An intersection has no
/// such formula. It is met by equations: a point of A and one of B, and the condition that they are one. Those
/// equations are further coordinates; with them every composition has supports, of a body in R^(d + equations) of which
/// the points with all these coordinates zero are the composed body.
///
/// The error of a composition is that of its parts: A, grown by epsilon, is composed of its parts, each grown by
/// epsilon of its own width. For sums that is the growth of the sum, for hulls it is no more.
#pragma once

#include <memory>
#include <vector>

#include "pd/dimension/directional_width.hpp"
#include "pd/numeric/expected.hpp"

namespace pd::dimension {

namespace detail {
struct ComposedNode;
}

/// Equations of all bodies of one query: each intersection of k bodies brings (k - 1) D, so do k bodies that meet.
inline constexpr int kMaxEquations = 40;

/// Immutable; copies share their parts.
template <int D>
class ComposedBody {
 public:
  /// A preprocessed body where `map` puts it.
  /// @return ErrorCode::non_finite, or bad_value for a singular matrix ("affine").
  static Expected<ComposedBody> of(DirectionalWidth<D> body, const AffineMap<D>& map = {});

  /// @return ErrorCode::bad_value for an empty list; limit_exceeded where there are more than kMaxEquations.
  static Expected<ComposedBody> sum_of(std::vector<ComposedBody> parts);
  static Expected<ComposedBody> hull_of(std::vector<ComposedBody> parts);
  static Expected<ComposedBody> intersection_of(std::vector<ComposedBody> parts);

  /// The largest epsilon of the structures inside; 0 where all of them are exact.
  [[nodiscard]] double epsilon() const;
  /// 0 unless there is an intersection inside.
  [[nodiscard]] int equations() const;

  /// A point extreme up to epsilon() of the parts' widths. Requires equations() == 0.
  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const;

  /// For the sources of this module.
  [[nodiscard]] const std::shared_ptr<const detail::ComposedNode>& node() const { return node_; }

 private:
  explicit ComposedBody(std::shared_ptr<const detail::ComposedNode> node) : node_(std::move(node)) {}
  static Expected<ComposedBody> make(int kind, std::vector<ComposedBody> parts);

  std::shared_ptr<const detail::ComposedNode> node_;
};

}  // namespace pd::dimension
