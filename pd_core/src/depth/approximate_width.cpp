#include "pd/depth/approximate_width.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "numeric/floating_point_guard.hpp"
#include "numeric/small_decompositions.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/width.hpp"
#include "pd/structure/direction_grid.hpp"
#include "pd/structure/overlay.hpp"
#include "shape/hull/extreme_points.hpp"

namespace pd {

namespace {

/// Squares of lengths stay in range.
constexpr double kLargest = 1e150;
/// The first pass takes no more directions, so that delta is at least some 9e-7.
constexpr std::int64_t kMostDirections = 500'000;
/// Directions of one refining pass: few enough that the kernel's next width profits from them, and a pass is not
/// waiting for memory.
constexpr std::size_t kBatch = 24;

/// A facet of K + (-K): a direction in which the kernel is thin.
struct ThinDirection {
  double width;
  Vec3 normal;
};

/// Every facet normal of the kernel's difference body with its width, in doubles.
class Facets : public OverlayVisitor {
 public:
  explicit Facets(const ConvexPolytope& kernel) : kernel_(kernel) {}

  bool visit(std::span<const OverlayFacet> facets) override {
    for (const OverlayFacet& facet : facets) {
      Vec3 normal;
      if (facet.on_a.kind == Feature::Kind::edge && facet.on_b.kind == Feature::Kind::edge) {
        normal = along(facet.on_a).cross(along(facet.on_b));
        if (!(normal.squaredNorm() > 0)) continue;
        normal.normalize();
      } else {
        normal = kernel_.facet_normal(facet.on_b.kind == Feature::Kind::facet ? facet.on_b.first : facet.on_a.first);
      }
      const double width =
          std::abs((kernel_.vertex(corner(facet.on_b)) - kernel_.vertex(corner(facet.on_a))).dot(normal));
      found.push_back({width, normal});
    }
    return true;
  }

  std::vector<ThinDirection> found;

 private:
  /// Unit: the square of a product of two edges longer than 1e77 is infinite, and its normal would be 0.
  [[nodiscard]] Vec3 along(const Feature& edge) const {
    return (kernel_.vertex(edge.second) - kernel_.vertex(edge.first)).stableNormalized();
  }
  [[nodiscard]] int corner(const Feature& f) const {
    return f.kind == Feature::Kind::facet ? kernel_.facet_vertices(f.first)[0] : f.first;
  }

  const ConvexPolytope& kernel_;
};

class WidthSearch {
 public:
  WidthSearch(std::span<const Vec3> points, double delta, Scratch& scratch)
      : points_(points), delta_(delta), scratch_(scratch) {}

  /// @param grid  as many directions as leave a third of the kernel to the passes that know where it is thin.
  ApproximateWidth run(const DirectionGrid& grid) {
    fatten();
    std::vector<Vec3> directions = grid.directions;
    for (Vec3& d : directions) d = (to_fat_.transpose() * d).normalized();
    pass(directions);
    // A pass without new points has measured the kernel's thinnest direction itself.
    for (bool grown = true; grown;) {
      const ConvexPolytope kernel = *ConvexPolytope::from_points(kernel_);
      kernel_.clear();
      for (int v = 0; v < kernel.num_vertices(); ++v) kernel_.push_back(kernel.vertex(v));
      result_.kernel_size = kernel.num_vertices();
      directions = thin_directions(kernel);
      // The exact width is the certificate; while doubles deny it, it is not asked for.
      if (directions.empty()) {
        const ConvexShape shape(kernel);
        result_.lower = width({&shape, Pose()}, scratch_).lower;
        if (result_.upper <= (1 + delta_) * result_.lower) break;
        directions.push_back(result_.normal);
      }
      grown = pass(directions);
      if (!grown) {
        const ConvexShape shape(kernel);
        result_.lower = width({&shape, Pose()}, scratch_).lower;
      }
    }
    result_.width = result_.upper;
    return result_;
  }

 private:
  /// Extents along the directions: an upper bound, and new points for the kernel. False when there are none.
  bool pass(const std::vector<Vec3>& directions) {
    const std::vector<detail::Extremes> extremes = detail::extreme_points(points_, directions);
    ++result_.passes;
    result_.dot_products_per_point += static_cast<std::int64_t>(directions.size());
    bool grown = false;
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const detail::Extremes& e = extremes[k];
      // Three products and two sums of at most the largest coordinate each, twice; the direction's own length; a sum.
      const double extent = (e.most - e.least + 16 * detail::kUnitRoundoff * largest_) * (1 + 0x1p-49);
      if (extent < result_.upper) {
        result_.upper = extent;
        result_.normal = directions[k];
      }
      for (const std::size_t i : {e.argument_least, e.argument_most}) {
        if (std::find(kernel_.begin(), kernel_.end(), points_[i]) != kernel_.end()) continue;
        kernel_.push_back(points_[i]);
        grown = true;
      }
    }
    return grown;
  }

