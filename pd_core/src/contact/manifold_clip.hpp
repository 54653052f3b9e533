/// @file
/// Two supporting faces cut by each other across the contact normal: the points of which a manifold is made.
///
/// Both faces are flattened along the normal; the polygon of one is cut to the inside of the other's, edge by edge
/// (Sutherland, Hodgman 1974). Each corner carries an id of the features that meet in it, so that a contact point is
/// found again in the next frame.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/supporting_face.hpp"

namespace pd::detail {

using Vec2 = Eigen::Vector2d;

/// A corner of the clipped polygon and the edge that leaves it: an edge of A's loop (`edge_of_b` false) or of B's.
struct ClipVertex {
  Vec2 point;
  std::int64_t id;
  std::int32_t edge;
  bool edge_of_b;
};

/// What a contact point is made of, the highest bits of its id.
enum class IdKind : std::int64_t { vertex_a = 0, vertex_b = 1, crossing = 2, witness = 3 };

constexpr std::int64_t make_id(IdKind kind, std::int64_t a, std::int64_t b) {
  constexpr std::int64_t kMask = (std::int64_t{1} << 25) - 1;
  return (static_cast<std::int64_t>(kind) << 50) | ((a & kMask) << 25) | (b & kMask);
}

/// A right-handed frame (u, w, n) about an origin near the contact, n the contact normal.
struct ContactFrame {
  Vec3 u, w, n, origin;

  ContactFrame(const Vec3& normal, const Vec3& centre) : n(normal), origin(centre) {
    int smallest = 0;
    n.cwiseAbs().minCoeff(&smallest);
    u = n.cross(Vec3::Unit(smallest)).normalized();
    w = n.cross(u);
  }
  [[nodiscard]] Vec2 flatten(const Vec3& x) const { return {(x - origin).dot(u), (x - origin).dot(w)}; }
  [[nodiscard]] double height(const Vec3& x) const { return (x - origin).dot(n); }
};

/// a x b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Heights along n, above points of the plane across n, of a face: of its plane, or of its segment at the nearest
/// parameter.
class FaceHeight {
 public:
  FaceHeight(const SupportingFace& face, const ContactFrame& frame);
  [[nodiscard]] double above(const Vec2& p) const {
    if (corners_ == 1) return height_;
    const Vec2 offset = p - start_;
    if (corners_ == 2) {
      const double s = scale_ > 0 ? std::clamp(offset.dot(along_) / scale_, 0.0, 1.0) : 0.0;
      return (1 - s) * height_ + s * end_;
    }
    return height_ - (offset.x() * along_.x() + offset.y() * along_.y()) / scale_;
  }

 private:
  std::size_t corners_;
  Vec2 start_;      ///< of the first corner
  double height_;   ///< of it
  Vec2 along_;      ///< to the second corner of a segment, or the plane's normal across n
  double scale_;    ///< the segment's squared length, or the plane's normal along n
  double end_ = 0;  ///< height of the segment's second corner
};

/// Grown on first use.
struct ClipBuffers {
  std::vector<ClipVertex> polygon;  ///< the intersection
  bool whole_rim = false;           ///< it is all of a disc's rim
  std::vector<ClipVertex> window;
  std::vector<ClipVertex> clipped;
  std::vector<double> sides;  ///< of the polygon's corners, of one edge of the window
};

/// The intersection of two faces across n: a polygon, a segment as a loop of two, or nothing where a face is a single
/// point (the witnesses are the contact then), or the faces miss each other.
/// @param most_aside  how far the corners of two segments' intersection may lie beside B's segment, as a share of both
/// lengths
void intersect_faces(const SupportingFace& a, const SupportingFace& b, const ContactFrame& frame, double most_aside,
                     ClipBuffers& buffers);

}  // namespace pd::detail
