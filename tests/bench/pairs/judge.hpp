/// @file
/// Right or wrong, by the exact oracle: never inside a timed section, and for each solver on the numbers it received.
#pragma once

#include <memory>
#include <optional>

#include "bench/peers/solver.hpp"
#include "oracle/body.hpp"
#include "oracle/depth_oracle.hpp"

namespace pd::bench {

/// A relative error of the depth, or a rest of overlap after the translation, above this share of the depth is wrong.
inline constexpr double kTolerance = 1e-3;

struct Judgement {
  bool wrong = false;         ///< missed, depth off by more than kTolerance, or not separated
  double relative_error = 0;  ///< |depth - truth| / truth; 1 where the overlap was missed
  double size_error = 0;      ///< |depth - truth| over the extent of the difference
};

/// Coordinates as a solver of this precision receives them.
[[nodiscard]] Vec3 received(const Vec3& v, Precision precision);
[[nodiscard]] Pose received(const Pose& pose, Precision precision);

/// The oracle's bodies of one pair in both precisions, built when first asked for.
class JudgedBodies {
 public:
  explicit JudgedBodies(const Bodies& bodies) : bodies_(bodies) {}
  [[nodiscard]] const oracle::Body& a(Precision precision) const { return get(0, precision); }
  [[nodiscard]] const oracle::Body& b(Precision precision) const { return get(1, precision); }

 private:
  [[nodiscard]] const oracle::Body& get(int side, Precision precision) const;

  const Bodies& bodies_;
  mutable std::optional<oracle::Body> built_[2][2];
};

/// One placement of the bodies. Refers to both arguments.
class Judge {
 public:
  Judge(const JudgedBodies& bodies, const Pose& pose_a, const Pose& pose_b) : bodies_(bodies), poses_{pose_a, pose_b} {}

  [[nodiscard]] ContactClass contact(Precision precision) const { return truth(precision).verdict.contact; }
  [[nodiscard]] double depth(Precision precision) const { return truth(precision).depth; }
  [[nodiscard]] Judgement judge(const Answer& answer, Precision precision) const;

 private:
  struct Truth {
    Pose pose_a;
    Pose pose_b;
    oracle::ExactPair pair;
    oracle::Verdict verdict;
    double depth = 0;
    double extent = 0;
  };
  [[nodiscard]] const Truth& truth(Precision precision) const;

  const JudgedBodies& bodies_;
  Pose poses_[2];
  mutable std::unique_ptr<Truth> truths_[2];
};

}  // namespace pd::bench
