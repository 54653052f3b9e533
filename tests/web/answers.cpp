/// @file
/// Asks libpdepth.so, so that the answers of WebAssembly can be compared bit for bit.
///
///     web_answers PAIRS FILE    writes the questions, and prints how many answers there are and their hash
///
/// The file holds doubles, pair by pair: each body as kind (0 hull, then as `kCurved`), count of numbers, numbers and
/// margin; each pose as count of numbers and numbers. answers.mjs reads it, asks the package and computes the same
/// hash.
#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "pdepth/pdepth.h"
#include "scenes/shape_families.hpp"

namespace {

using pd::Vec3;
using pd::scenes::Random;

struct Release {
  void operator()(pdepth_context* context) const { pdepth_context_destroy(context); }
  void operator()(pdepth_shape* shape) const { pdepth_shape_release(shape); }
};
using Shape = std::unique_ptr<pdepth_shape, Release>;

/// Hashes 32-bit words: FNV-1a, and a second lane that the first one stirs. JavaScript computes both quickly, too.
class Hash {
 public:
  void add(std::uint32_t word) {
    first_ = (first_ ^ word) * 0x01000193U;
    second_ = (second_ ^ word ^ first_ >> 15) * 0x85EBCA6BU;
  }
  void add(std::int32_t word) { add(static_cast<std::uint32_t>(word)); }
  void add(double x) {
    std::array<std::uint32_t, 2> words{};
    std::memcpy(words.data(), &x, sizeof x);
    for (const std::uint32_t word : words) add(word);
  }
  void add(const double* x, int count) {
    for (int i = 0; i < count; ++i) add(x[i]);
  }
  void add(const pdepth_feature& feature) {
    for (const std::int32_t x : {feature.kind, feature.part, feature.first, feature.second}) add(x);
  }
  void add(const pdepth_answer& x) {
    for (const std::int32_t word : {x.contact, x.method, x.bracket_reached}) add(word);
    for (const double d : {x.depth, x.lower, x.upper, x.distance, x.distance_lower, x.distance_upper}) add(d);
    for (const double* v : {x.translation, x.normal, x.witness_a, x.witness_b}) add(v, 3);
    add(x.feature_a);
    add(x.feature_b);
  }
  void print(std::int64_t answers) const {
    std::printf("%" PRId64 " answers, hash %08" PRIx32 "%08" PRIx32 "\n", answers, first_, second_);
  }

 private:
  std::uint32_t first_ = 0x811C9DC5U;
  std::uint32_t second_ = 0x9747B28CU;
};

/// The kinds of body in the file, after 0 for a hull.
enum Curved { kSphere = 1, kCapsule, kCylinder, kCone, kEllipsoid, kHullOfSpheres };

class Questions {
 public:
  explicit Questions(const char* path) : file_(std::fopen(path, "wb")) {
    if (file_ == nullptr || pdepth_context_create(nullptr, &context_) != PDEPTH_OK) throw std::runtime_error(path);
  }
  ~Questions() {
    std::fclose(file_);
    pdepth_context_destroy(context_);
  }
  Questions(const Questions&) = delete;
  Questions& operator=(const Questions&) = delete;

  Shape hull(const std::vector<Vec3>& points, double margin) {
    std::vector<double> numbers;
    for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
    pdepth_shape* shape = nullptr;
    require(pdepth_convex_hull(context_, numbers.data(), static_cast<std::int64_t>(points.size()), &shape));
    return body(0, numbers, margin, shape);
  }
  Shape curved(Random& random) {
    const int kind = random.integer(kSphere, kHullOfSpheres);
    const int axis = random.integer(0, 2);
    std::vector<double> numbers;
    pdepth_shape* shape = nullptr;
    const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1), z = random.uniform(0.2, 1);
    if (kind == kSphere) {
      numbers = {x};
      require(pdepth_sphere(context_, x, &shape));
    } else if (kind == kEllipsoid) {
      numbers = {x, y, z};
      require(pdepth_ellipsoid(context_, numbers.data(), &shape));
    } else if (kind == kHullOfSpheres) {
      numbers = {0, 0, 0, x, y, 0, z, y, 0, y, x, z};
      require(pdepth_hull_of_spheres(context_, numbers.data(), 3, &shape));
    } else {
      numbers = {x, y, static_cast<double>(axis)};
      const auto make = kind == kCapsule ? &pdepth_capsule : kind == kCylinder ? &pdepth_cylinder : &pdepth_cone;
      require(make(context_, x, y, axis, &shape));
    }
    return body(kind, numbers, 0, shape);
  }
  void pair(const pdepth_shape* a, const pd::Pose& pose_a, const pdepth_shape* b, const pd::Pose& pose_b) {
    question_ = {};
    question_.size = sizeof question_;
    question_.a = a;
    question_.b = b;
    question_.pose_a = pose(pose_a);
    question_.pose_b = pose(pose_b);
  }
  void ask(pdepth_settings settings) {
    settings.size = sizeof settings;
    question_.settings = &settings;
    pdepth_answer answer{};
    answer.size = sizeof answer;
    require(pdepth_depth(context_, &question_, &answer));
    hash_.add(answer);
    ++answers_;
  }
  void print() const { hash_.print(answers_); }

