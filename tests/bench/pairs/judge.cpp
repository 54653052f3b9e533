#include "bench/pairs/judge.hpp"

#include <cmath>

#include "oracle/answer_check.hpp"
#include "scenes/single_precision.hpp"

namespace pd::bench {

Vec3 received(const Vec3& v, Precision precision) {
  return precision == Precision::binary32 ? scenes::to_single(v) : v;
}

Pose received(const Pose& pose, Precision precision) {
  return precision == Precision::binary32 ? scenes::to_single(pose) : pose;
}

const oracle::Body& JudgedBodies::get(int side, Precision precision) const {
  auto& body = built_[side][static_cast<int>(precision)];
  if (!body) {
    scenes::Points points = vertices_of(side == 0 ? bodies_.a : bodies_.b);
    for (Vec3& p : points) p = received(p, precision);
    body.emplace(points);
  }
  return *body;
}

const Judge::Truth& Judge::truth(Precision precision) const {
  auto& truth = truths_[static_cast<int>(precision)];
  if (!truth) {
    const Pose a = received(poses_[0], precision);
    const Pose b = received(poses_[1], precision);
    truth = std::make_unique<Truth>(
        Truth{a, b, oracle::ExactPair(bodies_.a(precision), a, bodies_.b(precision), b), {}, 0, 0});
    truth->verdict = oracle::judge(truth->pair, {.distance = false});
    truth->depth = truth->verdict.depth.approximate();
    truth->extent = oracle::difference_extent(truth->pair);
  }
  return *truth;
}

Judgement Judge::judge(const Answer& answer, Precision precision) const {
  const Truth& t = truth(precision);
  const bool overlapping = t.verdict.contact == ContactClass::overlapping;
  // Bodies that do not overlap: the right answer says so, and every other one has no truth to be relative to.
  if (!overlapping) {
    const bool wrong = answer.overlapping && answer.depth > 0;
    return {wrong, wrong ? 1.0 : 0.0, wrong ? answer.depth / t.extent : 0.0};
  }
  if (!answer.overlapping || !std::isfinite(answer.depth) || !answer.translation.allFinite()) {
    return {true, 1, t.depth / t.extent};
  }
  const double error = std::abs(answer.depth - t.depth);
  Judgement judgement{error > kTolerance * t.depth, error / t.depth, error / t.extent};
  if (judgement.wrong) return judgement;
  // The plane that the translation itself points at proves nearly every right answer; the oracle decides the others.
  const double length = answer.translation.norm();
  if (length > 0) {
    const double reach = std::ldexp(t.pair.support(answer.translation / length), t.pair.scale());
    if (reach - length <= kTolerance * t.depth) return judgement;
  }
  const oracle::ExactPair moved(t.pair.a(), t.pose_a, t.pair.b(), t.pose_b, answer.translation);
  const oracle::Verdict rest = oracle::judge(moved, {.distance = false});
  judgement.wrong = rest.contact == ContactClass::overlapping && rest.depth.approximate() > kTolerance * t.depth;
  return judgement;
}

}  // namespace pd::bench
