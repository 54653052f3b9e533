#include "engine_glue/shape_matrix.hpp"

#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btMultimaterialTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btSdfCollisionShape.h>
#include <BulletCollision/CollisionShapes/btTetrahedronShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

namespace pd::test {

namespace {

constexpr double kHalfWidth = 15;

btVector3 vector(double x, double y, double z) {
  return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
}
btTransform at(double x, double y, double z) { return btTransform(btQuaternion::getIdentity(), vector(x, y, z)); }

/// The corners of a box.
std::array<btVector3, 8> corners_of(const btVector3& half) {
  std::array<btVector3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners[static_cast<std::size_t>(i)] =
        btVector3((i & 1) ? half.x() : -half.x(), (i & 2) ? half.y() : -half.y(), (i & 4) ? half.z() : -half.z());
  }
  return corners;
}

/// A convex type of the host's own, which the conversion refuses: a box of these half extents by its support alone.
class HostsConvex final : public btConvexInternalShape {
 public:
  explicit HostsConvex(const btVector3& half) : half_(half) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    setMargin(btScalar(0.01));
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& v) const override {
    return btVector3(std::copysign(half_.x(), v.x()), std::copysign(half_.y(), v.y()), std::copysign(half_.z(), v.z()));
  }
  btVector3 localGetSupportingVertex(const btVector3& v) const override {
    btVector3 direction = v;
    if (direction.fuzzyZero()) direction.setValue(0, 1, 0);
    return localGetSupportingVertexWithoutMargin(v) + getMargin() * direction.normalized();
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* v, btVector3* out, int count) const override {
    for (int i = 0; i < count; ++i) out[i] = localGetSupportingVertexWithoutMargin(v[i]);
  }
  void calculateLocalInertia(btScalar mass, btVector3& inertia) const override {
    btBoxShape(half_).calculateLocalInertia(mass, inertia);
  }
  void getAabb(const btTransform& t, btVector3& lower, btVector3& upper) const override {
    btTransformAabb(half_, getMargin(), t, lower, upper);
  }
  const char* getName() const override { return "HostsConvex"; }

 private:
  btVector3 half_;
};

/// A signed distance field of one cell, cubic, as Bullet reads it from memory: the height above y = 0.
class FieldOfHeight {
 public:
  FieldOfHeight() {
    for (const double bound : {-kHalfWidth, kHalfWidth}) {
      for (int axis = 0; axis < 3; ++axis) add(bound);
    }
    for (int axis = 0; axis < 3; ++axis) add(1U);
    for (int axis = 0; axis < 3; ++axis) add(2 * kHalfWidth);
    for (int axis = 0; axis < 3; ++axis) add(0.5 / kHalfWidth);
    for (const std::uint64_t count : {1ULL, 1ULL, 1ULL, 32ULL}) add(count);
    for (int node = 0; node < 32; ++node) add(kHalfWidth * height_of(node));
    for (const std::uint64_t count : {1ULL, 1ULL}) add(count);
    for (unsigned node = 0; node < 32; ++node) add(node);
    for (const std::uint64_t count : {1ULL, 1ULL}) add(count);
    add(0U);
  }
  [[nodiscard]] const std::vector<char>& bytes() const { return bytes_; }

 private:
  template <class T>
  void add(T value) {
    const auto* const first = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  /// In [-1, 1]: corners first, then two nodes on each edge along x, y and z.
  static double height_of(int node) {
    if (node < 8) return (node & 2) != 0 ? 1 : -1;
    if (node < 16) return node < 12 ? -1 : 1;
    if (node < 24) return (node & 1) != 0 ? 1.0 / 3 : -1.0 / 3;
    return ((node - 24) & 2) != 0 ? 1 : -1;
  }
  std::vector<char> bytes_;
};

}  // namespace

template <class... Children>
btCompoundShape* ShapeMatrix::compound_of(const Children&... children) {
  auto* compound = make<btCompoundShape>();
  (compound->addChildShape(children.first, children.second), ...);
  return compound;
}

