/// @file
/// Questions of `pdepth.h` asked and their answers written, for one pair as for the rows of a batch.
#pragma once

#include "c_interface/handles.hpp"
#include "c_interface/reading.hpp"
#include "pd/contact/finite_answer.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::c_interface {

/// Refuses an answer that is not finite.
inline void require_finite(bool finite) {
  if (!finite) refuse(past_doubles("question"), "");
}
/// Everything but the size, which the caller has set; refuses an answer that is not finite.
void write_depth(const PenetrationDepth& answer, pdepth_answer& out);
[[nodiscard]] pdepth_feature feature_of(const Feature& feature, std::int32_t part);
inline void write_vector(const Vec3& vector, double* out) {
  for (int k = 0; k < 3; ++k) out[k] = vector[k];
}

/// Refuses a method that does not answer for the two convex shapes.
void require_supported(const Question& question);

/// Answers are written in place, since a copy of what was just written would wait for the stores.
void ask_depth(const Question& question, Workspace& space, pdepth_answer& out);
void ask_manifold(const Question& question, double breaking_threshold, Workspace& space, pdepth_manifold& out);
/// @param answer  or nullptr.
void ask_derivatives(const Question& question, Workspace& space, pdepth_derivatives& out, pdepth_answer* answer);

}  // namespace pd::c_interface
