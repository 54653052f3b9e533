#include "pd/mujoco/contact_recorder.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "collision_table.hpp"
#include "geom_shape.hpp"
#include "pair_record.hpp"
#include "pd/record/record_shape.hpp"

namespace pd {

namespace detail {

namespace {

pd_record_pose to_record(const mjData& data, int geom) {
  pd_record_pose pose{};
  pose.rotation = PD_RECORD_MATRIX;
  for (int i = 0; i < 3; ++i) pose.translation[i] = static_cast<double>(data.geom_xpos[3 * geom + i]);
  for (int i = 0; i < 9; ++i) pose.matrix_row_major[i] = static_cast<double>(data.geom_xmat[9 * geom + i]);
  return pose;
}

}  // namespace

class RecordedModel {
 public:
  RecordedModel(const mjModel& model, const char* path) : model_(model) {
    good_ = pd_record_open(&record_, path, ("MuJoCo " + std::string(mj_versionString())).c_str(),
                           sizeof(mjtNum) == sizeof(float) ? PD_RECORD_FLOAT32 : PD_RECORD_FLOAT64, nullptr) != 0;
    record_.has_time = 1;
  }

  void write(const mjData& data, int geom1, int geom2, const CollisionContact* contacts, int count) {
    const std::scoped_lock lock(mutex_);
    const auto a = shape_id(geom1), b = shape_id(geom2);
    if (!a || !b || !geom_pose(data, geom1) || !geom_pose(data, geom2)) {
      ++unsupported_;
      return;
    }
    record_.time = static_cast<double>(data.time);
    std::vector<RecordedPoint> points;
    for (int i = 0; i < count; ++i) {
      const CollisionContact& contact = contacts[i];
      const Vec3 normal = vector_of(normal_of(contact)), middle = vector_of(contact.pos);
      const auto half = static_cast<double>(contact.dist) / 2;
      points.push_back({middle - half * normal, middle + half * normal, -2 * half, -normal});
    }
    record_pair(record_, {a->c_str(), to_record(data, geom1)}, {b->c_str(), to_record(data, geom2)}, points);
  }

  bool close() {
    const std::scoped_lock lock(mutex_);
    if (record_.file != nullptr) good_ = pd_record_close(&record_) != 0 && good_;
    return good_;
  }
  [[nodiscard]] const mjModel& model() const { return model_; }
  [[nodiscard]] bool good() const {
    const std::scoped_lock lock(mutex_);
    return good_ && record_.good != 0;
  }
  [[nodiscard]] std::int64_t contacts() const {
    const std::scoped_lock lock(mutex_);
    return record_.contacts;
  }
  [[nodiscard]] std::int64_t unsupported() const {
    const std::scoped_lock lock(mutex_);
    return unsupported_;
  }

 private:
  static Vec3 vector_of(const mjtNum* numbers) {
    return {static_cast<double>(numbers[0]), static_cast<double>(numbers[1]), static_cast<double>(numbers[2])};
  }

  /// The id of a geom's shape, which is written if it is new; nothing if the geom has no shape.
  std::optional<std::string> shape_id(int geom) {
    if (model_.geom_type[geom] == mjGEOM_PLANE) {
      if (!plane_written_) {
        const double up[3] = {0, 0, 1};
        pd_record_plane(&record_, "plane", up, 0);
        plane_written_ = true;
      }
      return "plane";
    }
    std::int64_t conversions = 0;
    const GeomShape& shape = shapes_.find(model_, geom, conversions);
    if (!shape.body) return std::nullopt;
    for (std::size_t i = 0; i < written_.size(); ++i) {
      if (written_[i].get() == &shape) return "s" + std::to_string(i);
    }
    written_.push_back(shared_shape(model_, geom));
    std::string id = "s" + std::to_string(written_.size() - 1);
    record_shape(record_, id, *shape.body);
    return id;
  }

  const mjModel& model_;
  mutable std::mutex mutex_;  ///< guards what follows
  pd_record record_{};
  bool good_ = false;
  bool plane_written_ = false;
  GeomShapes shapes_;
  std::vector<std::shared_ptr<const GeomShape>> written_;  ///< by id
  std::int64_t unsupported_ = 0;
};

namespace {

/// The models that are being recorded. MuJoCo's table belongs to the whole process.
struct Recordings {
  std::mutex mutex;
  std::map<const mjModel*, RecordedModel*> models;
  ReplacedEntries entries;

  static Recordings& instance() {
    static Recordings recordings;
    return recordings;
  }
  RecordedModel* find(const mjModel* model) {
    const std::scoped_lock lock(mutex);
    const auto found = models.find(model);
    return found == models.end() ? nullptr : found->second;
  }
};

int collide_and_record(const mjModel* model, CollisionData* data, CollisionContact* contacts, int geom1, int geom2,
                       mjtNum margin) {
  Recordings& recordings = Recordings::instance();
  const mjfCollision before = recordings.entries.before(model->geom_type[geom1], model->geom_type[geom2]);
  const int count = before(model, data, contacts, geom1, geom2, margin);
  if (RecordedModel* recorded = recordings.find(model)) recorded->write(*data, geom1, geom2, contacts, count);
  return count;
}

}  // namespace

ReplacedEntries& recorder_entries() { return Recordings::instance().entries; }

}  // namespace detail

MujocoRecorder::MujocoRecorder(const mjModel* model, const char* path) {
  detail::Recordings& recordings = detail::Recordings::instance();
  const std::scoped_lock lock(recordings.mutex);
  if (recordings.models.contains(model)) return;
  auto recorded = std::make_unique<detail::RecordedModel>(*model, path);
  if (!recorded->good()) return;
  model_ = std::move(recorded);
  recordings.models.emplace(model, model_.get());
  recordings.entries.put(&detail::collide_and_record);
}

MujocoRecorder::~MujocoRecorder() { close(); }

bool MujocoRecorder::close() {
  if (!model_) return false;
  detail::Recordings& recordings = detail::Recordings::instance();
  {
    const std::scoped_lock lock(recordings.mutex);
    const auto found = recordings.models.find(&model_->model());
    if (found != recordings.models.end() && found->second == model_.get()) recordings.models.erase(found);
    if (recordings.models.empty()) recordings.entries.put_back();
  }
  return model_->close();
}

bool MujocoRecorder::good() const { return model_ && model_->good(); }
std::int64_t MujocoRecorder::contacts() const { return model_ ? model_->contacts() : 0; }
std::int64_t MujocoRecorder::unsupported() const { return model_ ? model_->unsupported() : 0; }

bool record_mujoco(const mjModel* model, const mjData* data, const char* path) {
  // MuJoCo's collision starts by forgetting the contacts and the forces that stand on them, so it works on a copy.
  mjData* copy = mj_makeData(model);
  if (copy == nullptr) return false;
  mj_copyData(copy, model, data);
  MujocoRecorder recorder(model, path);
  if (recorder.good()) mj_collision(model, copy);
  mj_deleteData(copy);
  return recorder.close();
}

}  // namespace pd
