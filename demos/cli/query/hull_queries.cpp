/// @file
/// Queries about one body: hull, width.
#include "pair_reader.hpp"
#include "pd/depth/width.hpp"

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

void answer_width(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "method", "delta"});
  Method method = Method::automatic;
  const auto method_node = line.find("method");
  if (method_node) method = read_method(*method_node);
  // Every width is exact up to rounding, which is within every delta.
  if (const auto delta = line.find("delta")) (void)read_delta(*delta);
  const NamedShape a = read_shape(line.at("a"), session.limits);
  const Pose pose = read_optional_pose(line, "pose_a");
  if (method != Method::automatic && method != Method::expansion && method != Method::overlay) {
    method_node->refuse("unsupported", "this method gives no widths yet; \"auto\" is exact");
  }
  if (!supports(method, a.shape, a.shape)) {
    method_node->refuse("unsupported", "this method does not answer for this shape; \"auto\" does");
  }
  const Stopwatch watch;
  const Width result = width({&a.shape, pose}, session.scratch, method);
  const std::int64_t nanoseconds = watch.nanoseconds();
  answer.key("width").number(result.width);
  answer.key("lower").number(result.lower);
  answer.key("upper").number(result.upper);
  answer.key("normal").vector(result.normal);
  write_statistics(result.statistics, nanoseconds, answer);
}

}  // namespace pd::query
