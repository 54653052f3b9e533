#include "pd/solid/solid_parts.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "numeric/quotient.hpp"
#include "solid/convex_cell.hpp"
#include "solid/winding.hpp"

namespace pd {

namespace {

using detail::ConvexCell;
using detail::Cut;
using detail::PlanePolygon;
using detail::PlaneSet;
using detail::Side;

/// A cell, and the pieces of faces in its interior and on its walls.
struct Open {
  ConvexCell cell;
  std::vector<PlanePolygon> faces;
  std::vector<PlanePolygon> on_walls;
};

enum class Height : std::uint8_t { below, above, both };

class Partition {
 public:
  Partition(const MeshSolid& solid, const SolidPartsLimits& limits)
      : solid_(solid), limits_(limits), planes_(exponent_of(solid)) {}

  /// A convex piece: what lies in the solid for certain, and what covers it.
  struct Piece {
    std::optional<ConvexCell> inner;
    std::optional<ConvexCell> outer;  ///< nothing: that of the inner one
  };
  /// The convex cells of the solid; nothing where there are more than the limits allow.
  std::optional<std::vector<Piece>> run() {
    std::vector<Open> open;
    open.push_back({ConvexCell::cube(planes_, std::ldexp(1.0, exponent_of(solid_) + 2)), {}, {}});
    for (const MeshSolid::Triangle& t : solid_.triangles()) open.back().faces.push_back(polygon_of(t));
    std::vector<Piece> parts;
    while (!open.empty()) {
      Open here = std::move(open.back());
      open.pop_back();
      std::optional<Side> plane;
      if (here.faces.empty()) {
        const std::optional<bool> told = is_solid(here);
        if (!told) parts.push_back({std::nullopt, std::move(here.cell)});
        if (told.value_or(false)) parts.push_back({std::move(here.cell), std::nullopt});
      } else if (!(plane = best_cut(here.faces))) {
        plane = add_piece(here, parts);
      }
      if (plane) split(std::move(here), *plane, open);
      if (static_cast<std::int64_t>(parts.size() + open.size()) > limits_.parts || polygons_ > limits_.polygons) {
        return std::nullopt;
      }
    }
    return parts;
  }

  [[nodiscard]] PlaneSet& planes() { return planes_; }
  [[nodiscard]] double scale() const { return std::ldexp(1.0, exponent_of(solid_)); }

 private:
  static int exponent_of(const MeshSolid& solid) {
    const TriangleNode& root = solid.nodes().front();
    const double size = std::max(root.low.cwiseAbs().maxCoeff(), root.high.cwiseAbs().maxCoeff());
    return size > 0 ? std::ilogb(size) : 0;
  }

  [[nodiscard]] PlanePolygon polygon_of(const MeshSolid::Triangle& t) {
    std::array<detail::Dyadic3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = detail::to_dyadic(solid_.vertex(t.vertices[k]));
    const detail::Dyadic3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    PlanePolygon polygon;
    polygon.plane = planes_.add(normal, dot(normal, corners[0]));
    int axis = 0;
    planes_.normal(polygon.plane).cwiseAbs().maxCoeff(&axis);
    const double up = planes_.normal(polygon.plane)[axis] > 0 ? 1 : -1;
    // Edges lie in planes along the axis, whose coefficients are short.
    for (std::size_t k = 0; k < 3; ++k) {
      const detail::Dyadic3 along = corners[(k + 1) % 3] - corners[k];
      const Vec3 unit = up * Vec3::Unit(axis);
      const detail::Dyadic3 outwards = cross(along, detail::to_dyadic(unit));
      polygon.sides.push_back(planes_.add(outwards, dot(outwards, corners[k])));
    }
    polygon.update(planes_);
    ++polygons_;
    return polygon;
  }

  /// At least the height of a polygon above a plane.
  [[nodiscard]] double rise(const PlanePolygon& polygon, Side plane) const {
    double most = -HUGE_VAL;
    for (const Vec3& x : polygon.corners) most = std::max(most, planes_.height(plane, x));
    return most + 2 * polygon.error + 0x1p-46;
  }

