/// @file
/// `slowest_pairs`: searches, for each query and size, the pair that takes longest, by climbing from the slowest of all
/// families. A step changes a few things of the pair that a generator would not: a vertex, by a share of the body or
/// by an ulp, onto another's plane or place; a pose, a little or by a symmetry; a size. It stays where that made the
/// query dearer.
///
/// Cost is the least processor time of several runs, warm caches, on a thread of its own: shared cores disturb it
/// upwards only. What is found is written as lines of the protocol; `--replay` asks such lines again, once each, for
/// callgrind to count. `pdepth query` answers depths `tightest` and refuses the lines of `certified` and `contact` by
/// the field that names these.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace {

using pd::Vec3;
using pd::scenes::PointPair;
using pd::scenes::Random;

/// What a query is asked with.
struct Workplace {
  pd::Scratch scratch;
  pd::ManifoldScratch manifold;
};
struct Query {
  const char* name;
  nlohmann::ordered_json fields;  ///< of its line
  std::function<void(const pd::PosedShape&, const pd::PosedShape&, Workplace&)> ask;
};

std::vector<Query> queries() {
  const auto depth = [](pd::DepthSettings settings) {
    return [settings](const pd::PosedShape& a, const pd::PosedShape& b, Workplace& place) {
      (void)pd::penetration_depth(a, b, place.scratch, settings);
    };
  };
  return {{"certified", {{"query", "depth"}, {"bracket", "certified"}}, depth({.bracket = pd::Bracket::certified})},
          {"tightest", {{"query", "depth"}}, depth({.bracket = pd::Bracket::tightest})},
          {"contact", {{"query", "depth"}, {"bracket", "contact"}}, depth({.bracket = pd::Bracket::contact})},
          {"overlay", {{"query", "depth"}, {"method", "overlay"}}, depth({.method = pd::Method::overlay})},
          {"directional",
           {{"query", "directional_depth"}, {"direction", {1, 2, 3}}},
           [](const pd::PosedShape& a, const pd::PosedShape& b, Workplace& place) {
             (void)pd::directional_depth(a, b, {1, 2, 3}, place.scratch);
           }},
          {"manifold",
           {{"query", "contact_manifold"}},
           [](const pd::PosedShape& a, const pd::PosedShape& b, Workplace& place) {
             const pd::PenetrationDepth answer = pd::penetration_depth(a, b, place.scratch);
             (void)pd::contact_manifold(a, b, answer, 0.02, place.manifold);
           }}};
}

/// Seconds of the query about the pair, least of `runs`; none where a body is refused.
std::optional<double> cost(const Query& query, const PointPair& pair, Workplace& place, int runs) {
  const auto a = pd::ConvexPolytope::from_points(pair.a);
  const auto b = pd::ConvexPolytope::from_points(pair.b);
  if (!a || !b) return std::nullopt;
  const pd::ConvexShape shape_a(*a);
  const pd::ConvexShape shape_b(*b);
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    const double start = pd::bench::processor_seconds();
    query.ask({&shape_a, pair.pose_a}, {&shape_b, pair.pose_b}, place);
    least = std::min(least, pd::bench::processor_seconds() - start);
  }
  return least;
}

std::size_t any_of(const pd::scenes::Points& points, Random& random) {
  return static_cast<std::size_t>(random.integer(0, static_cast<int>(points.size()) - 1));
}

/// 1, .1, ... 1e-15
double small(Random& random) { return std::pow(10.0, -random.integer(0, 15)); }

/// A direction, of such a length.
Vec3 small_vector(Random& random) {
  const Vec3 unit = random.direction();
  return small(random) * unit;
}

void change_points(pd::scenes::Points& points, Random& random) {
  const std::size_t i = any_of(points, random);
  const std::size_t j = any_of(points, random);
  const std::size_t k = any_of(points, random);
  switch (random.integer(0, 5)) {
    case 0:
      points[i] += points[j].norm() * small_vector(random);
      break;
    case 1:
      points[i] = points[j] + small(random) * (points[k] - points[j]);
      break;
    case 2:
      points[i][random.integer(0, 2)] = points[j][random.integer(0, 2)];
      break;
    case 3:
      points[i] = points[j] + points[k] - points[i];
      break;
    case 4: {
      const double most = small(random);
      points[i] *= 1 + random.uniform(-most, most);
      break;
    }
    default:
      for (Vec3& p : points) p += 0.1 * p.norm() * small_vector(random);
  }
}

