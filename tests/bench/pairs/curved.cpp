#include "bench/pairs/curved.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "bench/pairs/judge.hpp"
#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {

namespace {

using scenes::Random;
using scenes::to_single;

constexpr int kFrames = 4;
constexpr double kStepRadians = 0.01;
constexpr int kHull = 32;

struct Named {
  CurvedPair pair;
  std::string_view name;
  bool inside;
};
constexpr Named kPairs[] = {
    {CurvedPair::sphere_sphere, "sphere/sphere", false},
    {CurvedPair::capsule_capsule, "capsule/capsule", false},
    {CurvedPair::capsule_box, "capsule/box", false},
    {CurvedPair::cylinder_box, "cylinder/box", false},
    {CurvedPair::cone_hull, "cone/hull", false},
    {CurvedPair::ellipsoid_ellipsoid, "ellipsoid/ellipsoid", false},
    {CurvedPair::ball_small, "ball/small", true},
    {CurvedPair::near_ball_small, "ball1.001/small", true},
    {CurvedPair::tenth_ball_small, "ball1.1/small", true},
    {CurvedPair::ball_cylinder, "ball/cylinder", true},
    {CurvedPair::ball_cone, "ball/cone", true},
    {CurvedPair::cylinder_sphere, "cylinder/sphere", true},
    {CurvedPair::cone_sphere, "cone/sphere", true},
    {CurvedPair::spheres_box, "spheres/box", false},
    {CurvedPair::spheres_spheres, "spheres/spheres", false},
};

double size(Random& random) { return to_single(random.uniform(0.5, 1)); }
Vec3 sizes(Random& random) {
  const double x = size(random), y = size(random);
  return {x, y, size(random)};
}

/// Radii within the ratio, the least 1.
ConvexShape near_ball(double least, double ratio, Random& random) {
  Vec3 radii;
  for (double& r : radii) r = to_single(least * random.uniform(1, ratio));
  return *ConvexShape::ellipsoid(radii);
}

ConvexShape hull(double radius, Random& random) {
  scenes::Points points = scenes::sphere_hull(kHull, random);
  for (Vec3& p : points) p = to_single(Vec3(radius * p));
  return *ConvexPolytope::from_points(points);
}

/// Of radii of .2 to .8 of the size, round about its middle: none holds another.
ConvexShape sphere_hull(int count, double size, Random& random) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double radius = to_single(size * random.uniform(0.2, 0.8));
    spheres.push_back({to_single(Vec3((size - radius) * random.direction())), radius});
  }
  return *ConvexShape::hull_of_spheres(spheres);
}

ConvexShape small_body(Random& random) {
  const double tenth = to_single(0.1 * random.uniform(0.5, 1));
  switch (random.integer(0, 5)) {
    case 0:
      return *ConvexShape::sphere(tenth);
    case 1:
      return near_ball(tenth, 1.001, random);
    case 2:
      return *ConvexShape::ellipsoid(to_single(Vec3(0.1 * sizes(random))));
    case 3:
      return *ConvexPolytope::box(to_single(Vec3(0.1 * sizes(random))));
    case 4:
      return hull(tenth, random);
    default:
      return *ConvexShape::capsule(tenth, tenth, 2);
  }
}

ConvexShape small_turned(bool cone, Random& random) {
  const double radius = to_single(0.1 * size(random)), half_height = to_single(0.1 * size(random));
  return cone ? *ConvexShape::cone(radius, half_height, 2) : *ConvexShape::cylinder(radius, half_height, 2);
}

/// Two attitudes, turned a little from frame to frame.
class Attitudes {
 public:
  explicit Attitudes(Random& random) {
    for (int k = 0; k < 2; ++k) {
      axes_[k] = random.direction();
      const auto drawn = random.quaternion();
      turns_[k] = Eigen::Quaterniond(drawn[0], drawn[1], drawn[2], drawn[3]).normalized();
    }
  }
  void step() {
    for (int k = 0; k < 2; ++k) {
      turns_[k] = (Eigen::Quaterniond(Eigen::AngleAxisd(kStepRadians / 2, axes_[k])) * turns_[k]).normalized();
    }
  }
  [[nodiscard]] Pose at(int k, const Vec3& translation) const {
    const Eigen::Quaterniond& q = turns_[k];
    return to_single(*Pose::from_quaternion({q.w(), q.x(), q.y(), q.z()}, translation));
  }