  /// Adds what the planes of the faces leave of the cell.
  /// @return a plane beyond which the cell is solid although all faces lie below it: the cell has to be cut there.
  std::optional<Side> add_piece(const Open& here, std::vector<Piece>& pieces) {
    Piece piece{here.cell, std::nullopt};
    std::optional<ConvexCell> outer = here.cell;
    std::vector<Side> done;
    for (const PlanePolygon& face : here.faces) {
      const Side plane = face.plane;
      if (std::find(done.begin(), done.end(), plane) != done.end()) continue;
      done.push_back(plane);
      if (piece.inner) piece.inner = piece.inner->inside(planes_, plane);
      if (limits_.tolerance == 0) continue;
      double most = 0x1p-46;
      for (const PlanePolygon& other : here.faces) most = std::max(most, rise(other, plane));
      const Side shifted = above(plane, most);
      if (const auto beyond = here.cell.inside(planes_, shifted.opposite())) {
        if (middle_is_solid(*beyond).value_or(true)) return plane;
      }
      if (outer) outer = outer->inside(planes_, shifted);
    }
    if (limits_.tolerance > 0) piece.outer = std::move(outer);
    if (piece.inner || piece.outer) pieces.push_back(std::move(piece));
    return std::nullopt;
  }

  /// The plane shifted outwards by at least a length.
  [[nodiscard]] Side above(Side plane, double length) {
    const detail::Dyadic3 normal = planes_.exact_normal(plane);
    // The normal in doubles is the exact one times 2^-top.
    int top = 0;
    for (const detail::Dyadic& c : {normal.x, normal.y, normal.z}) {
      if (c.sign() != 0) top = std::max(top, detail::top_bit(c.mantissa()) + c.exponent());
    }
    const detail::Dyadic size = detail::Dyadic(planes_.normal(plane).norm() * (1 + 0x1p-40)).scaled(top);
    const detail::Dyadic offset = planes_.exact_offset(plane) + size * detail::Dyadic(length);
    return planes_.add(normal, offset.scaled(exponent_of(solid_)));
  }

  /// Tells on which sides of a plane a polygon lies; exactly without a tolerance, else in doubles.
  [[nodiscard]] Height height_of(const PlanePolygon& polygon, Side plane) const {
    if (limits_.tolerance > 0) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const Vec3& x : polygon.corners) {
        const double height = planes_.height(plane, x);
        low = std::min(low, height);
        high = std::max(high, height);
      }
      const double tolerance = limits_.tolerance / scale();
      return high <= tolerance ? Height::below : low >= -tolerance ? Height::above : Height::both;
    }
    PlanePolygon inner;
    switch (cut(planes_, polygon, plane, inner, nullptr)) {
      case Cut::inside:
        return Height::below;
      case Cut::outside:
        return Height::above;
      case Cut::split:
        break;
    }
    return Height::both;
  }
  static bool faces_against(const PlanePolygon& polygon, Side plane) { return polygon.plane == plane.opposite(); }

  /// The plane of a face that has others above it, which cuts fewest faces and halves them best; nothing where every
  /// face has all others below it.
  [[nodiscard]] std::optional<Side> best_cut(const std::vector<PlanePolygon>& faces) const {
    constexpr std::size_t kMostTried = 24;
    std::vector<Side> tried;
    std::optional<Side> best;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < faces.size() && tried.size() < kMostTried; ++i) {
      const Side plane = faces[i].plane;
      const bool known = std::any_of(tried.begin(), tried.end(), [&](Side s) { return s.plane() == plane.plane(); });
      if (known) continue;
      std::size_t above = 0, below = 0, both = 0, against = 0;
      for (const PlanePolygon& face : faces) {
        if (face.plane.plane() == plane.plane()) {
          against += faces_against(face, plane);
          continue;
        }
        const Height height = height_of(face, plane);
        ++(height == Height::above ? above : height == Height::below ? below : both);
      }
      if (above + both + against == 0) continue;
      tried.push_back(plane);
      const double uneven = std::abs(static_cast<double>(above) - static_cast<double>(below));
      const double cost = 8 * static_cast<double>(both) + uneven;
      if (cost < least) {
        least = cost;
        best = plane;
      }
    }
    return best;
  }

  void split(Open here, Side plane, std::vector<Open>& open) {
    std::optional<ConvexCell> inner_cell = here.cell.inside(planes_, plane);
    std::optional<ConvexCell> outer_cell = here.cell.inside(planes_, plane.opposite());
    Open inner, outer;
    const auto share = [&](std::vector<PlanePolygon>& from, std::vector<PlanePolygon> Open::*list) {
      for (PlanePolygon& polygon : from) {
        if (polygon.plane.plane() == plane.plane()) {
          inner.on_walls.push_back(polygon);
          outer.on_walls.push_back(std::move(polygon));
          continue;
        }
        PlanePolygon below, above;
        switch (cut(planes_, polygon, plane, below, &above)) {
          case Cut::inside:
            (inner.*list).push_back(std::move(polygon));
            break;
          case Cut::outside:
            (outer.*list).push_back(std::move(polygon));
            break;
          case Cut::split:
            ++polygons_;
            (inner.*list).push_back(std::move(below));
            (outer.*list).push_back(std::move(above));
            break;
        }
      }
    };
    share(here.faces, &Open::faces);
    share(here.on_walls, &Open::on_walls);
    if (outer_cell) {
      outer.cell = *std::move(outer_cell);
      open.push_back(std::move(outer));
    }
    if (inner_cell) {
      inner.cell = *std::move(inner_cell);
      open.push_back(std::move(inner));
    }
  }

  /// A cell without faces inside is all solid or all empty. A face on one of its walls tells which: it shows its back
  /// to the solid.
  [[nodiscard]] std::optional<bool> is_solid(const Open& here) const {
    for (const PlanePolygon& face : here.on_walls) {
      for (const PlanePolygon& wall : here.cell.facets()) {
        if (wall.plane.plane() == face.plane.plane()) return wall.plane == face.plane;
      }
    }
    return middle_is_solid(here.cell);
  }

  /// No face lies on a wall: the place of the cell's middle.
  [[nodiscard]] std::optional<bool> middle_is_solid(const ConvexCell& cell) const {
    Vec3 middle = Vec3::Zero();
    double count = 0;
    for (const PlanePolygon& facet : cell.facets()) {
      for (const Vec3& corner : facet.corners) middle += corner;
      count += static_cast<double>(facet.corners.size());
    }
    middle /= count;
    const bool inside = std::all_of(cell.facets().begin(), cell.facets().end(), [&](const PlanePolygon& facet) {
      return planes_.sign_at_point(facet.plane, middle) < 0;
    });
    if (!inside) return std::nullopt;
    const Pose identity;
    const detail::PosedSolids alone(solid_, identity, solid_, identity);
    detail::PosedPoint point;
    point.x = middle * std::ldexp(1.0, exponent_of(solid_) - alone.scale_exponent());
    point.exact = true;
    return place_in(alone, detail::Body::b, point).winding > 0;
  }

  const MeshSolid& solid_;
  const SolidPartsLimits& limits_;
  PlaneSet planes_;
  std::int64_t polygons_ = 0;
};

