#include "solid/hull_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

#include "solid/surface_distance.hpp"
#include "solid/winding.hpp"

namespace pd::detail {

namespace {

constexpr double kShrink = 0x1p-32;
/// A piece with a wall nearer to its middle is not shrunk: the shift would be some roundings of 2^-52 long.
constexpr double kThin = 0x1p-13;
/// Triangles that are cut by all walls of a piece at most.
constexpr std::size_t kMostCut = 256;

enum class Place : std::uint8_t { unknown, inside, outside };

/// A facet of the polytope within a box.
struct Patch {
  std::int32_t facet;
  std::vector<Vec3> corners;
};

/// The polytope within a box. Its corners are those of the patches, and those of the box that lie in the polytope.
struct ReachPiece {
  TriangleBox box;
  std::vector<Patch> patches;
  std::vector<Vec3> own;  ///< corners of the box in the polytope
  double upper = HUGE_VAL;
  Place place = Place::unknown;
  std::vector<std::int32_t> triangles;  ///< those that may meet the shrunk piece, where the place is unknown

  template <class Each>
  void for_each_corner(const Each& each) const {
    for (const Patch& patch : patches) {
      for (const Vec3& x : patch.corners) each(x);
    }
    for (const Vec3& x : own) each(x);
  }
  [[nodiscard]] Vec3 middle() const {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for_each_corner([&](const Vec3& x) {
      sum += x;
      ++count;
    });
    return sum / count;
  }
};

/// The part of a polygon where a height, linear in x, is not positive.
template <class Height>
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Height& height) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double a = height(from), b = height(to);
    if (a <= 0) kept.push_back(from);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) kept.emplace_back(from + a / (a - b) * (to - from));
  }
  return kept;
}

/// A polytope's facets as halfspaces, in doubles.
struct Facets {
  std::vector<Vec3> normals;
  std::vector<double> offsets;
  /// A point in the polytope is one within rounding of all halfspaces.
  [[nodiscard]] bool hold(const Vec3& x) const {
    constexpr double kRounding = 0x1p-46;
    for (std::size_t f = 0; f < normals.size(); ++f) {
      if (normals[f].dot(x) > offsets[f] + kRounding) return false;
    }
    return true;
  }
};

/// The halfspaces of a piece, shrunk about its middle.
class ShrunkPiece {
 public:
  ShrunkPiece(const ReachPiece& piece, const Facets& facets, const Vec3& middle) {
    thick_ = true;
    for (int axis = 0; axis < 3; ++axis) {
      add(Vec3::Unit(axis), piece.box.high[axis], middle);
      add(-Vec3::Unit(axis), -piece.box.low[axis], middle);
    }
    for (const Patch& patch : piece.patches) {
      const auto f = static_cast<std::size_t>(patch.facet);
      add(facets.normals[f], facets.offsets[f], middle);
    }
  }

  /// False: too thin to tell what meets it.
  [[nodiscard]] bool thick() const { return thick_; }

  [[nodiscard]] bool meets(const PosedTriangle& triangle) const {
    // Most triangles lie above one halfspace as a whole, or below all of them, and need no polygon.
    bool within = true;
    for (std::size_t h = 0; h < normals_.size(); ++h) {
      int above = 0;
      for (std::size_t k = 0; k < 3; ++k) above += normals_[h].dot(triangle[k].x) - offsets_[h] > 0 ? 1 : 0;
      if (above == 3) return false;
      within = within && above == 0;
    }
    if (within) return true;
    std::vector<Vec3> polygon = {triangle[0].x, triangle[1].x, triangle[2].x};
    for (std::size_t h = 0; h < normals_.size() && !polygon.empty(); ++h) {
      polygon = clipped(polygon, [&](const Vec3& x) { return normals_[h].dot(x) - offsets_[h]; });
    }
    return !polygon.empty();
  }

