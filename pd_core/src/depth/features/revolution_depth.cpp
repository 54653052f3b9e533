#include "depth/features/revolution_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "depth/features/edge_arc.hpp"
#include "depth/features/revolution_kernels.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

/// Of more facets or vertices an expanding polytope looks at a few only, and is faster.
constexpr int kMostRevolutionFacets = 128;
/// Directions that arcs may look at.
constexpr int kMostTouches = 64;
/// A posed normal errs by 12u, with it the height of a point as far away as P reaches; products, sums and roots err by
/// less than 20u of the reach.
constexpr double kPlaceHeightError = 40 * kUnitRoundoff;
/// Of the reach: how far feet may lie outside a face by rounding.
constexpr double kFootOutside = 1e-12;
/// Of the bracket that is asked for: what an arc may leave open.
constexpr double kShareOfArcs = 0.25;

struct RevolvedCoreOf {
  Vec3 axis;

  std::optional<RevolvedCore> operator()(const Cylinder& c) const {
    return RevolvedCore{axis, c.radius, c.half_height, false, 0};
  }
  std::optional<RevolvedCore> operator()(const Cone& c) const {
    const double height = 2 * c.half_height;
    const double slant = std::sqrt(c.radius * c.radius + height * height);
    return RevolvedCore{axis, c.radius, c.half_height, true, c.radius / slant};
  }
  template <class Other>
  std::optional<RevolvedCore> operator()(const Other& /*none*/) const {
    return std::nullopt;
  }
};

int axis_of_core(const ConvexShape::Core& core) {
  if (const auto* cylinder = std::get_if<Cylinder>(&core)) return cylinder->axis;
  if (const auto* cone = std::get_if<Cone>(&core)) return cone->axis;
  return -1;
}

class RevolutionSearch {
 public:
  RevolutionSearch(const ConvexPolytope& polytope, int of, const RevolvedCore& core, const SmoothDifference& difference)
      : polytope_(polytope),
        difference_(difference),
        of_(of),
        sense_(of == 1 ? 1 : -1),
        core_(core),
        rotation_(difference.rotation_of(of)),
        error_(kPlaceHeightError * difference.reach()),
        posed_(posed(polytope, rotation_, sense_, difference.offset())) {}

  std::optional<RevolutionDepth> run(double relative, double width, std::int64_t& support_calls) {
    look_across_facets();
    look_across_discs();
    if (least_.height < -error_) return apart();
    if (!(least_.height > 2 * error_)) return std::nullopt;
    floor_ = least_.height;
    const double slack = kShareOfArcs * std::max(width, relative * least_.height);
    look_along_edges(slack);
    if (least_.height < -error_) return apart();
    if (!(floor_ > 0)) return std::nullopt;
    look_across_vertices();
    if (least_.height < -error_) return apart();
    RevolutionDepth out;
    out.normal = least_.normal;
    // One for rounding, one for discs that are lower than a facet by less than that.
    out.lower = std::min(floor_, least_.height) - 2 * error_;
    if (!(out.lower > 0)) return std::nullopt;
    ++support_calls;
    out.touched = difference_.support(out.normal, nullptr).x;
    out.upper = out.touched.dot(out.normal) + support_plane_error(difference_);
    out.lower = std::min(out.lower, out.upper);
    if (!(out.upper - out.lower <= std::max(width, relative * out.lower))) return std::nullopt;
    const std::optional<Vec3> point = foot();
    if (!point) return std::nullopt;
    out.on_a = *point;
    return out;
  }

 private:
  enum class Place : unsigned char { facet, disc, edge, vertex };

