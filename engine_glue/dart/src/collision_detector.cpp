#include "pd/dart/collision_detector.hpp"

#include <algorithm>
#include <cstdio>
#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/DistanceFilter.hpp>
#include <limits>

#include "dart_queries.hpp"

namespace pd {

namespace detail {

namespace {

using dart::collision::CollisionOption;
using dart::collision::CollisionResult;
using dart::collision::Contact;
using dart::collision::DistanceOption;
using dart::collision::DistanceResult;

/// The interval of an object along an axis.
struct Interval {
  double low, high;
  std::size_t place;  ///< in its list
  DartObject* object;
  bool of_second_group;
};

/// The axis along which the centres of bounded objects are spread most. Equal spreads: the first axis.
class WidestAxis {
 public:
  void add(const std::vector<DartObject*>& objects) {
    for (const DartObject* object : objects) {
      if (object->refusal() || object->body().ground) continue;
      low_ = low_.cwiseMin(object->pose().translation());
      high_ = high_.cwiseMax(object->pose().translation());
    }
  }
  [[nodiscard]] Eigen::Index axis() const {
    Eigen::Index widest = 0;
    (high_ - low_).maxCoeff(&widest);
    return widest;
  }

 private:
  Vec3 low_ = Vec3::Constant(std::numeric_limits<double>::max());
  Vec3 high_ = -low_;
};

std::vector<Interval> intervals_of(const std::vector<DartObject*>& objects, bool of_second_group, Eigen::Index axis) {
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const DartObject& object = *objects[i];
    const bool unbounded = object.refusal().has_value();
    const double x = unbounded ? 0 : object.pose().translation()[axis];
    const double reach = unbounded ? std::numeric_limits<double>::infinity() : object.body().radius;
    intervals.push_back({x - reach, x + reach, i, objects[i], of_second_group});
  }
  return intervals;
}

/// Calls `visit(first, second)` for the pairs whose intervals and spheres meet, until it returns false. The first
/// object is the first group's, or stands first in the only one.
template <class Visit>
void visit_near_pairs(std::vector<Interval> all, bool two_groups, Visit&& visit) {
  std::sort(all.begin(), all.end(), [](const Interval& p, const Interval& q) {
    return std::tie(p.low, p.of_second_group, p.place) < std::tie(q.low, q.of_second_group, q.place);
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size() && !(all[j].low > all[i].high); ++j) {
      const Interval *first = &all[i], *second = &all[j];
      if (two_groups && first->of_second_group == second->of_second_group) continue;
      if (two_groups ? first->of_second_group : first->place > second->place) std::swap(first, second);
      if (first->object == second->object || !spheres_meet(*first->object, *second->object)) continue;
      if (!visit(*first->object, *second->object)) return;
    }
  }
}

/// Collects the contacts of a call.
class Collector {
 public:
  Collector(DartQueries& queries, const CollisionOption& option, CollisionResult* result)
      : queries_(queries), option_(option), result_(result) {}

  /// @return false if no more pairs are wanted
  bool take(DartObject& first, DartObject& second) {
    if (option_.collisionFilter && option_.collisionFilter->ignoresCollision(&first, &second)) return true;
    contacts_.clear();
    queries_.collide(first, second, option_.enableContact && result_ != nullptr, contacts_);
    found_ = found_ || !contacts_.empty();
    if (result_ == nullptr) return !found_;
    for (const Contact& contact : contacts_) {
      if (result_->getNumContacts() >= option_.maxNumContacts) break;
      result_->addContact(contact);
    }
    return result_->getNumContacts() < option_.maxNumContacts;
  }
  [[nodiscard]] bool found() const { return found_; }

 private:
  DartQueries& queries_;
  const CollisionOption& option_;
  CollisionResult* result_;
  std::vector<Contact> contacts_;
  bool found_ = false;
};

/// The nearest pair so far.
class Nearest {
 public:
  Nearest(DartQueries& queries, const DistanceOption& option) : queries_(queries), option_(option) {}

  /// @return false if no more pairs are wanted
  bool take(DartObject& first, DartObject& second) {
    if (option_.distanceFilter && !option_.distanceFilter->needDistance(&first, &second)) return true;
    if (first_ != nullptr && are_farther(first, second)) return true;
    PairDistance pair;
    if (!queries_.distance(first, second, option_.enableNearestPoints, pair)) return true;
    if (first_ == nullptr || pair.signed_distance < nearest_.signed_distance) {
      nearest_ = pair;
      first_ = &first;
      second_ = &second;
    }
    return nearest_.signed_distance > option_.distanceLowerBound;
  }

  double tell(DistanceResult* result) const {
    // DART's own detectors answer for no pair as for a distance of 0.
    const double unclamped = first_ == nullptr ? 0 : nearest_.signed_distance;
    const double clamped = std::max(unclamped, option_.distanceLowerBound);
    if (result == nullptr || first_ == nullptr) return clamped;
    result->minDistance = clamped;
    result->unclampedMinDistance = unclamped;
    result->shapeFrame1 = first_->getShapeFrame();
    result->shapeFrame2 = second_->getShapeFrame();
    if (option_.enableNearestPoints) {
      result->nearestPoint1 = nearest_.on_first;
      result->nearestPoint2 = nearest_.on_second;
    }
    return clamped;
  }

 private:
  /// True if the spheres around two objects are farther apart than the nearest pair.
  [[nodiscard]] bool are_farther(const DartObject& a, const DartObject& b) const {
    if (a.refusal() || b.refusal()) return false;
    const double between = (a.pose().translation() - b.pose().translation()).norm();
    return between - a.body().radius - b.body().radius > nearest_.signed_distance;
  }