 private:
  void require(pdepth_status status) const {
    if (status == PDEPTH_OK) return;
    pdepth_error error{};
    pdepth_last_error(context_, &error);
    throw std::runtime_error(std::string(error.message) + " (" + error.where + ")");
  }
  void write(const std::vector<double>& numbers) {
    if (std::fwrite(numbers.data(), sizeof(double), numbers.size(), file_) != numbers.size())
      throw std::runtime_error("disk full");
  }
  Shape body(int kind, const std::vector<double>& numbers, double margin, pdepth_shape* core) {
    write({static_cast<double>(kind), static_cast<double>(numbers.size())});
    write(numbers);
    write({margin});
    Shape owned(core);
    if (margin == 0) return owned;
    pdepth_shape* swept = nullptr;
    require(pdepth_with_margin(context_, core, margin, &swept));
    return Shape(swept);
  }
  pdepth_pose pose(const pd::Pose& from) {
    pdepth_pose out{};
    const bool turns_by_quaternion = from.is_quaternion();
    out.form = turns_by_quaternion ? PDEPTH_POSE_QUATERNION_XYZW : PDEPTH_POSE_MATRIX;
    for (int k = 0; k < 3; ++k) out.numbers[k] = from.translation()[k];
    for (int k = 0; k < 4 && turns_by_quaternion; ++k) {
      out.numbers[3 + k] = from.quaternion_wxyz()[static_cast<std::size_t>(k + 1) % 4];
    }
    for (int k = 0; k < 9 && !turns_by_quaternion; ++k) out.numbers[3 + k] = from.rotation()(k / 3, k % 3);
    const int count = turns_by_quaternion ? 7 : 12;
    write({static_cast<double>(count)});
    write(std::vector<double>(out.numbers, out.numbers + count));
    return out;
  }

  std::FILE* file_;
  pdepth_context* context_ = nullptr;
  pdepth_question question_{};
  Hash hash_;
  std::int64_t answers_ = 0;
};

/// Asks for four answers about two hulls.
void ask_sharp(Questions& questions, std::int64_t i, Random& random) {
  static constexpr std::array kSizes = {4, 6, 8, 8, 12, 16, 24, 48};
  const auto family = static_cast<pd::scenes::PairFamily>(i % pd::scenes::kPairFamilies);
  const int n = kSizes[static_cast<std::size_t>(random.integer(0, static_cast<int>(kSizes.size()) - 1))];
  const auto depth = static_cast<pd::scenes::DepthClass>(random.integer(0, pd::scenes::kDepthClasses - 1));
  const pd::scenes::PointPair p = pd::scenes::make_pair(family, n, depth, 1000003 + static_cast<std::uint64_t>(i));
  double size = 0;
  for (const Vec3& point : p.b) size = std::max(size, point.cwiseAbs().maxCoeff());
  const bool is_ordinary = size > 1e-100 && size < 1e100;
  const Shape a = questions.hull(p.a, is_ordinary && i % 5 == 0 ? 0.1 * size : 0);
  const Shape b = questions.hull(p.b, 0);
  questions.pair(a.get(), p.pose_a, b.get(), p.pose_b);
  pdepth_settings settings{};
  questions.ask(settings);
  settings.bracket = PDEPTH_BRACKET_CERTIFIED;
  questions.ask(settings);
  settings.bracket = PDEPTH_BRACKET_CONTACT;
  settings.contact_tolerance = 1e-6;
  questions.ask(settings);
  settings.use_beyond = 1;
  settings.beyond = 1e-3;
  questions.ask(settings);
}

/// Asks for one answer about two curved bodies.
void ask_curved(Questions& questions, Random& random) {
  const Shape a = questions.curved(random);
  const Shape b = questions.curved(random);
  const Vec3 place_a = 0.5 * random.direction();
  const pd::Pose pose_a = random.pose(place_a);
  const Vec3 place_b = random.vector(0, 1.5);
  questions.pair(a.get(), pose_a, b.get(), random.pose(place_b));
  pdepth_settings settings{};
  settings.delta = 1e-3;
  questions.ask(settings);
}

}  // namespace

int main(int count, char** words) try {
  if (count != 3) throw std::runtime_error("web_answers PAIRS FILE");
  Questions questions(words[2]);
  for (std::int64_t i = 0; i < std::atoll(words[1]); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    random.next();
    ask_sharp(questions, i, random);
    ask_curved(questions, random);
  }
  questions.print();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
