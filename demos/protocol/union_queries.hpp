/// @file
/// The queries that also answer for compounds and star-shaped bodies.
#pragma once

#include <cstdint>
#include <string_view>

#include "pd/compound/compound_depth.hpp"
#include "protocol/body_reader.hpp"
#include "protocol/handlers.hpp"

namespace pd::query {

/// Two bodies where they stand. Holds what the posed compounds refer to: neither copied nor moved.
struct BodyPair {
  NamedBody a;
  NamedBody b;
  Pose pose_a;
  Pose pose_b;

  [[nodiscard]] PosedCompound posed_a() const { return {&a.compound, pose_a}; }
  [[nodiscard]] PosedCompound posed_b() const { return {&b.compound, pose_b}; }
};

/// Reads "a", "b" and their poses.
[[nodiscard]] BodyPair read_bodies(const Node& line, const Limits& limits);

/// Reads "max_work" of a Minkowski difference; kDifferenceWork if it is not given.
[[nodiscard]] std::int64_t read_max_work(const Node& line);

/// The fields of a union's depth answer from "class" to "stats".
void write_union_answer(const UnionDepth& result, const BodyPair& pair, std::int64_t nanoseconds, JsonWriter& answer);

/// True if "a" or "b" of a line is a mesh that is asked as a sheet of triangles.
[[nodiscard]] bool names_sheet(const Node& line);

/// Answers contact_manifold for bodies that need not be convex, sheets included.
void answer_union_contact_manifold(const Node& line, Session& session, JsonWriter& answer);
void answer_union_time_of_impact(const Node& line, Session& session, JsonWriter& answer);

/// The handler of a query for bodies that need not be convex; nullptr where it answers for convex bodies only (its own
/// reader then refuses the shape).
[[nodiscard]] Handler find_union_handler(std::string_view query);

}  // namespace pd::query