 private:
  void add(const Vec3& normal, double offset, const Vec3& middle) {
    const double height = offset - normal.dot(middle);
    thick_ = thick_ && height > kThin;
    normals_.push_back(normal);
    // Half the shift stays for rounding.
    offsets_.push_back(normal.dot(middle) + height * (1 - 0.5 * kShrink));
  }

  std::vector<Vec3> normals_;
  std::vector<double> offsets_;
  bool thick_ = false;
};

class ReachSearch {
 public:
  ReachSearch(const PosedSolids& alone, const ReachGoal& goal) : alone_(alone), goal_(goal) {}

  ReachBracket run(const ConvexPolytope& polytope) {
    goal_.enough = alone_.inside(goal_.enough);
    const auto vertex = [&](std::int32_t v) { return alone_.inside(polytope.vertex(v)); };
    ReachPiece all;
    all.box.low = all.box.high = vertex(0);
    for (int f = 0; f < polytope.num_facets(); ++f) {
      Patch patch{f, {}};
      double most = -HUGE_VAL;
      for (const std::int32_t v : polytope.facet_vertices(f)) {
        patch.corners.push_back(vertex(v));
        all.box.low = all.box.low.cwiseMin(patch.corners.back());
        all.box.high = all.box.high.cwiseMax(patch.corners.back());
        most = std::max(most, polytope.facet_normal(f).dot(patch.corners.back()));
      }
      facets_.normals.push_back(polytope.facet_normal(f));
      facets_.offsets.push_back(most);
      all.patches.push_back(std::move(patch));
    }
    collect(all);
    add_corners(all);
    add(std::move(all));
    while (!ended()) halve(pop());
    const double back = std::ldexp(1.0, alone_.scale_exponent());
    // Corners are rounded: each point of the polytope is within some roundings of a piece.
    const double upper = open_.empty() ? 0 : open_.front().upper + 0x1p-46;
    const Vec3 worst = open_.empty() ? Vec3::Zero().eval() : open_.front().middle();
    return {lower_ * back, std::max(upper, closed_ + 0x1p-46) * back, worst * back, steps_};
  }

 private:
  struct Less {
    bool operator()(const ReachPiece& a, const ReachPiece& b) const { return a.upper < b.upper; }
  };

  [[nodiscard]] bool ended() const {
    if (open_.empty() || steps_ >= goal_.steps) return true;
    const double upper = open_.front().upper;
    if (goal_.share > 0) return upper <= (1 + goal_.share) * lower_ || upper <= goal_.enough;
    return upper <= goal_.enough || lower_ > goal_.enough;
  }
  ReachPiece pop() {
    std::pop_heap(open_.begin(), open_.end(), Less());
    ReachPiece piece = std::move(open_.back());
    open_.pop_back();
    return piece;
  }