  /// An affine map after which the set is about as wide in every direction: the inverse root of the second moments of
  /// its extreme points, twice over, since the first ones see little of a thin set's cross-section. It serves the
  /// choice of directions alone.
  void fatten() {
    result_.upper = std::numeric_limits<double>::infinity();
    std::vector<Vec3> directions{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    for (const Vec3& p : points_) largest_ = std::max(largest_, p.cwiseAbs().maxCoeff());
    to_fat_ = Mat3::Identity();
    const DirectionGrid few = *direction_grid(GridKind::geodesic, 1, GridExtent::hemisphere);
    for (int round = 0; round < 2; ++round) {
      if (round > 0) {
        directions = few.directions;
        for (Vec3& d : directions) d = (to_fat_.transpose() * d).normalized();
      }
      if (!pass(directions)) return;
      Vec3 centre = Vec3::Zero();
      for (const Vec3& p : kernel_) centre += p / static_cast<double>(kernel_.size());
      double scale = 0;
      for (const Vec3& p : kernel_) scale = std::max(scale, (p - centre).cwiseAbs().maxCoeff());
      if (!(scale > 0)) return;
      Mat3 moments = Mat3::Zero();
      for (const Vec3& p : kernel_) {
        const Vec3 x = (p - centre) / scale;
        moments += x * x.transpose() / static_cast<double>(kernel_.size());
      }
      // Not thinner than rounding.
      moments += 0x1p-80 * Mat3::Identity() + 0x1p-48 * moments.trace() * Mat3::Identity();
      const detail::SmallCholesky root(moments.data(), 3);
      if (!root.positive()) return;
      to_fat_ = Mat3::Identity();
      for (int k = 0; k < 3; ++k) root.solve_lower(to_fat_.col(k).data());
    }
  }

  /// The kernel's thinnest directions that are too thin to do, well apart in the fattened space.
  std::vector<Vec3> thin_directions(const ConvexPolytope& kernel) {
    Facets facets(kernel);
    overlay_.walk(kernel, Pose(), kernel, Pose(), OverlayPieces::as_walked, facets);
    std::sort(facets.found.begin(), facets.found.end(), [](const ThinDirection& x, const ThinDirection& y) {
      if (x.width != y.width) return x.width < y.width;
      return std::lexicographical_compare(x.normal.begin(), x.normal.end(), y.normal.begin(), y.normal.end());
    });
    // A good part of the spacing of a grid for delta.
    const double apart = 1 - 0.5 * delta_;
    const Mat3 dual = to_fat_.inverse().transpose();
    std::vector<Vec3> chosen, chosen_fat;
    for (const ThinDirection& thin : facets.found) {
      if (chosen.size() == kBatch) break;
      if (thin.width * (1 + delta_) >= result_.upper) break;
      const Vec3 fat = (dual * thin.normal).normalized();
      const bool near = std::any_of(chosen_fat.begin(), chosen_fat.end(),
                                    [&](const Vec3& other) { return std::abs(other.dot(fat)) > apart; });
      if (near) continue;
      chosen.push_back(thin.normal);
      chosen_fat.push_back(fat);
    }
    return chosen;
  }

  std::span<const Vec3> points_;
  double delta_;
  Scratch& scratch_;
  double largest_ = 0;
  Mat3 to_fat_;
  std::vector<Vec3> kernel_;
  Overlay overlay_;
  ApproximateWidth result_;
};

}  // namespace

Expected<ApproximateWidth> approximate_width(std::span<const Vec3> points, double delta, Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  if (!(delta > 0 && delta <= 1)) return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  if (points.empty()) return Error{ErrorCode::too_few_points, "a width needs at least one point", "points"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].array().abs() <= kLargest).all()) continue;
    const std::string where = "points[" + std::to_string(i) + "]";
    if (!points[i].allFinite()) return Error{ErrorCode::non_finite, "a point needs three finite numbers", where};
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e150", where};
  }
  const Expected<DirectionGrid> grid =
      direction_grid(GridKind::geodesic, std::min(1.0, 3 * delta), GridExtent::hemisphere, kMostDirections);
  if (!grid) {
    return Error{ErrorCode::limit_exceeded, "a width within less than 1e-6 takes too many directions", "delta"};
  }
  return WidthSearch(points, delta, scratch).run(*grid);
}

}  // namespace pd
