#include "dimension/backends/kernel_structure.hpp"

#include <algorithm>
#include <numeric>

#include "dimension/equal_planes.hpp"
#include "dimension/halfspace_body.hpp"

namespace pd::dimension::detail {

KernelStructure::KernelStructure(const AnyMap& to_unit, std::vector<Node> nodes,
                                 const std::vector<std::array<std::int32_t, 2>>& links)
    : from_unit_(to_unit.inverse()),
      nodes_(std::move(nodes)),
      cells_(static_cast<int>(to_unit.translation.size()), static_cast<double>(nodes_.size())) {
  store_links(links);
  QueryCounters ignored;
  std::int32_t last = 0;
  for (std::int64_t c = 0; c < cells_.size(); ++c) {
    last = climb(last, cells_.middle(c), ignored);
    starts_.push_back(last);
  }
}

/// Each node's neighbours in ascending order, once each; facets name them many times.
void KernelStructure::store_links(const std::vector<std::array<std::int32_t, 2>>& links) {
  std::vector<std::int32_t> end(nodes_.size() + 1, 0);
  for (const auto& [from, to] : links) ++end[static_cast<std::size_t>(from) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::int32_t> named(links.size());
  for (const auto& [from, to] : links) named[static_cast<std::size_t>(end[static_cast<std::size_t>(from)]++)] = to;
  // `end` has moved on by one node each.
  first_link_.assign(1, 0);
  auto begin = named.begin();
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    const auto last = named.begin() + end[v];
    std::sort(begin, last);
    const auto unique = std::unique(begin, last);
    for (auto to = begin; to != unique; ++to) links_.push_back({nodes_[static_cast<std::size_t>(*to)].unit, *to});
    first_link_.push_back(static_cast<std::int32_t>(links_.size()));
    begin = last;
  }
}

std::shared_ptr<const KernelStructure> KernelStructure::of_kernel(const KernelBuilder& builder) {
  const RadialHull& hull = builder.hull();
  std::vector<std::int32_t> node_of(hull.vertices().size(), -1);
  std::vector<Node> nodes;
  std::vector<std::array<std::int32_t, 2>> links;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(hull.facets().size()); ++f) {
    if (!hull.alive(f)) continue;
    for (const std::int32_t v : hull.vertices_of(f)) {
      if (node_of[v] >= 0) continue;
      node_of[v] = static_cast<std::int32_t>(nodes.size());
      const auto& p = builder.kernel()[builder.kernel_of_vertex(v)];
      nodes.push_back({hull.vertices()[static_cast<std::size_t>(v)], p.point, p.index});
    }
    for (const std::int32_t v : hull.vertices_of(f)) {
      for (const std::int32_t w : hull.vertices_of(f)) {
        if (v != w) links.push_back({node_of[v], node_of[w]});
      }
    }
  }
  const std::shared_ptr<KernelStructure> r(new KernelStructure(builder.to_unit(), std::move(nodes), links));
  for (const std::int32_t i : builder.unplaced()) {
    const auto& p = builder.kernel()[i];
    r->loose_.push_back({p.unit, p.point, p.index});
  }
  return r;
}

std::shared_ptr<const KernelStructure> KernelStructure::build(const AnyBody& body, double epsilon) {
  const AnySandwich& sandwich = body.sandwich;
  if (body.representation == Representation::points) {
    KernelBuilder builder(sandwich.fattening(), epsilon);
    builder.add(body.points, 0);
    return of_kernel(builder);
  }
  std::vector<AnyVector> polar = polar_points(body.halfspaces, sandwich);
  for (AnyVector& q : polar) q *= sandwich.ratio;
  KernelBuilder builder(identity_map(body.dimension()), epsilon);
  builder.add(polar, 0);
  const RadialHull& hull = builder.hull();
  const std::vector<std::int32_t> same = merge_equal_planes(hull);
  std::vector<std::int32_t> node_of(hull.facets().size(), -1);
  std::vector<Node> nodes;
  std::vector<std::array<std::int32_t, 2>> links;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(hull.facets().size()); ++f) {
    if (!hull.alive(f) || same[f] != f) continue;
    node_of[f] = static_cast<std::int32_t>(nodes.size());
    const AnyVector unit = sandwich.ratio / builder.limit() * hull.normal(f);
    nodes.push_back({unit, sandwich.centre + sandwich.axes * unit, -1});
  }
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(hull.facets().size()); ++f) {
    if (!hull.alive(f)) continue;
    for (const std::int32_t g : hull.neighbours_of(f)) {
      const std::int32_t a = node_of[same[f]], b = node_of[same[g]];
      if (a != b) links.push_back({a, b});
    }
  }
  return std::shared_ptr<const KernelStructure>(new KernelStructure(sandwich.fattening(), std::move(nodes), links));
}

std::int32_t KernelStructure::climb(std::int32_t start, const AnyVector& unit_direction,
                                    QueryCounters& counters) const {
  std::int32_t at = start;
  double value = dot(unit_direction.data(), nodes_[at].unit.data(), unit_direction.size());
  std::int64_t steps = 1, products = 1;
  for (;;) {
    std::int32_t best = at;
    with_dimension(unit_direction.size(), [&](auto d) {
      for (std::int32_t l = first_link_[at]; l < first_link_[at + 1]; ++l) {
        const double other = dot(unit_direction.data(), links_[l].unit.data(), d);
        if (other > value) {
          value = other;
          best = links_[l].node;
        }
      }
    });
    products += first_link_[at + 1] - first_link_[at];
    if (best == at) break;
    at = best;
    ++steps;
  }
  counters.nodes += steps;
  counters.dot_products += products;
  counters.deepest = std::max(counters.deepest, steps);
  return at;
}

AnySupport KernelStructure::support(const AnyVector& direction, QueryCounters& counters) const {
  ++counters.queries;
  const AnyVector unit = from_unit_.pull_back(direction);
  const Node& node = nodes_[extreme_node(unit, counters)];
  AnySupport best{node.point, dot(direction.data(), node.point.data(), direction.size()), node.index};
  for (const Node& other : loose_) {
    const double value = direction.dot(other.point);
    if (value > best.value) best = {other.point, value, other.index};
  }
  return best;
}

StructureSize KernelStructure::size() const {
  StructureSize r;
  r.points = r.nodes = static_cast<std::int64_t>(nodes_.size());
  r.links = static_cast<std::int64_t>(links_.size());
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    r.max_out_degree = std::max<std::int64_t>(r.max_out_degree, first_link_[v + 1] - first_link_[v]);
  }
  r.depth = 1;
  r.bytes = static_cast<std::int64_t>(nodes_.size() * sizeof(Node) + links_.size() * sizeof(Link) +
                                      (first_link_.size() + starts_.size()) * sizeof(std::int32_t));
  return r;
}

}  // namespace pd::dimension::detail
