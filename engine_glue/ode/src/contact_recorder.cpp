#include "pd/ode/contact_recorder.hpp"

#include <utility>

#include "contact_record.hpp"
#include "geom_body.hpp"
#include "installed.hpp"
#include "own_colliders.hpp"
#include "pd/record/record_shape.hpp"

namespace pd {

namespace detail {

namespace {

/// ODE's own colliders give at most so many contacts of a pair; a caller of `dCollide` chooses its own number.
constexpr int kContactsOfPair = 64;

void collide_all(void* /*data*/, dGeomID first, dGeomID second) {
  if (dGeomIsSpace(first) != 0 || dGeomIsSpace(second) != 0) {
    dSpaceCollide2(first, second, nullptr, &collide_all);
    return;
  }
  dContactGeom contacts[kContactsOfPair];
  dCollide(first, second, kContactsOfPair, contacts, sizeof(dContactGeom));
}

/// Pairs inside a space, and inside of each space in it.
void collide_inside(dSpaceID space) {
  dSpaceCollide(space, nullptr, &collide_all);
  for (int i = 0; i < dSpaceGetNumGeoms(space); ++i) {
    const dGeomID geom = dSpaceGetGeom(space, i);
    if (dGeomIsSpace(geom) != 0) collide_inside(reinterpret_cast<dSpaceID>(geom));
  }
}

}  // namespace

OdeRecord::OdeRecord(const char* path) {
  good_ = pd_record_open(&record_, path, "ODE", sizeof(dReal) == sizeof(float) ? PD_RECORD_FLOAT32 : PD_RECORD_FLOAT64,
                         nullptr) != 0;
}

std::pair<std::string, bool> OdeRecord::id_of(std::vector<double> numbers) {
  const auto [place, is_new] = written_.try_emplace(std::move(numbers), "s" + std::to_string(written_.size()));
  return {place->second, is_new};
}

std::optional<OdeRecord::Known> OdeRecord::known_plane(dGeomID geom) {
  const auto plane = plane_of(geom);
  if (!plane) return std::nullopt;
  const Vec3& n = plane->normal;
  const auto [id, is_new] = id_of({-1, n.x(), n.y(), n.z(), plane->offset});
  if (is_new) pd_record_plane(&record_, id.c_str(), n.data(), plane->offset);
  return Known{id, pd_record_pose{}};
}

std::optional<OdeRecord::Known> OdeRecord::known(dGeomID geom) {
  if (dGeomGetClass(geom) == dPlaneClass) return known_plane(geom);
  const auto pose = geom_pose(geom);
  const auto found = geom_numbers(geom);
  if (!pose || !found || !is_in_its_box(geom, *found, *pose)) return std::nullopt;
  const KeptBodies::Body& body = bodies_.find(found->key, found->numbers);
  if (!body.shape) return std::nullopt;
  std::vector<double> numbers{static_cast<double>(body.kind), body.size[0], body.size[1], body.size[2]};
  numbers.insert(numbers.end(), body.points.begin(), body.points.end());
  const auto [id, is_new] = id_of(std::move(numbers));
  if (is_new) record_shape(record_, id, *body.shape);
  Known known{id, {}};
  known.pose.rotation = PD_RECORD_MATRIX;
  const dReal* place = dGeomGetPosition(geom);
  const dReal* rows = dGeomGetRotation(geom);
  for (int i = 0; i < 3; ++i) known.pose.translation[i] = static_cast<double>(place[i]);
  for (int i = 0; i < 9; ++i) known.pose.matrix_row_major[i] = static_cast<double>(rows[i / 3 * 4 + i % 3]);
  return known;
}

void OdeRecord::write(dGeomID first, dGeomID second, dContactGeom* contacts, int skip, int count) {
  const std::scoped_lock lock(mutex_);
  bodies_.begin_pair();
  const auto a = known(first), b = known(second);
  if (!a || !b) {
    ++unsupported_;
    return;
  }
  std::vector<RecordedPoint> points;
  for (int i = 0; i < count; ++i) {
    const dContactGeom& contact = contact_at(contacts, skip, i);
    const Vec3 normal(static_cast<double>(contact.normal[0]), static_cast<double>(contact.normal[1]),
                      static_cast<double>(contact.normal[2]));
    const Vec3 middle(static_cast<double>(contact.pos[0]), static_cast<double>(contact.pos[1]),
                      static_cast<double>(contact.pos[2]));
    const auto depth = static_cast<double>(contact.depth);
    points.push_back({middle - depth / 2 * normal, middle + depth / 2 * normal, depth, normal});
  }
  record_pair(record_, {a->id.c_str(), a->pose}, {b->id.c_str(), b->pose}, points);
}

void OdeRecord::set_time(double seconds) {
  const std::scoped_lock lock(mutex_);
  record_.time = seconds;
  record_.has_time = 1;
}

bool OdeRecord::close() {
  const std::scoped_lock lock(mutex_);
  if (record_.file != nullptr) good_ = pd_record_close(&record_) != 0 && good_;
  return good_;
}

bool OdeRecord::good() const {
  const std::scoped_lock lock(mutex_);
  return good_ && record_.good != 0;
}

std::int64_t OdeRecord::contacts() const {
  const std::scoped_lock lock(mutex_);
  return record_.contacts;
}

std::int64_t OdeRecord::unsupported() const {
  const std::scoped_lock lock(mutex_);
  return unsupported_;
}

}  // namespace detail

OdeRecorder::OdeRecorder(const char* path) {
  detail::InstalledOde& installed = detail::InstalledOde::instance();
  if (installed.record() != nullptr) return;
  auto record = std::make_unique<detail::OdeRecord>(path);
  if (record->good() && installed.begin_record(record.get())) record_ = std::move(record);
}

OdeRecorder::~OdeRecorder() { close(); }

void OdeRecorder::set_time(double seconds) {
  if (record_) record_->set_time(seconds);
}

bool OdeRecorder::close() {
  if (!record_) return false;
  detail::InstalledOde::instance().end_record(record_.get());
  return record_->close();
}

bool OdeRecorder::good() const { return record_ && record_->good(); }
std::int64_t OdeRecorder::contacts() const { return record_ ? record_->contacts() : 0; }
std::int64_t OdeRecorder::unsupported() const { return record_ ? record_->unsupported() : 0; }

bool record_ode(dSpaceID space, const char* path) {
  OdeRecorder recorder(path);
  if (recorder.good()) detail::collide_inside(space);
  return recorder.close();
}

}  // namespace pd
