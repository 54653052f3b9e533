/// @file
/// Cholesky factorisation of sparse symmetric positive definite matrices of blocks of 6 x 6, one row of blocks a body.
///
/// Bodies are eliminated by approximate minimum degree (Amestoy, Davis and Duff 1996, by `Eigen::AMDOrdering`). Which
/// blocks fill in is found once a pattern, and where each product goes in the first factorisation, so that later ones
/// are straight runs through lists. A factorisation of a tower of n bodies takes time O(n). That of a heap takes as
/// many products as half the squares of its columns' blocks. The first one takes another share of that, times a
/// logarithm.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace pd::detail {

class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, 6, 6>;

  /// @param pairs  (a, b), a < b, ascending and unique: the blocks off the diagonal that are not 0. Kept if it is the
  ///               pattern of the last call.
  void set_pattern(int num_bodies, const std::vector<std::pair<int, int>>& pairs);

  /// Products of blocks that a factorisation takes; less than the bodies only where these form trees.
  [[nodiscard]] long long products() const { return products_; }

  /// Factorises anew what differs from the last call: blocks of some bodies, and of pairs of two of those. The result
  /// is the same bits as that of the whole. A column is computed anew if one of those bodies is in it or is eliminated
  /// below it. After `set_pattern` with another pattern all bodies have changed.
  /// @param own     the diagonal's blocks, by body; their lower triangles are read
  /// @param shared  by pair, rows of b and columns of a
  void factorise(const std::vector<Block>& own, const std::vector<Block>& shared,
                 const std::vector<bool>& changed_bodies);

  /// Solves in place, six numbers a body.
  void solve(Eigen::VectorXd& x) const;

 private:
  void choose_order();
  void find_columns();
  void place_products();
  /// Sets the columns that are computed anew to their blocks before elimination.
  void reset_columns(const std::vector<Block>& own, const std::vector<Block>& shared);
  void eliminate();

  int num_bodies_ = 0;
  long long products_ = 0;
  bool products_are_placed_ = false;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<int> order_;            ///< the bodies as they are eliminated
  std::vector<int> rank_;             ///< of a body in `order_`
  std::vector<int> column_start_;     ///< of each rank in `row_`; one more at the end
  std::vector<int> row_;              ///< ranks below the diagonal, ascending in each column
  std::vector<int> place_of_pair_;    ///< in `row_`
  std::vector<bool> is_new_;          ///< columns that are computed anew, by rank
  std::vector<bool> pair_is_turned_;  ///< whether a pair's block stands transposed there
  std::vector<int>
      product_place_;            ///< where each product of two blocks of a column goes: in `row_`; -1 - rank: diagonal
  std::vector<Block> diagonal_;  ///< lower triangles
  std::vector<Block> below_;     ///< as `row_`
};

}  // namespace pd::detail
