#include "pd/dimension/approximate_minkowski_sum.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dimension/composed_node.hpp"
#include "dimension/equal_planes.hpp"
#include "dimension/joggle.hpp"
#include "dimension/radial_hull.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace {

/// Rounding in the frame, relative; far below the least epsilon.
constexpr double kRoom = 1e-9;

/// Grows a polytope inside K until it holds K shrunk by `limit`.
template <int D>
class GrowingSum {
 public:
  explicit GrowingSum(const ComposedBody<D>& sum) : sum_(sum), hull_(0.5) {
    const detail::EllipsoidBounds<D> bounds = sum.node().template bounds<D>(Matrix<D>::Identity(), 0);
    frame_.linear = inverse_of<D>(bounds.inner);
    frame_.translation = -(frame_.linear * bounds.center);
    ratio_ = (frame_.linear * bounds.outer).norm();
  }

  /// How far K reaches in the frame, in which it holds the unit ball.
  [[nodiscard]] double ratio() const { return ratio_; }

  /// @return false where rounding leaves no surface.
  bool grow(double limit) {
    enter_facets(0);
    while (!waiting_.empty()) {
      std::pop_heap(waiting_.begin(), waiting_.end());
      const Waiting next = waiting_.back();
      waiting_.pop_back();
      if (!hull_.alive(next.facet)) continue;
      if (certify(next) <= limit) continue;
      const std::size_t before = hull_.facets().size();
      const double nearer = detail::joggle<D>(static_cast<std::int64_t>(hull_.vertices().size()), limit);
      const Vector<D> point = (1 - nearer) * next.support;
      if (!hull_.insert(point, next.facet)) return false;
      enter_facets(before);
    }
    return true;
  }

  [[nodiscard]] const detail::RadialHull<D>& hull() const { return hull_; }
  [[nodiscard]] const AffineMap<D>& frame() const { return frame_; }
  /// Bounds h_K over a living facet's normal, whose plane is at 1.
  [[nodiscard]] double upper(std::int32_t facet) const { return upper_[static_cast<std::size_t>(facet)]; }
  [[nodiscard]] const QueryCounters& counters() const { return counters_; }
  [[nodiscard]] std::int64_t supports() const { return supports_; }

 private:
  struct Waiting {
    double height;
    std::int32_t facet;
    Vector<D> support;
    friend bool operator<(const Waiting& a, const Waiting& b) {
      return a.height != b.height ? a.height < b.height : a.facet > b.facet;
    }
  };

  Vector<D> support(const Vector<D>& normal) {
    ++supports_;
    return frame_.apply(sum_.support(frame_.pull_back(normal), counters_).point);
  }

  void enter_facets(std::size_t from) {
    upper_.resize(hull_.facets().size(), 0.0);
    for (std::size_t f = from; f < hull_.facets().size(); ++f) {
      const auto id = static_cast<std::int32_t>(f);
      if (!hull_.alive(id)) continue;
      const Vector<D> normal = hull_.facets()[f].normal;
      const Vector<D> p = support(normal);
      waiting_.push_back({normal.dot(p), id, p});
      std::push_heap(waiting_.begin(), waiting_.end());
    }
  }

  /// An upper bound of h_K over the facet's normal.
  double certify(const Waiting& facet) {
    const double error = sum_.epsilon();
    double bound = facet.height;
    if (sum_.node().radial) {
      bound /= 1 - error;
    } else if (error > 0) {
      const Vector<D> normal = hull_.facets()[static_cast<std::size_t>(facet.facet)].normal;
      bound += error / (1 - error) * (facet.height + (-normal).dot(support(-normal)));
    }
    return upper_[static_cast<std::size_t>(facet.facet)] = std::max(bound, 1.0) * (1 + kRoom);
  }

  const ComposedBody<D>& sum_;
  AffineMap<D> frame_;
  double ratio_ = 1;
  detail::RadialHull<D> hull_;
  std::vector<Waiting> waiting_;  ///< a heap
  std::vector<double> upper_;     ///< per facet, once certified
  QueryCounters counters_;
  std::int64_t supports_ = 0;
};

