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

double ComposedNode::support(const AnyVector& v, const double* u, AnyVector& value, double* residuals,
                             QueryCounters& counters) const {
  switch (kind) {
    case ComposedKind::leaf:
      value = map.apply(body.structure->support(map.pull_back(v), counters).point);
      return dot(v.data(), value.data(), v.size());
    case ComposedKind::sum: {
      value.setZero(dimension);
      double reach = 0;
      AnyVector part_value;
      for (const Composed& part : parts) {
        reach += part->support(v, u, part_value, residuals, counters);
        value += part_value;
        u += part->equations;
        residuals += part->equations;
      }
      return reach;
    }
    case ComposedKind::hull: {
      double best = -std::numeric_limits<double>::infinity();
      double* winner = residuals;
      double* slot = residuals;
      int winner_size = 0;
      AnyVector part_value;
      for (const Composed& part : parts) {
        const double reach = part->support(v, u, part_value, slot, counters);
        if (reach > best) {
          std::fill(winner, winner + winner_size, 0.0);
          best = reach;
          value = part_value;
          winner = slot;
          winner_size = part->equations;
        } else {
          std::fill(slot, slot + part->equations, 0.0);
        }
        u += part->equations;
        slot += part->equations;
      }
      return best;
    }
    case ComposedKind::intersection:
      break;
  }
  const auto d = static_cast<std::size_t>(dimension);
  const auto others = parts.size() - 1;
  AnyVector first_direction = v;
  for (std::size_t i = 0; i < others; ++i) first_direction += Eigen::Map<const AnyVector>(u + d * i, dimension);
  const double* inner_u = u + d * others;
  double* inner_residuals = residuals + d * others;
  double reach = parts[0]->support(first_direction, inner_u, value, inner_residuals, counters);
  for (std::size_t i = 0; i < others; ++i) {
    inner_u += parts[i]->equations;
    inner_residuals += parts[i]->equations;
    AnyVector other;
    const AnyVector direction = -Eigen::Map<const AnyVector>(u + d * i, dimension);
    reach += parts[i + 1]->support(direction, inner_u, other, inner_residuals, counters);
    Eigen::Map<AnyVector>(residuals + d * i, dimension) = value - other;
  }
  return reach;
}

