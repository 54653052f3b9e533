/// @file
/// Queries about one body: hull, width, hierarchy.
#include "pd/depth/width.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"
#include "protocol/pair_reader.hpp"

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
  // Every width is exact up to rounding, which is within every delta, but that of the grid.
  double delta = 0;
  if (const auto delta_node = line.find("delta")) delta = read_delta(*delta_node);
  const NamedShape a = read_shape(line.at("a"), session.limits);
  const Pose pose = read_optional_pose(line, "pose_a");
  if (method == Method::shallow || method == Method::decomposition) {
    method_node->refuse("unsupported", "this method gives no widths yet; \"auto\" is exact");
  }
  if (!supports(method, a.shape, a.shape)) {
    method_node->refuse("unsupported", "this method does not answer for this shape; \"auto\" does");
  }
  const Stopwatch watch;
  const Width result = width({&a.shape, pose}, session.scratch, method, delta);
  const std::int64_t nanoseconds = watch.nanoseconds();
  answer.key("width").number(result.width);
  answer.key("lower").number(result.lower);
  answer.key("upper").number(result.upper);
  if (!result.bracket_reached) answer.bracket_unreached();
  answer.key("normal").vector(result.normal);
  write_statistics(result.statistics, nanoseconds, answer);
}

void answer_hierarchy(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "kind"});
  HierarchyKind kind = HierarchyKind::inner;
  if (const auto node = line.find("kind")) {
    const std::string word = read_string(*node);
    if (word == "outer") {
      kind = HierarchyKind::outer;
    } else if (word != "inner") {
      node->refuse("bad_value", "unknown kind; known: inner, outer");
    }
  }
  const Node a = line.at("a");
  const NamedShape named = read_shape(a, session.limits);
  (void)read_optional_pose(line, "pose_a");  // levels do not depend on it
  const ConvexPolytope* const body = named.shape.polytope();
  if (body == nullptr || named.shape.margin() > 0) {
    a.refuse("unsupported", "a hierarchy is that of a polytope: convex, box or mesh, without a margin");
  }
  const Expected<PolyhedralHierarchy> hierarchy = PolyhedralHierarchy::build(*body, kind);
  if (!hierarchy) a.refuse(to_string(hierarchy.error().code), hierarchy.error().message);
  answer.key("levels").begin_array();
  for (const PolyhedralHierarchy::Level& level : hierarchy->levels()) {
    answer.begin_object();
    answer.key("vertices").integer(level.vertices);
    answer.key("facets").integer(level.facets);
    answer.key("max_degree").integer(level.max_degree);
    answer.end_object();
  }
  answer.end_array();
}

}  // namespace pd::query
