/// @file
/// One pair with everything that a test asks of it: the library's shapes, the oracle's bodies, the exact verdict, and
/// the dump of a failure in the corpus' format.
#pragma once

#include <memory>
#include <string>

#include "oracle/answer_check.hpp"
#include "oracle/corpus.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::oracle {

class JudgedPair {
 public:
  /// Throws std::runtime_error when the library refuses the points.
  explicit JudgedPair(scenes::PointPair points, std::string name = "pair");
  static JudgedPair of_family(scenes::PairFamily family, int n, scenes::DepthClass depth, std::uint64_t seed);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const scenes::PointPair& points() const { return points_; }
  [[nodiscard]] PosedShape a() const { return {shape_a_.get(), points_.pose_a}; }
  [[nodiscard]] PosedShape b() const { return {shape_b_.get(), points_.pose_b}; }
  /// Computed when first asked for.
  [[nodiscard]] const ExactPair& exact() const;
  [[nodiscard]] const Verdict& verdict() const;
  /// L of the answer's promises.
  [[nodiscard]] double extent() const { return difference_extent(exact()); }

  /// S of the answer's promises.
  [[nodiscard]] double size_of_numbers() const {
    return oracle::size_of_numbers(*shape_a_->polytope(), points_.pose_a, *shape_b_->polytope(), points_.pose_b);
  }

  /// Empty when every promise is kept; else what was broken, and the pair as an entry for a corpus file.
  [[nodiscard]] std::string complaint(const PenetrationDepth& answer, Bracket bracket) const;

 private:
  std::string name_;
  scenes::PointPair points_;
  std::unique_ptr<ConvexShape> shape_a_;
  std::unique_ptr<ConvexShape> shape_b_;
  mutable std::unique_ptr<Body> body_a_;
  mutable std::unique_ptr<Body> body_b_;
  mutable std::unique_ptr<ExactPair> exact_;
  mutable std::unique_ptr<Verdict> verdict_;
};

}  // namespace pd::oracle
