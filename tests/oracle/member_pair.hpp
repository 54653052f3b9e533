/// @file
/// Two posed bodies of any kind, near each other: touching, at one place, in one line or anywhere.
#pragma once

#include <string>

#include "pd/shape/convex_shape.hpp"
#include "scenes/shape_families.hpp"

namespace pd::oracle {

inline constexpr int kMemberKinds = 16;

struct MemberKind {
  std::string name;
  ConvexShape shape;
};

/// A body of one of the kinds: polytopes, swept bodies and curved ones. Its sizes are random between 2^-spread and
/// 2^spread, but for the kinds that are long or flat by name.
[[nodiscard]] MemberKind make_member(int kind, double spread, scenes::Random& random);

/// Two bodies and where they stand.
struct MemberPair {
  std::string name;
  ConvexShape a;
  ConvexShape b;
  Pose pose_a;
  Pose pose_b;

  [[nodiscard]] PosedShape posed_a() const { return {&a, pose_a}; }
  [[nodiscard]] PosedShape posed_b() const { return {&b, pose_b}; }
};

/// A function of the seed. Each fourth pair has sizes that lie far apart.
[[nodiscard]] MemberPair make_member_pair(std::uint64_t seed);

/// The largest |coordinate| of a point of b - a.
[[nodiscard]] double size_of_difference(const PosedShape& a, const PosedShape& b);

}  // namespace pd::oracle
