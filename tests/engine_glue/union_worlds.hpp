/// @file
/// Worlds whose ground is made of many pieces that are meant as one: meshes, heightfields, compounds. y up; the upper
/// face of every flat ground lies at y = 0 before its margin.
#pragma once

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {

/// A world under pdepth's contacts by default, with the meshes and heights that its shapes point to.
class UnionWorld {
 public:
  explicit UnionWorld(bool ours = true, const BulletSolverSettings& settings = {}) : solver(settings) {
    if (ours) install(bullet.world(), solver);
  }

  btRigidBody* fixed(btCollisionShape* shape, const btVector3& at = btVector3(0, 0, 0)) {
    return smooth(bullet.body(shape, 0, at));
  }
  btRigidBody* moving(btCollisionShape* shape, const btTransform& pose, const btVector3& velocity) {
    btRigidBody* body = smooth(bullet.body(shape, 1, pose));
    body->setLinearVelocity(velocity);
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
  }
  btRigidBody* moving(btCollisionShape* shape, const btVector3& at, const btVector3& velocity) {
    return moving(shape, btTransform(btQuaternion::getIdentity(), at), velocity);
  }
  void step(int count = 1) {
    for (int i = 0; i < count; ++i) bullet.world().stepSimulation(btScalar(1) / 60, 0);
  }

  using Triangle = std::array<btVector3, 3>;
  btBvhTriangleMeshShape* mesh(const std::vector<Triangle>& triangles, btScalar margin, bool wide_indices = true) {
    meshes.push_back(std::make_unique<btTriangleMesh>(wide_indices));
    for (const Triangle& t : triangles) meshes.back()->addTriangle(t[0], t[1], t[2]);
    auto* shape = bullet.shape<btBvhTriangleMeshShape>(meshes.back().get(), true);
    shape->setMargin(margin);
    return shape;
  }

  std::vector<std::unique_ptr<btTriangleMesh>> meshes;
  std::vector<std::unique_ptr<std::vector<btScalar>>> heights;
  BulletPenetrationDepthSolver solver;
  BulletWorld bullet;

 private:
  static btRigidBody* smooth(btRigidBody* body) {
    body->setFriction(0);
    body->setRestitution(0);
    return body;
  }
};

/// Appends the two triangles of a rectangle of corners a, b, c, d, counter-clockwise seen from outside.
inline void add_rectangle(std::vector<UnionWorld::Triangle>& into, const btVector3& a, const btVector3& b,
                          const btVector3& c, const btVector3& d) {
  into.push_back({a, b, c});
  into.push_back({a, c, d});
}

/// A flat rectangle [x0, x1] x [z0, z1] at `height` in cells, facing up.
inline void add_floor(std::vector<UnionWorld::Triangle>& into, double x0, double x1, double z0, double z1, int along,
                      int across, double height = 0) {
  const auto at = [&](double i, double k) {
    return btVector3(btScalar(x0 + (x1 - x0) * i / along), btScalar(height), btScalar(z0 + (z1 - z0) * k / across));
  };
  for (int i = 0; i < along; ++i) {
    for (int k = 0; k < across; ++k) add_rectangle(into, at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k));
  }
}

/// Rows whose cells have different lengths, so that corners of one row lie inside edges of the next.
inline std::vector<UnionWorld::Triangle> floor_of_t_junctions(double extent, double half_width) {
  std::vector<UnionWorld::Triangle> triangles;
  const int cells[] = {17, 40, 23, 31};
  for (int row = 0; row < 4; ++row) {
    const double z0 = half_width * (0.5 * row - 1);
    add_floor(triangles, -extent, extent, z0, z0 + 0.5 * half_width, cells[row], 1);
  }
  return triangles;
}

inline btHeightfieldTerrainShape* flat_heightfield(UnionWorld& world, int side, btScalar spacing, btScalar margin,
                                                   bool diamonds = false) {
  world.heights.push_back(std::make_unique<std::vector<btScalar>>(static_cast<std::size_t>(side * side), btScalar(0)));
  const btScalar* data = world.heights.back()->data();
  auto* terrain = world.bullet.shape<btHeightfieldTerrainShape>(side, side, data, btScalar(-1), btScalar(1), 1, false);
  terrain->setLocalScaling(btVector3(spacing, 1, spacing));
  terrain->setUseDiamondSubdivision(diamonds);
  terrain->setMargin(margin);
  return terrain;
}

/// Boxes in a row along x, flush.
inline btCompoundShape* flush_boxes(UnionWorld& world, int count, btScalar length, btScalar half_width) {
  auto* compound = world.bullet.shape<btCompoundShape>();
  auto* box = world.bullet.shape<btBoxShape>(btVector3(length / 2, btScalar(.5), half_width));
  for (int i = 0; i < count; ++i) {
    compound->addChildShape(
        btTransform(btQuaternion::getIdentity(),
                    btVector3((btScalar(i) - btScalar(.5) * btScalar(count - 1)) * length, btScalar(-.5), 0)),
        box);
  }
  return compound;
}

/// Hulls in a row along x with oblique seams, as a decomposition leaves them: upper faces agree to 1e-7, and so do the
/// seams.
inline btCompoundShape* decomposed_slab(UnionWorld& world, int count, double length, double half_width,
                                        btScalar margin) {
  auto* compound = world.bullet.shape<btCompoundShape>();
  const auto seam = [&](int i, double z) { return length * (i - 0.5 * count) + 0.3 * z * (i % 2 == 0 ? 1 : -1); };
  for (int i = 0; i < count; ++i) {
    auto* hull = world.bullet.shape<btConvexHullShape>();
    const double off = 1e-7 * ((i * 7) % 5 - 2) / 2;
    for (const double y : {-1.0, off}) {
      for (const double z : {-half_width, half_width}) {
        hull->addPoint(btVector3(btScalar(seam(i, z) - off), btScalar(y), btScalar(z)), false);
        hull->addPoint(btVector3(btScalar(seam(i + 1, z) + off), btScalar(y), btScalar(z)), false);
      }
    }
    hull->setMargin(margin);
    hull->recalcLocalAabb();
    compound->addChildShape(btTransform::getIdentity(), hull);
  }
  return compound;
}

}  // namespace pd::test
