#include "stack/impulse_newton.hpp"

#include <algorithm>
#include <cmath>

#include "stack/block_products.hpp"

namespace pd::detail {

ImpulseNewton::Outcome ImpulseNewton::solve(const Limits& limits) {
  Outcome outcome;
  if (masses.empty() || rows.empty()) {
    outcome.settled = true;
    return outcome;
  }
  find_pattern();
  if (factor_.products() > limits.products) {
    outcome.given_up = true;
    return outcome;
  }
  impulses_.clear();
  for (const Row& row : rows) impulses_.push_back(row.impulse);
  reached_ = impulses_;
  assembled_.clear();
  begin_round();
  guess_holds();
  int rounds = 0;
  bool factor_fits = false;
  for (int step = 0; step < kMostSteps; ++step) {
    if (!factor_fits) {
      factorise();
      ++outcome.factorisations;
    }
    solve_held();
    // What is held where may be guessed right at once; only after that is there a point to search from.
    const double share = step == 0 ? 1 : share_of_step();
    move(share);
    factor_fits = !classify(share == 1 ? limits.amiss_at_end : 0);
    if (step == 0 && amiss_ > limits.amiss_at_first) {
      outcome.spared = limits.spares_trees && factor_.products() < static_cast<long long>(masses.size());
      outcome.given_up = !outcome.spared;
      if (outcome.given_up) return outcome;
    }
    if (!factor_fits || share < 1) continue;
    const bool last = ++rounds == kMostRounds || !round_changed_much();
    reached_ = impulses_;
    if (last) break;
    begin_round();
    factor_fits = !classify(0);
  }
  // A body whose pose or velocity is no number must not spoil those that are solved with it.
  outcome.settled =
      rounds > 0 && std::all_of(reached_.begin(), reached_.end(), [](double x) { return std::isfinite(x); });
  if (outcome.settled) {
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].impulse = reached_[i];
  }
  return outcome;
}

double ImpulseNewton::speed(const Row& row, const Eigen::VectorXd& x) const {
  double sum = 0;
  for (int side = 0; side < 2; ++side) {
    if (row.body[side] >= 0) sum += row.jacobian[side].dot(x.segment<6>(6 * row.body[side]));
  }
  return sum;
}

void ImpulseNewton::find_pattern() {
  const auto ends = [](const Row& row) {
    return std::pair(std::min(row.body[0], row.body[1]), std::max(row.body[0], row.body[1]));
  };
  pairs_.clear();
  for (const Row& row : rows) {
    const std::pair<int, int> pair = ends(row);
    if (pair.first >= 0 && (pairs_.empty() || pairs_.back() != pair)) pairs_.push_back(pair);
  }
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  block_of_row_.clear();
  std::pair<int, int> last(-1, -1);
  int block = -1;
  for (const Row& row : rows) {
    const std::pair<int, int> pair = ends(row);
    if (pair != last) {
      block =
          pair.first < 0 ? -1 : static_cast<int>(std::lower_bound(pairs_.begin(), pairs_.end(), pair) - pairs_.begin());
      last = pair;
    }
    block_of_row_.push_back(block);
  }
  factor_.set_pattern(static_cast<int>(masses.size()), pairs_);
}

/// Impulses as they are now are what rows carried before this round, and what bounds friction.
void ImpulseNewton::begin_round() {
  targets_.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row& row = rows[i];
    targets_.push_back(row.target + row.of_changes * impulses_[i]);
    if (row.normal < 0) continue;
    row.upper = row.friction * std::max(0.0, impulses_[static_cast<std::size_t>(row.normal)]);
    row.lower = -row.upper;
  }
}

bool ImpulseNewton::round_changed_much() const {
  double all = 0, change = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].normal >= 0) continue;
    all += std::abs(impulses_[i]);
    change += std::abs(impulses_[i] - reached_[i]);
  }
  return change > kMuch * all;
}

