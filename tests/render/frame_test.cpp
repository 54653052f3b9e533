#include <gtest/gtest.h>

#include <set>

#include "render/scene_fixture.hpp"

namespace pd::render {
namespace {

using test::long_arrow;
using test::three_boxes;

constexpr Size kSize{480, 270};

class Frame : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto made = Renderer::create();
    if (made) {
      renderer_ = std::make_unique<Renderer>(*std::move(made));
    } else {
      reason_ = made.error().message;
    }
  }
  static void TearDownTestSuite() { renderer_.reset(); }

  void SetUp() override {
    if (!renderer_) {
      GTEST_SKIP() << reason_;
    }
  }

  static Image draw(const Scene& scene, Size size = kSize) {
    camera_ = frame_box(bounds(three_boxes()), size);
    auto image = renderer_->draw(scene, camera_, size);
    EXPECT_TRUE(image);
    return *image;
  }

  static std::unique_ptr<Renderer> renderer_;
  static std::string reason_;
  static Camera camera_;
};

std::unique_ptr<Renderer> Frame::renderer_;
std::string Frame::reason_;
Camera Frame::camera_;

TEST_F(Frame, HasItsSizeAndIsNotBlank) {
  for (const Size size : {kSize, Size{333, 187}}) {
    const Image image = draw(three_boxes(), size);
    EXPECT_EQ(image.size(), size);
    std::set<std::uint32_t> colours;
    for (std::size_t i = 0; i < image.bytes().size(); i += 4) {
      ASSERT_EQ(image.bytes()[i + 3], 255);
      colours.insert(
          static_cast<std::uint32_t>(image.bytes()[i] << 16 | image.bytes()[i + 1] << 8 | image.bytes()[i + 2]));
    }
    EXPECT_GT(colours.size(), 500u);
  }
}

TEST_F(Frame, BodiesStandWhereTheyProject) {
  const Image with = draw(three_boxes());
  Scene empty = three_boxes();
  const Box focus = bounds(empty);
  empty.bodies.clear();
  empty.focus = focus;
  const Image without = draw(empty);
  for (const Body& body : three_boxes().bodies) {
    const PicturePoint at = project(camera_, kSize, body.pose.translation());
    const auto x = static_cast<int>(at.x);
    const auto y = static_cast<int>(at.y);
    int gap = 0;
    for (int channel = 0; channel < 3; ++channel) {
      gap += std::abs(int{with.pixel(x, y)[channel]} - int{without.pixel(x, y)[channel]});
    }
    EXPECT_GT(gap, 40);
  }
}

TEST_F(Frame, ArrowPixelsStandWhereTheWitnessesProject) {
  Scene scene = three_boxes();
  const Arrow arrow = long_arrow();
  scene.arrows.push_back(arrow);
  const Image image = draw(scene);
  for (double t = 0.05; t < 1; t += 0.05) {
    const PicturePoint at = project(camera_, kSize, arrow.from + t * (arrow.to - arrow.from));
    EXPECT_TRUE(test::is_arrow_colour(image.pixel(static_cast<int>(at.x), static_cast<int>(at.y)))) << "at share " << t;
  }
  // Nowhere else: every such pixel is within the arrow's thickness of its segment.
  const PicturePoint from = project(camera_, kSize, arrow.from);
  const PicturePoint to = project(camera_, kSize, arrow.to);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (test::is_arrow_colour(image.pixel(x, y))) {
        EXPECT_LT(std::abs(x + 0.5 - 0.5 * (from.x + to.x)), 8);
        EXPECT_GT(y, std::min(from.y, to.y) - 3);
        EXPECT_LT(y, std::max(from.y, to.y) + 3);
      }
    }
  }
}

TEST_F(Frame, ArrowShowsThroughTheBodyThatHidesIt) {
  Scene scene = three_boxes();
  const Arrow arrow{.from = {0, 0, 0.2}, .to = {0, 0, 0.8}};
  const Image before = draw(scene);
  scene.arrows.push_back(arrow);
  const Image after = draw(scene);
  const PicturePoint at = project(camera_, kSize, {0, 0, 0.5});
  const auto x = static_cast<int>(at.x);
  const auto y = static_cast<int>(at.y);
  const auto redness = [&](const Image& image) { return int{image.pixel(x, y)[0]} - int{image.pixel(x, y)[2]}; };
  EXPECT_GT(redness(after), redness(before) + 60);
}

