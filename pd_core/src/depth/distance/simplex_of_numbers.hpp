/// @file
/// A simplex of the search for a closest point (closest_search.hpp): one text for double-double and for exact numbers.
/// Nothing is divided, so that exact numbers stay exact.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"

namespace pd::detail {

/// The operations that the text needs of a kind of numbers.
template <class Number>
struct SimplexNumber;
template <>
struct SimplexNumber<DoubleDouble> {
  using Vector = Vec3DD;
  static bool is_positive(const DoubleDouble& x) { return to_double(x) > 0; }
  /// True if a / b < c / d, for positive b and d.
  static bool is_less(const DoubleDouble& a, const DoubleDouble& b, const DoubleDouble& c, const DoubleDouble& d) {
    const DoubleDouble x = a / b, y = c / d;
    return x.hi < y.hi || (x.hi == y.hi && x.lo < y.lo);
  }
};
template <>
struct SimplexNumber<Dyadic> {
  using Vector = Dyadic3;
  static bool is_positive(const Dyadic& x) { return x.sign() > 0; }
  static bool is_less(const Dyadic& a, const Dyadic& b, const Dyadic& c, const Dyadic& d) { return a * d < c * b; }
};
inline Dyadic3 scaled(const Dyadic3& v, const Dyadic& s) { return v * s; }

/// A face of the simplex, and the point nearest to the origin in its relative interior.
template <class Number>
struct NearestOfFace {
  typename SimplexNumber<Number>::Vector point;  ///< times `scale`
  Number squared{};                              ///< of the point's length, times `scale`
  Number scale{};                                ///< positive; the sum of the weights
  std::array<Number, 4> weights{};               ///< positive
  std::array<int, 4> members{};                  ///< ascending
  int count = 0;
};

/// A simplex of up to four corners, and its point nearest to the origin.
/// @tparam Vertex  whatever the caller knows a corner by
template <class Number, class Vertex>
class SimplexOfNumbers {
 public:
  using Vector = typename SimplexNumber<Number>::Vector;
  using Face = NearestOfFace<Number>;
  struct Corner {
    Vertex vertex{};
    Vector x{};
  };

  explicit SimplexOfNumbers(Corner first) {
    corners_[0] = std::move(first);
    nearest_ = *nearest_in({0}, 1);
  }

  [[nodiscard]] const Face& nearest() const { return nearest_; }
  [[nodiscard]] const Corner& corner(int i) const { return corners_[static_cast<std::size_t>(i)]; }

  /// Takes these corners, if the nearest point lies in the relative interior of them all; else one after the other.
  void take(std::span<const Corner> corners) {
    std::copy(corners.begin(), corners.end(), corners_.begin());
    if (std::optional<Face> whole = nearest_in({0, 1, 2, 3}, static_cast<int>(corners.size()))) {
      nearest_ = *std::move(whole);
      return;
    }
    nearest_ = *nearest_in({0}, 1);
    for (const Corner& corner : corners.subspan(1)) {
      if (nearest_.count < 4) add(corner);
    }
  }

  /// Adds a corner and keeps the face nearest to the origin. False if no face with the new corner is nearer.
  bool add(Corner s) {
    const int count = nearest_.count;
    corners_[static_cast<std::size_t>(count)] = std::move(s);
    std::optional<Face> best;
    // Small faces first, as bits of the old corners that stay.
    for (const unsigned with : {0U, 1U, 2U, 4U, 3U, 5U, 6U, 7U}) {
      if (with >> count != 0) continue;
      std::array<int, 4> members{};
      int size = 0;
      for (int i = 0; i < count; ++i) {
        if ((with >> i & 1U) != 0) members[static_cast<std::size_t>(size++)] = i;
      }
      members[static_cast<std::size_t>(size++)] = count;
      std::optional<Face> face = nearest_in(members, size);
      if (face && is_nearer(*face, best ? *best : nearest_)) best = std::move(face);
    }
    if (!best) return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(best->count); ++i) {
      const auto from = static_cast<std::size_t>(best->members[i]);
      if (i != from) corners_[i] = std::move(corners_[from]);
      best->members[i] = static_cast<int>(i);
    }
    nearest_ = *std::move(best);
    return true;
  }

 private:
  static bool is_nearer(const Face& x, const Face& y) {
    return SimplexNumber<Number>::is_less(x.squared, x.scale, y.squared, y.scale);
  }

  /// Nothing if the nearest point of the affine hull of these corners lies elsewhere, or they are dependent.
  [[nodiscard]] std::optional<Face> nearest_in(const std::array<int, 4>& members, int count) const {
    const auto x = [&](std::size_t i) -> const Vector& { return corner(members[i]).x; };
    const auto positive = [](const Number& number) { return SimplexNumber<Number>::is_positive(number); };
    Face face;
    face.members = members;
    face.count = count;
    auto& weights = face.weights;
    switch (count) {
      case 1:
        weights[0] = face.scale = Number{1.0};
        face.point = x(0);
        face.squared = dot(x(0), x(0));
        return face;
      case 2: {
        const Vector e = x(1) - x(0);
        weights[0] = dot(x(1), e);
        weights[1] = -dot(x(0), e);
        if (!positive(weights[0]) || !positive(weights[1])) return std::nullopt;
        // Across the edge whatever rounding did to the weights.
        const Vector across = cross(x(0), e);
        face.scale = dot(e, e);
        face.point = cross(e, across);
        face.squared = dot(across, across);
        break;
      }
      case 3: {
        const Vector n = cross(x(1) - x(0), x(2) - x(0));
        for (std::size_t i = 0; i < 3; ++i) {
          weights[i] = dot(n, cross(x((i + 1) % 3), x((i + 2) % 3)));
          if (!positive(weights[i])) return std::nullopt;
        }
        const Number level = dot(n, x(0));
        face.scale = dot(n, n);
        face.point = scaled(n, level);
        face.squared = level * level;
        break;
      }
      default: {
        // The volumes that the origin spans with the faces are of one sign.
        weights = {dot(x(1), cross(x(2), x(3))), -dot(x(0), cross(x(2), x(3))), dot(x(0), cross(x(1), x(3))),
                   -dot(x(0), cross(x(1), x(2)))};
        if (!positive(weights[0])) {
          for (Number& weight : weights) weight = -weight;
        }
        for (const Number& weight : weights) {
          if (!positive(weight)) return std::nullopt;
          face.scale = face.scale + weight;
        }
        face.point = Vector{};
      }
    }
    return positive(face.scale) ? std::optional(std::move(face)) : std::nullopt;
  }

  std::array<Corner, 4> corners_{};
  Face nearest_;
};

}  // namespace pd::detail