/// A part's corners: exact ones once, in doubles; and the planes that meet there.
class PartCorners {
 public:
  PartCorners(PlaneSet& planes, const ConvexCell& cell, double scale) : planes_(planes), cell_(cell), scale_(scale) {
    for (const PlanePolygon& facet : cell.facets()) {
      const std::size_t n = facet.sides.size();
      for (std::size_t i = 0; i < n; ++i) {
        const Side q = facet.sides[i], r = facet.sides[(i + 1) % n];
        const PlaneSet::ExactPoint exact = planes.exact_meet(facet.plane, q, r);
        const Vec3 x(quotient(exact.numerator.x, exact.denominator), quotient(exact.numerator.y, exact.denominator),
                     quotient(exact.numerator.z, exact.denominator));
        exact_ = exact_ && planes.sign_at_point(facet.plane, x) == 0 && planes.sign_at_point(q, x) == 0 &&
                 planes.sign_at_point(r, x) == 0;
        points_.push_back(x);
        meets_.push_back({facet.plane, q, r});
      }
    }
    for (const Vec3& x : points_) centre_ += x / static_cast<double>(points_.size());
  }

  [[nodiscard]] bool exact() const { return exact_; }
  [[nodiscard]] std::optional<ConvexPolytope> polytope() const { return hull(points_); }

  /// A polytope that lies in the part; nothing for parts thinner than what rounding moves.
  [[nodiscard]] std::optional<ConvexPolytope> inner() const {
    for (const double share : {0x1p-46, 0x1p-40, 0x1p-32, 0x1p-24, 0x1p-16, 0x1p-8}) {
      const std::vector<Vec3> points = moved(-share);
      const bool inside = std::all_of(points.begin(), points.end(), [&](const Vec3& x) {
        return std::all_of(cell_.facets().begin(), cell_.facets().end(),
                           [&](const PlanePolygon& facet) { return planes_.sign_at_point(facet.plane, x) <= 0; });
      });
      if (inside) return hull(points);
    }
    return std::nullopt;
  }

