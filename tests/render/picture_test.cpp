#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "pd/render/annotation.hpp"
#include "pd/render/chart.hpp"
#include "pd/render/composition.hpp"
#include "pd/render/video.hpp"

namespace pd::render {
namespace {

class Picture : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / ("pdepth_render_" + std::string(info->name()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

Image ramp(Size size) {
  Image image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      std::uint8_t* pixel = image.pixel(x, y);
      pixel[0] = static_cast<std::uint8_t>(x * 255 / size.width);
      pixel[1] = static_cast<std::uint8_t>(y * 255 / size.height);
      pixel[2] = static_cast<std::uint8_t>((x * 7 + y * 3) % 256);
    }
  }
  return image;
}

double share_changed(const Image& a, const Image& b, int x0, int y0, int x1, int y1) {
  int changed = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      changed += a.pixel(x, y)[1] != b.pixel(x, y)[1] ? 1 : 0;
    }
  }
  return changed / static_cast<double>((x1 - x0) * (y1 - y0));
}

TEST_F(Picture, PngRoundTripKeepsEveryByte) {
  const Image image = ramp({97, 61});
  const auto path = write_png(image, folder_ / "deep" / "ramp.png");
  ASSERT_TRUE(path);
  const auto back = read_png(*path);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), image.size());
  EXPECT_EQ(difference(image, *back).largest, 0);
}

TEST_F(Picture, UnwritableAndUnreadablePathsAreNamed) {
  const auto refused = write_png(ramp({4, 4}), "/proc/none/picture.png");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::bad_value);
  EXPECT_EQ(refused.error().where, "/proc/none/picture.png");
  EXPECT_FALSE(read_png(folder_ / "missing.png"));
}

TEST_F(Picture, ResizedIsTheAreaAverage) {
  const Image image = ramp({80, 60});
  const Image quarter = resized(image, {20, 15});
  int sum = 0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      sum += image.pixel(8 + x, 12 + y)[0];
    }
  }
  EXPECT_NEAR(quarter.pixel(2, 3)[0], sum / 16.0, 0.51);
  EXPECT_EQ(difference(resized(image, image.size()), image).largest, 0);
}

TEST_F(Picture, AnnotationStandsInItsCorners) {
  const Image plain({640, 360}, palette::kPaper);
  Image image = plain;
  annotate(image, {.title = "Tower of ten", .subtitle = "exact", .status = "t = 1.20 s"});
  EXPECT_GT(share_changed(plain, image, 0, 0, 320, 60), 0.02);
  EXPECT_GT(share_changed(plain, image, 0, 300, 320, 360), 0.005);
  EXPECT_EQ(share_changed(plain, image, 400, 100, 640, 360), 0);
  annotate(image, {.headlines = {{"0.4 mm", "drift"}}, .sparkline = {.values = {0, 1, 2, 1}, .now = 2}});
  EXPECT_GT(share_changed(plain, image, 400, 260, 640, 360), 0.01);
}

TEST_F(Picture, FittedExponentIsTheSlope) {
  Series series{.name = "n log n", .x = {}, .y = {}};
  for (double n = 10; n < 1e6; n *= 3) {
    series.x.push_back(n);
    series.y.push_back(2e-3 * std::pow(n, 1.5));
  }
  EXPECT_NEAR(fitted_exponent(series), 1.5, 1e-12);
  EXPECT_TRUE(std::isnan(fitted_exponent({.name = "", .x = {3}, .y = {4}})));
}

TEST_F(Picture, ChartsOfAnyFiguresAreDrawn) {
  Chart chart{.title = "Time a query", .x_label = "vertices", .y_label = "microseconds"};
  chart.series.push_back({.name = "warm", .x = {1, 2, 3, 4}, .y = {1, 4, std::nan(""), 16}, .markers = true});
  const Image linear = draw_chart(chart, {640, 400});
  EXPECT_GT(share_changed(linear, Image({640, 400}, palette::kPaper), 0, 0, 640, 400), 0.01);
  chart.x_scale = Scale::logarithmic;
  chart.y_scale = Scale::logarithmic;
  chart.series.push_back({.name = "none", .x = {}, .y = {}});
  chart.series.push_back({.name = "flat", .x = {1, 1000}, .y = {5, 5}, .fit_exponent = true});
  chart.series.push_back({.name = "not positive", .x = {1, -1}, .y = {0, -5}});
  EXPECT_EQ(draw_chart(chart, {640, 400}).size(), (Size{640, 400}));
  EXPECT_EQ(draw_chart(Chart{}, {320, 200}).size(), (Size{320, 200}));
}

