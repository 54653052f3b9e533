/// @file
/// Questions of `pdepth.h` asked and their answers written, for one pair as for the rows of a batch.
#pragma once

#include "c_interface/handles.hpp"
#include "c_interface/reading.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::c_interface {

[[nodiscard]] pdepth_answer answer_of(const PenetrationDepth& answer);
[[nodiscard]] pdepth_feature feature_of(const Feature& feature, std::int32_t part);
void write_vector(const Vec3& vector, double* out);

/// Refuses a method that does not answer for the two convex shapes.
void require_supported(const Question& question);

[[nodiscard]] pdepth_answer ask_depth(const Question& question, Workspace& space);
[[nodiscard]] pdepth_manifold ask_manifold(const Question& question, double breaking_threshold, Workspace& space);
/// @param answer  or nullptr.
[[nodiscard]] pdepth_derivatives ask_derivatives(const Question& question, Workspace& space, pdepth_answer* answer);

}  // namespace pd::c_interface
