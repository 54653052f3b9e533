#include "scenes/bullet/bullet_scene.hpp"

#include <BulletCollision/CollisionDispatch/btInternalEdgeUtility.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include <algorithm>
#include <cmath>

#include "pd/bullet/install.hpp"
#include "pd/bullet/scalar.hpp"

namespace pd::scenes {

namespace {

btScalar scalar(double x) { return static_cast<btScalar>(x); }

btTransform transform_of(const WorldBody& body) {
  const Eigen::Quaterniond& q = body.orientation;
  return btTransform(btQuaternion(scalar(q.x()), scalar(q.y()), scalar(q.z()), scalar(q.w())),
                     to_bullet(body.position));
}

/// Bullet's default, or a tenth of the body where that is less (what Bullet itself does for boxes and cylinders).
double default_margin(const WorldBody& body) {
  double least = 1e30;
  if (body.kind == WorldBody::Kind::hull) {
    for (const Vec3& point : body.points) {
      least = std::min(least, point.norm());
    }
  } else {
    least = body.half_extents.minCoeff();
  }
  return std::min(static_cast<double>(CONVEX_DISTANCE_MARGIN), 0.1 * least);
}

std::unique_ptr<btConvexShape> hull_of(const std::vector<Vec3>& points, double margin, const Vec3& shrink) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& point : points) {
    hull->addPoint(to_bullet(Vec3(point.cwiseProduct(shrink))), false);
  }
  hull->setMargin(scalar(margin));
  hull->recalcLocalAabb();
  return hull;
}

/// Bullet's own cure for inner edges. The callback is one for all worlds and asked for bodies with
/// CF_CUSTOM_MATERIAL_CALLBACK alone: those of `bullet_edges`.
bool adjust_edges(btManifoldPoint& point, const btCollisionObjectWrapper* a, int part_a, int index_a,
                  const btCollisionObjectWrapper* b, int part_b, int index_b) {
  if (b->getCollisionShape()->getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    btAdjustInternalEdgeContacts(point, b, a, part_b, index_b);
  } else if (a->getCollisionShape()->getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    btAdjustInternalEdgeContacts(point, a, b, part_a, index_a);
  }
  return true;
}

}  // namespace

std::string_view to_string(ContactRun run) {
  switch (run) {
    case ContactRun::bullet_best:
      return "bullet";
    case ContactRun::bullet_sharp:
      return "bullet-margin-0";
    case ContactRun::bullet_hulls:
      return "bullet-hulls";
    case ContactRun::bullet_edges:
      return "bullet-edges";
    case ContactRun::persistent:
      return "persistent";
    case ContactRun::pdepth:
      return "pdepth";
    case ContactRun::pdepth_hulls:
      return "pdepth-hulls";
    case ContactRun::pdepth_sharp:
      return "pdepth-margin-0";
  }
  return "";
}

std::unique_ptr<btConvexShape> convex_bullet_shape(const WorldBody& body, bool boxes_as_hulls, double margin) {
  std::unique_ptr<btConvexShape> shape;
  const Vec3& half = body.half_extents;
  switch (body.kind) {
    case WorldBody::Kind::box:
      if (boxes_as_hulls) {
        return hull_of(box_points(half), margin,
                       Vec3(1 - margin / half.x(), 1 - margin / half.y(), 1 - margin / half.z()));
      }
      shape = std::make_unique<btBoxShape>(to_bullet(half));
      break;
    case WorldBody::Kind::cylinder:
      shape = std::make_unique<btCylinderShapeZ>(to_bullet(half));
      break;
    case WorldBody::Kind::sphere:
      return std::make_unique<btSphereShape>(scalar(half.x()));
    case WorldBody::Kind::capsule:
      return std::make_unique<btCapsuleShapeZ>(scalar(half.x()), scalar(2 * half.z()));
    default: {
      double least = 1e30;
      for (const Vec3& point : body.points) {
        least = std::min(least, point.norm());
      }
      return hull_of(body.points, margin, Vec3::Constant(1 - margin / least));
    }
  }
  shape->setMargin(scalar(margin));
  return shape;
}

