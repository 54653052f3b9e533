#include "pd/render/video.hpp"

#include <cassert>
#include <string>
#include <system_error>
#include <utility>

#include "pd/numeric/whole_file.hpp"
#include "video/ffmpeg_process.hpp"

namespace pd::render {
namespace {

Error bad_path(const std::filesystem::path& path, const std::string& reason) {
  return Error{ErrorCode::bad_value, reason, path.string()};
}

std::vector<std::string> raw_input(Size size, int frames_per_second) {
  return {"-f",       "rawvideo",
          "-pix_fmt", "rgba",
          "-s",       std::to_string(size.width) + "x" + std::to_string(size.height),
          "-r",       std::to_string(frames_per_second),
          "-i",       "pipe:0"};
}

void make_folder(const std::filesystem::path& path) {
  if (path.has_parent_path()) {
    std::error_code ignored;  // writing the file tells
    std::filesystem::create_directories(path.parent_path(), ignored);
  }
}

}  // namespace

struct VideoWriter::State {
  detail::FfmpegProcess process;
  std::unique_ptr<WholeFile> file;
  std::filesystem::path path;
  Size size;
  int frames = 0;
  bool open = true;

  /// Ends ffmpeg. @return empty, or why there is no film.
  std::string close() {
    open = false;
    std::string words = process.finish();
    if (words.empty() && !file->finish()) words = "the film cannot be given its name";
    return words;
  }
};

VideoWriter::VideoWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoWriter::~VideoWriter() {
  if (state_ && state_->open) (void)state_->close();
}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

Expected<VideoWriter> VideoWriter::open(const std::filesystem::path& path, Size size, int frames_per_second) {
  make_folder(path);
  auto file = std::make_unique<WholeFile>(path);
  if (!file->good()) return bad_path(path, "the film cannot be written there");
  std::vector<std::string> arguments = raw_input(size, frames_per_second);
  // One encoder thread: the drawing needs the cores, and the file's bytes do not depend on their number.
  const std::vector<std::string> output = {"-vf",
                                           "crop=trunc(iw/2)*2:trunc(ih/2)*2:0:0",
                                           "-c:v",
                                           "libx264",
                                           "-preset",
                                           "veryfast",
                                           "-crf",
                                           "18",
                                           "-threads",
                                           "1",
                                           "-pix_fmt",
                                           "yuv420p",
                                           "-colorspace",
                                           "bt709",
                                           "-color_primaries",
                                           "bt709",
                                           "-color_trc",
                                           "bt709",
                                           "-movflags",
                                           "+faststart",
                                           "-f",
                                           "mp4",
                                           file->written_path().string()};
  arguments.insert(arguments.end(), output.begin(), output.end());
  auto process = detail::FfmpegProcess::start(arguments);
  if (!process) {
    return process.error();
  }
  return VideoWriter(std::unique_ptr<State>(new State{*std::move(process), std::move(file), path, size}));
}

Expected<int> VideoWriter::add(const Image& frame) {
  if (!state_->open) {
    return bad_path(state_->path, "the film is closed");
  }
  if (frame.size() != state_->size) {
    return bad_path(state_->path, "all frames of a film have one size");
  }
  if (!state_->process.write(frame.bytes())) {
    state_->open = false;
    return bad_path(state_->path, "ffmpeg stopped: " + state_->process.finish());
  }
  return ++state_->frames;
}

Expected<std::filesystem::path> VideoWriter::finish() {
  if (!state_->open) {
    return bad_path(state_->path, "the film is closed");
  }
  const std::string words = state_->close();
  if (!words.empty()) {
    return bad_path(state_->path, "ffmpeg failed: " + words);
  }
  return state_->path;
}

Expected<std::filesystem::path> write_looping_clip(std::span<const Image> frames, const std::filesystem::path& path,
                                                   int frames_per_second, int width, std::size_t max_bytes) {
  assert(!frames.empty());
  const bool webp = path.extension() == ".webp";
  if (!webp && path.extension() != ".gif") {
    return bad_path(path, "a looping clip ends in .webp or .gif");
  }
  make_folder(path);
  // Coarser and coarser, until it fits.
  struct Step {
    int quality;  // WebP's 0..100
    int colours;  // GIF's palette
    double shrink;
  };
  constexpr Step kSteps[] = {{82, 192, 1}, {68, 128, 1}, {55, 96, 1}, {50, 64, 0.85}, {42, 48, 0.75}};
  for (const Step& step : kSteps) {
    WholeFile file(path);
    if (!file.good()) return bad_path(path, "the clip cannot be written there");
    const std::string target = file.written_path().string();
    const std::string scale =
        "scale=" + std::to_string(static_cast<int>(width * step.shrink) / 2 * 2) + ":-2:flags=area";
    std::vector<std::string> arguments = raw_input(frames.front().size(), frames_per_second);
    if (webp) {
      arguments.insert(arguments.end(), {"-vf", scale, "-c:v", "libwebp_anim", "-quality", std::to_string(step.quality),
                                         "-compression_level", "4", "-loop", "0", "-f", "webp", target});
    } else {
      arguments.insert(arguments.end(),
                       {"-vf",
                        scale + ",split[a][b];[a]palettegen=max_colors=" + std::to_string(step.colours) +
                            ":stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle",
                        "-loop", "0", "-f", "gif", target});
    }
    auto process = detail::FfmpegProcess::start(arguments);
    if (!process) {
      return process.error();
    }
    detail::FfmpegProcess ffmpeg = *std::move(process);
    for (const Image& frame : frames) {
      if (frame.size() != frames.front().size()) {
        return bad_path(path, "all frames of a clip have one size");
      }
      if (!ffmpeg.write(frame.bytes())) {
        break;  // finish tells why
      }
    }
    const std::string words = ffmpeg.finish();
    if (!words.empty()) {
      return bad_path(path, "ffmpeg failed: " + words);
    }
    std::error_code missing;
    if (std::filesystem::file_size(target, missing) <= max_bytes && !missing) {
      if (file.finish()) return path;
      return bad_path(path, "the clip cannot be given its name");
    }
  }
  return Error{ErrorCode::limit_exceeded,
               "the clip is larger than " + std::to_string(max_bytes) + " bytes at any quality fit to be seen",
               path.string()};
}

}  // namespace pd::render
