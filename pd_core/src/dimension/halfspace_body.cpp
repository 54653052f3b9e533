#include "dimension/halfspace_body.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>

#include "dimension/kernel_builder.hpp"
#include "dimension/linear_program.hpp"
#include "dimension/validate.hpp"
#include "dimension/weighted_ellipsoid.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"

namespace pd::dimension::detail {

namespace {

/// A body that reaches farther than this times its largest offset is called unbounded.
constexpr double kBound = 0x1p46;
constexpr double kSlack = 0x1p-44;
/// Of the kernel of the polar, from whose facets the sandwich comes.
constexpr double kPolarEpsilon = 0.05;

template <int D>
std::optional<Error> check(std::span<const Halfspace<D>> halfspaces) {
  if (halfspaces.size() <= D) {
    return Error{ErrorCode::too_few_points,
                 "a bounded body in R^" + std::to_string(D) + " needs at least " + std::to_string(D + 1) +
                     " halfspaces, here are " + std::to_string(halfspaces.size()),
                 "halfspaces"};
  }
  for (std::size_t i = 0; i < halfspaces.size(); ++i) {
    const Halfspace<D>& h = halfspaces[i];
    const std::string where = "halfspaces[" + std::to_string(i) + "]";
    if (!h.normal.allFinite() || !std::isfinite(h.offset)) {
      return Error{ErrorCode::non_finite, "a halfspace needs finite numbers", where};
    }
    const double largest = h.normal.cwiseAbs().maxCoeff();
    if (largest == 0) return Error{ErrorCode::zero_direction, "a halfspace needs a normal that is not zero", where};
    if (largest > kMaxCoordinate || std::abs(h.offset) > kMaxCoordinate || largest < 1 / kMaxCoordinate) {
      return Error{ErrorCode::out_of_range, "normals and offsets are limited to 1e100, normals to 1e-100 from below",
                   where};
    }
  }
  return std::nullopt;
}

/// A fixed random order.
std::vector<std::size_t> shuffled(std::size_t n) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(1);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

/// The rows a.x <= b of unit length with |b| <= 1, and extreme points of their intersection.
template <int D>
class Program {
 public:
  explicit Program(std::span<const Halfspace<D>> halfspaces) {
    scale_ = 0;
    for (const std::size_t i : shuffled(halfspaces.size())) {
      const double length = halfspaces[i].normal.stableNorm();
      rows_.push_back({halfspaces[i].normal / length, halfspaces[i].offset / length});
      scale_ = std::max(scale_, std::abs(rows_.back().b));
    }
    if (!(scale_ > 0)) scale_ = 1;
    for (ProgramRow<D>& row : rows_) row.b /= scale_;
  }

  [[nodiscard]] bool maximise(const Vector<D>& direction, Vector<D>& x) const {
    return detail::maximise<D>(rows_, direction, kBound, kSlack, x);
  }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] const std::vector<ProgramRow<D>>& rows() const { return rows_; }

 private:
  std::vector<ProgramRow<D>> rows_;
  double scale_;
};

Error empty_error() { return {ErrorCode::bad_value, "the halfspaces have no point in common", "halfspaces"}; }
Error unbounded_error() { return {ErrorCode::unbounded, "the halfspaces must enclose a bounded body", "halfspaces"}; }

/// A rough sandwich from extreme points along the axes of better and better frames. Scaled by `program.scale()`.
template <int D>
Expected<Sandwich<D>> rough_sandwich(const Program<D>& program) {
  std::vector<Vector<D>> core;
  const auto add = [&](const Vector<D>& direction) -> std::optional<Error> {
    Vector<D> x;
    if (!program.maximise(direction, x)) return empty_error();
    if (x.cwiseAbs().maxCoeff() > 0.25 * kBound) return unbounded_error();
    core.push_back(x);
    return std::nullopt;
  };
  for (int k = 0; k < D; ++k) {
    for (const double sign : {1.0, -1.0}) {
      if (auto error = add(sign * Vector<D>::Unit(k))) return *error;
    }
  }
  Sandwich<D> sandwich;
  std::int64_t steps = 0;
  // The extreme points of a solid body span it after the axes' directions and those off their span.
  for (int more = 0; !core_ellipsoid<D>(core, 1, sandwich, steps); ++more) {
    if (more > D) return flat_error<D>("halfspaces");
    const SpanningFrame<D> frame = spanning_frame<D>(core);
    // Of the axes' directions, the one that is farthest off the span.
    Vector<D> off = Vector<D>::Zero();
    for (int k = 0; k < D; ++k) {
      Vector<D> r = Vector<D>::Unit(k);
      for (int j = 0; j < std::min(frame.rank, D - 1); ++j) {
        const Vector<D> axis = frame.to_frame.linear.row(j).transpose().normalized();
        r -= axis.dot(r) * axis;
      }
      if (r.norm() > off.norm()) off = r;
    }
    for (const double sign : {1.0, -1.0}) {
      if (auto error = add(sign * off)) return *error;
    }
  }
  for (;;) {
    const AffineMap<D> to_unit = sandwich.fattening();
    double farthest = 0, squared = 0;
    for (int k = 0; k < D; ++k) {
      double extent = 0;
      for (const double sign : {1.0, -1.0}) {
        if (auto error = add(sign * to_unit.linear.row(k).transpose())) return *error;
        extent = std::max(extent, std::abs(to_unit.linear.row(k).dot(core.back() - sandwich.centre)));
      }
      farthest = std::max(farthest, extent);
      squared += extent * extent;
    }
    if (farthest <= 4 * sandwich.ratio) {
      sandwich.ratio = std::sqrt(squared) * (1 + 1e-9);
      return sandwich;
    }
    if (!core_ellipsoid<D>(core, 1, sandwich, steps)) return flat_error<D>("halfspaces");
  }
}

}  // namespace

