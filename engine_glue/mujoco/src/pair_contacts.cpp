#include "pair_contacts.hpp"

#include <algorithm>

#include "pd/contact/box_contact.hpp"
#include "pd/contact/halfspace_contact.hpp"

namespace pd::detail {

namespace {

/// Models whose pairs are remembered. Beyond so many, all are forgotten at once.
constexpr std::size_t kRememberedModels = 16;

/// Four of many points are chosen by their depths. Differences below a thousandth of the reach do not sway the choice
/// then, so that a body at rest keeps its points from step to step. In radii of the smaller body.
constexpr double kSteadyReach = 0.02;

NamedRefusal pose_refused(const GeomPair& pair, int geom, const Error& error) {
  return {MujocoRefusal::pose, "the pose of " + name_of(*pair.model, geom) + ": " + error.message};
}

NamedRefusal shape_refused(const GeomPair& pair, int geom, const Error& error) {
  const bool mesh = pair.model->geom_type[geom] == mjGEOM_MESH;
  return {mesh ? MujocoRefusal::mesh : MujocoRefusal::size,
          name_of(*pair.model, geom) + ", " + error.where + ": " + error.message};
}

BoxInRows box_of(const GeomPair& pair, int geom, const Pose& pose) {
  const mjtNum* size = pair.model->geom_size + 3 * geom;
  return in_rows({{static_cast<double>(size[0]), static_cast<double>(size[1]), static_cast<double>(size[2])}, &pose});
}

}  // namespace

std::optional<NamedRefusal> PairContacts::ask(GeomPair pair, const MujocoOptions& options) {
  points_.count = 0;
  const auto pose1 = geom_pose(*pair.data, pair.geom1);
  if (!pose1) return pose_refused(pair, pair.geom1, pose1.error());
  const auto pose2 = geom_pose(*pair.data, pair.geom2);
  if (!pose2) return pose_refused(pair, pair.geom2, pose2.error());
  const GeomShape& second = shapes_.find(*pair.model, pair.geom2, conversions_);
  if (!second.body) return shape_refused(pair, pair.geom2, second.body.error());
  const PosedShape b{&*second.body, *pose2};
  pair.size = second.radius;
  if (pair.model->geom_type[pair.geom1] == mjGEOM_PLANE) {
    body_on_plane(pair, b, *pose1);
  } else {
    const GeomShape& first = shapes_.find(*pair.model, pair.geom1, conversions_);
    if (!first.body) return shape_refused(pair, pair.geom1, first.body.error());
    const PosedShape a{&*first.body, *pose1};
    pair.size = std::min(first.radius, second.radius);
    if (first.source.type == mjGEOM_BOX && second.source.type == mjGEOM_BOX) {
      two_boxes(pair, options, a, b);
    } else {
      two_bodies(pair, options, a, b);
    }
  }
  // A margin below 0 asks for the points that are deeper than it.
  const auto end = std::remove_if(points_.points.begin(), points_.points.begin() + points_.count,
                                  [&](const ContactPoint& point) { return -point.depth > pair.margin; });
  points_.count = static_cast<int>(end - points_.points.begin());
  return std::nullopt;
}

double PairContacts::within_margin(const GeomPair& pair) { return std::max(0.0, pair.margin); }

template <class Points>
ContactManifold PairContacts::steady_four(const GeomPair& pair, Points&& points_within) {
  ContactManifold nearest = points_within(within_margin(pair));
  if (nearest.count < 4) return nearest;
  ContactManifold steady = points_within(within_margin(pair) + kSteadyReach * pair.size);
  const auto last = steady.points.begin() + steady.count;
  const bool all_meet =
      std::all_of(steady.points.begin(), last, [&](const ContactPoint& point) { return -point.depth <= pair.margin; });
  return steady.count == 4 && all_meet ? steady : nearest;
}

void PairContacts::two_boxes(const GeomPair& pair, const MujocoOptions& options, const PosedShape& a,
                             const PosedShape& b) {
  const BoxInRows box1 = box_of(pair, pair.geom1, a.pose), box2 = box_of(pair, pair.geom2, b.pose);
  BoxContact found = box_contact(box1, box2, 0, within_margin(pair));
  if (!found.answered) {
    two_bodies(pair, options, a, b);
    return;
  }
  points_ = steady_four(pair, [&](double threshold) {
    return threshold == within_margin(pair) ? found.manifold : box_contact(box1, box2, 0, threshold).manifold;
  });
  correct_deepest(found.lower + (found.upper - found.lower) / 2);
}

void PairContacts::two_bodies(const GeomPair& pair, const MujocoOptions& options, const PosedShape& a,
                              const PosedShape& b) {
  DepthSettings settings{.bracket = Bracket::contact, .delta = options.delta, .beyond = within_margin(pair)};
  WarmCertificate* memory = options.remember_pairs ? memory_of(pair) : nullptr;
  PenetrationDepth depth = penetration_depth(a, b, scratch_, settings, memory);
  // Curved bodies deep inside each other may spend the budget of an engine's step.
  if (!depth.bracket_reached) {
    settings.bracket = Bracket::certified;
    depth = penetration_depth(a, b, scratch_, settings);
  }
  if (depth.contact == ContactClass::separated && depth.distance_lower > settings.beyond) return;
  points_ = steady_four(pair, [&](double threshold) {
    return contact_manifold(a, b, depth, threshold, manifold_, DeepestPoint::at_depth);
  });
  if (points_.count == 0 && depth.signed_distance() <= settings.beyond) {
    points_.normal = depth.normal;
    points_.points[0] = {depth.witness_a, depth.witness_b, -depth.signed_distance(), 0};
    points_.count = 1;
  }
}

void PairContacts::body_on_plane(const GeomPair& pair, const PosedShape& body, const Pose& plane) {
  // MuJoCo's plane is the half-space below its local z.
  const Vec3 up = plane.rotation().col(2);
  const Halfspace3 ground{up, up.dot(plane.translation())};
  HalfspaceContact found;
  points_ = steady_four(pair, [&](double threshold) {
    found = halfspace_contact(body, ground, threshold, manifold_);
    return found.manifold;
  });
  for (ContactPoint& point : points_.points) std::swap(point.position_a, point.position_b);
  points_.normal = -points_.normal;
  correct_deepest(found.lower + (found.upper - found.lower) / 2);
}

void PairContacts::correct_deepest(double signed_distance) {
  const auto last = points_.points.begin() + points_.count;
  const auto deepest =
      std::max_element(points_.points.begin(), last, [](const auto& p, const auto& q) { return p.depth < q.depth; });
  if (deepest != last) deepest->depth = -signed_distance;
}

WarmCertificate* PairContacts::memory_of(const GeomPair& pair) {
  if (memories_.size() >= kRememberedModels && !memories_.contains(pair.model)) memories_.clear();
  const auto key = static_cast<std::uint64_t>(pair.geom1) << 32 | static_cast<std::uint32_t>(pair.geom2);
  return &memories_[pair.model][key];
}

}  // namespace pd::detail
