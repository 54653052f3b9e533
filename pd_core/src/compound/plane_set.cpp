#include "compound/plane_set.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/quotient.hpp"
#include "numeric/root_sum.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

constexpr double kUnderflow = 0x1p-900;

using Integer = PlaneSet::Integer;
using Coefficients = std::array<Integer, 4>;

std::array<Integer, 3> cross(const Coefficients& a, const Coefficients& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The point where three planes meet is v / determinant.
struct Meet {
  std::array<Integer, 3> v;
  Integer determinant;
};

Meet meet_exactly(const Coefficients& f, const Coefficients& q, const Coefficients& r) {
  const auto qr = cross(q, r), rf = cross(r, f), fq = cross(f, q);
  Meet m;
  for (std::size_t i = 0; i < 3; ++i) m.v[i] = f[3] * qr[i] + q[3] * rf[i] + r[3] * fq[i];
  m.determinant = f[0] * qr[0] + f[1] * qr[1] + f[2] * qr[2];
  return m;
}

/// The same in doubles, with the sums of the absolute terms.
struct RoundedMeet {
  Vec3 v, v_size;
  double determinant, determinant_size;
};

/// A `Meet` in double-double. Its sizes are those of `RoundedMeet`: a term takes at most twelve operations of relative
/// error 2 kUdd, on coefficients within kUdd.
struct FineMeet {
  Vec3DD v;
  DoubleDouble determinant;
};
constexpr double kFineError = 32 * kUdd;

template <class Plane>
FineMeet meet_finely(const Plane& f, const Plane& q, const Plane& r) {
  const Vec3DD &nf = f.finer_normal, &nq = q.finer_normal, &nr = r.finer_normal;
  const Vec3DD qr = cross(nq, nr);
  return {scaled(qr, f.finer_offset) + scaled(cross(nr, nf), q.finer_offset) + scaled(cross(nf, nq), r.finer_offset),
          dot(nf, qr)};
}

/// True if every number within `error` of x rounds to x.hi; then so does the number that x stands for.
bool rounds_for_certain(const DoubleDouble& x, double error) {
  return x.hi + (x.lo + error) == x.hi && x.hi + (x.lo - error) == x.hi;
}

Vec3 cross_size(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]};
}

template <class Plane>
RoundedMeet meet_rounded(const Plane& f, const Plane& q, const Plane& r) {
  const Vec3 &nf = f.normal, &nq = q.normal, &nr = r.normal;
  const Vec3 af = nf.cwiseAbs(), aq = nq.cwiseAbs(), ar = nr.cwiseAbs();
  const Vec3 qr = nq.cross(nr), qr_size = cross_size(aq, ar);
  RoundedMeet m;
  m.v = f.offset * qr + q.offset * nr.cross(nf) + r.offset * nf.cross(nq);
  m.v_size =
      std::abs(f.offset) * qr_size + std::abs(q.offset) * cross_size(ar, af) + std::abs(r.offset) * cross_size(af, aq);
  m.determinant = nf.dot(qr);
  m.determinant_size = af.dot(qr_size);
  return m;
}

}  // namespace

Side PlaneSet::add(const Dyadic3& normal, const Dyadic& offset) {
  const std::array<Dyadic, 4> given{normal.x, normal.y, normal.z, offset.scaled(-scale_exponent_)};
  int exponent = 0;
  bool any = false;
  for (const Dyadic& c : given) {
    if (c.sign() == 0) continue;
    exponent = any ? std::min(exponent, c.exponent()) : c.exponent();
    any = true;
  }
  Coefficients exact;
  Integer divisor = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (given[i].sign() == 0) continue;
    exact[i] = given[i].mantissa() << static_cast<unsigned>(given[i].exponent() - exponent);
    divisor = divisor.is_zero() ? Integer(boost::multiprecision::abs(exact[i]))
                                : Integer(boost::multiprecision::gcd(divisor, exact[i]));
  }
  const int leading = exact[0].sign() != 0 ? exact[0].sign() : exact[1].sign() != 0 ? exact[1].sign() : exact[2].sign();
  if (leading < 0) divisor = -divisor;
  for (Integer& c : exact) {
    if (!c.is_zero()) c /= divisor;
  }
  const auto [found, inserted] = numbers_.try_emplace(exact, static_cast<std::int32_t>(planes_.size()));
  if (inserted) {
    int top = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!exact[i].is_zero()) top = std::max(top, top_bit(exact[i]));
    }
    const auto rounded = [&](const Integer& c) { return Dyadic::from_integer(c, -top).to_double(); };
    Plane plane;
    plane.normal = {rounded(exact[0]), rounded(exact[1]), rounded(exact[2])};
    plane.offset = rounded(exact[3]);
    plane.inverse_length = 1 / plane.normal.norm();
    const auto finer = [&](const Integer& c, double high) {
      const Dyadic rest = Dyadic::from_integer(c, -top) - Dyadic(high);
      return quick_two_sum(high, rest.sign() == 0 ? 0.0 : rest.to_double());
    };
    plane.finer_normal = {finer(exact[0], plane.normal[0]), finer(exact[1], plane.normal[1]),
                          finer(exact[2], plane.normal[2])};
    plane.finer_offset = finer(exact[3], plane.offset);
    plane.exact = std::move(exact);
    planes_.push_back(std::move(plane));
  }
  return Side(found->second, leading < 0);
}

Dyadic PlaneSet::exact_offset(Side s) const {
  const Integer& d = planes_[index(s)].exact[3];
  return Dyadic::from_integer(s.flipped() ? Integer(-d) : d, 0);
}

