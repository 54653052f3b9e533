#include "depth/facets/decomposition_depth.hpp"

#include <algorithm>
#include <cmath>

#include "depth/facets/facet_enumeration.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// So many vertices of P are tried against each facet: the first ones found stand far apart.
constexpr std::size_t kProbes = 32;

double norm1(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }

class DecompositionSearch {
 public:
  DecompositionSearch(const PosedPair& pair, const DecompositionSettings& settings, OverlayDepthBuffers& overlay,
                      DecompositionBuffers& buffers)
      : pair_(pair),
        settings_(settings),
        overlay_(overlay),
        buffers_(buffers),
        walk_(pair, overlay.overlay),
        search_(walk_, overlay.candidates, settings.upper) {
    PairVector translation;
    translation.translated = true;
    offset_ = pair.approximate(translation);
    const double error = pair.vector_error();
    reach_ = (overlay.overlay.a.reach + overlay.overlay.b.reach + norm1(offset_) + 3 * error) * (1 + 8 * kUnitRoundoff);
    point_error_ = (3 * error + 2 * kUnitRoundoff * reach_) * (1 + 8 * kUnitRoundoff);
    choose_probes();
  }

  /// False when all facets had better be enumerated: nothing is found then.
  bool run(DecompositionDepth& result) {
    for (const bool of_a : {true, false}) {
      mark_far_facets(of_a);
      gather_edges(of_a);
    }
    result.edges_a = static_cast<std::int64_t>(buffers_.edges_a.size());
    result.edges_b = static_cast<std::int64_t>(buffers_.edges_b.size());
    if (settings_.may_enumerate && enumeration_is_cheaper()) return false;

    for (const bool of_a : {true, false}) offer_facets(of_a);
    LineTree::Frame frame;
    frame.offset = offset_;
    frame.origin = overlay_.overlay.a.points.front();
    frame.scale = 1 / reach_;
    find_shared_facets(walk_, buffers_.shared);
    buffers_.lines.a.build(pair_, overlay_.overlay, true, buffers_.edges_a, buffers_.shared.of_a, frame);
    buffers_.lines.b.build(pair_, overlay_.overlay, false, buffers_.edges_b, buffers_.shared.of_b, frame);
    offer_closest_lines(walk_, reach_, settings_.seed, buffers_.lines, search_, result.lines);

    const std::optional<OverlayPiece> piece = search_.piece(settings_.exactly);
    result.nearest.facets_visited = search_.visited();
    result.nearest.exact_comparisons = search_.exact_comparisons();
    result.nearest.has_facet = piece.has_value();
    if (piece) result.nearest.facet = facet_of(pair_, *piece);
    result.nearest.contact = search_.outside() ? ContactClass::separated
                             : search_.zero()  ? ContactClass::touching
                                               : ContactClass::overlapping;
    return true;
  }

 private:
  [[nodiscard]] const ConvexPolytope& body(bool of_a) const { return of_a ? pair_.a() : pair_.b(); }
  [[nodiscard]] const PosedDiagram& diagram(bool of_a) const { return of_a ? overlay_.overlay.a : overlay_.overlay.b; }

  void choose_probes() {
    buffers_.test_points.clear();
    probe_reach_ = 0;
    for (const VertexPair& v : settings_.vertices.first(std::min(kProbes, settings_.vertices.size()))) {
      const Vec3 x = overlay_.overlay.b.points[static_cast<std::size_t>(v.b)] -
                     overlay_.overlay.a.points[static_cast<std::size_t>(v.a)] + offset_;
      buffers_.test_points.push_back({x, v.a, v.b});
      probe_reach_ = std::max(probe_reach_, norm1(x));
    }
  }

  /// The outward normal, in P, of a facet of one body.
  [[nodiscard]] Vec3 normal(bool of_a, int facet) const {
    const PosedDiagram::Facet& f = diagram(of_a).facets[static_cast<std::size_t>(facet)];
    const Vec3 n(f.normal[0], f.normal[1], f.normal[2]);
    return of_a ? Vec3(-n) : n;
  }
  /// A test point above this product with a facet's normal shows its plane to be farther than the bound.
  [[nodiscard]] double far_level(bool of_a, int facet, const Vec3& n) const {
    const double normal_error = diagram(of_a).normal_errors[static_cast<std::size_t>(facet)];
    const double n1 = norm1(n);
    const double product_error = (probe_reach_ * normal_error + n1 * point_error_ + 3 * point_error_ * normal_error +
                                  4 * kUnitRoundoff * probe_reach_ * n1) *
                                     (1 + 16 * kUnitRoundoff) +
                                 0x1p-900;
    const double longest = std::sqrt(n.squaredNorm()) * (1 + 8 * kUnitRoundoff) + 2 * normal_error;
    return (search_.upper() * longest + product_error) * (1 + 8 * kUnitRoundoff);
  }

