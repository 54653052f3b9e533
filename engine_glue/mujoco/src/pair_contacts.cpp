#include "pair_contacts.hpp"

#include <algorithm>

namespace pd::detail {

namespace {

/// Models whose pairs are remembered. Beyond so many, all are forgotten at once.
constexpr std::size_t kRememberedModels = 16;

NamedRefusal pose_refused(const GeomPair& pair, int geom, const Error& error) {
  return {MujocoRefusal::pose, "the pose of " + name_of(*pair.model, geom) + ": " + error.message};
}

NamedRefusal shape_refused(const GeomPair& pair, int geom, const Error& error) {
  const bool mesh = pair.model->geom_type[geom] == mjGEOM_MESH;
  return {mesh ? MujocoRefusal::mesh : MujocoRefusal::size,
          name_of(*pair.model, geom) + ", " + error.where + ": " + error.message};
}

Vec3 half_extents_of(const GeomPair& pair, int geom) {
  const mjtNum* size = pair.model->geom_size + 3 * geom;
  return {static_cast<double>(size[0]), static_cast<double>(size[1]), static_cast<double>(size[2])};
}

}  // namespace

std::optional<NamedRefusal> PairContacts::ask(const GeomPair& pair, const MujocoOptions& options) {
  points_.count = 0;
  const auto pose1 = geom_pose(*pair.data, pair.geom1);
  if (!pose1) return pose_refused(pair, pair.geom1, pose1.error());
  const auto pose2 = geom_pose(*pair.data, pair.geom2);
  if (!pose2) return pose_refused(pair, pair.geom2, pose2.error());
  const GeomShape& second = shapes_.find(*pair.model, pair.geom2, conversions_);
  if (!second.body) return shape_refused(pair, pair.geom2, second.body.error());
  const PosedShape b{&*second.body, *pose2};
  if (pair.model->geom_type[pair.geom1] == mjGEOM_PLANE) {
    // MuJoCo's plane is the half-space below its local z.
    const Vec3 up = pose1->rotation().col(2);
    points_ = pairs_.on_ground(
        {.body = b, .ground = {up, up.dot(pose1->translation())}, .margin = pair.margin, .size = second.radius});
    PairPoints::exchange(points_);
    return std::nullopt;
  }
  const GeomShape& first = shapes_.find(*pair.model, pair.geom1, conversions_);
  if (!first.body) return shape_refused(pair, pair.geom1, first.body.error());
  PairOfBodies bodies{.a = {&*first.body, *pose1},
                      .b = b,
                      .margin = pair.margin,
                      .size = std::min(first.radius, second.radius),
                      .delta = options.delta,
                      .memory = options.remember_pairs ? memory_of(pair) : nullptr};
  if (first.source.type == mjGEOM_BOX && second.source.type == mjGEOM_BOX) {
    bodies.boxes = {half_extents_of(pair, pair.geom1), half_extents_of(pair, pair.geom2)};
  }
  points_ = pairs_.of_bodies(bodies);
  return std::nullopt;
}

WarmCertificate* PairContacts::memory_of(const GeomPair& pair) {
  if (memories_.size() >= kRememberedModels && !memories_.contains(pair.model)) memories_.clear();
  const auto key = static_cast<std::uint64_t>(pair.geom1) << 32 | static_cast<std::uint32_t>(pair.geom2);
  return &memories_[pair.model][key];
}

}  // namespace pd::detail
