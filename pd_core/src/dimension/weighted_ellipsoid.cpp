#include "dimension/weighted_ellipsoid.hpp"

#include <algorithm>
#include <array>
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
class Ascent {
  static constexpr int kMost = kMaxDimension + 1;
  using Lifted = std::array<double, kMost>;

 public:
  explicit Ascent(const std::vector<AnyVector>& y)
      : size_(y[0].size() + 1), weights_(y.size(), 1 / static_cast<double>(y.size())) {
    for (const AnyVector& p : y) {
      Lifted q{};
      q[std::copy_n(p.data(), p.size(), q.begin()) - q.begin()] = 1;
      lifted_.push_back(q);
    }
  }

  /// Steps until the outer excess is at most `excess` in units of L; returns their number.
  std::int64_t run(double excess) {
    const auto size = static_cast<double>(size_);
    std::int64_t steps = 0;
    for (;; ++steps) {
      if (steps % kRefresh == 0) refresh();
      std::size_t most = 0, least = lifted_.size();
      for (std::size_t i = 0; i < lifted_.size(); ++i) {
        if (w_[i] > w_[most]) most = i;
        if (weights_[i] > 0 && (least == lifted_.size() || w_[i] < w_[least])) least = i;
      }
      const double above = w_[most] / size - 1, below = 1 - w_[least] / size;
      if (above <= excess) {
        // The incremental w drift; the decision is made on fresh ones.
        if (steps % kRefresh == 0) return steps;
        refresh();
        if (*std::max_element(w_.begin(), w_.end()) / size - 1 <= excess) return steps;
        continue;
      }
      if (above >= below) {
        step(most, (w_[most] / size - 1) / (w_[most] - 1));
      } else {
        // Away: at most the whole weight, which the step's other end reaches.
        const double whole = -weights_[least] / (1 - weights_[least]);
        const double optimal = w_[least] > 1 ? (w_[least] / size - 1) / (w_[least] - 1) : whole;
        step(least, std::max(optimal, whole));
      }
    }
  }

  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }

 private:
  static constexpr std::int64_t kRefresh = 64;

  void refresh() {
    std::array<double, kMost * kMost> moments{};
    for (std::size_t i = 0; i < lifted_.size(); ++i) {
      const Lifted& q = lifted_[i];
      for (Eigen::Index k = 0; k < size_; ++k) add_scaled(&moments[size_ * k], weights_[i] * q[k], q.data(), size_);
    }
    pd::detail::SmallElimination(moments.data(), static_cast<int>(size_)).inverse(inverse_.data());
    w_.resize(lifted_.size());
    for (std::size_t i = 0; i < lifted_.size(); ++i) w_[i] = dot(lifted_[i].data(), image_of(lifted_[i]).data(), size_);
  }

  /// Lambda^-1 q
  [[nodiscard]] Lifted image_of(const Lifted& q) const {
    Lifted r{};
    for (Eigen::Index k = 0; k < size_; ++k) add_scaled(r.data(), q[k], &inverse_[size_ * k], size_);
    return r;
  }

  /// u <- (1 - beta) u + beta e_j; Lambda^-1 and w by the rank-one update.
  void step(std::size_t j, double beta) {
    for (double& u : weights_) u *= 1 - beta;
    weights_[j] = std::max(0.0, weights_[j] + beta);
    const Lifted z = image_of(lifted_[j]);
    const double factor = beta / (1 - beta + beta * w_[j]);
    for (Eigen::Index k = 0; k < size_; ++k) add_scaled(&inverse_[size_ * k], -factor * z[k], z.data(), size_);
    for (double& entry : inverse_) entry /= 1 - beta;
    for (std::size_t i = 0; i < lifted_.size(); ++i) {
      const double along = dot(z.data(), lifted_[i].data(), size_);
      w_[i] = (w_[i] - factor * along * along) / (1 - beta);
    }
  }

  std::vector<Lifted> lifted_;
  Eigen::Index size_;
  std::vector<double> weights_;
  std::vector<double> w_;
  std::array<double, kMost * kMost> inverse_{};  ///< of Lambda, column by column
};

}  // namespace

