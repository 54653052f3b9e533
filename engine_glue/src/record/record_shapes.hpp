/// @file
/// The shapes of a contact record: each written once, before the first contact that names it.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>

#include "pd/record/pd_record.h"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

class RecordShapes {
 public:
  /// Ids of shapes, which are written when they are new. Empty where a shape has no exact form.
  std::optional<std::string> convex(pd_record& record, const btConvexShape& shape);
  /// Boxes, those of the plane, and what scales them, without the round corners of a margin; other shapes as `convex`.
  std::optional<std::string> sharp(pd_record& record, const btConvexShape& shape);
  std::string plane(pd_record& record, const btStaticPlaneShape& shape);
  /// A triangle, as the caller converted it.
  std::string triangle(pd_record& record, const ConvexShape& triangle);

 private:
  /// The id of a shape that is known by this number; `write` writes it where it is new.
  template <class Write>
  std::string known(std::uint64_t number, Write&& write);

  std::unordered_map<std::uint64_t, std::int64_t> ids_;  ///< by fingerprint; looked up only
};

}  // namespace pd::detail
