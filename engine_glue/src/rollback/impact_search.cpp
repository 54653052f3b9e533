#include "rollback/impact_search.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "shapes/moving_body.hpp"

namespace pd::detail {

namespace {

/// What queries may leave open, as a share of the gap at which bodies meet. Bodies that rest are 0 apart up to
/// rounding: the sign of such a distance takes exact arithmetic, a hundred times the query, and is of no use here.
constexpr double kLeftOpen = 0x1p-10;

/// What a pair in contact may sink by in a part of a step is the slop less what it has sunk in the step already, and
/// this share of the slop at the least: a pair that sinks on and on is cut at finite lengths.
constexpr double kLeastSlop = 0.25;

}  // namespace

Pose Piece::with_body_at(const btTransform& pose) const { return to_pd(pose * local); }

void ImpactSearch::begin_frame() {
  bodies_.clear();
  first_depths_.clear();
  collected_ = false;
  const auto& objects = world_.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (objects[i]->hasContactResponse()) bodies_.push_back({objects[i]});
  }
}

void ImpactSearch::collect() {
  if (collected_) return;
  collected_ = true;
  pieces_.clear();
  for (Body& body : bodies_) {
    body.first_piece = static_cast<int>(pieces_.size());
    add_pieces(body.object, body.object->getCollisionShape(), btTransform::getIdentity());
    body.num_pieces = static_cast<int>(pieces_.size()) - body.first_piece;
    body.radius = 0;
    for (int k = body.first_piece; k < body.first_piece + body.num_pieces; ++k) {
      const Piece& piece = pieces_[static_cast<std::size_t>(k)];
      body.radius =
          std::max(body.radius, piece.concave != nullptr ? std::numeric_limits<double>::infinity()
                                                         : to_pd(piece.local.getOrigin()).norm() + piece.radius);
    }
  }
  bodies_.erase(std::remove_if(bodies_.begin(), bodies_.end(), [](const Body& body) { return body.num_pieces == 0; }),
                bodies_.end());
}

void ImpactSearch::add_pieces(btCollisionObject* object, const btCollisionShape* shape, const btTransform& local) {
  if (shape->isCompound()) {
    const auto* compound = static_cast<const btCompoundShape*>(shape);
    for (int i = 0; i < compound->getNumChildShapes(); ++i) {
      add_pieces(object, compound->getChildShape(i), local * compound->getChildTransform(i));
    }
    return;
  }
  Piece piece;
  piece.body = object;
  piece.local = local;
  if (shape->isConcave()) {
    piece.concave = static_cast<const btConcaveShape*>(shape);
  } else if (shape->isConvex()) {
    piece.cached = solver_.cache().find(*static_cast<const btConvexShape*>(shape), 0);
    if (!piece.cached->body) return;
    piece.radius = bounding_radius(piece.cached->sharp ? *piece.cached->sharp : *piece.cached->body);
  } else {
    return;
  }
  pieces_.push_back(std::move(piece));
}

void ImpactSearch::mark_start() {
  surroundings_.clear();
  starts_.clear();
  for (Body& body : bodies_) {
    body.start = body.object->getWorldTransform();
    if (const btRigidBody* rigid = btRigidBody::upcast(body.object)) {
      body.linear = rigid->getLinearVelocity();
      body.angular = rigid->getAngularVelocity();
    }
  }
}

double ImpactSearch::farthest_way() const {
  const auto reach = [](const Body& body) {
    // Of the step that was made, which began at the marked pose.
    const btBroadphaseProxy& box = *body.object->getBroadphaseHandle();
    const btVector3 origin = body.start.getOrigin();
    return to_pd(btVector3((box.m_aabbMin - origin).absolute()))
        .cwiseMax(to_pd(btVector3((box.m_aabbMax - origin).absolute())))
        .norm();
  };
  double farthest = 0, second = 0;
  for (const Body& body : bodies_) {
    const btTransform& end = body.object->getWorldTransform();
    double turned = 0;
    for (int i = 0; i < 3; ++i) {
      turned += static_cast<double>((end.getBasis()[i] - body.start.getBasis()[i]).length2());
    }
    // A turn by the angle t moves a point at r by the chord 2 r sin(t / 2), and the matrix by sqrt(8) sin(t / 2). Up to
    // t = 1 the arc is less than 1.05 of the chord.
    const double chord = turned > 0 ? std::sqrt(0.5 * turned) * reach(body) : 0;
    if (turned > 0.4) return std::numeric_limits<double>::infinity();
    const double way = to_pd(end.getOrigin() - body.start.getOrigin()).norm() + 1.05 * chord;
    second = std::max(second, std::min(way, farthest));
    farthest = std::max(farthest, way);
  }
  return farthest + second;
}

