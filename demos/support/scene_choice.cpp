#include "support/scene_choice.hpp"

#include <fmt/core.h>

#include <string>
#include <utility>

namespace pd::demo {

Expected<std::vector<scenes::World>> choose_scenes(const DemoOptions& options, std::span<const SceneChoice> scenes) {
  std::vector<scenes::World> chosen;
  std::string names;
  for (const SceneChoice& scene : scenes) {
    names += (names.empty() ? "" : ", ") + std::string(scene.name);
    if (options.scene == "list") {
      fmt::print("  {:<12} {}\n", scene.name, scene.description);
    } else if (options.scene.empty() ? scene.shown_unasked : options.scene == scene.name) {
      chosen.push_back(scene.make(options.seed));
    }
  }
  if (chosen.empty() && options.scene != "list") {
    return Error{ErrorCode::bad_value, "the scenes are " + names, "--scene"};
  }
  return chosen;
}

}  // namespace pd::demo
