/// @file
/// Double-double arithmetic of four numbers at once. Every lane takes the steps of double_double.hpp in their order, so
/// that its bits are those of the numbers on their own.
#pragma once

#include "numeric/double_double.hpp"
#include "numeric/lanes.hpp"

namespace pd::detail {

struct DoubleDoubleLanes {
  Lanes hi, lo;
};

/// Four numbers as they are kept in memory.
struct FourDoubleDoubles {
  double hi[kLanes];
  double lo[kLanes];

  [[nodiscard]] DoubleDouble operator[](int i) const { return {hi[i], lo[i]}; }
  void set(int i, const DoubleDouble& x) {
    hi[i] = x.hi;
    lo[i] = x.lo;
  }
};
/// The first three.
inline Vec3DD vector_of(const FourDoubleDoubles& x) { return {x[0], x[1], x[2]}; }

PD_INLINE void load(DoubleDoubleLanes& to, const FourDoubleDoubles& from) {
  load(to.hi, from.hi);
  load(to.lo, from.lo);
}
PD_INLINE void store(FourDoubleDoubles& to, const DoubleDoubleLanes& from) {
  store(to.hi, from.hi);
  store(to.lo, from.lo);
}
/// The same number in every lane.
PD_INLINE void spread(DoubleDoubleLanes& to, const DoubleDouble& from) {
  const Lanes zero = {0, 0, 0, 0};
  to.hi = zero + from.hi;
  to.lo = zero + from.lo;
}

PD_INLINE void two_sum(DoubleDoubleLanes& out, const Lanes& a, const Lanes& b) {
  const Lanes s = a + b;
  const Lanes bb = s - a;
  out.lo = (a - (s - bb)) + (b - bb);
  out.hi = s;
}
PD_INLINE void quick_two_sum(DoubleDoubleLanes& out, const Lanes& a, const Lanes& b) {
  const Lanes s = a + b;
  out.lo = b - (s - a);
  out.hi = s;
}
PD_INLINE void two_product(DoubleDoubleLanes& out, const Lanes& a, const Lanes& b) {
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  const Lanes p = a * b;
  const Lanes ca = kSplit * a, cb = kSplit * b;
  const Lanes a_hi = ca - (ca - a), b_hi = cb - (cb - b);
  const Lanes a_lo = a - a_hi, b_lo = b - b_hi;
  out.lo = ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
  out.hi = p;
}

PD_INLINE void add(DoubleDoubleLanes& out, const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  DoubleDoubleLanes s, t;
  two_sum(s, a.hi, b.hi);
  two_sum(t, a.lo, b.lo);
  quick_two_sum(s, s.hi, s.lo + t.hi);
  quick_two_sum(out, s.hi, s.lo + t.lo);
}
PD_INLINE void subtract(DoubleDoubleLanes& out, const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  add(out, a, {-b.hi, -b.lo});
}
PD_INLINE void multiply(DoubleDoubleLanes& out, const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  DoubleDoubleLanes p;
  two_product(p, a.hi, b.hi);
  quick_two_sum(out, p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
PD_INLINE void multiply(DoubleDoubleLanes& out, const DoubleDoubleLanes& a, const Lanes& b) {
  DoubleDoubleLanes p;
  two_product(p, a.hi, b);
  quick_two_sum(out, p.hi, p.lo + a.lo * b);
}
PD_INLINE void divide(DoubleDoubleLanes& out, const DoubleDoubleLanes& a, const DoubleDoubleLanes& b) {
  DoubleDoubleLanes product, rest;
  const Lanes q1 = a.hi / b.hi;
  multiply(product, b, q1);
  subtract(rest, a, product);
  const Lanes q2 = rest.hi / b.hi;
  multiply(product, b, q2);
  subtract(rest, rest, product);
  const Lanes q3 = rest.hi / b.hi;
  DoubleDoubleLanes quotient;
  quick_two_sum(quotient, q1, q2);
  add(out, quotient, {q3, Lanes{0, 0, 0, 0}});
}
/// u x v of the first three lanes.
PD_INLINE void cross(DoubleDoubleLanes& out, const DoubleDoubleLanes& u, const DoubleDoubleLanes& v) {
  const auto yzx = [](Lanes & to, const Lanes& x) __attribute__((always_inline)) {
    to = __builtin_shufflevector(x, x, 1, 2, 0, 3);
  };
  DoubleDoubleLanes u_next, v_next, left, right, turned;
  yzx(u_next.hi, u.hi);
  yzx(u_next.lo, u.lo);
  yzx(v_next.hi, v.hi);
  yzx(v_next.lo, v.lo);
  // Coordinate k of the difference, u_k v_k+1 - u_k+1 v_k, is coordinate k + 2 of the product.
  multiply(left, u, v_next);
  multiply(right, u_next, v);
  subtract(turned, left, right);
  yzx(out.hi, turned.hi);
  yzx(out.lo, turned.lo);
}

}  // namespace pd::detail
