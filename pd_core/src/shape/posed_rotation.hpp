/// @file
/// The rotations of a posed pair in double-double, column by column, four lanes at a time.
#pragma once

#include <cstdint>

#include "numeric/double_double_lanes.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/common_frame.hpp"

namespace pd::detail {

/// The columns of R; the last lanes are 0.
using ColumnsDD = FourDoubleDoubles[3];

/// R of both poses: a quaternion's from the exact rational, each entry within 2^-100; a matrix as it stands.
void rotations_in_double_double(const Pose& pose_a, const Pose& pose_b, ColumnsDD& columns_a, ColumnsDD& columns_b);

/// Whether R is what its columns hold, hi parts alone, exactly: a matrix, or a quaternion of one component, whose
/// rotation is a turn by 0 or a half about an axis.
[[nodiscard]] bool stored_in_doubles(const Pose& pose, const ColumnsDD& columns);
/// Whether R does no more than exchange and reverse axes, exactly.
[[nodiscard]] bool exchanges_axes(const Pose& pose, const ColumnsDD& columns);
/// What R exchanges and reverses, where it does no more.
[[nodiscard]] AxisExchange exchange_of(const ColumnsDD& columns);

/// factor * (to - from) in a body's frame, for R to turn; an absent index (-1) stands for the local origin.
struct LocalVector {
  const ColumnsDD* columns = nullptr;  ///< null: the vector is 0
  DoubleDouble coordinates[3];         ///< of no value then

  /// Requires that products with the factor are exact: it is a power of two, or its negative.
  LocalVector(const ConvexPolytope& p, const ColumnsDD& r, double factor, int to, int from) {
    if (to < 0 && from < 0) return;
    columns = &r;
    const double* const all[3] = {p.x(), p.y(), p.z()};
    for (int i = 0; i < 3; ++i) {
      const double t = to >= 0 ? all[i][to] * factor : 0;
      const double f = from >= 0 ? all[i][from] * factor : 0;
      coordinates[i] = two_sum(t, -f);
    }
  }
};

/// R_v v + R_w w + offset (or null).
struct TurnedSum {
  LocalVector v;
  LocalVector w;
  const FourDoubleDoubles* offset = nullptr;
};

template <class P>
PD_INLINE void turn(DoubleDoubleLanesBy<P>& out, const LocalVector& v) {
  DoubleDoubleLanesBy<P> column, coordinate, product;
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

/// The last lane is 0.
template <class P>
PD_INLINE void add_up(DoubleDoubleLanesBy<P>& out, const TurnedSum& sum) {
  DoubleDoubleLanesBy<P> more;
  out.hi = out.lo = Lanes{0, 0, 0, 0};
  if (sum.v.columns != nullptr) turn(out, sum.v);
  if (sum.w.columns != nullptr) {
    turn(more, sum.w);
    add(out, out, more);
  }
  if (sum.offset != nullptr) {
    load(more, *sum.offset);
    add(out, out, more);
  }
}

/// R^T x.
[[nodiscard]] Vec3DD turned_back(const ColumnsDD& r, const Vec3DD& x);

}  // namespace pd::detail