void ImpulseNewton::guess_holds() {
  // Where something carries both bodies already, what carried nothing carries nothing. What a body meets that nothing
  // carries yet will hold it: they fall together, until one of them is held and the other comes on at up to the largest
  // speed that there is to stop.
  carried_.assign(masses.size(), false);
  double fastest = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].normal < 0) fastest = std::max(fastest, rows[i].target);
    if (rows[i].normal >= 0 || impulses_[i] <= rows[i].lower) continue;
    for (const int body : rows[i].body) {
      if (body >= 0) carried_[static_cast<std::size_t>(body)] = true;
    }
  }
  const auto is_carried = [this](int body) { return body < 0 || carried_[static_cast<std::size_t>(body)]; };
  holds_.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const bool met = row.normal < 0 && targets_[i] > -fastest && !(is_carried(row.body[0]) && is_carried(row.body[1]));
    Hold hold = Hold::within;
    if (impulses_[i] <= row.lower && !met) hold = Hold::at_lower;
    if (impulses_[i] >= row.upper && row.lower < row.upper) hold = Hold::at_upper;
    holds_.push_back(hold);
  }
}

/// Impulses at `x_`, and which rows are at their bounds. @return whether that changed, by more than a share of the
/// impulses: of the solution for what is factorised, rows that carry next to nothing come and go by rounding. Elsewhere
/// a share would leave a direction that does not lead down.
bool ImpulseNewton::classify(double negligible) {
  double all = 0, amiss = 0;
  next_holds_.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double impulse = (targets_[i] - speeds_[i]) / row.softness;
    const Hold hold = row.lower == row.upper || impulse <= row.lower ? Hold::at_lower
                      : impulse >= row.upper                         ? Hold::at_upper
                                                                     : Hold::within;
    impulses_[i] = std::clamp(impulse, row.lower, row.upper);
    const double held = holds_[i] == Hold::within ? impulse : holds_[i] == Hold::at_lower ? row.lower : row.upper;
    all += std::abs(impulses_[i]);
    if (hold != holds_[i]) amiss += std::abs(impulses_[i] - held);
    next_holds_.push_back(hold);
  }
  amiss_ = all > 0 ? amiss / all : 0;
  if (!(amiss > negligible * all) && (negligible > 0 || holds_ == next_holds_)) return false;
  std::swap(holds_, next_holds_);
  return true;
}

void ImpulseNewton::factorise() {
  const bool first = assembled_.empty();
  // From one factorisation to the next a few rows come to their bounds or leave them. Only the blocks of their bodies
  // are summed anew, in the order of rows: a stiff row that is taken out of a sum leaves its rounding there.
  changed_.assign(masses.size(), first);
  for (std::size_t i = 0; i < assembled_.size(); ++i) {
    if ((assembled_[i] == Hold::within) == (holds_[i] == Hold::within)) continue;
    for (const int body : rows[i].body) {
      if (body >= 0) changed_[static_cast<std::size_t>(body)] = true;
    }
  }
  assembled_ = holds_;
  own_.resize(masses.size());
  for (std::size_t body = 0; body < masses.size(); ++body) {
    if (changed_[body]) own_[body] = masses[body];
  }
  shared_.resize(pairs_.size());
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    if (has_changed(pairs_[pair])) shared_[pair] = Matrix6::Zero();
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (holds_[i] == Hold::within) assemble(i);
  }
  factor_.factorise(own_, shared_, changed_);
}

bool ImpulseNewton::has_changed(const std::pair<int, int>& pair) const {
  return changed_[static_cast<std::size_t>(pair.first)] && changed_[static_cast<std::size_t>(pair.second)];
}

