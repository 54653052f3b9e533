/// @file
/// The faces of two boxes that face each other, cut by each other across the contact normal (Sutherland, Hodgman 1974):
/// the corners of which the contact points of two boxes are made.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include <cstdint>

#include "contact/manifold_clip.hpp"
#include "pd/contact/box_contact.hpp"

namespace pd::detail {

/// Four corners cut by four lines have eight corners at most.
inline constexpr int kMostBoxCorners = 8;

/// Corners of the intersection within the breaking threshold, on B's face: centre + s first + t second.
struct BoxCorners {
  double centre[3], first[3], second[3];  ///< of B's face, about the centre of A
  int count = 0;
  double s[kMostBoxCorners], t[kMostBoxCorners];
  double depth[kMostBoxCorners];        ///< of A's face below, along the normal; <= the boxes' own
  std::uint16_t kind[kMostBoxCorners];  ///< which features meet there: `feature_id`
  double deepest = 0;                   ///< of them all, at least minus the threshold
  double size = 0;                      ///< of the intersection
};

[[nodiscard]] inline std::int64_t feature_id(std::uint16_t kind) {
  return make_id(static_cast<IdKind>(kind >> 8), kind >> 4 & 15, kind & 15);
}

/// @param centre_b  from that of A
/// @param n  unit, from B to A
/// @param signed_depth  of the boxes along it
void box_corners(const BoxInRows& a, const BoxInRows& b, const double (&centre_b)[3], const double (&n)[3],
                 double signed_depth, double breaking_threshold, BoxCorners& out);

/// The points at the first four corners: on A, on B, depth, and one number that says nothing.
/// @param origin  the centre of A
void points_at_corners(const BoxCorners& corners, const double (&n)[3], const double (&origin)[3], double (&out)[4][8]);

}  // namespace pd::detail