  [[nodiscard]] std::vector<std::int32_t>& far_from(bool of_a) const {
    return of_a ? buffers_.far_from_a : buffers_.far_from_b;
  }

  void mark_far_facets(bool of_a) {
    const int count = body(of_a).num_facets();
    far_from(of_a).assign(static_cast<std::size_t>(count), -1);
    if (buffers_.test_points.empty()) return;
    const int test_points = static_cast<int>(buffers_.test_points.size());
    int last = 0;  // neighbours in number are often neighbours in space
    for (int f = 0; f < count; ++f) {
      const Vec3 n = normal(of_a, f);
      const double level = far_level(of_a, f, n);
      if (!(test_point(last).x.dot(n) > level)) {
        last = 0;
        double best = test_point(0).x.dot(n);
        for (int k = 1; k < test_points; ++k) {
          const double value = test_point(k).x.dot(n);
          if (value > best) {
            best = value;
            last = k;
          }
        }
        if (!(best > level)) continue;
      }
      far_from(of_a)[static_cast<std::size_t>(f)] = last;
    }
  }

  [[nodiscard]] const DecompositionBuffers::TestPoint& test_point(int k) const {
    return buffers_.test_points[static_cast<std::size_t>(k)];
  }

  /// [A] step 1, for the facets of one body.
  void offer_facets(bool of_a) {
    int at = 0;
    for (int f = 0; f < body(of_a).num_facets(); ++f) {
      if (far_from(of_a)[static_cast<std::size_t>(f)] >= 0) continue;
      at = locate(of_a, f, start(of_a, f, at));
      const OverlayPiece piece = of_a ? OverlayPiece{OverlayPiece::Kind::facet_of_a, f, at}
                                      : OverlayPiece{OverlayPiece::Kind::facet_of_b, at, f};
      search_.consume(std::span<const OverlayPiece>(&piece, 1));
    }
  }

  /// Where the climb to the vertex of the other body that is extreme against a facet begins.
  [[nodiscard]] int start(bool of_a, int facet, int otherwise) const {
    if (buffers_.test_points.empty()) return otherwise;
    const Vec3 n = normal(of_a, facet);
    const auto best = std::max_element(buffers_.test_points.begin(), buffers_.test_points.end(),
                                       [&](const auto& x, const auto& y) { return x.x.dot(n) < y.x.dot(n); });
    return of_a ? best->b : best->a;
  }

  /// The vertex of the other body whose cell holds the facet's opposite normal, by a walk in its normal diagram. By
  /// convexity an exact local maximum is the maximum.
  [[nodiscard]] int locate(bool of_a, int facet, int at) const {
    const ConvexPolytope& other = body(!of_a);
    for (bool improved = true; improved;) {
      improved = false;
      const int begin = other.first_half_edge(at);
      const int end = begin + static_cast<int>(other.neighbours(at).size());
      for (int h = begin; h < end; ++h) {
        const int side = of_a ? walk_.side_of_edge_b(h, facet) : walk_.side_of_edge_a(h, facet);
        if (side < 0) {
          at = other.target(h);
          improved = true;
          break;
        }
      }
    }
    return at;
  }

  /// The edges whose arcs no test point shows to be too far from end to end.
  void gather_edges(bool of_a) {
    const ConvexPolytope& own = body(of_a);
    std::vector<std::int32_t>& edges = of_a ? buffers_.edges_a : buffers_.edges_b;
    edges.clear();
    for (int h = 0; h < own.num_half_edges(); ++h) {
      const HalfEdge e = own.half_edge(h);
      if (e.twin < h || (e.facet >= 0 && far_arc(of_a, e.facet, own.half_edge(e.twin).facet))) continue;
      edges.push_back(h);
    }
  }

