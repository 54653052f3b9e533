/// @file
/// The scenes of a demo by name: what `--scene` chooses from.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "scenes/worlds.hpp"
#include "support/demo_options.hpp"

namespace pd::demo {

struct SceneChoice {
  std::string_view name;         ///< of the world
  std::string_view description;  ///< one line, for `--scene list`
  bool shown_unasked;            ///< whether the demo shows it where no scene is named
  scenes::World (*make)(std::uint64_t seed);
};

/// The worlds that `options.scene` names: one, or without a name all that are shown unasked. "list" prints the scenes
/// to stdout and chooses none.
/// @return ErrorCode::bad_value with the names that there are
[[nodiscard]] Expected<std::vector<scenes::World>> choose_scenes(const DemoOptions& options,
                                                                 std::span<const SceneChoice> scenes);

}  // namespace pd::demo
