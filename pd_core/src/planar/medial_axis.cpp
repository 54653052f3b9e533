#include "pd/planar/medial_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "numeric/floating_point_guard.hpp"
#include "planar/edge_distance.hpp"
#include "planar/skeleton.hpp"

namespace pd {

namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// The part of an edge from `from` on (a distance along it from its start, in scaled units) has `edge` across the
/// bisector.
struct Arc {
  double from;
  std::int32_t edge;
};

double cross(const Point2& a, const Point2& b) { return a[0] * b[1] - a[1] * b[0]; }

}  // namespace

struct MedialAxis::Storage {
  ConvexPolygon p, q;
  ConvexDifference difference;
  std::vector<Node> nodes;
  std::int64_t work = 0;
  double scale = 1;                   ///< lengths inside = lengths outside * scale
  std::vector<Point2> inward, start;  ///< of every edge, scaled: unit normal and first corner
  std::vector<std::int32_t> arc_first;
  std::vector<Arc> arcs;
  std::int32_t root = -1;
  std::vector<std::array<std::int32_t, 3>> children;  ///< centroids of the parts beyond a node's links

  [[nodiscard]] double distance(int edge, const Point2& x) const {
    const Point2 &n = inward[index(edge)], &s = start[index(edge)];
    return n[0] * (x[0] - s[0]) + n[1] * (x[1] - s[1]);
  }
  [[nodiscard]] double along(int edge, const Point2& x) const {
    const Point2 &n = inward[index(edge)], &s = start[index(edge)];
    return n[1] * (x[0] - s[0]) - n[0] * (x[1] - s[1]);
  }
  [[nodiscard]] Point2 scaled(const Node& node) const { return {node.position[0] * scale, node.position[1] * scale}; }

  void collect_arcs(const detail::Skeleton& skeleton);
  void build_centroids();
  [[nodiscard]] int locate(const Point2& x, std::int64_t& probes) const;
  void near_edges(int found, const Point2& x, std::set<std::int32_t>& near, std::int64_t& probes) const;
};

/// The nodes of every edge's cell, in the order of their feet on the edge.
void MedialAxis::Storage::collect_arcs(const detail::Skeleton& skeleton) {
  const int n = static_cast<int>(inward.size());
  for (int f = 0; f < n; ++f) {
    arc_first.push_back(static_cast<std::int32_t>(arcs.size()));
    int across = f == 0 ? n - 1 : f - 1;
    arcs.push_back({-std::numeric_limits<double>::infinity(), across});
    for (int at = skeleton.corner_node(across); at >= 0;) {
      const Node& node = nodes[index(at)];
      std::size_t in = 0, other = 0;
      while (node.edges[in] != across) ++in;
      while (node.edges[other] == across || node.edges[other] == f) ++other;
      across = node.edges[other];
      arcs.push_back({along(f, scaled(node)), across});
      at = node.links[in];
    }
  }
  arc_first.push_back(static_cast<std::int32_t>(arcs.size()));
}

/// A tree over the nodes: each part's centroid, below it those of what is left of the part beyond its links.
void MedialAxis::Storage::build_centroids() {
  const std::size_t n = nodes.size();
  children.assign(n, {-1, -1, -1});
  std::vector<std::int32_t> size(n), parent(n), order;
  std::vector<char> taken(n, 0);
  struct Part {
    std::int32_t node, above;
    std::size_t slot;
  };
  std::vector<Part> parts{{0, -1, 0}};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    order.assign(1, part.node);
    parent[index(part.node)] = -1;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (const std::int32_t next : nodes[index(order[i])].links) {
        if (next < 0 || next == parent[index(order[i])] || taken[index(next)]) continue;
        parent[index(next)] = order[i];
        order.push_back(next);
      }
    }
    const auto whole = static_cast<std::int32_t>(order.size());
    std::int32_t centroid = part.node;
    for (const std::int32_t v : order) size[index(v)] = 1;
    for (std::size_t i = order.size(); i-- > 0;) {
      const std::int32_t v = order[i];
      // The deepest node that holds half of the part.
      if (2 * size[index(v)] >= whole) {
        centroid = v;
        break;
      }
      size[index(parent[index(v)])] += size[index(v)];
    }
    taken[index(centroid)] = 1;
    (part.above < 0 ? root : children[index(part.above)][part.slot]) = centroid;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t next = nodes[index(centroid)].links[k];
      if (next >= 0 && !taken[index(next)]) parts.push_back({next, centroid, k});
    }
  }
}

/// The nearest edge, up to rounding at the borders of the parts.
int MedialAxis::Storage::locate(const Point2& x, std::int64_t& probes) const {
  int best = nodes[index(root)].edges[0];
  double least = std::numeric_limits<double>::infinity();
  for (int at = root; at >= 0;) {
    const Node& node = nodes[index(at)];
    const Point2 c = scaled(node), v{x[0] - c[0], x[1] - c[1]};
    for (const std::int32_t e : node.edges) {
      const double d = distance(e, x);
      if (d < least) {
        least = d;
        best = e;
      }
    }
    probes += 3;
    // Part k lies between the feet on the two other edges, counter-clockwise.
    std::size_t part = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &from = inward[index(node.edges[(k + 1) % 3])], &to = inward[index(node.edges[(k + 2) % 3])];
      const double a = -cross(from, v), b = -cross(v, to);  // feet lie against the inward normals
      if (cross(from, to) >= 0 ? a >= 0 && b >= 0 : a >= 0 || b >= 0) {
        part = k;
        break;
      }
    }
    at = children[index(at)][part];
  }
  return best;
}

