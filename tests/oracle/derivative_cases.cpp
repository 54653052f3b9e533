#include "oracle/derivative_cases.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "pd/depth/minkowski_difference.hpp"

namespace pd::oracle {

namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random);
}

Vec3 direction(Random& random) {
  std::normal_distribution<double> normal;
  const double z = normal(random), y = normal(random);
  return Vec3(normal(random), y, z).normalized();
}

Vec3 vector(Random& random, double shortest, double longest) {
  const Vec3 unit = direction(random);
  return uniform(random, shortest, longest) * unit;
}

Mat3 rotation(Random& random) {
  std::normal_distribution<double> normal;
  const double z = normal(random), y = normal(random), x = normal(random);
  return Eigen::Quaterniond(normal(random), x, y, z).normalized().toRotationMatrix();
}

ConvexShape hull(Random& random) {
  const int n = 4 + static_cast<int>(random() % 20);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(direction(random).cwiseProduct(Vec3(1, .8, .6)));
  return *ConvexPolytope::from_points(points);
}

ConvexShape box(const Vec3& half) { return *ConvexPolytope::box(half); }

ConvexShape polytope(Random& random) {
  if (random() % 3 == 0) return box({uniform(random, .3, 1), uniform(random, .3, 1), uniform(random, .3, 1)});
  return hull(random);
}

ConvexShape round_body(Random& random) {
  const int axis = static_cast<int>(random() % 3);
  if (random() % 2 == 0) return *ConvexShape::sphere(uniform(random, .3, 1));
  const double half_length = uniform(random, .2, .8);
  return *ConvexShape::capsule(uniform(random, .2, .6), half_length, axis);
}

ConvexShape curved(Random& random) {
  const int axis = static_cast<int>(random() % 3);
  const double r = uniform(random, .3, .9), h = uniform(random, .3, .9);
  switch (random() % 4) {
    case 3: {
      std::vector<Sphere> spheres;
      for (int i = 0; i < 3 + axis; ++i) spheres.push_back({.7 * direction(random), uniform(random, 0, .6)});
      return *ConvexShape::hull_of_spheres(spheres);
    }
    case 0:
      return *ConvexShape::ellipsoid({uniform(random, .4, 1), uniform(random, .4, 1), uniform(random, .4, 1)});
    case 1:
      return *ConvexShape::cylinder(r, h, axis);
    default:
      return *ConvexShape::cone(r, h, axis);
  }
}

ConvexShape body(DerivativeFamily family, Random& random, bool first) {
  switch (family) {
    case DerivativeFamily::polytopes:
      return polytope(random);
    case DerivativeFamily::rounded:
      return *polytope(random).with_margin(uniform(random, .02, .3));
    case DerivativeFamily::round:
      return first ? round_body(random) : random() % 2 == 0 ? polytope(random) : round_body(random);
    case DerivativeFamily::curved:
      break;
  }
  if (first) return curved(random);
  return random() % 2 == 0 ? polytope(random) : curved(random);
}

const char* name(DerivativeFamily family) {
  constexpr std::array<const char*, 4> kNames{"polytopes", "rounded polytopes", "spheres, capsules", "curved"};
  return kNames[static_cast<std::size_t>(family)];
}

Pose moved(const Pose& pose, const Vec3& translation, const Vec3& turn) {
  const double angle = turn.norm();
  const Mat3 by = angle > 0 ? Mat3(Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()) : Mat3::Identity();
  return *Pose::from_matrix(by * pose.rotation(), pose.translation() + translation);
}

/// The pair with number `k` of the 12 changed by `step`.
PosedPairCase stepped(const PosedPairCase& pair, int k, double step) {
  PosedPairCase out = pair;
  const Vec3 by = step * Vec3::Unit(k % 3);
  const Vec3 shift = k % 6 < 3 ? by : Vec3::Zero();
  Pose& pose = k < 6 ? out.pose_a : out.pose_b;
  pose = moved(pose, shift, by - shift);
  return out;
}

PenetrationDepth answer_of(const PosedPairCase& pair, Scratch& scratch) {
  DepthSettings settings;
  if (!pair.a.polytope() || !pair.b.polytope()) settings.delta = 1e-12;
  return penetration_depth(pair.posed_a(), pair.posed_b(), scratch, settings);
}

