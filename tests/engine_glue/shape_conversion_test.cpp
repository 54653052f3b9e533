// A converted shape has Bullet's support, margin included, in every direction.
#include "pd/bullet/shape_conversion.hpp"

#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "pd/bullet/scalar.hpp"

namespace {

double support_value(const pd::ConvexShape& shape, const pd::Vec3& d) {
  double core = -HUGE_VAL;
  if (const auto* polytope = shape.polytope()) {
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      core = std::max(core, polytope->vertex(v).dot(d));
    }
  } else if (const auto* cylinder = std::get_if<pd::Cylinder>(&shape.core())) {
    pd::Vec3 radial = d;
    radial[cylinder->axis] = 0;
    core = cylinder->radius * radial.norm() + cylinder->half_height * std::abs(d[cylinder->axis]);
  } else if (const auto* spheres = std::get_if<pd::SphereHull>(&shape.core())) {
    core = -HUGE_VAL;
    for (const pd::Sphere& s : spheres->spheres()) core = std::max(core, s.centre.dot(d) + s.radius * d.norm());
  } else {
    const auto& cone = std::get<pd::Cone>(shape.core());
    pd::Vec3 radial = d;
    radial[cone.axis] = 0;
    core = std::max(cone.half_height * d[cone.axis], cone.radius * radial.norm() - cone.half_height * d[cone.axis]);
  }
  return core + shape.margin() * d.norm();
}

void expect_same_support(const btConvexShape& shape) {
  const auto converted = pd::to_convex_shape(shape);
  ASSERT_TRUE(converted.has_value()) << shape.getName() << ": " << converted.error().message;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    pd::Vec3 d{normal(random), normal(random), normal(random)};
    if (i < 6) {
      d = (i % 2 ? 1 : -1) * pd::Vec3::Unit(i / 2);
    }
    btVector3 direction = pd::to_bullet(d.normalized());
    direction.normalize();
    const pd::Vec3 u = pd::to_pd(direction);
    const double bullet = pd::to_pd(shape.localGetSupportVertexNonVirtual(direction)).dot(u);
    ASSERT_NEAR(support_value(*converted, u), bullet, 2e-6 * (1 + std::abs(bullet))) << shape.getName() << " " << i;
  }
}

std::vector<btVector3> some_points() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<btVector3> points;
  for (int i = 0; i < 20; ++i) {
    points.push_back(pd::to_bullet(pd::Vec3{uniform(random), uniform(random), uniform(random)}));
  }
  return points;
}

btConvexHullShape some_hull() {
  btConvexHullShape hull;
  for (const btVector3& point : some_points()) {
    hull.addPoint(point);
  }
  return hull;
}

const btVector3 kScaling(btScalar(1.5), btScalar(0.5), btScalar(2));

TEST(ShapeConversion, BoxMarginLiesInside) {
  btBoxShape box(btVector3(1, 2, 3));
  expect_same_support(box);
  box.setMargin(btScalar(0.3));
  expect_same_support(box);
  box.setMargin(0);
  box.setLocalScaling(kScaling);
  expect_same_support(box);
}

TEST(ShapeConversion, HullPointCloudTetrahedronTriangle) {
  btConvexHullShape hull = some_hull();
  expect_same_support(hull);
  hull.setLocalScaling(kScaling);
  hull.setMargin(btScalar(0.2));
  expect_same_support(hull);
  hull.setLocalScaling(btVector3(-1, 1, 1));
  expect_same_support(hull);

  std::vector<btVector3> points = some_points();
  btConvexPointCloudShape cloud(points.data(), static_cast<int>(points.size()), kScaling);
  expect_same_support(cloud);

  btBU_Simplex1to4 simplex(points[0], points[1], points[2], points[3]);
  expect_same_support(simplex);
  btTriangleShape triangle(points[0], points[1], points[2]);
  expect_same_support(triangle);
  triangle.setMargin(0);
  expect_same_support(triangle);
}