  /// A polytope that holds the part.
  [[nodiscard]] ConvexPolytope outer() const {
    for (const double share : {0x1p-40, 0x1p-32, 0x1p-24}) {
      std::optional<ConvexPolytope> out = hull(moved(share));
      if (out && holds_corners(*out)) return *std::move(out);
    }
    // Boxes around the corners, wider than their rounding.
    std::vector<Vec3> points;
    for (const Vec3& x : points_) {
      const double reach = 0x1p-50 * std::max(x.cwiseAbs().maxCoeff(), 0x1p-900);
      for (int k = 0; k < 8; ++k) {
        points.push_back(x + reach * Vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
      }
    }
    return *hull(points);
  }

 private:
  [[nodiscard]] std::vector<Vec3> moved(double share) const {
    std::vector<Vec3> points;
    points.reserve(points_.size());
    for (const Vec3& x : points_) points.push_back(x + share * (x - centre_));
    return points;
  }
  [[nodiscard]] std::optional<ConvexPolytope> hull(std::vector<Vec3> points) const {
    for (Vec3& x : points) x *= scale_;
    Expected<ConvexPolytope> made = ConvexPolytope::from_points(points);
    if (!made || made->affine_dimension() < 3) return std::nullopt;
    return *std::move(made);
  }
  [[nodiscard]] bool holds_corners(const ConvexPolytope& polytope) const {
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const auto loop = polytope.facet_vertices(f);
      const auto corner = [&](std::size_t k) { return detail::to_dyadic(polytope.vertex(loop[k])); };
      const detail::Dyadic3 normal = cross(corner(1) - corner(0), corner(2) - corner(0));
      const Side plane = planes_.add(normal, dot(normal, corner(0)));
      for (const auto& meet : meets_) {
        if (planes_.sign_at_meet(meet[0], meet[1], meet[2], plane) > 0) return false;
      }
    }
    return true;
  }

  PlaneSet& planes_;
  const ConvexCell& cell_;
  double scale_;
  std::vector<Vec3> points_;  ///< inside lengths
  std::vector<std::array<Side, 3>> meets_;
  Vec3 centre_ = Vec3::Zero();
  bool exact_ = true;
};

}  // namespace

namespace {

/// True if a polytope lies inside of another for certain.
bool lies_within(const ConvexPolytope& small, const ConvexPolytope& large, double rounding) {
  for (int f = 0; f < large.num_facets(); ++f) {
    const Vec3& normal = large.facet_normal(f);
    double offset = HUGE_VAL;
    for (const std::int32_t v : large.facet_vertices(f)) offset = std::min(offset, normal.dot(large.vertex(v)));
    for (int v = 0; v < small.num_vertices(); ++v) {
      if (!(normal.dot(small.vertex(v)) < offset - rounding)) return false;
    }
  }
  return true;
}

/// Slivers between faces that rounding keeps from one plane are covered by their neighbours.
std::vector<Compound::Part> without_covered(std::vector<Compound::Part> parts, double size) {
  std::vector<char> covered(parts.size(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < parts.size() && covered[i] == 0; ++j) {
      if (i == j || covered[j] != 0) continue;
      covered[i] = lies_within(*parts[i].shape.polytope(), *parts[j].shape.polytope(), 0x1p-48 * size) ? 1 : 0;
    }
  }
  std::vector<Compound::Part> kept;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (covered[i] == 0) kept.push_back(std::move(parts[i]));
  }
  return kept;
}

}  // namespace

Expected<SolidParts> SolidParts::from_solid(const MeshSolid& solid, const SolidPartsLimits& limits) {
  const detail::FloatingPointGuard guard;
  Partition partition(solid, limits);
  const auto pieces = partition.run();
  if (!pieces) {
    return Error{ErrorCode::limit_exceeded,
                 "the solid has more than " + std::to_string(limits.parts) + " convex parts, or faces of more than " +
                     std::to_string(limits.polygons) + " pieces",
                 "limits"};
  }
  std::vector<Compound::Part> inner, outer;
  bool all_exact = true;
  for (const Partition::Piece& piece : *pieces) {
    std::optional<ConvexPolytope> polytope;
    if (piece.inner) {
      const PartCorners corners(partition.planes(), *piece.inner, partition.scale());
      if (corners.exact()) polytope = corners.polytope();
      if (!polytope) polytope = corners.inner();
      if (polytope) inner.push_back({*polytope, Pose()});
      if (polytope && corners.exact() && !piece.outer) {
        outer.push_back({*std::move(polytope), Pose()});
        continue;
      }
    }
    all_exact = false;
    const ConvexCell& cell = piece.outer ? *piece.outer : *piece.inner;
    outer.push_back({PartCorners(partition.planes(), cell, partition.scale()).outer(), Pose()});
  }
  if (inner.empty()) return Error{ErrorCode::limit_exceeded, "the solid is thinner than rounding everywhere", ""};
  SolidParts parts(*Compound::from_parts(std::move(inner)));
  parts.exact_ = all_exact;
  if (!all_exact) parts.outer_ = *Compound::from_parts(without_covered(std::move(outer), partition.scale()));
  return parts;
}

}  // namespace pd
