/// @file
/// The boundary of a union of convex polytopes P_k, exact, and as little of it as a question needs.
///
/// A facet of P_k is part of the boundary of int(union) where it is not covered: where it lies neither in the interior
/// of another P_l nor against a facet of P_l that faces it. So a slot of zero width between two P_k is covered on both
/// sides: it is no part of the boundary, and no way out.
///
/// Searches are best first: facets wait in the order of their distance from the origin (or of the ray's parameter); the
/// first is asked which P_k hold its nearest point; one of them is subtracted, exactly, and what is left goes back in
/// the queue. A polygon whose nearest point no P_k holds ends the search. Each cut takes one P_k off a polygon's list
/// for good, so that every search ends. The nearest point is sought cube by cube (`CoverCells`), among the P_k that
/// meet the cube. A search in doubles closes slots that are narrower than a slack (`nearest_past_seams`).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "compound/part_differences.hpp"

namespace pd::detail {

class UnionMemory;

class UnionBoundary {
 public:
  /// Refers to the differences. Searches make those that they need; `free_piece_near` requires all to be made exactly.
  explicit UnionBoundary(PartDifferences& differences);

  /// A point of the union's boundary, and the facet that it lies on.
  struct BoundaryPoint {
    std::size_t piece = 0;
    std::size_t facet = 0;
    PlanePolygon polygon;   ///< part of that facet, uncovered around the point
    Vec3 x = Vec3::Zero();  ///< in doubles (inside lengths)
  };

  /// The boundary point nearest to the origin and a lower bound of its distance; nothing when the limit of facets was
  /// exceeded. Inside lengths. Requires the origin in the interior of the union, and the P_k of every facet within the
  /// distance sought to be there.
  /// @param known_lower  no boundary point is nearer: what lies inside that ball is not looked at.
  /// @param reach        a boundary point lies within this distance.
  struct Nearest {
    BoundaryPoint where;
    double lower = 0;         ///< the distance itself, rounded down
    bool projection = false;  ///< that point is the projection of the origin on the facet's plane, exactly
  };
  /// @param memory       nullptr, or the last frame's.
  [[nodiscard]] std::optional<Nearest> nearest(double known_lower, double reach, UnionMemory* memory);

  /// The nearest boundary point in doubles if slots and seams narrower than `slack` are closed: a P_k covers a point of
  /// a facet if it holds, up to the slack, the point two slacks farther out.
  struct PastSeams {
    std::size_t piece = 0;
    Vec3 x = Vec3::Zero();
  };
  /// Bounds of the origin's signed distance from a P_k, negative inside.
  struct SignedDistance {
    double least = 0;
    double most = 0;
  };
  using Measure = std::function<SignedDistance(std::size_t k)>;
  /// Makes a P_k when the search has come as far as the origin is deep in it, or apart from it.
  /// @return nothing if there is no P_k, or if the limit of facets was exceeded
  [[nodiscard]] std::optional<PastSeams> nearest_past_seams(double slack, const Measure& measure);

  /// Whether a point (inside lengths, as stored) lies on the boundary, exactly. `held` tells whether a closed P_k holds
  /// it: held and not on the boundary is inside.
  [[nodiscard]] std::optional<BoundaryPoint> at(const Vec3& x, bool& held);

  /// The least t >= 0 for which t d lies on the boundary, exact; nothing when the ray meets none.
  struct Hit {
    BoundaryPoint where;
    RayParameter t;
  };
  /// @param direction  `exact` rounded; its largest |coordinate| in [1, 2).
  [[nodiscard]] std::optional<Hit> along(const Vec3& direction, const Dyadic3& exact);

  /// Every piece of the boundary once, in the order of P_k and facets. Returns false when the visitor stops it, when
  /// the limit of facets was exceeded, and when `Counts::work` is beyond `max_work`.
  using Visitor = std::function<bool(const BoundaryPoint&)>;
  bool visit_all(const Visitor& visitor, std::int64_t max_work);

