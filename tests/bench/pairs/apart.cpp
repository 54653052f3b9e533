#include "bench/pairs/apart.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "bench/pairs/judge.hpp"
#include "bench/pairs/pairs.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {

namespace {

using scenes::PairFamily;

constexpr int kFrames = 4;
constexpr double kStepRadians = 0.01;

struct Family {
  PairFamily family;
  bool one_size;
};
constexpr Family kFamilies[] = {
    {PairFamily::sphere, false}, {PairFamily::box, true}, {PairFamily::needle, false}, {PairFamily::prism, false}};

bool asked(const std::vector<std::string>& names, PairFamily family) {
  return names.empty() || std::find(names.begin(), names.end(), scenes::to_string(family)) != names.end();
}

scenes::Points posed(const ConvexShape& shape, const Pose& pose, Precision precision) {
  const Pose at = received(pose, precision);
  scenes::Points points = vertices_of(shape);
  for (Vec3& p : points) p = at.apply(received(p, precision));
  return points;
}

/// Indices of at most `count` points that reach farthest in the direction.
std::vector<std::size_t> farthest(const scenes::Points& points, const Vec3& direction, std::size_t count) {
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return points[i].dot(direction) > points[j].dot(direction); });
  order.resize(std::min(order.size(), count));
  return order;
}

oracle::Body body_of(const ConvexShape& shape, const std::vector<std::size_t>& chosen, Precision precision) {
  const scenes::Points all = vertices_of(shape);
  scenes::Points points;
  for (const std::size_t i : chosen) points.push_back(received(all[i], precision));
  return oracle::Body(points);
}

/// Exact, of the hulls of the chosen vertices.
double distance_of(const Bodies& bodies, const Standing& at, Precision precision, const std::vector<std::size_t>& of_a,
                   const std::vector<std::size_t>& of_b) {
  const oracle::Body a = body_of(bodies.a, of_a, precision);
  const oracle::Body b = body_of(bodies.b, of_b, precision);
  const oracle::ExactPair pair(a, received(at.a, precision), b, received(at.b, precision));
  const oracle::Verdict verdict = oracle::judge(pair);
  if (verdict.contact != ContactClass::separated) return 0;
  return verdict.distance_known ? verdict.distance.approximate() : kUnknown;
}

}  // namespace

Expected<std::vector<ApartCell>> choose_apart(const std::vector<std::string>& families,
                                              const std::vector<int>& vertices, bool quick) {
  for (const std::string& name : families) {
    const bool there = std::any_of(std::begin(kFamilies), std::end(kFamilies),
                                   [&](const Family& f) { return scenes::to_string(f.family) == name; });
    if (!there) return Error{ErrorCode::bad_value, "no family of this name: " + name, "--families"};
  }
  std::vector<int> sizes = vertices;
  if (sizes.empty()) sizes = quick ? std::vector<int>{8, 32, 128} : std::vector<int>{8, 32, 128, 512, 2048};
  std::vector<ApartCell> cells;
  for (const Family& f : kFamilies) {
    if (!asked(families, f.family)) continue;
    for (const int n : sizes) {
      if (f.one_size && n != 8) continue;
      for (const double share : {0.01, 0.1, 1.0}) cells.push_back({f.family, n, share});
    }
  }
  if (cells.empty()) return Error{ErrorCode::bad_value, "no pair has this family and size", "--vertices"};
  return cells;
}

