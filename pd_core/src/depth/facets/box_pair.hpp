/// @file
/// Two posed boxes as the generators of P, and the axis along which they are least deep or farthest apart: what the
/// depth of two boxes (box_sat.hpp) and their contact points (contact/box_contact.cpp) are both made of.
#pragma once

#include "depth/facets/box_sat_kernels.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

/// The cross product of two generators turns by at most this over the sine of their angle: each errs by 3u of its
/// length, the product by 4u.
inline constexpr double kBoxTurn = 12 * kUnitRoundoff;
/// Sines below this are rounding.
inline constexpr double kBoxParallelSine = 8 * kUnitRoundoff;

/// A box whose edges run along the axes of its own frame.
struct BoxFrame {
  Vec3 centre;
  Vec3 half_extents;
};

/// Where two boxes are along the axis that tells their signed distance.
struct BoxDistance {
  int axis = 0;       ///< of `nearest_box_axis`
  Vec3 normal;        ///< unit; away from P's centre as the origin sees it
  double height = 0;  ///< of P along the normal, over the origin: the depth, or minus a gap; errs by `rounding`
  double rounding = 0;
  double depth = 0;  ///< > 0: certified, a ball of this radius about the origin lies in P
};

/// A pair of points, one of either box, whose difference is the foot of the origin on P's plane.
struct BoxFoot {
  Vec3 point_a = Vec3::Zero();  ///< relative to A's translation
  Vec3 point_b = Vec3::Zero();  ///< relative to A's translation, too
  double missed = 0;            ///< how far the difference is from the foot
};

/// Vertices are numbered lexicographically: 4 for +x, 2 for +y, 1 for +z.
constexpr int bit_of_box_axis(int axis) { return 4 >> axis; }

/// A box by its half edges, about a centre.
struct BoxHalfEdges {
  Vec3 edges[3];
  Vec3 centre;
};

/// The foot of the origin on the plane of `found`, met by points of both faces that are found by projecting from one to
/// the other: of two flush faces that cross, no corner lies on the other.
/// @param a, b   in the frame of the answer
/// @param level  heights that count as one
/// @param reach  at least the distance of any two of the boxes' points
[[nodiscard]] BoxFoot foot_of_boxes(const BoxHalfEdges& a, const BoxHalfEdges& b, const BoxDistance& found,
                                    double level, double reach);

class BoxPair {
 public:
  /// @param radius_a, radius_b  upper bounds of the vertices' distance from the frames' origins.
  BoxPair(const BoxFrame& frame_a, const Pose& pose_a, double radius_a, const BoxFrame& frame_b, const Pose& pose_b,
          double radius_b);

  /// For Bracket::contact. Rotations in single precision have columns whose products are exact, so that even edges
  /// turned by 1e-7 span a plane known to 2u.
  [[nodiscard]] BoxDistance distance() const;

  /// `foot_of_boxes`
  [[nodiscard]] BoxFoot foot(const BoxDistance& found, double level) const;

  /// How far the points of a foot may lie beside it by rounding.
  [[nodiscard]] double slack() const;

 protected:
  static constexpr int bit(int axis) { return bit_of_box_axis(axis); }
  static Vec3 generator(const BoxGenerators& of, int i) { return {of.x[i], of.y[i], of.z[i]}; }
  /// The two generators whose product is the normal of an axis.
  static void spanning(const BoxGenerators& a, const BoxGenerators& b, int axis, Vec3& u, Vec3& v);
  /// Of unit length, away from P's centre as the origin sees it.
  [[nodiscard]] Vec3 outward(const Vec3& n) const { return n * ((n.dot(centre_) > 0 ? -1 : 1) / n.norm()); }
  /// L, rounded: |c| + sum |g| a coordinate.
  [[nodiscard]] double greatest_coordinate() const;

  /// The vertex farthest along `sign` * normal; on equal heights the one with the lower id.
  static int farthest(const BoxGenerators& of, const Vec3& normal, double sign);

  const Mat3& rotation_a_;  ///< of the pose, which has to outlive this
  const Mat3& rotation_b_;
  const Vec3 centre_a_;  ///< relative to A's translation
  const Vec3 centre_b_;  ///< relative to A's translation, too
  const Vec3 centre_;    ///< of P
  const double reach_;
  BoxGenerators of_a_;
  BoxGenerators of_b_;
};

}  // namespace pd::detail
