#include "record/recorded_world.hpp"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btBox2dBox2dCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvex2dConvex2dAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btSphereTriangleCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pair/contact_algorithm.hpp"
#include "pair/dispatcher_owners.hpp"
#include "pd/bullet/scalar.hpp"
#include "shapes/triangles_in_box.hpp"

namespace pd::detail {

namespace {

using Owners = DispatcherOwners<RecordedWorld>;

std::string engine_name() {
  return "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." + std::to_string(BT_BULLET_VERSION % 100 / 10) +
         std::to_string(BT_BULLET_VERSION % 10);
}

pd_record_pose to_record(const btTransform& transform) {
  pd_record_pose pose{};
  pose.rotation = PD_RECORD_MATRIX;
  const Vec3 origin = to_pd(transform.getOrigin());
  std::copy(origin.data(), origin.data() + 3, pose.translation);
  for (int i = 0; i < 9; ++i) pose.matrix_row_major[i] = static_cast<double>(transform.getBasis()[i / 3][i % 3]);
  return pose;
}

/// Whether the shape is one of a kind, or has parts of which contact points tell.
bool has_parts(const btCollisionShape& shape) {
  return shape.isCompound() || (shape.isConcave() && shape.getShapeType() != STATIC_PLANE_PROXYTYPE);
}

/// The child of a compound that a contact point names; the shape itself where it has none.
const btCollisionShape* leaf_of(const btCollisionObject& object, int index) {
  const btCollisionShape* shape = object.getCollisionShape();
  if (!shape->isCompound()) return shape;
  const auto& compound = static_cast<const btCompoundShape&>(*shape);
  return index >= 0 && index < compound.getNumChildShapes() ? compound.getChildShape(index) : nullptr;
}

bool is_mesh(const btCollisionShape& shape) { return shape.isConcave() && has_parts(shape); }

/// Asks `ask` about the dispatcher's algorithm for two shapes. A triangle stands for a mesh.
template <class Ask>
bool algorithm_is(btCollisionDispatcher& dispatcher, const btCollisionObject& a, const btCollisionShape& shape_a,
                  const btCollisionObject& b, const btCollisionShape& shape_b, Ask&& ask) {
  const btTriangleShape triangle(btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(0, 1, 0));
  const auto asked = [&](const btCollisionShape& shape) -> const btCollisionShape* {
    if (is_mesh(shape)) return &triangle;
    return &shape;
  };
  const btCollisionObjectWrapper wrapper_a(nullptr, asked(shape_a), &a, a.getWorldTransform(), -1, -1);
  const btCollisionObjectWrapper wrapper_b(nullptr, asked(shape_b), &b, b.getWorldTransform(), -1, -1);
  btCollisionAlgorithm* algorithm =
      dispatcher.findAlgorithm(&wrapper_a, &wrapper_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  if (algorithm == nullptr) return false;
  const bool found = ask(*algorithm);
  algorithm->~btCollisionAlgorithm();
  dispatcher.freeCollisionAlgorithm(algorithm);
  return found;
}

/// Bullet's algorithms for shapes of the plane, if a host registers them: what they answer is no depth in space.
bool answers_in_the_plane(const btCollisionAlgorithm& algorithm) {
  return dynamic_cast<const btBox2dBox2dCollisionAlgorithm*>(&algorithm) != nullptr ||
         dynamic_cast<const btConvex2dConvex2dAlgorithm*>(&algorithm) != nullptr;
}

bool is_box(const btCollisionShape& shape) { return shape.getShapeType() == BOX_SHAPE_PROXYTYPE; }

/// A ball meets triangles without their margin where Bullet's own algorithm for these answers.
bool meets_bare_triangles(btCollisionDispatcher& dispatcher, const btCollisionObject& a, const btCollisionShape& leaf_a,
                          const btCollisionObject& b, const btCollisionShape& leaf_b) {
  const auto ball_on_mesh = [](const btCollisionShape& ball, const btCollisionShape& mesh) {
    return ball.getShapeType() == SPHERE_SHAPE_PROXYTYPE && is_mesh(mesh);
  };
  if (!ball_on_mesh(leaf_a, leaf_b) && !ball_on_mesh(leaf_b, leaf_a)) return false;
  return algorithm_is(dispatcher, a, leaf_a, b, leaf_b, [](const btCollisionAlgorithm& algorithm) {
    return dynamic_cast<const btSphereTriangleCollisionAlgorithm*>(&algorithm) != nullptr;
  });
}

/// Which boxes are taken without their margin: against planes (where Bullet asks a shape for its own support), by
/// Bullet's and our algorithm for two boxes, and as children of compounds by ours.
struct SharpBoxes {
  bool a = false;
  bool b = false;
};
SharpBoxes sharp_boxes(btCollisionDispatcher& dispatcher, const btCollisionObject& a, const btCollisionShape& leaf_a,
                       const btCollisionObject& b, const btCollisionShape& leaf_b) {
  const auto is_plane = [](const btCollisionShape& shape) { return shape.getShapeType() == STATIC_PLANE_PROXYTYPE; };
  if (is_plane(leaf_a) || is_plane(leaf_b)) return {true, true};
  if (!is_box(leaf_a) && !is_box(leaf_b)) return {};
  if (is_box(leaf_a) && is_box(leaf_b)) {
    const bool rounded = algorithm_is(dispatcher, a, leaf_a, b, leaf_b, [](const btCollisionAlgorithm& algorithm) {
      return dynamic_cast<const btConvexConvexAlgorithm*>(&algorithm) != nullptr;
    });
    return {!rounded, !rounded};
  }
  if (!a.getCollisionShape()->isCompound() && !b.getCollisionShape()->isCompound()) return {};
  const bool parts = algorithm_is(dispatcher, a, leaf_a, b, leaf_b, [](const btCollisionAlgorithm& algorithm) {
    const auto* own = dynamic_cast<const ContactAlgorithm*>(&algorithm);
    return own != nullptr && own->sharp_parts();
  });
  return {parts && is_box(leaf_a) && a.getCollisionShape()->isCompound(),
          parts && is_box(leaf_b) && b.getCollisionShape()->isCompound()};
}

}  // namespace

/// Contact points of two bodies, or of one part of each.
struct RecordedWorld::Group {
  const btCollisionObject* a;
  const btCollisionObject* b;
  int part_a, index_a, part_b, index_b;  ///< -1 where a body has no parts
  std::vector<const btManifoldPoint*> points;