pd::Pose changed(const pd::Pose& pose, double size, Random& random) {
  switch (random.integer(0, 3)) {
    case 0:
      return pd::Pose::from_trusted_matrix(pose.rotation(), pose.translation() + size * small_vector(random));
    case 1: {
      const Vec3 axis = random.direction();
      const double turn = small(random);
      const double w = std::sqrt(std::max(0.0, 1 - turn * turn));
      const auto by = pd::Pose::from_quaternion({w, turn * axis.x(), turn * axis.y(), turn * axis.z()}, Vec3::Zero());
      if (!by) return pose;
      return pd::Pose::from_trusted_matrix(by->rotation() * pose.rotation(), pose.translation());
    }
    case 2:
      return pd::Pose::from_trusted_matrix(pd::Mat3::Identity(), pose.translation());
    default: {
      const auto turned = pd::Pose::from_quaternion(random.quaternion(), pose.translation());
      return turned ? *turned : pose;
    }
  }
}

PointPair changed(PointPair pair, Random& random) {
  const int steps = random.integer(1, 3);
  for (int s = 0; s < steps; ++s) {
    switch (random.integer(0, 7)) {
      case 0:
        pair.b = pair.a;
        break;
      case 1:
      case 2:
      case 3:
        pair.pose_b = changed(pair.pose_b, pair.a[0].norm(), random);
        break;
      default:
        change_points(random.integer(0, 1) == 0 ? pair.a : pair.b, random);
    }
  }
  return pair;
}

using Json = nlohmann::ordered_json;

Json json_of(const pd::Pose& pose) {
  const pd::Mat3& r = pose.rotation();
  const Vec3& t = pose.translation();
  // A quaternion is turned into a matrix exactly, as a fraction: rounded to one it would be another pair.
  if (pose.is_quaternion())
    return {{"quaternion_wxyz", pose.quaternion_wxyz()}, {"translation", {t.x(), t.y(), t.z()}}};
  return {{"rotation_row_major", {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}},
          {"translation", {t.x(), t.y(), t.z()}}};
}

Json json_of(const pd::scenes::Points& points) {
  Json vertices = Json::array();
  for (const Vec3& p : points) vertices.push_back({p.x(), p.y(), p.z()});
  return {{"type", "convex"}, {"vertices", std::move(vertices)}};
}

std::string line_of(const Query& query, const PointPair& pair) {
  Json line = query.fields;
  line["a"] = json_of(pair.a);
  line["pose_a"] = json_of(pair.pose_a);
  line["b"] = json_of(pair.b);
  line["pose_b"] = json_of(pair.pose_b);
  return line.dump();
}

Vec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

pd::Pose pose_of(const Json& json) {
  const Vec3 translation = vector_of(json.at("translation"));
  if (json.contains("quaternion_wxyz")) {
    return pd::Pose::from_quaternion(json["quaternion_wxyz"].get<std::array<double, 4>>(), translation).value();
  }
  pd::Mat3 rotation;
  for (int k = 0; k < 9; ++k)
    rotation(k / 3, k % 3) = json.at("rotation_row_major").at(static_cast<std::size_t>(k)).get<double>();
  return pd::Pose::from_trusted_matrix(rotation, translation);
}

pd::scenes::Points points_of(const Json& json) {
  pd::scenes::Points points;
  for (const Json& vertex : json.at("vertices")) points.push_back(vector_of(vertex));
  return points;
}

/// Asks every line that a search wrote, by the query whose fields it has. @return whether all lines could be asked
bool replay(const std::string& file) {
  std::ifstream lines(file);
  std::string text;
  Workplace place;
  const std::vector<Query> known = queries();
  bool all = true;
  for (int number = 1; std::getline(lines, text); ++number) {
    const auto refused = [&](const std::string& why) {
      std::fprintf(stderr, "%s, line %d: %s\n", file.c_str(), number, why.c_str());
      all = false;
    };
    try {
      Json line = Json::parse(text);
      const PointPair pair{points_of(line.at("a")), points_of(line.at("b")), pose_of(line.at("pose_a")),
                           pose_of(line.at("pose_b"))};
      for (const char* body : {"a", "pose_a", "b", "pose_b"}) line.erase(body);
      const auto query = std::find_if(known.begin(), known.end(), [&](const Query& q) { return line == q.fields; });
      if (query == known.end()) {
        refused("no query of these fields: " + line.dump());
        continue;
      }
      const auto seconds = cost(*query, pair, place, 1);
      if (!seconds) {
        refused("a body was refused");
        continue;
      }
      std::printf("%-12s %9.2f us\n", query->name, 1e6 * *seconds);
    } catch (const Json::exception& error) {
      refused(error.what());
    }
  }
  return all;
}

struct Found {
  PointPair pair;
  double seconds = 0;
  std::string from;
};

