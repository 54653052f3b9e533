/// @file
/// One pair and its Minkowski difference, as a picture: where the two bodies overlap, how deep, and which facet of
/// P = B + (-A) says so.
#pragma once

#include <filesystem>
#include <string>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/render/renderer.hpp"

namespace pd::demo {

/// Two posed polytopes and what to call them.
struct NamedPair {
  const ConvexShape* a;
  const ConvexShape* b;
  Pose pose_a;
  Pose pose_b;
  std::string name_a;
  std::string name_b;
};

/// The pair on the left, its difference on the right, under one light and one direction of view; `turn_degrees` turns
/// the view about the vertical.
///
/// P is left out where it is flat or has more facets than a picture can show (100,000).
/// @return the renderer's refusal where it cannot draw.
/// Requires polytopes without margins and `answer` of `penetration_depth` for them.
[[nodiscard]] Expected<render::Image> difference_picture(const NamedPair& pair, const PenetrationDepth& answer,
                                                         render::Renderer& renderer, render::Size size,
                                                         double turn_degrees = 0);

/// Writes `difference_picture` as a PNG and names what went wrong on stderr. @return a code of DemoExit.
int write_difference_picture(const NamedPair& pair, const PenetrationDepth& answer, const std::filesystem::path& file,
                             render::Size size = {1600, 900});

}  // namespace pd::demo
