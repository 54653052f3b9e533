/// @file
/// A Bullet transform as rows and columns of four lanes: points of a manifold go back and forth several times a step,
/// and a product with columns costs a third of three products with rows. Sums are taken in Bullet's order, so that
/// results are the bits of `btTransform`. The fourth lane means nothing.
#pragma once

#include <LinearMath/btTransform.h>

namespace pd::detail {

typedef btScalar Lanes __attribute__((vector_size(4 * sizeof(btScalar))));

// By reference: lanes of double precision have no agreed way to be passed by value without AVX.

inline void load_lanes(const btVector3& v, Lanes& out) { __builtin_memcpy(&out, v.m_floats, sizeof(Lanes)); }
inline btVector3 from_lanes(const Lanes& v) { return {v[0], v[1], v[2]}; }
inline btScalar dot(const Lanes& x, const Lanes& y) {
  const Lanes product = x * y;
  return product[0] + product[1] + product[2];
}

class LaneTransform {
 public:
  explicit LaneTransform(const btTransform& transform) {
    for (int i = 0; i < 3; ++i) load_lanes(transform.getBasis()[i], rows_[i]);
    for (int k = 0; k < 3; ++k) columns_[k] = Lanes{rows_[0][k], rows_[1][k], rows_[2][k], 0};
    load_lanes(transform.getOrigin(), origin_);
  }

  /// transform(v)
  void apply(const btVector3& v, Lanes& out) const {
    out = columns_[0] * v.x() + columns_[1] * v.y() + columns_[2] * v.z() + origin_;
  }
  /// transform.invXform(v)
  void apply_inverse(const Lanes& v, Lanes& out) const {
    const Lanes from_origin = v - origin_;
    turn_back(from_origin, out);
  }
  /// v * transform.getBasis()
  void turn_back(const Lanes& v, Lanes& out) const { out = rows_[0] * v[0] + rows_[1] * v[1] + rows_[2] * v[2]; }

 private:
  Lanes rows_[3];
  Lanes columns_[3];
  Lanes origin_;
};

/// Both bodies of a manifold.
struct ManifoldPoses {
  LaneTransform a;
  LaneTransform b;
};

}  // namespace pd::detail
