/// @file
/// The answers of C are those of C++, bit for bit: every kind of query over generated pairs. PDEPTH_C_PAIRS in the
/// environment asks for another number of pairs; each pair is asked some 16 times.
#include <gtest/gtest.h>

#include <bit>
#include <cinttypes>
#include <cstdlib>
#include <cstring>

#include "c_interface/c_library.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/derivatives.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/depth/width.hpp"
#include "scenes/shape_families.hpp"

namespace pd::c_test {
namespace {

using scenes::Random;

/// The numbers of an answer in a fixed order, as words, so that NaN and the sign of zero count.
class Words {
 public:
  void add(double x) { words_.push_back(std::bit_cast<std::uint64_t>(x)); }
  void add(std::int64_t x) { words_.push_back(static_cast<std::uint64_t>(x)); }
  void add(const Vec3& v) { add_all(v.data(), 3); }
  void add_all(const double* x, int count) {
    for (int i = 0; i < count; ++i) add(x[i]);
  }
  [[nodiscard]] std::uint64_t hash() const {
    std::uint64_t state = 0;
    for (const std::uint64_t word : words_) {
      std::uint64_t z = (state ^ word) + 0x9E3779B97F4A7C15ULL;
      z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
      z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
      state = z ^ (z >> 31);
    }
    return state;
  }
  friend bool operator==(const Words&, const Words&) = default;

 private:
  std::vector<std::uint64_t> words_;
};

void add_feature(Words& words, const Feature& feature, std::int32_t part) {
  for (const std::int32_t x : {static_cast<std::int32_t>(feature.kind), part, feature.first, feature.second}) {
    words.add(std::int64_t{x});
  }
}
void add_feature(Words& words, const pdepth_feature& feature) {
  for (const std::int32_t x : {feature.kind, feature.part, feature.first, feature.second}) words.add(std::int64_t{x});
}

Words words_of(const PenetrationDepth& x, int part_a = 0, int part_b = 0, bool closed = true) {
  Words words;
  words.add(static_cast<std::int64_t>(x.contact));
  words.add(static_cast<std::int64_t>(x.method));
  words.add(std::int64_t{x.warm});
  words.add(std::int64_t{x.bracket_reached && closed});
  for (const double d : {x.depth, x.lower, x.upper, x.distance, x.distance_lower, x.distance_upper}) words.add(d);
  for (const Vec3& v : {x.translation, x.normal, x.witness_a, x.witness_b}) words.add(v);
  add_feature(words, x.feature_a, part_a);
  add_feature(words, x.feature_b, part_b);
  for (const auto n : {x.statistics.support_calls, x.statistics.facets_visited, x.statistics.exact_signs}) words.add(n);
  return words;
}
Words words_of(const UnionDepth& x) { return words_of(x, x.part_a, x.part_b, x.closed); }

Words words_of(const pdepth_answer& x) {
  Words words;
  for (const std::int32_t n : {x.contact, x.method, x.warm, x.bracket_reached}) words.add(std::int64_t{n});
  for (const double d : {x.depth, x.lower, x.upper, x.distance, x.distance_lower, x.distance_upper}) words.add(d);
  for (const double* v : {x.translation, x.normal, x.witness_a, x.witness_b}) words.add_all(v, 3);
  add_feature(words, x.feature_a);
  add_feature(words, x.feature_b);
  for (const auto n : {x.support_calls, x.facets_visited, x.exact_signs}) words.add(n);
  return words;
}

pdepth_settings settings_of(const DepthSettings& from) {
  auto settings = sized<pdepth_settings>();
  settings.method = static_cast<std::int32_t>(from.method);
  settings.bracket = from.bracket == Bracket::tightest    ? PDEPTH_BRACKET_TIGHTEST
                     : from.bracket == Bracket::certified ? PDEPTH_BRACKET_CERTIFIED
                                                          : PDEPTH_BRACKET_CONTACT;
  settings.delta = from.delta;
  settings.contact_tolerance = from.contact_tolerance;
  settings.use_beyond = from.beyond < HUGE_VAL ? 1 : 0;
  settings.beyond = settings.use_beyond != 0 ? from.beyond : 0;
  return settings;
}

class BothDoors {
 public:
  void pair(const Twin& a, const Pose& pose_a, const Twin& b, const Pose& pose_b) {
    a_ = &a, b_ = &b;
    posed_a_ = {&a.convex(), pose_a}, posed_b_ = {&b.convex(), pose_b};
    question_ = question_of(a.shape.get(), b.shape.get());
    question_.pose_a = pose_of(pose_a);
    question_.pose_b = pose_of(pose_b);
  }

