#include "depth/polytope_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "depth/box_pair.hpp"
#include "depth/exact_expansion.hpp"
#include "depth/expansion.hpp"
#include "depth/facet_proof.hpp"
#include "depth/nearest.hpp"
#include "depth/surface_bound.hpp"

namespace pd::detail {

namespace {

/// Width of the bracket that doubles are asked for, in units of L: `Bracket::certified` less the last roundings.
constexpr double kCertifiedWidth = 1.8e-14;

/// Sizes outside this range are left to the exact engines, which rescale.
bool within_range(double reach) { return reach > 0x1p-100 && reach < 0x1p100; }

class PolytopeQuery {
 public:
  PolytopeQuery(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers, WarmCertificate* warm,
                PenetrationDepth& out)
      : pair_(pair),
        settings_(settings),
        buffers_(buffers),
        warm_(warm),
        out_(out),
        difference_(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b, buffers.posed) {}

  void solve() {
    const bool exactly = settings_.bracket == Bracket::tightest && settings_.delta == 0;
    bracket_ = exactly ? Bracket::tightest : Bracket::certified;
    if (settings_.method == Method::overlay) {
      solve_by_overlay();
      return;
    }
    if (!exactly && settings_.method == Method::automatic && solve_boxes()) return;
    out_.method = Method::expansion;
    ExpansionResult result;
    if (within_range(difference_.reach())) {
      result = expand();
      remember(result);
    }
    if (settings_.method == Method::decomposition && result.status != ExpansionStatus::separated) {
      solve_by_decomposition(result);
      return;
    }
    switch (result.status) {
      case ExpansionStatus::certified:
        if (!exactly) {
          fill_overlapping(result);
        } else if (!solve_by_proof(result)) {
          solve_overlapping_exactly(result);
        }
        return;
      case ExpansionStatus::separated:
        if (!fill_separated(result) || exactly) solve_exactly(result);
        return;
      case ExpansionStatus::over_budget:
        if (result.lower > 0) {
          solve_by_decomposition(result);
          return;
        }
        [[fallthrough]];
      default:
        if (solve_by_proof(result)) return;
        // A needle's first simplex may be flat to doubles although the bodies are far apart.
        if (result.face < 0 && within_range(difference_.reach()) && fill_separated(result) && !exactly) return;
        solve_exactly(result);
    }
  }

 private:
  ExpansionGoal goal() const {
    ExpansionGoal goal;
    goal.absolute = kCertifiedWidth;
    goal.relative = settings_.delta;
    goal.budget = difference_.budget();
    return goal;
  }

  /// Two boxes by their axes of separation. False when that does not decide the matter.
  bool solve_boxes() {
    const std::optional<BoxFrame> box_a = box_frame(*pair_.a);
    if (!box_a) return false;
    const std::optional<BoxFrame> box_b = box_frame(*pair_.b);
    if (!box_b || !within_range(difference_.reach())) return false;
    const BoxPairDepth boxes =
        box_pair_depth(*pair_.a, *box_a, *pair_.pose_a, *pair_.b, *box_b, *pair_.pose_b, kCertifiedWidth);
    out_.method = Method::overlay;
    out_.statistics.facets_visited += kBoxAxes;
    if (boxes.status == BoxPairStatus::separated) {
      ExpansionResult result;
      result.normal = boxes.normal;
      return fill_separated(result);
    }
    if (boxes.status == BoxPairStatus::undecided) return false;
    set_depth(boxes.lower, boxes.upper, boxes.normal);
    out_.witness_a = boxes.point_a + pair_.pose_a->translation() - pair_.margins.a * boxes.normal;
    out_.witness_b = out_.witness_a + out_.translation;
    out_.feature_a = boxes.feature_a;
    out_.feature_b = boxes.feature_b;
    return true;
  }

  ExpansionResult expand() {
    Expansion<PolytopeDifference> expansion(difference_, buffers_.surface, buffers_.stack);
    ExpansionResult result;
    bool answered = false;
    if (warm_ && restore()) {
      result = expansion.resume(goal());
      answered = result.status == ExpansionStatus::certified || result.status == ExpansionStatus::separated;
      out_.warm = answered;
    }
    if (!answered) {
      const Vec3 start = warm_ ? warm_->state().direction : Vec3(Vec3::Zero());
      result = expansion.run(start, goal());
    }
    out_.statistics.support_calls += expansion.support_calls();
    out_.statistics.facets_visited += expansion.facets_visited();
    return result;
  }

