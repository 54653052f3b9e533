#include "pd/bullet/world_queries.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/scratch.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/moving_body.hpp"
#include "shapes/triangles_in_box.hpp"

namespace pd {

namespace {

using Body = std::shared_ptr<const detail::CachedShape>;
using Box = detail::ChildBox;

Expected<Body> convert(const btConvexShape& shape, BulletShapeCache* cache) {
  Body body = cache != nullptr ? cache->find(shape, 0) : detail::converted(shape);
  if (!body->body) return body->refusal;
  return body;
}

/// A convex piece of an object.
struct Piece {
  Body body;
  btTransform pose;
  int part;
  int index;
};

/// Around the shape on its way, and as far as it reaches from there.
struct Region {
  Box way;
  Box reached;
  double diameter;  ///< of the shape, or more
};

/// The pieces of an object that a region of the world meets. @return false where one has no exact body.
class Pieces {
 public:
  Pieces(const Region& region, BulletShapeCache* cache) : region_(region), cache_(cache) {}

  bool add(const btCollisionShape& shape, const btTransform& pose, int part, int index, bool outermost) {
    const Box box = detail::box_of(shape, pose);
    if (detail::apart(box, region_.reached, 0)) return true;
    if (shape.isCompound()) {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      bool all = true;
      for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        all = add(*compound.getChildShape(i), pose * compound.getChildTransform(i), -1, outermost ? i : index, false) &&
              all;
      }
      return all;
    }
    if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
      add_plane(static_cast<const btStaticPlaneShape&>(shape), pose);
      return true;
    }
    if (shape.isConcave()) {
      add_triangles(static_cast<const btConcaveShape&>(shape), pose, box);
      return true;
    }
    if (!shape.isConvex()) return false;
    auto body = convert(static_cast<const btConvexShape&>(shape), cache_);
    if (!body) return false;
    pieces.push_back({std::move(body).value(), pose, part, index});
    return true;
  }

  std::vector<Piece> pieces;

 private:
  /// @param own  the shape's box in the world. A region may be so wide that its middle loses the shape.
  void add_triangles(const btConcaveShape& shape, const btTransform& pose, const Box& own) {
    btVector3 lower = region_.reached.lower, upper = region_.reached.upper;
    lower.setMax(own.lower);
    upper.setMin(own.upper);
    // The box of the box in the shape's frame, wider by what these sums are rounded by.
    const btScalar rounded = 8 * SIMD_EPSILON * std::max({lower.length(), upper.length(), pose.getOrigin().length()});
    const btVector3 middle = pose.invXform(btScalar(0.5) * (lower + upper));
    const btMatrix3x3 turn = pose.getBasis().transpose().absolute();
    const btVector3 half = turn * (btScalar(0.5) * (upper - lower)) + btVector3(rounded, rounded, rounded);
    for (detail::BoxedTriangle& triangle : detail::triangles_in_box(shape, middle - half, middle + half)) {
      auto body = std::make_shared<detail::CachedShape>();
      body->body = std::move(triangle.shape);
      pieces.push_back({std::move(body), pose, triangle.part, triangle.index});
    }
  }

  /// The part of a plane below the way, as one triangle of doubles. Bullet's triangles of floats lie off the plane by a
  /// share of the box's size.
  void add_plane(const btStaticPlaneShape& plane, const btTransform& pose) {
    const Vec3 lower = to_pd(region_.way.lower), upper = to_pd(region_.way.upper);
    const Pose placed = to_pd(pose);
    const Vec3 middle = placed.rotation().transpose() * (0.5 * (lower + upper) - placed.translation());
    const Vec3 normal = to_pd(plane.getPlaneNormal()).normalized();
    const Vec3 foot = middle - (normal.dot(middle) - static_cast<double>(plane.getPlaneConstant())) * normal;
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    const Vec3 half = 0.5 * (upper - lower);
    const auto width = [&](const Vec3& axis) { return (placed.rotation() * axis).cwiseAbs().dot(half); };
    // No way past an edge is as short as the way out along the normal.
    const double radius = 4 * (width(u) + width(v) + region_.diameter);
    const double height = std::sqrt(3.0);
    const std::array corners{Vec3(foot - radius * u - height * radius * v),
                             Vec3(foot - radius * u + height * radius * v), Vec3(foot + 2 * radius * u)};
    auto triangle = ConvexPolytope::from_points(corners);
    if (!triangle) return;
    auto body = std::make_shared<detail::CachedShape>();
    body->body = std::make_shared<const ConvexShape>(std::move(triangle).value());
    pieces.push_back({std::move(body), pose, 0, 0});
  }

  const Region& region_;
  BulletShapeCache* cache_;
};

