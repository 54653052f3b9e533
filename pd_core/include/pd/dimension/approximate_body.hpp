/// @file
/// Small approximations of a body in either representation ([M] Lemma 16).
///
/// Outer: K is in K', and h_{K'}(v) <= h_K(v) + (epsilon / 2) width_v(K) for all v, so K' is in K_epsilon. Inner: K' is
/// in K, and every directional width of K' is at least 1 - epsilon times that of K.
///
/// | body | wanted | what is returned |
/// |---|---|---|
/// | points | points | an epsilon-kernel's vertices; outer: blown up about a point inside |
/// | points | halfspaces | the facets of the kernel's hull, coplanar ones once; outer: moved out |
/// | halfspaces | halfspaces | those of the body whose polar points form a kernel of the polar body; inner: moved in |
/// | halfspaces | points | the vertices of their intersection; inner: drawn in |
///
/// [M] samples the boundary by nearest points to a net (Dudley; Bronshteyn and Ivanov); departure: kernels by a growing
/// hull
/// (`epsilon_kernel.hpp`), of the polar body for halfspaces. Sizes are O(1 / epsilon^((d-1)/2)) as measured; the number
/// of facets of a hull of k points is at most about {1, 2, 7, 32} k on the families tried, d = 2..5. So the
/// approximation needs no budget beside that of a kernel.
#pragma once

#include <vector>

#include "pd/dimension/body.hpp"
#include "pd/numeric/expected.hpp"

namespace pd::dimension {

enum class Side { inner, outer };

template <int D>
struct ApproximateBody {
  Representation representation = Representation::points;
  std::vector<Vector<D>> points;
  std::vector<Halfspace<D>> halfspaces;  ///< outward normals of the body
};

/// @param epsilon  in [1e-6, 1). @return ErrorCode::bad_value ("epsilon").
template <int D>
[[nodiscard]] Expected<ApproximateBody<D>> approximate_body(const Body<D>& body, double epsilon,
                                                            Representation representation, Side side = Side::outer);

}  // namespace pd::dimension