btCollisionShape* BulletScene::make_shape(const WorldBody& body, ContactRun run) {
  const bool hulls = run == ContactRun::bullet_hulls || run == ContactRun::pdepth_hulls;
  switch (body.kind) {
    case WorldBody::Kind::compound: {
      auto compound = std::make_unique<btCompoundShape>();
      for (const WorldBody& part : body.parts) {
        compound->addChildShape(transform_of(part), make_shape(part, run));
      }
      shapes_.push_back(std::move(compound));
      break;
    }
    case WorldBody::Kind::mesh: {
      auto mesh = std::make_unique<btTriangleMesh>();
      for (const auto& triangle : body.triangles) {
        mesh->addTriangle(to_bullet(body.points[triangle[0]]), to_bullet(body.points[triangle[1]]),
                          to_bullet(body.points[triangle[2]]));
      }
      auto shape = std::make_unique<btBvhTriangleMeshShape>(mesh.get(), true);
      if (run == ContactRun::bullet_edges) {
        edge_maps_.push_back(std::make_unique<btTriangleInfoMap>());
        btGenerateInternalEdgeInfo(shape.get(), edge_maps_.back().get());
      }
      shapes_.push_back(std::move(shape));
      meshes_.push_back(std::move(mesh));
      shapes_.back()->setMargin(0);
      break;
    }
    case WorldBody::Kind::heightfield: {
      auto heights = std::make_unique<std::vector<btScalar>>();
      double highest = 1;
      for (const Vec3& point : body.points) {
        heights->push_back(scalar(point.z()));
        highest = std::max(highest, std::abs(point.z()));
      }
      const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(body.points.size()))));
      const btScalar* data = heights->data();
      // The range is symmetric, so that Bullet's origin of the shape is ours.
      auto terrain =
          std::make_unique<btHeightfieldTerrainShape>(side, side, data, scalar(-highest), scalar(highest), 2, false);
      const double spacing = body.points[1].x() - body.points[0].x();
      terrain->setLocalScaling(btVector3(scalar(spacing), scalar(spacing), 1));
      terrain->setMargin(0);
      if (run == ContactRun::bullet_edges) {
        edge_maps_.push_back(std::make_unique<btTriangleInfoMap>());
        btGenerateInternalEdgeInfo(terrain.get(), edge_maps_.back().get());
      }
      shapes_.push_back(std::move(terrain));
      heights_.push_back(std::move(heights));
      break;
    }
    default: {
      const bool box = body.kind == WorldBody::Kind::box;
      const bool sharp = run == ContactRun::bullet_sharp || run == ContactRun::persistent ||
                         run == ContactRun::pdepth_hulls || run == ContactRun::pdepth_sharp ||
                         (run == ContactRun::pdepth && !box);
      shapes_.push_back(convex_bullet_shape(body, hulls, sharp ? 0 : default_margin(body)));
      break;
    }
  }
  return shapes_.back().get();
}

void BulletScene::add_body(const WorldBody& plan, ContactRun run) {
  btCollisionShape* shape = make_shape(plan, run);
  btVector3 inertia(0, 0, 0);
  if (plan.mass > 0) {
    shape->calculateLocalInertia(scalar(plan.mass), inertia);
  }
  btRigidBody::btRigidBodyConstructionInfo info(scalar(plan.mass), nullptr, shape, inertia);
  info.m_startWorldTransform = transform_of(plan);
  info.m_friction = scalar(plan.friction.value_or(plan_.friction));
  info.m_restitution = scalar(plan_.restitution);
  bodies_.push_back(std::make_unique<btRigidBody>(info));
  btRigidBody& body = *bodies_.back();
  body.setLinearVelocity(to_bullet(plan.linear_velocity));
  body.setAngularVelocity(to_bullet(plan.angular_velocity));
  body.setActivationState(DISABLE_DEACTIVATION);
  if (run == ContactRun::bullet_edges && shape->isConcave()) {
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    gContactAddedCallback = adjust_edges;
  }
  world_->addRigidBody(&body);
}

BulletScene::BulletScene(const World& world, ContactRun run, const BulletSolverSettings& settings)
    : plan_(world),
      solver_(settings),
      dispatcher_(&configuration_),
      constraint_solver_(world.solved_at_once ? std::make_unique<StackSolver>()
                                              : std::make_unique<btSequentialImpulseConstraintSolver>()),
      world_(std::make_unique<btDiscreteDynamicsWorld>(&dispatcher_, &broadphase_, constraint_solver_.get(),
                                                       &configuration_)) {
  if (is_ours(run)) {
    install(*world_, solver_, run == ContactRun::persistent ? BulletContacts::persistent : BulletContacts::one_shot);
  }
  world_->setGravity(to_bullet(world.gravity));
  for (const WorldBody& plan : world.bodies) {
    add_body(plan, run);
  }
  for (const WorldJoint& joint : world.joints) {
    btRigidBody& a = *bodies_[joint.body_a];
    btRigidBody& b = *bodies_[joint.body_b];
    const btVector3 at = to_bullet(joint.at);
    joints_.push_back(std::make_unique<btPoint2PointConstraint>(a, b, a.getWorldTransform().invXform(at),
                                                                b.getWorldTransform().invXform(at)));
    world_->addConstraint(joints_.back().get(), true);
  }
}

BulletScene::~BulletScene() {
  for (auto& joint : joints_) {
    world_->removeConstraint(joint.get());
  }
  for (auto& body : bodies_) {
    world_->removeRigidBody(body.get());
  }
}

void BulletScene::step(double steps_per_second) { world_->stepSimulation(scalar(1 / steps_per_second), 0); }

int BulletScene::first_moving() const {
  const auto found = std::find_if(plan_.bodies.begin(), plan_.bodies.end(), [](const auto& b) { return b.mass > 0; });
  return static_cast<int>(found - plan_.bodies.begin());
}

MechanicalEnergy mechanical_energy(BulletScene& scene) {
  MechanicalEnergy energy;
  for (int i = 0; i < scene.num_bodies(); ++i) {
    const btRigidBody& body = scene.body(i);
    const double mass = scene.plan(i).mass;
    if (mass == 0) {
      continue;
    }
    const Vec3 inverse_inertia = to_pd(body.getInvInertiaDiagLocal());
    const Vec3 turning = to_pd(body.getWorldTransform().getBasis()).transpose() * to_pd(body.getAngularVelocity());
    energy.potential -= mass * scene.plan().gravity.dot(to_pd(body.getWorldTransform().getOrigin()));
    energy.kinetic += 0.5 * mass * to_pd(body.getLinearVelocity()).squaredNorm();
    for (int k = 0; k < 3; ++k) {
      energy.kinetic += inverse_inertia[k] > 0 ? 0.5 * turning[k] * turning[k] / inverse_inertia[k] : 0;
    }
  }
  return energy;
}

}  // namespace pd::scenes
