#include "depth/pair/revolution_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "depth/pair/edge_arc.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

/// More than these an expanding polytope does not look at.
constexpr int kMostRevolutionFacets = 128;
/// Directions that arcs may look at.
constexpr int kMostTouches = 64;
/// Of the squared sine of a direction's angle from the axis: below, a point of the rim is better not taken from it.
constexpr double kNearAxis = 0x1p-10;
/// Heights err by some 30u of the reach, points less.
constexpr double kHeightError = 64 * kUnitRoundoff;
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

/// A facet of V and the point of S that is farthest across it: rise * normal + shift * axis, or the middle of its disc.
struct FacetTouch {
  Vec3 normal;
  double along;  ///< <axis, normal>
  double level;  ///< of V
  double rise;   ///< 0 of an apex and of a disc's middle
  double shift;
  double height;  ///< of V's facet and that point
};

class RevolutionSearch {
 public:
  RevolutionSearch(const ConvexPolytope& polytope, int of, const RevolvedCore& core, const SmoothDifference& difference)
      : polytope_(polytope),
        difference_(difference),
        of_(of),
        sense_(of == 1 ? 1 : -1),
        core_(core),
        rotation_(difference.rotation_of(of)),
        error_(kHeightError * difference.reach() + face_error(difference)) {}

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
    out.lower = std::min(floor_, least_.height) - error_;
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
    Mat3 turn = cofactors_of(rotation_);
    const double determinant = rotation_.row(0).dot(turn.row(0));
    turn *= sense_;
    for (int f = 0; f < polytope_.num_facets(); ++f) {
      FacetTouch& at = facets_[static_cast<std::size_t>(f)];
      const Vec3& local = polytope_.facet_normal(f);
      const Vec3 turned = turn * local;
      const double inverse = 1 / turned.norm();
      at.normal = inverse * turned;
      at.level = determinant * inverse * polytope_.vertex(polytope_.facet_vertices(f)[0]).dot(local) +
                 difference_.offset().dot(at.normal);
      at.along = core_.axis.dot(at.normal);
      double across_squared = 1 - at.along * at.along;
      if (across_squared < kNearAxis) [[unlikely]]
        across_squared = core_.axis.cross(at.normal).squaredNorm();
      const double across = std::sqrt(across_squared);
      const bool upper = core_.pointed ? 2 * core_.half_height * at.along > core_.radius * across : !(at.along < 0);
      const double z = upper ? core_.half_height : -core_.half_height;
      const double middle = at.level + z * at.along;
      const bool apex = upper && core_.pointed;
      const double height = apex ? middle : middle + core_.radius * across;
      if (apex || across_squared < kNearAxis) {
        at.rise = 0;
        at.shift = z;
        at.height = middle;
      } else {
        at.rise = core_.radius / across;
        at.shift = z - at.along * at.rise;
        at.height = height;
      }
      if (height < least_.height) take({height, at.normal, false}, Place::facet, f);
    }
  }

  /// The cofactors of V's matrix, which is a rotation up to rounding only.
  static Mat3 cofactors_of(const Mat3& r) {
    Mat3 m;
    m.row(0) = r.row(1).cross(r.row(2));
    m.row(1) = r.row(2).cross(r.row(0));
    m.row(2) = r.row(0).cross(r.row(1));
    return m;
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
      if (height < least_.height) take({height, normal, false}, Place::disc, vertex);
    }
  }

  void look_along_edges(double slack) {
    int touches_left = kMostTouches;
    for (int h = 0; h < polytope_.num_half_edges(); ++h) {
      const HalfEdge& edge = polytope_.half_edge(h);
      if (edge.twin < h) continue;
      const FacetTouch& left = facets_[static_cast<std::size_t>(edge.facet)];
      const FacetTouch& right = facets_[static_cast<std::size_t>(polytope_.half_edge(edge.twin).facet)];
      const double cosine = left.normal.dot(right.normal);
      // The one facet's point, as far as it goes across the other.
      const double left_across_right = right.level + left.rise * cosine + left.shift * right.along;
      if (std::min(left.height, left_across_right) >= least_.height) continue;
      const double right_across_left = left.level + right.rise * cosine + right.shift * left.along;
      if (std::min(right.height, right_across_left) >= least_.height) continue;
      LeastHeight found = least_;
      EdgeArc arc(core_, point(edge.origin), left.normal, right.normal);
      floor_ = std::min(floor_, arc.search(slack, touches_left, found));
      if (found.height < least_.height) take(found, Place::edge, h);
      if (!(floor_ > 0)) return;
    }
  }

  /// 4. of the file's comment.
  void look_across_vertices() {
    const double steep = std::sqrt(1 - core_.kink * core_.kink);
    const double added = core_.pointed ? core_.half_height * core_.kink : core_.radius;
    const auto least_of = [&](const Vec3& x) {
      const double along = x.dot(core_.axis);
      return core_.kink * along - steep * (x - along * core_.axis).norm() + added;
    };
    if (least_of(centre_) >= least_.height) return;
    double greatest = -std::numeric_limits<double>::infinity();
    for (int v = 0; v < polytope_.num_vertices(); ++v) {
      greatest = std::max(greatest, least_of(point(v)));
      if (greatest >= least_.height) return;
    }
    const double level = greatest - 4 * error_;
    for (int v = 0; v < polytope_.num_vertices(); ++v) {
      if (least_of(point(v)) >= level) look_across_vertex(v, greatest, steep, added);
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
        on_core = foot - point(index_);
        if ((*on_core - on_core->dot(core_.axis) * core_.axis).norm() > core_.radius + outside()) return std::nullopt;
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
    // P = B - A, where V has the offset.
    return of_ == 1 ? Vec3(-*on_core) : Vec3(difference_.offset() - (foot - *on_core));
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

  [[nodiscard]] std::optional<Vec3> foot_on_facet(const Vec3& foot) const {
    const Vec3& normal = least_.normal;
    const Vec3 on_core = farthest_of_core(normal, is_upper(normal));
    const Vec3 on_facet = foot - on_core;
    const int first = polytope_.facet_half_edge(index_);
    int h = first;
    do {
      const HalfEdge& edge = polytope_.half_edge(h);
      const Vec3 from = point(edge.origin), along = point(polytope_.half_edge(edge.next).origin) - from;
      if (sense_ * normal.cross(along).dot(on_facet - from) < -outside() * along.norm()) return std::nullopt;
      h = edge.next;
    } while (h != first);
    return on_core;
  }

  /// Where the edge, and a line of the mantle where one is across, come to the foot.
  [[nodiscard]] std::optional<Vec3> foot_on_edge(const Vec3& foot) const {
    const Vec3& normal = least_.normal;
    const HalfEdge& half_edge = polytope_.half_edge(index_);
    const Vec3 from = point(half_edge.origin), edge = point(polytope_.half_edge(half_edge.twin).origin) - from;
    const Vec3 lower = farthest_of_core(normal, false);
    const bool upper = is_upper(normal);
    Vec3 on_core = upper ? farthest_of_core(normal, true) : lower;
    // from + share edge + on_core + rise mantle = foot
    Vec3 mantle = Vec3::Zero();
    if (least_.on_mantle) mantle = (upper ? lower : farthest_of_core(normal, true)) - on_core;
    const Vec3 left = foot - from - on_core;
    const double ee = edge.squaredNorm(), em = edge.dot(mantle), mm = mantle.squaredNorm();
    const double le = left.dot(edge), lm = left.dot(mantle);
    double share = le / ee, rise = 0;
    if (least_.on_mantle) {
      const double determinant = ee * mm - em * em;
      if (!(determinant > 0x1p-30 * ee * mm)) return std::nullopt;
      share = (le * mm - lm * em) / determinant;
      rise = (lm * ee - le * em) / determinant;
      on_core += rise * mantle;
    }
    const double least_share = -outside() / std::sqrt(ee);
    if (!(share >= least_share && share <= 1 - least_share)) return std::nullopt;
    if (least_.on_mantle) {
      const double least_rise = -outside() / std::sqrt(mm);
      if (!(rise >= least_rise && rise <= 1 - least_rise)) return std::nullopt;
    }
    return on_core;
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
  std::array<FacetTouch, kMostRevolutionFacets> facets_;
};

}  // namespace

std::optional<RevolutionDepth> revolution_depth(const PosedShape& a, const PosedShape& b,
                                                const SmoothDifference& difference, double relative, double width,
                                                std::int64_t& support_calls) {
  const int of = a.shape->polytope() != nullptr ? 0 : 1;
  const ConvexPolytope* polytope = (of == 0 ? a : b).shape->polytope();
  if (polytope == nullptr || polytope->affine_dimension() < 3 || polytope->num_facets() > kMostRevolutionFacets) {
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
