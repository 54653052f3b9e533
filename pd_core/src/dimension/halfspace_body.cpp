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

std::optional<Error> check(const Halfspaces& halfspaces) {
  const int d = halfspaces.dimension();
  if (halfspaces.size() <= static_cast<std::size_t>(d)) {
    return Error{ErrorCode::too_few_points,
                 "a bounded body in R^" + std::to_string(d) + " needs at least " + std::to_string(d + 1) +
                     " halfspaces, here are " + std::to_string(halfspaces.size()),
                 "halfspaces"};
  }
  for (std::size_t i = 0; i < halfspaces.size(); ++i) {
    const AnyHalfspace h = halfspaces[i];
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

template <typename Scalar>
ProgramVector<Scalar> to_array(const AnyVector& v) {
  ProgramVector<Scalar> r;
  for (std::size_t k = 0; k < static_cast<std::size_t>(v.size()); ++k) r[k] = Scalar{v[Eigen::Index(k)]};
  return r;
}

/// The rows a.x <= b of unit length with |b| <= 1, and extreme points of their intersection.
template <typename Scalar>
class Program {
 public:
  explicit Program(const Halfspaces& halfspaces) : variables_(static_cast<std::size_t>(halfspaces.dimension())) {
    for (std::size_t i = 0; i < halfspaces.size(); ++i) {
      scale_ = std::max(scale_, std::abs(halfspaces.offset(i)) / pd::detail::length(halfspaces.normals[i]));
    }
    if (!(scale_ > 0)) scale_ = 1;
    rows_.reserve(halfspaces.size());
    for (const std::size_t i : shuffled(halfspaces.size())) {
      // By a power of two near its length first, so that squares neither overflow nor vanish.
      const double power = std::exp2(std::round(std::log2(pd::detail::length(halfspaces.normals[i]))));
      ProgramRow<Scalar> row{to_array<Scalar>(halfspaces.normals[i] / power), {}};
      const Scalar length = root(dot(row.a, row.a, variables_));
      for (std::size_t k = 0; k < variables_; ++k) row.a[k] = row.a[k] / length;
      row.b = Scalar{halfspaces.offset(i) / power} / (length * Scalar{scale_});
      rows_.push_back(row);
    }
  }

  [[nodiscard]] bool maximise(const AnyVector& direction, AnyVector& x) const {
    ProgramVector<Scalar> point;
    const double slack = std::is_same_v<Scalar, double> ? kSlack : kFineSlack;
    if (!detail::maximise(rows_, variables_, to_array<Scalar>(direction), kBound, slack, point)) return false;
    x.resize(direction.size());
    for (std::size_t k = 0; k < variables_; ++k) x[Eigen::Index(k)] = head(point[k]);
    return true;
  }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] int dimension() const { return static_cast<int>(variables_); }

 private:
  std::size_t variables_;
  std::vector<ProgramRow<Scalar>> rows_;
  double scale_ = 0;
};

Error empty_error() { return {ErrorCode::bad_value, "the halfspaces have no point in common", "halfspaces"}; }
Error unbounded_error() { return {ErrorCode::unbounded, "the halfspaces must enclose a bounded body", "halfspaces"}; }

/// A rough sandwich from extreme points along the axes of better and better frames. Scaled by `program.scale()`.
template <typename Scalar>
Expected<AnySandwich> scaled_sandwich(const Program<Scalar>& program) {
  const int d = program.dimension();
  std::vector<AnyVector> core;
  const auto add = [&](const AnyVector& direction) -> std::optional<Error> {
    AnyVector x;
    if (!program.maximise(direction, x)) return empty_error();
    if (x.cwiseAbs().maxCoeff() > 0.25 * kBound) return unbounded_error();
    core.push_back(x);
    return std::nullopt;
  };
  for (int k = 0; k < d; ++k) {
    for (const double sign : {1.0, -1.0}) {
      if (auto error = add(sign * AnyVector::Unit(d, k))) return *error;
    }
  }
  AnySandwich sandwich;
  std::int64_t steps = 0;
  // The extreme points of a solid body span it after the axes' directions and those off their span.
  for (int more = 0; !core_ellipsoid(core, 1, sandwich, steps); ++more) {
    if (more > d) return flat_error("halfspaces", d);
    const SpanningFrame frame = spanning_frame(core);
    // Of the axes' directions, the one that is farthest off the span.
    AnyVector off = AnyVector::Zero(d);
    for (int k = 0; k < d; ++k) {
      AnyVector r = AnyVector::Unit(d, k);
      for (int j = 0; j < std::min(frame.rank, d - 1); ++j) {
        const AnyVector axis = frame.to_frame.linear.row(j).transpose().normalized();
        r -= axis.dot(r) * axis;
      }
      if (r.norm() > off.norm()) off = r;
    }
    for (const double sign : {1.0, -1.0}) {
      if (auto error = add(sign * off)) return *error;
    }
  }
  for (;;) {
    const AnyMap to_unit = sandwich.fattening();
    double farthest = 0, squared = 0;
    for (int k = 0; k < d; ++k) {
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
    if (!core_ellipsoid(core, 1, sandwich, steps)) return flat_error("halfspaces", d);
  }
}

template <typename Scalar>
Expected<AnySandwich> rough_sandwich(const Halfspaces& halfspaces) {
  const Program<Scalar> program(halfspaces);
  const Expected<AnySandwich> scaled = scaled_sandwich<Scalar>(program);
  if (!scaled) return scaled;
  AnySandwich r = *scaled;
  r.centre *= program.scale();
  r.axes *= program.scale();
  for (std::size_t i = 0; i < halfspaces.size(); ++i) {
    if (!(halfspaces.offset(i) > halfspaces.normals[i].dot(r.centre))) {
      return flat_error("halfspaces", halfspaces.dimension());
    }
  }
  return r;
}

}  // namespace

std::vector<AnyVector> polar_points(const Halfspaces& halfspaces, const AnySandwich& sandwich) {
  std::vector<AnyVector> polar;
  polar.reserve(halfspaces.size());
  for (std::size_t i = 0; i < halfspaces.size(); ++i) {
    const double distance = halfspaces.offset(i) - halfspaces.normals[i].dot(sandwich.centre);
    polar.push_back(sandwich.axes.transpose() * halfspaces.normals[i] / distance);
  }
  return polar;
}

namespace {

/// The sandwich from the polar points in the rough one's frame, which only has to be about right; refused where the
/// frame is not.
Expected<AnySandwich> refined_sandwich(const Halfspaces& halfspaces, const AnySandwich& frame, double eta) {
  // K_z = {z : <q_i, z> <= 1} holds the unit ball and lies in that of radius ratio. The hull H of a kernel of ratio q_i
  // has K_z in ratio H^o, whose vertices are its facets' normals, and K_z holds ratio H^o / limit.
  const int d = halfspaces.dimension();
  std::vector<AnyVector> polar = polar_points(halfspaces, frame);
  for (AnyVector& q : polar) {
    q *= frame.ratio;
    if (!q.allFinite() || q.norm() > 1.01 * frame.ratio) return flat_error("halfspaces", d);
  }
  KernelBuilder builder(identity_map(d), kPolarEpsilon);
  builder.add(polar, 0);
  if (!builder.unplaced().empty()) return flat_error("halfspaces", d);
  std::vector<AnyVector> corners;
  const RadialHull& hull = builder.hull();
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(hull.facets().size()); ++f) {
    if (!hull.alive(f)) continue;
    // A vertex of the hull's start among them: the polar points do not surround the unit ball, so that K_z reaches
    // farther than the frame says.
    for (const std::int32_t v : hull.vertices_of(f)) {
      if (builder.kernel_of_vertex(v) < 0) return flat_error("halfspaces", d);
    }
    corners.push_back(frame.ratio * hull.normal(f));
  }
  const auto ellipsoid = enclosing_ellipsoid_of(corners, eta);
  if (!ellipsoid) return ellipsoid.error();
  const AnySandwich& inner = ellipsoid->sandwich;
  const double limit = builder.limit();
  AnySandwich r;
  const AnyVector centre = inner.centre / limit;
  const double shift = (inverse_of<kAnyDimension>(inner.axes) * (inner.centre - centre)).norm();
  r.centre = frame.centre + frame.axes * centre;
  r.axes = frame.axes * inner.axes / (limit * (1 + 1e-9));
  r.ratio = (inner.ratio + shift) * limit * (1 + 2e-9);
  return r;
}

}  // namespace