  [[nodiscard]] bool far_arc(bool of_a, int f, int g) const {
    const std::int32_t at_f = far_from(of_a)[static_cast<std::size_t>(f)];
    const std::int32_t at_g = far_from(of_a)[static_cast<std::size_t>(g)];
    if (at_f < 0 || at_g < 0) return false;
    if (at_f == at_g) return true;
    const Vec3 m = normal(of_a, f), n = normal(of_a, g);
    const double level_m = far_level(of_a, f, m), level_n = far_level(of_a, g, n);
    return std::any_of(buffers_.test_points.begin(), buffers_.test_points.end(),
                       [&](const auto& p) { return p.x.dot(m) > level_m && p.x.dot(n) > level_n; });
  }

  /// Whether the overlay, at its price for each facet of P, is likely to cost less than the search for the closest
  /// lines at its price for each edge that is left (or each pair of them).
  ///
  /// The facets are guessed as for arcs thrown at random on the part of the sphere that they span: 2 / pi times the
  /// product of their lengths over its area, for which half the surface of their box stands. Prices in nanoseconds, as
  /// measured on round patches and balls of 64 to 2048 edges.
  [[nodiscard]] bool enumeration_is_cheaper() const {
    constexpr double kFacet = 14, kLocation = 100, kPair = 8, kLine = 400;
    Vec3 low = Vec3::Constant(1), high = Vec3::Constant(-1);
    const double length_a = arcs_length(true, low, high);
    const double length_b = arcs_length(false, low, high);
    const Vec3 box = high - low;
    const double area = box.x() * box.y() + box.y() * box.z() + box.z() * box.x();
    const double all = pair_.a().num_edges() + pair_.b().num_edges();
    const double facets = std::max(all, area > 0 ? 2 / 3.14 * length_a * length_b / area : 0.0);
    const auto edges_a = static_cast<double>(buffers_.edges_a.size());
    const auto edges_b = static_cast<double>(buffers_.edges_b.size());
    const double lines = std::min(kPair * edges_a * edges_b, kLine * (edges_a + edges_b));
    return kFacet * facets + kLocation * all < lines;
  }

  /// Total length of the arcs that are left (their chords'), whose ends widen the box.
  double arcs_length(bool of_a, Vec3& low, Vec3& high) const {
    const ConvexPolytope& own = body(of_a);
    const Pose& pose = of_a ? pair_.pose_a() : pair_.pose_b();
    const double mirror = of_a ? -1 : 1;
    double length = 0;
    for (const std::int32_t h : of_a ? buffers_.edges_a : buffers_.edges_b) {
      const HalfEdge e = own.half_edge(h);
      if (e.facet < 0) return 0;  // a segment: little to search
      const Vec3 p = mirror * (pose.rotation() * own.facet_normal(e.facet));
      const Vec3 q = mirror * (pose.rotation() * own.facet_normal(own.half_edge(e.twin).facet));
      low = low.cwiseMin(p).cwiseMin(q);
      high = high.cwiseMax(p).cwiseMax(q);
      length += (q - p).norm();
    }
    return length;
  }

  const PosedPair& pair_;
  const DecompositionSettings& settings_;
  OverlayDepthBuffers& overlay_;
  DecompositionBuffers& buffers_;
  OverlayWalk walk_;
  PlaneSearch search_;
  Vec3 offset_;
  double reach_ = 0;
  double point_error_ = 0;
  double probe_reach_ = 0;
};

}  // namespace

DecompositionDepth decomposition_depth(const PosedPair& pair, const DecompositionSettings& settings,
                                       OverlayDepthBuffers& overlay, DecompositionBuffers& buffers) {
  DecompositionDepth result;
  const bool solid = pair.a().affine_dimension() == 3 || pair.b().affine_dimension() == 3;
  if (!solid && flat_difference(pair)) {
    // A flat P has one plane, and no search to speak of.
    result.nearest = overlay_depth(pair, overlay, settings.exactly, settings.upper);
    return result;
  }
  if (!DecompositionSearch(pair, settings, overlay, buffers).run(result)) {
    result.nearest = overlay_depth(pair, overlay, settings.exactly, settings.upper);
    result.enumerated = true;
  }
  return result;
}

}  // namespace pd::detail
