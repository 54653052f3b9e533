#include "pair_contacts.hpp"

#include <algorithm>

namespace pd::detail {

namespace {

/// First geoms whose pairs are remembered. Beyond so many, all are forgotten at once.
constexpr std::size_t kRememberedGeoms = 20000;

/// ODE knows no margin: corners of faces that meet count up to this gap, with depth 0. In radii of the smaller body.
constexpr double kSlack = 1e-4;

Vec3 half_extents_of(const KeptBodies::Body& box) { return {box.size[0], box.size[1], box.size[2]}; }

}  // namespace

OdePairContacts::Asked OdePairContacts::ask_geom(dGeomID geom) {
  Asked asked;
  const auto refuse = [&](OdeRefusal kind, const std::string& reason) {
    asked.refusal = NamedOdeRefusal{kind, name_of(geom) + ": " + reason};
    return asked;
  };
  const auto pose = geom_pose(geom);
  if (!pose) return refuse(OdeRefusal::pose, "its pose: " + pose.error().message);
  asked.pose = *pose;
  const auto numbers = geom_numbers(geom);
  if (!numbers) return refuse(OdeRefusal::convex, numbers.error().message);
  asked.body = &bodies_.find(numbers->key, numbers->numbers);
  if (!asked.body->shape) {
    const Error& error = asked.body->shape.error();
    const bool hull = asked.body->kind == BodyKind::hull;
    return refuse(hull ? OdeRefusal::convex : OdeRefusal::size, error.where + ": " + error.message);
  }
  if (!is_in_its_box(geom, *numbers, asked.pose)) {
    return refuse(OdeRefusal::convex, "its box is not that of the points that pd::ode_convex was told");
  }
  return asked;
}

std::optional<NamedOdeRefusal> OdePairContacts::ask_on_plane(dGeomID body, dGeomID plane) {
  const auto ground = plane_of(plane);
  if (!ground) return NamedOdeRefusal{OdeRefusal::size, name_of(plane) + ": " + ground.error().message};
  const Asked asked = ask_geom(body);
  if (asked.refusal) return asked.refusal;
  points_ = pairs_.on_ground(
      {.body = asked.posed(), .ground = *ground, .slack = kSlack * asked.body->radius, .size = asked.body->radius});
  return std::nullopt;
}

std::optional<NamedOdeRefusal> OdePairContacts::ask(dGeomID first, dGeomID second, const OdeOptions& options) {
  points_.count = 0;
  bodies_.begin_pair();
  if (dGeomGetClass(second) == dPlaneClass) return ask_on_plane(first, second);
  const Asked a = ask_geom(first);
  if (a.refusal) return a.refusal;
  const Asked b = ask_geom(second);
  if (b.refusal) return b.refusal;
  const double size = std::min(a.body->radius, b.body->radius);
  PairOfBodies pair{.a = a.posed(),
                    .b = b.posed(),
                    .slack = kSlack * size,
                    .size = size,
                    .delta = options.delta,
                    .memory = options.remember_pairs ? memory_of(first, second) : nullptr};
  if (a.body->kind == BodyKind::box && b.body->kind == BodyKind::box) {
    pair.boxes = {half_extents_of(*a.body), half_extents_of(*b.body)};
  }
  points_ = pairs_.of_bodies(pair);
  return std::nullopt;
}

WarmCertificate* OdePairContacts::memory_of(dGeomID first, dGeomID second) {
  if (memories_.size() >= kRememberedGeoms && !memories_.contains(first)) memories_.clear();
  return &memories_[first][second];
}

}  // namespace pd::detail