/// Dearer pairs than so many times the median are counted.
constexpr double kMostMedians = 50;

struct Settings {
  std::vector<int> sizes = {4, 8, 16, 32, 64};
  std::vector<std::string> queries;
  int draws = 3;
  int climbers = 8;
  double seconds = 10;
  std::uint64_t seed = 1;
  std::string lines;
  std::string replayed;
};

/// One query at one size: the median of what the families draw, then the climb.
void search(const Query& query, int size, const Settings& settings, std::ofstream& lines) {
  Workplace place;
  std::vector<Found> starts;
  for (int f = 0; f < pd::scenes::kPairFamilies; ++f) {
    for (int depth = 0; depth < pd::scenes::kDepthClasses; ++depth) {
      for (int draw = 0; draw < settings.draws; ++draw) {
        const auto family = static_cast<pd::scenes::PairFamily>(f);
        PointPair pair = pd::scenes::make_pair(family, size, static_cast<pd::scenes::DepthClass>(depth),
                                               settings.seed * 1000003 + static_cast<std::uint64_t>(draw));
        if (const auto seconds = cost(query, pair, place, 3)) {
          starts.push_back({std::move(pair), *seconds, std::string(pd::scenes::to_string(family))});
        }
      }
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Found& x, const Found& y) { return x.seconds > y.seconds; });
  const double median = starts[starts.size() / 2].seconds;
  const double slowest = starts.front().seconds;
  const auto above = std::count_if(starts.begin(), starts.end(),
                                   [&](const Found& found) { return found.seconds > kMostMedians * median; });
  starts.resize(std::min(starts.size(), static_cast<std::size_t>(settings.climbers)));
  Random random(settings.seed + 77 * static_cast<std::uint64_t>(size));
  const double start = pd::bench::processor_seconds();
  int tried = 0;
  for (std::size_t turn = 0; pd::bench::processor_seconds() - start < settings.seconds;
       turn = (turn + 1) % starts.size()) {
    Found& climber = starts[turn];
    PointPair next = changed(climber.pair, random);
    ++tried;
    const auto first = cost(query, next, place, 2);
    if (!first || *first < climber.seconds) continue;
    const double again = *cost(query, next, place, 5);
    if (again >= climber.seconds) {
      climber.pair = std::move(next);
      climber.seconds = again;
    }
  }
  Found& worst = *std::max_element(starts.begin(), starts.end(),
                                   [](const Found& x, const Found& y) { return x.seconds < y.seconds; });
  worst.seconds = *cost(query, worst.pair, place, 9);
  std::printf("%-12s %5d %9.2f %9.2f %6d %9.2f %8.1f  %-20s %d\n", query.name, size, 1e6 * median, 1e6 * slowest,
              static_cast<int>(above), 1e6 * worst.seconds, worst.seconds / median, worst.from.c_str(), tried);
  std::fflush(stdout);
  if (lines.is_open()) lines << line_of(query, worst.pair) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Climbs to the slowest pair of each query and size."};
  app.add_option("--sizes", settings.sizes, "vertices of a body")->delimiter(',')->capture_default_str();
  app.add_option("--queries", settings.queries, "certified, tightest, contact, overlay, directional, manifold")
      ->delimiter(',');
  app.add_option("--draws", settings.draws, "pairs of each family and depth")->capture_default_str();
  app.add_option("--climbers", settings.climbers, "of the slowest, each climbs on its own")->capture_default_str();
  app.add_option("--seconds", settings.seconds, "of climbing, a query and size")->capture_default_str();
  app.add_option("--seed", settings.seed)->capture_default_str();
  app.add_option("--lines", settings.lines, "file that takes the finds as lines of the protocol");
  app.add_option("--replay", settings.replayed, "file of such lines: asks each once and searches nothing")
      ->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  if (!settings.replayed.empty()) return replay(settings.replayed) ? 0 : 2;
  std::ofstream lines;
  if (!settings.lines.empty()) {
    lines.open(settings.lines);
    if (!lines) {
      std::fprintf(stderr, "%s cannot be written\n", settings.lines.c_str());
      return 2;
    }
  }
  std::printf("seed %llu; microseconds\n%-12s %5s %9s %9s %6s %9s %8s  %-20s %s\n",
              static_cast<unsigned long long>(settings.seed), "query", "size", "median", "families", "> 50", "climbed",
              "/ median", "climbed from", "tried");
  for (const Query& query : queries()) {
    const auto named = [&](const std::string& name) { return name == query.name; };
    if (!settings.queries.empty() && std::none_of(settings.queries.begin(), settings.queries.end(), named)) continue;
    for (const int size : settings.sizes) search(query, size, settings, lines);
  }
  return 0;
}
