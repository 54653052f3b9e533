/// @file
/// The kernel of Gauss maps for two boxes uses that P = B + (-A) is a zonotope of six generators. The normals of its
/// facets are the cross products of pairs of generators, fifteen up to sign. Along u x v, the product of two edges, the
/// other four half edges reach.
///
/// The depth of two boxes (gauss_sat_boxes.hpp) and their contact points (contact/box_contact.hpp) are made of it. It
/// is compiled for several instruction sets. Every lane is computed on its own, so that all of them give the same bits.
#pragma once

#include <optional>

#include "numeric/unit_roundoff.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

/// A box whose edges run along the axes of its own frame.
struct BoxFrame {
  Vec3 centre;
  Vec3 half_extents;
};

/// Returns centre and half extents, rounded, of a polytope that is exactly such a box; else nothing.
[[nodiscard]] std::optional<BoxFrame> box_frame(const ConvexPolytope& p);

/// Vertices of a box are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
constexpr int bit_of_box_axis(int axis) { return 4 >> axis; }

/// Returns the facet of such a polytope across an axis, at its upper or lower end.
[[nodiscard]] int facet_of_box(const ConvexPolytope& p, int axis, bool positive);

/// The rows of a posed box's rotation and its half extents, each with a 0 behind them.
struct BoxRows {
  const double (&x)[4];
  const double (&y)[4];
  const double (&z)[4];
  const double (&half_extents)[4];

  [[nodiscard]] Vec3 axis(int k) const { return {x[k], y[k], z[k]}; }
  [[nodiscard]] Vec3 half_edge(int k) const { return half_extents[k] * axis(k); }
};

/// Returns the vertex of a box that is farthest along sign * normal; on equal heights the one with the lowest id.
[[nodiscard]] int farthest_of_box(const BoxRows& of, const Vec3& normal, double sign);

/// The fifteen axes stand in blocks of four slots, and the last slot of each block is empty. Block 0 holds the products
/// of A's edges lane and lane + 1, block 1 those of B's, block 2 + i those of A's edge i and B's edge lane.
inline constexpr int kBoxAxes = 15;
inline constexpr int kBoxAxisSlots = 20;

/// A slot by its block and lane.
struct BoxAxis {
  int block, lane;
  explicit constexpr BoxAxis(int slot) : block(slot / 4), lane(slot % 4) {}
  [[nodiscard]] constexpr bool is_of_edges() const { return block >= 2; }
  /// The axis of its box across which a facet lies; lanes span (0, 1), (1, 2), (2, 0).
  [[nodiscard]] constexpr int across() const { return (lane + 2) % 3; }
  /// The edges of A, and those of B, that span the facet of P, as bits.
  [[nodiscard]] constexpr int flat_a() const { return flat(0, block - 2); }
  [[nodiscard]] constexpr int flat_b() const { return flat(1, lane); }

 private:
  [[nodiscard]] constexpr int flat(int own, int edge) const {
    return block == own ? 7 & ~bit_of_box_axis(across()) : block < 2 ? 0 : bit_of_box_axis(edge);
  }
};

/// The cross product of two unit axes turns by at most this over the sine of their angle: each errs by 3u, the product
/// by 4u.
inline constexpr double kBoxTurn = 12 * kUnitRoundoff;

/// Two boxes in one frame.
struct PosedBoxes {
  BoxRows a, b;
  double centre[3];  ///< of P: of B from that of A
  double reach;      ///< at least the distance of any two of the boxes' points

  /// True if all numbers of the axes have the 24 digits of single precision. Their products are then exact, so that
  /// even edges turned by 1e-7 span a plane known to 2u.
  [[nodiscard]] bool has_single_axes() const;
  /// Returns the largest |coordinate| of P, rounded: |c| + sum |g| for each coordinate.
  [[nodiscard]] double greatest_coordinate() const;
  /// Returns the height of P over its centre, along a normal of any length.
  [[nodiscard]] double height_along(const Vec3& n) const;
  /// Bounds the rounding of the points that meet at a foot.
  [[nodiscard]] double slack() const { return 64 * kUnitRoundoff * reach; }
  [[nodiscard]] Vec3 centre_vector() const { return {centre[0], centre[1], centre[2]}; }
  /// Returns the cross product of the two axes that span the facets of a slot.
  [[nodiscard]] Vec3 normal_of(BoxAxis axis) const;
  /// Returns n at unit length, turned away from P's centre as the origin sees it.
  [[nodiscard]] Vec3 outward(const Vec3& n) const { return n * ((n.dot(centre_vector()) > 0 ? -1 : 1) / n.norm()); }
};

/// The signed distance of two boxes and the axis that tells it.
struct BoxDistance {
  int axis = 0;         ///< a slot
  Vec3 normal;          ///< unit; away from P's centre as the origin sees it
  double height = 0;    ///< of P along the normal, over the origin: the depth, or minus a gap; errs by `rounding`
  double rounding = 0;  ///< error of `height`, that of the normal included
  double depth = 0;     ///< > 0: certified, a ball of this radius about the origin lies in P
  double slivers = 0;   ///< taken off that depth, for edges parallel up to rounding
  /// By slot: sign * square of the facets' distance, less the error of their normal's turn; infinity where edges are
  /// parallel up to rounding.
  double lower_keys[kBoxAxisSlots];
};

/// The facets' distances err by 12u of the reach for half edges and centre, and by 8u for the sum of products.
[[nodiscard]] inline double box_rounding(double reach) { return 20 * kUnitRoundoff * reach; }

/// Why it proves anything: every facet of P is spanned by two edges. A computed normal turns from the true one by
/// rounding over the sine of their angle, and h_P changes by at most that times the reach. Two edges parallel up to
/// rounding are taken for parallel: turning one into the other's direction moves no point of P by more than that sine
/// times its length.
[[nodiscard]] BoxDistance distance_of_boxes(const PosedBoxes& boxes);

/// A pair of points, one of either body, whose difference is the foot of the origin on a plane of P.
struct FootPoints {
  Vec3 point_a = Vec3::Zero();
  Vec3 point_b = Vec3::Zero();
  double missed = 0;  ///< how far the difference is from the foot
  /// The vertices that are farthest along the plane's normal; on equal heights those with the lower ids.
  VertexPair farthest{0, 0};
};

/// Finds the foot of the origin on the plane of `found` as points of both faces, by projecting from one face to the
/// other: if two flush faces cross, no corner of one need lie on the other.
/// @param centre_a  of A, in the frame of the answer
/// @param level     heights that count as one
[[nodiscard]] FootPoints foot_of_boxes(const PosedBoxes& boxes, const Vec3& centre_a, const BoxDistance& found,
                                       double level);

}  // namespace pd::detail
