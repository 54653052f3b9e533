/// @file
/// One layer of the Macbeath hierarchy: regions whose shadows cover all directions, and a tree of cells that proves it.
#pragma once

#include <algorithm>
#include <cmath>

#include "dimension/backends/macbeath_region.hpp"

namespace pd::dimension::detail {

/// Scales of a region's ellipsoid: a new region enters outside all core shadows; cover shadows hold cells and queries.
/// A cell about a core direction shrinks into the cover shadow, so subdivision ends. The nearer the two, the more cells
/// and the fewer nodes: cores of half the cover's scale make 2.2 times as many in R^4, 2.6 times in R^5.
inline constexpr double kCoreScale = 0.8;
inline constexpr double kCoverScale = 0.9;
/// The same of a leaf's region, which has its size already.
inline constexpr double kLeafCoreScale = 0.9;
inline constexpr double kLeafCoverScale = 1;

/// A box on a face of the cube [-1, 1]^D: v[axis] = sign, the other coordinates in low .. low + side.
struct DirectionBox {
  int axis;
  double sign;
  AnyVector low;  ///< low[axis] = sign
  double side;

  [[nodiscard]] int dimension() const { return static_cast<int>(low.size()); }
  [[nodiscard]] int corners() const { return 1 << (dimension() - 1); }
  [[nodiscard]] AnyVector corner(int k) const {
    AnyVector r(low.size());
    for (int i = 0, bit = 0; i < dimension(); ++i) r[i] = low[i] + (i != axis && ((k >> bit++) & 1) != 0 ? side : 0);
    return r;
  }
  [[nodiscard]] AnyVector middle() const {
    AnyVector r(low.size());
    for (int i = 0; i < dimension(); ++i) r[i] = low[i] + (i == axis ? 0 : 0.5 * side);
    return r;
  }
  [[nodiscard]] DirectionBox child(int k) const {
    DirectionBox r = *this;
    r.side = 0.5 * side;
    for (int i = 0, bit = 0; i < dimension(); ++i) {
      if (i == axis) continue;
      if ((k >> bit++) & 1) r.low[i] += r.side;
    }
    return r;
  }
};

inline DirectionBox cube_face(int dimension, int face) {
  DirectionBox r{face / 2, face % 2 != 0 ? 1.0 : -1.0, AnyVector::Constant(dimension, -1), 2};
  r.low[r.axis] = r.sign;
  return r;
}

inline bool covers(const ShadowCone& cone, const DirectionBox& box) {
  for (int k = 0; k < box.corners(); ++k) {
    if (!cone.contains(box.corner(k))) return false;  // the cone is convex: corners decide
  }
  return true;
}

/// Whether a direction of the box lies in the cone, which is not everything; beyond rounding, false only where none
/// does. The cone is {v : g(v) <= 0}, g(v) = sqrt(v' square v) - <axis, v>, and g convex: it is descended coordinate by
/// coordinate from the box's middle until it is negative, or until its tangent plane is positive all over the box.
inline bool meets(const ShadowCone& cone, const DirectionBox& box) {
  AnyMatrix square = -cone.form;
  add_outer(square, 1, cone.axis);
  AnyVector v = box.middle();
  AnyVector image = square * v;
  constexpr int kSweeps = 8;
  for (int sweep = 0; sweep <= kSweeps; ++sweep) {
    const double root = std::sqrt(std::max(v.dot(image), 0.0));
    double tangent = root - cone.axis.dot(v);
    if (!(tangent > 0)) return true;
    for (int i = 0; i < box.dimension(); ++i) {
      if (i == box.axis) continue;
      const double slope = image[i] / root - cone.axis[i];
      tangent += slope * ((slope > 0 ? box.low[i] : box.low[i] + box.side) - v[i]);
    }
    constexpr double kSlack = 1e-9;
    if (tangent > kSlack * root) return false;
    for (int i = 0; i < box.dimension(); ++i) {
      if (i == box.axis) continue;
      // Along the coordinate g is sqrt(a u^2 + rest) - l u and a constant, u measured from the root's least place.
      const double a = square(i, i), l = cone.axis[i];
      const double rest = std::max(v.dot(image) - image[i] * image[i] / a, 0.0);
      double to = l > 0 ? box.low[i] + box.side : box.low[i];
      if (a > l * l) {
        to = std::clamp(v[i] - image[i] / a + l * std::sqrt(rest / (a * (a - l * l))), box.low[i],
                        box.low[i] + box.side);
      }
      image += square.col(i) * (to - v[i]);
      v[i] = to;
    }
  }
  return true;
}

/// The cone's section with the plane of a face of the cube: in its coordinates y an ellipse
/// (y - center)' form (y - center) <= 1, or nothing, or something unbounded.
class ShadowSection {
 public:
  ShadowSection(const ShadowCone& cone, const DirectionBox& face) : cone_(cone) {
    if (cone.everything) return;
    // v' form v over v = (y, sign) is f + 2 <q, y> - y' P y.
    const int d = face.dimension();
    AnyMatrix p(d - 1, d - 1);
    AnyVector q(d - 1);
    for (int i = 0, row = 0; i < d; ++i) {
      if (i == face.axis) continue;
      q[row] = face.sign * cone.form(i, face.axis);
      for (int j = 0, column = 0; j < d; ++j) {
        if (j != face.axis) p(row, column++) = -cone.form(i, j);
      }
      ++row;
    }
    AnyMatrix lower = p;  // Cholesky, as the test of definiteness, too
    for (int k = 0; k < d - 1; ++k) {
      for (int i = k; i < d - 1; ++i) {
        for (int j = 0; j < k; ++j) lower(i, k) -= lower(i, j) * lower(k, j);
        if (i == k && !(lower(k, k) > 1e-9 * p(k, k))) return;  // unbounded, or too flat to be sure
        lower(i, k) = i == k ? std::sqrt(lower(k, k)) : lower(i, k) / lower(k, k);
      }
    }
    const auto solve = [&](AnyVector x) {
      for (int i = 0; i < d - 1; ++i) {
        for (int k = 0; k < i; ++k) x[i] -= lower(i, k) * x[k];
        x[i] /= lower(i, i);
      }
      for (int i = d - 2; i >= 0; --i) {
        for (int k = i + 1; k < d - 1; ++k) x[i] -= lower(k, i) * x[k];
        x[i] /= lower(i, i);
      }
      return x;
    };
    center_ = solve(q);
    const double constant = cone.form(face.axis, face.axis);
    const double height = constant + q.dot(center_);
    AnyVector along = face.low;
    for (int i = 0, row = 0; i < d; ++i) {
      if (i != face.axis) along[i] = center_[row++];
    }
    if (height < -1e-9 * (std::abs(constant) + std::abs(q.dot(center_))) || !(cone.axis.dot(along) > 0)) {
      kind_ = Kind::empty;
      return;
    }
    kind_ = Kind::ellipse;
    const double scale = std::max(height, 1e-9 * std::abs(constant)) * (1 + 1e-9);  // rounding errs on the larger side
    form_ = p / scale;
    extent_.resize(d - 1);
    for (int i = 0; i < d - 1; ++i) {
      extent_[i] = std::sqrt(solve(AnyVector::Unit(d - 1, i))[i] * scale);
      width_ += std::sqrt(form_(i, i));
    }
  }

