/// @file
/// Fixed queries whose instructions callgrind counts (`instruction_budget.cmake`): `fixed_cases NAME` sets one
/// up, runs it until no buffer grows any more, and then once more inside `pdepth_counted_call`, the only function that
/// is counted.
///
/// Instruction counts repeat where times do not, so that a slower hot path is seen in review.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "bench/programs/resting_cases.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace {

constexpr pd::DepthSettings kHotPath{.bracket = pd::Bracket::certified};
constexpr pd::DepthSettings kContact{.bracket = pd::Bracket::contact, .contact_tolerance = 0x1p-29};

using pd::scenes::DepthClass;
using pd::scenes::PairFamily;

struct FixedCase {
  const char* name;
  PairFamily family;
  int vertices;
  DepthClass depth;
  double warm_radians;  ///< counted with the memory of three frames, each so far from the next; 0: cold
};
constexpr FixedCase kCases[] = {
    {"box_mid", PairFamily::box, 8, DepthClass::mid, 0},
    {"sphere_8_deep", PairFamily::sphere, 8, DepthClass::deep, 0},
    {"sphere_32_deep", PairFamily::sphere, 32, DepthClass::deep, 0},
    {"sphere_128_mid", PairFamily::sphere, 128, DepthClass::mid, 0},
    {"sphere_128_deep", PairFamily::sphere, 128, DepthClass::deep, 0},
    {"sphere_2048_shallow", PairFamily::sphere, 2048, DepthClass::shallow, 0},
    {"sphere_128_mid_warm", PairFamily::sphere, 128, DepthClass::mid, 0.008},
    {"needle_32_deep", PairFamily::needle, 32, DepthClass::deep, 0},
    {"grid_32_mid", PairFamily::grid, 32, DepthClass::mid, 0},
};

/// Cold, in the tightest bracket.
struct FixedTightest {
  const char* name;
  PairFamily family;
  int vertices;
  DepthClass depth;
  std::uint64_t seed;
  bool turned = false;  ///< both bodies as a whole
};
constexpr FixedTightest kTightest[] = {
    {"tightest_sphere_8", PairFamily::sphere, 8, DepthClass::shallow, 1},
    {"tightest_cubes_deep", PairFamily::cubes, 8, DepthClass::deep, 1},  // facets tied exactly
    {"tightest_grid_128", PairFamily::grid, 128, DepthClass::mid, 1},    // edges in the facet's plane
    {"tightest_grid_32_turned", PairFamily::grid, 32, DepthClass::mid, 2, true},
    {"tightest_no_translation", PairFamily::box, 8, DepthClass::mid, 33},  // none as short as the depth rounded up
    {"tightest_near_ties_64", PairFamily::near_equal_bodies, 64, DepthClass::mid, 7},  // ties but for noise
};

/// What `slowest_pairs` found dear in one of all families: cold, facets that doubles cannot find or tell apart.
struct FixedDear {
  const char* name;
  PairFamily family;
  int vertices;
  DepthClass depth;
  std::uint64_t seed;
  pd::DepthSettings settings;
};
constexpr pd::DepthSettings kTightestBracket{};
constexpr pd::DepthSettings kOverlay{.method = pd::Method::overlay};
constexpr FixedDear kDear[] = {
    // Products of coordinates leave the range of doubles.
    {"dear_scales_8", PairFamily::scales, 8, DepthClass::shallow, 1000011, kHotPath},
    {"dear_scales_64", PairFamily::scales, 64, DepthClass::deep, 1000007, kHotPath},
    {"dear_scales_apart_32", PairFamily::scales, 32, DepthClass::gap, 1000007, kHotPath},
    {"dear_far_translations_32", PairFamily::far_translations, 32, DepthClass::deep, 1000006, kHotPath},
    {"dear_equal_bodies_64", PairFamily::equal_bodies, 64, DepthClass::mid, 1000003, kHotPath},  // facets tie exactly
    // The origin on the boundary of P, and next to it.
    {"dear_kissing_32", PairFamily::kissing, 32, DepthClass::deep, 1000006, kHotPath},
    {"dear_near_kissing_8", PairFamily::near_kissing, 8, DepthClass::gap, 1000003, kHotPath},
    // A body 1e-40 times as large as the other.
    {"dear_mixed_scales_32", PairFamily::mixed_scales, 32, DepthClass::deep, 1000011, kTightestBracket},
    {"dear_mixed_scales_overlay_8", PairFamily::mixed_scales, 8, DepthClass::mid, 1000003, kOverlay},
    // Planes that differ by 1e-31 of their distance, and by the least double.
    {"dear_near_equal_64", PairFamily::near_equal_bodies, 64, DepthClass::mid, 1000008, kTightestBracket},
    {"dear_ulp_noise_8", PairFamily::ulp_noise, 8, DepthClass::mid, 1000010, kTightestBracket},
};

