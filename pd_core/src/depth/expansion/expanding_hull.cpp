#include "depth/expansion/expanding_hull.hpp"

#include <algorithm>

#include "depth/expansion/initial_simplex.hpp"

namespace pd::detail {

namespace {

/// The numbers are the steps of expanding_polytope.hpp.
class HullExpansion {
 public:
  HullExpansion(const SmoothDifference& difference, ExactHull& hull, const ExpansionGoal& goal,
                std::int64_t& support_calls, const SearchWatch& watch)
      : difference_(difference), hull_(hull), goal_(goal), support_calls_(support_calls), watch_(watch) {}

  /// 1. and 2. False when the first supports end the search.
  bool start(const Vec3& direction) {
    hull_.clear();
    Vec3 directions[4];
    surrounding_directions(direction, initial_cone_sine(difference_), directions);
    for (const Vec3& d : directions) {
      if (!add_support(d)) return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (!add_support(Vec3::Unit(axis)) || !add_support(-Vec3::Unit(axis))) return false;
    }
    return hull_.start();
  }

  /// 3. to 9.
  void grow() {
    for (int step = 0; step < goal_.max_steps; ++step) {
      // 3.
      const int f = hull_.nearest();
      const double distance = hull_.face(f).distance;
      const Vec3 unit = hull_.face(f).unit_normal;
      result_.face = f;
      result_.lower = distance - lower_error_;
      // 5., 6. and 7.
      if (!add_support(unit)) return;
      if (watch_) report_step(watch_, kExactHullArithmetic, step, hull_, result_, unit, hull_.vertices.back().x);
      if (touches(goal_, result_.lower, result_.upper, largest_)) {
        result_.status = ExpansionStatus::touching;
        return;
      }
      if (reached(goal_, result_.lower, result_.upper, largest_)) {
        result_.status = ExpansionStatus::certified;
        return;
      }
      // 8. and 9.
      const double height = hull_.vertices.back().x.dot(unit);
      if (height - distance <= 4 * lower_error_ || !hull_.insert(f)) return;
    }
    result_.status = ExpansionStatus::over_budget;
  }

  [[nodiscard]] const ExpansionResult& result() const { return result_; }

 private:
  /// 5. and 6. False when the support's plane shows the bodies separated.
  bool add_support(const Vec3& unit) {
    const DifferenceVertex s = difference_.support(unit, nullptr);
    ++support_calls_;
    hull_.vertices.push_back(s);
    largest_ = std::max(largest_, s.x.cwiseAbs().maxCoeff());
    const double height = s.x.dot(unit);
    if (height + upper_error_ < result_.upper) {
      result_.upper = height + upper_error_;
      result_.normal = unit;
    }
    if (height >= -upper_error_ - goal_.touching * largest_) return true;
    result_.status = ExpansionStatus::separated;
    return false;
  }

  const SmoothDifference& difference_;
  ExactHull& hull_;
  const ExpansionGoal& goal_;
  std::int64_t& support_calls_;
  const SearchWatch& watch_;
  const double lower_error_ = face_error(difference_);
  const double upper_error_ = support_plane_error(difference_);
  double largest_ = 0;
  ExpansionResult result_;
};

}  // namespace

ExpansionResult expand_exact_hull(const SmoothDifference& difference, ExactHull& hull, const Vec3& start,
                                  const ExpansionGoal& goal, std::int64_t& support_calls, const SearchWatch& watch) {
  HullExpansion expansion(difference, hull, goal, support_calls, watch);
  if (expansion.start(start)) expansion.grow();
  if (watch) report_end(watch, kExactHullArithmetic, expansion.result());
  return expansion.result();
}

}  // namespace pd::detail