  /// Whether a direction of the box, on this face, is in the cone; beyond rounding, false only where none is. Bounds
  /// come first: alone they let 10 times more children through in R^4 than meet a parent, the more the finer the layer.
  [[nodiscard]] bool meets(const DirectionBox& box) const {
    return cone_.everything || (may_meet(box) && detail::meets(cone_, box));
  }

 private:
  [[nodiscard]] bool may_meet(const DirectionBox& box) const {
    if (kind_ == Kind::empty) return false;
    if (kind_ == Kind::unbounded) return in_ball(box);
    const double half = 0.5 * box.side;
    const int d = box.dimension();
    AnyVector away(d - 1);
    for (int i = 0, row = 0; i < d; ++i) {
      if (i == box.axis) continue;
      away[row] = box.low[i] + half - center_[row];
      if (std::abs(away[row]) > half + extent_[row]) return false;
      ++row;
    }
    return std::sqrt(away.dot(form_ * away)) <= 1 + half * width_;
  }

  /// Bounds over the ball about the box's middle: (m + r)' form (m + r) <= m' form m + 2 |r| |form m| + |r|^2 |axis|^2.
  [[nodiscard]] bool in_ball(const DirectionBox& box) const {
    const AnyVector middle = box.middle();
    const double radius = 0.5 * box.side * std::sqrt(static_cast<double>(box.dimension() - 1));
    if (cone_.axis.dot(middle) + radius * cone_.axis.norm() <= 0) return false;
    const AnyVector image = cone_.form * middle;
    return middle.dot(image) + 2 * radius * image.norm() + radius * radius * cone_.axis.squaredNorm() >= 0;
  }

  ShadowCone cone_;
  enum class Kind { unbounded, empty, ellipse } kind_ = Kind::unbounded;
  AnyVector center_, extent_;
  AnyMatrix form_;
  double width_ = 0;  ///< of the box [-1, 1]^(D-1) in the ellipse's norm, at most
};

}  // namespace pd::dimension::detail