SpanningFrame spanning_frame(const Points& points) {
  SpanningFrame frame;
  if (points.empty()) return frame;
  const auto farthest = [&](const auto& squared) {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double s = squared(AnyVector(points[i]));
      if (s > most) {
        most = s;
        best = i;
      }
    }
    return best;
  };
  const int d = points.dimension();
  const AnyVector start = points[0];
  const AnyVector origin = points[farthest([&](const AnyVector& p) { return (p - start).squaredNorm(); })];
  AnyMatrix axes = AnyMatrix::Zero(d, d);  // columns
  AnyVector scales = AnyVector::Ones(d);
  const auto residual = [&](const AnyVector& p, int rank) {
    AnyVector r = p - origin;
    // Twice, for the digits that a needle's long axis takes away.
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k < rank; ++k) r -= axes.col(k).dot(r) * axes.col(k);
    }
    return r;
  };
  for (int k = 0; k < d; ++k) {
    const std::size_t best = farthest([&](const AnyVector& p) { return residual(p, k).squaredNorm(); });
    const AnyVector r = residual(points[best], k);
    const double length = r.norm();
    if (!(length > kFlat * scales[0]) && k > 0) break;
    if (!(length > 0)) break;
    axes.col(k) = r / length;
    scales[k] = length;
    frame.rank = k + 1;
  }
  frame.largest_scale = scales[0];
  frame.smallest_scale = frame.rank == d ? scales.minCoeff() : 0;
  frame.to_frame.linear = scales.cwiseInverse().asDiagonal() * axes.transpose();
  frame.to_frame.translation = -(frame.to_frame.linear * origin);
  return frame;
}

bool core_ellipsoid(const Points& points, double eta, AnySandwich& sandwich, std::int64_t& steps) {
  const SpanningFrame frame = spanning_frame(points);
  const int d = points.dimension();
  if (frame.rank < d) return false;
  const AnyVector origin = -(inverse_of<kAnyDimension>(frame.to_frame.linear) * frame.to_frame.translation);
  std::vector<AnyVector> y;
  y.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    y.push_back(in_frame(frame.to_frame.linear, origin, points.data(i)));
  }
  Ascent ascent(y);
  // R^2 = (D + 1) (1 + excess) - 1 <= D (1 + eta).
  steps += ascent.run(eta * d / (d + 1));

  AnyVector mean = AnyVector::Zero(d);
  for (std::size_t i = 0; i < y.size(); ++i) mean += ascent.weights()[i] * y[i];
  AnyMatrix covariance = AnyMatrix::Zero(d, d);
  for (std::size_t i = 0; i < y.size(); ++i) {
    const AnyVector x = y[i] - mean;
    add_outer(covariance, ascent.weights()[i], x);
  }
  const pd::detail::SmallCholesky root(covariance.data(), d);
  if (!root.positive()) return false;
  double squared = 0;
  for (const AnyVector& p : y) {
    AnyVector x = p - mean;
    root.solve_lower(x.data());
    squared = std::max(squared, x.squaredNorm());
  }
  squared *= 1 + 1e-9;  // the roundings of the solve, in a frame where the covariance is well conditioned
  const AnyMatrix from_frame = inverse_of<kAnyDimension>(frame.to_frame.linear);
  sandwich.centre = origin + from_frame * mean;
  sandwich.axes = from_frame * Eigen::Map<const AnyMatrix>(root.lower(), d, d) / std::sqrt(squared);
  sandwich.ratio = squared;
  return true;
}

void CoreSet::add(const Points& chunk) {
  std::size_t i = 0;
  while (i < chunk.size() && !full_) extend_span(chunk[i++]);
  while (i < chunk.size()) {
    const double limit = kFarSlack * kFarSlack * sandwich_.ratio * sandwich_.ratio;
    const AnyMatrix linear = to_unit_.linear;
    const AnyVector centre = sandwich_.centre;
    while (i < chunk.size() && in_frame(linear, centre, chunk.data(i)).squaredNorm() <= limit) ++i;
    if (i < chunk.size()) join(chunk[i++]);
  }
}

void CoreSet::extend_span(const AnyVector& p) {
  if (!core_.empty()) {
    std::vector<AnyVector> with = core_;
    with.push_back(p);
    const int before = spanning_frame(core_).rank;
    const SpanningFrame after = spanning_frame(with);
    // A point that adds no dimension joins where it doubles the extent: a stream may begin with a cluster.
    const bool grows = after.largest_scale > 2 * spanning_frame(core_).largest_scale;
    if (after.rank == before && !grows) return;
  }
  join(p);
}

void CoreSet::join(const AnyVector& p) {
  core_.push_back(p);
  if (core_.size() <= static_cast<std::size_t>(p.size())) return;
  AnySandwich next;
  // A core that was solid can be flat within rounding as seen from the point that joined: it grows by dimensions again.
  full_ = core_ellipsoid(core_, 1, next, steps_);
  if (!full_) return;
  sandwich_ = next;
  to_unit_ = sandwich_.fattening();
}

}  // namespace pd::dimension::detail
