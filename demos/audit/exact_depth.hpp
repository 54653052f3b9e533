/// @file
/// The exact signed depth of a recorded pair, as a certified interval.
#pragma once

#include <optional>

#include "audit/record_reader.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::audit {

/// lower <= x <= upper; x is the depth, or minus the distance.
struct SignedDepth {
  double lower = 0;
  double upper = 0;
};

/// Brackets of unions with curved or swept parts are not asked for closer than this: their cells grow with 1 / delta^2.
inline constexpr double kFinestUnionDelta = 1e-3;

/// The answer of the library. @param delta  relative, where no exact answer exists; in (0, 1]. Requires two bodies,
/// none a half-space. Empty where the library refuses (out_of_range, limit_exceeded).
[[nodiscard]] std::optional<PenetrationDepth> body_depth(const RecordedContact& contact, double delta,
                                                         Scratch& scratch);

/// x as an interval; `scale` is L. Empty as `body_depth`.
[[nodiscard]] std::optional<SignedDepth> signed_depth(const RecordedContact& contact, double tolerance, double scale,
                                                      Scratch& scratch);

/// The half-space of a contact and the body that it meets.
struct PlaneContact {
  Vec3 normal;  ///< of the posed half-space, not unit; it points out of it
  SignedDepth depth;
};

/// Requires a contact of one half-space with a body.
[[nodiscard]] PlaneContact plane_contact(const RecordedContact& contact);

}  // namespace pd::audit
