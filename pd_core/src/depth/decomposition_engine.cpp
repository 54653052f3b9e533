#include "depth/decomposition_engine.hpp"

#include <algorithm>
#include <cmath>

#include "depth/plane_search.hpp"

namespace pd::detail {

namespace {

constexpr double kU = 0x1p-53;

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
    reach_ = (overlay.overlay.a.reach + overlay.overlay.b.reach + norm1(offset_) + 3 * error) * (1 + 8 * kU);
    point_error_ = (3 * error + 2 * kU * reach_) * (1 + 8 * kU);
    choose_probes();
  }

  void run(DecompositionDepth& result) {
    LineTree::Frame frame;
    frame.offset = offset_;
    frame.origin = overlay_.overlay.a.points.front();
    frame.scale = 1 / reach_;
    for (const bool of_a : {true, false}) {
      mark_far_facets(of_a);
      offer_facets(of_a);
      gather_edges(of_a);
      (of_a ? result.edges_a : result.edges_b) = static_cast<std::int64_t>(buffers_.edges.size());
      (of_a ? buffers_.lines.a : buffers_.lines.b).build(pair_, overlay_.overlay, of_a, buffers_.edges, frame);
    }
    offer_closest_lines(walk_, reach_, settings_.seed, buffers_.lines, search_, result.lines);

    const std::optional<OverlayPiece> piece = search_.piece(settings_.exactly);
    result.nearest.facets_visited = search_.visited();
    result.nearest.exact_comparisons = search_.exact_comparisons();
    result.nearest.has_facet = piece.has_value();
    if (piece) result.nearest.facet = facet_of(pair_, *piece);
    result.nearest.contact = search_.outside() ? ContactClass::separated
                             : search_.zero()  ? ContactClass::touching
                                               : ContactClass::overlapping;
  }

 private:
  [[nodiscard]] const ConvexPolytope& body(bool of_a) const { return of_a ? pair_.a() : pair_.b(); }
  [[nodiscard]] const PosedDiagram& diagram(bool of_a) const { return of_a ? overlay_.overlay.a : overlay_.overlay.b; }

  void choose_probes() {
    buffers_.probes.clear();
    probe_reach_ = 0;
    for (const PairId& v : settings_.vertices.first(std::min(kProbes, settings_.vertices.size()))) {
      const Vec3 x = overlay_.overlay.b.points[static_cast<std::size_t>(v.b)] -
                     overlay_.overlay.a.points[static_cast<std::size_t>(v.a)] + offset_;
      buffers_.probes.push_back({x, v.a, v.b});
      probe_reach_ = std::max(probe_reach_, norm1(x));
    }
  }

  /// The outward normal, in P, of a facet of one body.
  [[nodiscard]] Vec3 normal(bool of_a, int facet) const {
    const PosedDiagram::Facet& f = diagram(of_a).facets[static_cast<std::size_t>(facet)];
    const Vec3 n(f.normal[0], f.normal[1], f.normal[2]);
    return of_a ? Vec3(-n) : n;
  }
  /// A probe above this product with a facet's normal shows its plane to be farther than the bound.
  [[nodiscard]] double far_level(bool of_a, int facet, const Vec3& n) const {
    const double normal_error = diagram(of_a).normal_errors[static_cast<std::size_t>(facet)];
    const double n1 = norm1(n);
    const double product_error = (probe_reach_ * normal_error + n1 * point_error_ + 3 * point_error_ * normal_error +
                                  4 * kU * probe_reach_ * n1) *
                                     (1 + 16 * kU) +
                                 0x1p-900;
    const double longest = std::sqrt(n.squaredNorm()) * (1 + 8 * kU) + 2 * normal_error;
    return (search_.upper() * longest + product_error) * (1 + 8 * kU);
  }

  void mark_far_facets(bool of_a) {
    const int count = body(of_a).num_facets();
    buffers_.far_from.assign(static_cast<std::size_t>(count), -1);
    if (buffers_.probes.empty()) return;
    const int probes = static_cast<int>(buffers_.probes.size());
    int last = 0;  // neighbours in number are often neighbours in space
    for (int f = 0; f < count; ++f) {
      const Vec3 n = normal(of_a, f);
      const double level = far_level(of_a, f, n);
      if (!(probe(last).x.dot(n) > level)) {
        last = 0;
        double best = probe(0).x.dot(n);
        for (int k = 1; k < probes; ++k) {
          const double value = probe(k).x.dot(n);
          if (value > best) {
            best = value;
            last = k;
          }
        }
        if (!(best > level)) continue;
      }
      buffers_.far_from[static_cast<std::size_t>(f)] = last;
    }
  }

  [[nodiscard]] const DecompositionBuffers::Probe& probe(int k) const {
    return buffers_.probes[static_cast<std::size_t>(k)];
  }

  /// [A] step 1, for the facets of one body.
  void offer_facets(bool of_a) {
    int at = 0;
    for (int f = 0; f < body(of_a).num_facets(); ++f) {
      if (buffers_.far_from[static_cast<std::size_t>(f)] >= 0) continue;
      at = locate(of_a, f, start(of_a, f, at));
      const OverlayPiece piece = of_a ? OverlayPiece{OverlayPiece::Kind::facet_of_a, f, at}
                                      : OverlayPiece{OverlayPiece::Kind::facet_of_b, at, f};
      search_.consume(std::span<const OverlayPiece>(&piece, 1));
    }
  }

  /// Where the climb to the vertex of the other body that is extreme against a facet begins.
  [[nodiscard]] int start(bool of_a, int facet, int otherwise) const {
    if (buffers_.probes.empty()) return otherwise;
    const Vec3 n = normal(of_a, facet);
    const auto best = std::max_element(buffers_.probes.begin(), buffers_.probes.end(),
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

  /// The edges whose arcs no probe shows to be too far from end to end.
  void gather_edges(bool of_a) {
    const ConvexPolytope& own = body(of_a);
    buffers_.edges.clear();
    for (int h = 0; h < own.num_half_edges(); ++h) {
      const HalfEdge& e = own.half_edge(h);
      if (e.twin < h || (e.facet >= 0 && far_arc(of_a, e.facet, own.half_edge(e.twin).facet))) continue;
      buffers_.edges.push_back(h);
    }
  }

  [[nodiscard]] bool far_arc(bool of_a, int f, int g) const {
    const std::int32_t at_f = buffers_.far_from[static_cast<std::size_t>(f)];
    const std::int32_t at_g = buffers_.far_from[static_cast<std::size_t>(g)];
    if (at_f < 0 || at_g < 0) return false;
    if (at_f == at_g) return true;
    const Vec3 m = normal(of_a, f), n = normal(of_a, g);
    const double level_m = far_level(of_a, f, m), level_n = far_level(of_a, g, n);
    return std::any_of(buffers_.probes.begin(), buffers_.probes.end(),
                       [&](const auto& p) { return p.x.dot(m) > level_m && p.x.dot(n) > level_n; });
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
  DecompositionSearch(pair, settings, overlay, buffers).run(result);
  return result;
}

}  // namespace pd::detail