/// Every object whose box in the broadphase meets a box.
class Neighbours : public btBroadphaseAabbCallback {
 public:
  explicit Neighbours(const std::function<void(btBroadphaseProxy&)>& visit) : visit_(visit) {}
  bool process(const btBroadphaseProxy* proxy) override {
    visit_(*const_cast<btBroadphaseProxy*>(proxy));
    return true;
  }

 private:
  const std::function<void(btBroadphaseProxy&)>& visit_;
};

void fill(WorldHit& hit, const btCollisionObject& object, const Piece& piece, const PenetrationDepth& answer) {
  hit.object = &object;
  hit.part = piece.part;
  hit.index = piece.index;
  hit.point_on_shape = answer.witness_a;
  hit.point_on_object = answer.witness_b;
  hit.normal = answer.normal;
  hit.distance = answer.signed_distance();
}

bool passes(const btBroadphaseProxy& proxy, const WorldQuerySettings& settings) {
  return (proxy.m_collisionFilterGroup & settings.filter_mask) != 0 &&
         (settings.filter_group & proxy.m_collisionFilterMask) != 0;
}

/// The box wider by a margin, which may be infinite; boxes of floats are rounded.
Box widened(Box box, double margin) {
  constexpr btScalar kMost = std::numeric_limits<btScalar>::max();
  const auto grown = static_cast<btScalar>(std::min(margin * 1.001, static_cast<double>(kMost)));
  box.lower -= btVector3(grown, grown, grown);
  box.upper += btVector3(grown, grown, grown);
  return box;
}

/// A box around the shape at both ends of its way, wider by `margin`.
Box box_around(const btConvexShape& shape, const btTransform& from, const btTransform& to, double margin) {
  Box box = detail::box_of(shape, from);
  const Box end = detail::box_of(shape, to);
  box.lower.setMin(end.lower);
  box.upper.setMax(end.upper);
  return widened(box, margin);
}

double diameter(const btConvexShape& shape, const btTransform& pose) {
  const Box box = detail::box_of(shape, pose);
  return to_pd(box.upper - box.lower).norm();
}

/// Why a question has no answer, if it has none.
std::optional<Error> refusal(const btTransform& from, const btTransform& to, const WorldQuerySettings& settings) {
  if (!is_finite(from)) return Error{ErrorCode::non_finite, "must be finite", "from"};
  if (!is_finite(to)) return Error{ErrorCode::non_finite, "must be finite", "to"};
  if (!(settings.tolerance > 0 && std::isfinite(settings.tolerance))) {
    return Error{ErrorCode::bad_value, "must be > 0 and finite", "settings.tolerance"};
  }
  return std::nullopt;
}

/// A shape on its way through the world.
class Cast {
 public:
  Cast(const Body& body, const btTransform& from, const btTransform& to, double tolerance)
      : body_(body), from_(to_pd(from)), motion_(detail::motion_between(from, to, 1)) {
    settings_.distance_tolerance = tolerance;
    settings_.contact_at_end = false;
    settings_.depth.bracket = Bracket::certified;
  }

  /// How far a point leaves the chord between its ends at most: a turning one by r (1 - cos(turn / 2)).
  [[nodiscard]] double bulge() const {
    const double radius = bounding_radius(body_->sharp ? *body_->sharp : *body_->body);
    return radius * (1 - std::cos(0.5 * motion_.angular_velocity.norm()));
  }

  /// The first hit of one object before `limit`, if there is one.
  std::optional<SweepHit> first_hit(const btCollisionObject& object, const std::vector<Piece>& pieces, double limit) {
    std::optional<SweepHit> best;
    for (const Piece& piece : pieces) {
      const TimeOfImpact found = time_of_impact({{&body_->beside(*piece.body), from_}, motion_},
                                                {{&piece.body->beside(*body_), to_pd(piece.pose)}, {}},
                                                best ? best->fraction : limit, scratch_, settings_);
      if (!found.hit || !(found.time < (best ? best->fraction : limit))) continue;
      best.emplace();
      fill(*best, object, piece, found.contact);
      best->fraction = found.time;
    }
    return best;
  }

 private:
  const Body& body_;
  Pose from_;
  RigidMotion motion_;
  TimeOfImpactSettings settings_;
  Scratch scratch_;
};

/// A question to a whole world.
struct Sweep {
  btCollisionWorld& world;
  const btConvexShape& shape;
  const btTransform& from;
  const btTransform& to;
  const WorldQuerySettings& settings;
};

