#include "pd/dimension/approximate_intersection.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dimension/composed/composed_node.hpp"
#include "dimension/origin_frame.hpp"
#include "dimension/origin_search.hpp"
#include "numeric/number_text.hpp"

namespace pd::dimension {

namespace {

using detail::AnyVector;
using detail::Composed;
using detail::EllipsoidBounds;
using detail::Point;
using detail::SupportBody;

/// The differences x_1 - x_i of points of k bodies, and behind them the bodies' own residuals; for one body x_1 -
/// point. O lies here exactly when the bodies have a common point (the body holds the point).
class Meeting final : public SupportBody {
 public:
  Meeting(std::span<const Composed> bodies, const AnyVector& point)
      : bodies_(bodies), point_(point), dimension_(bodies[0]->dimension) {
    differences_ = dimension_ * std::max<Eigen::Index>(1, static_cast<Eigen::Index>(bodies.size()) - 1);
    size_ = differences_;
    for (const Composed& body : bodies) {
      size_ += body->equations;
      error_ = std::max(error_, body->epsilon);
      consistent_ = consistent_ && body->consistent;
      magnitude_ += body->magnitude;
    }
    magnitude_ += point.cwiseAbs().maxCoeff();
  }

  [[nodiscard]] Point support(const Point& direction) const override {
    Point r = Point::Zero(size_);
    AnyVector first_direction = AnyVector::Zero(dimension_);
    for (Eigen::Index i = 0; i < differences_; i += dimension_) first_direction += direction.segment(i, dimension_);
    const double* u = direction.data() + differences_;
    double* residuals = r.data() + differences_;
    AnyVector first;
    bodies_[0]->support(first_direction, u, first, residuals, counters_);
    if (bodies_.size() == 1) r.head(dimension_) = first - point_;
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      u += bodies_[i - 1]->equations;
      residuals += bodies_[i - 1]->equations;
      const Eigen::Index slot = dimension_ * static_cast<Eigen::Index>(i - 1);
      AnyVector other;
      bodies_[i]->support(-direction.segment(slot, dimension_), u, other, residuals, counters_);
      r.segment(slot, dimension_) = first - other;
    }
    return r;
  }

  [[nodiscard]] double relative_error() const override { return error_; }
  [[nodiscard]] bool consistent() const override { return consistent_; }
  [[nodiscard]] double magnitude() const override { return magnitude_; }

  [[nodiscard]] EllipsoidBounds bounds() const override {
    const auto leaf = [](const Composed& body) { return body->kind == detail::ComposedKind::leaf; };
    return size_ == dimension_ && std::all_of(bodies_.begin(), bodies_.end(), leaf) ? leaf_bounds() : composed_bounds();
  }

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] const QueryCounters& counters() const { return counters_; }

 private:
  /// Of one or two images of preprocessed bodies, from what their nodes keep.
  [[nodiscard]] EllipsoidBounds leaf_bounds() const {
    const detail::ComposedNode& first = *bodies_[0];
    EllipsoidBounds r = {first.centre - point_, first.inner, first.inner};
    double ratio = first.body.sandwich.ratio;
    if (bodies_.size() == 2) {
      const detail::ComposedNode& second = *bodies_[1];
      r.center = first.centre - second.centre;
      detail::add_to_root(r.inner, 1, second.inner);
      // Sums of roots are at most sqrt(2) times the root of the sum of squares.
      ratio = std::sqrt(2.0) * std::max(ratio, second.body.sandwich.ratio);
    }
    r.outer = ratio * r.inner;
    return r;
  }

  [[nodiscard]] EllipsoidBounds composed_bounds() const {
    const double count = static_cast<double>(bodies_.size());
    EllipsoidBounds r = EllipsoidBounds::zero(size_);
    Eigen::Index residual = differences_;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      detail::LiftedMatrix entry = detail::LiftedMatrix::Zero(size_, dimension_);
      for (Eigen::Index slot = 0; slot < differences_; slot += dimension_) {
        if (i == 0 || slot == dimension_ * static_cast<Eigen::Index>(i - 1)) {
          for (int c = 0; c < dimension_; ++c) entry(slot + c, c) = i == 0 ? 1.0 : -1.0;
        }
      }
      const EllipsoidBounds part = bodies_[i]->bounds(entry, residual);
      residual += bodies_[i]->equations;
      r.center += part.center;
      detail::add_to_root(r.inner, 1, part.inner);
      detail::add_to_root(r.outer, std::sqrt(count), part.outer);
    }
    if (bodies_.size() == 1) r.center.head(dimension_) -= point_;
    return r;
  }

  std::span<const Composed> bodies_;
  AnyVector point_;
  Eigen::Index dimension_;
  Eigen::Index differences_ = 0;
  Eigen::Index size_ = 0;
  double error_ = 0;
  double magnitude_ = 0;
  bool consistent_ = true;
  mutable QueryCounters counters_;
};

