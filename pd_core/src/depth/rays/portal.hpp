/// @file
/// Where a line through the inside of P = B + (-A) leaves it: a triangle of vertices of P that the line crosses (a
/// portal), pushed outwards until its plane supports P.
///
/// After Snethen, "XenoCollide" (Game Programming Gems 7, 2008), with two differences: every choice is an exact sign,
/// and instead of a cone at an interior point the portal is a triangle about the line, so that it may start behind the
/// origin. Each step moves the crossing strictly outwards along the (symbolically moved) line, so the search ends.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "depth/difference/direction_signs.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::detail {

struct Portal {
  /// Counter-clockwise seen against the direction; the plane through them supports P where the line leaves it.
  std::array<VertexPair, 3> corners;
  std::int64_t support_calls = 0;
};

/// Inner hierarchies of the two polytopes, both or none.
struct PortalHierarchies {
  const PolyhedralHierarchy* a = nullptr;
  const PolyhedralHierarchy* b = nullptr;
};

/// Requires the origin in the interior of P. Measured 7 to 30 supports; each O(sqrt n) on round bodies, O(log n) where
/// hierarchies say where its climb starts.
[[nodiscard]] Portal find_portal(const DirectionSigns& ray, const PortalHierarchies& hierarchies = {});

using PortalCorners = std::array<VertexPair, 3>;

/// Triangles of vertices of P that some line crossed: one behind the origin, and portals from the widest to the last.
/// A line that has moved a little still crosses one of the wider ones.
struct PortalEnds {
  static constexpr int kMost = 24;
  bool known = false;
  PortalCorners back{};
  int count = 0;
  std::array<PortalCorners, kMost> portals{};

  void push(const PortalCorners& v) {
    if (count == kMost) std::copy(portals.begin() + 2, portals.end(), portals.begin() + 1);
    if (count == kMost) --count;
    portals[static_cast<std::size_t>(count++)] = v;
  }
};

/// The portal of a ray from the origin, and the proof that the origin lies inside P: the line crosses a triangle of
/// vertices of P behind the origin and a supporting plane before it.
/// @param direction  that of `ray`
/// @param ends  of an earlier ray, or not known: a search starts at the last portal that the line crosses still. Those
/// of this ray are left in it. Every vertex must be one of the bodies.
/// @return nothing where the line does not meet the interior of P, the origin is not inside, or the triangles are met
/// so that this proof does not tell (through a corner or side, say).
/// Requires that both bodies are solids.
[[nodiscard]] std::optional<Portal> find_inside_portal(const DirectionSigns& ray, const Vec3& direction,
                                                       PortalEnds& ends);

/// The same for a line that may miss: nothing where the line through the origin does not meet the interior of P.
[[nodiscard]] std::optional<Portal> find_line_portal(const DirectionSigns& ray);

}  // namespace pd::detail