TEST(ShapeConversion, ConvexTriangleMeshWithScaling) {
  const std::vector<btVector3> points = some_points();
  btTriangleMesh mesh;
  for (std::size_t i = 0; i + 2 < points.size(); ++i) {
    mesh.addTriangle(points[i], points[i + 1], points[i + 2]);
  }
  btConvexTriangleMeshShape shape(&mesh);
  expect_same_support(shape);
  shape.setLocalScaling(kScaling);
  expect_same_support(shape);
}

TEST(ShapeConversion, CylindersAndConesOnEveryAxis) {
  const btVector3 half(btScalar(0.7), btScalar(1.1), btScalar(0.7));
  btCylinderShape y(half);
  btCylinderShapeX x(btVector3(btScalar(1.1), btScalar(0.7), btScalar(0.7)));
  btCylinderShapeZ z(btVector3(btScalar(0.7), btScalar(0.7), btScalar(1.1)));
  for (btCylinderShape* cylinder : std::initializer_list<btCylinderShape*>{&x, &y, &z}) {
    expect_same_support(*cylinder);
    cylinder->setMargin(btScalar(0.01));
    expect_same_support(*cylinder);
    cylinder->setLocalScaling(btVector3(2, 2, 2));
    expect_same_support(*cylinder);
  }
  btConeShape cone_y(btScalar(0.7), btScalar(1.9));
  btConeShapeX cone_x(btScalar(0.7), btScalar(1.9));
  btConeShapeZ cone_z(btScalar(0.7), btScalar(1.9));
  for (btConeShape* cone : std::initializer_list<btConeShape*>{&cone_x, &cone_y, &cone_z}) {
    expect_same_support(*cone);
    cone->setLocalScaling(btVector3(2, 2, 2));
    expect_same_support(*cone);
  }
}

TEST(ShapeConversion, SphereCapsuleMultisphere) {
  btSphereShape sphere(btScalar(0.8));
  expect_same_support(sphere);
  sphere.setLocalScaling(btVector3(2, 2, 2));
  expect_same_support(sphere);
  btCapsuleShape y(btScalar(0.4), 2);
  btCapsuleShapeX x(btScalar(0.4), 2);
  btCapsuleShapeZ z(btScalar(0.4), 2);
  z.setMargin(btScalar(0.1));  // ignored by capsules
  for (const btCapsuleShape* capsule : std::initializer_list<btCapsuleShape*>{&x, &y, &z}) {
    expect_same_support(*capsule);
  }
  const std::vector<btVector3> centres = some_points();
  const std::vector<btScalar> radii(centres.size(), btScalar(0.3));
  btMultiSphereShape spheres(centres.data(), radii.data(), static_cast<int>(centres.size()));
  expect_same_support(spheres);
  spheres.setLocalScaling(btVector3(2, 2, 2));
  expect_same_support(spheres);
}

TEST(ShapeConversion, MultispheresOfUnequalRadii) {
  const std::vector<btVector3> centres = some_points();
  std::vector<btScalar> radii;
  for (std::size_t i = 0; i < centres.size(); ++i) radii.push_back(btScalar(0.1) + btScalar(0.07) * btScalar(i % 5));
  btMultiSphereShape spheres(centres.data(), radii.data(), static_cast<int>(centres.size()));
  expect_same_support(spheres);
  EXPECT_EQ(pd::to_convex_shape(spheres)->polytope(), nullptr);
  const btUniformScalingShape scaled(&spheres, btScalar(2.5));
  expect_same_support(scaled);
  spheres.setLocalScaling(btVector3(2, 2, 2));
  expect_same_support(spheres);
  spheres.setLocalScaling(btVector3(2, 2, 1));
  EXPECT_EQ(pd::to_convex_shape(spheres).error().code, pd::ErrorCode::unsupported);
}

