#include "oracle/judged_pair.hpp"

#include <stdexcept>

namespace pd::oracle {

namespace {

std::unique_ptr<ConvexShape> shape_of(const scenes::Points& points) {
  const auto polytope = ConvexPolytope::from_points(points);
  if (!polytope) throw std::runtime_error("hull refused: " + polytope.error().message);
  return std::make_unique<ConvexShape>(*polytope);
}

}  // namespace

JudgedPair::JudgedPair(scenes::PointPair points, std::string name)
    : name_(std::move(name)),
      points_(std::move(points)),
      shape_a_(shape_of(points_.a)),
      shape_b_(shape_of(points_.b)) {}

JudgedPair JudgedPair::of_family(scenes::PairFamily family, int n, scenes::DepthClass depth, std::uint64_t seed) {
  return JudgedPair(scenes::make_pair(family, n, depth, seed),
                    std::string(to_string(family)) + " n=" + std::to_string(n) + " " + std::string(to_string(depth)) +
                        " seed=" + std::to_string(seed));
}

const ExactPair& JudgedPair::exact() const {
  if (!exact_) {
    body_a_ = std::make_unique<Body>(points_.a);
    body_b_ = std::make_unique<Body>(points_.b);
    exact_ = std::make_unique<ExactPair>(*body_a_, points_.pose_a, *body_b_, points_.pose_b);
  }
  return *exact_;
}

const Verdict& JudgedPair::verdict() const {
  if (!verdict_) verdict_ = std::make_unique<Verdict>(judge(exact()));
  return *verdict_;
}

std::string JudgedPair::complaint(const PenetrationDepth& answer, Bracket bracket) const {
  const Findings findings =
      check_answer(exact(), verdict(),
                   {shape_a_->polytope(), shape_b_->polytope(), &points_.pose_a, &points_.pose_b, bracket}, answer);
  if (findings.wrong.empty()) return {};
  std::string what = name_ + ":";
  for (const Breach& w : findings.wrong) {
    what.append(" ").append(to_string(w.promise)).append(": ").append(w.what).append(";");
  }
  PairText text =
      describe(name_, name_.substr(0, name_.find(' ')), points_.a, points_.pose_a, points_.b, points_.pose_b);
  text.contact = std::string(pd::to_string(verdict().contact));
  const std::string dump = to_json(text, what);
  return what.append("\n").append(dump);
}

}  // namespace pd::oracle
