// Meshes as hosts have them: refused by name, or answered right, and never a crash.
#include <gtest/gtest.h>

#include <limits>

#include "engine_glue/union_worlds.hpp"
#include "pd/bullet/mesh_check.hpp"

namespace pd::test {
namespace {

using Triangles = std::vector<UnionWorld::Triangle>;

Triangles floor_of_cells() {
  Triangles triangles;
  add_floor(triangles, -8, 8, -2, 2, 16, 4);
  return triangles;
}

/// The speed that is left of 3 m/s after two seconds; -1 for a box that has left the floor's height by a millimetre.
double speed_over(UnionWorld& world, btCollisionShape* ground) {
  world.fixed(ground);
  const btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(btVector3(.4F, .4F, .4F)),
                                         btVector3(-5, .4F, .13F), btVector3(3, 0, 0));
  for (int i = 0; i < 120; ++i) {
    world.step();
    if (!(std::abs(body->getWorldTransform().getOrigin().y() - btScalar(.4)) < btScalar(1e-3))) return -1;
  }
  return static_cast<double>(body->getLinearVelocity().x());
}

TEST(BadMesh, TrianglesWithoutAreaAndTwiceTheSameAreHarmless) {
  UnionWorld world;
  Triangles triangles = floor_of_cells();
  const std::size_t count = triangles.size();
  for (std::size_t i = 0; i < count; i += 3) {
    const UnionWorld::Triangle t = triangles[i];
    triangles.push_back({t[2], t[1], t[0]});
    triangles.push_back({t[0], t[1], t[1]});
    triangles.push_back({t[2], t[2], t[2]});
    triangles.push_back({t[0], (t[0] + t[1]) / 2, t[1]});
  }
  btBvhTriangleMeshShape* ground = world.mesh(triangles, 0);
  const auto report = check_mesh(*world.meshes.back());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->faces, static_cast<std::int64_t>(triangles.size()));
  EXPECT_EQ(report->count(MeshFault::degenerate_face), static_cast<std::int64_t>(3 * ((count + 2) / 3)));
  EXPECT_NEAR(speed_over(world, ground), 3, 0.005);
  EXPECT_GT(world.solver.statistics().skipped_triangles, 0);
}

TEST(BadMesh, EdgesOfThreeTrianglesAreHarmless) {
  UnionWorld world;
  Triangles triangles = floor_of_cells();
  // Sheets that hang from the floor's inner edges.
  for (int x = -4; x <= 4; ++x) {
    triangles.push_back({btVector3(btScalar(x), 0, -1), btVector3(btScalar(x), 0, 0), btVector3(btScalar(x), -1, 0)});
    triangles.push_back({btVector3(btScalar(x), 0, 0), btVector3(btScalar(x), 0, 1), btVector3(btScalar(x), -1, 0)});
  }
  btBvhTriangleMeshShape* ground = world.mesh(triangles, 0);
  const auto report = check_mesh(*world.meshes.back());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->count(MeshFault::not_manifold), 18);
  EXPECT_NEAR(speed_over(world, ground), 3, 0.005);
}

TEST(BadMesh, ShortIndicesScalingAndUpdates) {
  for (const bool scaled : {false, true}) {
    UnionWorld world;
    Triangles triangles;
    const double size = scaled ? 0.5 : 1;
    add_floor(triangles, -8 * size, 8 * size, -2 * size, 2 * size, 16, 4, -0.5 * size);
    world.meshes.push_back(std::make_unique<btTriangleMesh>(false));
    btTriangleMesh& vertices = *world.meshes.back();
    for (const auto& t : triangles) vertices.addTriangle(t[0], t[1], t[2]);
    // The floor is lifted to y = 0 after the tree was built, within what the tree was built for.
    auto* mesh =
        world.bullet.shape<btBvhTriangleMeshShape>(&vertices, true, btVector3(-10, -1, -10), btVector3(10, 1, 10));
    mesh->setMargin(0);
    unsigned char* base = nullptr;
    unsigned char* indices = nullptr;
    int count = 0;
    int stride = 0;
    int index_stride = 0;
    int faces = 0;
    PHY_ScalarType type{};
    PHY_ScalarType index_type{};
    vertices.getLockedVertexIndexBase(&base, count, type, stride, &indices, index_stride, faces, index_type);
    for (int i = 0; i < count; ++i) reinterpret_cast<btScalar*>(base + i * stride)[1] = 0;
    vertices.unLockVertexBase(0);
    EXPECT_EQ(index_type, PHY_SHORT);
    mesh->refitTree(btVector3(-10, -1, -10), btVector3(10, 1, 10));
    mesh->recalcLocalAabb();
    EXPECT_TRUE(check_mesh(vertices));
    btCollisionShape* ground = mesh;
    if (scaled) ground = world.bullet.shape<btScaledBvhTriangleMeshShape>(mesh, btVector3(2, 1, 2));
    EXPECT_NEAR(speed_over(world, ground), 3, 0.005) << scaled;
  }
}