/// @param needs    bool(btBroadphaseProxy&): who is asked.
/// @param limit    double(): hits from here on are of no interest.
/// @param answer   void(const SweepHit&).
template <class Needs, class Limit, class Answer>
Expected<int> ask(const Sweep& sweep, const Needs& needs, const Limit& limit, const Answer& answer) {
  if (const auto refused = refusal(sweep.from, sweep.to, sweep.settings)) return *refused;
  const Expected<Body> body = convert(sweep.shape, sweep.settings.cache);
  if (!body) return body.error();
  Cast cast(*body, sweep.from, sweep.to, sweep.settings.tolerance);
  const Box box = box_around(sweep.shape, sweep.from, sweep.to, cast.bulge() + sweep.settings.tolerance);
  const Region region{box, box, diameter(sweep.shape, sweep.from)};
  int unanswered = 0;
  const std::function<void(btBroadphaseProxy&)> visit = [&](btBroadphaseProxy& proxy) {
    const auto& object = *static_cast<const btCollisionObject*>(proxy.m_clientObject);
    if (!needs(proxy)) return;
    Pieces found(region, sweep.settings.cache);
    if (!found.add(*object.getCollisionShape(), object.getWorldTransform(), -1, -1, true)) ++unanswered;
    const auto hit = cast.first_hit(object, found.pieces, std::min(1.0, limit()));
    if (hit) answer(*hit);
  };
  Neighbours neighbours(visit);
  sweep.world.getBroadphase()->aabbTest(box.lower, box.upper, neighbours);
  return unanswered;
}

}  // namespace

Expected<SweepResult> sweep_test(btCollisionWorld& world, const btConvexShape& shape, const btTransform& from,
                                 const btTransform& to, const WorldQuerySettings& settings) {
  SweepResult result;
  const auto unanswered = ask(
      {world, shape, from, to, settings}, [&](const btBroadphaseProxy& proxy) { return passes(proxy, settings); },
      // A hit at the very end counts, and of two at the same time the one that is found first.
      [&] { return result.hit ? result.hit->fraction : 1.0; }, [&](const SweepHit& hit) { result.hit = hit; });
  if (!unanswered) return unanswered.error();
  result.unanswered = *unanswered;
  return result;
}

Expected<int> sweep_test(btCollisionWorld& world, const btConvexShape& shape, const btTransform& from,
                         const btTransform& to, btCollisionWorld::ConvexResultCallback& callback,
                         const WorldQuerySettings& settings) {
  return ask(
      {world, shape, from, to, settings}, [&](btBroadphaseProxy& proxy) { return callback.needsCollision(&proxy); },
      [&] { return static_cast<double>(callback.m_closestHitFraction); },
      [&](const SweepHit& hit) {
        btCollisionWorld::LocalShapeInfo info{hit.part, hit.index};
        btCollisionWorld::LocalConvexResult local(hit.object, hit.index >= 0 ? &info : nullptr, to_bullet(hit.normal),
                                                  to_bullet(hit.point_on_object), static_cast<btScalar>(hit.fraction));
        callback.addSingleResult(local, true);
      });
}

Expected<DistanceResult> distance_test(btCollisionWorld& world, const btConvexShape& shape, const btTransform& pose,
                                       double reach, const WorldQuerySettings& settings) {
  if (auto refused = refusal(pose, pose, settings)) {
    if (refused->where == "from") refused->where = "pose";
    return *refused;
  }
  if (!(reach >= 0)) return Error{ErrorCode::bad_value, "must be >= 0", "reach"};
  const Expected<Body> body = convert(shape, settings.cache);
  if (!body) return body.error();
  const Box way = box_around(shape, pose, pose, settings.tolerance);
  const Region region{way, widened(way, reach), diameter(shape, pose)};
  DistanceResult result;
  Scratch scratch;
  double least = reach;
  const std::function<void(btBroadphaseProxy&)> visit = [&](btBroadphaseProxy& proxy) {
    const auto& object = *static_cast<const btCollisionObject*>(proxy.m_clientObject);
    if (!passes(proxy, settings)) return;
    Pieces found(region, settings.cache);
    if (!found.add(*object.getCollisionShape(), object.getWorldTransform(), -1, -1, true)) ++result.unanswered;
    for (const Piece& piece : found.pieces) {
      const PenetrationDepth answer = penetration_depth({&(*body)->beside(*piece.body), to_pd(pose)},
                                                        {&piece.body->beside(**body), to_pd(piece.pose)}, scratch);
      WorldHit hit;
      fill(hit, object, piece, answer);
      if (hit.distance > least || (result.nearest && hit.distance == least)) continue;
      least = hit.distance;
      result.nearest = hit;
    }
  };
  Neighbours neighbours(visit);
  world.getBroadphase()->aabbTest(region.reached.lower, region.reached.upper, neighbours);
  return result;
}

}  // namespace pd