// A floor point in front of a box, lit from behind it and then from the front; a ghost's shadow lies between.
TEST_F(Frame, BodiesCastShadowsOnTheFloor) {
  Scene scene = three_boxes();
  const auto floor_light = [&](const Vec3& light, float opacity) {
    scene.light_direction = light;
    for (Body& body : scene.bodies) {
      body.opacity = opacity;
    }
    const Image image = draw(scene);
    const PicturePoint at = project(camera_, kSize, {-1.4, -0.7, 0});
    return int{image.pixel(static_cast<int>(at.x), static_cast<int>(at.y))[1]};
  };
  const int shadowed = floor_light({0, 1, 1}, 1);
  const int lit = floor_light({0, -1, 1}, 1);
  const int ghost = floor_light({0, 1, 1}, 0.5f);
  EXPECT_LT(shadowed, lit - 25);
  EXPECT_LT(ghost, lit - 5);
  EXPECT_GT(ghost, shadowed + 5);
}

TEST_F(Frame, SameSceneSameBytes) {
  const Image first = draw(three_boxes());
  draw(Scene{});
  const Image again = draw(three_boxes());
  EXPECT_EQ(difference(first, again).largest, 0);
}

TEST_F(Frame, LabelsAreDrawnBesideTheirPlace) {
  Scene scene = three_boxes();
  const Image plain = draw(scene);
  scene.labels.push_back({.at = {0, 0, 1}, .text = "witness"});
  const Image labelled = draw(scene);
  int changed = 0;
  for (std::size_t i = 0; i < plain.bytes().size(); i += 4) {
    changed += plain.bytes()[i] != labelled.bytes()[i] ? 1 : 0;
  }
  EXPECT_GT(changed, 60);
}

// A scene of any size and place makes the same picture.
TEST_F(Frame, ScaleAndPlaceDoNotMatter) {
  const Image plain = draw(three_boxes());
  for (const double scale : {1e-5, 1e5}) {
    Scene scaled = three_boxes();
    scaled.ground.metres_per_unit = 1 / scale;
    const MeshRef box = box_mesh(Vec3::Constant(0.5 * scale));
    for (Body& body : scaled.bodies) {
      body.mesh = box;
      body.pose = test::placed(scale * body.pose.translation());
    }
    const Camera camera = frame_box(bounds(scaled), kSize);
    const auto image = renderer_->draw(scaled, camera, kSize);
    ASSERT_TRUE(image);
    EXPECT_LT(difference(plain, *image).mean, 0.4) << scale;
  }
}

TEST(Contexts, WordsNameThem) {
  EXPECT_EQ(*context_kind("osmesa"), ContextKind::osmesa);
  EXPECT_EQ(*context_kind("egl"), ContextKind::egl);
  const auto unknown = context_kind("vulkan");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::bad_value);
}

TEST(Contexts, OsmesaAndEglAgree) {
  auto osmesa = Renderer::create(ContextKind::osmesa);
  auto egl = Renderer::create(ContextKind::egl);
  if (!osmesa || !egl) {
    GTEST_SKIP() << (osmesa ? egl.error().message : osmesa.error().message);
  }
  Scene scene = three_boxes();
  scene.arrows.push_back(long_arrow());
  const Camera camera = frame_box(bounds(scene), kSize);
  Renderer one = *std::move(osmesa);
  Renderer other = *std::move(egl);
  // Turns: each context must find its way back to the thread.
  for (int turn = 0; turn < 2; ++turn) {
    const auto a = one.draw(scene, camera, kSize);
    const auto b = other.draw(scene, camera, kSize);
    ASSERT_TRUE(a);
    ASSERT_TRUE(b);
    EXPECT_LT(difference(*a, *b).mean, 1.0);
  }
}

}  // namespace
}  // namespace pd::render