 private:
  Vec3 axes_[2];
  Eigen::Quaterniond turns_[2];
};

PenetrationDepth depth_of(const Bodies& bodies, const Pose& a, const Pose& b, Scratch& scratch) {
  return penetration_depth({&bodies.a, a}, {&bodies.b, b}, scratch, {.bracket = Bracket::certified});
}

bool is_of_spheres(CurvedPair pair) { return pair == CurvedPair::spheres_box || pair == CurvedPair::spheres_spheres; }

/// FCL's signed distance of a ball in a ball may take minutes for one call; hulls of spheres it has none.
std::vector<char> sitting_out(const Solvers& solvers, const CurvedCell& cell) {
  std::vector<char> sits_out;
  for (const auto& solver : solvers) {
    const bool endless = cell.depth == 0 && solver->name() == kFclDistance;
    sits_out.push_back(endless || (is_of_spheres(cell.pair) && solver->name().starts_with("fcl")) ? 1 : 0);
  }
  return sits_out;
}

}  // namespace

std::string_view to_string(CurvedPair pair) {
  for (const Named& named : kPairs) {
    if (named.pair == pair) return named.name;
  }
  return {};
}

Expected<std::vector<CurvedCell>> choose_curved(const std::vector<std::string>& families) {
  std::vector<CurvedCell> cells;
  for (const std::string& name : families) {
    const bool there =
        std::any_of(std::begin(kPairs), std::end(kPairs), [&](const Named& n) { return n.name == name; });
    if (!there) return Error{ErrorCode::bad_value, "no family of this name: " + name, "--families"};
  }
  for (const Named& named : kPairs) {
    if (!families.empty() && std::find(families.begin(), families.end(), named.name) == families.end()) continue;
    if (named.inside) {
      cells.push_back({named.pair, 0});
    } else {
      cells.insert(cells.end(), {{named.pair, 0.01}, {named.pair, 0.1}});
    }
  }
  return cells;
}

Bodies curved_bodies(CurvedPair pair, Random& random) {
  const double r = size(random), h = size(random), other = size(random);
  switch (pair) {
    case CurvedPair::sphere_sphere:
      return {*ConvexShape::sphere(r), *ConvexShape::sphere(h)};
    case CurvedPair::capsule_capsule:
      return {*ConvexShape::capsule(r, h, 2), *ConvexShape::capsule(other, size(random), 2)};
    case CurvedPair::capsule_box:
      return {*ConvexShape::capsule(r, h, 2), *ConvexPolytope::box(sizes(random))};
    case CurvedPair::cylinder_box:
      return {*ConvexShape::cylinder(r, h, 2), *ConvexPolytope::box(sizes(random))};
    case CurvedPair::cone_hull:
      return {*ConvexShape::cone(r, h, 2), hull(other, random)};
    case CurvedPair::ellipsoid_ellipsoid: {
      ConvexShape one = *ConvexShape::ellipsoid(sizes(random));
      return {std::move(one), *ConvexShape::ellipsoid(sizes(random))};
    }
    case CurvedPair::ball_small:
      return {near_ball(1, 1, random), small_body(random)};
    case CurvedPair::near_ball_small: {
      ConvexShape ball = near_ball(1, 1.001, random);
      return {std::move(ball), small_body(random)};
    }
    case CurvedPair::tenth_ball_small: {
      ConvexShape ball = near_ball(1, 1.1, random);
      return {std::move(ball), small_body(random)};
    }
    case CurvedPair::ball_cylinder:
    case CurvedPair::ball_cone:
      return {near_ball(1, 1, random), small_turned(pair == CurvedPair::ball_cone, random)};
    case CurvedPair::cylinder_sphere:
      return {*ConvexShape::cylinder(r, h, 2), *ConvexShape::sphere(to_single(0.1 * other))};
    case CurvedPair::cone_sphere:
      break;
    case CurvedPair::spheres_box: {
      ConvexShape spheres = sphere_hull(3, r, random);
      return {std::move(spheres), *ConvexPolytope::box(sizes(random))};
    }
    case CurvedPair::spheres_spheres: {
      ConvexShape spheres = sphere_hull(3, r, random);
      return {std::move(spheres), sphere_hull(4, h, random)};
    }
  }
  return {*ConvexShape::cone(r, h, 2), *ConvexShape::sphere(to_single(0.1 * other))};
}

