#include "dimension/weighted_ellipsoid.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/small_decompositions.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

/// Relative to the largest distance: residuals below are rounding (about 2 D roundings of 2^-53 each, with room).
constexpr double kFlat = 0x1p-44;
/// How far beyond the core's outer ellipsoid a point of a stream may lie before it joins.
constexpr double kFarSlack = 2;

/// The ascent in the frame: weights u on lifted points q = (y, 1), w_i = q_i^T Lambda^-1 q_i, Lambda = sum u q q^T.
template <int D>
class Ascent {
  static constexpr int L = D + 1;
  using Lifted = Eigen::Matrix<double, L, 1, Eigen::DontAlign>;
  using Moments = Eigen::Matrix<double, L, L, Eigen::DontAlign>;

 public:
  explicit Ascent(const std::vector<Vector<D>>& y) : weights_(y.size(), 1 / static_cast<double>(y.size())) {
    for (const Vector<D>& p : y) {
      Lifted q;
      q << p, 1.0;
      lifted_.push_back(q);
    }
  }

  /// Steps until the outer excess is at most `excess` in units of L; returns their number.
  std::int64_t run(double excess) {
    std::int64_t steps = 0;
    for (;; ++steps) {
      if (steps % kRefresh == 0) refresh();
      std::size_t most = 0, least = lifted_.size();
      for (std::size_t i = 0; i < lifted_.size(); ++i) {
        if (w_[i] > w_[most]) most = i;
        if (weights_[i] > 0 && (least == lifted_.size() || w_[i] < w_[least])) least = i;
      }
      const double above = w_[most] / L - 1, below = 1 - w_[least] / L;
      if (above <= excess) {
        // The incremental w drift; the decision is made on fresh ones.
        if (steps % kRefresh == 0) return steps;
        refresh();
        if (*std::max_element(w_.begin(), w_.end()) / L - 1 <= excess) return steps;
        continue;
      }
      if (above >= below) {
        step(most, (w_[most] / L - 1) / (w_[most] - 1));
      } else {
        // Away: at most the whole weight, which the step's other end reaches.
        const double whole = -weights_[least] / (1 - weights_[least]);
        const double optimal = w_[least] > 1 ? (w_[least] / L - 1) / (w_[least] - 1) : whole;
        step(least, std::max(optimal, whole));
      }
    }
  }

  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }

 private:
  static constexpr std::int64_t kRefresh = 64;

  void refresh() {
    Moments moments = Moments::Zero();
    for (std::size_t i = 0; i < lifted_.size(); ++i) moments += weights_[i] * lifted_[i] * lifted_[i].transpose();
    pd::detail::SmallElimination(moments.data(), L).inverse(inverse_.data());
    w_.resize(lifted_.size());
    for (std::size_t i = 0; i < lifted_.size(); ++i) w_[i] = lifted_[i].dot(inverse_ * lifted_[i]);
  }

  /// u <- (1 - beta) u + beta e_j; Lambda^-1 and w by the rank-one update.
  void step(std::size_t j, double beta) {
    for (double& u : weights_) u *= 1 - beta;
    weights_[j] = std::max(0.0, weights_[j] + beta);
    const Lifted z = inverse_ * lifted_[j];
    const double factor = beta / (1 - beta + beta * w_[j]);
    inverse_ = (inverse_ - factor * z * z.transpose()) / (1 - beta);
    for (std::size_t i = 0; i < lifted_.size(); ++i) {
      const double along = z.dot(lifted_[i]);
      w_[i] = (w_[i] - factor * along * along) / (1 - beta);
    }
  }

  std::vector<Lifted> lifted_;
  std::vector<double> weights_;
  std::vector<double> w_;
  Moments inverse_;
};

}  // namespace

template <int D>
SpanningFrame<D> spanning_frame(std::span<const Vector<D>> points) {
  SpanningFrame<D> frame;
  if (points.empty()) return frame;
  const auto farthest = [&](const auto& squared) {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double s = squared(points[i]);
      if (s > most) {
        most = s;
        best = i;
      }
    }
    return best;
  };
  const Vector<D> start = points[0];
  const Vector<D> origin = points[farthest([&](const Vector<D>& p) { return (p - start).squaredNorm(); })];
  Matrix<D> axes = Matrix<D>::Zero();  // columns
  Vector<D> scales = Vector<D>::Ones();
  const auto residual = [&](const Vector<D>& p, int rank) {
    Vector<D> r = p - origin;
    // Twice, for the digits that a needle's long axis takes away.
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k < rank; ++k) r -= axes.col(k).dot(r) * axes.col(k);
    }
    return r;
  };
  for (int k = 0; k < D; ++k) {
    const std::size_t best = farthest([&](const Vector<D>& p) { return residual(p, k).squaredNorm(); });
    const Vector<D> r = residual(points[best], k);
    const double length = r.norm();
    if (!(length > kFlat * scales[0]) && k > 0) break;
    if (!(length > 0)) break;
    axes.col(k) = r / length;
    scales[k] = length;
    frame.rank = k + 1;
  }
  frame.largest_scale = scales[0];
  frame.smallest_scale = frame.rank == D ? scales.minCoeff() : 0;
  frame.to_frame.linear = scales.cwiseInverse().asDiagonal() * axes.transpose();
  frame.to_frame.translation = -(frame.to_frame.linear * origin);
  return frame;
}

