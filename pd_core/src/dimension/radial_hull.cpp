#include "dimension/radial_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd::dimension::detail {

namespace {

/// How far above its plane (gauge - 1) a point must be for a facet to see it. Above the rounding of gauges in a frame
/// where everything is within a constant, and far below the least epsilon of a kernel.
constexpr double kVisible = 1e-12;
/// lambda down to this counts as inside the cone.
constexpr double kInside = -1e-12;

/// Inverse by Gauss and Jordan with partial pivots; false for a singular matrix.
template <int D>
bool invert(Matrix<D> a, Matrix<D>& r) {
  r.setIdentity();
  for (int k = 0; k < D; ++k) {
    int pivot = k;
    for (int i = k + 1; i < D; ++i) {
      if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
    }
    if (!(std::abs(a(pivot, k)) > 0)) return false;
    if (pivot != k) {
      a.row(k).swap(a.row(pivot));
      r.row(k).swap(r.row(pivot));
    }
    const double scale = 1 / a(k, k);
    a.row(k) *= scale;
    r.row(k) *= scale;
    for (int i = 0; i < D; ++i) {
      if (i == k) continue;
      const double factor = a(i, k);
      a.row(i) -= factor * a.row(k);
      r.row(i) -= factor * r.row(k);
    }
  }
  return r.allFinite();
}

}  // namespace

template <int D>
RadialHull<D>::RadialHull(double start_radius)
    : least_distance_(0.5 * start_radius / std::sqrt(static_cast<double>(D))) {
  for (int k = 0; k < D; ++k) {
    for (const double sign : {1.0, -1.0}) vertices_.push_back(sign * start_radius * Vector<D>::Unit(k));
  }
  // Facet with bits s: vertex k is +-e_k by bit k; its neighbour across the ridge without vertex k differs in that bit.
  constexpr int kFacets = 1 << D;
  for (int s = 0; s < kFacets; ++s) {
    Facet f;
    for (int k = 0; k < D; ++k) {
      f.vertex[k] = 2 * k + ((s >> k) & 1);
      f.neighbour[k] = s ^ (1 << k);
    }
    f.successor = -1;
    complete(f);
    facets_.push_back(f);
  }
  alive_ = kFacets;
  visible_.assign(facets_.size(), 0);
  cone_of_.resize(facets_.size());
}

/// Inverse and normal from the vertices; false where the facet is degenerate or comes too near to the origin.
template <int D>
bool RadialHull<D>::complete(Facet& facet) const {
  Matrix<D> columns;
  for (int k = 0; k < D; ++k) columns.col(k) = vertices_[facet.vertex[k]];
  if (!invert<D>(columns, facet.inverse)) return false;
  facet.normal = facet.inverse.colwise().sum().transpose();
  return facet.normal.norm() * least_distance_ <= 1;
}

template <int D>
std::int32_t RadialHull<D>::locate(const Vector<D>& p, std::int32_t start, std::int64_t& visited) const {
  std::int32_t f = start;
  while (facets_[f].successor >= 0) f = facets_[f].successor;
  std::int32_t previous = -1;
  double previous_least = 0;
  // Straight walks take about the number of facets to the power 1 / (D - 1); a longer one goes round in circles.
  for (std::int64_t steps = 0; steps < 200 + alive_; ++steps) {
    ++visited;
    const Vector<D> lambda = facets_[f].inverse * p;
    // The place of the least, by conditional moves: which it is cannot be foretold.
    double least = lambda[0];
    std::size_t k = 0;
    for (std::size_t j = 1; j < D; ++j) {
      k += (j - k) & (std::size_t{0} - static_cast<std::size_t>(lambda[j] < least));
      least = std::min(lambda[j], least);
    }
    if (least >= kInside) return f;
    const std::int32_t next = facets_[f].neighbour[k];
    // On a ridge within rounding, each side sends the point to the other.
    if (next == previous && steps > 0) return least > previous_least ? f : previous;
    previous = f;
    previous_least = least;
    f = next;
  }
  double best = -std::numeric_limits<double>::infinity();
  for (std::int32_t g = 0; g < static_cast<std::int32_t>(facets_.size()); ++g) {
    if (!alive(g)) continue;
    ++visited;
    const double least = (facets_[g].inverse * p).minCoeff();
    if (least > best) {
      best = least;
      f = g;
    }
  }
  return f;
}

