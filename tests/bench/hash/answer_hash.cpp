#include "bench/hash/answer_hash.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/depth/width.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

namespace {

using scenes::DepthClass;
using scenes::PairFamily;
using scenes::Random;

/// The hash of a sequence of 64-bit words: multiply and mix (the finaliser of SplitMix64), order counts.
class Hash {
 public:
  void add(std::uint64_t word) {
    std::uint64_t z = (state_ ^ word) + 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    state_ = z ^ (z >> 31);
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Feature& f) {
    add(static_cast<std::uint64_t>(f.kind));
    add(static_cast<std::uint64_t>(f.first));
    add(static_cast<std::uint64_t>(f.second));
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

struct Row {
  std::int64_t answers = 0;
  Hash hash;
};

void add(Row& row, const PenetrationDepth& answer) {
  ++row.answers;
  Hash& h = row.hash;
  h.add(static_cast<std::uint64_t>(answer.contact));
  for (const double x :
       {answer.depth, answer.lower, answer.upper, answer.distance, answer.distance_lower, answer.distance_upper}) {
    h.add(x);
  }
  for (const Vec3* v : {&answer.translation, &answer.normal, &answer.witness_a, &answer.witness_b}) h.add(*v);
  h.add(answer.feature_a);
  h.add(answer.feature_b);
}

struct Pair {
  ConvexShape a;
  ConvexShape b;
  Pose pose_a;
  Pose pose_b;
};

class Hasher {
 public:
  explicit Hasher(const HashSettings& settings) : settings_(settings) {}

  std::map<std::string, Row> run() {
    for (std::int64_t i = 0; i < settings_.pairs; ++i) {
      Random random(settings_.seed * 0xD1B54A32D192ED03ULL + static_cast<std::uint64_t>(i));
      random.next();
      sharp(i, random);
      if (i % 4 == 0) curved(i, random);
    }
    return std::move(rows_);
  }

 private:
  void ask(const std::string& name, const Pair& pair, const DepthSettings& settings) {
    add(rows_[name], penetration_depth({&pair.a, pair.pose_a}, {&pair.b, pair.pose_b}, scratch_, settings));
  }

  void sharp(std::int64_t i, Random& random) {
    static constexpr std::array kSizes = {4, 5, 6, 8, 8, 8, 10, 12, 16, 16, 24, 32, 48, 64, 128, 300};
    const auto family = static_cast<PairFamily>(i % scenes::kPairFamilies);
    const int n = kSizes[static_cast<std::size_t>(random.integer(0, static_cast<int>(kSizes.size()) - 1))];
    const auto depth = static_cast<DepthClass>(random.integer(0, scenes::kDepthClasses - 1));
    const scenes::PointPair p =
        scenes::make_pair(family, n, depth, settings_.seed * 1000003 + static_cast<std::uint64_t>(i));
    const Pair pair{*ConvexPolytope::from_points(p.a), *ConvexPolytope::from_points(p.b), p.pose_a, p.pose_b};
    ask("auto tightest", pair, {});
    ask("auto certified", pair, {.bracket = Bracket::certified});
    ask("expansion tightest", pair, {.method = Method::expansion});
    ask("expansion certified", pair, {.method = Method::expansion, .bracket = Bracket::certified});
    warm(pair, random);
    rounded(pair, random);
    if (i % 8 == 0) contact(pair, random);
    if (n > 24 || i % 8 != 0) return;
    ask("overlay", pair, {.method = Method::overlay});
    ask("decomposition", pair, {.method = Method::decomposition});
    if (i % 32 != 0) return;
    if (n <= 12) ask("shallow, delta .5", pair, {.method = Method::shallow, .delta = 0.5});
    // Sizes far from 1 are the business of other tests; the grid's search is long there.
    if (family == PairFamily::sphere || family == PairFamily::box) {
      ask("grid, delta .1", pair, {.method = Method::grid, .delta = 0.1});
    }
  }

  /// Five frames with one memory; the second body drifts by a ten-thousandth of its place and size.
  void warm(const Pair& pair, Random& random) {
    WarmCertificate memory;
    const double step = 1e-4 * (pair.pose_b.translation().cwiseAbs().maxCoeff() + pair.b.polytope()->radius());
    const Vec3 drift = step * random.direction();
    for (int frame = 0; frame < 5; ++frame) {
      const Pose pose_b = Pose::from_trusted_matrix(pair.pose_b.rotation(), pair.pose_b.translation() + frame * drift);
      add(rows_["auto certified, warm"], penetration_depth({&pair.a, pair.pose_a}, {&pair.b, pose_b}, scratch_,
                                                           {.bracket = Bracket::certified}, &memory));
    }
  }

  void rounded(const Pair& pair, Random& random) {
    const double size = pair.a.polytope()->radius() + pair.b.polytope()->radius();
    if (!(size < 1e100) || !(size > 1e-100)) return;
    const auto a = pair.a.with_margin(0.1 * random.uniform() * size);
    const auto b = pair.b.with_margin(0.1 * random.uniform() * size);
    const Pair round{*a, *b, pair.pose_a, pair.pose_b};
    ask("rounded tightest", round, {});
    ask("rounded certified", round, {.bracket = Bracket::certified});
  }

  void contact(const Pair& pair, Random& random) {
    const PosedShape a{&pair.a, pair.pose_a};
    const PosedShape b{&pair.b, pair.pose_b};
    const PenetrationDepth answer = penetration_depth(a, b, scratch_);
    const ContactManifold manifold = contact_manifold(a, b, answer, 0.02, manifold_scratch_);
    Row& row = rows_["contact manifold"];
    ++row.answers;
    row.hash.add(manifold.normal);
    for (int k = 0; k < manifold.count; ++k) {
      const ContactPoint& point = manifold.points[static_cast<std::size_t>(k)];
      row.hash.add(point.position_a);
      row.hash.add(point.position_b);
      row.hash.add(point.depth);
      row.hash.add(static_cast<std::uint64_t>(point.feature_id));
    }
    const auto along = directional_depth(a, b, random.direction(), scratch_);
    if (!along) return;
    Row& directional = rows_["directional depth"];
    ++directional.answers;
    for (const double x : {along->depth, along->lower, along->upper}) directional.hash.add(x);
    directional.hash.add(along->normal);
  }

  [[nodiscard]] ConvexShape curved_shape(Random& random) const {
    const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1), z = random.uniform(0.2, 1);
    const int axis = random.integer(0, 2);
    switch (random.integer(0, 5)) {
      case 0:
        return *ConvexShape::sphere(x);
      case 1:
        return *ConvexShape::capsule(x, y, axis);
      case 2:
        return *ConvexShape::cylinder(x, y, axis);
      case 3:
        return *ConvexShape::cone(x, y, axis);
      case 4:
        return *ConvexShape::ellipsoid({x, y, z});
      default:
        return *ConvexPolytope::from_points(scenes::sphere_hull(random.integer(4, 40), random));
    }
  }

  void curved(std::int64_t i, Random& random) {
    const auto pose = [&](double reach) {
      const Vec3 translation = reach * random.direction();
      return random.pose(translation);
    };
    const Pair pair{curved_shape(random), curved_shape(random), pose(0.5), pose(random.uniform(0, 1.5))};
    ask("curved, delta 1e-2", pair, {.delta = 1e-2});
    ask("curved, delta 1e-4", pair, {.delta = 1e-4});
    if (i % 64 == 0) ask("curved grid, delta .1", pair, {.method = Method::grid, .delta = 0.1});
  }

  const HashSettings& settings_;
  Scratch scratch_;
  ManifoldScratch manifold_scratch_;
  std::map<std::string, Row> rows_;
};

std::string hash_text(const Row& row) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016" PRIx64, row.hash.value());
  return text.data();
}

std::string line_of(const std::string& name, const Row& row) {
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), "%-24s %9" PRId64 "  %s", name.c_str(), row.answers, hash_text(row).c_str());
  return line.data();
}