  void halve(const ReachPiece& piece) {
    Vec3 low = piece.middle(), high = low;
    piece.for_each_corner([&](const Vec3& x) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    });
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const double place = 0.5 * (low[axis] + high[axis]);
    for (const double sign : {1.0, -1.0}) {
      ReachPiece half{piece.box, {}, {}, piece.upper, piece.place, piece.triangles};
      (sign > 0 ? half.box.high : half.box.low)[axis] = place;
      for (const Patch& patch : piece.patches) {
        std::vector<Vec3> corners = clipped(patch.corners, [&](const Vec3& x) { return sign * (x[axis] - place); });
        if (!corners.empty()) half.patches.push_back({patch.facet, std::move(corners)});
      }
      add_corners(half);
      if (!half.patches.empty() || !half.own.empty()) add(std::move(half));
    }
  }

  void add_corners(ReachPiece& piece) const {
    for (int k = 0; k < 8; ++k) {
      const Vec3 x((k & 1) != 0 ? piece.box.high.x() : piece.box.low.x(),
                   (k & 2) != 0 ? piece.box.high.y() : piece.box.low.y(),
                   (k & 4) != 0 ? piece.box.high.z() : piece.box.low.z());
      if (facets_.hold(x)) piece.own.push_back(x);
    }
  }

  /// Lists the triangles whose boxes meet that of the piece.
  void collect(ReachPiece& piece) const {
    std::vector<std::int32_t> stack = {0};
    while (!stack.empty()) {
      const TriangleNode& node = alone_.solid(Body::a).nodes()[static_cast<std::size_t>(stack.back())];
      stack.pop_back();
      if (!alone_.box(Body::a, node).meets(piece.box)) continue;
      if (node.is_leaf()) {
        for (std::int32_t t = node.first; t < node.last; ++t) piece.triangles.push_back(t);
      } else {
        stack.push_back(node.left);
        stack.push_back(node.right);
      }
    }
  }

  /// True if a wall of the box has the whole triangle on its outer side.
  static bool lies_beside(const PosedTriangle& triangle, const TriangleBox& box) {
    const Vec3 low = triangle[0].x.cwiseMin(triangle[1].x).cwiseMin(triangle[2].x);
    const Vec3 high = triangle[0].x.cwiseMax(triangle[1].x).cwiseMax(triangle[2].x);
    return (low.array() > box.high.array()).any() || (high.array() < box.low.array()).any();
  }

  [[nodiscard]] PosedTriangle corners(std::int32_t triangle) const { return alone_.corners(Body::a, triangle); }

  [[nodiscard]] bool is_inside(const Vec3& x) const {
    PosedPoint point;
    point.x = x;
    point.exact = true;
    const PointPlace place = place_in(alone_, Body::a, point);
    return place.on_surface || place.winding > 0;
  }

  void add(ReachPiece piece) {
    ++steps_;
    const Vec3 middle = piece.middle();
    if (piece.place == Place::unknown) {
      std::erase_if(piece.triangles, [&](std::int32_t t) { return lies_beside(corners(t), piece.box); });
    }
    // A piece that many triangles come near is hardly free of them: it is halved first.
    if (piece.place == Place::unknown && piece.triangles.size() <= kMostCut) {
      const ShrunkPiece shrunk(piece, facets_, middle);
      if (shrunk.thick()) {
        std::erase_if(piece.triangles, [&](std::int32_t t) { return !shrunk.meets(corners(t)); });
        if (piece.triangles.empty()) piece.place = is_inside(middle) ? Place::inside : Place::outside;
      }
    }
    if (piece.place == Place::inside) {
      closed_ = std::max(closed_, kShrink * (piece.box.high - piece.box.low).norm());
      return;
    }
    const auto far_from = [&](std::int32_t t) {
      const PosedTriangle triangle = corners(t);
      double most = 0;
      piece.for_each_corner([&](const Vec3& x) { most = std::max(most, reach_to_triangle(triangle, x)); });
      return most;
    };
    const NearestTriangle nearest = nearest_triangle(alone_, Body::a, middle);
    piece.upper = std::min(piece.upper, far_from(nearest.triangle));
    constexpr std::size_t kMostTried = 8;
    for (std::size_t i = 0; i < std::min(piece.triangles.size(), kMostTried); ++i) {
      if (piece.triangles[i] != nearest.triangle) piece.upper = std::min(piece.upper, far_from(piece.triangles[i]));
    }
    const bool higher = nearest.distance > lower_;
    if (higher && (piece.place == Place::outside || !is_inside(middle))) lower_ = nearest.distance;
    open_.push_back(std::move(piece));
    std::push_heap(open_.begin(), open_.end(), Less());
  }

  const PosedSolids& alone_;
  ReachGoal goal_;
  Facets facets_;
  std::vector<ReachPiece> open_;  ///< a heap by the upper bound
  double lower_ = 0;
  double closed_ = 0;  ///< the largest bound of pieces that lie in the solid
  std::int64_t steps_ = 0;
};

}  // namespace

ReachBracket HullReach::beyond(const ConvexPolytope& polytope, const ReachGoal& goal) const {
  return ReachSearch(alone_, goal).run(polytope);
}

}  // namespace pd::detail