  void depth(const DepthSettings& settings) {
    const pdepth_settings of_c = settings_of(settings);
    question_.settings = &of_c;
    compare(words_of(penetration_depth(posed_a_, posed_b_, scratch_, settings)), ask(), "depth");
    question_.settings = nullptr;
  }

  /// Three frames with one memory each.
  void warm(const Vec3& drift) {
    WarmCertificate certificate;
    const Pair memory = make_pair(context_);
    question_.pair = memory.get();
    const Pose start = posed_b_.pose;
    for (int frame = 0; frame < 3; ++frame) {
      posed_b_.pose = Pose::from_trusted_matrix(start.rotation(), start.translation() + frame * drift);
      question_.pose_b = pose_of(posed_b_.pose);
      compare(words_of(penetration_depth(posed_a_, posed_b_, scratch_, {}, &certificate)), ask(), "warm");
    }
    question_.pair = nullptr;
    posed_b_.pose = start;
    question_.pose_b = pose_of(start);
  }

  void compound() {
    const PosedCompound a{&a_->whole, posed_a_.pose}, b{&b_->whole, posed_b_.pose};
    WarmUnion memory_of_cpp;
    const Pair memory = make_pair(context_);
    question_.pair = memory.get();
    for (int frame = 0; frame < 2; ++frame) {
      compare(words_of(*penetration_depth(a, b, scratch_, {}, &memory_of_cpp)), ask(), "compound");
    }
    question_.pair = nullptr;
  }

  void along(const Vec3& direction) {
    auto answer = sized<pdepth_directional>();
    const pdepth_status status = pdepth_depth_along(context_.get(), &question_, direction.data(), &answer);
    const auto expected = directional_depth(posed_a_, posed_b_, direction, scratch_);
    ASSERT_EQ(status == PDEPTH_OK, expected.has_value());
    if (!expected) return;
    Words of_c, of_cpp;
    of_c.add(std::int64_t{answer.contact});
    of_c.add_all(&answer.depth, 3);
    of_c.add_all(answer.normal, 3);
    add_feature(of_c, answer.feature_a);
    add_feature(of_c, answer.feature_b);
    of_cpp.add(static_cast<std::int64_t>(expected->contact));
    for (const double x : {expected->depth, expected->lower, expected->upper}) of_cpp.add(x);
    of_cpp.add(expected->normal);
    add_feature(of_cpp, expected->feature_a, 0);
    add_feature(of_cpp, expected->feature_b, 0);
    compare(of_cpp, of_c, "along");
  }

  void manifold(double threshold) {
    auto answer = sized<pdepth_manifold>();
    ASSERT_EQ(pdepth_contact_manifold(context_.get(), &question_, threshold, &answer), PDEPTH_OK);
    const PenetrationDepth depth = penetration_depth(posed_a_, posed_b_, scratch_);
    const ContactManifold expected = contact_manifold(posed_a_, posed_b_, depth, threshold, manifold_scratch_);
    ASSERT_EQ(answer.count, expected.count);
    Words of_c, of_cpp;
    of_c.add_all(answer.normal, 3);
    of_cpp.add(expected.normal);
    for (int i = 0; i < answer.count; ++i) {
      const ContactPoint& point = expected.points[static_cast<std::size_t>(i)];
      of_c.add_all(answer.points[i].position_a, 7);
      of_c.add(answer.points[i].feature_id);
      of_cpp.add(point.position_a);
      of_cpp.add(point.position_b);
      of_cpp.add(point.depth);
      of_cpp.add(point.feature_id);
    }
    compare(of_cpp, of_c, "manifold");
  }

