/// @file
/// Poses as Python gives them: a Pose, a 4x4 matrix, (R, t), or None for the identity.
#pragma once

#include <string_view>

#include "pd/shape/pose.hpp"
#include "python/arrays.hpp"

namespace pd::python {

/// The pose of 16 numbers, row by row; the last row must be 0, 0, 0, 1.
/// @return as Pose::from_matrix, and bad_value for another last row.
[[nodiscard]] Expected<Pose> pose_of_matrix(const double* numbers);

/// @throws Refused with the argument's name.
[[nodiscard]] Pose read_pose(py::handle value, std::string_view argument);

/// Declares `Pose`.
void bind_pose(py::module_& module);

}  // namespace pd::python
