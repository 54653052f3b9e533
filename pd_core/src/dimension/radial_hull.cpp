#include "dimension/radial_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pd::dimension::detail {

namespace {

/// How far above its plane (gauge - 1) a point must be for a facet to see it. Above the rounding of gauges in a frame
/// where everything is within a constant, and far below the least epsilon of a kernel.
constexpr double kVisible = 1e-12;
/// lambda down to this counts as inside the cone.
constexpr double kLeastInside = -1e-12;

/// Inverse by Gauss and Jordan with partial pivots, written column by column; false for a singular matrix.
bool invert(const AnyMatrix& matrix, double* r) {
  const int n = static_cast<int>(matrix.rows());
  double a[kMaxDimension][2 * kMaxDimension] = {};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) a[i][j] = matrix(i, j);
    a[i][n + i] = 1;
  }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    if (!(std::abs(a[pivot][k]) > 0)) return false;
    if (pivot != k) std::swap(a[k], a[pivot]);
    const double scale = 1 / a[k][k];
    for (int j = 0; j < 2 * n; ++j) a[k][j] *= scale;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = a[i][k];
      for (int j = 0; j < 2 * n; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  bool finite = true;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      *r++ = a[i][n + j];
      finite = finite && std::isfinite(a[i][n + j]);
    }
  }
  return finite;
}

}  // namespace

RadialHull::RadialHull(int dimension, double start_radius)
    : dimension_(dimension),
      stride_(static_cast<std::size_t>(dimension * dimension + dimension)),
      least_distance_(0.5 * start_radius / std::sqrt(static_cast<double>(dimension))) {
  for (int k = 0; k < dimension; ++k) {
    for (const double sign : {1.0, -1.0}) vertices_.push_back(sign * start_radius * AnyVector::Unit(dimension, k));
  }
  // Facet with bits s: vertex k is +-e_k by bit k; its neighbour across the ridge without vertex k differs in that bit.
  alive_ = std::int64_t{1} << dimension;
  numbers_.resize(static_cast<std::size_t>(alive_) * stride_);
  for (int s = 0; s < alive_; ++s) {
    Facet f{};
    for (int k = 0; k < dimension; ++k) {
      f.vertex[k] = 2 * k + ((s >> k) & 1);
      f.neighbour[k] = s ^ (1 << k);
    }
    f.successor = -1;
    complete(f, numbers_.data() + stride_ * s);
    facets_.push_back(f);
  }
  visible_.assign(facets_.size(), 0);
  cone_of_.resize(facets_.size());
}

/// Inverse and normal from the vertices; false where the facet is degenerate or comes too near to the origin.
bool RadialHull::complete(const Facet& facet, double* numbers) const {
  AnyMatrix columns(dimension_, dimension_);
  for (int k = 0; k < dimension_; ++k) columns.col(k) = vertices_[facet.vertex[k]];
  if (!invert(columns, numbers)) return false;
  double* const normal = numbers + dimension_ * dimension_;
  double squared = 0;
  for (int k = 0; k < dimension_; ++k) {
    normal[k] = std::accumulate(numbers + k * dimension_, numbers + (k + 1) * dimension_, 0.0);
    squared += normal[k] * normal[k];
  }
  return std::sqrt(squared) * least_distance_ <= 1;
}

/// The innermost loop of kernels, therefore one for each dimension.
template <int D>
std::int32_t RadialHull::walk(const double* point, std::int32_t start, std::int64_t& visited) const {
  std::int32_t f = start;
  while (facets_[f].successor >= 0) f = facets_[f].successor;
  std::int32_t previous = -1;
  double previous_least = 0;
  // Straight walks take about the number of facets to the power 1 / (D - 1); a longer one goes round in circles.
  for (std::int64_t steps = 0; steps < 200 + alive_; ++steps) {
    ++visited;
    const Vector<D> lambda = image<D>(numbers(f), point);
    // The place of the least, by conditional moves: which it is cannot be foretold.
    double least = lambda[0];
    std::size_t k = 0;
    for (std::size_t j = 1; j < D; ++j) {
      k += (j - k) & (std::size_t{0} - static_cast<std::size_t>(lambda[j] < least));
      least = std::min(lambda[j], least);
    }
    if (least >= kLeastInside) return f;
    const std::int32_t next = facets_[f].neighbour[k];
    // On a ridge within rounding, each side sends the point to the other.
    if (next == previous && steps > 0) return least > previous_least ? f : previous;
    previous = f;
    previous_least = least;
    f = next;
  }
  return -1;
}

std::int32_t RadialHull::locate(const AnyVector& p, std::int32_t start, std::int64_t& visited) const {
  const std::int32_t met = dimension_ == 2   ? walk<2>(p.data(), start, visited)
                           : dimension_ == 3 ? walk<3>(p.data(), start, visited)
                           : dimension_ == 4 ? walk<4>(p.data(), start, visited)
                                             : walk<5>(p.data(), start, visited);
  if (met >= 0) return met;
  double best = -std::numeric_limits<double>::infinity();
  std::int32_t f = start;
  for (std::int32_t g = 0; g < static_cast<std::int32_t>(facets_.size()); ++g) {
    if (!alive(g)) continue;
    ++visited;
    const AnyVector lambda = inverse(g) * p;
    const double least = lambda.minCoeff();
    if (least > best) {
      best = least;
      f = g;
    }
  }
  return f;
}

void RadialHull::mark_visible(const AnyVector& p, std::int32_t f) {
  if (visible_[f] != 0) return;
  visible_[f] = 1;
  std::size_t next = removed_.size();
  removed_.push_back(f);
  for (; next < removed_.size(); ++next) {
    for (const std::int32_t g : neighbours_of(removed_[next])) {
      if (visible_[g] != 0 || !(gauge(g, p) > 1 + kVisible)) continue;
      visible_[g] = 1;
      removed_.push_back(g);
    }
  }
}

