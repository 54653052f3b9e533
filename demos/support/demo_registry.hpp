/// @file
/// The demos by name. Built only where both Bullet and render are (`PD_WITH_BULLET`, `PD_WITH_RENDER`).
#pragma once

#include <span>
#include <string_view>

#include "support/demo_options.hpp"

namespace pd::demo {

struct Demo {
  std::string_view name;
  std::string_view description;  ///< one line, for the help
  bool has_scenes;               ///< whether it takes `options.scene`
  /// Runs to the end, writes its files below `options.out`, prints progress to stderr and headline figures to stdout.
  /// @return one of DemoExit.
  int (*run)(const DemoOptions& options);
};

/// All demos, in the order of the help.
[[nodiscard]] std::span<const Demo> demos();

/// The demo of that name, or nullptr.
[[nodiscard]] const Demo* find_demo(std::string_view name);

/// Towers and piles where the solver matters: solver against solver from the same start.
int run_stacking(const DemoOptions& options);
/// Bodies thrown fast at each other: restored and advanced to the first contact.
int run_rollback(const DemoOptions& options);
/// One pair with its Minkowski difference, for any two meshes.
int run_difference(const DemoOptions& options);
/// The constructions of [A] as pictures: normal diagrams, direction grid, shallow search, width.
int run_agarwal(const DemoOptions& options);
/// The constructions of [D] as pictures: hierarchies, a descent, polygons and their convolution.
int run_dobkin(const DemoOptions& options);

}  // namespace pd::demo
