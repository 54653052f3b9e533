#include "oracle/resting_pair.hpp"

#include <cmath>

#include "oracle/judging.hpp"
#include "scenes/single_precision.hpp"

namespace pd::oracle {

namespace {

using scenes::Points;
using scenes::Random;

double single(double x, bool round) { return round ? scenes::to_single(x) : x; }

/// A box on a floor, a hull on a floor, two boxes, a box and a hull, capsules' cores among them.
Points core(Random& random, int kind) {
  switch (kind) {
    case 0:
      return scenes::box({random.uniform(0.005, 1), random.uniform(0.005, 1), random.uniform(0.005, 1)});
    case 1:
      return scenes::sphere_hull(random.integer(4, 12), random);
    case 2:
      return {Vec3(0, 0, -random.uniform(0.1, 1)), Vec3(0, 0, random.uniform(0.1, 1))};
    default:
      return {Vec3::Zero()};
  }
}

/// Upright, tipped a little, or anyhow.
Pose orientation(Random& random) {
  const int kind = random.integer(0, 3);
  if (kind == 3) return random.pose(Vec3::Zero());
  const auto [sine, cosine] = scenes::turn(random.uniform());
  double tip = 0;
  if (kind != 0) {
    const int halvings = random.integer(1, 22);
    tip = std::ldexp(random.uniform(-1, 1), -halvings);
  }
  const double half = 0.5 * tip;
  const double norm = std::sqrt(1 + half * half);
  // A turn about y, then a small one about an axis across it.
  return *Pose::from_quaternion({cosine / norm, half * cosine / norm, sine / norm, half * sine / norm}, Vec3::Zero());
}

/// To contact: by the translation out of an overlap, by the distance towards each other.
Vec3 to_contact(const PenetrationDepth& answer) {
  return answer.contact == ContactClass::overlapping ? answer.translation : Vec3(-answer.distance * answer.normal);
}

Pose moved(const Pose& pose, const Vec3& by, bool round) {
  Vec3 t = pose.translation() + by;
  for (int i = 0; i < 3; ++i) t[i] = single(t[i], round);
  return *Pose::from_matrix(pose.rotation(), t);
}

}  // namespace

RestingPair make_resting_pair(std::uint64_t seed, Scratch& scratch) {
  Random random(seed);
  random.next();
  const bool round = seed % 2 == 0;
  RestingPair pair;
  pair.cores.a = core(random, random.integer(0, 7) % 4);
  static constexpr double kFloors[] = {1, 20, 200};
  if (random.integer(0, 1) == 0) {
    pair.cores.b = core(random, random.integer(0, 1));
  } else {
    const double half_z = kFloors[random.integer(0, 2)];
    pair.cores.b = scenes::box(Vec3(kFloors[random.integer(0, 2)], 1, half_z));
  }
  pair.margin_a = single(random.uniform(0.001, 0.08), round);
  pair.margin_b = random.integer(0, 3) == 0 ? 0 : single(random.uniform(0.001, 0.08), round);
  const double z = random.uniform(-0.7, 0.7), y = random.uniform(0.5, 2);
  const Vec3 start(random.uniform(-0.7, 0.7), y, z);
  pair.cores.pose_a = moved(orientation(random), start, round);
  pair.cores.pose_b = random.integer(0, 1) == 0 ? Pose() : orientation(random);
  for (Vec3& p : pair.cores.a) p = Vec3(single(p.x(), round), single(p.y(), round), single(p.z(), round));
  for (Vec3& p : pair.cores.b) p = Vec3(single(p.x(), round), single(p.y(), round), single(p.z(), round));

  const auto answer = [&] {
    const auto a = ConvexShape(*ConvexPolytope::from_points(pair.cores.a)).with_margin(pair.margin_a);
    const auto b = ConvexShape(*ConvexPolytope::from_points(pair.cores.b)).with_margin(pair.margin_b);
    return penetration_depth({&*a, pair.cores.pose_a}, {&*b, pair.cores.pose_b}, scratch);
  };
  PenetrationDepth last = answer();
  pair.cores.pose_a = moved(pair.cores.pose_a, to_contact(last), round);
  last = answer();
  if (random.integer(0, 1) == 0) {
    // The points take the place in themselves: translations are tiny then, and their doubles as fine as one likes.
    const Pose& pose = pair.cores.pose_a;
    for (Vec3& p : pair.cores.a) p = p + pose.rotation().transpose() * pose.translation();
    pair.cores.pose_a = *Pose::from_matrix(pose.rotation(), Vec3::Zero());
    for (int k = 0; k < 2; ++k) {
      last = answer();
      pair.cores.pose_a = moved(pair.cores.pose_a, to_contact(last), false);
    }
  } else if (random.integer(0, 1) == 0) {
    pair.cores.pose_a = moved(pair.cores.pose_a, to_contact(last), round);
  }
  if (random.integer(0, 3) > 0) {
    const double size = std::pow(10, random.uniform(-20, -6));
    const double shift = random.integer(0, 1) == 0 ? size : -size;
    pair.cores.pose_a = moved(pair.cores.pose_a, shift * last.normal, false);
  }
  return pair;
}

int compare_with_depth(double x, const Verdict& core, const Scaled& margins) {
  const Scaled rest = to_scaled(x) - margins;  // x - depth = rest - core's signed depth
  if (core.contact == ContactClass::overlapping) return rest.mantissa.sign() < 0 ? -1 : core.depth.compare(rest);
  // Minus the distance: rest + distance.
  if (core.contact == ContactClass::touching) return rest.mantissa.sign();
  return rest.mantissa.sign() >= 0 ? 1 : -core.distance.compare(-rest);
}

std::string check_rounded(const JudgedPair& pair, double margin_a, double margin_b, const PenetrationDepth& answer,
                          Bracket bracket) {
  const Verdict& core = pair.verdict();
  if (core.contact == ContactClass::separated && !core.distance_known) return "oracle: distance not certified";
  const Scaled margins = to_scaled(margin_a) + to_scaled(margin_b);
  const int sign = -compare_with_depth(0, core, margins);
  const ContactClass expected = sign > 0   ? ContactClass::overlapping
                                : sign < 0 ? ContactClass::separated
                                           : ContactClass::touching;
  if (answer.contact != expected) return "class " + std::string(to_string(answer.contact));
  const double size = pair.size_of_numbers() + margin_a + margin_b;
  const double low = sign > 0 ? answer.lower : answer.distance_lower;
  const double high = sign > 0 ? answer.upper : answer.distance_upper;
  const double value = sign > 0 ? answer.depth : answer.distance;
  if (!(low >= 0 && low <= value && value <= high && std::isfinite(high))) return text("bracket [%g, %g]", low, high);
  if (sign > 0 && (compare_with_depth(low, core, margins) > 0 || compare_with_depth(high, core, margins) < 0)) {
    return text("bracket [%.17g, %.17g] does not hold the depth", low, high);
  }
  if (sign < 0 && (compare_with_depth(-low, core, margins) < 0 || compare_with_depth(-high, core, margins) > 0)) {
    return text("bracket [%.17g, %.17g] does not hold the distance", low, high);
  }
  // Tightest: neighbouring doubles, or the next one where no translation is short enough.
  const double allowed = bracket == Bracket::certified ? 2e-14 * size : 2 * (std::nextafter(high, HUGE_VAL) - high);
  if (high - low > allowed) return text("width %g, allowed %g", high - low, allowed);
  if (std::abs(answer.normal.norm() - 1) > 1e-15) return "normal";
  const double world = std::max(answer.witness_a.norm(), answer.witness_b.norm());
  const Vec3 gap = sign < 0 ? Vec3(-answer.distance * answer.normal) : answer.translation;
  const double error = (answer.witness_b - answer.witness_a - gap).cwiseAbs().maxCoeff();
  if (error > 2e-14 * size + 4 * 0x1p-52 * world) return text("witnesses differ by %g", error, 0);
  if (sign <= 0) return {};
  Scaled squared;
  for (int i = 0; i < 3; ++i) squared = squared + to_scaled(answer.translation[i]) * to_scaled(answer.translation[i]);
  if ((squared - to_scaled(answer.upper) * to_scaled(answer.upper)).mantissa.sign() > 0) return "translation too long";
  const Body a(pair.points().a), b(pair.points().b);
  const ExactPair apart(a, pair.points().pose_a, b, pair.points().pose_b, answer.translation);
  const Verdict moved = judge(apart);
  if (moved.contact == ContactClass::separated && !moved.distance_known) return "oracle: distance not certified";
  if (compare_with_depth(0, moved, margins) < 0) return "translation does not separate";
  return {};
}

}  // namespace pd::oracle