std::vector<Standing> frames_apart(const Bodies& bodies, double gap_share, int count, scenes::Random& random) {
  const Extent extent_a = extent_of(vertices_of(bodies.a));
  const Extent extent_b = extent_of(vertices_of(bodies.b));
  const double gap = gap_share * std::min(extent_a.size.minCoeff(), extent_b.size.minCoeff());
  const Vec3 line = random.direction();
  const Vec3 axes[2] = {random.direction(), random.direction()};
  Eigen::Quaterniond attitudes[2];
  for (Eigen::Quaterniond& q : attitudes) {
    const auto drawn = random.quaternion();
    q = Eigen::Quaterniond(drawn[0], drawn[1], drawn[2], drawn[3]).normalized();
  }
  Scratch scratch;
  std::vector<Standing> frames;
  for (int i = 0; i < count; ++i) {
    std::array<double, 4> wxyz[2];
    for (int k = 0; k < 2; ++k) {
      attitudes[k] = (Eigen::Quaterniond(Eigen::AngleAxisd(kStepRadians / 2, axes[k])) * attitudes[k]).normalized();
      wxyz[k] = {attitudes[k].w(), attitudes[k].x(), attitudes[k].y(), attitudes[k].z()};
    }
    const Pose a = *Pose::from_quaternion(wxyz[0], Vec3::Zero());
    const Pose turned = *Pose::from_quaternion(wxyz[1], Vec3::Zero());
    const Vec3 start = a.apply(extent_a.middle) - turned.apply(extent_b.middle);
    double near = 0;
    double far = 2 * (extent_a.size.norm() + extent_b.size.norm()) + 2 * gap;
    // The middles meet at 0, and the distance grows with the way from the first touch on.
    for (int step = 0; step < 40; ++step) {
      const double way = 0.5 * (near + far);
      const Pose b = *Pose::from_quaternion(wxyz[1], start + way * line);
      const DepthSettings settings{.bracket = Bracket::certified};
      const double distance = penetration_depth({&bodies.a, a}, {&bodies.b, b}, scratch, settings).distance;
      (distance < gap ? near : far) = way;
    }
    frames.push_back({a, *Pose::from_quaternion(wxyz[1], start + far * line), gap});
  }
  return frames;
}

double ApartJudge::error(const Answer& answer, const Standing& at, double limit, Precision precision) const {
  if (answer.overlapping || std::isnan(answer.distance) || !answer.translation.allFinite()) return 1;
  const scenes::Points a = posed(bodies_.a, at.a, precision);
  const scenes::Points b = posed(bodies_.b, at.b, precision);
  const bool farther = std::isinf(answer.distance);
  const double length = answer.translation.norm();
  constexpr std::size_t kNearest = 48;
  if (length > 0) {
    const Vec3 u = answer.translation / length;
    const auto top = farthest(a, u, kNearest);
    const auto bottom = farthest(b, -u, kNearest);
    const double below = b[bottom[0]].dot(u) - a[top[0]].dot(u);
    if (farther && below > limit) return 0;
    const double slack = kTolerance * answer.distance;
    if (!farther && below >= answer.distance - slack) {
      const double above = distance_of(bodies_, at, precision, top, bottom);
      const double off = std::max(answer.distance - below, std::abs(answer.distance - above));
      if (off <= slack) return off / above;
    }
  }
  const double truth =
      distance_of(bodies_, at, precision, farthest(a, Vec3::UnitX(), a.size()), farthest(b, Vec3::UnitX(), b.size()));
  if (farther) return truth > limit ? 0 : 1;
  return truth > 0 ? std::min(std::abs(answer.distance - truth) / truth, 1.0) : 1;
}

std::vector<Row> run_apart(const ApartSettings& settings, Solvers& solvers) {
  std::vector<Row> rows;
  print_header();
  std::uint64_t number = 0;
  for (const ApartCell& cell : settings.cells) {
    std::vector<Tally> tallies(solvers.size());
    for (int done = 0, refused = 0; done < settings.pairs && refused < 20 * settings.pairs;) {
      const std::optional<Draw> d =
          draw({cell.family, cell.vertices, scenes::DepthClass::mid}, settings.seed, number++);
      if (!d) {
        ++refused;
        continue;
      }
      scenes::Random random(settings.seed * 0x9E3779B97F4A7C15ULL + number);
      const ApartJudge judge(d->bodies);
      measure_frames(
          d->bodies, frames_apart(d->bodies, cell.gap_share, kFrames, random), solvers,
          [&](const Answer& answer, const Standing& at, Precision precision) {
            return judge.error(answer, at, at.limit(), precision);
          },
          tallies);
      ++done;
    }
    const std::vector<Row> block = rows_of(solvers, tallies, scenes::to_string(cell.family), cell.vertices,
                                           fmt::format("gap {:.0f}%", 100 * cell.gap_share), kBulletGjk);
    print_rows(block);
    rows.insert(rows.end(), block.begin(), block.end());
  }
  return rows;
}

}  // namespace pd::bench
