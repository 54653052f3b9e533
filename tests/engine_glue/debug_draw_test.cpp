// Contacts drawn as lines, by a drawer that records them.
#include "pd/bullet/debug_draw.hpp"

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

class RecordingDrawer final : public btIDebugDraw {
 public:
  struct Line {
    btVector3 from, to, color;
  };
  std::vector<Line> lines;
  std::vector<std::string> texts;

  void drawLine(const btVector3& from, const btVector3& to, const btVector3& color) override {
    lines.push_back({from, to, color});
  }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char* text) override { texts.emplace_back(text); }
  void setDebugMode(int) override {}
  [[nodiscard]] int getDebugMode() const override { return DBG_DrawContactPoints; }
};

/// A cube of a metre that stands an eighth of a metre deep in a floor.
TEST(DebugDraw, ShowsDepthNormalAndOutlineOfABoxOnAFloor) {
  BulletPenetrationDepthSolver solver;
  BulletWorld world;
  install(world.world(), solver);
  RecordingDrawer drawer;
  draw_contacts(world.world(), drawer);
  EXPECT_TRUE(drawer.lines.empty());

  world.body(world.shape<btBoxShape>(btVector3(5, 5, 5)), 0, btVector3(0, -5, 0));
  const btScalar half(0.5);
  world.body(world.shape<btBoxShape>(btVector3(half, half, half)), 1, btVector3(0, btScalar(0.375), 0));
  world.world().performDiscreteCollisionDetection();
  ContactDrawing drawing;
  drawing.depth_scale = 2;
  draw_contacts(world.world(), drawer, drawing);

  // Four depths, four edges of the outline, an arrow of three lines.
  ASSERT_EQ(drawer.lines.size(), 11U);
  int depths = 0, edges = 0;
  for (const RecordingDrawer::Line& line : drawer.lines) {
    const btVector3 way = line.to - line.from;
    const double along = static_cast<double>(way.y()),
                 across = static_cast<double>(btVector3(way.x(), 0, way.z()).length());
    depths += std::abs(std::abs(along) - 0.25) < 1e-5 && across < 1e-5 ? 1 : 0;
    edges += std::abs(along) < 1e-5 && std::abs(across - 1) < 1e-5 ? 1 : 0;
  }
  EXPECT_EQ(depths, 4);
  EXPECT_EQ(edges, 4);
  ASSERT_EQ(drawer.texts.size(), 1U);
  EXPECT_EQ(drawer.texts.front(), "0.125");
}

}  // namespace
}  // namespace pd::test