void ImpactSearch::sweep(Body& body, double duration) {
  const btTransform& end = body.object->getWorldTransform();
  body.motion = motion_between(body.start, end, duration);
  const double turn = body.motion.angular_velocity.norm() * duration;
  body.travel = body.motion.linear_velocity.norm() * duration + (turn > 0 ? turn * body.radius : 0);
  const btCollisionShape* shape = body.object->getCollisionShape();
  shape->getAabb(body.start, body.lower, body.upper);
  if (body.travel == 0) return;
  btVector3 lower;
  btVector3 upper;
  shape->getAabb(end, lower, upper);
  body.lower.setMin(lower);
  body.upper.setMax(upper);
  if (turn > 0 && std::isfinite(body.radius)) {
    // Between its ends a turning point leaves the chord by r (1 - cos(turn / 2)) at most.
    const auto bulge = static_cast<btScalar>(body.radius * (1 - std::cos(0.5 * std::min(turn, 6.28))) * 1.001);
    body.lower -= btVector3(bulge, bulge, bulge);
    body.upper += btVector3(bulge, bulge, bulge);
  }
}

bool ImpactSearch::may_meet(const Body& a, const Body& b) const {
  if (a.travel == 0 && b.travel == 0) return false;
  if (a.object->isStaticOrKinematicObject() && b.object->isStaticOrKinematicObject()) return false;
  if (a.lower.y() > b.upper.y() || b.lower.y() > a.upper.y() || a.lower.z() > b.upper.z() ||
      b.lower.z() > a.upper.z()) {
    return false;
  }
  return world_.getDispatcher()->needsCollision(a.object, b.object) &&
         world_.getPairCache()->needsBroadphaseCollision(a.object->getBroadphaseHandle(),
                                                         b.object->getBroadphaseHandle());
}

bool ImpactSearch::earliest(double duration, const Settings& settings, FoundImpact& found) {
  duration_ = duration;
  quick_.contact_tolerance = kLeftOpen * settings.gap;
  found = FoundImpact();
  found.time = HUGE_VAL;
  if (farthest_way() <= settings.searched) return false;
  collect();
  const auto widen = static_cast<btScalar>(settings.gap);
  for (Body& body : bodies_) {
    sweep(body, duration);
    body.lower -= btVector3(widen, widen, widen);
    body.upper += btVector3(widen, widen, widen);
  }
  order_.resize(bodies_.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto lower_x = [&](int i) { return bodies_[static_cast<std::size_t>(i)].lower.x(); };
  std::sort(order_.begin(), order_.end(),
            [&](int i, int j) { return lower_x(i) != lower_x(j) ? lower_x(i) < lower_x(j) : i < j; });
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const Body& first = bodies_[static_cast<std::size_t>(order_[i])];
    for (std::size_t j = i + 1; j < order_.size() && lower_x(order_[j]) <= first.upper.x(); ++j) {
      const Body& second = bodies_[static_cast<std::size_t>(order_[j])];
      if (may_meet(first, second)) {
        // In the order of the world, so that the answer does not depend on where the bodies are.
        search_bodies(order_[i] < order_[j] ? first : second, order_[i] < order_[j] ? second : first, settings, found);
      }
    }
  }
  return found.a.body != nullptr;
}

void ImpactSearch::search_bodies(const Body& a, const Body& b, const Settings& settings, FoundImpact& found) {
  // As for the world: pairs that move together.
  const double apart = (a.motion.linear_velocity - b.motion.linear_velocity).norm() * duration_;
  const auto turning = [&](const Body& body) {
    const double turn = body.motion.angular_velocity.norm() * duration_;
    return turn > 0 ? turn * body.radius : 0;
  };
  if (apart + turning(a) + turning(b) <= settings.searched) return;
  for (int i = a.first_piece; i < a.first_piece + a.num_pieces; ++i) {
    for (int j = b.first_piece; j < b.first_piece + b.num_pieces; ++j) {
      const Piece& pa = pieces_[static_cast<std::size_t>(i)];
      const Piece& pb = pieces_[static_cast<std::size_t>(j)];
      if (pa.concave == nullptr && pb.concave == nullptr) {
        search_convex(a, pa, b, pb, settings, found);
      } else if (pa.concave == nullptr) {
        search_concave(a, pa, b, pb, settings, found);
      } else if (pb.concave == nullptr) {
        search_concave(b, pb, a, pa, settings, found);
      }
    }
  }
}