btTriangleMesh& ShapeMatrix::mesh_of_floor(double half_width, int cells) {
  meshes_.push_back(std::make_unique<btTriangleMesh>());
  btTriangleMesh& mesh = *meshes_.back();
  const auto corner = [&](int i, int k) {
    return vector(half_width * (2.0 * i / cells - 1), 0, half_width * (2.0 * k / cells - 1));
  };
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      mesh.addTriangle(corner(i, k), corner(i, k + 1), corner(i + 1, k + 1));
      mesh.addTriangle(corner(i, k), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return mesh;
}

btTriangleMesh& ShapeMatrix::mesh_of_cube(double half) {
  meshes_.push_back(std::make_unique<btTriangleMesh>());
  const auto corners = corners_of(vector(half, half, half));
  constexpr int kFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const auto& face : kFaces) meshes_.back()->addTriangle(corners[face[0]], corners[face[1]], corners[face[2]]);
  return *meshes_.back();
}

void ShapeMatrix::make_convex_bodies() {
  const btVector3 half = vector(0.2, 0.1, 0.15);
  const auto corners = corners_of(half);
  const btScalar* const first = &corners[0].x();
  const btTransform lying(btQuaternion(vector(1, 0, 0), btScalar(-std::numbers::pi / 2)));
  auto* box = make<btBoxShape>(half);
  bodies_.push_back({"box", box});
  bodies_.push_back({"sphere", make<btSphereShape>(btScalar(0.15))});
  bodies_.push_back({"capsule", make<btCapsuleShapeX>(btScalar(0.1), btScalar(0.3))});
  auto* coin = make<btCylinderShape>(vector(0.2, 0.03, 0.2));
  coin->setMargin(btScalar(0.005));
  bodies_.push_back({"cylinder", coin});
  auto* flat = make<btCylinderShape>(vector(0.2, 0.02, 0.2));
  flat->setMargin(btScalar(0.04));
  bodies_.push_back({"cylinder with a margin beyond its half height", flat});
  auto* exactly_flat = make<btCylinderShape>(vector(0.2, 0.04, 0.2));
  exactly_flat->setMargin(btScalar(0.04));
  bodies_.push_back({"cylinder with a margin of its half height", exactly_flat});
  auto* thin = make<btBoxShape>(vector(0.2, 0.02, 0.2));
  thin->setMargin(btScalar(0.04));
  bodies_.push_back({"box with a margin beyond its half height", thin});
  bodies_.push_back({"cone", make<btConeShape>(btScalar(0.2), btScalar(0.2))});
  auto* hull = make<btConvexHullShape>(first, 8, static_cast<int>(sizeof(btVector3)));
  hull->setMargin(btScalar(0.01));
  hull->recalcLocalAabb();
  bodies_.push_back({"hull", hull});
  auto* scaled = make<btConvexHullShape>(first, 8, static_cast<int>(sizeof(btVector3)));
  scaled->setLocalScaling(vector(1, 0.5, 1.2));
  bodies_.push_back({"scaled hull", scaled});
  static std::array<btVector3, 8> cloud = corners;
  bodies_.push_back({"point cloud", make<btConvexPointCloudShape>(cloud.data(), 8, vector(1, 1, 1))});
  bodies_.push_back({"tetrahedron", make<btBU_Simplex1to4>(vector(-0.2, -0.05, -0.2), vector(0.2, -0.05, -0.2),
                                                           vector(0, -0.05, 0.25), vector(0, 0.15, 0))});
  bodies_.push_back(
      {"triangle", make<btTriangleShape>(vector(-0.2, 0, -0.2), vector(0.2, 0, -0.2), vector(0, 0, 0.3))});
  bodies_.push_back({"convex mesh", make<btConvexTriangleMeshShape>(&mesh_of_cube(0.12))});
  const std::array<btVector3, 2> centres{vector(-0.15, 0, 0), vector(0.15, 0, 0)};
  const std::array<btScalar, 2> radii{btScalar(0.1), btScalar(0.1)};
  bodies_.push_back({"multisphere", make<btMultiSphereShape>(centres.data(), radii.data(), 2)});
  auto* stretched = make<btMultiSphereShape>(centres.data(), radii.data(), 2);
  stretched->setLocalScaling(vector(1, 1.5, 1.2));
  bodies_.push_back({"multisphere scaled differently", stretched});
  bodies_.push_back({"uniform scaling", make<btUniformScalingShape>(hull, btScalar(0.7))});
  bodies_.push_back({"Minkowski sum", make<btMinkowskiSumShape>(box, make<btSphereShape>(btScalar(0.05)))});
  bodies_.push_back({"Minkowski sum of smooth shapes", make<btMinkowskiSumShape>(box, coin)});
  bodies_.push_back({"2D box", make<btBox2dShape>(vector(0.2, 0.2, 0.1)), lying});
  bodies_.push_back({"2D convex", make<btConvex2dShape>(hull)});
  bodies_.push_back({"convex of the host", make<HostsConvex>(half)});
}

