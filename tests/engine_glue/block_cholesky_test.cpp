// Blocks of 6 x 6 factorised by minimum degree, against the dense matrix.
#include "stack/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <set>

namespace pd::test {
namespace {

using detail::BlockCholesky;
using Block = BlockCholesky::Block;

TEST(BlockCholesky, SolvesAsTheDenseMatrixDoes) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto block = [&] { return Block(Block::NullaryExpr([&] { return normal(random); })); };
  BlockCholesky factor;
  for (int trial = 0; trial < 60; ++trial) {
    const int bodies = 1 + static_cast<int>(random() % 20);
    std::set<std::pair<int, int>> chosen;
    for (int i = 0; i < 2 * bodies; ++i) {
      const int a = static_cast<int>(random() % static_cast<unsigned>(bodies));
      const int b = static_cast<int>(random() % static_cast<unsigned>(bodies));
      if (a != b) chosen.emplace(std::min(a, b), std::max(a, b));
    }
    const std::vector<std::pair<int, int>> pairs(chosen.begin(), chosen.end());
    std::vector<Block> own;
    std::vector<Block> shared;
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * bodies, 6 * bodies);
    for (int i = 0; i < bodies; ++i) {
      const Block random_block = block();
      own.emplace_back(random_block * random_block.transpose() + 400 * Block::Identity());
      dense.block<6, 6>(6 * i, 6 * i) = own.back();
    }
    for (const auto& [a, b] : pairs) {
      shared.push_back(block());
      dense.block<6, 6>(6 * b, 6 * a) = shared.back();
      dense.block<6, 6>(6 * a, 6 * b) = shared.back().transpose();
    }
    const Eigen::VectorXd right = Eigen::VectorXd::NullaryExpr(6 * bodies, [&] { return normal(random); });
    factor.set_pattern(bodies, pairs);
    for (int again = 0; again < 2; ++again) {
      factor.factorise(own, shared, std::vector<bool>(own.size(), true));
      Eigen::VectorXd x = right;
      factor.solve(x);
      EXPECT_LT((dense * x - right).norm(), 1e-10 * right.norm()) << trial;
    }
  }
}

/// Where a few bodies change, only the columns that they reach are computed anew.
TEST(BlockCholesky, ChangesLeaveTheBitsOfAFactorisationOfTheWhole) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto block = [&] { return Block(Block::NullaryExpr([&] { return normal(random); })); };
  const auto definite = [&] {
    const Block factor = block();
    return Block(factor * factor.transpose() + 400 * Block::Identity());
  };
  for (int trial = 0; trial < 60; ++trial) {
    const int bodies = 2 + static_cast<int>(random() % 20);
    std::vector<std::pair<int, int>> pairs;
    for (int a = 0; a < bodies; ++a) {
      for (int b = a + 1; b < bodies; ++b) {
        if (b == a + 1 || random() % static_cast<unsigned>(bodies) == 0) pairs.emplace_back(a, b);
      }
    }
    std::vector<Block> own, shared;
    for (int i = 0; i < bodies; ++i) own.push_back(definite());
    for (std::size_t i = 0; i < pairs.size(); ++i) shared.push_back(block());
    BlockCholesky changed, whole;
    changed.set_pattern(bodies, pairs);
    changed.factorise(own, shared, std::vector<bool>(own.size(), true));
    whole.set_pattern(bodies, pairs);
    for (unsigned one_in = 1; one_in <= 16; one_in *= 2) {
      std::vector<bool> is_changed;
      for (int i = 0; i < bodies; ++i) {
        is_changed.push_back(random() % one_in == 0);
        if (is_changed.back()) own[static_cast<std::size_t>(i)] = definite();
      }
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [a, b] = pairs[i];
        if (is_changed[static_cast<std::size_t>(a)] && is_changed[static_cast<std::size_t>(b)]) shared[i] = block();
      }
      changed.factorise(own, shared, is_changed);
      whole.factorise(own, shared, std::vector<bool>(own.size(), true));
      Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(6 * bodies, [&] { return normal(random); });
      Eigen::VectorXd y = x;
      changed.solve(x);
      whole.solve(y);
      EXPECT_EQ(x, y) << trial << ", one body in " << one_in;
    }
  }
}

/// Least degree looked for among all bodies takes minutes at this size.
TEST(BlockCholesky, SolvesAPileOfFiveThousandBodies) {
  constexpr int kSide = 70;
  std::vector<std::pair<int, int>> pairs;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const int body = kSide * row + column;
      if (column + 1 < kSide) pairs.emplace_back(body, body + 1);
      if (row + 1 < kSide) pairs.emplace_back(body, body + kSide);
    }
  }
  constexpr int kBodies = kSide * kSide;
  const std::vector<Block> own(kBodies, 5 * Block::Identity()), shared(pairs.size(), -Block::Identity());
  BlockCholesky factor;
  factor.set_pattern(kBodies, pairs);
  factor.factorise(own, shared, std::vector<bool>(own.size(), true));
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(6 * kBodies, -1, 1);
  Eigen::VectorXd x = 5 * expected;
  for (const auto& [a, b] : pairs) {
    x.segment<6>(6 * a) -= expected.segment<6>(6 * b);
    x.segment<6>(6 * b) -= expected.segment<6>(6 * a);
  }
  factor.solve(x);
  EXPECT_LT((x - expected).norm(), 1e-10 * expected.norm());
}

}  // namespace
}  // namespace pd::test