template <int D>
bool core_ellipsoid(std::span<const Vector<D>> points, double eta, Sandwich<D>& sandwich, std::int64_t& steps) {
  const SpanningFrame<D> frame = spanning_frame<D>(points);
  if (frame.rank < D) return false;
  const Vector<D> origin = -(inverse_of<D>(frame.to_frame.linear) * frame.to_frame.translation);
  std::vector<Vector<D>> y;
  y.reserve(points.size());
  for (const Vector<D>& p : points) y.push_back(frame.to_frame.linear * (p - origin));
  Ascent<D> ascent(y);
  // R^2 = (D + 1) (1 + excess) - 1 <= D (1 + eta).
  steps += ascent.run(eta * D / (D + 1));

  Vector<D> mean = Vector<D>::Zero();
  for (std::size_t i = 0; i < y.size(); ++i) mean += ascent.weights()[i] * y[i];
  Matrix<D> covariance = Matrix<D>::Zero();
  for (std::size_t i = 0; i < y.size(); ++i) {
    const Vector<D> x = y[i] - mean;
    covariance += ascent.weights()[i] * x * x.transpose();
  }
  const pd::detail::SmallCholesky root(covariance.data(), D);
  if (!root.positive()) return false;
  double squared = 0;
  for (const Vector<D>& p : y) {
    Vector<D> x = p - mean;
    root.solve_lower(x.data());
    squared = std::max(squared, x.squaredNorm());
  }
  squared *= 1 + 1e-9;  // the roundings of the solve, in a frame where the covariance is well conditioned
  const Matrix<D> from_frame = inverse_of<D>(frame.to_frame.linear);
  sandwich.centre = origin + from_frame * mean;
  sandwich.axes = from_frame * Eigen::Map<const Matrix<D>>(root.lower()) / std::sqrt(squared);
  sandwich.ratio = squared;
  return true;
}

template <int D>
void CoreSet<D>::add(std::span<const Vector<D>> chunk) {
  const Vector<D>* p = chunk.data();
  const Vector<D>* const end = p + chunk.size();
  while (p != end && !full_) extend_span(*p++);
  while (p != end) {
    const double limit = kFarSlack * kFarSlack * sandwich_.ratio * sandwich_.ratio;
    const Matrix<D> linear = to_unit_.linear;
    const Vector<D> centre = sandwich_.centre;
    while (p != end && (linear * (*p - centre)).squaredNorm() <= limit) ++p;
    if (p != end) join(*p++);
  }
}

template <int D>
void CoreSet<D>::extend_span(const Vector<D>& p) {
  if (!core_.empty()) {
    std::vector<Vector<D>> with = core_;
    with.push_back(p);
    const int before = spanning_frame<D>(core_).rank;
    const SpanningFrame<D> after = spanning_frame<D>(with);
    // A point that adds no dimension joins where it doubles the extent: a stream may begin with a cluster.
    const bool grows = after.largest_scale > 2 * spanning_frame<D>(core_).largest_scale;
    if (after.rank == before && !grows) return;
  }
  join(p);
}

template <int D>
void CoreSet<D>::join(const Vector<D>& p) {
  core_.push_back(p);
  if (core_.size() <= D) return;
  Sandwich<D> next;
  // A core that was solid can be flat within rounding as seen from the point that joined: it grows by dimensions again.
  full_ = core_ellipsoid<D>(core_, 1, next, steps_);
  if (!full_) return;
  sandwich_ = next;
  to_unit_ = sandwich_.fattening();
}

#define PD_INSTANTIATE(D)                                                                           \
  template SpanningFrame<D> spanning_frame<D>(std::span<const Vector<D>>);                          \
  template bool core_ellipsoid<D>(std::span<const Vector<D>>, double, Sandwich<D>&, std::int64_t&); \
  template class CoreSet<D>;
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