  /// Puts the last surface at the present poses. False when there is none for this pair.
  bool restore() {
    WarmCertificate::State& state = warm_->state();
    if (state.vertices_a != pair_.a->num_vertices() || state.vertices_b != pair_.b->num_vertices() ||
        state.radius_a != pair_.a->radius() || state.radius_b != pair_.b->radius()) {
      warm_->clear();
    }
    if (state.faces.empty()) return false;
    Surface& surface = buffers_.surface;
    surface.clear();
    for (const auto& v : state.vertices) surface.vertices.push_back(difference_.vertex(v.a, v.b));
    surface.restore(state.faces);
    return true;
  }

  void remember(const ExpansionResult& result) {
    if (!warm_) return;
    WarmCertificate::State& state = warm_->state();
    state.vertices_a = pair_.a->num_vertices();
    state.vertices_b = pair_.b->num_vertices();
    state.radius_a = pair_.a->radius();
    state.radius_b = pair_.b->radius();
    state.direction = result.normal;
    // A certificate that held as it stood is remembered already.
    if (out_.warm && result.status == ExpansionStatus::certified &&
        buffers_.surface.vertices.size() == state.vertices.size()) {
      return;
    }
    state.vertices.clear();
    state.faces.clear();
    // A closed triangulated surface of F faces has F / 2 + 2 vertices.
    state.vertices.reserve(kMaxCachedFaces / 2 + 2);
    state.faces.reserve(kMaxCachedFaces);
    if (result.status != ExpansionStatus::certified || buffers_.surface.size() > kMaxCachedFaces) return;
    buffers_.surface.save(state.vertices, state.faces);
  }

  // ---- answers from doubles -------------------------------------------------------------------------------------

  /// @param lower, upper  of the cores' depth.
  void set_depth(double lower, double upper, const Vec3& normal) {
    const double margin = pair_.margins.a + pair_.margins.b;
    out_.contact = ContactClass::overlapping;
    // The sums round once; |translation| exceeds its length by the rounding of three products.
    out_.lower = (lower + margin) * (1 - 0x1p-52);
    out_.upper = (upper + margin) * (1 + 0x1p-50);
    out_.depth = (upper + margin) * (1 + 0x1p-52);
    out_.normal = normal;
    out_.translation = out_.depth * normal;
  }

  void fill_overlapping(const ExpansionResult& result) {
    set_depth(result.lower, result.upper, result.normal);
    const SurfaceTriangle& face = buffers_.surface.face(face_below_origin(result.face, result.normal));
    DifferenceVertex corners[3];
    double weights[3];
    for (int i = 0; i < 3; ++i) corners[i] = buffers_.surface.vertices[face.v[i]];
    project(face, result.normal, weights);
    fill_witnesses(corners, weights, 3);
    out_.witness_b = out_.witness_a + out_.translation;
    out_.feature_a = feature(*pair_.a, corners, &DifferenceVertex::a);
    out_.feature_b = feature(*pair_.b, corners, &DifferenceVertex::b);
    pair_features();
  }

  /// Barycentric coordinates of the origin's projection on a face's plane.
  void project(const SurfaceTriangle& face, const Vec3& normal, double (&weights)[3]) const {
    const std::vector<DifferenceVertex>& v = buffers_.surface.vertices;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      weights[i] = normal.dot(v[face.v[(i + 1) % 3]].x.cross(v[face.v[(i + 2) % 3]].x));
      sum += weights[i];
    }
    for (double& w : weights) w /= sum;
  }

  /// Coplanar faces share a facet of P: steps from f across the edge that the projection lies beyond, while the
  /// neighbour is as near, until the projection lies inside.
  int face_below_origin(int f, const Vec3& normal) const {
    const Surface& surface = buffers_.surface;
    const double level = std::sqrt(std::max(0.0, surface.key(f))) + 64 * 0x1p-53 * difference_.reach();
    for (int step = 0; step < surface.size(); ++step) {
      double weights[3];
      project(surface.face(f), normal, weights);
      const int least = static_cast<int>(std::min_element(weights, weights + 3) - weights);
      if (weights[least] >= 0) return f;
      // weights[i] belongs to vertex i, whose opposite edge runs from vertex i + 1.
      const int next = surface.face(f).adj[(least + 1) % 3] >> 2;
      if (std::sqrt(std::max(0.0, surface.key(next))) > level) return f;
      f = next;
    }
    return f;
  }

