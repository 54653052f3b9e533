/// @file
/// The two linear-algebra types that cross every door of the library.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // the cross product

#include "pd/numeric/language.hpp"

namespace pd {

/// A point or direction in R^3. Neither type is a "fixed-size vectorizable" Eigen type (24 and 72 bytes), so their size
/// and alignment do not depend on the instruction set a translation unit is compiled for.
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace pd
