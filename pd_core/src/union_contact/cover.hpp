/// @file
/// Whether the feature of a piece that another body touches lies inside of the other pieces of its union.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/union_contact/covered_contact.hpp"
#include "pd/union_contact/piece_surroundings.hpp"

namespace pd::detail {

/// A normal nearer to a facet's than this (1 - cosine, about 1e-5 rad) is that facet's.
inline constexpr double kSameNormal = 1e-10;

/// One of the pair's two bodies as a piece of its union, and the other that touches it.
struct PieceSide {
  PieceSurroundings& around;
  const PosedShape& own;
  const PosedShape& other;
  bool is_b;
  Vec3 front = Vec3::Zero();  ///< the only side of a triangle, zero: both
  /// From the piece outward, for the answer's normal.
  [[nodiscard]] Vec3 outward(const Vec3& normal) const { return is_b ? normal : Vec3(-normal); }
  [[nodiscard]] const Vec3& on_piece(const ContactPoint& point) const {
    return is_b ? point.position_b : point.position_a;
  }
};

/// Whether a body is a polygon.
[[nodiscard]] bool is_flat(const PosedShape& body);

/// Points and directions are those of `frame()`, in which the piece and what is near it lie.
class Cover {
 public:
  Cover(const PieceSide& side, double slack, double window, CoverBuffers& buffers)
      : around_(side.around),
        own_(side.own),
        slack_(slack),
        window_(window),
        buffers_(buffers),
        frame_(side.around.frame()) {}

  /// Sets the piece at hand: one that is kept, or made anew. To be called first.
  void take_own();

  [[nodiscard]] const UnionFrame& frame() const { return frame_; }
  /// No planes: nothing is known of it, as of what is curved.
  [[nodiscard]] const UnionPiece& own() const { return *buffers_.own; }

  /// Collects what is near the contact: only what could cover its feature against n, or (n zero) all.
  /// @return whether there is anything
  bool look_round(const Vec3& foot, const Vec3& n);

  /// Whether what is no facet of the piece could be covered at `foot`, by what is known of it without looking round.
  [[nodiscard]] bool may_be_covered(const Vec3& foot) const;

  /// How far beyond doubt the feature of the piece at `foot` (on its core) that faces n is covered: the least sine over
  /// the corners of its part within the window, kBeyondDoubt where it is more; -1 where one is free. Of a facet, no
  /// more is found out than whether it is kDecided.
  double covered(Vec3 foot, const Vec3& n);

  /// True if a point of the piece's facet n lies in no other piece, nor on the surface of one.
  [[nodiscard]] bool lies_free(const Vec3& foot, const Vec3& n) { return most_covered(foot, n, kBeyondDoubt) < 0; }

  /// What other pieces cover of all of the piece's facet, and so of every part of it; `some` where that is not known.
  [[nodiscard]] FacetCover cover_of(std::size_t facet) const;

 private:
  /// What of the piece touches a point.
  struct Touched {
    bool any = false;
    int facet = -1;  ///< that of the normal asked for
    const PiecePlane* first = nullptr;
    const PiecePlane* second = nullptr;
    int count = 0;
  };

  /// How far the piece's farthest corner is from a point. Requires: the piece is flat.
  [[nodiscard]] double farthest_corner(const Vec3& foot) const;
  /// The largest sine of all pieces near at a point of this one's core, or one that is enough.
  double most_covered(const Vec3& point, const Vec3& n, double enough);
  /// @param foot  moved into the piece, and on the facet if there is one
  Touched touched_at(Vec3& foot, const Vec3& n) const;
  /// The window's corners in the plane of n.
  [[nodiscard]] std::array<Vec3, 4> window_corners(const Vec3& foot, const Vec3& n) const;
  /// Whether a corner of the window lies on the piece's facet and is not covered: it is one of the feature's, which
  /// need not be cut out then.
  bool has_free_corner(const Vec3& foot, const Vec3& n);
  /// The part of the feature within the window, by its corners. They lie in the piece up to half the slack, so that a
  /// flush neighbour holds them.
  void set_feature(const Touched& touched, const Vec3& foot, const Vec3& n);
  [[nodiscard]] const PiecePlane* edge_of_triangle(const Vec3& foot) const;

  PieceSurroundings& around_;
  const PosedShape& own_;
  double slack_;
  double window_;
  CoverBuffers& buffers_;
  const UnionFrame& frame_;
};

}  // namespace pd::detail
