/// @file
/// What every demo is told on the command line: `pdepth demo NAME [--scene S] [--steps N] [--size WxH] [--out DIR]
/// [--solver S] [--seed N] [--video] [--force]`. Filled by the command line, read by the demos.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pd::report {
struct Page;
}

namespace pd::demo {

struct DemoOptions {
  /// One scene of a demo that has several, or "list"; empty = the demo's own choice.
  std::string scene;
  /// Steps of the simulation; 0 = the demo's own choice.
  int steps = 0;
  /// Size of one frame in pixels.
  int width = 1280;
  int height = 720;
  /// Where the files go; empty = "pdepth_out/NAME" below the present folder. Made when it is missing.
  std::filesystem::path out;
  /// "exact", "approx", "bullet-epa" or "bullet-minkowski": the solver shown first. Empty = "exact".
  std::string solver;
  /// Seed of what is thrown or piled at random; the same seed gives the same scene.
  std::uint64_t seed = 1;
  /// Also write an H.264 video (needs the program ffmpeg).
  bool video = false;
  /// Replace files that are already there; without it a folder that holds any is refused.
  bool force = false;
  /// A search to draw, as `pdepth depth --trace` writes it (difference). Empty: none.
  std::string trace;
  /// Files to work on, for the demos that take some (difference: two meshes).
  std::vector<std::string> inputs;
  /// Where the demo adds what it has to show; nullptr: no page is made.
  report::Page* page = nullptr;
  /// The demo's folder as the page sees it.
  std::filesystem::path page_folder;
};

/// Exit codes of a demo, those of the command `pdepth`.
enum DemoExit : int {
  kDemoDone = 0,
  kDemoFailed = 1,        ///< no GL context, no room on the disk, ...; a message went to stderr
  kDemoBadUsage = 2,      ///< an option that the demo cannot serve, output that is already there without --force
  kDemoInterrupted = 130  ///< stopped by Ctrl-C; what was done by then is complete and readable
};

}  // namespace pd::demo