/// A mesh that Bullet is never given.
struct RawMesh {
  std::vector<float> vertices{0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::vector<int> indices{0, 1, 2};
  [[nodiscard]] Expected<SurfaceReport> check(int num_vertices = 3) {
    btIndexedMesh part;
    part.m_numTriangles = static_cast<int>(indices.size() / 3);
    part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices.data());
    part.m_triangleIndexStride = 3 * sizeof(int);
    part.m_numVertices = num_vertices;
    part.m_vertexBase = vertices.empty() ? nullptr : reinterpret_cast<const unsigned char*>(vertices.data());
    part.m_vertexStride = 3 * sizeof(float);
    part.m_vertexType = PHY_FLOAT;
    btTriangleIndexVertexArray mesh;
    mesh.addIndexedMesh(part, type);
    return check_mesh(mesh);
  }
  PHY_ScalarType type = PHY_INTEGER;
};

TEST(BadMesh, RefusedByName) {
  const auto code = [](const Expected<SurfaceReport>& answer) {
    return answer ? std::string("none") : std::string(to_string(answer.error().code)) + " " + answer.error().where;
  };
  RawMesh good;
  EXPECT_EQ(code(good.check()), "none");
  EXPECT_EQ(good.check()->count(MeshFault::open_edge), 3);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    RawMesh mesh;
    mesh.vertices[4] = bad;
    EXPECT_EQ(code(mesh.check()), "non_finite parts[0].triangles[0]");
  }
  for (const int bad : {3, -1, 1 << 30}) {
    RawMesh mesh;
    mesh.indices.insert(mesh.indices.end(), {0, bad, 1});
    EXPECT_EQ(code(mesh.check()), "out_of_range parts[0].triangles[1]");
  }
  RawMesh counts;
  EXPECT_EQ(code(counts.check(-1)), "bad_value parts[0]");
  RawMesh types;
  types.type = PHY_FIXEDPOINT88;
  EXPECT_EQ(code(types.check()), "unsupported parts[0]");
  RawMesh nothing;
  nothing.vertices.clear();
  EXPECT_EQ(code(nothing.check()), "bad_value parts[0]");
}

TEST(BadMesh, CornersThatAreNoNumbersMakeNoContacts) {
  UnionWorld world;
  // A host's own shape: Bullet's tree of such boxes is the host's risk, its triangles are ours.
  class Holes : public btConcaveShape {
   public:
    void processAllTriangles(btTriangleCallback* callback, const btVector3&, const btVector3&) const override {
      const btScalar nan = std::numeric_limits<btScalar>::quiet_NaN();
      btVector3 bad[3] = {btVector3(0, 0, 0), btVector3(nan, 0, 0), btVector3(0, nan, 1)};
      btVector3 far[3] = {btVector3(0, 0, 0), btVector3(std::numeric_limits<btScalar>::infinity(), 0, 0),
                          btVector3(0, 0, 1)};
      btVector3 floor[3] = {btVector3(-20, 0, -20), btVector3(0, 0, 20), btVector3(20, 0, -20)};
      callback->processTriangle(bad, 0, 0);
      callback->processTriangle(far, 0, 1);
      callback->processTriangle(floor, 0, 2);
    }
    void getAabb(const btTransform&, btVector3& lower, btVector3& upper) const override {
      lower.setValue(-20, -1, -20);
      upper.setValue(20, 1, 20);
    }
    void setLocalScaling(const btVector3&) override {}
    const btVector3& getLocalScaling() const override { return one_; }
    void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
    const char* getName() const override { return "holes"; }
    Holes() {
      m_shapeType = CUSTOM_CONCAVE_SHAPE_TYPE;
      m_collisionMargin = 0;
    }

   private:
    btVector3 one_{1, 1, 1};
  };
  EXPECT_NEAR(speed_over(world, world.bullet.shape<Holes>()), 3, 0.005);
  EXPECT_GT(world.solver.statistics().skipped_triangles, 0);
}

}  // namespace
}  // namespace pd::test
