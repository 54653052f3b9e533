/// @file
/// The two posed bodies of a query, and the answer that `depth` and `distance` share.
#pragma once

#include <chrono>

#include "pd/contact/manifold.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "protocol/handlers.hpp"

namespace pd::query {

/// Two bodies where they stand. Holds what the posed shapes refer to: neither copied nor moved.
struct Pair {
  NamedShape a;
  NamedShape b;
  Pose pose_a;
  Pose pose_b;

  [[nodiscard]] PosedShape posed_a() const { return {&a.shape, pose_a}; }
  [[nodiscard]] PosedShape posed_b() const { return {&b.shape, pose_b}; }
};

/// Reads "a", "b" and their poses.
[[nodiscard]] Pair read_pair(const Node& line, const Limits& limits);
/// Reads the pose named `key`, the identity where it is missing.
[[nodiscard]] Pose read_optional_pose(const Node& line, std::string_view key);

/// "method" of depth and width: one of the protocol's words, else bad_value; "metric" without the field of that name is
/// missing_field.
[[nodiscard]] Method read_method(const Node& node);
/// "delta", in (0, 1].
[[nodiscard]] double read_delta(const Node& node);

/// "max_points", the budget of the depth of two solids; that of `SolidSettings` if it is not given. Other bodies need
/// none: the number is read for them, so that one form of line serves all bodies.
[[nodiscard]] std::int64_t read_max_points(const Node& line);

/// Measures the time of a query.
class Stopwatch {
 public:
  [[nodiscard]] std::int64_t nanoseconds() const {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The fields of a depth answer from "class" to "stats". `method`: its word, where it is no `Method`.
void write_depth_answer(const PenetrationDepth& result, const NamedShape& a, const NamedShape& b,
                        std::int64_t nanoseconds, JsonWriter& answer, std::string_view method = {});

/// The fields of an answer along a direction.
void write_directional_answer(const DirectionalDepth& result, std::int64_t nanoseconds, JsonWriter& answer);

/// The field "stats".
void write_statistics(const Statistics& statistics, std::int64_t nanoseconds, JsonWriter& answer);

/// The fields that every depth answer begins with: class, bracket, distance, translation, normal, witnesses.
void write_depth_fields(const PenetrationDepth& result, JsonWriter& answer);

/// The field "breaking_threshold", 0 where it is not given.
/// @throws Refusal bad_value when negative.
[[nodiscard]] double read_breaking_threshold(const Node& line);
/// Writes the fields "a_is" and, where points of a file are left out, "a_points_left_out". @param body  "a" or "b"
void write_body_note(std::string_view body, std::string_view is, std::int64_t left_out, JsonWriter& answer);
/// Writes the note of a body that is answered as its hull, and nothing for others.
void write_hull_note(std::string_view body, const NamedShape& shape, JsonWriter& answer);
/// Writes the fields of a contact point into the open object.
void write_contact_point(const ContactPoint& point, JsonWriter& answer);
/// The fields "normal" and "points".
void write_manifold(const ContactManifold& manifold, JsonWriter& answer);

/// "facet-vertex", "edge-edge", ...; empty where a side has no feature.
[[nodiscard]] std::string feature_kind(const PenetrationDepth& result);
/// The caller's ids of a feature's vertices.
[[nodiscard]] std::vector<int> feature_ids(const Feature& feature, const NamedShape& shape);

}  // namespace pd::query