  void impact(const RigidMotion& motion) {
    auto movement = sized<pdepth_movement>();
    movement.duration = 1;
    for (int k = 0; k < 3; ++k) {
      movement.a.linear_velocity[k] = motion.linear_velocity[k];
      movement.a.angular_velocity[k] = motion.angular_velocity[k];
    }
    auto answer = sized<pdepth_impact>();
    auto contact = sized<pdepth_answer>();
    ASSERT_EQ(pdepth_time_of_impact(context_.get(), &question_, &movement, &answer, &contact), PDEPTH_OK)
        << error_of(context_);
    const TimeOfImpact expected = time_of_impact({posed_a_, motion}, {posed_b_, {}}, 1, scratch_);
    Words of_c, of_cpp;
    of_c.add(answer.time);
    of_c.add(answer.certified);
    of_c.add(std::int64_t{answer.hit + 2 * answer.reached + 4 * answer.queries});
    of_cpp.add(expected.time);
    of_cpp.add(expected.certified);
    of_cpp.add(std::int64_t{(expected.hit ? 1 : 0) + (expected.reached ? 2 : 0) + 4 * expected.queries});
    compare(of_cpp, of_c, "impact");
    compare(words_of(expected.contact), words_of(contact), "contact at the impact");
  }

  void derivatives() {
    auto found = sized<pdepth_derivatives>();
    auto answer = sized<pdepth_answer>();
    ASSERT_EQ(pdepth_depth_derivatives(context_.get(), &question_, &found, &answer), PDEPTH_OK);
    const DepthDerivatives expected = depth_derivatives(posed_a_, posed_b_, scratch_);
    Words of_c, of_cpp;
    of_c.add(std::int64_t{found.unique_direction + 2 * found.unique_witness + 4 * found.stable_features});
    of_c.add_all(&found.signed_depth, 13);
    of_cpp.add(std::int64_t{(expected.unique_direction ? 1 : 0) + (expected.unique_witness ? 2 : 0) +
                            (expected.stable_features ? 4 : 0)});
    of_cpp.add(expected.signed_depth);
    for (const PoseGradient* g : {&expected.by_a, &expected.by_b}) of_cpp.add(g->translation), of_cpp.add(g->rotation);
    of_c.add_all(found.normal_by_a, 6 * 18);
    for (const PoseJacobian* j : {&expected.normal_by_a, &expected.normal_by_b, &expected.witness_a_by_a,
                                  &expected.witness_a_by_b, &expected.witness_b_by_a, &expected.witness_b_by_b}) {
      for (int row = 0; row < 3; ++row) {
        of_cpp.add(Vec3(j->translation.row(row)));
        of_cpp.add(Vec3(j->rotation.row(row)));
      }
    }
    compare(of_cpp, of_c, "derivatives");
    compare(words_of(expected.answer), words_of(answer), "depth beside the derivatives");
  }

