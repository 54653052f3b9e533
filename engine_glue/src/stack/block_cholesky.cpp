#include "stack/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <utility>

#include "stack/block_products.hpp"

namespace pd::detail {

void BlockCholesky::set_pattern(int num_bodies, const std::vector<std::pair<int, int>>& pairs) {
  if (num_bodies == num_bodies_ && pairs == pairs_) return;
  num_bodies_ = num_bodies;
  pairs_ = pairs;
  choose_order();
  find_columns();
  products_are_placed_ = false;
  diagonal_.resize(static_cast<std::size_t>(num_bodies));
  below_.resize(row_.size());
}

void BlockCholesky::choose_order() {
  std::vector<Eigen::Triplet<double>> entries;
  for (int body = 0; body < num_bodies_; ++body) entries.emplace_back(body, body, 1.0);
  for (const auto& [a, b] : pairs_) entries.emplace_back(b, a, 1.0);
  Eigen::SparseMatrix<double> pattern(num_bodies_, num_bodies_);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(pattern, order);
  order_.assign(order.indices().data(), order.indices().data() + num_bodies_);
  rank_.resize(order_.size());
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    rank_[static_cast<std::size_t>(order_[rank])] = static_cast<int>(rank);
  }
}

/// A column holds the blocks of its own pairs, and those of each column whose first block below the diagonal lies in
/// its row: a body that is eliminated leaves its neighbours connected, and the first of them takes the others over.
void BlockCholesky::find_columns() {
  std::vector<std::vector<int>> columns(order_.size());
  for (const auto& [a, b] : pairs_) {
    const auto [first, second] = std::minmax(rank_[static_cast<std::size_t>(a)], rank_[static_cast<std::size_t>(b)]);
    columns[static_cast<std::size_t>(first)].push_back(second);
  }
  products_ = 0;
  column_start_.assign(1, 0);
  row_.clear();
  for (std::vector<int>& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    row_.insert(row_.end(), column.begin(), column.end());
    column_start_.push_back(static_cast<int>(row_.size()));
    products_ += static_cast<long long>(column.size() * (column.size() + 1) / 2);
    if (column.size() < 2) continue;
    std::vector<int>& heir = columns[static_cast<std::size_t>(column.front())];
    heir.insert(heir.end(), column.begin() + 1, column.end());
  }
}

void BlockCholesky::place_products() {
  const auto place_of = [this](int row, int column) {
    const auto begin = row_.begin() + column_start_[static_cast<std::size_t>(column)];
    const auto end = row_.begin() + column_start_[static_cast<std::size_t>(column) + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - row_.begin());
  };
  place_of_pair_.clear();
  pair_is_turned_.clear();
  for (const auto& [a, b] : pairs_) {
    const int rank_a = rank_[static_cast<std::size_t>(a)];
    const int rank_b = rank_[static_cast<std::size_t>(b)];
    place_of_pair_.push_back(place_of(std::max(rank_a, rank_b), std::min(rank_a, rank_b)));
    pair_is_turned_.push_back(rank_a > rank_b);
  }
  product_place_.clear();
  for (int column = 0; column < num_bodies_; ++column) {
    const int end = column_start_[static_cast<std::size_t>(column) + 1];
    for (int p = column_start_[static_cast<std::size_t>(column)]; p < end; ++p) {
      const int across = row_[static_cast<std::size_t>(p)];
      product_place_.push_back(-1 - across);
      for (int q = p + 1; q < end; ++q) product_place_.push_back(place_of(row_[static_cast<std::size_t>(q)], across));
    }
  }
}

void BlockCholesky::factorise(const std::vector<Block>& own, const std::vector<Block>& shared,
                              const std::vector<bool>& changed_bodies) {
  if (!std::exchange(products_are_placed_, true)) place_products();
  is_new_.assign(order_.size(), false);
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    if (changed_bodies[static_cast<std::size_t>(order_[rank])]) is_new_[rank] = true;
    const auto first = static_cast<std::size_t>(column_start_[rank]);
    const bool has_heir = first < static_cast<std::size_t>(column_start_[rank + 1]);
    if (is_new_[rank] && has_heir) is_new_[static_cast<std::size_t>(row_[first])] = true;
  }
  reset_columns(own, shared);
  eliminate();
}

void BlockCholesky::reset_columns(const std::vector<Block>& own, const std::vector<Block>& shared) {
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    if (!is_new_[rank]) continue;
    diagonal_[rank] = own[static_cast<std::size_t>(order_[rank])];
    std::fill(below_.begin() + column_start_[rank], below_.begin() + column_start_[rank + 1], Block::Zero());
  }
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    const auto [a, b] = pairs_[pair];
    const int column = std::min(rank_[static_cast<std::size_t>(a)], rank_[static_cast<std::size_t>(b)]);
    if (!is_new_[static_cast<std::size_t>(column)]) continue;
    Block& block = below_[static_cast<std::size_t>(place_of_pair_[pair])];
    if (pair_is_turned_[pair]) {
      block = shared[pair].transpose();
    } else {
      block = shared[pair];
    }
  }
}

void BlockCholesky::eliminate() {
  std::size_t product = 0;
  for (std::size_t column = 0; column < order_.size(); ++column) {
    const auto begin = static_cast<std::size_t>(column_start_[column]);
    const auto end = static_cast<std::size_t>(column_start_[column + 1]);
    if (is_new_[column]) {
      diagonal_[column] = Eigen::LLT<Block>(diagonal_[column]).matrixL();
      for (std::size_t p = begin; p < end; ++p) divide_by_transpose(below_[p], diagonal_[column]);
    }
    for (std::size_t p = begin; p < end; ++p) {
      const auto across = static_cast<std::size_t>(-1 - product_place_[product++]);
      if (!is_new_[across]) {
        product += end - p - 1;
        continue;
      }
      subtract_square(diagonal_[across], below_[p]);
      for (std::size_t q = p + 1; q < end; ++q) {
        subtract_product(below_[static_cast<std::size_t>(product_place_[product++])], below_[q], below_[p]);
      }
    }
  }
}

void BlockCholesky::solve(Eigen::VectorXd& x) const {
  for (std::size_t column = 0; column < order_.size(); ++column) {
    auto own = x.segment<6>(6 * order_[column]);
    diagonal_[column].triangularView<Eigen::Lower>().solveInPlace(own);
    for (int p = column_start_[column]; p < column_start_[column + 1]; ++p) {
      const auto at = static_cast<std::size_t>(p);
      x.segment<6>(6 * order_[static_cast<std::size_t>(row_[at])]) -= below_[at] * own;
    }
  }
  for (std::size_t column = order_.size(); column-- > 0;) {
    auto own = x.segment<6>(6 * order_[column]);
    for (int p = column_start_[column]; p < column_start_[column + 1]; ++p) {
      const auto at = static_cast<std::size_t>(p);
      own -= below_[at].transpose() * x.segment<6>(6 * order_[static_cast<std::size_t>(row_[at])]);
    }
    diagonal_[column].transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
}

}  // namespace pd::detail