/// Bodies at rest, warm, for contacts.
struct FixedRest {
  const char* name;
  pd::bench::RestingBody body;
  pd::bench::RestingGround ground;
  double width;
};
using pd::bench::RestingBody;
using pd::bench::RestingGround;
constexpr FixedRest kRests[] = {
    {"rest_box_20", RestingBody::box, RestingGround::floor, 20},
    {"rest_box_10000", RestingBody::box, RestingGround::floor, 1e4},
    {"rest_hull_32_20", RestingBody::hull_32, RestingGround::floor, 20},
    {"rest_sphere_20", RestingBody::sphere, RestingGround::floor, 20},
    {"rest_capsule_20", RestingBody::capsule, RestingGround::floor, 20},
    {"rest_cylinder_20", RestingBody::cylinder, RestingGround::floor, 20},
    {"rest_cone_20", RestingBody::cone, RestingGround::floor, 20},
    {"rest_sphere_triangle", RestingBody::sphere, RestingGround::triangle, 2},
    {"rest_box_triangle", RestingBody::box, RestingGround::triangle, 2},
};

/// Bodies apart by a tenth of their size, asked whether by more than a hundredth; of 128 vertices also by more than
/// their balls, round the origins of their frames, are apart.
struct FixedGap {
  const char* name;
  int vertices;
  bool warm;
  double beyond = 0.02;
};
constexpr FixedGap kGaps[] = {{"beyond_8", 8, false},
                              {"beyond_8_warm", 8, true},
                              {"beyond_128", 128, false, 0.2178},
                              {"beyond_128_warm", 128, true, 0.2178},
                              {"beyond_128_balls", 128, false}};

/// Apart by a share of the first body's radius: how far.
struct FixedDistance {
  const char* name;
  PairFamily family;
  int vertices;
  double gap;
  bool warm;  ///< with the memory of three frames, each .01 rad from the next
};
constexpr FixedDistance kDistances[] = {{"distance_8_near", PairFamily::sphere, 8, 0.01, false},
                                        {"distance_8_far", PairFamily::sphere, 8, 1, false},
                                        {"distance_128_near", PairFamily::sphere, 128, 0.01, false},
                                        {"distance_needle_8", PairFamily::needle, 8, 0.1, false},
                                        {"distance_8_far_warm", PairFamily::sphere, 8, 1, true},
                                        {"distance_128_near_warm", PairFamily::sphere, 128, 0.01, true}};

/// Sixty frames with memory, B turned by so much from each to the next: all of them counted, the first one cold.
struct FixedFrames {
  const char* name;
  int vertices;
  double radians;
};
constexpr FixedFrames kFrames[] = {{"frames_8_slow", 8, 0.002}, {"frames_8", 8, 0.01},
                                   {"frames_8_fast", 8, 0.05},  {"frames_32_slow", 32, 0.002},
                                   {"frames_32", 32, 0.01},     {"frames_32_fast", 32, 0.05}};

