#include "shape/common_frame.hpp"

namespace pd::detail {

namespace {

using Quaternion = std::array<double, 4>;

bool same_or_opposite(const Quaternion& p, const Quaternion& q) {
  return p == q || p == Quaternion{-q[0], -q[1], -q[2], -q[3]};
}

/// R(q i) = R(q) diag(1, -1, -1), and so on.
std::optional<AxisExchange> by_half_turns(const Quaternion& a, const Quaternion& b) {
  const auto [w, x, y, z] = a;
  const AxisExchange none;
  if (same_or_opposite(b, a)) return none;
  if (same_or_opposite(b, {-x, w, z, -y})) return AxisExchange{none.axis, {1, -1, -1}};
  if (same_or_opposite(b, {-y, -z, w, x})) return AxisExchange{none.axis, {-1, 1, -1}};
  if (same_or_opposite(b, {-z, y, -x, w})) return AxisExchange{none.axis, {-1, -1, 1}};
  return std::nullopt;
}

std::optional<AxisExchange> by_columns(const Mat3& a, const Mat3& b) {
  AxisExchange out;
  std::array<bool, 3> taken{};
  for (int j = 0; j < 3; ++j) {
    int found = -1;
    for (int p = 0; p < 3 && found < 0; ++p) {
      const auto k = static_cast<std::size_t>(p);
      const bool same = a.col(p) == b.col(j);
      if (taken[k] || !(same || a.col(p) == -b.col(j))) continue;
      out.axis[k] = static_cast<std::int8_t>(j);
      out.sign[k] = same ? 1 : -1;
      taken[k] = true;
      found = p;
    }
    if (found < 0) return std::nullopt;
  }
  return out;
}

}  // namespace

std::optional<AxisExchange> relative_exchange(const Pose& a, const Pose& b) {
  if (a.is_quaternion() != b.is_quaternion()) return std::nullopt;
  return a.is_quaternion() ? by_half_turns(a.quaternion_wxyz(), b.quaternion_wxyz())
                           : by_columns(a.rotation(), b.rotation());
}

}  // namespace pd::detail