  DartQueries& queries_;
  const DistanceOption& option_;
  PairDistance nearest_;
  DartObject* first_ = nullptr;
  DartObject* second_ = nullptr;
};

/// The group of this detector; null with a warning for one of another detector.
DartGroup* group_of(const DartDetector& detector, dart::collision::CollisionGroup* group) {
  if (group != nullptr && group->getCollisionDetector().get() == &detector) return static_cast<DartGroup*>(group);
  std::fprintf(stderr, "pdepth: a detector is asked about a collision group of another detector, and finds nothing\n");
  return nullptr;
}

}  // namespace

}  // namespace detail

void DartOptions::print_warning(const char* line, void* /*user*/) { std::fprintf(stderr, "%s\n", line); }

DartDetector::DartDetector(const DartOptions& options) : queries_(std::make_unique<detail::DartQueries>(options)) {
  mCollisionObjectManager = std::make_unique<ManagerForSharableCollisionObjects>(this);
}
DartDetector::~DartDetector() = default;

std::shared_ptr<DartDetector> DartDetector::create(const DartOptions& options) {
  return std::shared_ptr<DartDetector>(new DartDetector(options));
}

std::shared_ptr<dart::collision::CollisionDetector> DartDetector::cloneWithoutCollisionObjects() const {
  return create(queries_->options());
}

const std::string& DartDetector::getType() const { return getStaticType(); }

const std::string& DartDetector::getStaticType() {
  static const std::string type = "pdepth";
  return type;
}

std::unique_ptr<dart::collision::CollisionGroup> DartDetector::createCollisionGroup() {
  return std::make_unique<detail::DartGroup>(shared_from_this());
}

bool DartDetector::collide(dart::collision::CollisionGroup* group, const dart::collision::CollisionOption& option,
                           dart::collision::CollisionResult* result) {
  if (result != nullptr) result->clear();
  auto* asked = detail::group_of(*this, group);
  if (asked == nullptr || option.maxNumContacts == 0) return false;
  const auto& objects = asked->refreshed();
  detail::WidestAxis widest;
  widest.add(objects);
  detail::Collector collector(*queries_, option, result);
  detail::visit_near_pairs(detail::intervals_of(objects, false, widest.axis()), false,
                           [&](auto& a, auto& b) { return collector.take(a, b); });
  return collector.found();
}

bool DartDetector::collide(dart::collision::CollisionGroup* group1, dart::collision::CollisionGroup* group2,
                           const dart::collision::CollisionOption& option, dart::collision::CollisionResult* result) {
  if (result != nullptr) result->clear();
  auto* first = detail::group_of(*this, group1);
  auto* second = detail::group_of(*this, group2);
  if (first == nullptr || second == nullptr || option.maxNumContacts == 0) return false;
  const auto &objects = first->refreshed(), &of_second = second->refreshed();
  detail::WidestAxis widest;
  widest.add(objects);
  widest.add(of_second);
  auto all = detail::intervals_of(objects, false, widest.axis());
  const auto others = detail::intervals_of(of_second, true, widest.axis());
  all.insert(all.end(), others.begin(), others.end());
  detail::Collector collector(*queries_, option, result);
  detail::visit_near_pairs(std::move(all), true, [&](auto& a, auto& b) { return collector.take(a, b); });
  return collector.found();
}

double DartDetector::distance(dart::collision::CollisionGroup* group, const dart::collision::DistanceOption& option,
                              dart::collision::DistanceResult* result) {
  if (result != nullptr) result->clear();
  auto* asked = detail::group_of(*this, group);
  if (asked == nullptr) return 0;
  const auto& objects = asked->refreshed();
  detail::Nearest nearest(*queries_, option);
  bool more = true;
  for (std::size_t i = 0; i < objects.size() && more; ++i) {
    for (std::size_t j = i + 1; j < objects.size() && more; ++j) more = nearest.take(*objects[i], *objects[j]);
  }
  return nearest.tell(result);
}

double DartDetector::distance(dart::collision::CollisionGroup* group1, dart::collision::CollisionGroup* group2,
                              const dart::collision::DistanceOption& option, dart::collision::DistanceResult* result) {
  if (result != nullptr) result->clear();
  auto* first = detail::group_of(*this, group1);
  auto* second = detail::group_of(*this, group2);
  if (first == nullptr || second == nullptr) return 0;
  const auto &objects = first->refreshed(), &others = second->refreshed();
  detail::Nearest nearest(*queries_, option);
  bool more = true;
  for (std::size_t i = 0; i < objects.size() && more; ++i) {
    for (std::size_t j = 0; j < others.size() && more; ++j) {
      if (objects[i] != others[j]) more = nearest.take(*objects[i], *others[j]);
    }
  }
  return nearest.tell(result);
}

DartReport DartDetector::report() const { return queries_->report(); }

std::unique_ptr<dart::collision::CollisionObject> DartDetector::createCollisionObject(
    const dart::dynamics::ShapeFrame* frame) {
  return std::make_unique<detail::DartObject>(this, frame);
}

void DartDetector::refreshCollisionObject(dart::collision::CollisionObject* object) {
  static_cast<detail::DartObject*>(object)->convert_if_changed();
}

void DartDetector::notifyCollisionObjectDestroying(dart::collision::CollisionObject* object) {
  queries_->forget(*static_cast<detail::DartObject*>(object));
}

void register_dart_detector() {
  dart::collision::CollisionDetector::getFactory()->registerCreator(
      DartDetector::getStaticType(),
      []() -> std::shared_ptr<dart::collision::CollisionDetector> { return DartDetector::create(); });
}

}  // namespace pd
