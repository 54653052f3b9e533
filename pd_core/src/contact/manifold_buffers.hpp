/// @file
/// What a `ManifoldScratch` holds.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/manifold_clip.hpp"
#include "contact/supporting_face.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

/// A corner of the intersection of two faces, lifted to both.
struct LiftedCorner {
  double height_b;  ///< of B's surface
  double depth;
  std::int64_t id;
};

struct ManifoldBuffers {
  SupportingFace face_a;
  SupportingFace face_b;
  ClipBuffers clip;
  std::vector<LiftedCorner> lifted;  ///< of two faces
  std::vector<ContactPoint> points;  ///< of a face on a half-space
  std::vector<Vec2> flat;            ///< either across the normal
};

}  // namespace pd::detail
