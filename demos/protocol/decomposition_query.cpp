/// @file
/// decomposition: the family F of [A] section 2.2, its sizes and its proof.
#include "pd/structure/decomposition.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::query {

namespace {

/// Counting how often F holds a pair takes time in proportion to these, listing the facets memory.
constexpr std::int64_t kMostProducts = std::int64_t{1} << 32;
constexpr std::int64_t kMostFacets = std::int64_t{1} << 26;

}  // namespace

void answer_decomposition(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "verify"});
  const bool verify = read_flag(line, "verify");
  const Pair pair = read_pair(line, session.limits);
  const ConvexPolytope& a = require_polytope(pair.a, line.at("a"));
  const ConvexPolytope& b = require_polytope(pair.b, line.at("b"));
  const Stopwatch watch;
  const Decomposition family = Decomposition::of(a, pair.pose_a, b, pair.pose_b);
  const std::int64_t nanoseconds = watch.nanoseconds();
  if (family.sum_products() > kMostProducts) {
    line.refuse("limit_exceeded", "more than " + std::to_string(kMostProducts) + " edge-edge facets to count");
  }
  const DecompositionCover cover = cover_of(family, a, b);
  answer.key("pairs").integer(family.num_pairs());
  answer.key("sum_sizes").integer(family.sum_sizes());
  answer.key("sum_products").integer(family.sum_products());
  answer.key("K_edge_edge").integer(cover.edge_edge);
  answer.key("max_cover").integer(cover.max_cover);
  answer.key("closest_lines_work").number(family.closest_lines_work());
  answer.key("size_classes").begin_array();
  for (const Decomposition::SizeClass& c : family.size_classes()) {
    answer.begin_object().key("i").integer(c.exponent);
    answer.key("pairs").integer(c.pairs);
    answer.key("opposite_sum").integer(c.opposite_sum);
    answer.key("family").string(c.family == Decomposition::Family::a ? "A" : "B").end_object();
  }
  answer.end_array();
  if (verify) {
    const Expected<DecompositionCheck> check = check_decomposition(family, a, pair.pose_a, b, pair.pose_b, kMostFacets);
    if (!check) line.at("verify").refuse(check.error());
    // Lemma 2.3 is about bodies that meet; where they only touch, two lines may.
    const ContactClass contact = penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch).contact;
    const std::int64_t violations = contact == ContactClass::separated  ? 0
                                    : contact == ContactClass::touching ? check->lines_below
                                                                        : check->lines_below + check->lines_meeting;
    answer.key("class").string(to_string(contact));
    answer.key("missing").integer(check->missing);
    answer.key("extra").integer(check->extra);
    answer.key("sign_violations").integer(violations);
    answer.key("signs_checked");
    answer.integer(contact == ContactClass::separated ? 0
                                                      : check->lines_above + check->lines_meeting + check->lines_below);
  }
  answer.key("stats").begin_object().key("nanoseconds").integer(nanoseconds).end_object();
}

}  // namespace pd::query