void RadialHull::unmark() {
  for (const std::int32_t f : removed_) visible_[f] = 0;
}

/// Facets from vertex v over the horizon; false, with one more facet seen, where one of them would be degenerate.
bool RadialHull::plan_cone(std::int32_t v) {
  horizon_.clear();
  planned_.clear();
  planned_numbers_.clear();
  for (std::size_t i = 0; i < removed_.size(); ++i) {
    const std::int32_t f = removed_[i];
    for (int k = 0; k < dimension_; ++k) {
      const std::int32_t g = facets_[f].neighbour[k];
      if (visible_[g] != 0) continue;
      Facet facet = facets_[f];
      facet.vertex[k] = v;
      facet.neighbour[k] = g;
      // Same orientation as f, and the origin well inside.
      planned_numbers_.resize(planned_numbers_.size() + stride_);
      const bool regular = inverse(f).row(k).dot(vertices_[v]) > 0 &&
                           complete(facet, planned_numbers_.data() + planned_numbers_.size() - stride_);
      if (!regular) {
        mark_visible(vertices_[v], g);
        return false;
      }
      horizon_.push_back({f, k});
      planned_.push_back(facet);
    }
  }
  return true;
}

bool RadialHull::insert(const AnyVector& p, std::int32_t f) {
  removed_.clear();
  added_.clear();
  const auto v = static_cast<std::int32_t>(vertices_.size());
  vertices_.push_back(p);
  mark_visible(p, f);
  bool planned = plan_cone(v);
  // Each refusal takes one more facet into the region; a region of everything has no horizon.
  while (!planned && static_cast<std::int64_t>(removed_.size()) < alive_) planned = plan_cone(v);
  if (!planned || planned_.empty()) {
    unmark();
    vertices_.pop_back();
    removed_.clear();
    return false;
  }
  link_cone();
  return true;
}

void RadialHull::link_cone() {
  for (std::size_t i = 0; i < planned_.size(); ++i) {
    const auto id = static_cast<std::int32_t>(facets_.size());
    facets_.push_back(planned_[i]);
    added_.push_back(id);
    cone_of_[horizon_[i].facet][horizon_[i].opposite] = id;
  }
  numbers_.insert(numbers_.end(), planned_numbers_.begin(), planned_numbers_.end());
  visible_.resize(facets_.size(), 0);
  cone_of_.resize(facets_.size());
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::int32_t seen = horizon_[i].facet;
    const int k = horizon_[i].opposite;
    Facet& facet = facets_[added_[i]];
    // The other side of the horizon.
    Facet& beyond = facets_[facet.neighbour[k]];
    for (int m = 0; m < dimension_; ++m) {
      if (beyond.neighbour[m] == seen) beyond.neighbour[m] = added_[i];
    }
    // Round the ridge of codimension 2 without vertices k and j, through seen facets, to the horizon's next ridge.
    for (int j = 0; j < dimension_; ++j) {
      if (j == k) continue;
      std::int32_t at = seen;
      std::int32_t pivot = facets_[seen].vertex[k];  // enters the next facet's ridge
      int leave = j;
      while (visible_[facets_[at].neighbour[leave]] != 0) {
        const std::int32_t next = facets_[at].neighbour[leave];
        const Facet& g = facets_[next];
        int across = 0, stays = 0;
        for (int m = 0; m < dimension_; ++m) {
          if (g.vertex[m] == pivot) across = m;
        }
        for (int m = 0; m < dimension_; ++m) {
          if (g.neighbour[m] == at) stays = m;
        }
        // g holds the ridge, the pivot, and one vertex that is new: the pivot of the next step.
        pivot = g.vertex[stays];
        at = next;
        leave = across;
      }
      facet.neighbour[j] = cone_of_[at][leave];
    }
  }
  unmark();
  for (const std::int32_t f : removed_) facets_[f].successor = added_.front();
  alive_ += static_cast<std::int64_t>(added_.size()) - static_cast<std::int64_t>(removed_.size());
}

std::vector<std::int32_t> RadialHull::compact() {
  std::vector<std::int32_t> renumbered(facets_.size(), -1);
  std::int32_t next = 0;
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    if (facets_[f].successor < 0) renumbered[f] = next++;
  }
  // Successors are younger than what they succeed.
  for (std::size_t f = facets_.size(); f-- > 0;) {
    if (facets_[f].successor >= 0) renumbered[f] = renumbered[static_cast<std::size_t>(facets_[f].successor)];
  }
  std::vector<Facet> living;
  std::vector<double> numbers_left;
  living.reserve(static_cast<std::size_t>(next));
  numbers_left.reserve(static_cast<std::size_t>(next) * stride_);
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    if (facets_[f].successor >= 0) continue;
    living.push_back(facets_[f]);
    for (int k = 0; k < dimension_; ++k) {
      std::int32_t& g = living.back().neighbour[k];
      g = renumbered[static_cast<std::size_t>(g)];
    }
    const double* const from = numbers(static_cast<std::int32_t>(f));
    numbers_left.insert(numbers_left.end(), from, from + stride_);
  }
  numbers_ = std::move(numbers_left);
  facets_ = std::move(living);
  visible_.assign(facets_.size(), 0);
  cone_of_.assign(facets_.size(), {});
  removed_.clear();
  added_.clear();
  return renumbered;
}

double RadialHull::inner_radius() const {
  double largest = 0;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(facets_.size()); ++f) {
    if (alive(f)) largest = std::max(largest, normal(f).squaredNorm());
  }
  return 1 / std::sqrt(largest);
}

}  // namespace pd::dimension::detail
