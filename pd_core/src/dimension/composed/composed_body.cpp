#include "pd/dimension/composed_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "dimension/composed/composed_node.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension {

namespace detail {

template <int D>
double ComposedNode<D>::support(const Vector<D>& v, const double* u, Vector<D>& value, double* residuals,
                                QueryCounters& counters) const {
  switch (kind) {
    case ComposedKind::leaf:
      value = map.apply(body->support(map.pull_back(v), counters).point);
      return v.dot(value);
    case ComposedKind::sum: {
      value.setZero();
      double reach = 0;
      Vector<D> part_value;
      for (const ComposedBody<D>& part : parts) {
        reach += part.node().support(v, u, part_value, residuals, counters);
        value += part_value;
        u += part.node().equations;
        residuals += part.node().equations;
      }
      return reach;
    }
    case ComposedKind::hull: {
      double best = -std::numeric_limits<double>::infinity();
      double* winner = residuals;
      double* slot = residuals;
      int winner_size = 0;
      Vector<D> part_value;
      for (const ComposedBody<D>& part : parts) {
        const double reach = part.node().support(v, u, part_value, slot, counters);
        if (reach > best) {
          std::fill(winner, winner + winner_size, 0.0);
          best = reach;
          value = part_value;
          winner = slot;
          winner_size = part.node().equations;
        } else {
          std::fill(slot, slot + part.node().equations, 0.0);
        }
        u += part.node().equations;
        slot += part.node().equations;
      }
      return best;
    }
    case ComposedKind::intersection:
      break;
  }
  const auto others = parts.size() - 1;
  Vector<D> first_direction = v;
  for (std::size_t i = 0; i < others; ++i) first_direction += Eigen::Map<const Vector<D>>(u + D * i);
  const double* inner_u = u + D * others;
  double* inner_residuals = residuals + D * others;
  double reach = parts[0].node().support(first_direction, inner_u, value, inner_residuals, counters);
  for (std::size_t i = 0; i < others; ++i) {
    inner_u += parts[i].node().equations;
    inner_residuals += parts[i].node().equations;
    Vector<D> other;
    const Vector<D> direction = -Eigen::Map<const Vector<D>>(u + D * i);
    reach += parts[i + 1].node().support(direction, inner_u, other, inner_residuals, counters);
    Eigen::Map<Vector<D>>(residuals + D * i) = value - other;
  }
  return reach;
}

template <int D>
EllipsoidBounds ComposedNode<D>::bounds(const LiftedMatrix& entry, Eigen::Index first_residual) const {
  const Eigen::Index size = entry.rows();
  if (kind == ComposedKind::leaf) {
    const Sandwich<D>& sandwich = body->sandwich();
    EllipsoidBounds r = EllipsoidBounds::zero(size);
    r.center = product(entry, Point(map.apply(sandwich.centre)));
    add_to_root(r.inner, 1, product(entry, LiftedMatrix(map.linear * sandwich.axes)));
    r.outer = sandwich.ratio * r.inner;
    return r;
  }
  const double count = static_cast<double>(parts.size());
  EllipsoidBounds r = EllipsoidBounds::zero(size);
  if (kind == ComposedKind::hull) {
    // With c the mean of the parts' centres: h(v) - <c, v> is at least the mean of |inner_i^T v|, and at most
    // |<c_i - c, v>| + |outer_i^T v| for some i, whose square is at most 2 (<c_i - c, v>^2 + |outer_i^T v|^2).
    std::vector<EllipsoidBounds> each;
    for (const ComposedBody<D>& part : parts) {
      each.push_back(part.node().bounds(entry, first_residual));
      first_residual += part.node().equations;
      r.center += each.back().center / count;
    }
    for (const EllipsoidBounds& part : each) {
      const Point aside = part.center - r.center;
      add_to_root(r.inner, 1 / count, part.inner);
      add_to_root(r.outer, std::sqrt(2.0), part.outer);
      add_to_root(r.outer, std::sqrt(2.0), aside);
    }
    return r;
  }
  Eigen::Index slot =
      first_residual + (kind == ComposedKind::intersection ? D * static_cast<Eigen::Index>(parts.size() - 1) : 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    LiftedMatrix part_entry = entry;
    if (kind == ComposedKind::intersection) {
      if (i > 0) part_entry.setZero();
      for (std::size_t k = 1; k < parts.size(); ++k) {
        if (i != 0 && i != k) continue;
        const Eigen::Index row = first_residual + D * static_cast<Eigen::Index>(k - 1);
        for (int c = 0; c < D; ++c) part_entry(row + c, c) += i == 0 ? 1.0 : -1.0;
      }
    }
    const EllipsoidBounds part = parts[i].node().bounds(part_entry, slot);
    slot += parts[i].node().equations;
    r.center += part.center;
    // Sums of roots are at least the root of the sum of squares, and at most sqrt(count) times that.
    add_to_root(r.inner, 1, part.inner);
    add_to_root(r.outer, std::sqrt(count), part.outer);
  }
  return r;
}

}  // namespace detail

