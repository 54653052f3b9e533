#include "pd/union_contact/union_exit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pd/depth/minkowski_difference.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/union_contact/union_piece.hpp"
#include "union_contact/piece_exit.hpp"

namespace pd {

namespace {

/// A piece covers a point of a facet where it holds, up to a slack, the point two slacks farther out: of a piece that
/// faces the facet the point may lie three slacks outside.
constexpr double kSeam = 3;

struct Extent {
  Vec3 low;
  Vec3 high;
};

Extent extent_of(const PosedShape& posed) {
  Extent extent{Vec3::Constant(std::numeric_limits<double>::infinity()), {}};
  extent.high = -extent.low;
  const ConvexPolytope& polytope = *posed.shape->polytope();
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    const Vec3 corner = posed.pose.apply(polytope.vertex(v));
    extent.low = extent.low.cwiseMin(corner);
    extent.high = extent.high.cwiseMax(corner);
  }
  return extent;
}

/// Returns the hull of a smooth core's support points in the 26 directions to the faces, edges and corners of a cube.
/// It lies inside of the core.
std::optional<ConvexShape> inner_polytope(const ConvexShape& shape) {
  std::vector<Vec3> points;
  const PosedShape at_home{&shape, Pose()};
  for (int i = 0; i < 27; ++i) {
    const Vec3 way(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (!way.isZero()) points.push_back(detail::farthest_against(at_home, way.normalized()));
  }
  auto hull = ConvexPolytope::from_points(points);
  if (!hull) return std::nullopt;
  auto rounded = ConvexShape(std::move(hull.value())).with_margin(shape.margin());
  if (!rounded) return std::nullopt;
  return std::move(rounded.value());
}

/// The point of a convex polygon, counter-clockwise about n, nearest to the origin.
Vec3 nearest_to_origin(const std::vector<Vec3>& polygon, const Vec3& n, double offset) {
  const Vec3 foot = offset * n;
  Vec3 best = foot;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& from = polygon[i];
    const Vec3 along = polygon[i + 1 < polygon.size() ? i + 1 : 0] - from;
    if (n.cross(along).dot(foot - from) >= 0) continue;
    // Beyond this edge.
    const double squared = along.squaredNorm();
    const double t = squared > 0 ? std::clamp(-from.dot(along) / squared, 0.0, 1.0) : 0.0;
    const Vec3 x = from + t * along;
    if (x.squaredNorm() < least) {
      least = x.squaredNorm();
      best = x;
    }
  }
  return best;
}

}  // namespace

void UnionExit::push(Waiting waiting) {
  waiting.order = order_++;
  queue_.push_back(waiting);
  std::push_heap(queue_.begin(), queue_.end(), [](const Waiting& x, const Waiting& y) {
    return x.key > y.key || (x.key == y.key && x.order > y.order);
  });
}

UnionExit::Waiting UnionExit::pop() {
  std::pop_heap(queue_.begin(), queue_.end(), [](const Waiting& x, const Waiting& y) {
    return x.key > y.key || (x.key == y.key && x.order > y.order);
  });
  const Waiting top = queue_.back();
  queue_.pop_back();
  return top;
}

bool UnionExit::stand_in(std::vector<PosedShape>& pieces) {
  for (PosedShape& piece : pieces) {
    if (piece.shape->polytope() != nullptr) continue;
    auto inner = inner_polytope(*piece.shape);
    if (!inner) return false;
    piece.shape = &inner_.emplace_back(std::move(*inner));
  }
  return true;
}