  [[nodiscard]] bool same(const Group& other) const {
    return a == other.a && part_a == other.part_a && index_a == other.index_a && part_b == other.part_b &&
           index_b == other.index_b;
  }
};

RecordedWorld::RecordedWorld(btCollisionWorld& world, const char* path, int every)
    : world_(world), dispatcher_(dynamic_cast<btCollisionDispatcher*>(world.getDispatcher())), every_(every) {
  if (dispatcher_ == nullptr || every < 1) return;
  if (!Owners::instance().add(dispatcher_, this)) return;
  if (pd_record_open(&record_, path, engine_name().c_str(),
                     sizeof(btScalar) == sizeof(float) ? PD_RECORD_FLOAT32 : PD_RECORD_FLOAT64, nullptr) == 0) {
    Owners::instance().remove(dispatcher_);
    return;
  }
  good_ = true;
  open_ = true;
  before_ = dispatcher_->getNearCallback();
  dispatcher_->setNearCallback(&RecordedWorld::near_callback);
  if (auto* dynamics = dynamic_cast<btDynamicsWorld*>(&world_)) {
    record_.has_time = 1;
    dynamics->addAction(this);
  }
}

RecordedWorld::~RecordedWorld() { close(); }

bool RecordedWorld::close() {
  if (!open_) return good_;
  open_ = false;
  if (dispatcher_->getNearCallback() == &RecordedWorld::near_callback) dispatcher_->setNearCallback(before_);
  if (auto* dynamics = dynamic_cast<btDynamicsWorld*>(&world_)) dynamics->removeAction(this);
  Owners::instance().remove(dispatcher_);
  good_ = pd_record_close(&record_) != 0;
  return good_;
}

void RecordedWorld::updateAction(btCollisionWorld*, btScalar step) {
  ++step_;
  record_.time += static_cast<double>(step);
}

void RecordedWorld::near_callback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                                  const btDispatcherInfo& info) {
  RecordedWorld* world = Owners::instance().find(dispatcher);
  if (world == nullptr) {  // another callback still calls this one
    btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    return;
  }
  world->before_(pair, dispatcher, info);
  if (world->step_ % world->every_ == 0) {
    const std::scoped_lock lock(world->mutex_);
    world->write_pair(pair);
  }
}

std::vector<RecordedWorld::Group> RecordedWorld::groups_of(const btBroadphasePair& pair, const btCollisionObject*& a,
                                                           const btCollisionObject*& b) const {
  btManifoldArray manifolds;
  pair.m_algorithm->getAllContactManifolds(manifolds);
  std::vector<Group> groups;
  for (int m = 0; m < manifolds.size(); ++m) {
    const btPersistentManifold& manifold = *manifolds[m];
    a = manifold.getBody0();
    b = manifold.getBody1();
    const bool parts_of_a = has_parts(*a->getCollisionShape());
    const bool parts_of_b = has_parts(*b->getCollisionShape());
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      Group group{a,
                  b,
                  parts_of_a ? point.m_partId0 : -1,
                  parts_of_a ? point.m_index0 : -1,
                  parts_of_b ? point.m_partId1 : -1,
                  parts_of_b ? point.m_index1 : -1,
                  {}};
      auto place = std::find_if(groups.begin(), groups.end(), [&](const Group& known) { return known.same(group); });
      if (place == groups.end()) place = groups.insert(groups.end(), std::move(group));
      place->points.push_back(&point);
    }
  }
  return groups;
}