Expected<IntersectionAnswer> locate(const Meeting& meeting, double epsilon, IntersectionSearch search) {
  const bool ternary = search == IntersectionSearch::nested_ternary;
  if (ternary && !meeting.consistent()) {
    const double fatness = detail::OriginFrame(meeting).inner_radius();
    const double allowed = detail::ternary_oracle_error(epsilon, static_cast<int>(meeting.size()), fatness);
    if (!(meeting.relative_error() <= allowed)) {
      return Error{ErrorCode::bad_value,
                   "the nested ternary search over macbeath structures needs them at epsilon " +
                       std::to_string(allowed) + " or below",
                   "epsilon"};
    }
  }
  const auto method = ternary ? detail::OriginMethod::nested_ternary : detail::OriginMethod::cutting_planes;
  const detail::OriginAnswer found = detail::locate_origin(meeting, {epsilon, method});
  if (!found.decided) {
    return Error{ErrorCode::out_of_range,
                 "the bodies are too far from the origin, or too slender, for this epsilon in double precision; move "
                 "them near the origin or take a larger epsilon",
                 "epsilon"};
  }
  return IntersectionAnswer{found.contains, found.supports, found.cuts, meeting.counters()};
}

Expected<IntersectionAnswer> meet(std::span<const Composed> bodies, const AnyVector& point, double epsilon,
                                  IntersectionSearch search) {
  if (!(epsilon > 0 && epsilon < 1)) return Error{ErrorCode::bad_value, "epsilon must lie in (0, 1)", "epsilon"};
  for (const Composed& body : bodies) {
    if (body->epsilon > epsilon / 4) {
      return Error{ErrorCode::bad_value,
                   "the bodies are preprocessed at epsilon " + pd::detail::number_text(body->epsilon) +
                       "; this query needs a quarter of its own epsilon, " + pd::detail::number_text(epsilon / 4),
                   "epsilon"};
    }
  }
  const Meeting lifted(bodies, point);
  if (lifted.size() > detail::kMaxLiftedDimension) {
    return Error{ErrorCode::limit_exceeded,
                 "the bodies take " + std::to_string(lifted.size()) + " coordinates; at most " +
                     std::to_string(detail::kMaxLiftedDimension) + " are allowed",
                 ""};
  }
  return locate(lifted, epsilon, search);
}

template <int D>
std::vector<Composed> nodes_of(std::span<const ComposedBody<D>> bodies) {
  std::vector<Composed> nodes;
  for (const ComposedBody<D>& body : bodies) nodes.push_back(body.node());
  return nodes;
}

}  // namespace

template <int D>
Expected<IntersectionAnswer> approximate_intersection(std::span<const ComposedBody<D>> bodies, double epsilon,
                                                      IntersectionSearch search) {
  if (bodies.size() < 2) return Error{ErrorCode::bad_value, "at least two bodies are needed", ""};
  return meet(nodes_of<D>(bodies), AnyVector::Zero(D), epsilon, search);
}

template <int D>
Expected<IntersectionAnswer> approximate_membership(const ComposedBody<D>& body, const Vector<D>& point, double epsilon,
                                                    IntersectionSearch search) {
  if (!point.allFinite()) return Error{ErrorCode::non_finite, "the point is not finite", "point"};
  return meet(std::span(&body.node(), 1), detail::any<D>(point), epsilon, search);
}

#define PD_INSTANTIATE(D)                                                                                           \
  template Expected<IntersectionAnswer> approximate_intersection<D>(std::span<const ComposedBody<D>>, double,       \
                                                                    IntersectionSearch);                            \
  template Expected<IntersectionAnswer> approximate_membership<D>(const ComposedBody<D>&, const Vector<D>&, double, \
                                                                  IntersectionSearch);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
