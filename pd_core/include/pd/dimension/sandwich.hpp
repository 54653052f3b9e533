/// @file
/// Sandwiching ellipsoids and boxes: the constant amount of information about a body from which it, its affine images
/// and its Minkowski sums with other bodies are fattened ([M] section 2.1, Lemmas 6 to 10).
///
/// C is a lambda-sandwiching body for K when C is centrally symmetric about a point c and C is in K is in the
/// lambda-expansion of C about c. K is gamma-fat when there are concentric balls B in K in B' with radius(B) >= gamma
/// radius(B').
#pragma once

#include <span>

#include "pd/dimension/affine_map.hpp"

namespace pd::dimension {

/// The ellipsoid C = {centre + axes u : |u| <= 1} with C in K in centre + ratio (C - centre). Lemma 6 promises ratio d
/// for the John ellipsoid; the ones here hold d (1 + eta), certified.
template <int D>
struct Sandwich {
  Vector<D> centre = Vector<D>::Zero(kInitialSize<D>);
  Matrix<D> axes = Matrix<D>::Identity(kInitialSize<D>, kInitialSize<D>);
  double ratio = 1;

  /// Maps C to the unit ball about O, so that the image of K is (1 / ratio)-fat.
  [[nodiscard]] AffineMap<D> fattening() const {
    const Matrix<D> back = inverse_of<D>(axes);
    return {back, -(back * centre)};
  }
};

/// The box {centre + axes u : |u_k| <= 1}, a ratio-sandwiching body; its columns are the half axes, orthogonal as long
/// as the body has not been mapped.
template <int D>
struct SandwichBox {
  Vector<D> centre = Vector<D>::Zero(kInitialSize<D>);
  Matrix<D> axes = Matrix<D>::Identity(kInitialSize<D>, kInitialSize<D>);
  double ratio = 1;

  /// The sandwich of the body's image.
  [[nodiscard]] SandwichBox mapped(const AffineMap<D>& map) const {
    return {map.apply(centre), map.linear * axes, ratio};
  }
};

/// Lemma 7: the box along the ellipsoid's principal axes, with half axes 1 / sqrt(d) of the ellipsoid's. It lies in the
/// ellipsoid, and its sqrt(d)-expansion holds the ellipsoid: ratio * sqrt(d), d^(3/2) (1 + eta) in all.
template <int D>
[[nodiscard]] SandwichBox<D> sandwich_box(const Sandwich<D>& ellipsoid);

/// A fattening map of a body of which boxes are stored, and what it promises.
template <int D>
struct FatteningMap {
  AffineMap<D> map;
  /// The image lies in the ball of this radius about O and holds the unit ball about O.
  double outer_radius = 1;
};

/// Lemmas 8, 9, 10: a map that fattens the Minkowski sum of bodies (or of their affine images) from their boxes
/// alone, in O(1) for constantly many boxes. One body is the case of Lemma 9.
///
/// The sum of the boxes is a zonotope, h_Z(v) = sum |<g_i, v>| over all half axes g_i. The Lewis weights are
/// w_i = sqrt(g_i^T M^-1 g_i) with M = sum g_i g_i^T / w_i; they sum to d. Cauchy and Schwarz then give
/// |v|_M <= h_Z(v) <= sqrt(d) |v|_M. This is a sqrt(d)-sandwiching ellipsoid for any number of boxes, and with it the
/// gamma = 1 / (lambda sqrt(d)) of Lemma 9 (1 / d^2 for lambda = d^(3/2)). The weights are a fixed point to which
/// iteration converges by a factor 2 a step; `outer_radius` is certified from those reached, within 1e-9.
/// Requires at least one box. lambda is the largest ratio of the boxes.
template <int D>
[[nodiscard]] FatteningMap<D> fatten_sum(std::span<const SandwichBox<D>> boxes);

}  // namespace pd::dimension