/// A cylinder in a box, a cone in a hull of 32 vertices, cold.
struct FixedCurved {
  const char* name;
  bool cone;
  std::uint64_t seed;
};
constexpr FixedCurved kCurved[] = {{"cylinder_box_edge", false, 10},   // a rim on an edge
                                   {"cylinder_box_facet", false, 14},  // a rim on a facet
                                   {"cone_hull_32", true, 10}};

/// Two boxes cold, in the tightest bracket, that need no search: at rest, one turned about the vertical, also with both
/// turned as a whole, and at one place, turned a little.
struct FixedTie {
  const char* name;
  std::array<double, 4> turn;
  double height;
  bool turned;
};
constexpr FixedTie kTies[] = {{"tightest_boxes_at_rest", {1, 0, 0, 0.3}, 0.299, false},
                              {"tightest_boxes_at_rest_turned", {1, 0, 0, 0.3}, 0.299, true},
                              {"tightest_boxes_at_one_place", {1, 1e-8, 2e-8, 3e-8}, 0, false}};

/// Two bricks flush on each other, cold, for contacts.
struct FixedFlush {
  const char* name;
  double gap;
};
constexpr FixedFlush kFlush[] = {{"flush_boxes_deep", -1e-3}, {"flush_boxes_apart", 1e-3}};

/// Prisms, cold and certified: on themselves, where all edges of both ends are as near as the sides but for n^-2; and
/// one that stands on a floor by a face, which the point below the origin misses by each corner.
struct FixedPrism {
  const char* name;
  int vertices;
  bool on_floor;
};
constexpr FixedPrism kPrisms[] = {
    {"prism_500_on_itself", 1000, false}, {"prism_2000_on_itself", 4000, false}, {"prism_3_on_floor", 6, true}};

}  // namespace

extern "C" {

/// By its plain name in callgrind's option --toggle-collect.
__attribute__((noinline)) void pdepth_counted_call(const pd::PosedShape* a, const pd::PosedShape* b,
                                                   pd::Scratch* scratch, pd::WarmCertificate* certificate,
                                                   pd::PenetrationDepth* answer, const pd::DepthSettings* settings) {
  *answer = pd::penetration_depth(*a, *b, *scratch, *settings, certificate);
}
}

