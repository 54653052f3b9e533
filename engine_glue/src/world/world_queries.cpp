#include "pd/bullet/world_queries.hpp"

#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/scratch.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/moving_body.hpp"
#include "world/pieces_in_region.hpp"

namespace pd {

namespace {

using Box = detail::ChildBox;
using detail::kRounded;
using detail::Pieces;
using detail::Region;
using detail::RegionCandidate;
using detail::RegionPiece;
using Body = std::shared_ptr<const detail::CachedShape>;

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

void fill(WorldHit& hit, const btCollisionObject& object, const RegionPiece& piece, const PenetrationDepth& answer) {
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

bool holds(const Box& box, const btBroadphaseProxy& proxy) {
  for (int k = 0; k < 3; ++k) {
    if (!(box.lower[k] <= proxy.m_aabbMin[k] && proxy.m_aabbMax[k] <= box.upper[k])) return false;
  }
  return true;
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

/// A question to a whole world.
struct Sweep {
  btCollisionWorld& world;
  const btConvexShape& shape;
  const btTransform& from;
  const btTransform& to;
  const WorldQuerySettings& settings;
};

/// A shape on its way through the world. Times are shares of the way.
class Cast {
 public:
  Cast(const Sweep& sweep, Body body)
      : sweep_(sweep),
        body_(std::move(body)),
        start_(to_pd(sweep.from)),
        motion_(detail::motion_between(sweep.from, sweep.to, 1)) {
    settings_.distance_tolerance = sweep.settings.tolerance;
    settings_.contact_at_end = false;
    settings_.depth.bracket = Bracket::certified;
    length_ = motion_.linear_velocity.norm();
    diameter_ = diameter(sweep.shape, sweep.from);
    rounded_ = kRounded * (start_.translation().norm() + to_pd(sweep.to.getOrigin()).norm() + diameter_);
    // How far a point leaves the chord between its ends at most: a turning one by r (1 - cos(turn / 2)).
    const double radius = bounding_radius(body_->sharp ? *body_->sharp : *body_->body);
    margin_ = radius * (1 - std::cos(0.5 * motion_.angular_velocity.norm())) + sweep.settings.tolerance;
  }

  /// Around the shape between two times.
  [[nodiscard]] Region region(double since, double until) const {
    double margin = margin_;
    if (since > 0 || until < 1) margin += rounded_;
    const Box box = box_around(sweep_.shape, at(since), at(until), margin);
    return {box, box, diameter_};
  }

  /// The part of the way in which the triangles of a mesh are looked for at once: as long as the shape, as a small
  /// share of the mesh, or as what places on the way are rounded by.
  [[nodiscard]] double stretch(const Box& mesh) const {
    constexpr double kStretches = 256;
    return std::max({diameter_, rounded_, to_pd(mesh.upper - mesh.lower).norm() / kStretches}) / length_;
  }

  /// Asks about one piece, which counts if it is hit before `limit`.
  std::optional<SweepHit> hit(const btCollisionObject& object, const RegionPiece& piece, double limit) {
    const TimeOfImpact found =
        time_of_impact({{&body_->beside(*piece.body), start_}, motion_},
                       {{&piece.body->beside(*body_), to_pd(piece.pose)}, {}}, limit, scratch_, settings_);
    if (!found.hit || !(found.time < limit)) return std::nullopt;
    SweepHit result;
    fill(result, object, piece, found.contact);
    result.fraction = found.time;
    return result;
  }

  [[nodiscard]] BulletShapeCache* cache() const { return sweep_.settings.cache; }

 private:
  [[nodiscard]] btTransform at(double time) const {
    if (time <= 0) return sweep_.from;
    if (time >= 1) return sweep_.to;
    const Pose pose = pose_at({{nullptr, start_}, motion_}, time);
    btTransform transform;
    for (int i = 0; i < 3; ++i) transform.getBasis()[i] = to_bullet(pose.rotation().row(i).transpose());
    transform.setOrigin(to_bullet(pose.translation()));
    return transform;
  }

  const Sweep& sweep_;
  Body body_;
  Pose start_;
  RigidMotion motion_;
  TimeOfImpactSettings settings_;
  Scratch scratch_;
  double length_ = 0;
  double diameter_ = 0;
  double margin_ = 0;
  double rounded_ = 0;  ///< places between the ends are rounded by less
};

/// The first hit of one object before a limit. Along a mesh the way is cut into stretches, the first ones first.
class FirstHit {
 public:
  FirstHit(Cast& cast, const btCollisionObject& object, double limit)
      : cast_(cast),
        object_(object),
        own_(detail::box_of(*object.getCollisionShape(), object.getWorldTransform())),
        limit_(limit) {
    const btCollisionShape& shape = *object.getCollisionShape();
    if (shape.isConcave() && shape.getShapeType() != STATIC_PLANE_PROXYTYPE) stretch_ = cast.stretch(own_);
    look(0, 1);
  }

  [[nodiscard]] const std::optional<SweepHit>& best() const { return best_; }
  /// False where a piece in the way has no exact body.
  [[nodiscard]] bool answered() const { return answered_; }

 private:
  void look(double since, double until) {
    if (since > 0 && limit_ <= since) return;
    const Region region = cast_.region(since, until);
    if (detail::apart(own_, region.way, 0)) return;
    if (until - since > stretch_) {
      const double middle = 0.5 * (since + until);
      look(since, middle);
      look(middle, until);
      return;
    }
    Pieces found(region, cast_.cache());
    answered_ = found.add(*object_.getCollisionShape(), object_.getWorldTransform(), -1, -1, true) && answered_;
    for (RegionCandidate& candidate : found.pieces) {
      const RegionPiece& piece = candidate.piece;
      // A triangle reaches into several stretches.
      if (stretch_ < 1 && !asked_.insert({piece.part, piece.index}).second) continue;
      if (!detail::convert(candidate)) continue;
      if (auto hit = cast_.hit(object_, piece, limit_)) {
        limit_ = hit->fraction;
        best_ = std::move(hit);
      }
    }
  }

  Cast& cast_;
  const btCollisionObject& object_;
  Box own_;
  double limit_;
  double stretch_ = 1;
  std::set<std::pair<int, int>> asked_;
  std::optional<SweepHit> best_;
  bool answered_ = true;
};

/// @param needs    bool(btBroadphaseProxy&): who is asked.
/// @param limit    double(): hits from here on are of no interest.
/// @param answer   void(const SweepHit&).
template <class Needs, class Limit, class Answer>
Expected<int> ask(const Sweep& sweep, const Needs& needs, const Limit& limit, const Answer& answer) {
  if (const auto refused = refusal(sweep.from, sweep.to, sweep.settings)) return *refused;
  const Expected<Body> body = detail::exact_body(sweep.shape, sweep.settings.cache);
  if (!body) return body.error();
  Cast cast(sweep, *body);
  int unanswered = 0;
  const std::function<void(btBroadphaseProxy&)> visit = [&](btBroadphaseProxy& proxy) {
    const auto& object = *static_cast<const btCollisionObject*>(proxy.m_clientObject);
    if (!needs(proxy)) return;
    const FirstHit found(cast, object, std::min(1.0, limit()));
    if (!found.answered()) ++unanswered;
    if (found.best()) answer(*found.best());
  };
  Neighbours neighbours(visit);
  const Box box = cast.region(0, 1).way;
  sweep.world.getBroadphase()->aabbTest(box.lower, box.upper, neighbours);
  return unanswered;
}

/// A shape's first look for the nearest goes as far as this share of its diameter, and each later one so many times
/// farther than the one before.
constexpr double kNearShare = 0.125, kFartherShare = 2;

/// The nearest object of a whole world.
struct Nearest {
  btCollisionWorld& world;
  const btConvexShape& shape;
  const Body& body;
  const btTransform& pose;
  const WorldQuerySettings& settings;

  [[nodiscard]] Box way() const { return box_around(shape, pose, pose, settings.tolerance); }

  /// @param whole  becomes whether the whole world lies in the box of the reach, so that a longer one asks no more.
  [[nodiscard]] DistanceResult within(double reach, bool& whole) const {
    const Region region{way(), widened(way(), reach), diameter(shape, pose), reach, true};
    DistanceResult result;
    Scratch scratch;
    double least = reach;
    int inside = 0;
    const std::function<void(btBroadphaseProxy&)> visit = [&](btBroadphaseProxy& proxy) {
      inside += holds(region.reached, proxy) ? 1 : 0;
      const auto& object = *static_cast<const btCollisionObject*>(proxy.m_clientObject);
      if (!passes(proxy, settings)) return;
      Pieces found(region, settings.cache);
      if (!found.add(*object.getCollisionShape(), object.getWorldTransform(), -1, -1, true)) ++result.unanswered;
      found.sort();
      for (RegionCandidate& candidate : found.pieces) {
        if (candidate.nearest > std::max(least, 0.0)) break;
        if (!detail::convert(candidate)) continue;
        const RegionPiece& piece = candidate.piece;
        const PenetrationDepth answer = penetration_depth({&body->beside(*piece.body), to_pd(pose)},
                                                          {&piece.body->beside(*body), to_pd(piece.pose)}, scratch);
        WorldHit hit;
        fill(hit, object, piece, answer);
        if (hit.distance > least || (result.nearest && hit.distance == least)) continue;
        least = hit.distance;
        result.nearest = hit;
      }
    };
    Neighbours neighbours(visit);
    world.getBroadphase()->aabbTest(region.reached.lower, region.reached.upper, neighbours);
    whole = inside == world.getNumCollisionObjects();
    return result;
  }
};

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
  const Expected<Body> body = detail::exact_body(shape, settings.cache);
  if (!body) return body.error();
  const Nearest nearest{world, shape, *body, pose, settings};
  // Nothing farther than an answer is asked, so that an answer nearby costs the same however far the reach is.
  double near = std::min(reach, std::max(kNearShare * diameter(shape, pose), settings.tolerance));
  for (;;) {
    bool whole = false;
    const DistanceResult result = nearest.within(near, whole);
    if (result.nearest || near >= reach) return result;
    near = whole ? reach : std::min(reach, kFartherShare * near);
  }
}

}  // namespace pd
