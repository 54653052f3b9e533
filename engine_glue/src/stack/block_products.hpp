/// @file
/// Products of blocks of 6 x 6 by columns, each column in three registers of two doubles. Of symmetric blocks the lower
/// triangle is kept, and some entries above it.
#pragma once

#include <Eigen/Core>

namespace pd::detail {

using Block6 = Eigen::Matrix<double, 6, 6>;
using Column6 = Eigen::Matrix<double, 6, 1>;

/// Calls visit(column, the part of it from its diagonal on, or from the row before) for the columns of a lower
/// triangle.
template <class Visit>
void visit_lower(Block6& c, const Visit& visit) {
  for (int j = 0; j < 2; ++j) visit(j, c.col(j).tail<6>());
  for (int j = 2; j < 4; ++j) visit(j, c.col(j).tail<4>());
  for (int j = 4; j < 6; ++j) visit(j, c.col(j).tail<2>());
}

/// c += s v v^T
inline void add_square(Block6& c, const Column6& v, double s) {
  visit_lower(c, [&](int j, auto column) { column += (s * v[j]) * v.tail<decltype(column)::RowsAtCompileTime>(); });
}

/// c -= a a^T
inline void subtract_square(Block6& c, const Block6& a) {
  visit_lower(c, [&](int j, auto column) {
    constexpr int kRows = decltype(column)::RowsAtCompileTime;
    Eigen::Matrix<double, kRows, 1> sum = column;
    for (int k = 0; k < 6; ++k) sum -= a(j, k) * a.col(k).tail<kRows>();
    column = sum;
  });
}

/// c -= a b^T
inline void subtract_product(Block6& c, const Block6& a, const Block6& b) {
  for (int j = 0; j < 6; ++j) {
    Column6 sum = c.col(j);
    for (int k = 0; k < 6; ++k) sum -= b(j, k) * a.col(k);
    c.col(j) = sum;
  }
}

/// Solves x l^T = x in place, l the lower triangle.
inline void divide_by_transpose(Block6& x, const Block6& l) {
  for (int j = 0; j < 6; ++j) {
    Column6 left = x.col(j);
    for (int k = 0; k < j; ++k) left -= l(j, k) * x.col(k);
    x.col(j) = (1 / l(j, j)) * left;
  }
}

}  // namespace pd::detail