template <int D>
void RadialHull<D>::mark_visible(const Vector<D>& p, std::int32_t f) {
  if (visible_[f] != 0) return;
  visible_[f] = 1;
  std::size_t next = removed_.size();
  removed_.push_back(f);
  for (; next < removed_.size(); ++next) {
    for (const std::int32_t g : facets_[removed_[next]].neighbour) {
      if (visible_[g] != 0 || !(gauge(g, p) > 1 + kVisible)) continue;
      visible_[g] = 1;
      removed_.push_back(g);
    }
  }
}

template <int D>
void RadialHull<D>::unmark() {
  for (const std::int32_t f : removed_) visible_[f] = 0;
}

/// Facets from vertex v over the horizon; false, with one more facet seen, where one of them would be degenerate.
template <int D>
bool RadialHull<D>::plan_cone(std::int32_t v) {
  horizon_.clear();
  planned_.clear();
  for (std::size_t i = 0; i < removed_.size(); ++i) {
    const std::int32_t f = removed_[i];
    for (int k = 0; k < D; ++k) {
      const std::int32_t g = facets_[f].neighbour[k];
      if (visible_[g] != 0) continue;
      Facet facet = facets_[f];
      facet.vertex[k] = v;
      facet.neighbour[k] = g;
      // Same orientation as f, and the origin well inside.
      const bool regular = facets_[f].inverse.row(k).dot(vertices_[v]) > 0 && complete(facet);
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

template <int D>
bool RadialHull<D>::insert(const Vector<D>& p, std::int32_t f) {
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

template <int D>
void RadialHull<D>::link_cone() {
  for (std::size_t i = 0; i < planned_.size(); ++i) {
    const auto id = static_cast<std::int32_t>(facets_.size());
    facets_.push_back(planned_[i]);
    added_.push_back(id);
    cone_of_[horizon_[i].facet][horizon_[i].opposite] = id;
  }
  visible_.resize(facets_.size(), 0);
  cone_of_.resize(facets_.size());
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const std::int32_t seen = horizon_[i].facet;
    const int k = horizon_[i].opposite;
    Facet& facet = facets_[added_[i]];
    // The other side of the horizon.
    Facet& beyond = facets_[facet.neighbour[k]];
    for (int m = 0; m < D; ++m) {
      if (beyond.neighbour[m] == seen) beyond.neighbour[m] = added_[i];
    }
    // Round the ridge of codimension 2 without vertices k and j, through seen facets, to the horizon's next ridge.
    for (int j = 0; j < D; ++j) {
      if (j == k) continue;
      std::int32_t at = seen;
      std::int32_t pivot = facets_[seen].vertex[k];  // enters the next facet's ridge
      int leave = j;
      while (visible_[facets_[at].neighbour[leave]] != 0) {
        const std::int32_t next = facets_[at].neighbour[leave];
        const Facet& g = facets_[next];
        int across = 0, stays = 0;
        for (int m = 0; m < D; ++m) {
          if (g.vertex[m] == pivot) across = m;
        }
        for (int m = 0; m < D; ++m) {
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

template <int D>
std::vector<std::int32_t> RadialHull<D>::compact() {
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
  living.reserve(static_cast<std::size_t>(next));
  for (const Facet& f : facets_) {
    if (f.successor >= 0) continue;
    living.push_back(f);
    for (std::int32_t& g : living.back().neighbour) g = renumbered[static_cast<std::size_t>(g)];
  }
  facets_ = std::move(living);
  visible_.assign(facets_.size(), 0);
  cone_of_.assign(facets_.size(), {});
  removed_.clear();
  added_.clear();
  return renumbered;
}

template <int D>
double RadialHull<D>::inner_radius() const {
  double largest = 0;
  for (const Facet& f : facets_) {
    if (f.successor < 0) largest = std::max(largest, f.normal.squaredNorm());
  }
  return 1 / std::sqrt(largest);
}

template class RadialHull<2>;
template class RadialHull<3>;
template class RadialHull<4>;
template class RadialHull<5>;

}  // namespace pd::dimension::detail
