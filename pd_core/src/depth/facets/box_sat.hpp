/// @file
/// Depth of two boxes, in doubles with a certificate: the fifteen axes of separation (box_sat_kernels.hpp), no search.
///
/// Why it proves anything: every facet of P is spanned by two generators. A computed normal turns from the true one by
/// rounding over the sine of their angle, and h_P changes by at most that times the reach. Two generators parallel up
/// to rounding are taken for parallel: turning one into the other's direction moves no point of P by more than that
/// sine times its length. Planes whose normals lie next to the winner's are as far as its foot, which lies in P.
///
/// The certificate fails, and the caller grows a surface, where the bracket is too wide (edges nearly but not quite
/// parallel, unless they cross along the winner's normal), where the point below the origin is not inside the winner,
/// and where the class is in doubt.
#pragma once

#include <array>
#include <optional>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/difference/bracket_width.hpp"
#include "depth/facets/box_pair.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/feature.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

inline constexpr int kBoxAxes = 15;

/// Centre and half extents, rounded, of a polytope that is exactly such a box.
std::optional<BoxFrame> box_frame(const ConvexPolytope& p);

/// The facet of such a box across an axis, at its upper or lower end.
int facet_of_box(const ConvexPolytope& p, int axis, bool positive);

/// The vertices of a box that differ from one of them in bits of `flat` alone; 4 for x, 2 for y, 1 for z.
void collect_box_face(int flat, int vertex, SupportFace& face);

enum class BoxPairStatus : std::uint8_t { certified, separated, undecided };

struct BoxPairDepth {
  BoxPairStatus status = BoxPairStatus::undecided;
  double lower = 0;
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit; separating when status says so
  /// Of boxes that one of the fifteen axes separates: corners of the facet of P across it.
  std::optional<SurfaceCorners> nearest;
  Feature feature_a;
  Feature feature_b;
  Vec3 point_a = Vec3::Zero();  ///< witness on A, relative to A's translation
};

/// @param width  the certified bracket's greatest width.
/// Requires extents between 2^-100 and 2^100. Constant time, no allocation.
BoxPairDepth box_pair_depth(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                            const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                            const BracketWidth& width);

/// The signed distance of two boxes for Bracket::contact.
struct BoxPairContact {
  bool certified = false;  ///< lower <= signed distance <= upper, as narrow as asked, and the points are in place
  double lower = 0;        ///< always a bound: P lies below -lower along the normal
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit; the plane of `lower`
  Feature feature_a;
  Feature feature_b;
  Vec3 point_a = Vec3::Zero();  ///< of A, and of B, relative to A's translation
  Vec3 point_b = Vec3::Zero();
};

/// Boxes that overlap, touch or are apart, flush or not, wherever the point of P nearest to the origin lies inside of a
/// facet. Two things differ from `box_pair_depth`. Rotations in single precision have columns whose products are exact,
/// so that even edges turned by 1e-7 span a plane known to 2u; the product of rounded generators errs by 12u over that
/// sine, more than a contact may leave open. And the foot of the origin is met by any points of both faces, found by
/// projecting from one to the other: of two flush faces that cross, no corner lies on the other.
BoxPairContact box_pair_contact(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                                const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                                const BracketWidth& width);

/// The facets of P that may be nearest to the origin, for a proof on the stored numbers: two to a pair of generators,
/// one on either side.
struct BoxNearFacets {
  static constexpr int kMost = 16;
  int count = 0;                           ///< 0: the class is in doubt, or there are more
  std::array<SurfaceCorners, kMost> near;  ///< a triangle in each, the nearest first
  std::array<std::int8_t, kMost> axis;     ///< slots of `box_axis_keys`
  double beyond = 0;                       ///< what no other facet is nearer than, for certain
  std::optional<FacetOfDifference> only;   ///< the one facet of `near`, where its plane supports P for certain
  /// Bit 3 i + j: edge i of A and edge j of B are parallel up to rounding. If they are not exactly, their facets are
  /// not among the above, and may be as near.
  unsigned parallel = 0;
};

/// Requires extents between 2^-100 and 2^100. Constant time, no allocation.
/// @param faces  filled with the faces in the plane of `only`.
BoxNearFacets box_near_facets(const ConvexPolytope& a, const BoxFrame& frame_a, const Pose& pose_a,
                              const ConvexPolytope& b, const BoxFrame& frame_b, const Pose& pose_b,
                              SupportFaces& faces);

}  // namespace pd::detail
