/// @file
/// Contact points of two bodies, or of a body on a plane, for engines that take up to four points a pair and want the
/// same four from step to step.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "pd/contact/box_contact.hpp"
#include "pd/contact/halfspace_contact.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

/// Two bodies, and the margin within which their contacts are wanted. Lengths are in the engine's unit.
struct PairOfBodies {
  PosedShape a, b;
  double margin = 0;  ///< below 0: only points that are deeper than that
  /// Beyond the margin: if the bodies meet, points that miss each other by so much count, too. For engines without a
  /// margin, whose bodies would lose a corner to rounding and topple.
  double slack = 0;
  double size = 0;                    ///< radius of the smaller body
  double delta = 0;                   ///< of `DepthSettings`
  WarmCertificate* memory = nullptr;  ///< of the pair, or null
  /// The half extents of A and of B, if both are boxes about the origins of their frames.
  std::optional<std::array<Vec3, 2>> boxes = std::nullopt;
};

/// A body on the ground, with the words of `PairOfBodies`.
struct BodyOnGround {
  PosedShape body;
  Halfspace3 ground;
  double margin = 0;
  double slack = 0;
  double size = 0;  ///< radius of the body
};

/// The answers of one thread, with its buffers.
class PairPoints {
 public:
  PairPoints() = default;

  /// The contact points of two bodies. The normal points from B to A.
  const ContactManifold& of_bodies(const PairOfBodies& pair) {
    points_.count = 0;
    if (!pair.boxes || !two_boxes(pair)) two_bodies(pair);
    drop_beyond(pair.margin, pair.slack);
    return points_;
  }

  /// The contact points of a body, A, on the ground, B, whose normal is the contact's.
  const ContactManifold& on_ground(const BodyOnGround& pair) {
    HalfspaceContact found;
    const double threshold = within(pair.margin) + pair.slack;
    points_ = steady_four(threshold, pair.size, [&](double reach) {
      found = halfspace_contact(pair.body, pair.ground, reach, manifold_);
      return found.manifold;
    });
    correct_deepest(found.lower + (found.upper - found.lower) / 2);
    drop_beyond(pair.margin, pair.slack);
    return points_;
  }

  /// Exchanges the names of A and B.
  static void exchange(ContactManifold& points) {
    for (ContactPoint& point : points.points) std::swap(point.position_a, point.position_b);
    points.normal = -points.normal;
  }

 private:
  /// Four of many points are chosen by their depths. Differences below a thousandth of the reach do not sway the choice
  /// then, so that a body at rest keeps its points from step to step. In radii of the smaller body.
  static constexpr double kSteadyReach = 0.02;

  /// The largest gap of a contact, which is never negative.
  static double within(double margin) { return std::max(0.0, margin); }

  /// The points up to a threshold, chosen so that small changes of depth do not change the choice.
  /// @param points_within  the contact points up to a threshold.
  template <class Points>
  static ContactManifold steady_four(double threshold, double size, Points&& points_within) {
    ContactManifold nearest = points_within(threshold);
    if (nearest.count < 4) return nearest;
    ContactManifold steady = points_within(threshold + kSteadyReach * size);
    const auto last = steady.points.begin() + steady.count;
    const bool all_meet =
        std::all_of(steady.points.begin(), last, [&](const ContactPoint& point) { return -point.depth <= threshold; });
    return steady.count == 4 && all_meet ? steady : nearest;
  }

  /// @return false if the general query has to answer
  bool two_boxes(const PairOfBodies& pair) {
    const BoxInRows a = in_rows({(*pair.boxes)[0], &pair.a.pose}), b = in_rows({(*pair.boxes)[1], &pair.b.pose});
    const double threshold = within(pair.margin) + pair.slack;
    BoxContact found = box_contact(a, b, 0, threshold);
    if (!found.answered) return false;
    points_ = steady_four(threshold, pair.size, [&](double reach) {
      return reach == threshold ? found.manifold : box_contact(a, b, 0, reach).manifold;
    });
    correct_deepest(found.lower + (found.upper - found.lower) / 2);
    return true;
  }

  void two_bodies(const PairOfBodies& pair) {
    DepthSettings settings{.bracket = Bracket::contact, .delta = pair.delta, .beyond = within(pair.margin)};
    PenetrationDepth depth = penetration_depth(pair.a, pair.b, scratch_, settings, pair.memory);
    // Curved bodies deep inside each other may spend the budget of an engine's step.
    if (!depth.bracket_reached) {
      settings.bracket = Bracket::certified;
      depth = penetration_depth(pair.a, pair.b, scratch_, settings);
    }
    if (depth.contact == ContactClass::separated && depth.distance_lower > settings.beyond) return;
    points_ = steady_four(within(pair.margin) + pair.slack, pair.size, [&](double threshold) {
      return contact_manifold(pair.a, pair.b, depth, threshold, manifold_, DeepestPoint::at_depth);
    });
    if (points_.count == 0 && depth.signed_distance() <= settings.beyond) {
      points_.normal = depth.normal;
      points_.points[0] = {depth.witness_a, depth.witness_b, -depth.signed_distance(), 0};
      points_.count = 1;
    }
  }

  /// Gives the deepest point the exact distance of the bodies.
  void correct_deepest(double signed_distance) {
    const auto last = points_.points.begin() + points_.count;
    const auto deepest =
        std::max_element(points_.points.begin(), last, [](const auto& p, const auto& q) { return p.depth < q.depth; });
    if (deepest != last) deepest->depth = -signed_distance;
  }

  /// A margin below 0 asks for the points that are deeper than it. Slack is for bodies that meet.
  void drop_beyond(double margin, double slack) {
    const auto first = points_.points.begin(), last = first + points_.count;
    const bool meet = std::any_of(first, last, [&](const ContactPoint& point) { return -point.depth <= margin; });
    const double farthest = meet ? margin + slack : margin;
    const auto end = std::remove_if(first, last, [&](const ContactPoint& point) { return -point.depth > farthest; });
    points_.count = static_cast<int>(end - first);
  }

  Scratch scratch_;
  ManifoldScratch manifold_;
  ContactManifold points_;
};

}  // namespace pd::detail
