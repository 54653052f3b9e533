#include "pd/solid/solid_parts.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "numeric/quotient.hpp"
#include "solid/part_corners.hpp"
#include "solid/solid_cells.hpp"

namespace pd {

namespace {

using detail::ConvexCell;
using detail::Cut;
using detail::PartCorners;
using detail::PlanePolygon;
using detail::PlaneSet;
using detail::Side;
using detail::SolidCell;
using detail::SolidCells;

enum class Height : std::uint8_t { below, above, both };

class Partition {
 public:
  Partition(const MeshSolid& solid, const SolidPartsLimits& limits)
      : limits_(limits), cells_(solid), planes_(cells_.planes()) {}

  /// A convex piece: what lies in the solid for certain, and what covers it.
  struct Piece {
    std::optional<ConvexCell> inner;
    std::optional<ConvexCell> outer;  ///< nothing: that of the inner one
  };
  /// The convex cells of the solid; nothing where there are more than the limits allow.
  std::optional<std::vector<Piece>> run() {
    std::vector<SolidCell> open;
    open.push_back(cells_.whole());
    std::vector<Piece> parts;
    while (!open.empty()) {
      SolidCell here = std::move(open.back());
      open.pop_back();
      std::optional<Side> plane;
      if (here.faces.empty()) {
        const std::optional<bool> told = cells_.is_solid(here);
        if (!told) parts.push_back({std::nullopt, std::move(here.cell)});
        if (told.value_or(false)) parts.push_back({std::move(here.cell), std::nullopt});
      } else if (!(plane = best_cut(here.faces))) {
        plane = add_piece(here, parts);
      }
      if (plane) {
        SolidCells::Halves halves = cells_.split(std::move(here), *plane);
        if (halves.beyond) open.push_back(*std::move(halves.beyond));
        if (halves.inside) open.push_back(*std::move(halves.inside));
      }
      if (static_cast<std::int64_t>(parts.size() + open.size()) > limits_.parts ||
          cells_.polygons() > limits_.polygons) {
        return std::nullopt;
      }
    }
    return parts;
  }

  [[nodiscard]] PlaneSet& planes() { return planes_; }
  [[nodiscard]] double scale() const { return std::ldexp(1.0, cells_.exponent()); }

 private:
  /// At least the height of a polygon above a plane.
  [[nodiscard]] double rise(const PlanePolygon& polygon, Side plane) const {
    double most = -HUGE_VAL;
    for (const Vec3& x : polygon.corners) most = std::max(most, planes_.height(plane, x));
    return most + 2 * polygon.error + 0x1p-46;
  }

  /// Adds what the planes of the faces leave of the cell.
  /// @return a plane beyond which the cell is solid although all faces lie below it: the cell has to be cut there.
  std::optional<Side> add_piece(const SolidCell& here, std::vector<Piece>& pieces) {
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
        if (cells_.middle_is_solid(*beyond).value_or(true)) return plane;
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
    return planes_.add(normal, offset.scaled(cells_.exponent()));
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

  const SolidPartsLimits& limits_;
  SolidCells cells_;
  PlaneSet& planes_;
};

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
  if (!(limits.tolerance >= 0 && std::isfinite(limits.tolerance))) {
    return Error{ErrorCode::bad_value, "a tolerance must be a length >= 0", "tolerance"};
  }
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
      if (!polytope) polytope = corners.inner(*piece.inner);
      if (polytope) inner.push_back({*polytope, Pose()});
      if (polytope && corners.exact() && !piece.outer) {
        outer.push_back({*std::move(polytope), Pose()});
        continue;
      }
    }
    all_exact = false;
    const ConvexCell& cell = piece.outer ? *piece.outer : *piece.inner;
    outer.push_back({PartCorners(partition.planes(), cell, partition.scale()).outer().polytope, Pose()});
  }
  if (inner.empty()) return Error{ErrorCode::limit_exceeded, "the solid is thinner than rounding everywhere", ""};
  SolidParts parts(*Compound::from_parts(std::move(inner)));
  parts.exact_ = all_exact;
  if (!all_exact) parts.outer_ = *Compound::from_parts(without_covered(std::move(outer), partition.scale()));
  return parts;
}

}  // namespace pd
