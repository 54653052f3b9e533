/// @file
/// Tells pdepth.js where the fields of pdepth.h's structs lie in the memory of the WebAssembly module, so that the
/// script holds no number that a compiler knows better.
#include <cstddef>
#include <cstdint>

#include "pdepth/pdepth.h"

namespace {

struct Place {
  const char* name;     ///< "answer.depth"; "answer" for the size of the whole; nullptr at the end
  std::int32_t number;  ///< in bytes
};

#define WHOLE(type) \
  { #type, sizeof(pdepth_##type) }
#define FIELD(type, field) \
  { #type "." #field, offsetof(pdepth_##type, field) }

constexpr Place kPlaces[] = {
    // clang-format off
    WHOLE(error), FIELD(error, status), FIELD(error, message), FIELD(error, where),
    WHOLE(pose), FIELD(pose, form), FIELD(pose, numbers),
    WHOLE(faces), FIELD(faces, points), FIELD(faces, num_points), FIELD(faces, offsets), FIELD(faces, num_faces),
    FIELD(faces, vertices),
    WHOLE(part), FIELD(part, shape), FIELD(part, pose),
    WHOLE(shape_info), FIELD(shape_info, is_convex), FIELD(shape_info, parts), FIELD(shape_info, dimension),
    FIELD(shape_info, vertices), FIELD(shape_info, facets), FIELD(shape_info, margin),
    WHOLE(surface), FIELD(surface, points), FIELD(surface, offsets), FIELD(surface, corners),
    WHOLE(settings), FIELD(settings, method), FIELD(settings, bracket), FIELD(settings, use_beyond),
    FIELD(settings, beyond), FIELD(settings, delta), FIELD(settings, contact_tolerance), FIELD(settings, seed),
    FIELD(settings, max_points),
    WHOLE(question), FIELD(question, a), FIELD(question, b), FIELD(question, pose_a), FIELD(question, pose_b),
    FIELD(question, settings), FIELD(question, pair),
    WHOLE(feature), FIELD(feature, kind), FIELD(feature, part), FIELD(feature, first), FIELD(feature, second),
    WHOLE(answer), FIELD(answer, status), FIELD(answer, contact), FIELD(answer, method), FIELD(answer, warm),
    FIELD(answer, bracket_reached), FIELD(answer, depth), FIELD(answer, lower), FIELD(answer, upper),
    FIELD(answer, distance), FIELD(answer, distance_lower), FIELD(answer, distance_upper),
    FIELD(answer, translation), FIELD(answer, normal), FIELD(answer, witness_a), FIELD(answer, witness_b),
    FIELD(answer, feature_a), FIELD(answer, feature_b), FIELD(answer, support_calls), FIELD(answer, facets_visited),
    FIELD(answer, exact_signs),
    WHOLE(directional), FIELD(directional, contact), FIELD(directional, depth), FIELD(directional, lower),
    FIELD(directional, upper), FIELD(directional, normal), FIELD(directional, feature_a),
    FIELD(directional, feature_b),
    WHOLE(contact_point), FIELD(contact_point, position_a), FIELD(contact_point, position_b),
    FIELD(contact_point, depth), FIELD(contact_point, feature_id),
    WHOLE(manifold), FIELD(manifold, contact), FIELD(manifold, count), FIELD(manifold, normal),
    FIELD(manifold, points),
    WHOLE(motion), FIELD(motion, linear_velocity), FIELD(motion, angular_velocity), FIELD(motion, arm),
    WHOLE(movement), FIELD(movement, max_queries), FIELD(movement, a), FIELD(movement, b),
    FIELD(movement, duration), FIELD(movement, distance_tolerance), FIELD(movement, allowed_depth),
    WHOLE(impact), FIELD(impact, hit), FIELD(impact, reached), FIELD(impact, queries), FIELD(impact, time),
    FIELD(impact, certified),
    WHOLE(derivatives), FIELD(derivatives, unique_direction), FIELD(derivatives, unique_witness),
    FIELD(derivatives, stable_features), FIELD(derivatives, signed_depth), FIELD(derivatives, by_a),
    FIELD(derivatives, by_b),
    WHOLE(width_answer), FIELD(width_answer, bracket_reached), FIELD(width_answer, width),
    FIELD(width_answer, lower), FIELD(width_answer, upper), FIELD(width_answer, normal),
    WHOLE(support_answer), FIELD(support_answer, part), FIELD(support_answer, vertex), FIELD(support_answer, value),
    FIELD(support_answer, point),
    WHOLE(pose_array), FIELD(pose_array, form), FIELD(pose_array, numbers), FIELD(pose_array, stride),
    WHOLE(batch), FIELD(batch, threads), FIELD(batch, count), FIELD(batch, a), FIELD(batch, stride_a),
    FIELD(batch, b), FIELD(batch, stride_b), FIELD(batch, poses_a), FIELD(batch, poses_b), FIELD(batch, settings),
    FIELD(batch, pairs), FIELD(batch, stride_pairs),
    {nullptr, 0},
    // clang-format on
};

}  // namespace

/// The table, for the script that the package wraps around the module.
extern "C" const void* pdepth_web_layout() { return kPlaces; }