/// Normal and witnesses as one vector.
using Nine = std::array<Vec3, 3>;

Nine features_of(const PosedPairCase& pair, Scratch& scratch) {
  const bool polytopes = pair.a.polytope() && pair.b.polytope();
  const PenetrationDepth answer =
      polytopes ? answer_of(pair, scratch) : depth_derivatives(pair.posed_a(), pair.posed_b(), scratch).answer;
  return {answer.normal, answer.witness_a, answer.witness_b};
}

bool same_features(const PenetrationDepth& x, const PenetrationDepth& y) {
  const auto same = [](const Feature& f, const Feature& g) {
    return f.kind == g.kind && std::minmax(f.first, f.second) == std::minmax(g.first, g.second);
  };
  return same(x.feature_a, y.feature_a) && same(x.feature_b, y.feature_b);
}

Vec3 claimed_feature(const DepthDerivatives& d, int which, int k) {
  const PoseJacobian* const by_a[3] = {&d.normal_by_a, &d.witness_a_by_a, &d.witness_b_by_a};
  const PoseJacobian* const by_b[3] = {&d.normal_by_b, &d.witness_a_by_b, &d.witness_b_by_b};
  const PoseJacobian& j = *(k < 6 ? by_a : by_b)[which];
  return (k % 6 < 3 ? j.translation : j.rotation).col(k % 3);
}

}  // namespace

PosedPairCase derivative_case(DerivativeFamily family, std::uint64_t seed, std::uint64_t index) {
  std::seed_seq sequence{seed, index, static_cast<std::uint64_t>(family)};
  Random random(sequence);
  ConvexShape a = body(family, random, true), b = body(family, random, false);
  if (random() % 2 == 0) std::swap(a, b);
  // Both bodies reach between .2 and 1.3 from their origins: from deep to well apart.
  const Vec3 offset = vector(random, .1, 2.2);
  const Vec3 place = vector(random, 0, 1);
  return {name(family), std::move(a), std::move(b), *Pose::from_matrix(rotation(random), place),
          *Pose::from_matrix(rotation(random), place + offset)};
}

bool runner_up_within(const PosedPairCase& pair, double gap, double step, Scratch& scratch) {
  const ConvexPolytope* const a = pair.a.polytope();
  const ConvexPolytope* const b = pair.b.polytope();
  if (!a || !b) return false;
  const PosedPairCase cores{pair.kind, *a, *b, pair.pose_a, pair.pose_b};
  const PenetrationDepth answer = answer_of(cores, scratch);
  if (answer.contact == ContactClass::separated) {
    // A distance below 100 steps is bent too sharply for differences of this step.
    if (answer.distance < 100 * step) return true;
    for (int k = 0; k < 12; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        if (!same_features(answer, answer_of(stepped(cores, k, sign * step), scratch))) return true;
      }
    }
    return false;
  }
  const Expected<MinkowskiDifference> p = minkowski_difference(*a, pair.pose_a, *b, pair.pose_b);
  std::vector<double> distances;
  for (const MinkowskiDifference::Facet& facet : p->facets) {
    const auto corner = static_cast<std::size_t>(p->corners[static_cast<std::size_t>(facet.first)]);
    distances.push_back(facet.normal.dot(p->vertices[corner].position));
  }
  if (distances.size() < 2) return true;
  std::partial_sort(distances.begin(), distances.begin() + 2, distances.end());
  return distances[1] - distances[0] < gap || distances[0] < gap;
}