template <int D>
std::vector<Vector<D>> polar_points(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& sandwich) {
  std::vector<Vector<D>> polar;
  polar.reserve(halfspaces.size());
  for (const Halfspace<D>& h : halfspaces) {
    const double distance = h.offset - h.normal.dot(sandwich.centre);
    polar.push_back(sandwich.axes.transpose() * h.normal / distance);
  }
  return polar;
}

template <int D>
Expected<Sandwich<D>> sandwich_of_halfspaces(std::span<const Halfspace<D>> halfspaces, double eta) {
  if (const auto error = check<D>(halfspaces)) return *error;
  const Program<D> program(halfspaces);
  const Expected<Sandwich<D>> rough = rough_sandwich<D>(program);
  if (!rough) return rough;
  Sandwich<D> frame = *rough;
  frame.centre *= program.scale();
  frame.axes *= program.scale();

  // K_z = {z : <q_i, z> <= 1} holds the unit ball and lies in that of radius ratio. The hull H of a kernel of ratio q_i
  // has K_z in ratio H^o, whose vertices are its facets' normals, and K_z holds ratio H^o / limit.
  std::vector<Vector<D>> polar = polar_points<D>(halfspaces, frame);
  for (Vector<D>& q : polar) {
    q *= frame.ratio;
    if (!q.allFinite() || q.norm() > 1.01 * frame.ratio) return flat_error<D>("halfspaces");
  }
  KernelBuilder<D> builder({}, kPolarEpsilon);
  builder.add(polar, 0);
  std::vector<Vector<D>> corners;
  for (const auto& f : builder.hull().facets()) {
    if (f.successor < 0) corners.push_back(frame.ratio * f.normal);
  }
  const Expected<EnclosingEllipsoid<D>> ellipsoid = enclosing_ellipsoid<D>(corners, eta);
  if (!ellipsoid) return ellipsoid.error();
  const Sandwich<D>& inner = ellipsoid->sandwich;
  const double limit = builder.limit();
  Sandwich<D> r;
  const Vector<D> centre = inner.centre / limit;
  const double shift = (inner.axes.inverse() * (inner.centre - centre)).norm();
  r.centre = frame.centre + frame.axes * centre;
  r.axes = frame.axes * inner.axes / (limit * (1 + 1e-9));
  r.ratio = (inner.ratio + shift) * limit * (1 + 2e-9);
  return r;
}

template <int D>
SupportPoint<D> extreme_point(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& sandwich,
                              const Vector<D>& direction) {
  std::vector<ProgramRow<D>> rows;
  rows.reserve(halfspaces.size());
  const std::vector<Vector<D>> polar = polar_points<D>(halfspaces, sandwich);
  for (const std::size_t i : shuffled(polar.size())) {
    const double length = polar[i].norm();
    // A plane at infinity holds nothing back.
    if (length > 0) rows.push_back({polar[i] / length, 1 / length});
  }
  Vector<D> z;
  const Vector<D> objective = (sandwich.axes.transpose() * direction).stableNormalized();
  maximise<D>(rows, objective, 4 * sandwich.ratio, kSlack, z);
  const Vector<D> point = sandwich.centre + sandwich.axes * z;
  return {point, direction.dot(point), -1};
}

#define PD_INSTANTIATE(D)                                                                                         \
  template Expected<Sandwich<D>> sandwich_of_halfspaces<D>(std::span<const Halfspace<D>>, double);                \
  template SupportPoint<D> extreme_point<D>(std::span<const Halfspace<D>>, const Sandwich<D>&, const Vector<D>&); \
  template std::vector<Vector<D>> polar_points<D>(std::span<const Halfspace<D>>, const Sandwich<D>&);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