void ImpactSearch::search_convex(const Body& a, const Piece& pa, const Body& b, const Piece& pb,
                                 const Settings& settings, FoundImpact& found) {
  const MovingShape moving_a = moving_piece(pa.cached->beside(*pb.cached), a.start, pa.local, a.motion);
  const MovingShape moving_b = moving_piece(pb.cached->beside(*pa.cached), b.start, pb.local, b.motion);
  const auto travel = [&](const Body& body, const Piece& piece, const MovingShape& moving) {
    return body.motion.angular_velocity.norm() * duration_ * (moving.arm.norm() + piece.radius);
  };
  const double reach = (a.motion.linear_velocity - b.motion.linear_velocity).norm() * duration_ +
                       travel(a, pa, moving_a) + travel(b, pb, moving_b);
  const double centres = (moving_a.start.pose.translation() - moving_b.start.pose.translation()).norm();
  if (centres > reach + pa.radius + pb.radius + settings.gap) return;
  const auto [known, is_new] = starts_.try_emplace(place_of(pa, pb));
  if (is_new) known->second = penetration_depth(moving_a.start, moving_b.start, scratch_, quick_);
  const PenetrationDepth& before = known->second;
  const double start = before.signed_distance();
  if (start > reach + settings.gap) return;
  TimeOfImpactSettings impact;
  impact.distance_tolerance = 0.5 * settings.gap;
  impact.contact_at_end = false;
  impact.depth = quick_;
  impact.at_start = &before;
  // From where it is, a pair in contact may sink; then the step is cut, and Bullet sees it there.
  if (start <= settings.in_contact) impact.allowed_depth = allowed_depth(pa, pb, std::max(-start, 0.0), settings);
  const TimeOfImpact hit = time_of_impact(moving_a, moving_b, std::min(duration_, found.time), scratch_, impact);
  if (hit.hit && hit.time < found.time) found = {pa, pb, hit.time, impact.allowed_depth};
}

std::size_t ImpactSearch::place_of(const Piece& a, const Piece& b) const {
  const auto place = [&](const Piece& piece) { return static_cast<std::size_t>(&piece - pieces_.data()); };
  return place(a) * pieces_.size() + place(b);
}

double ImpactSearch::allowed_depth(const Piece& a, const Piece& b, double depth, const Settings& settings) {
  const double first = first_depths_.emplace(place_of(a, b), depth).first->second;
  return depth + std::max(settings.slop - std::max(depth - first, 0.0), kLeastSlop * settings.slop);
}

void ImpactSearch::swept_box(const Body& a, const Piece& pa, const Body& b, const Piece& pb, btVector3& lower,
                             btVector3& upper) const {
  const btTransform frame = (b.start * pb.local).inverse();
  const btTransform start = a.start * pa.local;
  const btTransform end = a.object->getWorldTransform() * pa.local;
  const btVector3 from = frame * start.getOrigin();
  const btVector3 to = frame * end.getOrigin();
  lower = from;
  upper = from;
  lower.setMin(to);
  upper.setMax(to);
  const double turn = a.motion.angular_velocity.norm() * duration_;
  const double arm = to_pd(pa.local.getOrigin()).norm();
  // Where the concave body moves, too, its motion is laid on the other one.
  const double moved = b.motion.linear_velocity.norm() * duration_ +
                       b.motion.angular_velocity.norm() * duration_ *
                           (to_pd(a.start.getOrigin() - b.start.getOrigin()).norm() + arm + a.travel);
  const auto margin = static_cast<double>(pb.concave->getMargin());
  const auto grown =
      static_cast<btScalar>((pa.radius + margin + arm * (1 - std::cos(0.5 * std::min(turn, 6.28))) + moved) * 1.001);
  lower -= btVector3(grown, grown, grown);
  upper += btVector3(grown, grown, grown);
}