namespace {

/// Counts one cold query, by default in the tightest bracket, as the library's is.
int count_cold(const char* name, const pd::PosedShape& a, const pd::PosedShape& b,
               const pd::DepthSettings& settings = {}) {
  pd::Scratch scratch;
  pd::PenetrationDepth answer = pd::penetration_depth(a, b, scratch, settings);
  pdepth_counted_call(&a, &b, &scratch, nullptr, &answer, &settings);
  std::printf("%s: depth in [%.17g, %.17g]\n", name, answer.lower, answer.upper);
  return 0;
}

/// Three frames, each of B so far turned from the next; the last one from its pose.
void remember_frames(const pd::PosedShape& a, const pd::PosedShape& b, double radians, pd::Scratch& scratch,
                     pd::WarmCertificate& certificate) {
  for (int frames = 3; frames > 0; --frames) {
    const double half_angle = frames * radians / 2;
    const pd::Mat3 turn{{1 - 2 * half_angle * half_angle, -2 * half_angle, 0},
                        {2 * half_angle, 1 - 2 * half_angle * half_angle, 0},
                        {0, 0, 1}};
    const pd::PosedShape before{b.shape, pd::Pose::from_trusted_matrix(turn * b.pose.rotation(), b.pose.translation())};
    (void)pd::penetration_depth(a, before, scratch, kHotPath, &certificate);
  }
}

/// The vertex of a body that is farthest along a direction, turned.
pd::Vec3 farthest(const pd::ConvexPolytope& body, const pd::Mat3& turn, const pd::Vec3& direction) {
  pd::Vec3 best = turn * body.vertex(0);
  for (int v = 1; v < body.num_vertices(); ++v) {
    const pd::Vec3 x = turn * body.vertex(v);
    if (x.dot(direction) > best.dot(direction)) best = x;
  }
  return best;
}

/// Four pairs, the first two mid, the others shallow. B stays as deep along the first normal as it was.
int count_frames(const FixedFrames& c) {
  constexpr int kCount = 60;
  const pd::DepthSettings settings = kHotPath;  // an address that no clone of the counted call is made for
  pd::Scratch scratch;
  int warm = 0;
  double depth = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const DepthClass depth_class = seed <= 2 ? DepthClass::mid : DepthClass::shallow;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(PairFamily::sphere, c.vertices, depth_class, seed);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    const pd::PosedShape posed_a{&a, pair.pose_a};
    pd::WarmCertificate certificate;
    const pd::Vec3 out = pd::penetration_depth(posed_a, {&b, pair.pose_b}, scratch, kHotPath).translation;
    const pd::Vec3 foot = farthest(*a.polytope(), pair.pose_a.rotation(), -out) + pair.pose_a.translation() + out;
    for (int frame = 0; frame < kCount; ++frame) {
      const double angle = frame * c.radians;
      const pd::Mat3 about_z{{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
      const pd::Mat3 turn = about_z * pair.pose_b.rotation();
      const pd::PosedShape posed_b{&b, pd::Pose::from_trusted_matrix(turn, foot - farthest(*b.polytope(), turn, out))};
      pd::PenetrationDepth answer;
      pdepth_counted_call(&posed_a, &posed_b, &scratch, &certificate, &answer, &settings);
      warm += answer.warm ? 1 : 0;
      depth += answer.depth;
    }
  }
  std::printf("%s: %d of %zu warm, sum of depths %.17g\n", c.name, warm, std::size_t{4} * kCount, depth);
  return 0;
}

/// With all that stands beside it.
pd::Pose turned(const pd::Pose& pose) {
  const pd::Mat3 whole = pd::Pose::from_quaternion({0.5, 0.1, 0.7, 0.5}, pd::Vec3::Zero())->rotation();
  return pd::Pose::from_trusted_matrix(whole * pose.rotation(), whole * pose.translation());
}

pd::ConvexShape curved_body(bool cone, pd::scenes::Random& random) {
  const double radius = random.uniform(0.5, 1), half_height = random.uniform(0.5, 1);
  return cone ? *pd::ConvexShape::cone(radius, half_height, 2) : *pd::ConvexShape::cylinder(radius, half_height, 2);
}
int count_prism(const FixedPrism& c) {
  pd::scenes::Points points = pd::scenes::prism(c.vertices);
  for (pd::Vec3& p : points) p.z() *= 2;
  const pd::ConvexShape prism(*pd::ConvexPolytope::from_points(points));
  const pd::ConvexShape floor(*pd::ConvexPolytope::box({3, 3, 1}));
  const pd::Pose above = *pd::Pose::from_quaternion({0.96, 0, 0, 0.28}, {0.3, 0.2, 2 - 0x1p-8});
  if (c.on_floor) return count_cold(c.name, {&prism, above}, {&floor, pd::Pose()}, kHotPath);
  return count_cold(c.name, {&prism, pd::Pose()}, {&prism, pd::Pose()}, kHotPath);
}

pd::ConvexShape ground_body(bool hull, pd::scenes::Random& random) {
  if (hull) return *pd::ConvexPolytope::from_points(pd::scenes::sphere_hull(32, random));
  return *pd::ConvexPolytope::box({random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1)});
}

}  // namespace

