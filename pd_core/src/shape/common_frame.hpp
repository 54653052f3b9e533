/// @file
/// Two bodies that are turned alike, but for axes that are exchanged or reversed: R_B = R_A Q on the stored numbers, Q
/// a signed permutation. What is built along common axes and turned as a whole is of this kind (crates, bricks, parts
/// of one assembly), and signs of products of vectors without a translation are those in A's frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pd/shape/pose.hpp"

namespace pd::detail {

/// Q: coordinate k of Q v is sign[k] times coordinate axis[k] of v.
struct AxisExchange {
  std::array<std::int8_t, 3> axis{0, 1, 2};
  std::array<double, 3> sign{1, 1, 1};

  [[nodiscard]] bool is_identity() const {
    return axis == std::array<std::int8_t, 3>{0, 1, 2} && sign == std::array<double, 3>{1, 1, 1};
  }
  [[nodiscard]] Vec3 of(const Vec3& v) const {
    return {sign[0] * v[axis[0]], sign[1] * v[axis[1]], sign[2] * v[axis[2]]};
  }
  /// Row by row.
  [[nodiscard]] std::array<double, 9> matrix() const {
    std::array<double, 9> out{};
    for (std::size_t k = 0; k < 3; ++k) out[3 * k + static_cast<std::size_t>(axis[k])] = sign[k];
    return out;
  }
};

/// Q, where there is one. Two quaternions: those that differ by half turns about the axes, the others being no exact
/// multiples; two matrices: by their columns.
[[nodiscard]] std::optional<AxisExchange> relative_exchange(const Pose& a, const Pose& b);

}  // namespace pd::detail
