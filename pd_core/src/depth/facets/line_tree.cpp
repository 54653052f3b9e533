#include "depth/facets/line_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

/// Unit normals, tangents and products with the slabs' directions err by less than this (32u), and so do the ends of an
/// arc; an extremum that rounding hides just beyond an end exceeds the end by a square of it.
constexpr double kArcError = 0x1p-45;

std::array<double, LineTree::kSlabs> along_slabs(const Vec3& v) {
  return {
      v.x(), v.y(), v.z(), v.x() + v.y() + v.z(), v.x() + v.y() - v.z(), v.x() - v.y() + v.z(), v.x() - v.y() - v.z()};
}

/// Squared lengths of the slabs' directions.
constexpr std::array<double, LineTree::kSlabs> kSlabSquared{1, 1, 1, 3, 3, 3, 3};

/// The slabs of the great arc from p to q about the unit axis e, or of the whole circle.
LineTree::Slabs slabs_of(const Vec3& p, const Vec3& q, const Vec3& e, bool whole_circle) {
  constexpr double error = kArcError;
  LineTree::Slabs slabs;
  const auto at_p = along_slabs(p), at_q = along_slabs(q), at_e = along_slabs(e);
  const auto leaves_p = along_slabs(e.cross(p)), leaves_q = along_slabs(e.cross(q));
  for (std::size_t k = 0; k < LineTree::kSlabs; ++k) {
    double low = std::min(at_p[k], at_q[k]);
    double high = std::max(at_p[k], at_q[k]);
    const bool rises = leaves_p[k] > -error && leaves_q[k] < error;
    const bool falls = leaves_p[k] < error && leaves_q[k] > -error;
    if (whole_circle || rises || falls) {
      const double peak = std::sqrt(std::max(0.0, kSlabSquared[k] - at_e[k] * at_e[k]) + 8 * error);
      if (whole_circle || rises) high = std::max(high, peak);
      if (whole_circle || falls) low = std::min(low, -peak);
    }
    slabs.low[k] = low - 4 * kArcError;
    slabs.high[k] = high + 4 * kArcError;
  }
  return slabs;
}

Line6 minus(const Line6& x, const Line6& y) {
  return {x[0] - y[0], x[1] - y[1], x[2] - y[2], x[3] - y[3], x[4] - y[4], x[5] - y[5]};
}

}  // namespace

void LineTree::clear() {
  nodes_.clear();
  order_.clear();
  lines_.clear();
  points_.clear();
  middles_.clear();
  slabs_.clear();
  half_edges_.clear();
  facets_.clear();
  largest_ = 0;
}

void LineTree::build(const PosedPair& pair, const OverlayBuffers& overlay, bool of_a,
                     const std::vector<std::int32_t>& edges, const std::vector<std::int32_t>& shared_facets,
                     const Frame& frame) {
  clear();
  if (edges.empty()) return;
  const ConvexPolytope& body = of_a ? pair.a() : pair.b();
  const PosedDiagram& diagram = of_a ? overlay.a : overlay.b;
  const Mat3 turn = normal_matrix(of_a ? pair.pose_a() : pair.pose_b());
  const Vec3 origin = of_a ? frame.origin : Vec3(frame.origin - frame.offset);
  for (const std::int32_t h : edges) {
    const HalfEdge e = body.half_edge(h);
    const int target = body.target(h);
    // From the stored points and not from the posed ones, whose rounding is that of far larger numbers.
    const Vec3 vector =
        pair.approximate(of_a ? PairVector::edge_a(e.origin, target) : PairVector::edge_b(e.origin, target));
    Vec3 d = vector.stableNormalized();
    Slabs slabs;
    facets_.push_back({-1, -1});
    if (e.facet < 0) {
      const Vec3 u = d.unitOrthogonal();
      slabs = slabs_of(u, u, d, true);
      middles_.emplace_back(Vec3::Zero());
    } else {
      const Vec3 from = turn * body.facet_normal(e.facet);
      const Vec3 to = turn * body.facet_normal(body.half_edge(e.twin).facet);
      const double mirror = of_a ? -1 : 1;
      const Vec3 p = from * (mirror / from.norm());
      const Vec3 q = to * (mirror / to.norm());
      slabs = slabs_of(p, q, d, false);
      middles_.emplace_back(0.5 * (p + q));
      facets_.back() = {shared_facets[static_cast<std::size_t>(e.facet)],
                        shared_facets[static_cast<std::size_t>(body.half_edge(e.twin).facet)]};
    }
    slabs_.push_back(slabs);
    // One sense for each line, so that parallel ones lie together.
    Eigen::Index largest = 0;
    d.cwiseAbs().maxCoeff(&largest);
    if (d[largest] < 0) d = -d;
    const Vec3 p = (diagram.points[static_cast<std::size_t>(e.origin)] - origin) * frame.scale;
    const Vec3 m = p.cross(d);
    lines_.push_back(of_a ? Line6{m.x(), m.y(), m.z(), d.x(), d.y(), d.z()}
                          : Line6{d.x(), d.y(), d.z(), m.x(), m.y(), m.z()});
    largest_ = std::max(largest_, std::sqrt(dot(lines_.back(), lines_.back())));
    points_.push_back(p);
    half_edges_.push_back(h);
  }
  largest_ *= 1 + 0x1p-48;
  order_.resize(lines_.size());
  std::iota(order_.begin(), order_.end(), 0);
  Node root;
  root.first = 0;
  root.last = static_cast<std::int32_t>(lines_.size());
  bound(root);
  nodes_.push_back(root);
}