Expected<AnySandwich> sandwich_of_halfspaces(const Halfspaces& halfspaces, double eta) {
  if (const auto error = check(halfspaces)) return *error;
  // Programs in doubles lose digits where an optimum of theirs lies at the bound: nothing is refused on their word, and
  // nothing is believed that the polar points do not prove.
  if (const Expected<AnySandwich> rough = rough_sandwich<double>(halfspaces)) {
    Expected<AnySandwich> refined = refined_sandwich(halfspaces, *rough, eta);
    if (refined) return refined;
  }
  const Expected<AnySandwich> rough = rough_sandwich<DoubleDouble>(halfspaces);
  if (!rough) return rough;
  return refined_sandwich(halfspaces, *rough, eta);
}

AnySupport extreme_point(const Halfspaces& halfspaces, const AnySandwich& sandwich, const AnyVector& direction) {
  std::vector<ProgramRow<double>> rows;
  rows.reserve(halfspaces.size());
  const std::vector<AnyVector> polar = polar_points(halfspaces, sandwich);
  for (const std::size_t i : shuffled(polar.size())) {
    const double length = polar[i].norm();
    // A plane at infinity holds nothing back.
    if (length > 0) rows.push_back({to_array<double>(polar[i] / length), 1 / length});
  }
  ProgramVector<double> z{};
  const AnyVector objective = (sandwich.axes.transpose() * direction).stableNormalized();
  maximise(rows, static_cast<std::size_t>(direction.size()), to_array<double>(objective), 4 * sandwich.ratio, kSlack,
           z);
  const AnyVector point = sandwich.centre + sandwich.axes * Eigen::Map<const AnyVector>(z.data(), direction.size());
  return {point, direction.dot(point), -1};
}

}  // namespace pd::dimension::detail
