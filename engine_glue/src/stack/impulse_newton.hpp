/// @file
/// The impulses of one step of a constraint solver, solved at once instead of swept towards.
///
/// Rows J_i of velocities, each with a target r_i, bounds [lo_i, hi_i] of its impulse and a softness c_i > 0; bodies
/// with mass matrix M. Wanted are changes of velocity x and impulses with
///
///     M x = sum_i J_i^T lambda_i,   lambda_i = clamp((r_i + d_i lambda'_i - J_i x) / c_i, lo_i, hi_i).
///
/// lambda' is what a row carried before: the part d_i of softness is felt by what changes only (the method of
/// multipliers). Friction has none (d = 0), since its rows contradict each other by rounding, and would come to carry
/// that.
/// There a convex, piecewise quadratic function of x is least, so Newton's method finds it: each step is a sparse
/// Cholesky factorisation of M + sum of J_i^T J_i / c_i over the rows within their bounds, whose blocks are bodies and
/// pairs of them in contact, and an exact search along the step. Redundant rows (four points under a face) are no
/// trouble, since nothing is inverted but masses. Bounds of friction follow the normal impulses: they and lambda' are
/// held for a round and then taken anew, for as many rounds as the impulses still change by much.
///
/// A sweep of Gauss and Seidel mends about (pi / n)^2 / 4 of the slowest error of a tower of n bodies; a round mends
/// all but c / (c + (pi / 2 n)^2) of it, of a tower in time O(n).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "stack/block_cholesky.hpp"

namespace pd::detail {

class ImpulseNewton {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = BlockCholesky::Block;

  /// Softness of a contact's row beyond its own, as a share of what its bodies weigh against it. Four points under a
  /// face say three things, and their eight rows of friction three others. Poses in single precision let them
  /// contradict each other by some 1e-7 m a step, which stiff rows answer with impulses against each other: with 1e-6,
  /// points slip for that alone, and towers at 240 Hz and more fly apart. With 1e-2 a pyramid takes more rounds than it
  /// gets. Only changes of the impulse feel it, so that nothing sinks.
  static constexpr double kSoftness = 1e-4;

  struct Row {
    int body[2] = {-1, -1};  ///< places in `masses`; -1: fixed
    Vector6 jacobian[2];     ///< of linear, then angular velocity in the world
    double target = 0;       ///< r
    double softness = 0;     ///< c > 0
    double of_changes = 0;   ///< d, of c
    double lower = 0;        ///< of the impulse; of a row with `normal` >= 0 found by the solver
    double upper = 0;
    int normal = -1;  ///< of friction: the row whose impulse times `friction` bounds this one both ways
    double friction = 0;
    double impulse = 0;  ///< what it carried before, then the answer
  };

  struct Outcome {
    int factorisations = 0;
    /// At least one round ended: the equations hold, with friction's bounds from the round before. Else `kMostSteps`
    /// were not enough, or an impulse is no number, and impulses are as they were.
    bool settled = false;
    bool spared = false;    ///< `Limits::spares_trees` kept it from being given up
    bool given_up = false;  ///< by one of `Limits`; impulses are as they were
  };

  /// Ends a solution that is good enough, or does not pay. The limits are counts and shares, never times, so that the
  /// answer is the same on every machine.
  struct Limits {
    /// Most products of blocks that a factorisation may take.
    long long products = std::numeric_limits<long long>::max();
    /// Share of the impulses that the first step may show to be amiss. It is below 0.03 where a stack stands, also in
    /// its first step. It is near 1 where contacts come and go, and then more factorisations follow than pay.
    double amiss_at_first = std::numeric_limits<double>::infinity();
    bool spares_trees = false;  ///< `amiss_at_first` does not bind where the bodies form trees
    /// Share of the impulses that may be amiss at the end of a round.
    double amiss_at_end = 1e-5;
  };

  std::vector<Matrix6> masses;  ///< positive definite
  std::vector<Row> rows;

  /// Solves for all `impulse`. Deterministic: the same bits for the same rows in the same order.
  Outcome solve(const Limits& limits);
  Outcome solve() { return solve(Limits()); }

 private:
  enum class Hold : unsigned char { within, at_lower, at_upper };
  static constexpr int kMostSteps = 32;
  static constexpr int kMostRounds = 3;
  static constexpr int kMostLooks = 60;  ///< along one step
  static constexpr double kMuch = 0.1;   ///< of the sum of the impulses

  void find_pattern();
  void begin_round();
  void guess_holds();
  bool classify(double negligible);
  void factorise();
  /// Adds a row to the blocks of bodies of `changed_`, and to those of two such bodies.
  void assemble(std::size_t row);
  [[nodiscard]] bool has_changed(const std::pair<int, int>& pair) const;
  void solve_held();
  [[nodiscard]] double share_of_step();
  void move(double share);
  [[nodiscard]] bool round_changed_much() const;
  [[nodiscard]] double speed(const Row& row, const Eigen::VectorXd& x) const;

  std::vector<std::pair<int, int>> pairs_;  ///< (lower, higher) body of each block off the diagonal, ascending
  std::vector<int> block_of_row_;           ///< into `pairs_`, -1: one body only
  std::vector<Hold> holds_, next_holds_;    ///< as factorised; as they are
  std::vector<bool> changed_;               ///< bodies whose blocks differ from what was factorised last
  std::vector<bool> carried_;               ///< bodies that some row pushed before
  std::vector<double> impulses_, reached_;  ///< of rows: at `x_`; at the end of the last round
  std::vector<double> targets_;             ///< r + d lambda'
  std::vector<Matrix6> own_, shared_;       ///< what is factorised: bodies' blocks, and those of `pairs_`
  std::vector<Hold> assembled_;             ///< as `own_` and `shared_` have it; empty: they are of other rows
  double amiss_ = 0;  ///< share of the impulses that the last `classify` found on another side of their bounds
  BlockCholesky factor_;
  Eigen::VectorXd x_, aim_, step_;
  std::vector<double> speeds_, turns_;  ///< of rows: at `x_`, and along the step
};

}  // namespace pd::detail