  /// Whether an uncovered part of the boundary of the union of these P_k may meet a box (inside lengths); false is
  /// certain.
  [[nodiscard]] bool free_piece_near(const Vec3& low, const Vec3& high, const std::vector<std::size_t>& among);

  /// Whether x (inside lengths, as stored) lies outside every closed P_k, exactly.
  [[nodiscard]] bool outside_all(const Vec3& x) const;
  /// A triple of doubles outside int(union), exactly, within a few ulp of a boundary point that was found.
  [[nodiscard]] Vec3 free_placement(const BoundaryPoint& where) const;

  struct Counts {
    std::int64_t polygons = 0;  ///< clipped from the queue
    std::int64_t cuts = 0;      ///< P_k subtracted from a polygon
    std::int64_t cells = 0;     ///< cubes looked at
    std::int64_t passed = 0;    ///< facets that are covered for certain, in doubles
    std::int64_t tests = 0;     ///< P_k held against cubes and polygons, in doubles

    /// The unit is the time of a polygon that is looked at.
    [[nodiscard]] std::int64_t work() const { return polygons + cuts + passed / 16 + tests / 512; }
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  class NearestSearch;
  class SeamSearch;
  using ClippedSet = std::vector<std::uint64_t>;  ///< a bit for each P_k that was subtracted (or is the polygon's own)
  struct Cell {
    BoundaryPoint where;
    ClippedSet clipped;
  };

  [[nodiscard]] ClippedSet own(std::size_t piece) const;
  static void mark(ClippedSet& clipped, std::size_t k) { clipped[k / 64] |= std::uint64_t{1} << (k % 64); }
  static bool has(const ClippedSet& clipped, std::size_t k) { return (clipped[k / 64] >> (k % 64) & 1) != 0; }

  /// Cuts P_k off a polygon of P_own. False when it covers none of it; else `rest_` holds what is left.
  /// @param once  of two facets that lie in one plane and look the same way, the later gives way.
  bool subtract(const PlanePolygon& polygon, std::size_t own, std::size_t k, bool once);
  /// The deepest P_k of `among`, not subtracted yet, that holds x within the tolerance; -1: none.
  [[nodiscard]] std::ptrdiff_t covering(const Vec3& x, const ClippedSet& clipped, double tolerance,
                                        std::span<const std::int32_t> among);

  /// A part of a facet that is still to be cut, and the P_k that may cover some of it.
  struct OpenCell {
    Cell cell;
    std::vector<std::int32_t> near;
  };
  /// Takes the P_k out of `near` that lie apart from a flat polygon, for certain. False when one P_k holds it.
  /// @param error  of a coordinate of a corner
  [[nodiscard]] bool narrow(const std::vector<Vec3>& corners, double error, std::vector<std::int32_t>& near);
  /// Cuts one P_k away that covers some of the cell and adds what is left to `open`; false when none does.
  bool split_one(OpenCell& cell, std::vector<OpenCell>& open);
  /// Sets `corners` to those of a facet in doubles (inside lengths). Requires P_k to be made roughly.
  void rough_corners(std::size_t k, std::size_t f, std::vector<Vec3>& corners) const;
  /// True if P_k holds all of these points in its interior, for certain.
  /// @param rounding  bounds how wrong a height of these points is
  [[nodiscard]] bool surely_holds(std::size_t k, const std::vector<Vec3>& points, double rounding);
  /// Whether a P_k that covered something recently contains all of a polygon in its interior, for certain.
  bool contained_in_recent(const PlanePolygon& polygon);
  /// Puts a P_k that covered something in front of those asked first.
  void mark_recent(std::size_t k);
  static constexpr std::size_t kRecent = 12;

  PartDifferences& differences_;
  const PlaneSet& planes_;
  std::vector<Box> boxes_;  ///< of the P_k
  std::vector<std::size_t> recent_;
  std::vector<PlanePolygon> rest_;
  Counts counts_;
};

}  // namespace pd::detail
