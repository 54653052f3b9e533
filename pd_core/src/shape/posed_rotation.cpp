#include "shape/posed_rotation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

/// The entries of R(q) by twos: its diagonal, and those above and below it, whose numerators are sums and differences
/// of the same products.
struct RotationEntries {
  FourDoubleDoubles diagonal;
  FourDoubleDoubles sums;         ///< 10, 02, 21
  FourDoubleDoubles differences;  ///< 01, 20, 12
};

/// Factors of the products that the numerators are made of, four lanes each, the last 0. In memory: valgrind does not
/// know an instruction that puts them together in registers.
struct QuaternionFactors {
  double w[4], x[4], y[4], z[4];
  double signed_x[4], signed_y[4], signed_z[4];  ///< ww + xx - yy - zz, ww - xx + yy - zz, ww - xx - yy + zz
  double left[2][4], right[2][4];                ///< xy and wz, xz and wy, yz and wx
};

QuaternionFactors factors_of(double w, double x, double y, double z) {
  return {{w, w, w, 0},
          {x, x, x, 0},
          {y, y, y, 0},
          {z, z, z, 0},
          {x, -x, -x, 0},
          {-y, y, -y, 0},
          {-z, -z, z, 0},
          {{x, x, y, 0}, {y, z, z, 0}},
          {{w, w, w, 0}, {z, y, x, 0}}};
}

PD_INLINE void product_of(DoubleDoubleLanes& out, const double (&a)[4], const double (&b)[4]) {
  Lanes x, y;
  load(x, a);
  load(y, b);
  two_product(out, x, y);
}

PD_CLONES void rotation_entries(const QuaternionFactors& q, const DoubleDouble& squared_norm, RotationEntries& out) {
  DoubleDoubleLanes norm, entries, square, left, right;
  spread(norm, squared_norm);
  product_of(entries, q.w, q.w);
  product_of(square, q.x, q.signed_x);
  add(entries, entries, square);
  product_of(square, q.y, q.signed_y);
  add(entries, entries, square);
  product_of(square, q.z, q.signed_z);
  add(entries, entries, square);
  divide(entries, entries, norm);
  store(out.diagonal, entries);
  product_of(left, q.left[0], q.left[1]);
  product_of(right, q.right[0], q.right[1]);
  add(entries, left, right);
  divide(entries, {2.0 * entries.hi, 2.0 * entries.lo}, norm);
  store(out.sums, entries);
  subtract(entries, left, right);
  divide(entries, {2.0 * entries.hi, 2.0 * entries.lo}, norm);
  store(out.differences, entries);
}

PD_INLINE void turn(DoubleDoubleLanes& out, const LocalVector& v) {
  DoubleDoubleLanes column, coordinate, product;
  load(column, (*v.columns)[0]);
  spread(coordinate, v.coordinates[0]);
  multiply(out, column, coordinate);
  for (int j = 1; j < 3; ++j) {
    load(column, (*v.columns)[j]);
    spread(coordinate, v.coordinates[j]);
    multiply(product, column, coordinate);
    add(out, out, product);
  }
}

/// Entries 0, 1 and -1 only.
bool whole(const FourDoubleDoubles& column) {
  return std::all_of(column.lo, column.lo + 3, [](double x) { return x == 0; }) &&
         std::all_of(column.hi, column.hi + 3, [](double x) { return x == 0 || std::abs(x) == 1; });
}

}  // namespace

void rotation_in_double_double(const Pose& pose, ColumnsDD& columns) {
  if (!pose.is_quaternion()) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) columns[j].set(i, {pose.rotation()(i, j), 0});
      columns[j].set(3, {});
    }
    return;
  }
  const std::array<double, 4>& q = pose.quaternion_wxyz();
  DoubleDouble norm{0, 0};
  for (const double c : q) norm = norm + two_product(c, c);
  RotationEntries entries;
  rotation_entries(factors_of(q[0], q[1], q[2], q[3]), norm, entries);
  for (int j = 0; j < 3; ++j) {
    columns[j].set(j, entries.diagonal[j]);
    columns[j].set(3, {});
  }
  columns[0].set(1, entries.sums[0]);
  columns[2].set(0, entries.sums[1]);
  columns[1].set(2, entries.sums[2]);
  columns[1].set(0, entries.differences[0]);
  columns[0].set(2, entries.differences[1]);
  columns[2].set(1, entries.differences[2]);
}

bool stored_in_doubles(const Pose& pose, const ColumnsDD& columns) {
  if (!pose.is_quaternion()) return true;
  const std::array<double, 4>& q = pose.quaternion_wxyz();
  return std::count(q.begin(), q.end(), 0.0) == 3 && std::all_of(std::begin(columns), std::end(columns), whole);
}

bool exchanges_axes(const Pose& pose, const ColumnsDD& columns) {
  if (!stored_in_doubles(pose, columns) || !std::all_of(std::begin(columns), std::end(columns), whole)) return false;
  for (int i = 0; i < 3; ++i) {
    if (std::count(columns[i].hi, columns[i].hi + 3, 0.0) != 2) return false;
    if (std::abs(columns[0].hi[i]) + std::abs(columns[1].hi[i]) + std::abs(columns[2].hi[i]) != 1) return false;
  }
  return true;
}

PD_CLONES void turned_sum(const LocalVector& v, const LocalVector& w, const FourDoubleDoubles* offset,
                          FourDoubleDoubles& out) {
  DoubleDoubleLanes sum, more;
  const Lanes zero = {0, 0, 0, 0};
  sum.hi = sum.lo = zero;
  if (v.columns != nullptr) turn(sum, v);
  if (w.columns != nullptr) {
    turn(more, w);
    add(sum, sum, more);
  }
  if (offset != nullptr) {
    load(more, *offset);
    add(sum, sum, more);
  }
  store(out, sum);
}

Vec3DD turned_back(const ColumnsDD& r, const Vec3DD& x) {
  const auto along = [&](const FourDoubleDoubles& c) { return c[0] * x.x + c[1] * x.y + c[2] * x.z; };
  return {along(r[0]), along(r[1]), along(r[2])};
}

}  // namespace pd::detail
