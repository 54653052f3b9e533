/// @file
/// Convex bodies and ways between points, drawn: as SVG, and as the numbers that a page's script draws from.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/eye_polytope.hpp"

namespace pd::report {

enum class BodyRole : std::uint8_t { a, b, difference };

struct DrawnBody {
  EyePolytope shape;
  BodyRole role;
};

struct DrawnWay {
  Vec3 from;
  Vec3 to;
  bool reported = false;  ///< by an engine; else exact
};

struct DrawnBall {
  Vec3 centre;
  double radius;
};

/// All within [-1, 1]^3, z upwards.
struct PairView {
  std::vector<DrawnBody> bodies;
  std::vector<DrawnWay> ways;
  std::optional<DrawnBall> ball;  ///< of P: about the origin, with the depth as its radius
};

/// An `svg` element, seen from above the horizon. @param label  for screen readers
[[nodiscard]] std::string drawing_of(const PairView& view, std::string_view label);

/// [{"bodies":[{"role","points","polygons","kinds","edges"}],"ways":[...],"ball":...},...]; five digits.
[[nodiscard]] std::string json_of(const std::vector<PairView>& views);

}  // namespace pd::report