GradientJudgement judge_gradient(const PosedPairCase& pair, double step, Scratch& scratch) {
  GradientJudgement judged;
  judged.derivatives = depth_derivatives(pair.posed_a(), pair.posed_b(), scratch);
  const DepthDerivatives& d = judged.derivatives;
  // A curved body's normal is known to sqrt(2e-12) radians: a wider step keeps that below the slope.
  const bool curved = !pair.a.polytope() || !pair.b.polytope();
  const double feature_step = curved ? 100 * step : step;
  const Nine here{d.answer.normal, d.answer.witness_a, d.answer.witness_b};
  double error = 0, size = 0, bend = 0, feature_error = 0, feature_size = 0, feature_bend = 0;
  for (int k = 0; k < 12; ++k) {
    const PoseGradient& side = k < 6 ? d.by_a : d.by_b;
    const double claimed = (k % 6 < 3 ? side.translation : side.rotation)[k % 3];
    double bends = 0;
    const auto slope_over = [&](double width) {
      const double more = -answer_of(stepped(pair, k, width), scratch).signed_distance();
      const double less = -answer_of(stepped(pair, k, -width), scratch).signed_distance();
      bends = (more - 2 * d.signed_depth + less) / width;
      return (more - less) / (2 * width);
    };
    // Richardson: a distance bends as 1 / distance, which a plain difference shows.
    const double central = (4 * slope_over(step / 2) - slope_over(step)) / 3;
    const bool exists = k % 6 < 3 ? d.unique_direction : d.unique_witness;
    if (exists) {
      error += (claimed - central) * (claimed - central);
      size += central * central;
      bend += bends * bends;
    }
    if (!d.stable_features) continue;
    const Nine ahead = features_of(stepped(pair, k, feature_step), scratch);
    const Nine behind = features_of(stepped(pair, k, -feature_step), scratch);
    for (int which = 0; which < 3; ++which) {
      const auto i = static_cast<std::size_t>(which);
      const Vec3 slope = (ahead[i] - behind[i]) / (2 * feature_step);
      feature_error += (slope - claimed_feature(d, which, k)).squaredNorm();
      feature_size += slope.squaredNorm();
      feature_bend += ((ahead[i] - 2 * here[i] + behind[i]) / feature_step).squaredNorm();
    }
  }
  judged.one_slope = bend <= 1e-4 * size;
  judged.one_feature_slope = feature_bend <= 1e-2 * feature_size;
  if (size > 0) judged.gradient_error = std::sqrt(error / size);
  if (!(error >= 0)) judged.gradient_error = std::numeric_limits<double>::infinity();
  if (feature_size > 0) judged.feature_error = std::sqrt(feature_error / feature_size);
  if (!(feature_error >= 0)) judged.feature_error = std::numeric_limits<double>::infinity();
  return judged;
}

