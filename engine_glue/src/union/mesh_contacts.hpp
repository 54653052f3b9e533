/// @file
/// The contacts of a convex body, or of the convex children of a compound, with the triangles of a mesh or heightfield.
#pragma once

#include <memory>

#include "union/union_algorithm.hpp"

namespace pd::detail {

/// Bullet's own algorithm hands one manifold of four to every triangle in turn, so that what it keeps hangs on their
/// order, and (3.24) asks no triangle before the body is within the breaking threshold of it less its margin, which
/// lets bodies sink through most of a mesh's margin. Here all triangles are asked that come within the threshold of the
/// body's box, margin included.
[[nodiscard]] std::unique_ptr<UnionContacts> mesh_contacts();

/// Whether meshes of this Bullet type are taken: those that are triangles and nothing else.
[[nodiscard]] bool takes_mesh(int proxy_type);

}  // namespace pd::detail
