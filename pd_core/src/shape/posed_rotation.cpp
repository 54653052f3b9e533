#include "shape/posed_rotation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>

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
  double all[4];  ///< w, x, y, z
  double w[4], x[4], y[4], z[4];
  double signed_x[4], signed_y[4], signed_z[4];  ///< ww + xx - yy - zz, ww - xx + yy - zz, ww - xx - yy + zz
  double left[2][4], right[2][4];                ///< xy and wz, xz and wy, yz and wx
};

QuaternionFactors factors_of(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return {{w, x, y, z},
          {w, w, w, 0},
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

/// Of one rotation or two, step by step: each is one long chain of operations, and a processor works on two at once.
template <class P, int N>
PD_INLINE void rotation_entries(const QuaternionFactors* q, RotationEntries* out) {
  DoubleDoubleLanesBy<P> norm[N], entries[N], square[N], left[N], right[N];
  for (int k = 0; k < N; ++k) product_of(square[k], q[k].all, q[k].all);
  for (int k = 0; k < N; ++k) spread(norm[k], sum_of(square[k]));
  for (int k = 0; k < N; ++k) product_of(entries[k], q[k].w, q[k].w);
  for (int k = 0; k < N; ++k) product_of(square[k], q[k].x, q[k].signed_x);
  for (int k = 0; k < N; ++k) add(entries[k], entries[k], square[k]);
  for (int k = 0; k < N; ++k) product_of(square[k], q[k].y, q[k].signed_y);
  for (int k = 0; k < N; ++k) add(entries[k], entries[k], square[k]);
  for (int k = 0; k < N; ++k) product_of(square[k], q[k].z, q[k].signed_z);
  for (int k = 0; k < N; ++k) add(entries[k], entries[k], square[k]);
  for (int k = 0; k < N; ++k) divide(entries[k], entries[k], norm[k]);
  for (int k = 0; k < N; ++k) store(out[k].diagonal, entries[k]);
  for (int k = 0; k < N; ++k) {
    product_of(left[k], q[k].left[0], q[k].left[1]);
    product_of(right[k], q[k].right[0], q[k].right[1]);
  }
  for (int k = 0; k < N; ++k) add(entries[k], left[k], right[k]);
  for (int k = 0; k < N; ++k) divide(entries[k], {2.0 * entries[k].hi, 2.0 * entries[k].lo}, norm[k]);
  for (int k = 0; k < N; ++k) store(out[k].sums, entries[k]);
  for (int k = 0; k < N; ++k) subtract(entries[k], left[k], right[k]);
  for (int k = 0; k < N; ++k) divide(entries[k], {2.0 * entries[k].hi, 2.0 * entries[k].lo}, norm[k]);
  for (int k = 0; k < N; ++k) store(out[k].differences, entries[k]);
}

/// Where no entry is rounded: a matrix, or a quaternion of one component, which is a turn by 0 or by a half about an
/// axis, whatever its length.
bool as_stored(const Pose& pose, ColumnsDD& columns) {
  const std::array<double, 4>& q = pose.quaternion_wxyz();
  const bool matrix = !pose.is_quaternion();
  if (!matrix && std::count(q.begin(), q.end(), 0.0) != 3) return false;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) columns[j].set(i, {matrix ? pose.rotation()(i, j) : 0, 0});
    columns[j].set(3, {});
    if (!matrix) columns[j].hi[j] = q[0] != 0 || q[static_cast<std::size_t>(j) + 1] != 0 ? 1 : -1;
  }
  return true;
}

void columns_of(const RotationEntries& entries, ColumnsDD& columns) {
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

/// Entries 0, 1 and -1 only.
bool whole(const FourDoubleDoubles& column) {
  return std::all_of(column.lo, column.lo + 3, [](double x) { return x == 0; }) &&
         std::all_of(column.hi, column.hi + 3, [](double x) { return x == 0 || std::abs(x) == 1; });
}

}  // namespace

void rotations_in_double_double(const Pose& pose_a, const Pose& pose_b, ColumnsDD& columns_a, ColumnsDD& columns_b) {
  QuaternionFactors factors[2];
  ColumnsDD* columns[2];
  int count = 0;
  for (const auto& [pose, of] : {std::pair{&pose_a, &columns_a}, std::pair{&pose_b, &columns_b}}) {
    if (as_stored(*pose, *of)) continue;
    factors[count] = factors_of(pose->quaternion_wxyz());
    columns[count++] = of;
  }
  if (count == 0) return;
  RotationEntries entries[2];
  with_products([&](auto products) __attribute__((always_inline)) {
    using Products = decltype(products);
    // A split product takes 17 operations in place of one, so the rare way holds the code of one rotation only.
    if (!std::is_same_v<Products, SplitProducts> && count == 2) {
      rotation_entries<Products, 2>(factors, entries);
    } else {
      for (int k = 0; k < count; ++k) rotation_entries<Products, 1>(factors + k, entries + k);
    }
  });
  for (int k = 0; k < count; ++k) columns_of(entries[k], *columns[k]);
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

AxisExchange exchange_of(const ColumnsDD& columns) {
  AxisExchange out;
  for (int j = 0; j < 3; ++j) {
    const FourDoubleDoubles& column = columns[j];
    const std::size_t i = column.hi[0] != 0 ? 0 : column.hi[1] != 0 ? 1 : 2;
    out.axis[i] = static_cast<std::int8_t>(j);
    out.sign[i] = column.hi[i] < 0 ? -1 : 1;
  }
  return out;
}

}  // namespace pd::detail
