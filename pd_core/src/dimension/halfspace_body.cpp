#include "dimension/halfspace_body.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <type_traits>

#include "dimension/kernel_builder.hpp"
#include "dimension/linear_program.hpp"
#include "dimension/validate.hpp"
#include "dimension/weighted_ellipsoid.hpp"
#include "numeric/length.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

/// A body that reaches farther than this times its largest offset is called unbounded.
constexpr double kBound = 0x1p46;
constexpr double kSlack = 0x1p-44;
using pd::detail::DoubleDouble;
/// Of double-double: 2^-40 of the body even where an optimum lies at the bound.
constexpr double kFineSlack = 0x1p-86;
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

template <int D>
ProgramVector<double, D> to_array(const Vector<D>& v) {
  ProgramVector<double, D> r;
  for (std::size_t k = 0; k < D; ++k) r[k] = v[Eigen::Index(k)];
  return r;
}

/// The rows a.x <= b of unit length with |b| <= 1, and extreme points of their intersection.
template <typename Scalar, int D>
class Program {
 public:
  explicit Program(std::span<const Halfspace<D>> halfspaces) {
    for (const Halfspace<D>& h : halfspaces)
      scale_ = std::max(scale_, std::abs(h.offset) / pd::detail::length(h.normal));
    if (!(scale_ > 0)) scale_ = 1;
    rows_.reserve(halfspaces.size());
    for (const std::size_t i : shuffled(halfspaces.size())) {
      // By a power of two near its length first, so that squares neither overflow nor vanish.
      const double power = std::exp2(std::round(std::log2(pd::detail::length(halfspaces[i].normal))));
      ProgramRow<Scalar, D> row{};
      for (std::size_t k = 0; k < D; ++k) row.a[k] = Scalar{halfspaces[i].normal[Eigen::Index(k)] / power};
      const Scalar length = root(dot(row.a, row.a));
      for (Scalar& a : row.a) a = a / length;
      row.b = Scalar{halfspaces[i].offset / power} / (length * Scalar{scale_});
      rows_.push_back(row);
    }
  }

  [[nodiscard]] bool maximise(const Vector<D>& direction, Vector<D>& x) const {
    ProgramVector<Scalar, D> objective, point;
    for (std::size_t k = 0; k < D; ++k) objective[k] = Scalar{direction[Eigen::Index(k)]};
    const double slack = std::is_same_v<Scalar, double> ? kSlack : kFineSlack;
    if (!detail::maximise<Scalar, D>(rows_, objective, kBound, slack, point)) return false;
    for (std::size_t k = 0; k < D; ++k) x[Eigen::Index(k)] = head(point[k]);
    return true;
  }
  [[nodiscard]] double scale() const { return scale_; }

 private:
  std::vector<ProgramRow<Scalar, D>> rows_;
  double scale_ = 0;
};

Error empty_error() { return {ErrorCode::bad_value, "the halfspaces have no point in common", "halfspaces"}; }
Error unbounded_error() { return {ErrorCode::unbounded, "the halfspaces must enclose a bounded body", "halfspaces"}; }

