/// @file
/// Two worlds side by side: the frames of their film, the film, and the strip of a few moments.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/render/annotation.hpp"
#include "pd/render/composition.hpp"
#include "pd/render/renderer.hpp"
#include "pd/render/video.hpp"

namespace pd::demo {

inline constexpr int kFramesPerSecond = 30;

/// What one of the two worlds shows at one step.
struct Half {
  render::Scene scene;                            ///< with its arrows
  double depth = 0;                               ///< deepest penetration, metres
  std::optional<render::Headline> headline = {};  ///< what is said of it; none: its deepest penetration
  std::string heading;                            ///< which world
  std::string status;                             ///< time and step
  render::Sparkline curve;                        ///< of the deepest penetration
};

struct DuelPlan {
  std::filesystem::path folder;  ///< frames/NAME_0000.png, NAME.mp4 and NAME_strip.png go there
  std::string name;
  std::string title;
  std::string strip_statement;  ///< what the figures below the strip's pictures are
  render::Size size;            ///< of a frame
  render::Box view;             ///< what has to be seen
  render::ViewAngle direction;
  double shown_depth = 0;  ///< depths below this are good
  bool video = true;
};

/// Draws frames as they come. Every member function answers why it failed, if it did.
class DuelFilm {
 public:
  static Expected<DuelFilm> open(const DuelPlan& plan, render::Renderer& renderer);

  /// Draws one frame, writes it, and adds it to the film `repeats` times. @param said  the line below both halves.
  Expected<int> add_frame(const Half& left, const Half& right, const std::string& said, int repeats = 1);
  /// Keeps a moment for the strip.
  Expected<int> add_moment(const Half& left, const Half& right, const std::string& time);
  [[nodiscard]] std::size_t num_moments() const { return moments_.size(); }
  /// Writes the strip and closes the film. @return how many frames there are.
  Expected<int> finish();

 private:
  DuelFilm(const DuelPlan& plan, render::Renderer& renderer);
  Expected<render::Panel> draw_half(const Half& half);

  DuelPlan plan_;
  render::Renderer* renderer_;
  render::Camera camera_;
  render::Camera strip_camera_;
  std::optional<render::VideoWriter> film_;
  std::vector<render::Moment> moments_;
  render::StripWords words_;
  int frames_ = 0;
};

}  // namespace pd::demo