void RecordedWorld::write_pair(btBroadphasePair& pair) {
  const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  if (pair.m_algorithm == nullptr || !dispatcher_->needsCollision(a, b)) return;
  const auto unknown = [](const btCollisionObject& object) {
    const int type = object.getCollisionShape()->getShapeType();
    return type == GIMPACT_SHAPE_PROXYTYPE || btBroadphaseProxy::isSoftBody(type);
  };
  if (unknown(*a) || unknown(*b) || answers_in_the_plane(*pair.m_algorithm)) {
    ++unsupported_;
    return;
  }
  const std::vector<Group> groups = groups_of(pair, a, b);
  for (const Group& group : groups) write_group(*group.a, *group.b, group);
  if (groups.empty() && !has_parts(*a->getCollisionShape()) && !has_parts(*b->getCollisionShape())) {
    write_group(*a, *b, Group{a, b, -1, -1, -1, -1, {}});
  }
}

RecordedPart RecordedWorld::triangle_of(const btCollisionObject& object, int part, int index, bool without_margin,
                                        const btVector3& at) {
  const auto& mesh = static_cast<const btConcaveShape&>(*object.getCollisionShape());
  const btTransform& pose = object.getWorldTransform();
  // The point lies on the triangle, swept by the margin, up to what a contact point drifts while it is kept.
  const btVector3 local = pose.invXform(at);
  for (btScalar reach = mesh.getMargin() + btScalar(0.05); reach < btScalar(1e3); reach *= btScalar(8)) {
    const btVector3 around(reach, reach, reach);
    for (const BoxedTriangle& triangle : triangles_in_box(mesh, local - around, local + around)) {
      if (triangle.part != part || triangle.index != index) continue;
      const auto bare = without_margin ? Expected<ConvexShape>(ConvexShape(*triangle.shape->polytope()))
                                       : Expected<ConvexShape>(*triangle.shape);
      return {shapes_.triangle(record_, *bare), pose};
    }
  }
  return {std::nullopt, pose};
}

RecordedPart RecordedWorld::part_of(const btCollisionObject& object, int part, int index, bool sharp,
                                    bool without_margin, const btVector3* at) {
  const btTransform& pose = object.getWorldTransform();
  const btCollisionShape& shape = *object.getCollisionShape();
  if (is_mesh(shape)) return at ? triangle_of(object, part, index, without_margin, *at) : RecordedPart{{}, pose};
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
    return {shapes_.plane(record_, static_cast<const btStaticPlaneShape&>(shape)), pose};
  }
  const btCollisionShape* leaf = leaf_of(object, index);
  if (leaf == nullptr || !leaf->isConvex()) return {std::nullopt, pose};
  const btTransform stands =
      shape.isCompound() ? pose * static_cast<const btCompoundShape&>(shape).getChildTransform(index) : pose;
  const auto& convex = static_cast<const btConvexShape&>(*leaf);
  return {sharp ? shapes_.sharp(record_, convex) : shapes_.convex(record_, convex), stands};
}

void RecordedWorld::write_group(const btCollisionObject& a, const btCollisionObject& b, const Group& group) {
  const btCollisionShape* leaf_a = leaf_of(a, group.index_a);
  const btCollisionShape* leaf_b = leaf_of(b, group.index_b);
  if (leaf_a == nullptr || leaf_b == nullptr) {
    ++unsupported_;
    return;
  }
  const SharpBoxes sharp = sharp_boxes(*dispatcher_, a, *leaf_a, b, *leaf_b);
  const bool without_margin = meets_bare_triangles(*dispatcher_, a, *leaf_a, b, *leaf_b);
  // The points' numbers stay where `report` points to.
  std::vector<std::array<Vec3, 2>> positions;
  std::vector<pd_record_point> points;
  const btManifoldPoint* deepest = nullptr;
  for (const btManifoldPoint* point : group.points) {
    positions.push_back({to_pd(point->getPositionWorldOnA()), to_pd(point->getPositionWorldOnB())});
    if (deepest == nullptr || point->getDistance() < deepest->getDistance()) deepest = point;
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    points.push_back(
        {positions[i][0].data(), positions[i][1].data(), -static_cast<double>(group.points[i]->getDistance())});
  }
  const RecordedPart side_a = part_of(a, group.part_a, group.index_a, sharp.a, without_margin,
                                      deepest ? &deepest->getPositionWorldOnA() : nullptr);
  const RecordedPart side_b = part_of(b, group.part_b, group.index_b, sharp.b, without_margin,
                                      deepest ? &deepest->getPositionWorldOnB() : nullptr);
  if (!side_a.shape || !side_b.shape) {
    ++unsupported_;
    return;
  }
  const pd_record_pose pose_a = to_record(side_a.pose);
  const pd_record_pose pose_b = to_record(side_b.pose);
  pd_record_report report{};
  Vec3 normal = Vec3::Zero();
  if (deepest != nullptr) {
    normal = to_pd(deepest->m_normalWorldOnB);
    report = {-static_cast<double>(deepest->getDistance()), normal.isZero(0) ? nullptr : normal.data(), points.data(),
              points.size()};
  }
  pd_record_contact(&record_, side_a.shape->c_str(), &pose_a, side_b.shape->c_str(), &pose_b,
                    deepest != nullptr ? &report : nullptr);
}

}  // namespace pd::detail