/// Halves a node where it is longest, among the six coordinates of its lines and the three of its arcs' middles.
int LineTree::children(int number) {
  const Node node = nodes_[static_cast<std::size_t>(number)];
  if (node.left >= 0) return node.left;
  const auto coordinate = [&](std::int32_t i, std::size_t k) {
    return k < 6 ? lines_[static_cast<std::size_t>(i)][k] : middles_[order(i)][static_cast<Eigen::Index>(k) - 6];
  };
  std::array<double, 9> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (std::int32_t i = node.first; i < node.last; ++i) {
    for (std::size_t k = 0; k < 9; ++k) {
      const double c = coordinate(i, k);
      low[k] = std::min(low[k], c);
      high[k] = std::max(high[k], c);
    }
  }
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 9; ++k) {
    if (high[k] - low[k] > high[longest] - low[longest]) longest = k;
  }
  keys_.clear();
  for (std::int32_t i = node.first; i < node.last; ++i) {
    keys_.push_back({coordinate(i, longest), order_[static_cast<std::size_t>(i)], i});
  }
  const std::int32_t half = (node.last - node.first) / 2;
  std::nth_element(keys_.begin(), keys_.begin() + half, keys_.end());
  moved_.clear();
  for (const Key& key : keys_) moved_.push_back(lines_[static_cast<std::size_t>(key.position)]);
  std::copy(moved_.begin(), moved_.end(), lines_.begin() + node.first);
  for (std::int32_t i = node.first; i < node.last; ++i) {
    order_[static_cast<std::size_t>(i)] = keys_[static_cast<std::size_t>(i - node.first)].line;
  }
  const auto left = static_cast<std::int32_t>(nodes_.size());
  nodes_[static_cast<std::size_t>(number)].left = left;
  Node child;
  child.first = node.first;
  child.last = node.first + half;
  bound(child);
  nodes_.push_back(child);
  child.first = child.last;
  child.last = node.last;
  bound(child);
  nodes_.push_back(child);
  return left;
}

void LineTree::bound(Node& node) const {
  node.slabs.low.fill(4);
  node.slabs.high.fill(-4);
  node.centre = {};
  node.facets = facets(node.first);
  for (std::int32_t i = node.first; i < node.last; ++i) {
    const Slabs& slabs = slabs_[order(i)];
    for (std::size_t k = 0; k < kSlabs; ++k) {
      node.slabs.low[k] = std::min(node.slabs.low[k], slabs.low[k]);
      node.slabs.high[k] = std::max(node.slabs.high[k], slabs.high[k]);
    }
    for (std::size_t k = 0; k < 6; ++k) node.centre[k] += line(i)[k];
    for (std::int32_t& facet : node.facets) {
      if (facet != facets(i)[0] && facet != facets(i)[1]) facet = -1;
    }
  }
  const double inverse = 1.0 / (node.last - node.first);
  for (double& c : node.centre) c *= inverse;
  // The chord runs from the line farthest from the first one to the one farthest from that.
  const auto farthest_from = [&](const Line6& from) {
    double most = -1;
    std::int32_t farthest = node.first;
    for (std::int32_t i = node.first; i < node.last; ++i) {
      const Line6 way = minus(line(i), from);
      const double squared = dot(way, way);
      if (squared > most) {
        most = squared;
        farthest = i;
      }
    }
    return line(farthest);
  };
  const Line6 one = farthest_from(line(node.first));
  node.chord = minus(farthest_from(one), one);
  const double length = std::sqrt(dot(node.chord, node.chord));
  for (double& c : node.chord) c = length > 0 ? c / length : 0;
  node.low = node.high = 0;
  double residual = 0;
  for (std::int32_t i = node.first; i < node.last; ++i) {
    const Line6 way = minus(line(i), node.centre);
    const double along = dot(way, node.chord);
    node.low = std::min(node.low, along);
    node.high = std::max(node.high, along);
    double squared = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      const double rest = way[k] - along * node.chord[k];
      squared += rest * rest;
    }
    residual = std::max(residual, squared);
  }
  node.residual = std::sqrt(residual) + 0x1p-48 * (1 + largest_);
}

}  // namespace pd::detail
