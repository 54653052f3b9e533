/// @file
/// A piece of a union of convex pieces (a triangle of a mesh, a part of a compound) near a contact, as planes without
/// its margin, and what it covers.
///
/// Let n be a unit direction, outward from another piece that touches at a point c. A piece covers c against n if c
/// lies in it and it has a way d from c with <n, d> > 0. A body that left the other piece along n still stands in it.
/// The largest such <n, d> over unit d is the sine of the angle between n and the piece's normal cone at c.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

/// A half-space that a piece lies in.
struct PiecePlane {
  Vec3 normal;  ///< unit, outward
  double offset;
  [[nodiscard]] double height(const Vec3& point) const { return normal.dot(point) - offset; }
};

struct UnionPiece {
  std::vector<PiecePlane> planes;  ///< the piece is where all heights are <= 0
  Vec3 middle = Vec3::Zero();      ///< of its corners
  double margin = 0;
  bool flat = false;  ///< a triangle: its first two planes are its two sides, the others its edges, corner to next
};

/// A way that leads less than this (as a sine) against a normal covers nothing: a contact that is off by so much gives
/// a body that rests on it 1e-4 m/s a second aside.
inline constexpr double kLevel = 1e-5;
/// A sine from which on a contact is covered beyond doubt; below, it is one of the facet's own if its normal is near.
inline constexpr double kDecided = 0.02;
/// More than this is not told apart.
inline constexpr double kBeyondDoubt = 2 * kDecided;

/// How far the surfaces of pieces that are meant to meet may lie apart: 2^-18 of the bodies, and the rounding of poses.
/// @param size  radius of the smaller body
/// @param farthest  largest coordinate of the poses
/// @param pose_rounding  share of its size by which the host's scalar may be off a coordinate, a few times over
[[nodiscard]] double seam_slack(double size, double farthest, double pose_rounding);
[[nodiscard]] double seam_slack(const PosedShape& a, const PosedShape& b, double pose_rounding);

/// Sides first, then edges; no planes where the corners are no triangle.
void set_triangle(const std::array<Vec3, 3>& corners, double margin, UnionPiece& piece);
/// No planes where the shape is no solid polytope.
void set_solid(const ConvexShape& shape, const Pose& pose, UnionPiece& piece);
/// Calls `set_triangle` for a triangle and `set_solid` for any other body.
void set_piece(const PosedShape& body, UnionPiece& piece);

/// The part of segment or polygon `points` (in place) that lies in the piece, each plane moved out by `slack`.
void clip_to_piece(const UnionPiece& piece, double slack, std::vector<Vec3>& points, std::vector<Vec3>& spare);

/// The largest <n, d> as above, 0 where the piece has no such way; -1 where `point` lies outside of it by more than
/// `slack`. Planes within `slack` of the point count as touching it. Time O(k^3) in those. `active` is memory for them.
/// @param enough  a sine from which on no larger one is looked for.
[[nodiscard]] double covered_sine(const UnionPiece& piece, const Vec3& point, const Vec3& n, double slack,
                                  double enough, std::vector<const PiecePlane*>& active);

}  // namespace pd