  /// V's matrix is a rotation up to rounding only: its cofactors turn normals.
  static PosedPolytope posed(const ConvexPolytope& polytope, const Mat3& r, double sense, const Vec3& offset) {
    PosedPolytope out{polytope.storage(), {}, {}, 0, {offset.x(), offset.y(), offset.z()}};
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
      for (int c = 0; c < 3; ++c) {
        const int d = c == 2 ? 0 : c + 1, e = c == 0 ? 2 : c - 1;
        out.matrix[3 * i + c] = sense * r(i, c);
        out.cofactors[3 * i + c] = sense * (r(j, d) * r(k, e) - r(j, e) * r(k, d));
      }
    }
    out.determinant = sense * (r(0, 0) * out.cofactors[0] + r(0, 1) * out.cofactors[1] + r(0, 2) * out.cofactors[2]);
    return out;
  }

  [[nodiscard]] std::optional<RevolutionDepth> apart() const {
    RevolutionDepth out;
    out.normal = least_.normal;
    out.is_apart = true;
    return out;
  }

  /// A vertex of V.
  [[nodiscard]] Vec3 point(int vertex) const {
    return sense_ * (rotation_ * polytope_.vertex(vertex)) + difference_.offset();
  }

  void take(const LeastHeight& found, Place place, int index) {
    least_ = found;
    place_ = place;
    index_ = index;
  }

  void look_across_facets() {
    double height = 0;
    const int f = facet_touches(posed_, core_, facets_.data(), height);
    take({height, Vec3::Map(facets_[static_cast<std::size_t>(f)].normal), false}, Place::facet, f);
  }

  /// V's centre shows most of them to be high enough.
  void look_across_discs() {
    centre_ = sense_ * (rotation_ * polytope_.centre()) + difference_.offset();
    const double along = centre_.dot(core_.axis);
    for (const double side : {1.0, -1.0}) {
      if ((core_.pointed && side > 0) || side * along + core_.half_height >= least_.height) continue;
      const Vec3 normal = side * core_.axis;
      const int vertex = support_vertex(polytope_, rotation_.transpose() * (sense_ * normal), -1);
      const double height = point(vertex).dot(normal) + core_.half_height;
      // A facet that lies flush on it has come first.
      if (height < least_.height - error_) take({height, normal, false}, Place::disc, vertex);
    }
  }

  /// The core holds the origin: of two facets of V that lie no nearer than P does, the edge's own points show its arc
  /// to be high enough. So only edges of nearer facets are looked at.
  void look_along_edges(double slack) {
    int touches_left = kMostTouches;
    const double reach = least_.height;
    for (int f = 0; f < polytope_.num_facets(); ++f) {
      if (facets_[static_cast<std::size_t>(f)].level >= reach) continue;
      const int first = polytope_.facet_half_edge(f);
      int h = first;
      do {
        const HalfEdge& edge = polytope_.half_edge(h);
        const int beyond = polytope_.half_edge(edge.twin).facet;
        const bool seen = beyond < f && facets_[static_cast<std::size_t>(beyond)].level < reach;
        if (!seen) look_along_edge(std::min(h, edge.twin), slack, touches_left);
        if (!(floor_ > 0)) return;
        h = edge.next;
      } while (h != first);
    }
  }

  void look_along_edge(int h, double slack, int& touches_left) {
    const HalfEdge &edge = polytope_.half_edge(h), &back = polytope_.half_edge(edge.twin);
    const FacetTouch& left = facets_[static_cast<std::size_t>(edge.facet)];
    const FacetTouch& right = facets_[static_cast<std::size_t>(back.facet)];
    const double cosine =
        left.normal[0] * right.normal[0] + left.normal[1] * right.normal[1] + left.normal[2] * right.normal[2];
    // The one facet's point, as far as it goes across the other.
    const double left_across_right = right.level + left.rise * cosine + left.shift * right.along;
    if (std::min(left.height, left_across_right) >= least_.height) return;
    const double right_across_left = left.level + right.rise * cosine + right.shift * left.along;
    if (std::min(right.height, right_across_left) >= least_.height) return;
    LeastHeight found = least_;
    const Vec3 along = rotation_ * (polytope_.vertex(back.origin) - polytope_.vertex(edge.origin));
    EdgeArc arc(core_, point(edge.origin), along, Vec3::Map(left.normal), Vec3::Map(right.normal));
    floor_ = std::min(floor_, arc.search(slack, touches_left, found));
    if (found.height < least_.height) take(found, Place::edge, h);
  }

  /// 4. of the file's comment.
  void look_across_vertices() {
    const double steep = std::sqrt(1 - core_.kink * core_.kink);
    const double added = core_.pointed ? core_.half_height * core_.kink : core_.radius;
    const double along = centre_.dot(core_.axis);
    if (core_.kink * along - steep * (centre_ - along * core_.axis).norm() + added >= least_.height) return;
    const double greatest = vertex_circles(posed_, core_, circles_.data());
    if (greatest + added >= least_.height) return;
    for (int v = 0; v < polytope_.num_vertices(); ++v) {
      if (circles_[static_cast<std::size_t>(v)] >= greatest - 4 * error_) {
        look_across_vertex(v, greatest + added, steep, added);
      }
    }
  }

  /// A vertex of the greatest of those least values.
  void look_across_vertex(int v, double value, double steep, double added) {
    const Vec3 x = point(v);
    const Vec3 aside = x - x.dot(core_.axis) * core_.axis;
    const double length = aside.norm();
    if (!(length > 0x1p-20 * difference_.reach())) {
      // Where the vertex lies on the axis, all directions of the circle are tied.
      floor_ = -std::numeric_limits<double>::infinity();
      return;
    }
    const Vec3 normal = core_.kink * core_.axis - (steep / length) * aside;
    const int farthest = support_vertex(polytope_, rotation_.transpose() * (sense_ * normal), -1);
    const double height = point(farthest).dot(normal) + added;
    if (height - value > 8 * error_) return;  // another vertex lies farther out: no minimum of h
    floor_ = std::min(floor_, value);
    if (height < least_.height) take({height, normal, true}, Place::vertex, v);
  }

  /// The foot of the origin, as a point of A.
  [[nodiscard]] std::optional<Vec3> foot() const {
    const Vec3 foot = least_.height * least_.normal;
    std::optional<Vec3> on_core;
    switch (place_) {
      case Place::facet:
        on_core = foot_on_facet(foot);
        break;
      case Place::disc:
        on_core = foot_on_disc(foot);
        break;
      case Place::edge:
        on_core = foot_on_edge(foot);
        break;
      case Place::vertex:
        on_core = foot - point(index_);
        if (std::abs(on_core->dot(core_.axis)) > core_.half_height + outside()) return std::nullopt;
        break;
    }
    if (!on_core) return std::nullopt;
    // P = B - A, where V has the offset. What is left of Newton's method lies across the edge, and B's point has it.
    if (of_ == 1) return Vec3(-*on_core);
    const Vec3 on_polytope = foot - *on_core;
    return Vec3(difference_.offset() - (place_ == Place::edge ? nearest_on_edge(on_polytope) : on_polytope));
  }

  [[nodiscard]] Vec3 nearest_on_edge(const Vec3& x) const {
    const HalfEdge& half_edge = polytope_.half_edge(index_);
    const Vec3 from = point(half_edge.origin), edge = point(polytope_.half_edge(half_edge.twin).origin) - from;
    return from + std::clamp((x - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge;
  }

  [[nodiscard]] double outside() const { return kFootOutside * difference_.reach(); }

  /// The middle of the farthest part's rim or its apex, and how far from it the farthest point lies.
  [[nodiscard]] Vec3 farthest_of_core(const Vec3& normal, bool upper) const {
    const Vec3 middle = (upper ? core_.half_height : -core_.half_height) * core_.axis;
    if (upper && core_.pointed) return middle;
    Vec3 aside = normal - normal.dot(core_.axis) * core_.axis;
    double length = aside.norm();
    // A disc flush on V.
    if (length * core_.radius <= 0.25 * outside()) return middle;
    aside /= length;
    aside -= aside.dot(core_.axis) * core_.axis;
    length = aside.norm();
    return middle + (core_.radius / length) * aside;
  }
  [[nodiscard]] bool is_upper(const Vec3& normal) const {
    const double along = normal.dot(core_.axis);
    return core_.pointed ? along > core_.kink : !(along < 0);
  }

  /// A part of a segment, by shares of it.
  struct Part {
    double from = 0, to = 1;
    [[nodiscard]] double middle() const { return 0.5 * (from + to); }
    /// Where a linear function of these values at the ends is not below 0, but for `outside`.
    void clip(double at_start, double at_end, double outside) {
      if (std::min(at_start, at_end) >= -outside) return;
      if (at_start < at_end) {
        from = std::max(from, at_end > 0 ? at_start / (at_start - at_end) : at_end < -outside ? 2.0 : 1.0);
      } else {
        to = std::min(to, at_start > 0 ? at_start / (at_start - at_end) : at_start < -outside ? -1.0 : 0.0);
      }
    }
    [[nodiscard]] bool is_there() const { return from <= to; }
  };

  [[nodiscard]] std::optional<Vec3> foot_on_facet(const Vec3& foot) const {
    const Vec3& normal = least_.normal;
    const bool upper = is_upper(normal);
    const Vec3 on_core = farthest_of_core(normal, upper);
    const Vec3 start = foot - on_core;
    // The core's own face: a point, a line of the mantle or a disc, of which the way to the facet's middle is looked
    // at.
    Vec3 way = Vec3::Zero();
    const bool is_disc = on_core.cross(core_.axis).isZero(0) && !(upper && core_.pointed);
    if (is_disc) {
      const std::span<const std::int32_t> corners = polytope_.facet_vertices(index_);
      for (const std::int32_t v : corners) way += point(v);
      way = way / static_cast<double>(corners.size()) - start;
    } else {
      const Vec3 line = farthest_of_core(normal, !upper) - on_core;
      if (std::abs(line.dot(normal)) <= outside()) way = -line;
    }
    Part part;
    const int first = polytope_.facet_half_edge(index_);
    int h = first;
    do {
      const HalfEdge& edge = polytope_.half_edge(h);
      const Vec3 from = point(edge.origin), along = point(polytope_.half_edge(edge.next).origin) - from;
      const Vec3 inwards = sense_ * normal.cross(along);
      const double at_start = inwards.dot(start - from);
      part.clip(at_start, at_start + inwards.dot(way), outside() * along.norm());
      h = edge.next;
    } while (h != first);
    if (!part.is_there()) return std::nullopt;
    const double share = is_disc ? part.from : part.middle();
    if (is_disc && share * way.norm() > core_.radius + outside()) return std::nullopt;
    return on_core - share * way;
  }

  /// Where the edge, and a line of the mantle where one is across, come to the foot:
  /// from + share edge + on_core + rise line = foot.
  [[nodiscard]] std::optional<Vec3> foot_on_edge(const Vec3& foot) const {
    const Vec3& normal = least_.normal;
    const HalfEdge& half_edge = polytope_.half_edge(index_);
    const Vec3 from = point(half_edge.origin), edge = point(polytope_.half_edge(half_edge.twin).origin) - from;
    const Vec3 on_core = farthest_of_core(normal, false);
    const Vec3 line = farthest_of_core(normal, true) - on_core;
    const Vec3 left = foot - from - on_core;
    const double ee = edge.squaredNorm(), el = edge.dot(line), ll = line.squaredNorm();
    const double fe = left.dot(edge), fl = left.dot(line);
    if (!(ee > 0)) return std::nullopt;  // too short for its square
    // A disc flush on the edge: foot_on_facet and foot_on_disc have what is common.
    if (on_core.cross(core_.axis).isZero(0)) return std::nullopt;
    const double outside_edge = outside() / std::sqrt(ee), outside_line = outside() / std::sqrt(ll);
    const auto is_inside = [](double share, double outside) { return share >= -outside && share <= 1 + outside; };
    if (!least_.on_mantle && std::abs(line.dot(normal)) > outside()) {
      const double rise = is_upper(normal) ? 1 : 0;
      if (!is_inside((fe - rise * el) / ee, outside_edge)) return std::nullopt;
      return on_core + rise * line;
    }
    const double determinant = ee * ll - el * el;
    if (determinant > 0x1p-30 * ee * ll) {
      const double share = (fe * ll - fl * el) / determinant, rise = (fl * ee - fe * el) / determinant;
      if (!is_inside(share, outside_edge) || !is_inside(rise, outside_line)) return std::nullopt;
      return on_core + rise * line;
    }
    // Side by side.
    Part part;
    part.clip(fe, fe - el, outside_edge * ee);
    part.clip(ee - fe, ee - fe + el, outside_edge * ee);
    if (!part.is_there()) return std::nullopt;
    return on_core + part.middle() * line;
  }

  /// Of a vertex below a disc, or of an edge from it that lies flush on it.
  [[nodiscard]] std::optional<Vec3> foot_on_disc(const Vec3& foot) const {
    const Vec3& normal = least_.normal;
    const Vec3 middle = core_.half_height * normal;
    const Vec3 to_vertex = foot - point(index_) - middle;
    const double most = core_.radius + outside();
    if (to_vertex.norm() <= most) return middle + to_vertex;
    for (const std::int32_t next : polytope_.neighbours(index_)) {
      const Vec3 edge = point(next) - point(index_);
      const double squared = edge.squaredNorm();
      if (std::abs(edge.dot(normal)) > outside() || !(squared > 0)) continue;
      const Vec3 nearest = to_vertex - std::clamp(to_vertex.dot(edge) / squared, 0.0, 1.0) * edge;
      if (nearest.norm() <= most) return middle + nearest;
    }
    return std::nullopt;
  }

  const ConvexPolytope& polytope_;
  const SmoothDifference& difference_;
  int of_;        ///< the polytope: 0 is A, 1 is B
  double sense_;  ///< V is so many times the polytope
  const RevolvedCore& core_;
  const Mat3& rotation_;
  double error_;
  Vec3 centre_ = Vec3::Zero();  ///< of V
  LeastHeight least_{std::numeric_limits<double>::infinity(), Vec3::Zero(), false};
  Place place_ = Place::facet;
  int index_ = -1;  ///< of the facet, half-edge or vertex
  double floor_ = 0;
  PosedPolytope posed_;
  std::array<FacetTouch, kMostRevolutionFacets + 3> facets_;
  std::array<double, kMostRevolutionFacets> circles_;
};

}  // namespace

std::optional<RevolutionDepth> revolution_depth(const PosedShape& a, const PosedShape& b,
                                                const SmoothDifference& difference, double relative, double width,
                                                std::int64_t& support_calls) {
  const int of = a.shape->polytope() != nullptr ? 0 : 1;
  const ConvexPolytope* polytope = (of == 0 ? a : b).shape->polytope();
  if (polytope == nullptr || polytope->affine_dimension() < 3 ||
      std::max(polytope->num_facets(), polytope->num_vertices()) > kMostRevolutionFacets) {
    return std::nullopt;
  }
  const ConvexShape::Core& round = difference.core_of(1 - of);
  const int axis = axis_of_core(round);
  if (axis < 0) return std::nullopt;
  const Vec3 turned = difference.rotation_of(1 - of).col(axis);
  const std::optional<RevolvedCore> core = std::visit(RevolvedCoreOf{of == 1 ? Vec3(-turned) : turned}, round);
  return RevolutionSearch(*polytope, of, *core, difference).run(relative, width, support_calls);
}

}  // namespace pd::detail
