#include "pd/dart/contact_recorder.hpp"

#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dart_object.hpp"
#include "pair_record.hpp"
#include "pd/dart/collision_detector.hpp"
#include "pd/record/record_shape.hpp"

namespace pd {

namespace detail {

class DartRecord {
 public:
  explicit DartRecord(std::string path) : path_(std::move(path)) {
    // The engine's name is known once a group is written.
    good_ = open("DART");
  }

  void write(dart::collision::CollisionGroup& group, const dart::collision::CollisionOption& option, double seconds) {
    if (!named_ && good_) {
      pd_record_close(&record_);
      good_ = open("DART, detector " + group.getCollisionDetector()->getType());
      named_ = true;
    }
    record_.time = seconds;
    record_.has_time = 1;
    DartGroup& seen = group_of_these(group);
    const std::vector<DartObject*>& objects = seen.refreshed();
    std::map<const dart::dynamics::ShapeFrame*, DartObject*> by_frame;
    for (DartObject* object : objects) by_frame[object->getShapeFrame()] = object;
    dart::collision::CollisionResult result;
    constexpr std::size_t kAll = 100'000;
    group.collide({true, kAll, option.collisionFilter}, &result);
    std::map<std::pair<DartObject*, DartObject*>, std::vector<RecordedPoint>> reported;
    for (const auto& contact : result.getContacts()) {
      DartObject* a = by_frame[contact.collisionObject1->getShapeFrame()];
      DartObject* b = by_frame[contact.collisionObject2->getShapeFrame()];
      if (a == nullptr || b == nullptr) continue;
      const Vec3 half = contact.penetrationDepth / 2 * contact.normal;
      auto& points = reported.contains({b, a}) ? reported[{b, a}] : reported[{a, b}];
      const double sign = reported.contains({b, a}) ? -1 : 1;
      points.push_back(
          {contact.point - sign * half, contact.point + sign * half, contact.penetrationDepth, sign * contact.normal});
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
      for (std::size_t j = i + 1; j < objects.size(); ++j) {
        DartObject *a = objects[i], *b = objects[j];
        if (reported.contains({a, b}) || reported.contains({b, a}) || !spheres_meet(*a, *b)) continue;
        if (option.collisionFilter && option.collisionFilter->ignoresCollision(a, b)) continue;
        if (!a->body().ground || !b->body().ground) write_pair(*a, *b, {});
      }
    }
    for (const auto& [pair, points] : reported) write_pair(*pair.first, *pair.second, points);
  }

  bool close() {
    if (record_.file != nullptr) good_ = pd_record_close(&record_) != 0 && good_;
    return good_;
  }
  [[nodiscard]] bool good() const { return good_ && record_.good != 0; }
  [[nodiscard]] std::int64_t contacts() const { return record_.contacts; }
  [[nodiscard]] std::int64_t unsupported() const { return unsupported_; }

 private:
  bool open(const std::string& engine) {
    return pd_record_open(&record_, path_.c_str(), engine.c_str(), PD_RECORD_FLOAT64, nullptr) != 0;
  }

  /// pdepth's objects for the frames of a group.
  DartGroup& group_of_these(const dart::collision::CollisionGroup& group) {
    group_ = detector_->createCollisionGroup();
    for (std::size_t i = 0; i < group.getNumShapeFrames(); ++i) group_->addShapeFrame(group.getShapeFrame(i));
    return static_cast<DartGroup&>(*group_);
  }

  void write_pair(const DartObject& a, const DartObject& b, const std::vector<RecordedPoint>& points) {
    if (a.refusal() || b.refusal()) {
      ++unsupported_;
      return;
    }
    const std::string first = id_of(a), second = id_of(b);
    record_pair(record_, {first.c_str(), pose_of(a)}, {second.c_str(), pose_of(b)}, points);
  }

  /// The id of an object's shape, which is written if it is new: each version of a shape once.
  std::string id_of(const DartObject& object) {
    const auto shape = object.getShape();
    const auto [place, is_new] =
        written_.try_emplace({shape->getID(), shape->getVersion()}, "s" + std::to_string(written_.size()));
    if (is_new && object.body().ground) {
      pd_record_plane(&record_, place->second.c_str(), object.body().ground->normal.data(),
                      object.body().ground->offset);
    } else if (is_new) {
      record_shape(record_, place->second, *object.body().shape);
    }
    return place->second;
  }

  static pd_record_pose pose_of(const DartObject& object) {
    pd_record_pose pose{};
    pose.rotation = PD_RECORD_MATRIX;
    const Eigen::Isometry3d& place = object.getTransform();
    for (int i = 0; i < 3; ++i) pose.translation[i] = place.translation()[i];
    for (int i = 0; i < 9; ++i) pose.matrix_row_major[i] = place.linear()(i / 3, i % 3);
    return pose;
  }

  std::string path_;
  pd_record record_{};
  bool good_ = false;
  bool named_ = false;
  std::int64_t unsupported_ = 0;
  std::shared_ptr<DartDetector> detector_ = DartDetector::create({.warning = nullptr});
  std::unique_ptr<dart::collision::CollisionGroup> group_;
  std::map<std::pair<std::size_t, std::size_t>, std::string> written_;  ///< by the shape's id and version
};

}  // namespace detail

DartRecorder::DartRecorder(const char* path) : record_(std::make_unique<detail::DartRecord>(path)) {}
DartRecorder::~DartRecorder() { close(); }

void DartRecorder::write(dart::collision::CollisionGroup& group, const dart::collision::CollisionOption& option,
                         double seconds) {
  record_->write(group, option, seconds);
}

bool DartRecorder::close() { return record_->close(); }
bool DartRecorder::good() const { return record_->good(); }
std::int64_t DartRecorder::contacts() const { return record_->contacts(); }
std::int64_t DartRecorder::unsupported() const { return record_->unsupported(); }

}  // namespace pd
