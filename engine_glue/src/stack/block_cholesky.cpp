#include "stack/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>

namespace pd::detail {

void BlockCholesky::set_pattern(int num_bodies, const std::vector<std::pair<int, int>>& pairs) {
  if (num_bodies == num_bodies_ && pairs == pairs_) return;
  num_bodies_ = num_bodies;
  pairs_ = pairs;
  eliminate();
  place_products();
  diagonal_.resize(static_cast<std::size_t>(num_bodies));
  below_.resize(row_.size());
}

/// Least degree first, of equals the first body: what it meets of those that are left then meets each other.
void BlockCholesky::eliminate() {
  const auto n = static_cast<std::size_t>(num_bodies_);
  std::vector<std::vector<int>> neighbours(n);
  for (const auto& [a, b] : pairs_) {
    neighbours[static_cast<std::size_t>(a)].push_back(b);
    neighbours[static_cast<std::size_t>(b)].push_back(a);
  }
  for (std::vector<int>& each : neighbours) std::sort(each.begin(), each.end());
  rank_.assign(n, -1);
  order_.clear();
  std::vector<std::vector<int>> columns;  // by rank, of bodies
  std::vector<int> merged;
  for (std::size_t rank = 0; rank < n; ++rank) {
    int least = -1;
    for (int body = 0; body < num_bodies_; ++body) {
      const auto at = static_cast<std::size_t>(body);
      if (rank_[at] >= 0) continue;
      if (least < 0 || neighbours[at].size() < neighbours[static_cast<std::size_t>(least)].size()) least = body;
    }
    rank_[static_cast<std::size_t>(least)] = static_cast<int>(rank);
    order_.push_back(least);
    columns.push_back(std::move(neighbours[static_cast<std::size_t>(least)]));
    const std::vector<int>& column = columns.back();
    for (const int body : column) {
      std::vector<int>& own = neighbours[static_cast<std::size_t>(body)];
      merged.clear();
      std::set_union(own.begin(), own.end(), column.begin(), column.end(), std::back_inserter(merged));
      own.clear();
      for (const int other : merged) {
        if (other != body && other != least) own.push_back(other);
      }
    }
  }
  column_start_.assign(1, 0);
  row_.clear();
  for (std::vector<int>& column : columns) {
    for (int& body : column) body = rank_[static_cast<std::size_t>(body)];
    std::sort(column.begin(), column.end());
    row_.insert(row_.end(), column.begin(), column.end());
    column_start_.push_back(static_cast<int>(row_.size()));
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

void BlockCholesky::factorise(const std::vector<Block>& own, const std::vector<Block>& shared) {
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    diagonal_[rank] = own[static_cast<std::size_t>(order_[rank])];
  }
  std::fill(below_.begin(), below_.end(), Block::Zero());
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    Block& block = below_[static_cast<std::size_t>(place_of_pair_[pair])];
    if (pair_is_turned_[pair]) {
      block = shared[pair].transpose();
    } else {
      block = shared[pair];
    }
  }
  std::size_t product = 0;
  for (std::size_t column = 0; column < order_.size(); ++column) {
    const auto begin = static_cast<std::size_t>(column_start_[column]);
    const auto end = static_cast<std::size_t>(column_start_[column + 1]);
    diagonal_[column] = Eigen::LLT<Block>(diagonal_[column]).matrixL();
    const auto factor = diagonal_[column].transpose().triangularView<Eigen::Upper>();
    for (std::size_t p = begin; p < end; ++p) {
      factor.solveInPlace<Eigen::OnTheRight>(below_[p]);
    }
    for (std::size_t p = begin; p < end; ++p) {
      const int across = -1 - product_place_[product++];
      diagonal_[static_cast<std::size_t>(across)].noalias() -= below_[p] * below_[p].transpose();
      for (std::size_t q = p + 1; q < end; ++q) {
        const auto place = static_cast<std::size_t>(product_place_[product++]);
        below_[place].noalias() -= below_[q] * below_[p].transpose();
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
