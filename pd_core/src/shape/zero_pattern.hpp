/// @file
/// Zeros that are read off the stored numbers: aligned boxes and prisms make ties by the dozen, and a determinant whose
/// six products each have a factor 0 needs no arithmetic.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"
#include "shape/common_frame.hpp"

namespace pd::detail {

/// Bit 3 i + j: entry (i, j) of the rotation is exactly zero, read off the stored numbers.
inline std::uint32_t zero_entries(const Pose& pose) {
  std::uint32_t mask = 0;
  const auto set = [&](int i, int j, bool zero) { mask |= static_cast<std::uint32_t>(zero) << (3 * i + j); };
  if (!pose.is_quaternion()) {
    for (int i = 0; i < 9; ++i) set(i / 3, i % 3, pose.rotation()(i / 3, i % 3) == 0);
    return mask;
  }
  // Off the diagonal an entry is 2 (p q +- r s): zero when both products are, whatever rounding does.
  const std::array<double, 4>& q = pose.quaternion_wxyz();
  if (q[0] != 0 && q[1] != 0 && q[2] != 0 && q[3] != 0) return 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const std::size_t x = static_cast<std::size_t>(i) + 1, y = static_cast<std::size_t>(j) + 1, z = 6 - x - y;
      set(i, j, (q[x] == 0 || q[y] == 0) && (q[0] == 0 || q[z] == 0));
    }
  }
  return mask;
}

/// Those of no rotation but for axes that are exchanged.
inline std::uint32_t zero_entries(const AxisExchange& exchange) {
  std::uint32_t mask = 0b111'111'111;
  for (unsigned k = 0; k < 3; ++k) mask &= ~(1u << (3 * k + static_cast<unsigned>(exchange.axis[k])));
  return mask;
}

/// Bit i: coordinate i of R (to - from) is exactly zero because each of its three products is. -1 stands for the origin
/// of the body's frame.
inline std::uint32_t zero_coordinates(const ConvexPolytope& body, std::uint32_t rotation, int from, int to) {
  const auto same = [&](const double* x) {
    return static_cast<std::uint32_t>((from < 0 ? 0 : x[from]) == (to < 0 ? 0 : x[to]));
  };
  const std::uint32_t still = same(body.x()) | same(body.y()) << 1 | same(body.z()) << 2;
  std::uint32_t mask = 0;
  for (int i = 0; i < 3; ++i) {
    if (((rotation >> (3 * i) | still) & 7u) == 7u) mask |= 1u << i;
  }
  return mask;
}

/// Whether each of the six products of det(e, u, v) has a factor that is exactly zero.
inline bool vanishes_term_by_term(std::uint32_t e, std::uint32_t u, std::uint32_t v) {
  constexpr std::array<std::array<int, 3>, 6> kTerms{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  return std::all_of(kTerms.begin(), kTerms.end(),
                     [&](const std::array<int, 3>& t) { return ((e >> t[0] | u >> t[1] | v >> t[2]) & 1u) != 0; });
}

/// The same of the coordinates of a cross product.
inline bool cross_vanishes_term_by_term(std::uint32_t u, std::uint32_t v) {
  constexpr std::array<std::array<int, 2>, 6> kTerms{{{1, 2}, {2, 1}, {2, 0}, {0, 2}, {0, 1}, {1, 0}}};
  return std::all_of(kTerms.begin(), kTerms.end(),
                     [&](const std::array<int, 2>& t) { return ((u >> t[0] | v >> t[1]) & 1u) != 0; });
}

}  // namespace pd::detail
