/// @file
/// The exact backend of directional width queries.
///
/// Points: those outside a coarse kernel, in lists by the cone (apex: a point inside) over the facet of the kernel's
/// hull that they lie in. A point of a cone is sum lambda_k v_k, lambda >= 0, sum lambda at most the largest gauge g of
/// the list, so its height in u is at most g max_k <u, v_k>: only the lists around the hull's extreme vertex that can
/// hold more than the best so far are scanned. Any dimension; no hull of all points is built. Points inside the
/// kernel's hull are not extreme in any direction. Halfspaces: a linear program each.
#pragma once

#include <memory>

#include "dimension/backends/width_structure.hpp"

namespace pd::dimension::detail {

std::shared_ptr<const WidthStructure> exact_structure(const AnyBody& body);

}  // namespace pd::dimension::detail
