#include "depth/facets/near_facets.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "numeric/unit_roundoff.hpp"
#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

using Edge = NearFacetsBuffers::Edge;
using Candidate = NearFacetsBuffers::Candidate;
using Kind = NearFacetsBuffers::Kind;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// |error| of each coordinate of an edge's direction: as of LineTree's.
constexpr double kDirectionError = 16 * kUnitRoundoff;
/// |error| of a unit direction's product with a facet's normal, turned by a rounded matrix: below 100u.
constexpr double kSideError = 0x1p-46;
/// |n - exact| of a facet's unit normal: a few u as it is stored, 6u a coordinate for the turn, 4u for the length.
constexpr double kNormalError = 24 * kUnitRoundoff;
/// Two edges whose sine is below this are parallel up to rounding.
constexpr double kParallelEdges = 0x1p-40;
/// Pairs of edges, for each edge of both bodies, that may be tried; beyond that the overlay is cheaper.
constexpr std::int64_t kPairsPerEdge = 256;

class NearFacetsSearch {
 public:
  NearFacetsSearch(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                   const PolytopeDifference& difference, const InnerSurface& surface,
                   const NearFacetsSettings& settings, std::vector<std::int32_t>& stack, NearFacetsBuffers& buffers)
      : a_(a),
        b_(b),
        pose_a_(pose_a),
        pose_b_(pose_b),
        difference_(difference),
        surface_(surface),
        settings_(settings),
        stack_(stack),
        buffers_(buffers),
        reach_(difference.reach()),
        radius_(settings.upper / reach_),
        known_(settings.lower / reach_) {}

  NearFacets run() {
    if (a_.affine_dimension() != 3 || b_.affine_dimension() != 3) return out_;
    buffers_.candidates.clear();
    for (const bool of_a : {true, false}) {
      find_near_arcs({body(of_a), pose(of_a), body(!of_a), pose(!of_a), of_a}, difference_, surface_, radius_,
                     arcs(of_a));
    }
    const auto pairs = static_cast<std::int64_t>(buffers_.near_a.kept.size() * buffers_.near_b.kept.size());
    const std::int64_t edges = a_.num_edges() + b_.num_edges();
    if (pairs > kPairsPerEdge * edges) return out_;
    if (!measure_facets(true, edges) || !measure_facets(false, edges)) return out_;
    if (!place_edges(true) || !place_edges(false)) return out_;
    out_.pairs = pairs;
    if (!try_pairs()) return out_;
    choose();
    return out_;
  }

 private:
  [[nodiscard]] const ConvexPolytope& body(bool of_a) const { return of_a ? a_ : b_; }
  [[nodiscard]] const Pose& pose(bool of_a) const { return of_a ? pose_a_ : pose_b_; }
  [[nodiscard]] NearArcs& arcs(bool of_a) const { return of_a ? buffers_.near_a : buffers_.near_b; }

  /// [A] step 1 for the facets of one body that no test point shows too far. False when there are too many.
  bool measure_facets(bool of_a, std::int64_t edges) {
    const std::vector<std::uint32_t>& far = arcs(of_a).far;
    const auto near = std::count(far.begin(), far.end(), 0U);
    if (near > 16 + edges / 4) return false;
    if (near == 0) return true;
    const Mat3 turn = normal_matrix(pose(of_a)) * (of_a ? -1 : 1);
    for (std::size_t f = 0; f < far.size(); ++f) {
      if (far[f] != 0) continue;
      const auto facet = static_cast<std::int32_t>(f);
      const Vec3 n = (turn * body(of_a).facet_normal(facet)).normalized();
      const DifferenceVertex s = support(n);
      const double height = s.x.dot(n);
      const double lower = (height - lower_error()) / reach_ - kNormalError;
      if (lower > radius_) continue;
      const double upper = (height + bound_error()) / reach_;
      buffers_.candidates.push_back(
          {of_a ? Kind::facet_of_a : Kind::facet_of_b, true, of_a ? facet : s.a, of_a ? s.b : facet, lower, upper, n});
      radius_ = std::min(radius_, upper);
      ++out_.facets;
    }
    return true;
  }

  DifferenceVertex support(const Vec3& n) {
    ++out_.support_calls;
    return difference_.certified_support(n, difference_.support(n, nullptr), stack_);
  }