Dyadic3 PlaneSet::exact_normal(Side s) const {
  const Coefficients& c = planes_[index(s)].exact;
  const auto part = [&](std::size_t i) { return Dyadic::from_integer(s.flipped() ? Integer(-c[i]) : c[i], 0); };
  return {part(0), part(1), part(2)};
}

int PlaneSet::sign_at_meet(Side f, Side q, Side r, Side h) const {
  if (h.plane() == f.plane() || h.plane() == q.plane() || h.plane() == r.plane()) return 0;
  const Plane &pf = planes_[index(f)], &pq = planes_[index(q)], &pr = planes_[index(r)], &ph = planes_[index(h)];
  // Turning f, q or r round turns the point's numerator and denominator alike, which is what their product undoes.
  const int turned = f.orientation() * q.orientation() * r.orientation() * h.orientation();
  {
    const RoundedMeet m = meet_rounded(pf, pq, pr);
    const double value = ph.normal.dot(m.v) - ph.offset * m.determinant;
    const double size = ph.normal.cwiseAbs().dot(m.v_size) + std::abs(ph.offset) * m.determinant_size;
    // Four coefficients within 2u each (8u), and at most nine roundings on the way of a term.
    if (std::abs(value) > 24 * kUnitRoundoff * size + kUnderflow) return (value > 0 ? 1 : -1) * turned;
    const FineMeet fine = meet_finely(pf, pq, pr);
    const DoubleDouble finer = dot(ph.finer_normal, fine.v) - ph.finer_offset * fine.determinant;
    if (std::abs(finer.hi) > 2 * kFineError * size + kUnderflow) return (finer.hi > 0 ? 1 : -1) * turned;
  }
  ++exact_signs_;
  const Meet m = meet_exactly(pf.exact, pq.exact, pr.exact);
  const Integer value =
      ph.exact[0] * m.v[0] + ph.exact[1] * m.v[1] + ph.exact[2] * m.v[2] - ph.exact[3] * m.determinant;
  return value.sign() * turned;
}

int PlaneSet::sign_at_point(Side h, const Vec3& x) const {
  const Plane& p = planes_[index(h)];
  const double value = p.normal.dot(x) - p.offset;
  const double size = p.normal.cwiseAbs().dot(x.cwiseAbs()) + std::abs(p.offset);
  if (std::abs(value) > 8 * kUnitRoundoff * size + kUnderflow) return (value > 0 ? 1 : -1) * h.orientation();
  ++exact_signs_;
  return (dot(exact_normal(h), to_dyadic(x)) - exact_offset(h)).sign();
}

int PlaneSet::sign_on_ray(Side h, const Dyadic3& direction, const RayParameter& t) const {
  return (dot(exact_normal(h), direction) * t.numerator - exact_offset(h) * t.denominator).sign() *
         t.denominator.sign();
}

PlaneSet::ExactPoint PlaneSet::exact_meet(Side f, Side q, Side r) const {
  const Meet m = meet_exactly(planes_[index(f)].exact, planes_[index(q)].exact, planes_[index(r)].exact);
  const bool turned = f.orientation() * q.orientation() * r.orientation() < 0;
  const auto number = [&](const Integer& x) { return Dyadic::from_integer(turned ? Integer(-x) : x, 0); };
  return {{number(m.v[0]), number(m.v[1]), number(m.v[2])}, number(m.determinant)};
}

PlaneSet::Point PlaneSet::meet(Side f, Side q, Side r) const {
  const Plane &pf = planes_[index(f)], &pq = planes_[index(q)], &pr = planes_[index(r)];
  const RoundedMeet m = meet_rounded(pf, pq, pr);
  const double slack = 24 * kUnitRoundoff * m.determinant_size + kUnderflow;
  if (std::abs(m.determinant) > 2 * slack) {
    const double least = std::abs(m.determinant) - slack;
    const Vec3 x = m.v / m.determinant;
    const Vec3 error = (24 * kUnitRoundoff * m.v_size + x.cwiseAbs() * slack).array() / least +
                       4 * kUnitRoundoff * x.cwiseAbs().array();
    // Flat crossings are worth exact arithmetic, so that bounds stay near the rounding of the input.
    if (error.maxCoeff() <= 0x1p-46 * (1 + x.cwiseAbs().maxCoeff())) return {x, error.maxCoeff()};
  }
  const FineMeet fine = meet_finely(pf, pq, pr);
  const double fine_slack = kFineError * m.determinant_size + kUnderflow;
  if (std::abs(fine.determinant.hi) > 0x1p10 * fine_slack) {
    const double least = std::abs(fine.determinant.hi) - 2 * fine_slack;
    Vec3 x;
    bool certain = true;
    for (int i = 0; i < 3 && certain; ++i) {
      const DoubleDouble& above = i == 0 ? fine.v.x : i == 1 ? fine.v.y : fine.v.z;
      const DoubleDouble coordinate = above / fine.determinant;
      x[i] = coordinate.hi;
      const double error =
          (kFineError * m.v_size[i] + kUnderflow + std::abs(x[i]) * fine_slack) / least + 16 * kUdd * std::abs(x[i]);
      certain = rounds_for_certain(coordinate, 2 * error);
    }
    if (certain) return {x, 2 * kUnitRoundoff * x.cwiseAbs().maxCoeff() + kUnderflow};
  }
  const Meet e = meet_exactly(pf.exact, pq.exact, pr.exact);
  const Dyadic below = Dyadic::from_integer(e.determinant, 0);
  const auto coordinate = [&](std::size_t i) { return quotient(Dyadic::from_integer(e.v[i], 0), below); };
  const Vec3 x(coordinate(0), coordinate(1), coordinate(2));
  return {x, 2 * kUnitRoundoff * x.cwiseAbs().maxCoeff() + kUnderflow};
}

}  // namespace pd::detail