void ImpulseNewton::assemble(std::size_t i) {
  const Row& row = rows[i];
  const double stiffness = 1 / row.softness;
  for (int side = 0; side < 2; ++side) {
    if (row.body[side] < 0 || !changed_[static_cast<std::size_t>(row.body[side])]) continue;
    add_square(own_[static_cast<std::size_t>(row.body[side])], row.jacobian[side], stiffness);
  }
  if (block_of_row_[i] < 0) return;
  const auto pair = static_cast<std::size_t>(block_of_row_[i]);
  if (!has_changed(pairs_[pair])) return;
  const int high = row.body[0] < row.body[1] ? 1 : 0;
  for (int k = 0; k < 6; ++k) shared_[pair].col(k) += (stiffness * row.jacobian[1 - high][k]) * row.jacobian[high];
}

/// `aim_`: the velocities if all rows stay within or at their bounds as they are.
void ImpulseNewton::solve_held() {
  aim_.setZero(static_cast<Eigen::Index>(6 * masses.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double push = holds_[i] == Hold::within     ? targets_[i] / row.softness
                        : holds_[i] == Hold::at_lower ? row.lower
                                                      : row.upper;
    if (push == 0) continue;
    for (int side = 0; side < 2; ++side) {
      if (row.body[side] >= 0) aim_.segment<6>(6 * row.body[side]) += push * row.jacobian[side];
    }
  }
  factor_.solve(aim_);
}

/// How far along from `x_` to `aim_` the function is least, at most 1: where its slope, which rises, is 0.
double ImpulseNewton::share_of_step() {
  step_ = aim_ - x_;
  double inertia_start = 0, inertia_rise = 0;
  for (std::size_t body = 0; body < masses.size(); ++body) {
    const auto at = static_cast<Eigen::Index>(6 * body);
    const Vector6 pushed = masses[body] * step_.segment<6>(at);
    inertia_start += pushed.dot(x_.segment<6>(at));
    inertia_rise += pushed.dot(step_.segment<6>(at));
  }
  turns_.clear();
  for (const Row& row : rows) turns_.push_back(speed(row, step_));
  struct Slope {
    double value;
    double rise;  ///< of the value with the share, to the right of where it bends
  };
  const auto slope = [&](double share) {
    Slope sum{inertia_start + share * inertia_rise, inertia_rise};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double impulse = (targets_[i] - speeds_[i] - share * turns_[i]) / rows[i].softness;
      sum.value -= turns_[i] * std::clamp(impulse, rows[i].lower, rows[i].upper);
      if (impulse > rows[i].lower && impulse < rows[i].upper) sum.rise += turns_[i] * turns_[i] / rows[i].softness;
    }
    return sum;
  };
  const double start = slope(0).value;
  Slope at_share = slope(1);
  double size = std::abs(inertia_start);
  for (std::size_t i = 0; i < rows.size(); ++i) size += std::abs(turns_[i] * impulses_[i]);
  // Nothing to gain, but for rounding; or all of the way is downhill.
  constexpr double kRounding = 1e-12;
  constexpr double kLevel = 1e-9;
  if (start >= -kRounding * size || at_share.value <= -kLevel * start) return 1;
  // The slope is piecewise linear in the share and does not fall: Newton's method finds its piece. Where that leaves
  // the bounds, the exponent is halved until the root is bracketed, then the bracket.
  double low = 0, high = 1, share = 1;
  for (int i = 0; i < kMostLooks && std::abs(at_share.value) > -kLevel * start && high - low > kLevel * high; ++i) {
    const double newton = share - at_share.value / at_share.rise;
    share = newton > low && newton < high ? newton : low > 0 ? 0.5 * (low + high) : 0.0625 * high;
    at_share = slope(share);
    (at_share.value < 0 ? low : high) = share;
  }
  return share;
}

/// To the point at that share of the way from `x_` to `aim_`. What a row's speed is there is known better from the two
/// ends of the way than from the point, which rounding may leave on the other side of where a row begins to push.
void ImpulseNewton::move(double share) {
  if (share == 1) {
    x_ = aim_;
    speeds_.clear();
    for (const Row& row : rows) speeds_.push_back(speed(row, x_));
    return;
  }
  x_ += share * step_;
  for (std::size_t i = 0; i < rows.size(); ++i) speeds_[i] += share * turns_[i];
}

}  // namespace pd::detail