  void fill_witnesses(const DifferenceVertex* corners, const double* weights, int count) {
    Vec3 a = Vec3::Zero();
    Vec3 b = Vec3::Zero();
    double total = 0;
    for (int i = 0; i < count; ++i) {
      const double w = std::max(0.0, weights[i]);
      a += w * pair_.a->vertex(corners[i].a);
      b += w * pair_.b->vertex(corners[i].b);
      total += w;
    }
    out_.witness_a = pair_.pose_a->apply(a / total) - pair_.margins.a * out_.normal;
    out_.witness_b = pair_.pose_b->apply(b / total) + pair_.margins.b * out_.normal;
  }

  /// The face of one body that a face of the surface uses: one, two or three of its vertices.
  static Feature feature(const ConvexPolytope& body, const DifferenceVertex (&corners)[3],
                         std::int32_t DifferenceVertex::*id) {
    std::int32_t ids[3] = {corners[0].*id, corners[1].*id, corners[2].*id};
    std::sort(ids, ids + 3);
    const int distinct = static_cast<int>(std::unique(ids, ids + 3) - ids);
    if (distinct == 1) return {Feature::Kind::vertex, ids[0], -1};
    if (distinct == 2) return {Feature::Kind::edge, ids[0], ids[1]};
    const int first = body.first_half_edge(ids[0]);
    for (int h = first; h < first + static_cast<int>(body.neighbours(ids[0]).size()); ++h) {
      const int f = body.half_edge(h).facet;
      if (f < 0) break;
      const auto loop = body.facet_vertices(f);
      if (std::find(loop.begin(), loop.end(), ids[1]) != loop.end() &&
          std::find(loop.begin(), loop.end(), ids[2]) != loop.end()) {
        return {Feature::Kind::facet, f, -1};
      }
    }
    return {Feature::Kind::vertex, ids[0], -1};
  }

  /// A facet's partner is a vertex, also where the two bodies' facets are parallel.
  void pair_features() {
    if (out_.feature_b.kind == Feature::Kind::facet && out_.feature_a.kind != Feature::Kind::vertex) {
      out_.feature_a = {Feature::Kind::vertex, first_vertex(*pair_.a, out_.feature_a), -1};
    } else if (out_.feature_a.kind == Feature::Kind::facet && out_.feature_b.kind != Feature::Kind::vertex) {
      out_.feature_b = {Feature::Kind::vertex, first_vertex(*pair_.b, out_.feature_b), -1};
    }
  }
  static std::int32_t first_vertex(const ConvexPolytope& body, const Feature& feature) {
    return feature.kind == Feature::Kind::facet ? body.facet_vertices(feature.first)[0] : feature.first;
  }

  /// False when doubles do not narrow the bracket enough or cannot tell the class.
  bool fill_separated(const ExpansionResult& result) {
    const double margin = pair_.margins.a + pair_.margins.b;
    // What is left after the margins may be far smaller than the cores' distance: no relative error of that would do.
    const double relative = margin > 0 ? 0.0 : settings_.delta;
    const DifferenceVertex first = difference_.support(result.normal, nullptr);
    const NearestResult nearest =
        nearest_point(difference_, first, relative, kCertifiedWidth, buffers_.stack, out_.statistics.support_calls);
    for (int i = 0; i < nearest.count; ++i) start_[i] = {nearest.simplex[i].a, nearest.simplex[i].b};
    start_count_ = nearest.count;
    if (!nearest.certified) return false;
    out_.normal = -nearest.point.normalized();
    const double round = 4 * 0x1p-53 * (nearest.upper + margin);
    if (margin > 0 && nearest.lower - margin <= round && nearest.upper - margin >= -round) return false;
    fill_witnesses(nearest.simplex, nearest.weights, nearest.count);
    DifferenceVertex corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = nearest.simplex[std::min(i, nearest.count - 1)];
    out_.feature_a = feature(*pair_.a, corners, &DifferenceVertex::a);
    out_.feature_b = feature(*pair_.b, corners, &DifferenceVertex::b);
    pair_features();
    if (nearest.lower > margin) {
      out_.contact = ContactClass::separated;
      out_.distance_lower = nearest.lower - margin - round;
      out_.distance_upper = nearest.upper - margin + round;
      out_.distance = std::clamp((out_.witness_a - out_.witness_b).norm(), out_.distance_lower, out_.distance_upper);
    } else {
      out_.contact = ContactClass::overlapping;
      out_.lower = margin - nearest.upper - round;
      out_.depth = margin - nearest.lower + round;
      out_.upper = out_.depth * (1 + 0x1p-50);
      out_.translation = out_.depth * out_.normal;
      out_.witness_b = out_.witness_a + out_.translation;
    }
    return true;
  }

