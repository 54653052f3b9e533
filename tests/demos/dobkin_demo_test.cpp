// The pictures of the constructions of Dobkin et al.: each is written, of the size asked for, and shows something.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "pd/render/image.hpp"

namespace {

namespace fs = std::filesystem;

std::size_t colours_of(const pd::render::Image& image, int left, int right) {
  std::set<std::array<std::uint8_t, 3>> colours;
  for (int y = image.height() / 5; y < image.height() * 4 / 5; ++y) {
    for (int x = left; x < right; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      colours.insert({p[0], p[1], p[2]});
    }
  }
  return colours.size();
}

TEST(DobkinDemo, EveryPictureShowsSomethingInBothHalves) {
  const fs::path folder = fs::temp_directory_path() / ("pdepth_dobkin_" + std::to_string(getpid()));
  fs::remove_all(folder);
  const std::string command =
      std::string(PDEPTH_PROGRAM) + " demo dobkin --size 640x360 --out " + folder.string() + " > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  for (const char* name : {"hierarchies", "descent", "polygons"}) {
    const auto image = pd::render::read_png(folder / (std::string(name) + ".png"));
    ASSERT_TRUE(image) << name;
    EXPECT_EQ(image->size(), (pd::render::Size{640, 360})) << name;
    for (const int half : {0, 320}) EXPECT_GT(colours_of(*image, half, half + 320), 200u) << name << " " << half;
  }
  fs::remove_all(folder);
}

}  // namespace
