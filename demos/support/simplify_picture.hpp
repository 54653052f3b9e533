/// @file
/// The picture of `pdepth simplify`: the scan's points beside the hull that stands for them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::demo {

/// @return an exit code; what went wrong is said on stderr.
int write_simplify_picture(const std::vector<Vec3>& scan, const ConvexPolytope& hull, const std::string& side,
                           double epsilon, const std::filesystem::path& file);

}  // namespace pd::demo