TEST_F(Picture, SideBySideKeepsPanelsPixelForPixel) {
  const Size whole{1280, 720};
  const Size size = panel_size(whole, 2);
  const Image panel = ramp(size);
  const Image both =
      side_by_side(std::vector<Panel>{{panel, "exact"}, {panel, "other"}}, "Same start", "0.4 mm / 37 mm", whole);
  ASSERT_EQ(both.size(), whole);
  int places = 0;
  for (int y = 0; y + size.height <= whole.height; ++y) {
    places += std::equal(panel.pixel(0, 0), panel.pixel(0, 0) + 4 * size.width, both.pixel(0, y)) ? 1 : 0;
  }
  EXPECT_EQ(places, 1);
}

TEST_F(Picture, FilmStripHoldsSixFrames) {
  const std::vector<Panel> frames(6, Panel{ramp({320, 180}), "t = 0.1 s"});
  const Image strip = film_strip(frames, "Rollback", 900);
  EXPECT_EQ(strip.width(), 900);
  EXPECT_GT(strip.height(), 300);
}

bool ffmpeg_is_there() { return std::system("ffmpeg -version > /dev/null 2>&1") == 0; }

TEST_F(Picture, VideoIsMade) {
  if (!ffmpeg_is_there()) {
    GTEST_SKIP() << "the program ffmpeg is not installed";
  }
  auto opened = VideoWriter::open(folder_ / "film.mp4", {161, 91});
  ASSERT_TRUE(opened) << opened.error().message;
  VideoWriter film = *std::move(opened);
  for (int i = 1; i <= 12; ++i) {
    const auto count = film.add(Image({161, 91}, {static_cast<float>(i) / 12, 0.5f, 0.5f}));
    ASSERT_TRUE(count);
    EXPECT_EQ(*count, i);
  }
  EXPECT_FALSE(film.add(Image({8, 8})));
  const auto path = film.finish();
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_GT(std::filesystem::file_size(*path), 500u);
  EXPECT_FALSE(film.add(Image({161, 91})));
  // The moov box stands before the media: the film starts before it is loaded.
  std::FILE* file = std::fopen(path->c_str(), "rb");
  std::string head(4000, '\0');
  head.resize(std::fread(head.data(), 1, head.size(), file));
  std::fclose(file);
  EXPECT_NE(head.find("moov"), std::string::npos);
  EXPECT_LT(head.find("moov"), head.find("mdat"));
}

TEST_F(Picture, BadVideoPathIsNamed) {
  if (!ffmpeg_is_there()) {
    GTEST_SKIP() << "the program ffmpeg is not installed";
  }
  const auto opened = VideoWriter::open("/proc/none/film.mp4", {64, 64});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::bad_value);
  EXPECT_FALSE(write_looping_clip(std::vector<Image>{ramp({20, 12})}, "/proc/none/clip.gif"));
}

/// A film or a clip that cannot be finished leaves what stood under its name.
TEST_F(Picture, FilmsAreWrittenBesideTheirNames) {
  if (!ffmpeg_is_there()) {
    GTEST_SKIP() << "the program ffmpeg is not installed";
  }
  const auto older = [&](const char* name) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / name) << "older";
    return folder_ / name;
  };
  const auto text_of = [](const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  };
  const auto film = older("film.mp4"), clip = older("clip.gif");
  {
    VideoWriter writer = *VideoWriter::open(film, {64, 48});
    ASSERT_TRUE(writer.add(ramp({64, 48})));
    EXPECT_EQ(text_of(film), "older");
    ASSERT_TRUE(writer.finish());
    EXPECT_NE(text_of(film), "older");
  }
  EXPECT_FALSE(write_looping_clip(std::vector<Image>{ramp({64, 48})}, clip, 10, 64, 50));
  EXPECT_EQ(text_of(clip), "older");
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".pdepth-")) << entry.path();
  }
}

TEST_F(Picture, MissingFfmpegIsSaidPlainly) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const auto opened = VideoWriter::open(folder_ / "film.mp4", {64, 64});
  setenv("PATH", path.c_str(), 1);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::unsupported);
  EXPECT_NE(opened.error().message.find("ffmpeg"), std::string::npos);
}

TEST_F(Picture, LoopingClipFitsOrIsRefused) {
  if (!ffmpeg_is_there()) {
    GTEST_SKIP() << "the program ffmpeg is not installed";
  }
  std::vector<Image> frames;
  for (int i = 0; i < 6; ++i) {
    frames.push_back(ramp({200, 120}));
  }
  for (const char* name : {"clip.webp", "clip.gif"}) {
    const auto path = write_looping_clip(frames, folder_ / name, 10, 160);
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_LT(std::filesystem::file_size(*path), 2'000'000u);
  }
  const auto small = write_looping_clip(frames, folder_ / "small.webp", 10, 160, 50);
  ASSERT_FALSE(small);
  EXPECT_EQ(small.error().code, ErrorCode::limit_exceeded);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "small.webp"));
  EXPECT_FALSE(write_looping_clip(frames, folder_ / "clip.bmp"));
}

}  // namespace
}  // namespace pd::render
