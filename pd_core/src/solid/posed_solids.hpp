/// @file
/// Exact signs about the points of two posed solids.
///
/// Points are taken relative to A's origin, exactly, and are scaled by a power of two so that the largest coordinate is
/// about 1. Doubles with a bound of their errors decide first; where a body stands without rounding (an identity, or an
/// exchange of axes, and a translation that its vertices take exactly) the predicates on doubles follow, and else
/// dyadic numbers. A quaternion's rotation is homogeneous there: all points are multiplied by the same |q_A|^2 |q_B|^2
/// > 0.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "numeric/dyadic.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/shape/pose.hpp"
#include "shape/mesh/triangle_tree.hpp"

namespace pd::detail {

enum class Body : std::uint8_t { a, b };
[[nodiscard]] inline Body other(Body body) { return body == Body::a ? Body::b : Body::a; }

/// A vertex, or the mean of three vertices by whole weights that sum to 2^shift. Without vertices it is the point x,
/// which needs poses that turn nothing (identities).
struct PosedPoint {
  Vec3 x;              ///< each coordinate within the bound of the pair
  bool exact = false;  ///< x is the point itself
  Body body = Body::a;
  std::array<std::int32_t, 3> vertices{-1, -1, -1};
  std::array<std::int32_t, 3> weights{1, 0, 0};
  int shift = 0;
};

using PosedTriangle = std::array<PosedPoint, 3>;

class PosedSolids {
 public:
  /// Refers to the solids and poses: they must outlive it.
  /// @param way  A stands moved by it, exactly.
  PosedSolids(const MeshSolid& a, const Pose& pose_a, const MeshSolid& b, const Pose& pose_b,
              const Vec3& way = Vec3::Zero());

  [[nodiscard]] const MeshSolid& solid(Body body) const { return *placing(body).solid; }
  [[nodiscard]] const Pose& pose(Body body) const { return *placing(body).pose; }
  /// Lengths inside = lengths outside * 2^-scale_exponent.
  [[nodiscard]] int scale_exponent() const { return scale_exponent_; }
  [[nodiscard]] double inside(double length) const { return length * lift_ * scale_; }
  [[nodiscard]] Vec3 inside(const Vec3& own) const { return own * lift_ * scale_; }
  /// At most the error of a coordinate of a point in doubles.
  [[nodiscard]] double error() const { return error_; }

  [[nodiscard]] PosedPoint point(Body body, std::int32_t vertex) const;
  [[nodiscard]] PosedPoint mean(Body body, const std::array<std::int32_t, 3>& vertices,
                                const std::array<std::int32_t, 3>& weights, int shift) const;
  [[nodiscard]] PosedTriangle corners(Body body, std::int32_t triangle) const;
  /// The box of a node of the solid's tree, rounded outwards.
  [[nodiscard]] TriangleBox box(Body body, const TriangleNode& node) const;
  /// The point in the body's own coordinates (outside lengths). It is that of a point within error() of this one.
  [[nodiscard]] Vec3 in_own_frame(Body body, const Vec3& x) const;
  /// The point in the world, rounded.
  [[nodiscard]] Vec3 outside(const Vec3& x) const;

  /// Sign of <(q - p) x (r - p), s - p>.
  [[nodiscard]] int orient3d(const PosedPoint& p, const PosedPoint& q, const PosedPoint& r, const PosedPoint& s) const;
  [[nodiscard]] int orient3d(const PosedTriangle& t, const PosedPoint& s) const {
    return orient3d(t[0], t[1], t[2], s);
  }
  /// Sign of (q - p) x (r - p) in the shadow that drops an axis; the other two follow it cyclically.
  [[nodiscard]] int orient2d(int axis, const PosedPoint& p, const PosedPoint& q, const PosedPoint& r) const;
  /// Sign of p[k] - q[k].
  [[nodiscard]] int compare(int k, const PosedPoint& p, const PosedPoint& q) const;

  /// The way from p to q times a positive number, which is the same for all points.
  [[nodiscard]] Dyadic3 exact_way(const PosedPoint& p, const PosedPoint& q) const;

  /// Signs that doubles left open.
  [[nodiscard]] std::int64_t exact_signs() const { return exact_signs_; }

 private:
  struct Placing {
    const MeshSolid* solid;
    const Pose* pose;
    Mat3 rotation;
    Mat3 absolute;
    Vec3 offset;
    bool exact = false;  ///< rotation and offset hold without rounding
  };
  struct ExactPlacing {
    std::array<Dyadic, 9> rotation[2];  ///< numerators over the common denominator
    Dyadic3 offset_b;
  };
  [[nodiscard]] const Placing& placing(Body body) const { return body == Body::a ? a_ : b_; }
  [[nodiscard]] Dyadic3 exact(const PosedPoint& p) const;
  [[nodiscard]] Dyadic3 exact_vertex(Body body, std::int32_t vertex) const;

  Placing a_, b_;
  Vec3 way_;
  int scale_exponent_ = 0;
  double lift_ = 1, scale_ = 1;  ///< their product is 2^-scale_exponent, which no double holds for subnormal lengths
  double error_ = 0;
  mutable std::optional<ExactPlacing> exact_;
  mutable std::int64_t exact_signs_ = 0;
};

/// A pose of the same rotation with another translation.
[[nodiscard]] Pose placed_at(const Pose& pose, const Vec3& translation);

/// A pose's rotation as numerators, and their denominator: |q|^2 of a quaternion, else 1.
void rotation_numerators(const Pose& pose, std::array<Dyadic, 9>& rotation, Dyadic& denominator);

}  // namespace pd::detail