template <int D>
std::vector<Vector<D>> points_of(const GrowingSum<D>& grown, double factor) {
  const auto& hull = grown.hull();
  std::vector<char> used(hull.vertices().size(), 0);
  for (std::size_t f = 0; f < hull.facets().size(); ++f) {
    if (!hull.alive(static_cast<std::int32_t>(f))) continue;
    for (const std::int32_t v : hull.facets()[f].vertex) used[static_cast<std::size_t>(v)] = 1;
  }
  const AffineMap<D> back = grown.frame().inverse();
  std::vector<Vector<D>> r;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] != 0) r.push_back(back.apply(factor * hull.vertices()[v]));
  }
  return r;
}

template <int D>
std::vector<Halfspace<D>> halfspaces_of(const GrowingSum<D>& grown, Side side) {
  const auto& hull = grown.hull();
  const std::vector<std::int32_t> same = detail::merge_equal_planes(hull);
  std::vector<Halfspace<D>> r;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(same.size()); ++f) {
    if (same[static_cast<std::size_t>(f)] != f) continue;
    const Vector<D>& plane = hull.facets()[static_cast<std::size_t>(f)].normal;
    const Vector<D> normal = grown.frame().pull_back(plane);
    const double offset = (side == Side::outer ? grown.upper(f) : 1 - kRoom) - plane.dot(grown.frame().translation);
    const double length = normal.norm();
    r.push_back({normal / length, offset / length});
  }
  return r;
}

}  // namespace

template <int D>
Expected<ApproximateSum<D>> approximate_minkowski_sum(const ComposedBody<D>& sum, double epsilon,
                                                      Representation representation, Side side) {
  const pd::detail::FloatingPointGuard guard;
  if (!(epsilon >= 1e-6 && epsilon < 1)) {
    return Error{ErrorCode::bad_value, "epsilon must lie in [1e-6, 1)", "epsilon"};
  }
  if (sum.equations() > 0) {
    return Error{ErrorCode::unsupported, "an intersection has no support without a search; its parts can be asked", ""};
  }
  GrowingSum<D> grown(sum);
  const double needed = sum.node().radial ? epsilon / 4 : epsilon / (8 * (1 + grown.ratio()));
  if (sum.epsilon() > needed) {
    return Error{ErrorCode::bad_value,
                 "the bodies are preprocessed at epsilon " + std::to_string(sum.epsilon()) + "; this query needs " +
                     std::to_string(needed),
                 "epsilon"};
  }
  // Outer: blown up by 1 + epsilon / 2 about a point inside, no support grows by more than epsilon / 2 of the width.
  const double limit = side == Side::outer ? 1 + epsilon / 2 * (1 - 1e-4) : 1 / (1 - epsilon * (1 - 1e-4));
  if (!grown.grow(limit)) {
    return Error{ErrorCode::out_of_range, "the bodies are too slender for this epsilon in double precision", "epsilon"};
  }
  ApproximateSum<D> r;
  r.body.representation = representation;
  std::vector<Vector<D>> points = points_of(
      grown, side == Side::outer && representation == Representation::points ? limit * (1 + kRoom) : 1 - kRoom);
  std::vector<Halfspace<D>> halfspaces = halfspaces_of(grown, side);
  r.vertices = static_cast<std::int64_t>(points.size());
  r.facets = static_cast<std::int64_t>(halfspaces.size());
  if (representation == Representation::points) {
    r.body.points = std::move(points);
  } else {
    r.body.halfspaces = std::move(halfspaces);
  }
  r.support_calls = grown.supports();
  r.counters = grown.counters();
  return r;
}

#define PD_INSTANTIATE(D)                                                                                           \
  template Expected<ApproximateSum<D>> approximate_minkowski_sum<D>(const ComposedBody<D>&, double, Representation, \
                                                                    Side);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