SupportLevel ImpactSearch::level_of(const StillTriangle& triangle, const Vec3& towards) {
  const std::array<Vec3, 3>& corners = triangle.corners;
  Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double length = normal.norm();
  if (!(length > 0)) return {Vec3::UnitX(), HUGE_VAL};
  normal /= normal.dot(towards - corners[0]) < 0 ? -length : length;
  double level = -HUGE_VAL;
  for (const Vec3& corner : corners) level = std::max(level, normal.dot(corner));
  return {normal, level + triangle.margin};
}

std::vector<ImpactSearch::Surface>& ImpactSearch::surface_of(const Approach& pair, StaysApart& along) {
  btVector3 lower;
  btVector3 upper;
  swept_box(pair.a, pair.convex, pair.b, pair.concave, lower, upper);
  const auto [known, is_new] = surroundings_.try_emplace(place_of(pair.convex, pair.concave));
  Surroundings& around = known->second;
  bool is_known = !is_new && pair.depth.beyond <= around.beyond;
  for (int i = 0; i < 3; ++i) is_known = is_known && lower[i] >= around.lower[i] && upper[i] <= around.upper[i];
  if (!is_known) {
    around.lower = lower;
    around.upper = upper;
    around.beyond = pair.depth.beyond;
    read_surface(pair, along, around);
  }
  return around.surface;
}

void ImpactSearch::read_surface(const Approach& pair, StaysApart& along, Surroundings& around) {
  const Pose surface = to_pd(pair.b.start * pair.concave.local);
  const Pose& start = pair.moving.start.pose;
  const Whereabouts near{surface.rotation().transpose() * (start.translation() - surface.translation()),
                         pair.convex.radius + pair.depth.beyond};
  const btConcaveShape& concave = *pair.concave.concave;
  const double margin = margin_of_triangles(concave);
  const double margins = margin + pair.moving.start.shape->margin();
  around.surface.clear();
  for (const TriangleCorners& local : corners_in_box(concave, around.lower, around.upper, &near)) {
    StillTriangle world{local.corners, margin};
    for (Vec3& corner : world.corners) corner = surface.apply(corner);
    Surface triangle{local, level_of(world, start.translation()), world, 0, HUGE_VAL, nullptr, std::nullopt};
    const SupportLevel& level = triangle.level;
    triangle.bound = std::max(along.at_start(level), along.beside_at_start(world));
    if (triangle.bound <= pair.depth.beyond) {
      // A point of the body is no nearer than the body: the first one, or the one on the way through it that is in the
      // plane of the triangle.
      Vec3 point = along.first_along(level.normal);
      const double above = level.normal.dot(point) - (level.level - margin);
      if (above < 0) {
        const Vec3 last = along.first_along(-level.normal);
        const double thick = level.normal.dot(last - point);
        if (thick > -above) point += (-above / thick) * (last - point);
      }
      const double reach = distance_from(point, world.corners) - margins;
      if (!std::isnan(reach)) triangle.reach = reach;
    }
    around.surface.push_back(std::move(triangle));
  }
  std::stable_sort(around.surface.begin(), around.surface.end(),
                   [](const Surface& x, const Surface& y) { return x.reach < y.reach; });
}

std::shared_ptr<CachedShape> ImpactSearch::shape_of(const TriangleCorners& corners, double margin) {
  btTriangleShape triangle(to_bullet(corners.corners[0]), to_bullet(corners.corners[1]), to_bullet(corners.corners[2]));
  triangle.setMargin(static_cast<btScalar>(margin));
  std::shared_ptr<CachedShape> found;
  triangles_.find(triangle, found, [&](const btTriangleShape& made) { return solver_.cache().find(made, 0); });
  return found;
}

double ImpactSearch::ask_start(const Approach& pair, Surface& triangle) {
  if (!triangle.start) {
    triangle.start.emplace();
    triangle.shape = shape_of(triangle.corners, triangle.world.margin);
    if (triangle.shape->body) {
      const MovingShape posed = moving_piece(*triangle.shape->body, pair.b.start, pair.concave.local, pair.b.motion);
      *triangle.start = penetration_depth(pair.moving.start, posed.start, scratch_, pair.depth);
    }
  }
  return triangle.shape->body ? triangle.start->signed_distance() : HUGE_VAL;
}