namespace {

/// Two bodies as they stand in a frame of their own; the whole is then turned and shifted.
struct Arrangement {
  const char* kind;
  ConvexShape a;
  ConvexShape b;
  Mat3 turn_a = Mat3::Identity();
  Vec3 offset_a = Vec3::Zero();  ///< of A's origin from B's
  bool unique_direction = false;
  bool unique_witness = false;
};

Mat3 about(const Vec3& axis, double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

/// A box of half extents 1 as B, and a smaller body near its face z = 1 that reaches `low` below its origin.
Arrangement over_face(const char* kind, ConvexShape a, const Mat3& turn, double low, Random& random, bool unique) {
  const double size = uniform(random, .02, .2);
  const double signed_depth = random() % 2 == 0 ? size : -size;
  const double y = uniform(random, -.2, .2);
  const Vec3 offset(uniform(random, -.2, .2), y, 1 + low - signed_depth);
  return {kind, std::move(a), box({1, 1, 1}), turn, offset, true, unique};
}

/// A cube of half 1 around a body that reaches `half` along each axis, with depths by +x and +y that differ by `gap`.
Arrangement in_the_corner(const char* kind, ConvexShape a, double half, double gap, Random& random,
                          bool unique_witness) {
  const double depth = half + uniform(random, .1, .2);
  // Depth along +x: 1 + half - offset.x.
  const Vec3 offset(1 + half - depth, 1 + half - depth - gap, uniform(random, -.1, .1));
  return {kind, std::move(a), box({1, 1, 1}), Mat3::Identity(), offset, gap > 0, gap > 0 && unique_witness};
}

Arrangement polytope_tie(std::uint64_t kind, Random& random) {
  const double angle = uniform(random, .1, 1.4), half = uniform(random, .1, .4);
  const Mat3 edge_down = about(Vec3::UnitX(), std::numbers::pi / 4);
  const Mat3 corner_down =
      Eigen::Quaterniond::FromTwoVectors(Vec3(1, 1, 1), Vec3(0, 0, -1)).toRotationMatrix() * Mat3::Identity();
  switch (kind) {
    case 0:  // six ways out
      return {"concentric cubes", box({half, half, half}), box({1, 1, 1})};
    case 1:
      return in_the_corner("equal depths by two faces", box({half, half, half}), half, 0, random, false);
    case 2:
      return in_the_corner("depths by two faces that differ by 1e-9 to 1e-3", box({half, half, half}), half,
                           std::pow(10.0, uniform(random, -9, -3)), random, false);
    case 3:
      return over_face("parallel faces", box({half, half, half}), about(Vec3::UnitZ(), angle), half, random, false);
    case 4:
      return over_face("edge along a face", box({half, half, half}), about(Vec3::UnitZ(), angle) * edge_down,
                       std::numbers::sqrt2 * half, random, false);
    case 5:
      return over_face("corner over a face", box({half, half, half}), about(Vec3::UnitZ(), angle) * corner_down,
                       std::numbers::sqrt3 * half, random, true);
    case 6: {  // edges along x of two cubes on their edges, one over the other
      Arrangement out{"parallel edges apart", box({half, half, half}), box({1, 1, 1}), Mat3::Identity()};
      out.offset_a = Vec3(uniform(random, -.3, .3), 1 + half + .1, 1 + half + .1);
      out.unique_direction = true;
      return out;
    }
    default: {  // the same two edges, turned across each other about the line that joins them
      const Vec3 diagonal = Vec3(0, 1, 1).normalized();
      Arrangement out{"crossed edges apart", box({half, half, half}), box({1, 1, 1}), about(diagonal, angle)};
      out.offset_a = (std::numbers::sqrt2 * (1 + half) + .1) * diagonal;
      out.unique_direction = out.unique_witness = true;
      return out;
    }
  }
}

Arrangement round_tie(std::uint64_t kind, Random& random) {
  const double r = uniform(random, .1, .4), h = uniform(random, .1, .4), angle = uniform(random, .1, 1.4);
  const Mat3 lying = about(Vec3::UnitZ(), angle) * about(Vec3::UnitX(), std::numbers::pi / 2);
  switch (kind) {
    case 8:
      return {"concentric spheres", *ConvexShape::sphere(r), *ConvexShape::sphere(1)};
    case 9:
      return in_the_corner("ball with equal depths by two faces", *ConvexShape::sphere(r), r, 0, random, true);
    case 10:
      return in_the_corner("ball with depths that differ by 1e-9 to 1e-3", *ConvexShape::sphere(r), r,
                           std::pow(10.0, uniform(random, -9, -3)), random, true);
    case 11: {
      Arrangement out{"parallel capsules", *ConvexShape::capsule(r, h, 2), *ConvexShape::capsule(.5, 1, 2)};
      out.offset_a = (r + .5 + uniform(random, -.05, .2)) * Vec3(std::cos(angle), std::sin(angle), 0);
      out.unique_direction = true;
      return out;
    }
    case 12:
      return over_face("cylinder standing on a face", *ConvexShape::cylinder(r, h, 2), Mat3::Identity(), h, random,
                       false);
    case 13:
      return over_face("cylinder lying on a face", *ConvexShape::cylinder(r, h, 2), lying, r, random, false);
    case 14:
      return over_face("cone on its apex", *ConvexShape::cone(r, h, 2), about(Vec3::UnitX(), std::numbers::pi), h,
                       random, true);
    default: {
      const Vec3 radii(.3 + r, .2 + r, .1 + r);
      return {"concentric ellipsoids", *ConvexShape::ellipsoid(.5 * radii), *ConvexShape::ellipsoid(radii)};
    }
  }
}

}  // namespace

TieCase tie_case(std::uint64_t seed, std::uint64_t index) {
  std::seed_seq sequence{seed, index, std::uint64_t{99}};
  Random random(sequence);
  const std::uint64_t kind = index % kTieKinds;
  Arrangement built = kind < 8 ? polytope_tie(kind, random) : round_tie(kind, random);
  // Turned as a whole, so that rounding blurs every tie; one in four stays as built, exact.
  const bool turned = random() % 4 != 0;
  const Mat3 whole = turned ? rotation(random) : Mat3::Identity();
  const Vec3 place = turned ? vector(random, 0, 2) : Vec3(0, 0, 0);
  const Pose pose_b = *Pose::from_matrix(whole, place);
  const Pose pose_a = *Pose::from_matrix(whole * built.turn_a, place + whole * built.offset_a);
  return {{built.kind, std::move(built.a), std::move(built.b), pose_a, pose_b},
          built.unique_direction,
          built.unique_witness};
}

}  // namespace pd::oracle