EllipsoidBounds ComposedNode::bounds(const LiftedMatrix& entry, Eigen::Index first_residual) const {
  const Eigen::Index size = entry.rows();
  if (kind == ComposedKind::leaf) {
    const AnySandwich& sandwich = body.sandwich;
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
    for (const Composed& part : parts) {
      each.push_back(part->bounds(entry, first_residual));
      first_residual += part->equations;
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
      first_residual +
      (kind == ComposedKind::intersection ? dimension * static_cast<Eigen::Index>(parts.size() - 1) : 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    LiftedMatrix part_entry = entry;
    if (kind == ComposedKind::intersection) {
      if (i > 0) part_entry.setZero();
      for (std::size_t k = 1; k < parts.size(); ++k) {
        if (i != 0 && i != k) continue;
        const Eigen::Index row = first_residual + dimension * static_cast<Eigen::Index>(k - 1);
        for (int c = 0; c < dimension; ++c) part_entry(row + c, c) += i == 0 ? 1.0 : -1.0;
      }
    }
    const EllipsoidBounds part = parts[i]->bounds(part_entry, slot);
    slot += parts[i]->equations;
    r.center += part.center;
    // Sums of roots are at least the root of the sum of squares, and at most sqrt(count) times that.
    add_to_root(r.inner, 1, part.inner);
    add_to_root(r.outer, std::sqrt(count), part.outer);
  }
  return r;
}

AnySupport ComposedNode::support(const AnyVector& v, QueryCounters& counters) const {
  AnySupport r;
  r.value = support(v, nullptr, r.point, nullptr, counters);
  return r;
}

Expected<Composed> leaf_of(PreparedBody body, const AnyMap& map) {
  if (!map.linear.allFinite() || !map.translation.allFinite()) {
    return Error{ErrorCode::non_finite, "the affine map holds a number that is not finite", "affine"};
  }
  const double scale = map.linear.cwiseAbs().maxCoeff();
  const AnyMatrix unit = map.linear / (scale > 0 ? scale : 1);
  if (!inverse_if_regular<kAnyDimension>(unit)) {
    return Error{ErrorCode::bad_value, "the matrix is singular; the image would be flat", "affine.matrix"};
  }
  auto node = std::make_shared<ComposedNode>();
  node->dimension = static_cast<int>(map.translation.size());
  const AnySandwich& sandwich = body.sandwich;
  const AnyMatrix axes = map.linear * sandwich.axes;
  // Of the image and of the terms that it is summed from.
  node->magnitude = map.linear.cwiseAbs().rowwise().sum().maxCoeff() *
                        (sandwich.centre.cwiseAbs().maxCoeff() + sandwich.ratio * sandwich.axes.norm()) +
                    map.translation.cwiseAbs().maxCoeff() + sandwich.ratio * axes.norm();
  if (!(node->magnitude < kMaxCoordinate)) {
    return Error{ErrorCode::out_of_range, "the image's coordinates exceed 1e100", "affine"};
  }
  node->epsilon = body.backend == Backend::exact ? 0 : body.epsilon;
  node->consistent = body.backend != Backend::macbeath;
  node->centre = map.apply(sandwich.centre);
  LiftedMatrix inner = LiftedMatrix::Zero(node->dimension, node->dimension);
  add_to_root(inner, 1, axes);
  node->inner = inner;
  node->body = std::move(body);
  node->map = map;
  return Composed(std::move(node));
}

Expected<Composed> composed_of(ComposedKind kind, std::vector<Composed> parts) {
  if (parts.empty()) return Error{ErrorCode::bad_value, "an empty list of bodies; at least one is needed", ""};
  if (parts.size() == 1) return parts[0];
  auto node = std::make_shared<ComposedNode>();
  node->kind = kind;
  node->dimension = parts[0]->dimension;
  node->radial = node->kind == ComposedKind::sum;
  std::size_t equations =
      node->kind == ComposedKind::intersection ? static_cast<std::size_t>(node->dimension) * (parts.size() - 1) : 0;
  for (const Composed& part : parts) {
    equations += static_cast<std::size_t>(part->equations);
    node->epsilon = std::max(node->epsilon, part->epsilon);
    node->radial = node->radial && part->radial;
    node->consistent = node->consistent && part->consistent;
    node->magnitude += part->magnitude;
  }
  if (equations > kMaxEquations) {
    return Error{ErrorCode::limit_exceeded,
                 "the intersections take " + std::to_string(equations) + " equations; at most " +
                     std::to_string(kMaxEquations) + " are allowed",
                 ""};
  }
  node->equations = static_cast<int>(equations);
  node->parts = std::move(parts);
  return Composed(std::move(node));
}

}  // namespace detail

template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::of(DirectionalWidth<D> body, const AffineMap<D>& map) {
  const auto leaf = detail::leaf_of({body.structure(), detail::any<D>(body.sandwich()), body.epsilon(), body.backend()},
                                    detail::any<D>(map));
  if (!leaf) return leaf.error();
  return ComposedBody(*leaf);
}

template <int D>
Expected<ComposedBody<D>> ComposedBody<D>::make(int kind, std::vector<ComposedBody> parts) {
  std::vector<detail::Composed> nodes;
  for (const ComposedBody& part : parts) nodes.push_back(part.node_);
  const auto made = detail::composed_of(static_cast<detail::ComposedKind>(kind), std::move(nodes));
  if (!made) return made.error();
  return ComposedBody(*made);
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
  return detail::fixed<D>(node_->support(detail::any<D>(direction), counters));
}

template class ComposedBody<2>;
template class ComposedBody<3>;
template class ComposedBody<4>;
template class ComposedBody<5>;

}  // namespace pd::dimension