int main(int argc, char** argv) {
  for (const FixedCase& c : kCases) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(c.family, c.vertices, c.depth, 1);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    const pd::PosedShape posed_a{&a, pair.pose_a};
    const pd::PosedShape posed_b{&b, pair.pose_b};
    pd::Scratch scratch;
    pd::WarmCertificate certificate;
    pd::PenetrationDepth answer;
    if (c.warm_radians > 0) {
      remember_frames(posed_a, posed_b, c.warm_radians, scratch, certificate);
    } else {
      answer = pd::penetration_depth(posed_a, posed_b, scratch, kHotPath);
    }
    pdepth_counted_call(&posed_a, &posed_b, &scratch, c.warm_radians > 0 ? &certificate : nullptr, &answer, &kHotPath);
    // The depth is printed so that no call can be left out; it also shows that the case is what it was.
    std::printf("%s: depth %.17g, %lld supports, %lld exact signs\n", c.name, answer.depth,
                static_cast<long long>(answer.statistics.support_calls),
                static_cast<long long>(answer.statistics.exact_signs));
    return 0;
  }
  for (const FixedTightest& c : kTightest) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(c.family, c.vertices, c.depth, c.seed);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    if (!c.turned) return count_cold(c.name, {&a, pair.pose_a}, {&b, pair.pose_b});
    return count_cold(c.name, {&a, turned(pair.pose_a)}, {&b, turned(pair.pose_b)});
  }
  for (const FixedDear& c : kDear) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(c.family, c.vertices, c.depth, c.seed);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    return count_cold(c.name, {&a, pair.pose_a}, {&b, pair.pose_b}, c.settings);
  }
  for (const FixedRest& c : kRests) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::bench::RestingCase rest(c.body, c.ground, c.width, 8);
    const pd::PosedShape ground = rest.ground();
    pd::Scratch scratch;
    pd::WarmCertificate certificate;
    pd::PenetrationDepth answer;
    for (int frame = 0; frame + 1 < rest.frames(); ++frame) {
      answer = pd::penetration_depth(rest.body(frame), ground, scratch, kContact, &certificate);
    }
    const pd::PosedShape body = rest.body(rest.frames() - 1);
    pdepth_counted_call(&body, &ground, &scratch, &certificate, &answer, &kContact);
    std::printf("%s: signed distance in [%.17g, %.17g]\n", c.name, answer.distance_lower - answer.upper,
                answer.distance_upper - answer.lower);
    return 0;
  }
  for (const FixedGap& c : kGaps) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(PairFamily::sphere, c.vertices, DepthClass::gap, 1);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    pd::Scratch scratch;
    pd::WarmCertificate certificate;
    const pd::PenetrationDepth near = pd::penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, kHotPath);
    const pd::PosedShape posed_a{
        &a, pd::Pose::from_trusted_matrix(pair.pose_a.rotation(), pair.pose_a.translation() + 0.2 * near.normal)};
    const pd::PosedShape posed_b{&b, pair.pose_b};
    pd::DepthSettings settings = kHotPath;
    settings.beyond = c.beyond;
    pd::WarmCertificate* const warm = c.warm ? &certificate : nullptr;
    pd::PenetrationDepth answer = pd::penetration_depth(posed_a, posed_b, scratch, settings, warm);
    pdepth_counted_call(&posed_a, &posed_b, &scratch, warm, &answer, &settings);
    std::printf("%s: distance in [%.17g, %.17g], %lld supports\n", c.name, answer.distance_lower, answer.distance_upper,
                static_cast<long long>(answer.statistics.support_calls));
    return 0;
  }
  for (const FixedDistance& c : kDistances) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::scenes::PointPair pair = pd::scenes::make_pair(c.family, c.vertices, DepthClass::mid, 1);
    const pd::ConvexShape a(*pd::ConvexPolytope::from_points(pair.a));
    const pd::ConvexShape b(*pd::ConvexPolytope::from_points(pair.b));
    pd::Scratch scratch;
    const pd::PenetrationDepth in = pd::penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, kHotPath);
    const pd::Vec3 out = (in.depth + c.gap * a.polytope()->radius()) * in.normal;
    const pd::PosedShape posed_a{
        &a, pd::Pose::from_trusted_matrix(pair.pose_a.rotation(), pair.pose_a.translation() + out)};
    const pd::PosedShape posed_b{&b, pair.pose_b};
    pd::WarmCertificate certificate;
    pd::PenetrationDepth answer = pd::penetration_depth(posed_a, posed_b, scratch, kHotPath);
    if (c.warm) remember_frames(posed_a, posed_b, 0.01, scratch, certificate);
    pdepth_counted_call(&posed_a, &posed_b, &scratch, c.warm ? &certificate : nullptr, &answer, &kHotPath);
    std::printf("%s: distance in [%.17g, %.17g], %lld supports\n", c.name, answer.distance_lower, answer.distance_upper,
                static_cast<long long>(answer.statistics.support_calls));
    return 0;
  }
  for (const FixedFrames& c : kFrames) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    return count_frames(c);
  }
  for (const FixedCurved& c : kCurved) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    pd::scenes::Random random(c.seed);
    const pd::ConvexShape a = curved_body(c.cone, random), b = ground_body(c.cone, random);
    const pd::PosedShape posed_a{&a, random.pose(pd::Vec3::Zero())};
    const pd::PosedShape posed_b{&b, random.pose(1.4 * random.direction())};
    pd::Scratch scratch;
    pd::PenetrationDepth answer = pd::penetration_depth(posed_a, posed_b, scratch, kHotPath);
    pdepth_counted_call(&posed_a, &posed_b, &scratch, nullptr, &answer, &kHotPath);
    std::printf("%s: depth in [%.17g, %.17g], %lld supports\n", c.name, answer.lower, answer.upper,
                static_cast<long long>(answer.statistics.support_calls));
    return 0;
  }
  for (const FixedTie& c : kTies) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::ConvexShape a(*pd::ConvexPolytope::box(pd::Vec3(0.3, 0.7, 0.1)));
    const pd::ConvexShape b(*pd::ConvexPolytope::box(pd::Vec3(1, 0.6, 0.2)));
    const double length = std::hypot(c.turn[0], c.turn[3]);
    const std::array<double, 4> turn{c.turn[0] / length, c.turn[1], c.turn[2], c.turn[3] / length};
    const pd::Pose upright = *pd::Pose::from_quaternion(turn, {0.0, 0.0, c.height});
    if (!c.turned) return count_cold(c.name, {&a, upright}, {&b, pd::Pose()});
    return count_cold(c.name, {&a, turned(upright)}, {&b, turned(pd::Pose())});
  }
  for (const FixedFlush& c : kFlush) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    const pd::bench::FlushBricks bricks(c.gap);
    const pd::PosedShape upper = bricks.upper(), lower = bricks.lower();
    pd::Scratch scratch;
    pd::PenetrationDepth answer = pd::penetration_depth(upper, lower, scratch, kContact);
    pdepth_counted_call(&upper, &lower, &scratch, nullptr, &answer, &kContact);
    std::printf("%s: signed distance in [%.17g, %.17g]\n", c.name, answer.distance_lower - answer.upper,
                answer.distance_upper - answer.lower);
    return 0;
  }
  for (const FixedPrism& c : kPrisms) {
    if (argc != 2 || std::strcmp(argv[1], c.name) != 0) continue;
    return count_prism(c);
  }
  std::fprintf(stderr, "fixed_cases NAME, one of:");
  for (const FixedCase& c : kCases) std::fprintf(stderr, " %s", c.name);
  for (const FixedTightest& c : kTightest) std::fprintf(stderr, " %s", c.name);
  for (const FixedDear& c : kDear) std::fprintf(stderr, " %s", c.name);
  for (const FixedRest& c : kRests) std::fprintf(stderr, " %s", c.name);
  for (const FixedGap& c : kGaps) std::fprintf(stderr, " %s", c.name);
  for (const FixedDistance& c : kDistances) std::fprintf(stderr, " %s", c.name);
  for (const FixedFrames& c : kFrames) std::fprintf(stderr, " %s", c.name);
  for (const FixedCurved& c : kCurved) std::fprintf(stderr, " %s", c.name);
  for (const FixedTie& c : kTies) std::fprintf(stderr, " %s", c.name);
  for (const FixedFlush& c : kFlush) std::fprintf(stderr, " %s", c.name);
  for (const FixedPrism& c : kPrisms) std::fprintf(stderr, " %s", c.name);
  std::fprintf(stderr, "\n");
  return 2;
}