  void body(const Vec3& direction) {
    auto found = sized<pdepth_width_answer>();
    ASSERT_EQ(pdepth_width(context_.get(), a_->shape.get(), &question_.pose_a, nullptr, &found), PDEPTH_OK);
    const Width expected = width(posed_a_, scratch_);
    Words of_c, of_cpp;
    of_c.add_all(&found.width, 6);
    for (const double x : {expected.width, expected.lower, expected.upper}) of_cpp.add(x);
    of_cpp.add(expected.normal);
    compare(of_cpp, of_c, "width");

    auto support = sized<pdepth_support_answer>();
    ASSERT_EQ(pdepth_support(context_.get(), a_->shape.get(), &question_.pose_a, direction.data(), &support),
              PDEPTH_OK);
    const std::vector<Vec3> point{Vec3::Zero()};
    const ConvexShape origin(*ConvexPolytope::from_points(point));
    const DifferenceSupport value = *support_of_difference({&origin, Pose()}, posed_a_, direction);
    Words value_of_c, value_of_cpp;
    value_of_c.add(support.value);
    value_of_cpp.add(value.value);
    compare(value_of_cpp, value_of_c, "support");
    const Vec3 at(support.point[0], support.point[1], support.point[2]);
    EXPECT_NEAR(at.dot(direction), value.value, 1e-14 * (at.norm() + std::abs(value.value)) * direction.norm());
  }

  [[nodiscard]] const Context& context() const { return context_; }
  [[nodiscard]] std::int64_t answers() const { return answers_; }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  Words ask() {
    auto answer = sized<pdepth_answer>();
    EXPECT_EQ(pdepth_depth(context_.get(), &question_, &answer), PDEPTH_OK) << error_of(context_);
    EXPECT_EQ(answer.status, PDEPTH_OK);
    return words_of(answer);
  }

  void compare(const Words& of_cpp, const Words& of_c, const char* query) {
    ASSERT_TRUE(of_cpp == of_c) << query << " of answer " << answers_;
    hash_ = 31 * hash_ + of_c.hash();
    ++answers_;
  }