/// Every edge whose distance is within rounding of the least: neighbours across the bisectors over x's foot, and on.
/// From a cell to that of an edge nearly as near, all cells on the straight way are nearly as near.
void MedialAxis::Storage::near_edges(int found, const Point2& x, std::set<std::int32_t>& near,
                                     std::int64_t& probes) const {
  constexpr double kMargin = 1e-12;
  double least = distance(found, x);
  std::vector<std::int32_t> open{found};
  near.insert(found);
  const auto look = [&](std::int32_t e) {
    ++probes;
    const double d = distance(e, x);
    if (d > least + kMargin) return false;
    least = std::min(least, d);
    if (near.insert(e).second) open.push_back(e);
    return true;
  };
  while (!open.empty()) {
    const std::int32_t f = open.back();
    open.pop_back();
    if (distance(f, x) > least + kMargin) continue;
    const auto first = arcs.begin() + arc_first[index(f)], last = arcs.begin() + arc_first[index(f + 1)];
    const double foot = along(f, x);
    const auto above = std::upper_bound(first, last, foot, [](double t, const Arc& arc) { return t < arc.from; });
    for (auto arc = above; arc != last && look(arc->edge); ++arc) {
    }
    for (auto arc = above; arc != first && look((arc - 1)->edge); --arc) {
    }
  }
  std::erase_if(near, [&](std::int32_t e) { return distance(e, x) > least + kMargin; });
}

MedialAxis MedialAxis::build(const ConvexPolygon& p, const ConvexPolygon& q) {
  const detail::FloatingPointGuard guard;
  auto data = std::make_shared<Storage>();
  data->p = p;
  data->q = q;
  data->difference = convex_difference(p, q);
  const detail::DifferenceEdges edges(data->p, data->q, data->difference);
  double largest = 0;
  for (const ConvexPolygon* polygon : {&p, &q}) {
    for (const Point2& v : polygon->points()) largest = std::max({largest, std::abs(v[0]), std::abs(v[1])});
  }
  data->scale = std::ldexp(1.0, -std::ilogb(largest) - 2);
  const int n = edges.size();
  std::vector<detail::EdgeLine> lines;
  for (int i = 0; i < n; ++i) {
    const auto u = detail::vector_of<detail::Dyadic>(edges.edge(i));
    const detail::Vec3DD normal = detail::unit_double_double({-u[1], u[0], detail::Dyadic(0.0)});
    const ConvexDifference::Corner& c = edges.corner(i);
    const Point2 &a = p.vertex(c.p), &b = q.vertex(c.q);
    const auto coordinate = [&](std::size_t k) { return detail::two_sum(a[k] * data->scale, -b[k] * data->scale); };
    const detail::DoubleDouble x = coordinate(0), y = coordinate(1);
    lines.push_back({normal.x, normal.y, -(normal.x * x + normal.y * y)});
    data->inward.push_back({to_double(normal.x), to_double(normal.y)});
    data->start.push_back({to_double(x), to_double(y)});
  }
  // Edges that bound a region alone: the first one, the last one turned by less than half a turn from it, the next, and
  // one more where that runs back along the first.
  int last = 1;
  while (last + 1 < n && turn(edges.edge(0), edges.edge(last + 1)) > 0) ++last;
  std::vector<std::int32_t> start{0, last, last + 1};
  if (turn(edges.edge(0), edges.edge(last + 1)) == 0) start.push_back(last + 2);

  const detail::Skeleton skeleton(std::move(lines), start);
  data->work = skeleton.work();
  const double unscale = 1 / data->scale;
  for (const detail::Skeleton::Node& s : skeleton.nodes()) {
    Node node{{to_double(s.x) * unscale, to_double(s.y) * unscale}, to_double(s.radius) * unscale, s.faces, s.links};
    // Counter-clockwise from the least edge.
    const auto least = std::min_element(node.edges.begin(), node.edges.end()) - node.edges.begin();
    std::rotate(node.edges.begin(), node.edges.begin() + least, node.edges.end());
    std::rotate(node.links.begin(), node.links.begin() + least, node.links.end());
    if (node.edges[1] > node.edges[2]) {
      std::swap(node.edges[1], node.edges[2]);
      std::swap(node.links[1], node.links[2]);
    }
    data->nodes.push_back(node);
  }
  data->collect_arcs(skeleton);
  data->build_centroids();
  return MedialAxis(std::move(data));
}

std::span<const MedialAxis::Node> MedialAxis::nodes() const { return data_->nodes; }
int MedialAxis::num_edges() const { return static_cast<int>(data_->inward.size()); }
std::int64_t MedialAxis::work() const { return data_->work; }

Expected<PlanarDepth> MedialAxis::depth(const Point2& displacement) const {
  const detail::FloatingPointGuard guard;
  const Storage& s = *data_;
  // The class by a line through the displacement, as convex_intersection; its probes count.
  const auto line = convex_directional_depth(s.p, s.q, displacement, {1, 0});
  if (!line) return line.error();
  PlanarDepth out;
  out.contact = line->contact;
  out.probes = line->probes;
  if (out.contact != PlanarContact::overlapping) return out;
  const Point2 x{displacement[0] * s.scale, displacement[1] * s.scale};
  std::set<std::int32_t> near;
  s.near_edges(s.locate(x, out.probes), x, near, out.probes);
  const detail::DifferenceEdges edges(s.p, s.q, s.difference);
  int nearest = *near.begin();
  for (const std::int32_t e : near) {
    if (edges.compare(e, nearest, displacement) < 0) nearest = e;
  }
  edges.fill(nearest, displacement, out);
  return out;
}

}  // namespace pd