  /// False for an edge too short for doubles.
  bool place_edges(bool of_a) {
    const ConvexPolytope& own = body(of_a);
    const Mat3& turn = pose(of_a).rotation();
    const Mat3 turn_normals = normal_matrix(pose(of_a));
    // Relative to one vertex of A, so that points of B are points of P and those of A differences of two.
    const Vec3 start = a_.vertex(0);
    const Vec3 shift = of_a ? Vec3::Zero() : Vec3(difference_.offset() - pose_a_.rotation() * start);
    const std::vector<std::int32_t>& kept = arcs(of_a).kept;
    std::vector<Edge>& edges = of_a ? buffers_.edges_a : buffers_.edges_b;
    edges.resize(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const HalfEdge e = own.half_edge(kept[i]);
      const HalfEdge back = own.half_edge(e.twin);
      const Vec3 from = own.vertex(e.origin);
      const Vec3 vector = turn * (own.vertex(back.origin) - from);
      const double length = vector.norm();
      if (!(length > 0x1p-200)) return false;
      edges[i] = {vector / length,
                  turn_normals * own.facet_normal(e.facet),
                  turn_normals * own.facet_normal(back.facet),
                  (turn * (of_a ? Vec3(from - start) : from) + shift) / reach_,
                  length / reach_,
                  e.origin,
                  back.origin};
    }
    return true;
  }

  // ---- [A] step 2 -------------------------------------------------------------------------------------------------

  /// False where two edges are too nearly parallel for doubles, and what their near-degenerate parallelograms hide is
  /// too much.
  bool try_pairs() {
    const std::size_t count = buffers_.edges_a.size();
    if (count == 0 || buffers_.edges_b.empty()) return true;
    const auto padded = static_cast<std::size_t>(padded_to_lines(static_cast<int>(count)));
    LineArrays lines;
    lines.count = static_cast<int>(count);
    for (std::size_t k = 0; k < 6; ++k) {
      buffers_.lines_a[k].resize(padded);
      std::fill(buffers_.lines_a[k].begin() + static_cast<std::ptrdiff_t>(count), buffers_.lines_a[k].end(), 0.0);
      lines.coordinates[k] = buffers_.lines_a[k].data();
    }
    double largest = 0;
    for (std::size_t j = 0; j < count; ++j) {
      const Edge& e = buffers_.edges_a[j];
      const Vec3 m = e.point.cross(e.direction);
      largest = std::max(largest, m.squaredNorm());
      for (std::size_t k = 0; k < 3; ++k) {
        buffers_.lines_a[k][j] = m[static_cast<Eigen::Index>(k)];
        buffers_.lines_a[k + 3][j] = e.direction[static_cast<Eigen::Index>(k)];
      }
    }
    // Points of B lie within 1, so that a line's coordinates have at most the length sqrt(2).
    rounding_ = 0x1p-46 * std::sqrt(2 * (1 + largest)) * (1 + 0x1p-40);
    buffers_.near.resize(padded / kLineBlock);
    for (std::size_t i = 0; i < buffers_.edges_b.size(); ++i) {
      const Edge& e = buffers_.edges_b[i];
      const Vec3 m = e.point.cross(e.direction);
      lines_near(lines, {e.direction.x(), e.direction.y(), e.direction.z(), m.x(), m.y(), m.z()}, radius_, rounding_,
                 buffers_.near.data());
      for (std::size_t word = 0; word < buffers_.near.size(); ++word) {
        for (std::uint64_t bits = buffers_.near[word]; bits != 0; bits &= bits - 1) {
          const std::size_t j = kLineBlock * word + static_cast<std::size_t>(std::countr_zero(bits));
          if (!try_pair(static_cast<std::int32_t>(j), static_cast<std::int32_t>(i))) return false;
        }
      }
    }
    return true;
  }

  bool try_pair(std::int32_t j, std::int32_t i) {
    const Edge& a = buffers_.edges_a[static_cast<std::size_t>(j)];
    const Edge& b = buffers_.edges_b[static_cast<std::size_t>(i)];
    // As in arc_crossing.hpp: with n = s (b x a) the arcs cross where all four have the sign of s.
    const double sides[4] = {a.direction.dot(b.left), -a.direction.dot(b.right), b.direction.dot(a.left),
                             -b.direction.dot(a.right)};
    const double least = std::min(std::min(sides[0], sides[1]), std::min(sides[2], sides[3]));
    const double most = std::max(std::max(sides[0], sides[1]), std::max(sides[2], sides[3]));
    if (least < -kSideError && most > kSideError) return true;
    const Vec3 across = b.direction.cross(a.direction);
    const double sine = across.norm();
    if (sine < kParallelEdges) {
      if (distance_of_degenerate(a, b) > radius_) return true;
      hidden_ += (sine + 2 * kDirectionError) * std::min(a.length, b.length);
      return hidden_ <= kHiddenShare * settings_.width;
    }
    // The normal errs by an angle of at most phi, by which the distance errs as closest_lines.cpp derives.
    const double phi = (8 * kDirectionError + 16 * kUnitRoundoff) / sine;
    const Vec3 w = b.point - a.point;
    const double along = w.dot(across) / sine;
    const double distance = std::abs(along);
    const double error = 1.01 * phi * (w.cross(across).norm() / sine + phi * distance) + 48 * kUnitRoundoff;
    // Not as near as asked, or nearer than any facet of P is.
    if (distance - error > radius_ || distance + error < known_) return true;
    const bool certain = least > kSideError || most < -kSideError;
    buffers_.candidates.push_back(
        {Kind::edges, certain, j, i, distance - error, distance + error, across * ((along > 0 ? 1 : -1) / sine)});
    if (certain) radius_ = std::min(radius_, distance + error);
    ++out_.facets;
    return true;
  }

