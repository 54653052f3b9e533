/// @file
/// The plane of P that is nearest to the origin, and whether a translation reaches it, exactly.
#pragma once

#include <limits>
#include <optional>

#include "depth/certificate/facet_plane.hpp"
#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/difference/exact_support.hpp"

namespace pd::detail {

/// The plane {x : weight <normal, x> = level} that supports P and carries its boundary point nearest to the origin. The
/// signed distance of the cores is level / (weight |normal|): positive inside.
struct NearestPlane {
  ExactDirection normal;
  Dyadic weight;  ///< > 0
  Dyadic level;
};

/// The plane of a facet of P.
[[nodiscard]] NearestPlane exact_plane(const PosedPair& pair, const FacetOfDifference& facet);
/// The plane through the point of P nearest to the origin, outside P, normal to it.
[[nodiscard]] NearestPlane exact_plane(const ExactClosestPoint& nearest);

/// Where the half-space beyond the nearest plane of P, swept by a ball of radius r, begins: decides whether a
/// translation reaches it. Double-double where that is certain, exact numbers behind it.
class Separation {
 public:
  /// Known exactly from the start.
  Separation(NearestPlane plane, const Dyadic& r);
  /// The plane of a facet, made exact only where it must be. Refers to the pair. The plane must be known.
  Separation(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane, double margin_a,
             double margin_b);

  /// The plane of cores that are apart, which the margins make overlap; the same.
  Separation(const PosedPair& pair, const ProvenSeparation& proof, double margin_a, double margin_b);

  /// <normal, t> >= h_P(normal) + r |normal|, exactly.
  [[nodiscard]] bool reached(const Vec3& t);

  [[nodiscard]] const Vec3DD& unit() const { return unit_; }
  /// |t| of the translation to the nearest point, signed, and a bound of its error (infinite where the plane was given
  /// exactly).
  [[nodiscard]] const DoubleDouble& depth() const { return depth_; }
  [[nodiscard]] double depth_error() const { return depth_error_; }
  /// Whether the above are what double-double measured, each coordinate of `unit` within `unit_error`.
  [[nodiscard]] bool measured() const { return depth_error_ < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] double unit_error() const { return unit_error_; }
  /// How much farther than `depth * unit`, for a depth known as well as this plane, a translation must go along `unit`
  /// to reach the plane for certain.
  [[nodiscard]] double slack(const DoubleDouble& depth) const;
  /// Computed when first asked for.
  [[nodiscard]] const NearestPlane& plane();
  [[nodiscard]] const Dyadic& radius() {
    static_cast<void>(plane());
    return radius_;
  }

 private:
  void measure(const PosedPair& pair, const FacetPlane& plane, double margin_a, double margin_b);

  const PosedPair* pair_ = nullptr;
  FacetOfDifference facet_;
  const ProvenSeparation* apart_ = nullptr;  ///< instead of a facet
  DoubleDouble margins_;
  std::optional<NearestPlane> plane_;
  Dyadic radius_;
  Vec3DD unit_;
  double unit_error_ = 0;
  int axis_ = -1;       ///< of the plane, where its depth has no error
  DoubleDouble depth_;  ///< of the second stage, in the input's lengths
  double depth_error_;
};

}  // namespace pd::detail
