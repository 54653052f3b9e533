/// @file
/// The line protocol's contacts of a box that slides over many pieces are those of the manifolds of a Bullet world.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "cli/protocol_lines.hpp"
#include "cli/temporary_folder.hpp"
#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

std::string number(double x) {
  std::ostringstream text;
  text.precision(17);
  text << x;
  return text.str();
}

std::string pose_of(const btTransform& pose) {
  std::string text = R"({"rotation_row_major":[)";
  for (int i = 0; i < 9; ++i) text += (i > 0 ? "," : "") + number(double(pose.getBasis()[i / 3][i % 3]));
  text += R"(],"translation":[)";
  for (int i = 0; i < 3; ++i) text += (i > 0 ? "," : "") + number(double(pose.getOrigin()[i]));
  return text + "]}";
}

Vec3 vector(const Json& three) { return {three[0].get<double>(), three[1].get<double>(), three[2].get<double>()}; }

/// Slides a box of half extent 0.4 for a second at 3 m/s and compares the contacts of every third step with the line's.
/// @param body  the box as Bullet's pair takes it: with corners that are round by the margin, or sharp
void expect_same_contacts(UnionWorld& world, btCollisionShape* ground, const std::string& body,
                          const std::string& line_ground) {
  world.fixed(ground);
  auto* box = world.bullet.shape<btBoxShape>(btVector3(btScalar(.4), btScalar(.4), btScalar(.4)));
  btRigidBody* moving = world.moving(box, btVector3(-9, btScalar(.4), btScalar(.13)), btVector3(3, 0, 0));
  int compared = 0;
  for (int step = 0; step < 60; ++step) {
    const btTransform pose = moving->getWorldTransform();
    world.step();
    if (step % 3 != 0) continue;
    btDispatcher& dispatcher = *world.bullet.world().getDispatcher();
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
      if (manifold.getNumContacts() == 0) continue;
      SCOPED_TRACE(step);
      const Json found = answer(R"({"id":1,"query":"contact_manifold","a":)" + body + R"(,"pose_a":)" + pose_of(pose) +
                                R"(,"b":)" + line_ground + R"(,"breaking_threshold":)" +
                                number(double(manifold.getContactBreakingThreshold())) + "}");
      ASSERT_EQ(found.value("patches", Json()).size(), 1U) << found;
      ASSERT_EQ(found["points"].size(), static_cast<std::size_t>(manifold.getNumContacts()));
      const bool swapped = manifold.getBody0() != moving;
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        const btVector3& on_ground = swapped ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
        const Vec3 place(double(on_ground.x()), double(on_ground.y()), double(on_ground.z()));
        const Vec3 up =
            (swapped ? -1 : 1) * Vec3(double(point.m_normalWorldOnB.x()), double(point.m_normalWorldOnB.y()),
                                      double(point.m_normalWorldOnB.z()));
        const bool there = std::any_of(found["points"].begin(), found["points"].end(), [&](const Json& said) {
          return (vector(said["position_b"]) - place).norm() < 2e-3 && (vector(said["normal"]) - up).norm() < 1e-5 &&
                 std::abs(said["depth"].get<double>() + double(point.getDistance())) < 1e-5;
        });
        EXPECT_TRUE(there) << place.transpose() << " in " << found;
        EXPECT_LT((up - Vec3::UnitY()).norm(), 1e-5);
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 60);
}

/// A mesh as a file, at the coordinates that Bullet holds.
std::string sheet_of(const std::vector<UnionWorld::Triangle>& triangles, const TemporaryFolder& folder) {
  std::string text;
  for (const auto& triangle : triangles) {
    for (const btVector3& corner : triangle) {
      text += "v " + number(double(corner.x())) + " " + number(double(corner.y())) + " " + number(double(corner.z())) +
              "\n";
    }
    text += "f -3 -2 -1\n";
  }
  return R"({"type":"mesh","as":"sheet","path":")" + folder.write("ground.obj", text) + "\"}";
}

/// Beside a triangle Bullet's box has round corners, by its margin.
std::string round_box() {
  const auto core = static_cast<double>(btScalar(.4) - CONVEX_DISTANCE_MARGIN);
  const std::string half = number(core);
  return R"({"type":"box","half_extents":[)" + half + "," + half + "," + half + R"(],"margin":)" +
         number(double(CONVEX_DISTANCE_MARGIN)) + "}";
}

TEST(ContactLines, AFlatMesh) {
  UnionWorld world;
  TemporaryFolder folder;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, -12, 12, -2, 2, 24, 4);
  expect_same_contacts(world, world.mesh(triangles, 0), round_box(), sheet_of(triangles, folder));
}

TEST(ContactLines, AMeshOfTJunctions) {
  UnionWorld world;
  TemporaryFolder folder;
  const auto triangles = floor_of_t_junctions(12, 2);
  expect_same_contacts(world, world.mesh(triangles, 0), round_box(), sheet_of(triangles, folder));
}

TEST(ContactLines, FlushBoxesOfACompound) {
  UnionWorld world;
  std::string parts;
  for (int i = 0; i < 24; ++i) {
    parts += std::string(i > 0 ? "," : "") +
             R"({"shape":{"type":"box","half_extents":[0.5,0.5,2]},"pose":{"translation":[)" + number(i - 11.5) +
             ",-0.5,0]}}";
  }
  const double half = double(btScalar(.4));
  expect_same_contacts(
      world, flush_boxes(world, 24, 1, 2),
      R"({"type":"box","half_extents":[)" + number(half) + "," + number(half) + "," + number(half) + "]}",
      R"({"type":"compound","parts":[)" + parts + "]}");
}

}  // namespace
}  // namespace pd::test