  /// Lower bound of the distance of two nearly parallel edges' parallelogram: along the unit vector to the point
  /// nearest to the origin of the segment that it nearly is.
  double distance_of_degenerate(const Edge& a, const Edge& b) const {
    Vec3 corners[4];
    int count = 0;
    for (const std::int32_t va : {a.from, a.to}) {
      for (const std::int32_t vb : {b.from, b.to}) corners[count++] = difference_.vertex(va, vb).x;
    }
    double first = kInfinity, last = -kInfinity;
    for (const Vec3& x : corners) {
      first = std::min(first, x.dot(b.direction));
      last = std::max(last, x.dot(b.direction));
    }
    const Vec3 across = corners[0] - corners[0].dot(b.direction) * b.direction;
    const Vec3 nearest = across + std::clamp(0.0, first, last) * b.direction;
    const double length = nearest.norm();
    if (!(length > 0)) return 0;
    double least = kInfinity;
    for (const Vec3& x : corners) least = std::min(least, x.dot(nearest) / length);
    return (least - lower_error()) / reach_;
  }

  // ---- the nearest of the candidates ------------------------------------------------------------------------------

  void choose() {
    std::vector<Candidate>& candidates = buffers_.candidates;
    std::erase_if(candidates, [&](const Candidate& c) { return c.lower > radius_; });
    // The distance of a parallelogram is at least that of its nearest corner along any unit vector.
    for (Candidate& c : candidates) {
      if (c.kind == Kind::edges) c.lower = std::max(c.lower, (least_corner(c) - lower_error()) / reach_);
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
      return std::tuple(x.lower, x.kind, x.a, x.b) < std::tuple(y.lower, y.kind, y.a, y.b);
    });
    double lower = kInfinity;
    double upper = kInfinity;
    for (Candidate& c : candidates) {
      if (c.lower >= std::min(upper, lower + settings_.width)) break;
      const double height =
          c.kind == Kind::edges ? support(c.normal).x.dot(c.normal) + bound_error() : c.upper * reach_;
      if (!c.certain && height - 2 * bound_error() > reach_ * (c.upper + turn_error(c))) {
        c.lower = kInfinity;  // no facet of P
        continue;
      }
      lower = std::min(lower, c.lower);
      if (height / reach_ < upper && lies_below_origin(c, height)) {
        upper = height / reach_;
        out_.upper = height;
        out_.normal = c.normal;
      }
      if (upper - lower + hidden_ <= settings_.width) break;
    }
    if (hidden_ == 0 && upper < kInfinity) list_nearest(std::min(upper, radius_));
    lower -= hidden_;
    out_.lower = lower * reach_ * (1 - 4 * kUnitRoundoff);
    out_.certified = lower > 0 && upper < kInfinity && out_.upper - out_.lower <= settings_.width * reach_;
  }

  void list_nearest(double beyond) {
    buffers_.nearest.clear();
    for (const Candidate& c : buffers_.candidates) {
      if (c.lower <= beyond) buffers_.nearest.push_back(corners(c));
    }
    out_.beyond = beyond * reach_ * (1 - 4 * kUnitRoundoff);
  }

  [[nodiscard]] SurfaceCorners corners(const Candidate& c) const {
    if (c.kind == Kind::edges) {
      const Edge& a = buffers_.edges_a[static_cast<std::size_t>(c.a)];
      const Edge& b = buffers_.edges_b[static_cast<std::size_t>(c.b)];
      return {{{a.from, b.from}, {a.to, b.from}, {a.from, b.to}}};
    }
    const bool of_a = c.kind == Kind::facet_of_a;
    const auto loop = body(of_a).facet_vertices(of_a ? c.a : c.b);
    SurfaceCorners out;
    for (std::size_t k = 0; k < 3; ++k) out.v[k] = of_a ? VertexPair{loop[k], c.b} : VertexPair{c.a, loop[k]};
    return out;
  }

  /// By how much h_P may differ between the computed normal and the exact one, divided by the reach.
  [[nodiscard]] double turn_error(const Candidate& c) const {
    const Edge& a = buffers_.edges_a[static_cast<std::size_t>(c.a)];
    const Edge& b = buffers_.edges_b[static_cast<std::size_t>(c.b)];
    return (8 * kDirectionError + 16 * kUnitRoundoff) / b.direction.cross(a.direction).norm();
  }

  [[nodiscard]] double least_corner(const Candidate& c) {
    const Edge& a = buffers_.edges_a[static_cast<std::size_t>(c.a)];
    const Edge& b = buffers_.edges_b[static_cast<std::size_t>(c.b)];
    double least = kInfinity;
    for (const std::int32_t va : {a.from, a.to}) {
      for (const std::int32_t vb : {b.from, b.to}) {
        least = std::min(least, difference_.vertex(va, vb).x.dot(c.normal));
      }
    }
    return least;
  }

  /// Whether the piece holds the point below the origin, and where.
  bool lies_below_origin(const Candidate& c, double height) {
    return c.kind == Kind::edges ? below_edges(c) : below_facet(c, height);
  }

  bool below_edges(const Candidate& c) {
    const Edge& a = buffers_.edges_a[static_cast<std::size_t>(c.a)];
    const Edge& b = buffers_.edges_b[static_cast<std::size_t>(c.b)];
    const Vec3 w = b.point - a.point;
    const double t = a.direction.dot(b.direction);
    const double on_a = w.dot(a.direction), on_b = w.dot(b.direction);
    const double squared = a.direction.cross(b.direction).squaredNorm();
    const double along_a = (on_a - t * on_b) / squared;
    const double along_b = (t * on_a - on_b) / squared;
    if (along_a < -kInside || along_a > a.length + kInside || along_b < -kInside || along_b > b.length + kInside) {
      return false;
    }
    out_.kind = Kind::edges;
    out_.edge_a[0] = a.from;
    out_.edge_a[1] = a.to;
    out_.edge_b[0] = b.from;
    out_.edge_b[1] = b.to;
    out_.along_a = std::clamp(along_a / a.length, 0.0, 1.0);
    out_.along_b = std::clamp(along_b / b.length, 0.0, 1.0);
    return true;
  }

  /// The other body's vertex, moved by the translation, must lie inside the facet.
  bool below_facet(const Candidate& c, double height) {
    const bool of_a = c.kind == Kind::facet_of_a;
    const std::int32_t facet = of_a ? c.a : c.b;
    const std::int32_t vertex = of_a ? c.b : c.a;
    const auto loop = body(of_a).facet_vertices(facet);
    const Vec3 projection = height * c.normal;
    const auto corner = [&](std::size_t k) {
      return of_a ? difference_.vertex(loop[k], vertex).x : difference_.vertex(vertex, loop[k]).x;
    };
    // Seen from outside P, the corners of -A run clockwise.
    Vec3 last = corner(loop.size() - 1);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 next = corner(k);
      const Vec3 side = next - last;
      if ((of_a ? -1 : 1) * c.normal.dot(side.cross(projection - last)) < -kInside * reach_ * side.norm()) return false;
      last = next;
    }
    out_.kind = c.kind;
    out_.facet = facet;
    out_.vertex = vertex;
    return true;
  }

  [[nodiscard]] double lower_error() const { return face_error(difference_); }
  [[nodiscard]] double bound_error() const { return support_plane_error(difference_); }

  /// Near-degenerate parallelograms may take this share of the width.
  static constexpr double kHiddenShare = 0.125;
  /// A projection beyond a piece's border by no more than this, in units of the reach, is rounding.
  static constexpr double kInside = 64 * kUnitRoundoff;

  const ConvexPolytope& a_;
  const ConvexPolytope& b_;
  const Pose& pose_a_;
  const Pose& pose_b_;
  const PolytopeDifference& difference_;
  const InnerSurface& surface_;
  const NearFacetsSettings& settings_;
  std::vector<std::int32_t>& stack_;
  NearFacetsBuffers& buffers_;
  double reach_;
  double radius_;  ///< no piece farther than this is wanted; divided by the reach, as all lengths below
  double known_;
  double rounding_ = 0;
  double hidden_ = 0;  ///< the width of all near-degenerate parallelograms together
  NearFacets out_;
};

}  // namespace

NearFacets nearest_of_near_facets(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                  const Pose& pose_b, const PolytopeDifference& difference, const InnerSurface& surface,
                                  const NearFacetsSettings& settings, std::vector<std::int32_t>& stack,
                                  NearFacetsBuffers& buffers) {
  return NearFacetsSearch(a, pose_a, b, pose_b, difference, surface, settings, stack, buffers).run();
}

}  // namespace pd::detail