TEST(ShapeConversion, WrappersFollowTheirChild) {
  btConvexHullShape hull = some_hull();
  btCylinderShape cylinder(btVector3(1, 2, 1));
  btConeShape cone(1, 2);
  btSphereShape sphere(btScalar(0.25));
  for (btConvexShape* child : std::initializer_list<btConvexShape*>{&hull, &cylinder, &cone, &sphere}) {
    btUniformScalingShape scaled(child, btScalar(2.5));
    expect_same_support(scaled);
  }
  btConvex2dShape flat(&hull);
  expect_same_support(flat);
  btBox2dShape box_2d(btVector3(1, 2, 0));
  const auto flat_box = pd::to_convex_shape(box_2d);
  ASSERT_TRUE(flat_box.has_value());
  // Bullet takes the margin off its zero thickness too; in its plane, where it is used, it is a box of these half
  // extents.
  EXPECT_NEAR(support_value(*flat_box, pd::Vec3::UnitX()), 1, 1e-6);
  EXPECT_NEAR(support_value(*flat_box, pd::Vec3::UnitY()), 2, 1e-6);
  EXPECT_EQ(flat_box->polytope()->affine_dimension(), 2);

  btMinkowskiSumShape sum(&hull, &sphere);
  sum.setTransformA(btTransform(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.7)), btVector3(1, 0, 2)));
  expect_same_support(sum);
  btBoxShape box(btVector3(1, 1, 1));
  btMinkowskiSumShape hull_and_box(&hull, &box);
  expect_same_support(hull_and_box);
}

TEST(ShapeConversion, RefusesWhatHasNoExactForm) {
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, 1};
  btMultiSphereShape stretched(centres, radii, 2);
  stretched.setLocalScaling(kScaling);
  EXPECT_EQ(pd::to_convex_shape(stretched).error().code, pd::ErrorCode::unsupported);

  btCylinderShape cylinder(btVector3(1, 1, 1));
  btBoxShape box(btVector3(1, 1, 1));
  btMinkowskiSumShape smooth(&box, &cylinder);
  EXPECT_EQ(pd::to_convex_shape(smooth).error().code, pd::ErrorCode::unsupported);

  const btConvexHullShape empty;
  EXPECT_EQ(pd::to_convex_shape(empty).error().code, pd::ErrorCode::too_few_points);
}

/// A margin that reaches a half extent leaves the extents as they are: that is where Bullet has such bodies rest.
TEST(ShapeConversion, LargeMarginsKeepTheExtents) {
  const auto half = [](double x, double y, double z) {
    return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  };
  btBoxShape box(half(0.05, 0.0025, 0.03));
  btBox2dShape flat(half(0.05, 0.0025, 0.03));
  btCylinderShape plate(half(0.05, 0.0025, 0.05)), rod(half(0.0025, 0.05, 0.0025));
  btCylinderShapeX x(half(0.0025, 0.05, 0.05));
  btCylinderShapeZ z(half(0.05, 0.05, 0.0025));
  for (btConvexInternalShape* shape :
       std::initializer_list<btConvexInternalShape*>{&box, &flat, &plate, &rod, &x, &z}) {
    for (const double margin : {0.0025, 0.04, 1.0}) {
      shape->setMargin(static_cast<btScalar>(margin));
      const auto body = pd::to_convex_shape(*shape);
      ASSERT_TRUE(body) << shape->getName() << ' ' << margin << ": " << body.error().message;
      for (int axis = 0; axis < 3; ++axis) {
        pd::Vec3 d = pd::Vec3::Zero();
        d[axis] = 1;
        btVector3 lower, upper;
        shape->getAabb(btTransform::getIdentity(), lower, upper);
        EXPECT_NEAR(support_value(*body, d), static_cast<double>(upper[axis]), 1e-6)
            << shape->getName() << ' ' << margin;
      }
    }
  }
}

TEST(ShapeConversion, FingerprintFollowsEveryChange) {
  btConvexHullShape hull = some_hull();
  std::vector<std::uint64_t> seen{pd::shape_fingerprint(hull)};
  const auto expect_new = [&] {
    const std::uint64_t now = pd::shape_fingerprint(hull);
    EXPECT_EQ(std::count(seen.begin(), seen.end(), now), 0);
    seen.push_back(now);
  };
  EXPECT_EQ(pd::shape_fingerprint(some_hull()), seen[0]);
  hull.setMargin(btScalar(0.1));
  expect_new();
  hull.setLocalScaling(kScaling);
  expect_new();
  hull.getUnscaledPoints()[3].setX(btScalar(0.123));
  expect_new();
  hull.addPoint(btVector3(4, 4, 4));
  expect_new();
}

}  // namespace