std::string to_text(const HashSettings& settings, const std::map<std::string, Row>& rows) {
  std::string text = "pairs " + std::to_string(settings.pairs) + ", seed " + std::to_string(settings.seed) + "\n";
  std::int64_t answers = 0;
  for (const auto& [name, row] : rows) {
    text += line_of(name, row) + "\n";
    answers += row.answers;
  }
  return text + "answers " + std::to_string(answers) + "\n";
}

/// The rows for a page. @param expected  empty: rows are compared with nothing
void describe(const std::map<std::string, Row>& rows, const std::string& expected, HashOutcome& outcome) {
  outcome.compared = !expected.empty();
  outcome.rows = static_cast<int>(rows.size());
  outcome.csv = outcome.compared ? "question,answers,hash,same\n" : "question,answers,hash\n";
  std::istringstream lines(expected);
  std::vector<std::string> known;
  for (std::string line; std::getline(lines, line);) known.push_back(line);
  for (const auto& [name, row] : rows) {
    outcome.answers += row.answers;
    outcome.csv += "\"" + name + "\"," + std::to_string(row.answers) + ",0x" + hash_text(row);
    if (outcome.compared) {
      const bool same = std::find(known.begin(), known.end(), line_of(name, row)) != known.end();
      outcome.differing += same ? 0 : 1;
      outcome.csv += same ? ",equal" : ",differs";
    }
    outcome.csv += "\n";
  }
}

/// Names the rows in which two texts differ. @return the exit code.
int compare(const std::string& expected, const std::string& found) {
  std::istringstream left(expected), right(found);
  std::string a, b;
  int differing = 0;
  for (int line = 0; std::getline(left, a); ++line) {
    if (!std::getline(right, b)) b.clear();
    if (a == b) continue;
    if (line == 0) {
      std::fprintf(stderr, "the file to compare with was made otherwise: %s, here %s\n", a.c_str(), b.c_str());
      return 2;
    }
    std::fprintf(stderr, "differs: expected %s\n            found %s\n", a.c_str(), b.c_str());
    ++differing;
  }
  if (differing == 0) std::printf("equal to the file\n");
  return differing == 0 ? 0 : 1;
}

}  // namespace

int run_hash(const HashSettings& settings, HashOutcome* outcome) {
  const std::map<std::string, Row> rows = Hasher(settings).run();
  const std::string text = to_text(settings, rows);
  std::fputs(text.c_str(), stdout);
  if (!settings.out.empty()) {
    std::ofstream file(settings.out);
    if (!(file << text).flush()) {
      std::fprintf(stderr, "%s: cannot be written\n", settings.out.c_str());
      return 1;
    }
  }
  std::ostringstream expected;
  if (!settings.check.empty()) {
    std::ifstream file(settings.check);
    if (!file) {
      std::fprintf(stderr, "%s: cannot be read\n", settings.check.c_str());
      return 2;
    }
    expected << file.rdbuf();
  }
  if (outcome != nullptr) describe(rows, expected.str(), *outcome);
  return settings.check.empty() ? 0 : compare(expected.str(), text);
}

}  // namespace pd::bench