bool ImpactSearch::is_in_contact(const Approach& pair, std::vector<Surface>& surface, double in_contact) {
  // The triangles are sorted by their reach.
  if (!surface.empty() && surface.front().reach <= in_contact) return true;
  return std::any_of(surface.begin(), surface.end(), [&](Surface& triangle) {
    return triangle.bound <= in_contact && ask_start(pair, triangle) <= in_contact;
  });
}

void ImpactSearch::search_concave(const Body& a, const Piece& pa, const Body& b, const Piece& pb,
                                  const Settings& settings, FoundImpact& found) {
  const MovingShape moving_a = moving_piece(*pa.cached->body, a.start, pa.local, a.motion);
  // No point of the body comes farther than this against the surface.
  const double arm = moving_a.arm.norm();
  const double far = to_pd(a.start.getOrigin() - b.start.getOrigin()).norm() + arm + a.travel + pa.radius;
  const double way =
      duration_ * ((a.motion.linear_velocity - b.motion.linear_velocity).norm() +
                   a.motion.angular_velocity.norm() * (arm + pa.radius) + b.motion.angular_velocity.norm() * far);
  Approach pair{a, pa, b, pb, moving_a, quick_};
  pair.depth.beyond = std::max(way + settings.gap, settings.in_contact);
  StaysApart along(moving_a, duration_);
  std::vector<Surface>& surface = surface_of(pair, along);
  // A body that touches one triangle is in contact with the surface: on its way along it, it meets the next triangles
  // at their edges, no deeper than it lies on this one. So one depth is allowed for all.
  const bool in_contact = is_in_contact(pair, surface, settings.in_contact);
  const bool still = b.travel == 0;
  const auto proved = [&](const Surface& triangle, double least) {
    return triangle.bound > pair.depth.beyond ||
           (still && triangle.bound >= least &&
            (along.proved(triangle.level, least) || along.proved_beside(triangle.world, least)));
  };
  // Pairs in contact may sink by this at the least, whatever they have sunk.
  const double least = in_contact ? -0.9 * kLeastSlop * settings.slop : settings.gap;
  unproved_.clear();
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!proved(surface[i], least)) unproved_.push_back(i);
  }
  if (unproved_.empty()) return;
  TimeOfImpactSettings impact;
  impact.distance_tolerance = 0.5 * settings.gap;
  impact.contact_at_end = false;
  impact.depth = quick_;
  if (in_contact) {
    double depth = 0;
    for (Surface& triangle : surface) {
      if (-triangle.bound > depth) depth = std::max(depth, -ask_start(pair, triangle));
    }
    impact.allowed_depth = allowed_depth(pa, pb, depth, settings);
  }
  for (const std::size_t i : unproved_) {
    Surface& triangle = surface[i];
    if (impact.allowed_depth > 0 && proved(triangle, -0.9 * impact.allowed_depth)) continue;
    if (ask_start(pair, triangle) > way + settings.gap) continue;
    const MovingShape moving_b = moving_piece(*triangle.shape->body, b.start, pb.local, b.motion);
    impact.at_start = &*triangle.start;
    const TimeOfImpact hit = time_of_impact(moving_a, moving_b, std::min(duration_, found.time), scratch_, impact);
    if (hit.hit && hit.time < found.time) {
      found = {pa, pb, hit.time, impact.allowed_depth};
      found.b.cached = triangle.shape;
    }
  }
}

PenetrationDepth ImpactSearch::measure(const FoundImpact& impact, const btTransform& a, const btTransform& b) {
  const CachedShape &of_a = *impact.a.cached, &of_b = *impact.b.cached;
  return penetration_depth({&of_a.beside(of_b), impact.a.with_body_at(a)},
                           {&of_b.beside(of_a), impact.b.with_body_at(b)}, scratch_, quick_);
}

btTransform ImpactSearch::pose_after(const btCollisionObject& object, double time) const {
  const auto body = std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.object == &object; });
  btTransform pose = object.getWorldTransform();
  if (body == bodies_.end() || body->travel == 0) return pose;
  // A bounce adds the same velocity whatever the length.
  const auto share = static_cast<btScalar>(object.getRestitution() > 0 ? 1 : time / duration_);
  btTransformUtil::integrateTransform(body->start, body->linear.lerp(to_bullet(body->motion.linear_velocity), share),
                                      body->angular.lerp(to_bullet(body->motion.angular_velocity), share),
                                      static_cast<btScalar>(time), pose);
  return pose;
}

}  // namespace pd::detail
