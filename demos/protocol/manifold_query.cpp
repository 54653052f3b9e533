/// @file
/// contact_manifold: at most four pairs of contact points.
#include "protocol/pair_reader.hpp"

namespace pd::query {

double read_breaking_threshold(const Node& line) {
  double threshold = 0;
  if (const auto node = line.find("breaking_threshold")) {
    threshold = read_number(*node);
    if (threshold < 0) node->refuse("bad_value", "a breaking threshold must be 0 or greater");
  }
  return threshold;
}

void write_contact_point(const ContactPoint& point, JsonWriter& answer) {
  answer.key("position_a").vector(point.position_a);
  answer.key("position_b").vector(point.position_b);
  answer.key("depth").number(point.depth);
  answer.key("feature_id").integer(point.feature_id);
}

void write_manifold(const ContactManifold& manifold, JsonWriter& answer) {
  answer.key("normal").vector(manifold.normal);
  answer.key("points").begin_array();
  for (int i = 0; i < manifold.count; ++i) {
    answer.begin_object();
    write_contact_point(manifold.points[static_cast<std::size_t>(i)], answer);
    answer.end_object();
  }
  answer.end_array();
}

void answer_contact_manifold(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "breaking_threshold", "one_sided"});
  const double threshold = read_breaking_threshold(line);
  if (read_flag(line, "one_sided")) {
    line.at("one_sided")
        .refuse("unsupported", "only a sheet has sides; give a mesh as one (\"as\":\"sheet\"), or leave one_sided out");
  }
  const Pair pair = read_pair(line, session.limits);
  const PenetrationDepth depth = penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch,
                                                   {.method = Method::automatic, .bracket = Bracket::tightest});
  const ContactManifold manifold =
      contact_manifold(pair.posed_a(), pair.posed_b(), depth, threshold, session.manifold_scratch);
  write_manifold(manifold, answer);
}

}  // namespace pd::query
