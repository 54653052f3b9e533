/// @file
/// Convex bodies in R^D, 2 <= D <= 5: the hull of points, or the intersection of halfspaces. Validated by factories;
/// full-dimensional and bounded ([M] section 1).
///
/// Both carry a certified sandwich (`sandwich.hpp`), which every algorithm of this module starts from.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pd/dimension/affine_map.hpp"
#include "pd/dimension/sandwich.hpp"
#include "pd/numeric/expected.hpp"

namespace pd::dimension {

/// The points x with <normal, x> <= offset. The normal has any length but zero.
template <int D>
struct Halfspace {
  Vector<D> normal;
  double offset;
};

enum class Representation { points, halfspaces };

/// An extreme point in some direction.
template <int D>
struct SupportPoint {
  Vector<D> point;
  double value;             ///< <direction, point>
  std::int64_t index = -1;  ///< of the body's points; -1 where the point is none of them (halfspaces, sums)
};

/// Limits of coordinates, normals and offsets: squares and products of a few stay in range.
inline constexpr double kMaxCoordinate = 1e100;

/// Immutable; copies share their storage.
template <int D>
class Body {
 public:
  /// The hull of n points.
  /// @return ErrorCode::too_few_points (n <= D), non_finite or out_of_range ("points[i]"), not_full_dimensional. The
  /// last one means that all points lie in a hyperplane, or within 2^-40 of the largest distance between points of
  /// it. At this aspect doubles no longer tell a body from a flat one. O(n) time, a few passes
  /// (`enclosing_ellipsoid.hpp`).
  static Expected<Body> from_points(std::vector<Vector<D>> points);

  /// The intersection of n halfspaces. Vertices are not enumerated.
  /// @return ErrorCode::too_few_points (n <= D), non_finite, out_of_range, zero_direction ("halfspaces[i]"), unbounded,
  /// bad_value (empty), not_full_dimensional (no interior).
  /// Expected O(n) time: linear programs in D and D + 1 variables, then the polar of [M] Lemma 16.
  static Expected<Body> from_halfspaces(std::vector<Halfspace<D>> halfspaces);

  /// The image under a regular map. @return non_finite, out_of_range, bad_value for a singular matrix ("affine").
  [[nodiscard]] Expected<Body> transformed(const AffineMap<D>& map) const;

  [[nodiscard]] Representation representation() const { return data_->representation; }
  /// Empty for a body of halfspaces.
  [[nodiscard]] std::span<const Vector<D>> points() const { return data_->points; }
  /// Empty for a body of points. Normals as given.
  [[nodiscard]] std::span<const Halfspace<D>> halfspaces() const { return data_->halfspaces; }
  /// Number of points or halfspaces.
  [[nodiscard]] std::int64_t size() const {
    return static_cast<std::int64_t>(data_->points.size() + data_->halfspaces.size());
  }
  [[nodiscard]] const Sandwich<D>& sandwich() const { return data_->sandwich; }

  /// Extreme point in a direction of any nonzero length, the lowest index of several; O(n): a scan of the points, or
  /// Seidel's linear program over the halfspaces. For many directions: `DirectionalWidth`.
  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction) const;

 private:
  struct Storage {
    Representation representation = Representation::points;
    std::vector<Vector<D>> points;
    std::vector<Halfspace<D>> halfspaces;
    Sandwich<D> sandwich;
  };
  explicit Body(std::shared_ptr<const Storage> data) : data_(std::move(data)) {}

  std::shared_ptr<const Storage> data_;
};

}  // namespace pd::dimension
