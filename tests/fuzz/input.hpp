/// @file
/// Bytes of a fuzzer as bodies: a small grammar, so that every input means two posed bodies and mutations stay near.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/shape/convex_shape.hpp"
#include "pd/shape/pose.hpp"

namespace pd::fuzz {

/// Reads bytes from the front; zeros behind the end.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return next_ >= bytes_.size(); }
  std::uint8_t byte() { return empty() ? 0 : bytes_[next_++]; }
  int choice(int count) { return byte() % count; }

  /// A coordinate: mostly a small whole number or fraction, which tie; else one of a dictionary of hard numbers, or any
  /// bits of ordinary size.
  double number() {
    const int kind = choice(16);
    const double whole = static_cast<double>(static_cast<std::int8_t>(byte()));
    if (kind < 8) return std::fmod(whole, 8);
    if (kind < 11) return whole / 16;
    if (kind < 13) {
      constexpr double kHard[] = {0x1p-1074, 1e-318,      0x1p-1022,   1e-310, 1e-300, 1e-160, 1e-100, 1e-30,
                                  1e-16,     1 + 0x1p-52, 1 - 0x1p-53, 1e16,   1e100,  1e160,  1e299,  1e300};
      const double hard = kHard[byte() % std::size(kHard)];
      return whole < 0 ? -hard : hard;
    }
    if (kind < 15) return whole / 16 + std::ldexp(static_cast<double>(static_cast<std::int8_t>(byte())), -50);
    double fraction = 0;
    for (int i = 0; i < 6; ++i) fraction = fraction / 256 + byte();
    return std::ldexp(whole * (1 + fraction / 256), -6);
  }
  double size() { return std::abs(number()); }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t next_ = 0;
};

/// Some convex shape, or a refusal of the factory: that is an answer, too.
inline Expected<ConvexShape> read_shape(Input& input) {
  const std::uint8_t drawn = input.byte();
  const int kind = drawn < 250 ? drawn % 10 : 10;
  const int margin_kind = input.choice(4);
  Expected<ConvexShape> shape = [&]() -> Expected<ConvexShape> {
    switch (kind) {
      case 0:
        return ConvexShape::ellipsoid({input.size(), input.size(), input.size()});
      case 1:
      case 2:
      case 3: {
        // One by one: the order in which a call's arguments are read is the compiler's choice.
        const int axis = input.choice(3);
        const double second = input.size();
        const double first = input.size();
        if (kind == 1) return ConvexShape::cylinder(first, second, axis);
        if (kind == 2) return ConvexShape::cone(first, second, axis);
        return ConvexShape::capsule(first, second, axis);
      }
      case 4:
      case 5: {
        auto box = ConvexPolytope::box({input.size(), input.size(), input.size()});
        if (!box) return box.error();
        return ConvexShape(*std::move(box));
      }
      case 10: {
        std::vector<Sphere> spheres;
        for (int i = 1 + input.choice(5); i > 0; --i) {
          const Vec3 centre = input.vector();
          spheres.push_back({centre, input.size()});
        }
        return ConvexShape::hull_of_spheres(spheres);
      }
      default: {
        std::vector<Vec3> points;
        for (int i = 1 + input.choice(12); i > 0; --i) points.push_back(input.vector());
        auto hull = ConvexPolytope::from_points(points);
        if (!hull) return hull.error();
        return ConvexShape(*std::move(hull));
      }
    }
  }();
  if (!shape || margin_kind != 0) return shape;
  return shape->with_margin(input.size());
}

inline Expected<Pose> read_pose(Input& input) {
  const int kind = input.choice(4);
  const Vec3 translation = input.vector();
  if (kind < 2) return Pose::from_matrix(Mat3::Identity(), translation);
  if (kind == 2) return Pose::from_quaternion({0.5, 0.5, input.choice(2) == 0 ? 0.5 : -0.5, 0.5}, translation);
  const double q[4] = {1.0 + input.choice(8), static_cast<double>(input.choice(8)),
                       static_cast<double>(input.choice(8)), static_cast<double>(input.choice(8))};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return Pose::from_quaternion({q[0] / length, q[1] / length, q[2] / length, q[3] / length}, translation);
}

/// Ends the program with the words and where they stand: the fuzzer keeps the input.
[[noreturn]] void fail(const char* law, const char* file, int line);

}  // namespace pd::fuzz

#define PD_LAW(condition)                                               \
  do {                                                                  \
    if (!(condition)) ::pd::fuzz::fail(#condition, __FILE__, __LINE__); \
  } while (false)