  // ---- exact answers --------------------------------------------------------------------------------------------

  void solve_exactly(const ExpansionResult& result) {
    const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
    if (start_count_ > 0) {
      const auto proof = prove_separation(posed, std::span(start_).first(start_count_), buffers_.faces);
      if (proof && finish_apart(posed, *proof, buffers_.faces, pair_.margins, bracket_, out_)) {
        count_stages(posed);
        return;
      }
    } else {
      start_[0] = any_vertex(result);
      start_count_ = 1;
    }
    const ExactNearest nearest = exact_nearest(posed, start_, start_count_);
    if (nearest.apart) {
      finish_apart(posed, nearest, pair_.margins, out_);
    } else {
      finish_from(posed, nearest.simplex.data(), nearest.count, &nearest);
    }
    count_stages(posed);
  }

  /// The nearest face of the surface proved to lie in the nearest facet of P, mostly without big numbers. False where
  /// that fails.
  bool solve_by_proof(const ExpansionResult& result) {
    if (!(result.lower > 0) || result.face < 0) return false;
    // Keys err by the error of a point and of the distance itself; what lies beyond is certainly farther.
    const Surface& surface = buffers_.surface;
    const double error = difference_.point_error() + 8 * 0x1p-53 * difference_.reach();
    const double limit = result.lower + 8 * error;
    std::array<SurfaceCorners, kMaxNearFaces> near;
    std::size_t count = 0;
    const auto add = [&](int f) {
      for (int i = 0; i < 3; ++i) {
        const DifferenceVertex& v = surface.vertices[surface.face(f).v[i]];
        near[count].v[i] = {v.a, v.b};
      }
      ++count;
    };
    add(result.face);
    for (int f = 0; f < surface.slots(); ++f) {
      if (f == result.face || !(surface.key(f) <= limit * limit)) continue;
      if (count == near.size()) return false;
      add(f);
    }
    const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
    const double beyond = std::ldexp(limit - 2 * error, -posed.scale_exponent());
    const auto proven = prove_nearest_facet(posed, std::span(near).first(count), beyond, buffers_.faces);
    if (proven) {
      finish_overlapping(posed, proven->facet, proven->plane, buffers_.faces, pair_.margins, bracket_, out_);
    }
    count_stages(posed);
    return proven.has_value();
  }

  void solve_overlapping_exactly(const ExpansionResult& result) {
    const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
    PairId seed[3];
    for (int i = 0; i < 3; ++i) {
      const DifferenceVertex& v = buffers_.surface.vertices[buffers_.surface.face(result.face).v[i]];
      seed[i] = {v.a, v.b};
    }
    finish_from(posed, seed, 3, nullptr);
    count_stages(posed);
  }

  /// The origin is known to lie in P.
  void finish_from(const PosedPair& posed, const PairId* seed, int count, const ExactNearest* nearest) {
    const ExactDepth exact = exact_expansion(posed, seed, count, 4 * difference_.budget());
    out_.statistics.support_calls += exact.support_calls;
    out_.statistics.facets_visited += exact.facets_visited;
    if (!exact.complete) {
      solve_by_overlay();
    } else if (exact.contact == ContactClass::overlapping) {
      finish_overlapping(posed, facet_of_direction(posed, *exact.normal), pair_.margins, bracket_, buffers_.faces,
                         out_);
    } else {
      finish_touching(posed, *exact.normal, *nearest, pair_.margins, out_);
    }
  }

  /// @param upper  of the cores' depth.
  void solve_by_overlay(double upper = std::numeric_limits<double>::infinity()) {
    const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
    out_.method = Method::overlay;
    const OverlayDepth overlay = overlay_depth(posed, buffers_.overlay, bracket_ == Bracket::tightest,
                                               std::ldexp(upper, -posed.scale_exponent()));
    finish_nearest(posed, overlay);
  }

