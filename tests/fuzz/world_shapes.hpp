/// @file
/// Bytes of a fuzzer as Bullet's shapes, poses and lengths in a room of some metres.
#pragma once

#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <btBulletCollisionCommon.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "fuzz/input.hpp"

namespace pd::fuzz {

/// One triangle mesh with the memory that Bullet reads it from.
struct Mesh {
  std::vector<btScalar> coordinates;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> array;

  explicit Mesh(Input& input) {
    const int side = 2 + input.choice(4);
    for (int x = 0; x < side; ++x) {
      for (int z = 0; z < side; ++z) {
        coordinates.push_back(btScalar(x - side / 2));
        coordinates.push_back(btScalar(input.choice(4)) / 4);
        coordinates.push_back(btScalar(z - side / 2));
      }
    }
    for (int x = 0; x + 1 < side; ++x) {
      for (int z = 0; z + 1 < side; ++z) {
        const int at = x * side + z;
        for (const int corner : {at, at + 1, at + side, at + 1, at + side + 1, at + side}) indices.push_back(corner);
      }
    }
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(indices.size() / 3), indices.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(coordinates.size() / 3), coordinates.data(), static_cast<int>(3 * sizeof(btScalar)));
  }
};

/// Makes shapes and keeps them with the memory that they read.
class WorldShapes {
 public:
  explicit WorldShapes(Input& input) : input_(input) {}

  btScalar length() { return btScalar(1 + input_.choice(16)) / 8; }
  btScalar signed_length() { return btScalar(static_cast<std::int8_t>(input_.byte())) / 32; }
  btVector3 scaling() {
    const btScalar x = length(), y = length();
    return {x, y, length()};
  }
  btVector3 place() {
    const btScalar x = signed_length(), y = signed_length();
    return {x, y, signed_length()};
  }
  btTransform pose() {
    const btVector3 at = place();
    btQuaternion turned = btQuaternion::getIdentity();
    if (input_.choice(2) == 1) {
      const btVector3 axis = place();
      const btScalar angle = signed_length();
      if (axis.length2() > btScalar(1e-6)) turned = btQuaternion(axis.normalized(), angle);
    }
    return btTransform(turned, at);
  }

  btConvexShape* convex() {
    const btScalar a = length(), b = length();
    switch (input_.choice(16)) {
      case 0:
        return keep<btSphereShape>(a);
      case 1:
        return keep<btCapsuleShape>(a, b);
      case 2:
        return keep<btCylinderShapeX>(btVector3(a, b, b));
      case 3:
        return keep<btCylinderShape>(btVector3(b, a, b));
      case 4:
        return keep<btConeShapeZ>(a, b);
      case 5: {
        const std::array<btVector3, 2> centres{place(), place()};
        const std::array<btScalar, 2> radii{a, b};
        return keep<btMultiSphereShape>(centres.data(), radii.data(), 2);
      }
      case 6: {
        const btVector3 p = place(), q = place();
        return keep<btTriangleShape>(p, q, place());
      }
      case 7: {
        auto* sum = keep<btMinkowskiSumShape>(keep<btBoxShape>(btVector3(a, a, b)), keep<btSphereShape>(b));
        return sum;
      }
      case 8:
        return keep<btUniformScalingShape>(convex(), b);
      case 9: {
        auto* mesh = keep_mesh();
        return keep<btConvexTriangleMeshShape>(mesh->array.get());
      }
      case 10: {
        points_.emplace_back();
        for (int i = 2 + input_.choice(8); i > 0; --i) points_.back().push_back(place());
        return keep<btConvexPointCloudShape>(points_.back().data(), static_cast<int>(points_.back().size()),
                                             btVector3(1, 1, 1));
      }
      case 11:
      case 12: {
        auto* hull = keep<btConvexHullShape>();
        for (int i = 1 + input_.choice(12); i > 0; --i) hull->addPoint(place(), false);
        hull->recalcLocalAabb();
        return hull;
      }
      default:
        return keep<btBoxShape>(btVector3(a, b, a));
    }
  }

  Mesh* keep_mesh() {
    meshes_.push_back(std::make_unique<Mesh>(input_));
    return meshes_.back().get();
  }

  btCompoundShape* compound(int depth) {
    auto* whole = keep<btCompoundShape>(input_.choice(4) != 0);
    for (int i = input_.choice(5); i > 0; --i) {
      const btTransform at = pose();
      const int kind = input_.choice(8);
      if (kind == 0 && depth > 0) {
        whole->addChildShape(at, compound(depth - 1));
      } else if (kind == 1) {
        whole->addChildShape(at, surface());
      } else {
        whole->addChildShape(at, convex());
      }
    }
    return whole;
  }

  /// A shape that only bodies at rest may have.
  btCollisionShape* surface() {
    switch (input_.choice(4)) {
      case 0: {
        heights_.push_back(std::make_unique<std::array<float, 16>>());
        for (float& h : *heights_.back()) h = static_cast<float>(input_.choice(8)) / 8;
        return keep<btHeightfieldTerrainShape>(4, 4, heights_.back()->data(), btScalar(1), btScalar(0), btScalar(1), 1,
                                               PHY_FLOAT, input_.choice(2) == 0);
      }
      case 1: {
        auto* mesh = keep<btBvhTriangleMeshShape>(keep_mesh()->array.get(), true);
        return keep<btScaledBvhTriangleMeshShape>(mesh, scaling());
      }
      default:
        return keep<btBvhTriangleMeshShape>(keep_mesh()->array.get(), input_.choice(2) == 0);
    }
  }

  btCollisionShape* any_shape() {
    switch (input_.choice(8)) {
      case 0:
        return compound(2);
      case 1:
        return surface();
      case 2:
        return keep<btStaticPlaneShape>(btVector3(0, 1, 0), signed_length());
      case 3:
        return shapes_.empty() ? convex() : shapes_[static_cast<std::size_t>(input_.byte()) % shapes_.size()].get();
      case 4:
        return keep<btEmptyShape>();
      default:
        return convex();
    }
  }

  /// Bullet gives no inertia to surfaces, planes and shapes without points.
  static bool may_move(const btCollisionShape* shape) {
    if (shape->isCompound()) {
      const auto* whole = static_cast<const btCompoundShape*>(shape);
      for (int i = 0; i < whole->getNumChildShapes(); ++i) {
        if (!may_move(whole->getChildShape(i))) return false;
      }
      return true;
    }
    return !shape->isNonMoving() && !shape->isConcave() && shape->getShapeType() != EMPTY_SHAPE_PROXYTYPE;
  }

  /// Moves one corner of the mesh under `shape` and lets Bullet refit its tree.
  void bend(btBvhTriangleMeshShape& shape) {
    for (const auto& mesh : meshes_) {
      if (shape.getMeshInterface() != mesh->array.get()) continue;
      mesh->coordinates[static_cast<std::size_t>(input_.byte()) % mesh->coordinates.size()] += length() / 4;
      shape.refitTree(btVector3(-10, -10, -10), btVector3(10, 10, 10));
    }
  }

 private:
  template <class Shape, class... Arguments>
  Shape* keep(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* raw = made.get();
    shapes_.push_back(std::move(made));
    return raw;
  }

  Input& input_;
  std::vector<std::vector<btVector3>> points_;
  std::vector<std::unique_ptr<std::array<float, 16>>> heights_;
  std::vector<std::unique_ptr<Mesh>> meshes_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
};

}  // namespace pd::fuzz