  Context context_ = make_context();
  Scratch scratch_;
  ManifoldScratch manifold_scratch_;
  const Twin *a_ = nullptr, *b_ = nullptr;
  PosedShape posed_a_{}, posed_b_{};
  pdepth_question question_{};
  std::int64_t answers_ = 0;
  std::uint64_t hash_ = 0;
};

Twin curved_twin(const Context& context, Random& random) {
  const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1), z = random.uniform(0.2, 1);
  const int axis = random.integer(0, 2);
  const auto twin = [&](const ConvexShape& of_cpp, Shape of_c) {
    return Twin{Compound(of_cpp), true, std::move(of_c)};
  };
  const std::array<double, 3> radii{x, y, z};
  const std::array<double, 12> rows{0, 0, 0, x, y, 0, z, y, 0, y, x, z};
  const std::vector<Sphere> spheres{{{0, 0, 0}, x}, {{y, 0, z}, y}, {{0, y, x}, z}};
  switch (random.integer(0, 5)) {
    case 0:
      return twin(*ConvexShape::sphere(x), make_shape(context, &pdepth_sphere, x));
    case 1:
      return twin(*ConvexShape::capsule(x, y, axis), make_shape(context, &pdepth_capsule, x, y, axis));
    case 2:
      return twin(*ConvexShape::cylinder(x, y, axis), make_shape(context, &pdepth_cylinder, x, y, axis));
    case 3:
      return twin(*ConvexShape::cone(x, y, axis), make_shape(context, &pdepth_cone, x, y, axis));
    case 4:
      return twin(*ConvexShape::ellipsoid({x, y, z}), make_shape(context, &pdepth_ellipsoid, radii.data()));
    default:
      return twin(*ConvexShape::hull_of_spheres(spheres), make_shape(context, &pdepth_hull_of_spheres, rows.data(), 3));
  }
}

Twin compound_twin(const Context& context, Random& random) {
  std::vector<Compound::Placed> of_cpp;
  std::vector<pdepth_part> of_c;
  std::vector<Twin> parts;
  for (int i = 0; i < 3; ++i) {
    const Vec3 h = random.point(0.2, 0.6), place = random.point(-0.6, 0.6);
    parts.push_back(box_twin(context, {h.x(), h.y(), h.z()}));
    const Pose pose = random.pose(place);
    of_cpp.push_back({parts.back().whole, pose});
    of_c.push_back({parts.back().shape.get(), pose_of(pose)});
  }
  return {*Compound::from_compounds(of_cpp), false,
          make_shape(context, &pdepth_compound, of_c.data(), static_cast<int64_t>(of_c.size()))};
}

void ask_sharp(BothDoors& doors, std::int64_t i, Random& random) {
  static constexpr std::array kSizes = {4, 6, 8, 8, 12, 16, 24, 48, 128};
  const auto family = static_cast<scenes::PairFamily>(i % scenes::kPairFamilies);
  const int n = kSizes[static_cast<std::size_t>(random.integer(0, static_cast<int>(kSizes.size()) - 1))];
  const auto depth = static_cast<scenes::DepthClass>(random.integer(0, scenes::kDepthClasses - 1));
  const scenes::PointPair p = scenes::make_pair(family, n, depth, 1000003 + static_cast<std::uint64_t>(i));
  const Twin a = hull_twin(doors.context(), p.a), b = hull_twin(doors.context(), p.b);
  doors.pair(a, p.pose_a, b, p.pose_b);
  doors.depth({});
  doors.depth({.bracket = Bracket::certified});
  doors.depth({.bracket = Bracket::contact, .contact_tolerance = 1e-6});
  doors.depth({.method = Method::expansion});
  doors.depth({.beyond = 1e-3});
  const double size = p.pose_b.translation().cwiseAbs().maxCoeff() + b.convex().polytope()->radius();
  doors.warm(1e-4 * size * random.direction());
  doors.along(random.direction());
  doors.manifold(0.02);
  if (i % 26 == 3) doors.derivatives();
  if (!(size > 1e-100 && size < 1e100)) return;
  const Twin swept = margin_twin(doors.context(), a, 0.1 * size);
  doors.pair(swept, p.pose_a, b, p.pose_b);
  doors.depth({});
  doors.body(random.direction());
  const Vec3 way = size * random.direction();
  if (i % 8 == 0) doors.impact({way, random.point(-1, 1)});
}

void ask_curved(BothDoors& doors, std::int64_t i, Random& random) {
  const Twin a = curved_twin(doors.context(), random);
  const Twin b = curved_twin(doors.context(), random);
  const Vec3 place_a = 0.5 * random.direction();
  const Pose pose_a = random.pose(place_a);
  const Vec3 place = random.vector(0, 1.5);
  doors.pair(a, pose_a, b, random.pose(place));
  doors.depth({.delta = 1e-3});
  doors.depth({.bracket = Bracket::contact, .contact_tolerance = 1e-6});
  doors.manifold(0.02);
  if (i % 16 == 0) doors.body(random.direction());
}

TEST(CAnswers, AreThoseOfCppBitForBit) {
  const char* const wanted = std::getenv("PDEPTH_C_PAIRS");
#ifdef PD_VALIDATE
  constexpr std::int64_t kSample = 52;
#else
  constexpr std::int64_t kSample = 260;
#endif
  const std::int64_t pairs = wanted != nullptr ? std::atoll(wanted) : kSample;
  BothDoors doors;
  for (std::int64_t i = 0; i < pairs && !HasFatalFailure(); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    random.next();
    ask_sharp(doors, i, random);
    if (i % 2 == 0) ask_curved(doors, i, random);
    if (i % 26 == 7) {
      const Twin a = compound_twin(doors.context(), random);
      const Twin b = compound_twin(doors.context(), random);
      const Vec3 place = random.point(-0.5, 0.5);
      const Pose pose_a = random.pose(place);
      doors.pair(a, pose_a, b, Pose());
      doors.compound();
    }
  }
  std::printf("%" PRId64 " answers, hash %016" PRIx64 "\n", doors.answers(), doors.hash());
  EXPECT_GT(doors.answers(), 10 * pairs);
}

}  // namespace
}  // namespace pd::c_test