std::vector<Standing> frames_inside(const Bodies& bodies, double depth, int count, Random& random) {
  constexpr double kMostReach = 4;  // of two bodies of radii and half heights up to 1
  const Vec3 line = random.direction();
  Attitudes attitudes(random);
  Scratch scratch;
  std::vector<Standing> frames;
  const int where = random.integer(0, 3);
  const double inside = where == 0 ? 0 : where == 1 ? random.uniform(0, 0.15) : random.uniform(0.15, 0.45);
  for (int i = 0; i < count; ++i) {
    attitudes.step();
    const Pose a = attitudes.at(0, Vec3::Zero());
    double way = inside;
    if (depth > 0) {
      double near = 0;
      double far = kMostReach;
      if (depth_of(bodies, a, attitudes.at(1, Vec3::Zero()), scratch).depth < depth) return {};
      for (int step = 0; step < 32; ++step) {
        way = 0.5 * (near + far);
        (depth_of(bodies, a, attitudes.at(1, way * line), scratch).depth > depth ? near : far) = way;
      }
      way = near;
    }
    const Pose b = attitudes.at(1, way * line);
    if (depth_of(bodies, a, b, scratch).contact != ContactClass::overlapping) return {};
    frames.push_back({a, b, -depth});
  }
  return frames;
}

double CurvedJudge::depth(const Standing& at) const {
  const PosedShape a{&bodies_.a, at.a}, b{&bodies_.b, at.b};
  const oracle::Sweep sweep = oracle::sweep_directions(a, b, 600, 4);
  Scratch scratch;
  const PenetrationDepth own = depth_of(bodies_, at.a, at.b, scratch);
  return static_cast<double>(std::min(sweep.least, oracle::difference_support(a, b, own.normal)));
}

double CurvedJudge::error(const Answer& answer, const Standing& at, double truth) const {
  const double length = answer.translation.norm();
  if (!answer.overlapping || !std::isfinite(answer.depth) || !(length > 0) || !std::isfinite(length)) return 1;
  const long double reach = oracle::difference_support({&bodies_.a, at.a}, {&bodies_.b, at.b}, answer.translation);
  const double rest = static_cast<double>(reach) - length;
  return std::max(std::abs(answer.depth - truth), rest) / truth;
}

std::vector<Row> run_curved(const CurvedSettings& settings, Solvers& solvers) {
  std::vector<Row> rows;
  print_header();
  for (const CurvedCell& cell : settings.cells) {
    std::vector<Tally> tallies(solvers.size());
    const std::vector<char> sits_out = sitting_out(solvers, cell);
    for (int done = 0, number = 0; done < settings.pairs && number < 20 * settings.pairs; ++number) {
      Random random((settings.seed * 16 + static_cast<std::uint64_t>(cell.pair)) * 0x9E3779B97F4A7C15ULL +
                    static_cast<std::uint64_t>(number));
      const Bodies bodies = curved_bodies(cell.pair, random);
      const std::vector<Standing> frames = frames_inside(bodies, cell.depth, kFrames, random);
      if (frames.empty()) continue;
      const CurvedJudge judge(bodies);
      const Standing* known = nullptr;
      double truth = 0;
      const auto error = [&](const Answer& answer, const Standing& at, Precision) {
        if (known != &at) truth = judge.depth(at);
        known = &at;
        return judge.error(answer, at, truth);
      };
      measure_frames(bodies, frames, solvers, error, tallies, sits_out);
      ++done;
    }
    const std::vector<Row> block =
        rows_of(solvers, tallies, to_string(cell.pair), cell.pair == CurvedPair::cone_hull ? kHull : 0,
                cell.depth > 0 ? fmt::format("{}", cell.depth) : "inside", kBulletEpa);
    print_rows(block);
    rows.insert(rows.end(), block.begin(), block.end());
  }
  return rows;
}

}  // namespace pd::bench
