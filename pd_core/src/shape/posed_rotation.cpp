#include "shape/posed_rotation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "numeric/fused_products.hpp"

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

template <class P>
PD_INLINE void product_of(DoubleDoubleLanesBy<P>& out, const double (&a)[4], const double (&b)[4]) {
  Lanes x, y;
  load(x, a);
  load(y, b);
  two_product(out, x, y);
}

/// |q|^2.
template <class P>
PD_INLINE DoubleDouble sum_of(const DoubleDoubleLanesBy<P>& squares) {
  FourDoubleDoubles s;
  store(s, squares);
  return s[0] + s[1] + s[2] + s[3];
}

template <class P>
PD_INLINE void rotation_entries(const QuaternionFactors& q, const double (&wxyz)[4], RotationEntries& out) {
  DoubleDoubleLanesBy<P> norm, entries, square, left, right;
  product_of(square, wxyz, wxyz);
  spread(norm, sum_of(square));
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

/// Of a quaternion of one component, whatever its length: a turn by 0 or by a half about an axis.
void half_turn(const std::array<double, 4>& q, ColumnsDD& columns) {
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) columns[j].set(i, {});
    columns[j].hi[j] = q[0] != 0 || q[static_cast<std::size_t>(j) + 1] != 0 ? 1 : -1;
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
  if (std::count(q.begin(), q.end(), 0.0) == 3) {
    half_turn(q, columns);
    return;
  }
  const QuaternionFactors factors = factors_of(q[0], q[1], q[2], q[3]);
  const double wxyz[4] = {q[0], q[1], q[2], q[3]};
  RotationEntries entries;
  with_products([&](auto products)
                    __attribute__((always_inline)) { rotation_entries<decltype(products)>(factors, wxyz, entries); });
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

Vec3DD turned_back(const ColumnsDD& r, const Vec3DD& x) {
  const auto along = [&](const FourDoubleDoubles& c) { return c[0] * x.x + c[1] * x.y + c[2] * x.z; };
  return {along(r[0]), along(r[1]), along(r[2])};
}

}  // namespace pd::detail
