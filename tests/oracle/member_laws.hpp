/// @file
/// The laws that an answer keeps whatever the kinds of the bodies, its class and its bracket. Its witnesses and the
/// points of its manifold are points of both bodies. Powers of two scale every bit. The swap of the two bodies and
/// rigid motions of both keep the depth.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "oracle/member_pair.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::oracle {

enum class MemberLaw : std::uint8_t {
  answer,     ///< finite numbers, brackets in order, a normal of length 1
  witnesses,  ///< points of both bodies, the translation apart
  manifold,   ///< its points are points of both bodies, and lie apart along the normal by their depth
  swap,       ///< the same numbers, the opposite way
  powers,     ///< the same bits, scaled; of points of manifolds by up to 2^100
  motions,    ///< brackets of one number
};
inline constexpr std::size_t kMemberLaws = 6;
[[nodiscard]] std::string_view to_string(MemberLaw law);

struct BrokenLaw {
  MemberLaw law;
  std::string what;
};

/// How far points may lie off their bodies, as a share of `size_of_difference`: witnesses, and the other points of a
/// manifold, which are found across a normal that leaves open what the bracket does. Brackets other than the tightest
/// add their own width.
inline constexpr double kWitnessOff = 1e-9;
inline constexpr double kManifoldOff = 1e-7;

/// What the judge met, for the tests that must not pass on nothing.
struct MemberCounts {
  std::array<std::int64_t, 3> classes{};  ///< separated, touching, overlapping
  std::int64_t manifold_points = 0;
  double worst_witness = 0;  ///< with the tightest bracket, as shares of the size
  double worst_manifold = 0;
  double widest_motion = 0;  ///< the gap between brackets before and after a motion
};

class MemberJudge {
 public:
  /// The laws that the answer to this pair breaks: each at most once.
  /// @param seed  of the power and the motion.
  [[nodiscard]] std::vector<BrokenLaw> judge(const PosedShape& a, const PosedShape& b, const DepthSettings& settings,
                                             std::uint64_t seed);

  [[nodiscard]] const MemberCounts& counts() const { return counts_; }

 private:
  struct Answer {
    PenetrationDepth depth;
    ContactManifold manifold;
  };
  Answer ask(const PosedShape& a, const PosedShape& b, const DepthSettings& settings);
  void check_members(const PosedShape& a, const PosedShape& b, const Answer& answer, Bracket bracket, double size);

  void broken(MemberLaw law, const std::string& what);

  Scratch scratch_;
  ManifoldScratch manifolds_;
  MemberCounts counts_;
  std::vector<BrokenLaw> broken_;
};

}  // namespace pd::oracle
