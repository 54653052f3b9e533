// The pictures of the constructions of Agarwal et al.: each is written, of the size asked for, and shows something.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "pd/render/image.hpp"

namespace {

namespace fs = std::filesystem;

/// Share of the commonest colour, and the number of colours, below the title.
struct Colours {
  double commonest = 0;
  std::size_t count = 0;
};

Colours colours_of(const pd::render::Image& image, int left, int right) {
  std::map<std::array<std::uint8_t, 3>, int> counts;
  int pixels = 0;
  for (int y = image.height() / 5; y < image.height() * 4 / 5; ++y) {
    for (int x = left; x < right; ++x, ++pixels) {
      const std::uint8_t* p = image.pixel(x, y);
      ++counts[{p[0], p[1], p[2]}];
    }
  }
  Colours colours;
  for (const auto& [colour, count] : counts) {
    colours.commonest = std::max(colours.commonest, static_cast<double>(count) / pixels);
  }
  colours.count = counts.size();
  return colours;
}

TEST(AgarwalDemo, EveryPictureShowsSomethingInBothHalves) {
  const fs::path folder = fs::temp_directory_path() / ("pdepth_agarwal_" + std::to_string(getpid()));
  fs::remove_all(folder);
  const std::string command =
      std::string(PDEPTH_PROGRAM) + " demo agarwal --size 640x360 --out " + folder.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  for (const char* name : {"normal_diagrams", "direction_grid", "shallow_search", "width", "non_convex"}) {
    const auto image = pd::render::read_png(folder / (std::string(name) + ".png"));
    ASSERT_TRUE(image) << name;
    EXPECT_EQ(image->size(), (pd::render::Size{640, 360})) << name;
    for (const int half : {0, 320}) {
      const Colours colours = colours_of(*image, half, half + 320);
      EXPECT_GT(colours.count, 300u) << name << " from column " << half;
      EXPECT_LT(colours.commonest, 0.2) << name << " from column " << half;
    }
  }
  fs::remove_all(folder);
}

}  // namespace
