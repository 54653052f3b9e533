/// @file
/// Double-double arithmetic of four numbers at once. Every lane takes the steps of double_double.hpp in their order,
/// but for sums that are exact in one, so that its bits are those of the numbers on their own.
#pragma once

#include "numeric/double_double.hpp"
#include "numeric/fused_products.hpp"
#include "numeric/lanes.hpp"

namespace pd::detail {

/// @tparam Products  how the errors of products are found.
template <class Products>
struct DoubleDoubleLanesBy {
  Lanes hi, lo;
};
using DoubleDoubleLanes = DoubleDoubleLanesBy<SplitProducts>;

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

template <class P>
PD_INLINE void load(DoubleDoubleLanesBy<P>& to, const FourDoubleDoubles& from) {
  load(to.hi, from.hi);
  load(to.lo, from.lo);
}
template <class P>
PD_INLINE void store(FourDoubleDoubles& to, const DoubleDoubleLanesBy<P>& from) {
  store(to.hi, from.hi);
  store(to.lo, from.lo);
}
/// The same number in every lane.
template <class P>
PD_INLINE void spread(DoubleDoubleLanesBy<P>& to, const DoubleDouble& from) {
  const Lanes zero = {0, 0, 0, 0};
  to.hi = zero + from.hi;
  to.lo = zero + from.lo;
}

template <class P>
PD_INLINE void two_sum(DoubleDoubleLanesBy<P>& out, const Lanes& a, const Lanes& b) {
  const Lanes s = a + b;
  const Lanes bb = s - a;
  out.lo = (a - (s - bb)) + (b - bb);
  out.hi = s;
}
template <class P>
PD_INLINE void quick_two_sum(DoubleDoubleLanesBy<P>& out, const Lanes& a, const Lanes& b) {
  const Lanes s = a + b;
  out.lo = b - (s - a);
  out.hi = s;
}
template <class P>
PD_INLINE void two_product(DoubleDoubleLanesBy<P>& out, const Lanes& a, const Lanes& b) {
  const Lanes p = a * b;
  P::error(out.lo, p, a, b);
  out.hi = p;
}

template <class P>
PD_INLINE void add(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a, const DoubleDoubleLanesBy<P>& b) {
  DoubleDoubleLanesBy<P> s, t;
  two_sum(s, a.hi, b.hi);
  two_sum(t, a.lo, b.lo);
  quick_two_sum(s, s.hi, s.lo + t.hi);
  quick_two_sum(out, s.hi, s.lo + t.lo);
}
template <class P>
PD_INLINE void subtract(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a, const DoubleDoubleLanesBy<P>& b) {
  add(out, a, {-b.hi, -b.lo});
}
template <class P>
PD_INLINE void difference_of_near(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a,
                                  const DoubleDoubleLanesBy<P>& b) {
  DoubleDoubleLanesBy<P> s, t;
  two_sum(t, a.lo, -b.lo);
  quick_two_sum(s, a.hi - b.hi, t.hi);
  quick_two_sum(out, s.hi, s.lo + t.lo);
}
template <class P>
PD_INLINE void multiply(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a, const DoubleDoubleLanesBy<P>& b) {
  DoubleDoubleLanesBy<P> p;
  two_product(p, a.hi, b.hi);
  quick_two_sum(out, p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
template <class P>
PD_INLINE void multiply(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a, const Lanes& b) {
  DoubleDoubleLanesBy<P> p;
  two_product(p, a.hi, b);
  quick_two_sum(out, p.hi, p.lo + a.lo * b);
}
template <class P>
PD_INLINE void divide(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& a, const DoubleDoubleLanesBy<P>& b) {
  DoubleDoubleLanesBy<P> product, rest;
  const Lanes q1 = a.hi / b.hi;
  multiply(product, b, q1);
  difference_of_near(rest, a, product);
  const Lanes q2 = rest.hi / b.hi;
  multiply(product, b, q2);
  difference_of_near(rest, rest, product);
  const Lanes q3 = rest.hi / b.hi;
  DoubleDoubleLanesBy<P> quotient;
  quick_two_sum(quotient, q1, q2);
  add(out, quotient, {q3, Lanes{0, 0, 0, 0}});
}
/// u x v of the first three lanes.
template <class P>
PD_INLINE void cross(DoubleDoubleLanesBy<P>& out, const DoubleDoubleLanesBy<P>& u, const DoubleDoubleLanesBy<P>& v) {
  const auto yzx = [](Lanes & to, const Lanes& x) __attribute__((always_inline)) {
    to = __builtin_shufflevector(x, x, 1, 2, 0, 3);
  };
  DoubleDoubleLanesBy<P> u_next, v_next, left, right, turned;
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
/// The root of a number, in the steps of `sqrt`.
template <class P>
PD_INLINE DoubleDouble root(const DoubleDouble& x) {
  if (!(x.hi > 0)) return {0, 0};
  const double s = __builtin_sqrt(x.hi);
  DoubleDouble squared{s * s, 0};
  P::error(squared.lo, squared.hi, s, s);
  const DoubleDouble t = quick_two_sum(s, difference_of_near(x, squared).hi / (2 * s));
  DoubleDouble product{t.hi * t.hi, 0};
  P::error(product.lo, product.hi, t.hi, t.hi);
  const DoubleDouble rest = difference_of_near(x, quick_two_sum(product.hi, product.lo + (t.hi * t.lo + t.lo * t.hi)));
  return t + DoubleDouble{rest.hi / (2 * s), 0};
}

}  // namespace pd::detail
