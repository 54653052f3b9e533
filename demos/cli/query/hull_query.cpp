/// @file
/// hull: the exact convex hull of one body's points.
#include "pair_reader.hpp"

namespace pd::query {

void answer_hull(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a"});
  const Node a = line.at("a");
  const Stopwatch watch;
  const NamedShape named = read_shape(a, session.limits);
  const std::int64_t nanoseconds = watch.nanoseconds();
  const Pose pose = read_optional_pose(line, "pose_a");
  const ConvexPolytope* hull = named.shape.polytope();
  if (hull == nullptr || named.shape.margin() > 0) {
    a.refuse("unsupported", "a hull is that of points: convex, box or mesh, without a margin");
  }
  answer.key("vertices").begin_array();
  for (int v = 0; v < hull->num_vertices(); ++v) answer.vector(pose.apply(hull->vertex(v)));
  answer.end_array();
  answer.key("vertex_ids").begin_array();
  for (int v = 0; v < hull->num_vertices(); ++v) answer.integer(named.caller_id(v));
  answer.end_array();
  answer.key("facets").begin_array();
  for (int f = 0; f < hull->num_facets() && hull->affine_dimension() == 3; ++f) {
    answer.begin_array();
    for (const std::int32_t v : hull->facet_vertices(f)) answer.integer(v);
    answer.end_array();
  }
  answer.end_array();
  answer.key("affine_dim").integer(hull->affine_dimension());
  answer.key("stats").begin_object();
  answer.key("edges").integer(hull->num_edges());
  answer.key("bytes").integer(static_cast<std::int64_t>(hull->memory_bytes()));
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

}  // namespace pd::query
