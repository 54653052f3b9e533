#include "oracle/member_pair.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "oracle/curved_oracle.hpp"

namespace pd::oracle {

namespace {

using scenes::Random;

/// 2^x for x in [-spread, spread), by products alone: libraries differ in the last bit of std::exp2.
double random_size(double spread, Random& random) {
  const double exponent = random.uniform(-spread, spread);
  const double whole = std::floor(exponent);
  return std::ldexp(1 + (exponent - whole), static_cast<int>(whole));
}

ConvexShape random_hull(int n, double spread, Random& random) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double size = random_size(spread, random);
    points.push_back(size * random.direction());
  }
  return {*ConvexPolytope::from_points(points)};
}

Vec3 random_sizes(double spread, Random& random) {
  Vec3 sizes;
  for (int i = 0; i < 3; ++i) sizes[i] = random_size(spread, random);
  return sizes;
}

enum class Placement { touching, at_one_place, in_one_line, anywhere };

/// Both poses: the bodies come near each other, by a share of the size of b - a.
void place(Placement how, MemberPair& pair, Random& random) {
  const bool turned = random.integer(0, 3) != 0;
  const auto upright = [](const Vec3& t) { return *Pose::from_quaternion({1, 0, 0, 0}, t); };
  const auto pose = [&](const Vec3& t) { return turned ? random.pose(t) : upright(t); };
  switch (how) {
    case Placement::touching: {
      pair.pose_a = pose(Vec3::Zero());
      pair.pose_b = pose(Vec3::Zero());
      Vec3 n = random.direction();
      if (random.integer(0, 1) == 0) n = Vec3::Unit(random.integer(0, 2));
      const auto height = static_cast<double>(difference_support(pair.posed_a(), pair.posed_b(), n));
      const Vec3 way = -height * n;
      pair.pose_b = *Pose::from_quaternion(pair.pose_b.quaternion_wxyz(), way);
      return;
    }
    case Placement::at_one_place:
      pair.pose_a = pair.pose_b = pose(Vec3::Zero());
      return;
    case Placement::in_one_line: {
      const double share = random.uniform(0.05, 1.5);
      pair.pose_a = upright(Vec3::Zero());
      pair.pose_b = upright(share * Vec3::Unit(random.integer(0, 2)));
      return;
    }
    case Placement::anywhere: {
      const Vec3 base = 3 * random.direction();
      pair.pose_a = pose(base);
      const double share = random.uniform(0, 1.2) * size_of_difference(pair.posed_a(), {&pair.b, pair.pose_a});
      pair.pose_b = pose(base + share * random.direction());
      return;
    }
  }
}

}  // namespace

MemberKind make_member(int kind, double spread, Random& random) {
  const auto size = [&] { return random_size(spread, random); };
  const auto sizes = [&] { return random_sizes(spread, random); };
  switch (kind) {
    case 0:
      return {"box", ConvexShape(*ConvexPolytope::box(sizes()))};
    case 1:
      return {"hull", random_hull(12, spread, random)};
    case 2:
      return {"triangle", random_hull(3, spread, random)};
    case 3:
      return {"segment", random_hull(2, spread, random)};
    case 4: {
      const ConvexShape box(*ConvexPolytope::box(sizes()));
      return {"rounded box", *box.with_margin(size() / 4)};
    }
    case 5:
      return {"sphere", *ConvexShape::sphere(size())};
    case 6: {
      const Vec3 s = sizes();
      return {"capsule", *ConvexShape::capsule(s.x() / 2, s.y(), random.integer(0, 2))};
    }
    case 7:
      return {"ellipsoid", *ConvexShape::ellipsoid(sizes())};
    case 8:
      return {"long ellipsoid", *ConvexShape::ellipsoid({0.01, 0.1, 2})};
    case 9:
      return {"flat ellipsoid", *ConvexShape::ellipsoid({2, 2, 0x1p-16})};
    case 10: {
      const ConvexShape core = *ConvexShape::ellipsoid(sizes());
      return {"rounded ellipsoid", *core.with_margin(size() / 8)};
    }
    case 11: {
      const Vec3 s = sizes();
      return {"cylinder", *ConvexShape::cylinder(s.x(), s.y(), random.integer(0, 2))};
    }
    case 12:
      return {"coin", *ConvexShape::cylinder(1, 0x1p-12, random.integer(0, 2))};
    case 13: {
      const Vec3 s = sizes();
      return {"cone", *ConvexShape::cone(s.x(), s.y(), random.integer(0, 2))};
    }
    case 14: {
      const Vec3 s = sizes();
      const ConvexShape core = *ConvexShape::cone(s.x(), s.y(), random.integer(0, 2));
      return {"rounded cone", *core.with_margin(s.z() / 8)};
    }
    default: {
      const Vec3 s = sizes();
      const std::vector<Sphere> spheres{{{0, 0, 0}, s.x() / 2}, {{s.y(), 0, 0}, 0.25}, {{0, s.z(), 0.2}, 0.125}};
      return {"sphere hull", *ConvexShape::hull_of_spheres(spheres)};
    }
  }
}

MemberPair make_member_pair(std::uint64_t seed) {
  Random random(seed * 0xD1B54A32D192ED03ULL + 1);
  random.next();
  const double spread = random.integer(0, 3) == 0 ? 8 : 1;
  const int kind_a = random.integer(0, kMemberKinds - 1), kind_b = random.integer(0, kMemberKinds - 1);
  const MemberKind a = make_member(kind_a, spread, random);
  const MemberKind b = make_member(kind_b, spread, random);
  const auto how = static_cast<Placement>(random.integer(0, 3));
  static constexpr const char* kWords[] = {" touches ", " in ", " aligned with ", " and "};
  MemberPair pair{a.name + kWords[static_cast<int>(how)] + b.name, a.shape, b.shape, Pose(), Pose()};
  place(how, pair, random);
  return pair;
}

double size_of_difference(const PosedShape& a, const PosedShape& b) {
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    for (const double sign : {1.0, -1.0}) {
      size = std::max(size, std::abs(static_cast<double>(difference_support(a, b, sign * Vec3::Unit(k)))));
    }
  }
  return size;
}

}  // namespace pd::oracle
