/// @file
/// Worlds that show what contacts are worth: stacks that should stand, slides, rolls and bounces that should keep their
/// speed, pours that should lose nobody. The bench `contact`, the tests of engine_glue and the demos share them.
///
/// Every scene starts without penetration unless its name says so, and is the same for every solver. `perturbation`
/// moves each body by up to 1e-6 of its size (a seed; 0: not at all): chaotic scenes are judged by the median over such
/// starts.
#pragma once

#include <functional>
#include <vector>

#include "scenes/worlds.hpp"

namespace pd::scenes {

/// Each scene is judged by one of these goals.
enum class ContactGoal {
  stand,    ///< bodies stay where they started: fall time, drift, tail speed
  rest,     ///< bodies come to rest somewhere: deepest penetration, tail speed, bodies lost
  keep,     ///< the first moving body keeps its speed: `wanted_speed` along x at the end
  bounce,   ///< no energy comes from nowhere
  rebound,  ///< the first bounce keeps the wanted share of the height
  land      ///< bodies that fall stay above the place that they fell on: how many topple
};

struct ContactScene {
  std::string name;
  std::string title;
  ContactGoal goal = ContactGoal::stand;
  double seconds = 10;                 ///< how long it runs
  double quick_seconds = 2;            ///< in a quick run
  double size = 1;                     ///< of one body: the unit of drift and depth
  double wanted_speed = 0;             ///< keep: of the first moving body, along x; m/s
  double drop = 0;                     ///< rebound: how far the bodies fall
  double kept_height = 1;              ///< rebound: share of that height that a bounce keeps, e^2
  std::vector<double> rates{60, 240};  ///< steps a second; a quick run takes the first
  bool quick = false;                  ///< belongs to a quick run
  World world = {};
};

/// The scenes by name, made when asked for: `perturbation` as above.
struct ContactSceneMaker {
  std::string name;
  std::function<ContactScene(std::uint64_t perturbation)> make;
};
[[nodiscard]] const std::vector<ContactSceneMaker>& contact_scenes();

/// One scene by name. Requires: the name is one of `contact_scenes`.
[[nodiscard]] ContactScene contact_scene(const std::string& name, std::uint64_t perturbation = 0);

/// Boxes on each other, half extent `half`, on a floor of 20 half extents.
[[nodiscard]] ContactScene tower(int count, double half, std::uint64_t perturbation);
/// Rows of boxes of half extent 0.5: `rows` at the bottom, one at the top.
[[nodiscard]] ContactScene pyramid(int rows, std::uint64_t perturbation);
/// Pairs of leaning cards under lying cards, `pairs` at the bottom.
[[nodiscard]] ContactScene card_house(int pairs, std::uint64_t perturbation);
/// A unit box on an inclined plane (a box, or two triangles of a mesh), held by friction: `radians` of slope.
[[nodiscard]] ContactScene slope(double radians, double friction, bool mesh, std::uint64_t perturbation);
/// A wheel that rolls at 3 m/s.
[[nodiscard]] ContactScene rolling_cylinder(std::uint64_t perturbation);
/// Stones, boxes, cylinders and capsules that fall into a bowl (a triangle mesh) or onto a heightfield.
[[nodiscard]] ContactScene pour(int count, bool heightfield, std::uint64_t perturbation);
/// A box without friction that slides at 3 m/s for six seconds over flush boxes of a compound, a flat mesh, a flat
/// heightfield, a mesh whose corners lie inside edges, or hulls with oblique seams that agree to 1e-7.
enum class SlideOver { compound, mesh, heightfield, t_junctions, decomposition };
[[nodiscard]] ContactScene slide(SlideOver ground, std::uint64_t perturbation);

}  // namespace pd::scenes
