/// @file
/// The first tetrahedron of an expanding polytope: four vertices of P that span a volume for certain.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "depth/difference/polytope_difference.hpp"
#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/inner_surface.hpp"
#include "depth/expansion/moment_frame.hpp"

namespace pd::detail {

enum class InitialSimplexOutcome : std::uint8_t { found, separated, flat };

/// Two directions that span the plane across d (unit) with it, without a root (Duff et al. 2017).
inline void frame_across(const Vec3& d, Vec3& u, Vec3& w) {
  const double sign = std::copysign(1.0, d.z());
  const double a = -1 / (sign + d.z());
  const double b = d.x() * d.y() * a;
  u = {1 + sign * d.x() * d.x() * a, sign * b, -sign * d.x()};
  w = {b, sign + d.y() * d.y() * a, -d.y()};
}

/// Three directions around d (unit), each at the angle of this sine from it (below a right one), and the one opposite:
/// 120 degrees apart as seen along d.
inline void surrounding_directions(const Vec3& d, double sine, Vec3 (&out)[4]) {
  constexpr double kHeight = 0.86602540378443864676;  // sqrt(3) / 2
  Vec3 u, w;
  frame_across(d, u, w);
  const Vec3 axial = std::sqrt(1 - sine * sine) * d;
  out[0] = axial + sine * u;
  out[1] = axial - 0.5 * sine * u + kHeight * sine * w;
  out[2] = axial - 0.5 * sine * u - kHeight * sine * w;
  out[3] = -d;
}

/// Sine of the angle between the expected direction of the depth and those that a search begins with: about that
/// between the normals of nearby facets of P, fitted to what took the fewest supports for 8 to 2048 vertices.
inline double initial_cone_sine(const PolytopeDifference& difference) {
  const auto n = static_cast<unsigned>(difference.a().num_vertices() + difference.b().num_vertices());
  return std::min(0.78, (2.8 + 0.13 * std::bit_width(n)) / std::sqrt(static_cast<double>(n)));
}
inline double initial_cone_sine(const SmoothDifference& /*difference*/) { return 0.5; }

/// How a search begins.
enum class FirstDirections : std::uint8_t {
  plain,    ///< whatever the bodies are like: which of equally near facets a search ends at hangs on it
  by_shape  ///< in the frame of the bodies' moments where one is elongated,
};

/// Bodies of so few vertices are through in little more time than the frame takes.
inline constexpr int kFewestForFrame = 17;

/// Four directions (unit) for bodies one of which is elongated, laid out as `surrounding_directions` does in the frame
/// of P's moments (moment_frame.hpp). False where neither is, or there is little to gain.
/// @param expected  the direction in which the depth is expected, or zero: from the bodies' places and moments.
inline bool directions_by_shape(const PolytopeDifference& difference, const Vec3& expected, double sine,
                                Vec3 (&out)[4]) {
  const ConvexPolytope &a = difference.a(), &b = difference.b();
  if (!a.storage().elongated && !b.storage().elongated) return false;
  if (a.num_vertices() + b.num_vertices() < kFewestForFrame) return false;
  const MomentFrame frame(difference);
  const Vec3 w = expected.squaredNorm() > 0 ? frame.into(expected) : frame.expected(difference.centre());
  const double squared = w.squaredNorm();
  if (!(squared > 0 && squared < std::numeric_limits<double>::infinity())) return false;
  surrounding_directions(w / std::sqrt(squared), sine, out);
  for (Vec3& direction : out) direction = frame.out_of(direction).normalized();
  return true;
}
inline bool directions_by_shape(const SmoothDifference&, const Vec3&, double, Vec3 (&)[4]) { return false; }

/// The searches for the first tetrahedron, the cheapest first. `Probe` offers `add_support`, for one direction and for
/// four, and `add_both_supports`; each adds vertices to the surface and says false where a support shows the bodies
/// separated.
///
/// Most pairs are done after the first four supports; at most 20 are asked for.
template <class Probe>
class InitialSimplex {
 public:
  using Outcome = InitialSimplexOutcome;

  /// @param flat  error bound of six volumes.
  InitialSimplex(InnerSurface& surface, double flat, Probe& probe) : surface_(surface), flat_(flat), probe_(probe) {}

  /// @param directions  unit, the first ones to ask.
  /// @param direction   unit, where the depth is expected. @param sine  see initial_cone_sine.
  Outcome find(const Vec3 (&directions)[4], const Vec3& direction, double sine) {
    if (!probe_.add_support(directions)) return Outcome::separated;
    if (surface_.start_tetrahedron(flat_)) return Outcome::found;
    return search_farther(direction, sine);
  }

 private:
  /// Repeated or nearly coplanar vertices: farther around, in between the first three; then along the axes and along
  /// the normals that the vertices leave open. Nearly all directions see but the two ends of a slender body; those
  /// across it see its sides.
  Outcome search_farther(const Vec3& direction, double sine) {
    Vec3 directions[4];
    for (const double wider : {std::min(3 * sine, 0.8), 1.0}) {
      surrounding_directions(direction, -wider, directions);
      for (int i = 0; i < 3; ++i) {
        if (!probe_.add_support(directions[i])) return Outcome::separated;
      }
      if (surface_.start_from_spread_vertices(flat_)) return Outcome::found;
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!probe_.add_both_supports(Vec3::Unit(axis))) return Outcome::separated;
    }
    if (surface_.start_from_spread_vertices(flat_)) return Outcome::found;
    return search_across();
  }

  /// Across the longest edge between the vertices, then across the plane of three of them.
  Outcome search_across() {
    const Vec3 along = edge(1);
    if (!(along.squaredNorm() > 0)) return Outcome::flat;
    const Vec3 across = along.unitOrthogonal();
    if (!probe_.add_both_supports(across) || !probe_.add_both_supports(along.cross(across).normalized())) {
      return Outcome::separated;
    }
    if (surface_.start_from_spread_vertices(flat_)) return Outcome::found;
    const Vec3 normal = edge(1).cross(edge(2));
    if (!(normal.squaredNorm() > 0)) return Outcome::flat;
    if (!probe_.add_both_supports(normal.normalized())) return Outcome::separated;
    return surface_.start_from_spread_vertices(flat_) ? Outcome::found : Outcome::flat;
  }

  /// From the first of the four spread vertices to another one.
  Vec3 edge(int to) const {
    const SpreadPoints spread = surface_.spread_vertices();
    return surface_.vertices[spread.ids[to]].x - surface_.vertices[spread.ids[0]].x;
  }

  InnerSurface& surface_;
  double flat_;
  Probe& probe_;
};

}  // namespace pd::detail