template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::of(DirectionalWidth<D> body, const AffineMap<D>& map) {
  if (!map.linear.allFinite() || !map.translation.allFinite()) {
    return Error{ErrorCode::non_finite, "the affine map holds a number that is not finite", "affine"};
  }
  const double scale = map.linear.cwiseAbs().maxCoeff();
  const Matrix<D> unit = map.linear / (scale > 0 ? scale : 1);
  if (!inverse_if_regular<D>(unit)) {
    return Error{ErrorCode::bad_value, "the matrix is singular; the image would be flat", "affine.matrix"};
  }
  auto node = std::make_shared<detail::ComposedNode<D>>();
  const Sandwich<D>& sandwich = body.sandwich();
  const Matrix<D> axes = map.linear * sandwich.axes;
  // Of the image and of the terms that it is summed from.
  node->magnitude = map.linear.cwiseAbs().rowwise().sum().maxCoeff() *
                        (sandwich.centre.cwiseAbs().maxCoeff() + sandwich.ratio * sandwich.axes.norm()) +
                    map.translation.cwiseAbs().maxCoeff() + sandwich.ratio * axes.norm();
  if (!(node->magnitude < kMaxCoordinate)) {
    return Error{ErrorCode::out_of_range, "the image's coordinates exceed 1e100", "affine"};
  }
  node->epsilon = body.backend() == Backend::exact ? 0 : body.epsilon();
  node->consistent = body.backend() != Backend::macbeath;
  node->centre = map.apply(sandwich.centre);
  detail::LiftedMatrix inner = detail::LiftedMatrix::Zero(D, D);
  detail::add_to_root(inner, 1, axes);
  node->inner = inner;
  node->body = std::move(body);
  node->map = map;
  return ComposedBody(std::move(node));
}

template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::make(int kind, std::vector<ComposedBody> parts) {
  if (parts.empty()) return Error{ErrorCode::bad_value, "an empty list of bodies; at least one is needed", ""};
  if (parts.size() == 1) return parts[0];
  auto node = std::make_shared<detail::ComposedNode<D>>();
  node->kind = static_cast<detail::ComposedKind>(kind);
  node->radial = node->kind == detail::ComposedKind::sum;
  std::size_t equations = node->kind == detail::ComposedKind::intersection ? D * (parts.size() - 1) : 0;
  for (const ComposedBody& part : parts) {
    equations += static_cast<std::size_t>(part.equations());
    node->epsilon = std::max(node->epsilon, part.epsilon());
    node->radial = node->radial && part.node().radial;
    node->consistent = node->consistent && part.node().consistent;
    node->magnitude += part.node().magnitude;
  }
  if (equations > kMaxEquations) {
    return Error{ErrorCode::limit_exceeded,
                 "the intersections take " + std::to_string(equations) + " equations; at most " +
                     std::to_string(kMaxEquations) + " are allowed",
                 ""};
  }
  node->equations = static_cast<int>(equations);
  node->parts = std::move(parts);
  return ComposedBody(std::move(node));
}

template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::sum_of(std::vector<ComposedBody> parts) {
  return make(static_cast<int>(detail::ComposedKind::sum), std::move(parts));
}
template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::hull_of(std::vector<ComposedBody> parts) {
  return make(static_cast<int>(detail::ComposedKind::hull), std::move(parts));
}
template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::intersection_of(std::vector<ComposedBody> parts) {
  return make(static_cast<int>(detail::ComposedKind::intersection), std::move(parts));
}

template <int D>
double ComposedBody<D>::epsilon() const {
  return node_->epsilon;
}
template <int D>
int ComposedBody<D>::equations() const {
  return node_->equations;
}

template <int D>
SupportPoint<D> ComposedBody<D>::support(const Vector<D>& direction, QueryCounters& counters) const {
  SupportPoint<D> r;
  r.value = node_->support(direction, nullptr, r.point, nullptr, counters);
  return r;
}

#define PD_INSTANTIATE(D)         \
  template class ComposedBody<D>; \
  template struct detail::ComposedNode<D>;
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