/// A rough sandwich from extreme points along the axes of better and better frames. Scaled by `program.scale()`.
template <typename Scalar, int D>
Expected<Sandwich<D>> scaled_sandwich(const Program<Scalar, D>& program) {
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

template <typename Scalar, int D>
Expected<Sandwich<D>> rough_sandwich(std::span<const Halfspace<D>> halfspaces) {
  const Program<Scalar, D> program(halfspaces);
  const Expected<Sandwich<D>> scaled = scaled_sandwich<Scalar, D>(program);
  if (!scaled) return scaled;
  Sandwich<D> r = *scaled;
  r.centre *= program.scale();
  r.axes *= program.scale();
  const bool interior = std::all_of(halfspaces.begin(), halfspaces.end(),
                                    [&](const Halfspace<D>& h) { return h.offset > h.normal.dot(r.centre); });
  if (!interior) return flat_error<D>("halfspaces");
  return r;
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

namespace {

/// The sandwich from the polar points in the rough one's frame, which only has to be about right; refused where the
/// frame is not.
template <int D>
Expected<Sandwich<D>> refined_sandwich(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& frame, double eta) {
  // K_z = {z : <q_i, z> <= 1} holds the unit ball and lies in that of radius ratio. The hull H of a kernel of ratio q_i
  // has K_z in ratio H^o, whose vertices are its facets' normals, and K_z holds ratio H^o / limit.
  std::vector<Vector<D>> polar = polar_points<D>(halfspaces, frame);
  for (Vector<D>& q : polar) {
    q *= frame.ratio;
    if (!q.allFinite() || q.norm() > 1.01 * frame.ratio) return flat_error<D>("halfspaces");
  }
  KernelBuilder<D> builder({}, kPolarEpsilon);
  builder.add(polar, 0);
  if (!builder.unplaced().empty()) return flat_error<D>("halfspaces");
  std::vector<Vector<D>> corners;
  for (const auto& f : builder.hull().facets()) {
    if (f.successor >= 0) continue;
    // A vertex of the hull's start among them: the polar points do not surround the unit ball, so that K_z reaches
    // farther than the frame says.
    for (const std::int32_t v : f.vertex) {
      if (builder.kernel_of_vertex(v) < 0) return flat_error<D>("halfspaces");
    }
    corners.push_back(frame.ratio * f.normal);
  }
  const Expected<EnclosingEllipsoid<D>> ellipsoid = enclosing_ellipsoid<D>(corners, eta);
  if (!ellipsoid) return ellipsoid.error();
  const Sandwich<D>& inner = ellipsoid->sandwich;
  const double limit = builder.limit();
  Sandwich<D> r;
  const Vector<D> centre = inner.centre / limit;
  const double shift = (inverse_of<D>(inner.axes) * (inner.centre - centre)).norm();
  r.centre = frame.centre + frame.axes * centre;
  r.axes = frame.axes * inner.axes / (limit * (1 + 1e-9));
  r.ratio = (inner.ratio + shift) * limit * (1 + 2e-9);
  return r;
}

}  // namespace

template <int D>
Expected<Sandwich<D>> sandwich_of_halfspaces(std::span<const Halfspace<D>> halfspaces, double eta) {
  if (const auto error = check<D>(halfspaces)) return *error;
  // Programs in doubles lose digits where an optimum of theirs lies at the bound: nothing is refused on their word, and
  // nothing is believed that the polar points do not prove.
  if (const Expected<Sandwich<D>> rough = rough_sandwich<double, D>(halfspaces)) {
    Expected<Sandwich<D>> refined = refined_sandwich<D>(halfspaces, *rough, eta);
    if (refined) return refined;
  }
  const Expected<Sandwich<D>> rough = rough_sandwich<DoubleDouble, D>(halfspaces);
  if (!rough) return rough;
  return refined_sandwich<D>(halfspaces, *rough, eta);
}

template <int D>
SupportPoint<D> extreme_point(std::span<const Halfspace<D>> halfspaces, const Sandwich<D>& sandwich,
                              const Vector<D>& direction) {
  std::vector<ProgramRow<double, D>> rows;
  rows.reserve(halfspaces.size());
  const std::vector<Vector<D>> polar = polar_points<D>(halfspaces, sandwich);
  for (const std::size_t i : shuffled(polar.size())) {
    const double length = polar[i].norm();
    // A plane at infinity holds nothing back.
    if (length > 0) rows.push_back({to_array<D>(polar[i] / length), 1 / length});
  }
  ProgramVector<double, D> z{};
  const Vector<D> objective = (sandwich.axes.transpose() * direction).stableNormalized();
  maximise<double, D>(rows, to_array<D>(objective), 4 * sandwich.ratio, kSlack, z);
  const Vector<D> point = sandwich.centre + sandwich.axes * Eigen::Map<const Vector<D>>(z.data());
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
