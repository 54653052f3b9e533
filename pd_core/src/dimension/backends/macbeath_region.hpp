/// @file
/// Macbeath regions of a polar body, each as an ellipsoid and the cone of directions that it shadows from O.
///
/// K* = {x : <p, x> <= 1 for all points p of K}, so that h_K(v) = 1 / (length of v's ray in K*). The Macbeath region of
/// x in K* is M(x) = K* intersected with its reflection in x: x + {z : |<p, z>| <= 1 - <p, x> for all p}. An ellipsoid
/// about x inside it, scaled by c, keeps every y in it at <q, y> >= 1 - (1 + c)(1 - <q, x>) for each q, and inside
/// K*. So if q is the point whose facet the ray through x hits, x = (1 - delta) times the hit, every v through the
/// ellipsoid has <q, v> >= (1 - (1 + c) delta) h_K(v).
///
/// That bound is for the worst body. What q answers is the pyramid {y : <q, y> <= 1, <q, y> >= (1 - epsilon) <p, y> for
/// all p of K}, which holds such an ellipsoid's shadow; the Macbeath region of x in the pyramid casts a larger one, by
/// up to the slack of the bound, and its ellipsoid grows until a p stops it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

/// {v : v' form v >= 0, <axis, v> > 0}: the directions whose rays meet an ellipsoid that does not hold O, a convex
/// cone; all directions where it does.
struct ShadowCone {
  AnyMatrix form;
  AnyVector axis;
  bool everything = false;

  [[nodiscard]] bool contains(const AnyVector& v) const {
    return everything || (dot(axis.data(), v.data(), v.size()) > 0 && quadratic(form, v.data()) >= 0);
  }
};

struct MacbeathRegion {
  std::int32_t point;   ///< q: the point of K whose facet of K* the ray through x hits
  AnyVector center;     ///< x
  AnyMatrix ellipsoid;  ///< {x + z : z' ellipsoid z <= 1} lies in M(x), certified against every point

  /// Of the region's ellipsoid scaled by c, which must leave O outside.
  [[nodiscard]] ShadowCone shadow(double c) const;
};

/// The points of K that regions are cut from. O lies inside K.
class PolarBody {
 public:
  /// Requires a point.
  explicit PolarBody(std::vector<AnyVector> points) : points_(std::move(points)) {}

  [[nodiscard]] int dimension() const { return static_cast<int>(points_[0].size()); }
  [[nodiscard]] std::int32_t extreme(const AnyVector& v) const;
  /// The region at (1 - delta) times the end of v's ray.
  /// @param candidates  points that may bound it: a start; every point is checked before the end
  [[nodiscard]] MacbeathRegion region(const AnyVector& v, double delta, std::span<const std::int32_t> candidates) const;
  /// The region of the end of v's ray, drawn in by `depth`, in the pyramid of what the point there answers, grown as
  /// far as its shadow stays in that: <q, y> >= (1 - epsilon) h_K(y) for every y of the shadow of scale 1.
  [[nodiscard]] MacbeathRegion answering_region(const AnyVector& v, double depth, double epsilon,
                                                std::span<const std::int32_t> candidates) const;
  /// The points that can bound the regions between this one and the boundary, in its shadow.
  [[nodiscard]] std::vector<std::int32_t> neighbours(const MacbeathRegion& region,
                                                     std::span<const std::int32_t> candidates) const;
  [[nodiscard]] const std::vector<AnyVector>& points() const { return points_; }

 private:
  /// The largest ellipsoid about O, nearly, in the slabs |<slab(p), z>| <= 1: of the candidates in shape, of all in
  /// size.
  template <class Slab>
  [[nodiscard]] AnyMatrix ellipsoid_in(const Slab& slab, std::span<const std::int32_t> candidates) const;

  std::vector<AnyVector> points_;
};

}  // namespace pd::dimension::detail