  /// [A] section 2, under the bound that the expansion leaves and with the vertices of P that it found.
  void solve_by_decomposition(const ExpansionResult& result) {
    const PosedPair posed(*pair_.a, *pair_.pose_a, *pair_.b, *pair_.pose_b);
    out_.method = Method::decomposition;
    if (!(result.lower > 0)) {
      const PairId any = any_vertex(result);
      const ExactNearest nearest = exact_nearest(posed, &any, 1);
      if (nearest.apart) {
        finish_apart(posed, nearest, pair_.margins, out_);
        count_stages(posed);
        return;
      }
    }
    DecompositionBuffers& buffers = buffers_.decomposition;
    buffers.vertices.clear();
    if (within_range(difference_.reach())) {
      for (const DifferenceVertex& v : buffers_.surface.vertices) buffers.vertices.push_back({v.a, v.b});
    }
    DecompositionSettings settings;
    if (result.lower > 0) {
      const double height = least_height(difference_, buffers_.surface, buffers_.stack, out_.statistics.support_calls);
      settings.upper = std::ldexp(std::min(result.upper, height), -posed.scale_exponent());
    }
    settings.vertices = buffers.vertices;
    settings.seed = settings_.seed;
    settings.exactly = bracket_ == Bracket::tightest;
    settings.may_enumerate = settings_.method != Method::decomposition;
    const DecompositionDepth found = decomposition_depth(posed, settings, buffers_.overlay, buffers);
    if (found.enumerated) out_.method = Method::overlay;
    out_.statistics.pair_evaluations += found.lines.pair_evaluations;
    out_.statistics.block_bounds += found.lines.block_bounds;
    out_.statistics.lines_scanned += found.lines.lines_scanned;
    finish_nearest(posed, found.nearest);
  }

  void finish_nearest(const PosedPair& posed, const OverlayDepth& found) {
    out_.statistics.facets_visited += found.facets_visited;
    out_.statistics.exact_signs += found.exact_comparisons;
    if (found.contact == ContactClass::overlapping) {
      finish_overlapping(posed, found.facet, pair_.margins, bracket_, buffers_.faces, out_);
    } else {
      const PairId any{0, 0};
      const ExactNearest nearest = exact_nearest(posed, &any, 1);
      if (nearest.apart) {
        finish_apart(posed, nearest, pair_.margins, out_);
      } else if (found.has_facet) {
        finish_touching(posed, normal_of(posed, found.facet), nearest, pair_.margins, out_);
      } else {
        const ExactDepth flat = exact_expansion(posed, &any, 1, std::numeric_limits<int>::max());
        finish_touching(posed, *flat.normal, nearest, pair_.margins, out_);
      }
    }
    count_stages(posed);
  }

  static ExactDirection normal_of(const PosedPair& posed, const FacetOfDifference& facet) {
    return ExactDirection(cross(posed.exact(facet.u), posed.exact(facet.v)));
  }

  PairId any_vertex(const ExpansionResult& result) const {
    if (!within_range(difference_.reach())) return {0, 0};
    const DifferenceVertex s = difference_.support(result.normal, nullptr);
    return {s.a, s.b};
  }

  /// The finishing step itself decides one sign exactly.
  void count_stages(const PosedPair& posed) {
    out_.statistics.exact_signs += 1 + posed.stages().double_double + posed.stages().exact;
  }

  static constexpr int kMaxCachedFaces = 128;
  static constexpr int kBoxAxes = 15;
  /// More faces that may be nearest are left to exact arithmetic.
  static constexpr std::size_t kMaxNearFaces = 16;

  const PolytopePair& pair_;
  const DepthSettings& settings_;
  ScratchBuffers& buffers_;
  WarmCertificate* warm_;
  PenetrationDepth& out_;
  PolytopeDifference difference_;
  Bracket bracket_ = Bracket::tightest;
  PairId start_[4];
  int start_count_ = 0;
};

}  // namespace

void polytope_depth(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers,
                    WarmCertificate* warm, PenetrationDepth& out) {
  PolytopeQuery(pair, settings, buffers, warm, out).solve();
}

}  // namespace pd::detail