void ShapeMatrix::make_compound_bodies() {
  const btVector3 half = vector(0.1, 0.1, 0.15);
  auto* box = make<btBoxShape>(half);
  auto* flat = make<btCylinderShape>(vector(0.2, 0.02, 0.2));
  flat->setMargin(btScalar(0.04));
  const std::array<btVector3, 2> centres{vector(-0.15, 0, 0), vector(0.15, 0, 0)};
  const std::array<btScalar, 2> radii{btScalar(0.1), btScalar(0.1)};
  auto* stretched = make<btMultiSphereShape>(centres.data(), radii.data(), 2);
  stretched->setLocalScaling(vector(1, 1.5, 1.2));
  const auto left = [](btCollisionShape* shape) { return std::pair{at(-0.1, 0, 0), shape}; };
  const auto right = [](btCollisionShape* shape) { return std::pair{at(0.1, 0, 0), shape}; };
  const auto here = [](btCollisionShape* shape) { return std::pair{btTransform::getIdentity(), shape}; };
  auto* pair = compound_of(left(box), right(box));
  bodies_.push_back({"compound of boxes", pair});
  bodies_.push_back({"compound of one box", compound_of(here(box))});
  bodies_.push_back({"compound with an empty shape", compound_of(left(box), right(make<btEmptyShape>()), right(box))});
  bodies_.push_back({"compound of an empty shape alone", compound_of(here(make<btEmptyShape>()))});
  bodies_.push_back({"compound without children", compound_of()});
  bodies_.push_back({"compound with a flat cylinder", compound_of(here(flat))});
  bodies_.push_back({"compound with a multisphere scaled differently", compound_of(here(stretched))});
  bodies_.push_back({"compound of both", compound_of(left(box), std::pair{at(0.3, 0, 0), stretched})});
  bodies_.push_back({"nested compounds", compound_of(here(pair), std::pair{at(0, 0.15, 0), flat})});
  bodies_.push_back({"compound with a convex of the host", compound_of(left(make<HostsConvex>(half)), right(box))});
  auto* cube = make<btGImpactMeshShape>(&mesh_of_cube(0.12));
  cube->setMargin(btScalar(0.01));
  cube->updateBound();
  bodies_.push_back({"GImpact mesh", cube});
  auto* gimpact = make<btGImpactCompoundShape>();
  gimpact->addChildShape(at(-0.1, 0, 0), box);
  gimpact->addChildShape(at(0.1, 0, 0), box);
  gimpact->updateBound();
  bodies_.push_back({"GImpact compound", gimpact});
  bodies_.push_back({"empty shape", make<btEmptyShape>()});
}

