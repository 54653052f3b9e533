#include "pd/dimension/epsilon_kernel.hpp"

#include <string>

#include "dimension/kernel_builder.hpp"
#include "dimension/validate.hpp"
#include "dimension/weighted_ellipsoid.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd::dimension {

namespace {

using detail::KernelBuilder;
using detail::Points;
using AnyKernel = EpsilonKernel<kAnyDimension>;

/// Where no hull can be told from its points within rounding: the points that are not well inside join the kernel.
constexpr double kInside = 1 - 1e-9;

void add_outer_points(const KernelBuilder& builder, const Points& points, AnyKernel& kernel) {
  kernel.indices.clear();
  const detail::AnyMap inverse = builder.to_unit().inverse();
  std::int32_t f = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const detail::AnyVector unit = detail::in_frame(builder.to_unit().linear, inverse.translation, points.data(i));
    f = builder.hull().locate(unit, f, kernel.cones_visited);
    if (builder.hull().gauge(f, unit) > kInside) kernel.indices.push_back(static_cast<std::int64_t>(i));
  }
}

AnyKernel kernel_of(const KernelBuilder& builder) {
  AnyKernel r;
  for (const auto& p : builder.chosen()) r.indices.push_back(p.index);
  r.facets = builder.hull().num_facets();
  r.cones_visited = builder.cones_visited();
  return r;
}

AnyKernel kernel_of_points(const Points& points, const detail::AnyMap& fattening, double epsilon) {
  KernelBuilder builder(fattening, epsilon);
  builder.add(points, 0);
  AnyKernel kernel = kernel_of(builder);
  if (epsilon < detail::kLeastEpsilon) add_outer_points(builder, points, kernel);
  return kernel;
}

template <int D>
EpsilonKernel<D> fixed(AnyKernel kernel) {
  return {std::move(kernel.indices), kernel.facets, kernel.cones_visited};
}

}  // namespace

template <int D>
Expected<EpsilonKernel<D>> epsilon_kernel(const Body<D>& body, double epsilon) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  if (body.representation() != Representation::points) {
    return Error{ErrorCode::unsupported,
                 "a kernel is a choice of the body's points; approximate a body of halfspaces instead", "a"};
  }
  return fixed<D>(kernel_of_points(body.points(), detail::any<D>(body.sandwich()).fattening(), epsilon));
}

template <int D>
EpsilonKernelStream<D>::EpsilonKernelStream(double epsilon)
    : epsilon_(epsilon), core_(std::make_unique<detail::CoreSet>()) {}
template <int D>
EpsilonKernelStream<D>::EpsilonKernelStream(EpsilonKernelStream&&) noexcept = default;
template <int D>
EpsilonKernelStream<D>& EpsilonKernelStream<D>::operator=(EpsilonKernelStream&&) noexcept = default;
template <int D>
EpsilonKernelStream<D>::~EpsilonKernelStream() = default;

template <int D>
Expected<EpsilonKernelStream<D>> EpsilonKernelStream<D>::create(double epsilon) {
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  if (epsilon < detail::kLeastEpsilon) {
    return Error{ErrorCode::bad_value, "a kernel of a stream needs epsilon >= 1e-7", "epsilon"};
  }
  return EpsilonKernelStream(epsilon);
}

template <int D>
std::optional<Error> EpsilonKernelStream<D>::survey(std::span<const Vector<D>> chunk) {
  const pd::detail::FloatingPointGuard guard;
  if (!core_ || builder_) return Error{ErrorCode::bad_value, "the survey has ended, or the stream was moved", "chunk"};
  if (auto error = detail::check_coordinates(chunk, surveyed_)) return error;
  core_->add(chunk);
  surveyed_ += static_cast<std::int64_t>(chunk.size());
  return std::nullopt;
}

template <int D>
std::optional<Error> EpsilonKernelStream<D>::end_survey() {
  const pd::detail::FloatingPointGuard guard;
  if (!core_ || surveyed_ <= D) return detail::too_few_points_error(core_ ? surveyed_ : 0, D);
  if (!core_->full_dimensional() || detail::too_thin(core_->sandwich())) return detail::flat_error("points", D);
  builder_ = std::make_unique<KernelBuilder>(core_->sandwich().fattening(), epsilon_);
  return std::nullopt;
}

template <int D>
void EpsilonKernelStream<D>::select(std::span<const Vector<D>> chunk) {
  const pd::detail::FloatingPointGuard guard;
  if (!builder_) return;
  builder_->add(chunk, selected_);
  selected_ += static_cast<std::int64_t>(chunk.size());
}

template <int D>
EpsilonKernel<D> EpsilonKernelStream<D>::finish() {
  return builder_ ? fixed<D>(kernel_of(*builder_)) : EpsilonKernel<D>{};
}

template <int D>
std::vector<Vector<D>> EpsilonKernelStream<D>::kernel_points() const {
  std::vector<Vector<D>> points;
  if (!builder_) return points;
  for (const auto& p : builder_->chosen()) points.push_back(detail::fixed<D>(p.point));
  return points;
}

#define PD_INSTANTIATE(D)                                                        \
  template Expected<EpsilonKernel<D>> epsilon_kernel<D>(const Body<D>&, double); \
  template class EpsilonKernelStream<D>;
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension
