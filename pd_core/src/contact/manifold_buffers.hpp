/// @file
/// What a `ManifoldScratch` holds.
#pragma once

#include <vector>

#include "contact/manifold_clip.hpp"
#include "contact/supporting_face.hpp"
#include "pd/contact/manifold.hpp"

namespace pd::detail {

struct ManifoldBuffers {
  SupportingFace face_a;
  SupportingFace face_b;
  ClipBuffers clip;
  std::vector<ContactPoint> points;
  std::vector<Vec2> flat;  ///< the points across the normal
};

}  // namespace pd::detail
