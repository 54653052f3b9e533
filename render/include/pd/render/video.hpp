/// @file
/// Frames to a film, through the program ffmpeg (run, not linked).
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "pd/numeric/expected.hpp"
#include "pd/render/image.hpp"

namespace pd::render {

/// An H.264 film (yuv420p, faststart) that grows frame by frame, beside its name: a film that stood there before stays
/// until this one is closed.
class VideoWriter {
 public:
  /// @param size  of every frame; odd sides lose their last row or column (yuv420p has none).
  /// @return ErrorCode::unsupported where the program ffmpeg is missing, bad_value where the path cannot be written.
  static Expected<VideoWriter> open(const std::filesystem::path& path, Size size, int frames_per_second = 30);

  /// Closes the film.
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Appends a frame. @return how many there are, or why ffmpeg has stopped; bad_value for another size.
  Expected<int> add(const Image& frame);

  /// Closes the film. @return its path, or ffmpeg's own words. Further `add` calls are refused.
  Expected<std::filesystem::path> finish();

 private:
  struct State;
  explicit VideoWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A small looping picture for a page (animated WebP or GIF, by the path's ending), from frames of one size.
/// @param width  pixels; the height follows.
/// @return the path, or ErrorCode::unsupported (ffmpeg missing), bad_value (path, ending), limit_exceeded (the file
/// would be larger than `max_bytes` at the coarsest quality that is still fit to be seen). A refusal changes no file.
Expected<std::filesystem::path> write_looping_clip(std::span<const Image> frames, const std::filesystem::path& path,
                                                   int frames_per_second = 15, int width = 640,
                                                   std::size_t max_bytes = 2'000'000);

}  // namespace pd::render
