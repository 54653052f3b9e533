/// @file
/// A certified bracket of the depth of a solid A in a body B that stays: the translations near zero are covered by
/// balls in which A overlaps B.
///
/// A point that lies at a distance r from A's surface, inside, and s from B's certifies a ball of such translations: A
/// moved by less than r + s still overlaps B, since each body holds a ball about the point, and the two balls meet. So
/// does a point at a distance s outside of B, for less than r - s: the point of B that is nearest to it stays in A.
/// Cubes of translations are looked at from the nearest on; one that no ball covers is halved along each axis. The
/// nearest cube that is left bounds the depth from below. Where no ball is found, the cube's middle is tried as a
/// translation that separates, exactly.
///
/// If a share delta of the depth is asked for, some delta^-1 cubes are looked at where the placements that separate
/// begin at a plane, and delta^-2 where they begin at a sphere about zero. Sharp edges that cross each other cost
/// more: balls near them are small.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pd/solid/solid_depth.hpp"
#include "solid/posed_solids.hpp"
#include "solid/surface_depth.hpp"

namespace pd::detail {

/// The body that stays, as the cover asks it. Lengths are inside lengths unless said otherwise.
class StandingBody {
 public:
  StandingBody() = default;
  StandingBody(const StandingBody&) = delete;
  StandingBody& operator=(const StandingBody&) = delete;
  virtual ~StandingBody() = default;

  [[nodiscard]] virtual SurfaceDepth depth_at(const Vec3& x) = 0;
  /// With the depth of a point that is `moved` away.
  [[nodiscard]] virtual SurfaceDepth depth_at(const Vec3& x, const SurfaceDepth& near, double moved) = 0;

  /// Points with which a search for a deep one may begin.
  [[nodiscard]] virtual std::vector<Vec3> landmarks() const = 0;

  struct Meeting {
    ContactClass contact = ContactClass::separated;
    std::vector<Vec3> corners_a = {};  ///< of two places that cross, A where it stood before the way
    std::vector<Vec3> corners_b = {};
    std::int64_t points = 0;  ///< the work, as points whose depths take the same time
  };
  /// The class of A, moved by the vector as stored (an outside length), and this body. It is `separated` only where
  /// that is certain.
  [[nodiscard]] virtual Meeting meeting_after(const Vec3& way) = 0;
};

/// Requires overlapping bodies: the solid A of `solids`, and the one that stays, which lies in the box of the second.
struct CoverQuestion {
  const PosedSolids& solids;
  StandingBody& standing;
  const SolidSettings& settings;
};

/// A solid that stays.
[[nodiscard]] std::unique_ptr<StandingBody> standing_solid(const PosedSolid& a, const PosedSolid& b,
                                                           const PosedSolids& solids);

/// Narrows the bracket of `out`, whose lower end may be 0, until it reaches the share of the settings or they allow no
/// more points.
/// @return whether the translation is a better one; normal, depth and upper end then fit to it.
bool narrow_by_cover(const CoverQuestion& question, SolidDepth& out);

}  // namespace pd::detail