void ShapeMatrix::make_grounds() {
  const btVector3 half = vector(kHalfWidth, 1, kHalfWidth);
  auto* box = make<btBoxShape>(half);
  grounds_.push_back({"box", box, vector(0, -1, 0)});
  auto* plane = make<btStaticPlaneShape>(vector(0, 1, 0), btScalar(0));
  grounds_.push_back({"plane", plane});
  const auto corners = corners_of(half);
  auto* hull = make<btConvexHullShape>(&corners[0].x(), 8, static_cast<int>(sizeof(btVector3)));
  hull->setMargin(0);
  hull->recalcLocalAabb();
  grounds_.push_back({"hull", hull, vector(0, -1, 0)});
  auto* disc = make<btCylinderShape>(vector(kHalfWidth, 0.03, kHalfWidth));
  disc->setMargin(btScalar(0.04));
  grounds_.push_back({"cylinder with a margin beyond its half height", disc, vector(0, -0.03, 0)});
  const auto flush = [](auto* mesh) {
    mesh->setMargin(0);
    return mesh;
  };
  auto* mesh = flush(make<btBvhTriangleMeshShape>(&mesh_of_floor(kHalfWidth, 20), true));
  grounds_.push_back({"mesh", mesh});
  grounds_.push_back(
      {"mesh of two triangles", flush(make<btBvhTriangleMeshShape>(&mesh_of_floor(kHalfWidth, 1), true))});
  grounds_.push_back(
      {"multimaterial mesh", flush(make<btMultimaterialTriangleMeshShape>(&mesh_of_floor(kHalfWidth, 20), true))});
  auto* small = flush(make<btBvhTriangleMeshShape>(&mesh_of_floor(kHalfWidth / 2, 20), true));
  grounds_.push_back({"scaled mesh", flush(make<btScaledBvhTriangleMeshShape>(small, vector(2, 1, 2)))});
  constexpr int kSide = 31;
  heights_.assign(static_cast<std::size_t>(kSide * kSide), btScalar(0));
  grounds_.push_back({"heightfield", flush(make<btHeightfieldTerrainShape>(kSide, kSide, heights_.data(), btScalar(-1),
                                                                           btScalar(1), 1, false))});
  auto* field = make<btSdfCollisionShape>();
  const FieldOfHeight bytes;
  field->initializeSDF(bytes.bytes().data(), static_cast<int>(bytes.bytes().size()));
  grounds_.push_back({"signed distance field", field});
  auto* gimpact = make<btGImpactMeshShape>(&mesh_of_floor(kHalfWidth, 10));
  gimpact->updateBound();
  grounds_.push_back({"GImpact mesh", gimpact});
  auto* tile = make<btBoxShape>(vector(kHalfWidth / 2, 1, kHalfWidth));
  auto* tiles = compound_of(std::pair{at(-kHalfWidth / 2, 0, 0), tile}, std::pair{at(kHalfWidth / 2, 0, 0), tile});
  grounds_.push_back({"compound of boxes", tiles, vector(0, -1, 0)});
  const auto here = [](btCollisionShape* shape) { return std::pair{btTransform::getIdentity(), shape}; };
  grounds_.push_back({"compound with a plane", compound_of(here(plane))});
  grounds_.push_back({"compound with a plane and a box", compound_of(here(plane), std::pair{at(0, -1, 0), box})});
  grounds_.push_back({"compound with a mesh", compound_of(here(mesh))});
  grounds_.push_back(
      {"compound with an empty shape", compound_of(here(make<btEmptyShape>()), std::pair{at(0, -1, 0), box})});
  grounds_.push_back({"compound with a flat cylinder", compound_of(here(disc)), vector(0, -0.03, 0)});
  grounds_.push_back({"nested compounds", compound_of(std::pair{at(0, 0, 0), tiles}), vector(0, -1, 0)});
  grounds_.push_back({"nested compounds with a plane", compound_of(here(compound_of(here(plane))))});
}

ShapeMatrix::ShapeMatrix() {
  make_convex_bodies();
  make_compound_bodies();
  make_grounds();
}

ShapeMatrix::~ShapeMatrix() {
  // What holds other shapes goes before them.
  while (!shapes_.empty()) shapes_.pop_back();
}

}  // namespace pd::test