bool UnionExit::begin(std::span<const PosedShape> of_a, std::span<const PosedShape> of_b, double pose_rounding,
                      Scratch& scratch) {
  std::vector<PosedShape>& a = a_;
  std::vector<PosedShape>& b = b_;
  a.assign(of_a.begin(), of_a.end());
  b.assign(of_b.begin(), of_b.end());
  inner_.clear();
  if (!stand_in(a) || !stand_in(b)) return false;
  scratch_ = &scratch;
  slack_ = 0;
  inside_one_ = false;
  order_ = 0;
  pieces_.clear();
  built_.clear();
  facets_.clear();
  corners_.clear();
  sets_.clear();
  queue_.clear();
  words_ = (a.size() * b.size() + 63) / 64;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Extent extent = extent_of(a[i]);
    for (std::size_t j = 0; j < b.size(); ++j) {
      slack_ = std::max(slack_, seam_slack(a[i], b[j], pose_rounding));
      pieces_.push_back({i, j, -extent.high, -extent.low});
    }
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Extent extent = extent_of(b[j]);
    for (std::size_t k = j; k < pieces_.size(); k += b.size()) {
      pieces_[k].low += extent.low;
      pieces_[k].high += extent.high;
    }
  }
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    const Vec3 nearest = pieces_[k].low.cwiseMax(Vec3::Zero()) + pieces_[k].high.cwiseMin(Vec3::Zero());
    push_piece(nearest.norm(), k);
  }
  return true;
}

void UnionExit::push_piece(double distance, std::size_t number) {
  // It may cover what is nearer than itself by a seam.
  push({std::max(distance - kSeam * slack_, 0.0), 0, number});
}

void UnionExit::measure(std::size_t number) {
  Piece& piece = pieces_[number];
  piece.measured = true;
  const PosedShape &a = a_[piece.a], &b = b_[piece.b];
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  settings.contact_tolerance = slack_;
  const PenetrationDepth depth = penetration_depth(a, b, *scratch_, settings);
  const double margins = a.shape->margin() + b.shape->margin();
  const bool apart = depth.contact == ContactClass::separated;
  const double least = margins + (apart ? depth.distance_lower : -depth.upper);
  const double most = margins + (apart ? depth.distance_upper : -depth.lower);
  piece.depth = std::max(-most, 0.0);
  inside_one_ = inside_one_ || piece.depth > slack_;
  push_piece(std::max(least, -most), number);
}

bool UnionExit::build(std::size_t number) {
  Piece& piece = pieces_[number];
  piece.built = true;
  built_.push_back(number);
  piece.first = facets_.size();
  const PosedShape &a = a_[piece.a], &b = b_[piece.b];
  const auto built = minkowski_difference(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose,
                                          std::max<std::int64_t>(facets_left_, 0));
  if (!built) return false;
  const MinkowskiDifference& difference = built.value();
  facets_left_ -= difference.num_facets();
  piece.count = difference.facets.size();
  const std::size_t clipped = sets_.size();
  sets_.resize(sets_.size() + words_, 0);
  sets_[clipped + number / 64] |= std::uint64_t{1} << (number % 64);
  for (const MinkowskiDifference::Facet& facet : difference.facets) {
    polygon_.clear();
    double offset = -std::numeric_limits<double>::infinity();
    for (std::int32_t k = facet.first; k < facet.first + facet.count; ++k) {
      const std::int32_t corner = difference.corners[static_cast<std::size_t>(k)];
      polygon_.push_back(difference.vertices[static_cast<std::size_t>(corner)].position);
      offset = std::max(offset, facet.normal.dot(polygon_.back()));
    }
    facets_.push_back({facet.normal, offset});
    push_part(polygon_, number, facets_.size() - 1, clipped);
  }
  return true;
}

void UnionExit::push_part(const std::vector<Vec3>& polygon, std::size_t piece, std::size_t facet, std::size_t clipped) {
  const Vec3 nearest = nearest_to_origin(polygon, facets_[facet].normal, facets_[facet].offset);
  push({nearest.norm(), 0, piece, facet, corners_.size(), polygon.size(), clipped, nearest});
  corners_.insert(corners_.end(), polygon.begin(), polygon.end());
}

bool UnionExit::covered_by(const Piece& piece, const Vec3& x, const Vec3& n) const {
  for (std::size_t f = piece.first; f < piece.first + piece.count; ++f) {
    // A facet that lies on this one and looks the same way does not lead on; one that faces it does.
    const Facet& facet = facets_[f];
    if (facet.normal.dot(x) > facet.offset + slack_ * (1 - (kSeam - 1) * facet.normal.dot(n))) return false;
  }
  return piece.count > 0;
}

