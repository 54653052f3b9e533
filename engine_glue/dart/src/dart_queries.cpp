#include "dart_queries.hpp"

#include <algorithm>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <limits>

namespace pd::detail {

namespace {

/// Contacts of a pair that FCL is asked for.
constexpr std::size_t kContactsOfFcl = 100;

/// DART knows no margin: corners of faces that meet count up to this gap, with depth 0. In radii of the smaller body.
constexpr double kSlack = 1e-4;

}  // namespace

DartQueries::DartQueries(const DartOptions& options) : options_(options) {
  if (!(options_.delta >= 0 && options_.delta <= 1)) options_.delta = 0;
}

bool DartQueries::left_to_fcl(const DartObject& first, const DartObject& second) {
  const auto& refusal = first.refusal() ? first.refusal() : second.refusal();
  if (!refusal) return false;
  const auto kind = static_cast<std::size_t>(refusal->kind);
  if (report_.left[kind]++ == 0) {
    report_.first[kind] = refusal->text;
    if (options_.warning != nullptr) {
      const std::string line = "pdepth: " + refusal->text + ". DART's FCL detector answers for such pairs.";
      options_.warning(line.c_str(), options_.user);
    }
  }
  return true;
}

const ContactManifold& DartQueries::points_of(const DartObject& first, const DartObject& second) {
  const bool exchanged = first.body().ground.has_value();
  const DartObject& a = exchanged ? second : first;
  const DartObject& b = exchanged ? first : second;
  if (b.body().ground) {
    points_ = pairs_.on_ground(
        {.body = a.posed(), .ground = b.ground(), .slack = kSlack * a.body().radius, .size = a.body().radius});
    if (exchanged) PairPoints::exchange(points_);
    return points_;
  }
  PairOfBodies pair{
      .a = a.posed(), .b = b.posed(), .size = std::min(a.body().radius, b.body().radius), .delta = options_.delta};
  if (a.body().half_extents && b.body().half_extents) pair.boxes = {*a.body().half_extents, *b.body().half_extents};
  points_ = pairs_.of_bodies(pair);
  return points_;
}

void DartQueries::collide(DartObject& first, DartObject& second, bool points,
                          std::vector<dart::collision::Contact>& contacts) {
  if (left_to_fcl(first, second)) {
    collide_by_fcl(first, second, points, contacts);
    return;
  }
  if (first.body().ground && second.body().ground) return;
  ++report_.answered;
  ContactManifold found = points_of(first, second);
  std::sort(found.points.begin(), found.points.begin() + std::clamp(found.count, 0, 4),
            [](const ContactPoint& p, const ContactPoint& q) { return p.depth > q.depth; });
  dart::collision::Contact contact;
  contact.collisionObject1 = &first;
  contact.collisionObject2 = &second;
  for (int i = 0; i < (points ? found.count : std::min(found.count, 1)); ++i) {
    const ContactPoint& point = found.points[static_cast<std::size_t>(i)];
    if (points) {
      contact.point = point.position_a + (point.position_b - point.position_a) / 2;
      contact.normal = found.normal;
      contact.penetrationDepth = std::max(point.depth, 0.0);
      ++report_.contact_points;
    }
    contacts.push_back(contact);
  }
}

void DartQueries::on_ground(const DartObject& body, const DartObject& plane, bool points, PairDistance& found) {
  const Halfspace3 ground = plane.ground();
  HalfspaceContact contact = halfspace_contact(body.posed(), ground, 0, manifold_);
  found.signed_distance = contact.lower + (contact.upper - contact.lower) / 2;
  if (!points) return;
  if (contact.manifold.count == 0) {
    // Points are given up to a threshold alone.
    const double reach = contact.upper + body.body().radius;
    contact = halfspace_contact(body.posed(), ground, std::max(reach, 0.0), manifold_);
  }
  const auto first = contact.manifold.points.begin();
  const auto deepest = std::max_element(first, first + contact.manifold.count,
                                        [](const auto& p, const auto& q) { return p.depth < q.depth; });
  found.on_first = deepest->position_a;
  found.on_second = found.on_first - found.signed_distance * ground.normal;
}

bool DartQueries::distance(DartObject& first, DartObject& second, bool points, PairDistance& found) {
  if (left_to_fcl(first, second)) return distance_by_fcl(first, second, found);
  if (first.body().ground && second.body().ground) return false;
  ++report_.answered;
  if (second.body().ground) {
    on_ground(first, second, points, found);
  } else if (first.body().ground) {
    on_ground(second, first, points, found);
    std::swap(found.on_first, found.on_second);
  } else {
    const PenetrationDepth answer = penetration_depth(first.posed(), second.posed(), scratch_,
                                                      {.bracket = Bracket::certified, .delta = options_.delta});
    found = {static_cast<double>(answer.signed_distance()), answer.witness_a, answer.witness_b};
  }
  return true;
}

dart::collision::CollisionGroup& DartQueries::group_of_fcl(const DartObject& object) {
  if (!fcl_) fcl_ = dart::collision::FCLCollisionDetector::create();
  auto& group = groups_of_fcl_[&object];
  if (!group) {
    group = fcl_->createCollisionGroup();
    group->addShapeFrame(object.getShapeFrame());
  }
  return *group;
}

void DartQueries::collide_by_fcl(DartObject& first, DartObject& second, bool points,
                                 std::vector<dart::collision::Contact>& contacts) {
  dart::collision::CollisionResult result;
  auto& group = group_of_fcl(first);
  group.collide(&group_of_fcl(second), {points, points ? kContactsOfFcl : 1, nullptr}, &result);
  for (std::size_t i = 0; i < result.getNumContacts(); ++i) {
    dart::collision::Contact contact = result.getContact(i);
    if (contact.collisionObject1->getShapeFrame() == second.getShapeFrame()) contact.normal = -contact.normal;
    contact.collisionObject1 = &first;
    contact.collisionObject2 = &second;
    contacts.push_back(contact);
  }
}

bool DartQueries::distance_by_fcl(DartObject& first, DartObject& second, PairDistance& found) {
  dart::collision::DistanceResult result;
  auto& group = group_of_fcl(first);
  group.distance(&group_of_fcl(second), {true, -std::numeric_limits<double>::infinity(), nullptr}, &result);
  if (!result.found()) return false;
  found = {result.unclampedMinDistance, result.nearestPoint1, result.nearestPoint2};
  if (result.shapeFrame1 == second.getShapeFrame()) std::swap(found.on_first, found.on_second);
  return true;
}

}  // namespace pd::detail
