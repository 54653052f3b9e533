/// @file
/// Numbers of 1,200 bits, and vectors of them: products of a few doubles of like exponents are exact, the rest is off
/// by nothing that counts.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "numeric/dyadic.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::bench {

using Numbers = std::vector<double>;

using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<1200, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

inline Real real(const detail::Dyadic& x) { return ldexp(Real(x.mantissa().str()), x.exponent()); }

struct RealVector {
  Real x, y, z;
};
inline RealVector real(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline RealVector operator+(const RealVector& u, const RealVector& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
inline RealVector operator-(const RealVector& u, const RealVector& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
inline RealVector operator*(const RealVector& u, const Real& s) { return {u.x * s, u.y * s, u.z * s}; }
inline Real dot(const RealVector& u, const RealVector& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
inline RealVector cross(const RealVector& u, const RealVector& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

}  // namespace pd::bench