bool UnionExit::find_cover(const Waiting& part, std::optional<std::size_t>& cover) {
  const Vec3& x = part.nearest;
  const Vec3 n = facets_[part.facet].normal;
  cover.reset();
  const auto near = [&](std::size_t k) {
    const Piece& piece = pieces_[k];
    return (sets_[part.clipped + k / 64] >> (k % 64) & 1) == 0 && (x - piece.high).maxCoeff() <= kSeam * slack_ &&
           (piece.low - x).maxCoeff() <= kSeam * slack_;
  };
  const auto covers = [&](std::size_t k) { return near(k) && covered_by(pieces_[k], x, n); };
  // What covers one facet covers its neighbours.
  const auto found = std::find_if(built_.begin(), built_.end(), covers);
  if (found != built_.end()) {
    cover = *found;
    std::rotate(built_.begin(), found, found + 1);
    return true;
  }
  // What is not built yet lies farther than x, or holds the ball to x and beyond.
  const double far = x.norm();
  for (std::size_t k = 0; k < pieces_.size() && !cover; ++k) {
    if (pieces_[k].built || pieces_[k].depth <= far || !near(k)) continue;
    if (!build(k)) return false;
    if (covers(k)) cover = k;
  }
  return true;
}

void UnionExit::cut(const Waiting& part, std::size_t number) {
  const Piece piece = pieces_[number];
  const Vec3 n = facets_[part.facet].normal;
  const std::size_t clipped = sets_.size();
  for (std::size_t w = 0; w < words_; ++w) sets_.push_back(sets_[part.clipped + w]);
  sets_[clipped + number / 64] |= std::uint64_t{1} << (number % 64);
  const auto first = corners_.begin() + static_cast<std::ptrdiff_t>(part.corner);
  inside_.assign(first, first + static_cast<std::ptrdiff_t>(part.count));
  for (std::size_t f = piece.first; f < piece.first + piece.count; ++f) {
    const Facet& facet = facets_[f];
    const double level = facet.offset + slack_ * (1 - (kSeam - 1) * facet.normal.dot(n));
    heights_.clear();
    for (const Vec3& corner : inside_) heights_.push_back(facet.normal.dot(corner) - level);
    if (*std::max_element(heights_.begin(), heights_.end()) <= 0) continue;
    outside_.clear();
    polygon_.clear();
    for (std::size_t i = 0; i < inside_.size(); ++i) {
      const std::size_t k = i + 1 < inside_.size() ? i + 1 : 0;
      (heights_[i] > 0 ? outside_ : polygon_).push_back(inside_[i]);
      if ((heights_[i] > 0) == (heights_[k] > 0)) continue;
      const Vec3 crossing = inside_[i] + heights_[i] / (heights_[i] - heights_[k]) * (inside_[k] - inside_[i]);
      outside_.push_back(crossing);
      polygon_.push_back(crossing);
    }
    push_part(outside_, part.piece, part.facet, clipped);
    inside_.swap(polygon_);
    if (inside_.empty()) return;
  }
}

UnionExit::Outcome UnionExit::find(std::span<const PosedShape> a, std::span<const PosedShape> b, const Limits& limits,
                                   Scratch& scratch, Way& way) {
  if (!begin(a, b, limits.pose_rounding, scratch)) return Outcome::over_budget;
  facets_left_ = limits.max_facets;
  while (!queue_.empty()) {
    const Waiting top = pop();
    if (top.count == 0) {
      const Piece& piece = pieces_[top.piece];
      if (!piece.measured) {
        measure(top.piece);
      } else if (!piece.built && !build(top.piece)) {
        return Outcome::over_budget;
      }
      continue;
    }
    std::optional<std::size_t> cover;
    if (!find_cover(top, cover)) return Outcome::over_budget;
    if (cover) {
      cut(top, *cover);
      continue;
    }
    if (!inside_one_) return Outcome::apart;
    way = {top.nearest, pieces_[top.piece].a, pieces_[top.piece].b};
    return Outcome::found;
  }
  return Outcome::apart;
}

}  // namespace pd
