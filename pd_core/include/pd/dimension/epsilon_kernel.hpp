/// @file
/// Epsilon-kernels: few of the points, whose every directional width is at least (1 - epsilon) times that of all
/// ([M] section 1.1; Agarwal, Har-Peled, Varadarajan 2004).
///
/// Every point is given to the cone (apex: a point inside) over one facet of a growing hull of kernel points. It is
/// dropped for good once its gauge there is at most 1 / (1 - epsilon). K is in conv(kernel) / (1 - epsilon) about the
/// apex, which is more than the widths ask for and needs no covering of directions. The point of the largest gauge
/// enters first. Departure from [M]: its hierarchy finds kernels in O(n log(1/epsilon) + 1/epsilon^((d-1)/2 +
/// alpha)). Here sizes and work are measured (`pdepth-bench arya`). The method is the estimate refinement of Kamenev,
/// which has the optimal order O(1/epsilon^((d-1)/2)) of points on smooth bodies.
///
/// The method needs no budget, because a point enters the hull once. 1,000 points on a sphere of R^5 make 27,000 facets
/// in 0.1 s.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pd/dimension/body.hpp"
#include "pd/numeric/expected.hpp"

namespace pd::dimension {

namespace detail {
class KernelBuilder;
class CoreSet;
}  // namespace detail

template <int D>
struct EpsilonKernel {
  std::vector<std::int64_t> indices;  ///< of the body's points, ascending
  std::int64_t facets = 0;            ///< of the kernel's hull, simplices
  std::int64_t cones_visited = 0;     ///< in all, D dot products each
};

/// @param body     of points; a body of halfspaces has none to choose from: ErrorCode::unsupported ("a").
/// @param epsilon  in (0, 1), else ErrorCode::bad_value ("epsilon"). Below 1e-7 the kernel is that of 1e-7 with every
/// point that is not certified to be inside it.
template <int D>
[[nodiscard]] Expected<EpsilonKernel<D>> epsilon_kernel(const Body<D>& body, double epsilon);

/// A kernel of points that are not kept: two passes of chunks in the same order.
///
/// Until `end_survey` has succeeded, and once the stream was moved from, `select` does nothing and the kernel is empty.
/// Memory: the kernel and its hull, and 65536 points; nothing that grows with n.
template <int D>
class EpsilonKernelStream {
 public:
  /// @return ErrorCode::bad_value ("epsilon").
  static Expected<EpsilonKernelStream> create(double epsilon);

  /// First pass: every chunk. @return ErrorCode::non_finite or out_of_range ("points[i]", i counted over the stream);
  /// bad_value ("chunk") after the pass.
  std::optional<Error> survey(std::span<const Vector<D>> chunk);
  /// Between the passes. @return ErrorCode::too_few_points, not_full_dimensional ("points").
  std::optional<Error> end_survey();
  /// Second pass: every chunk again.
  void select(std::span<const Vector<D>> chunk);
  /// After the second pass.
  [[nodiscard]] EpsilonKernel<D> finish();
  /// The kernel's points, in the order of `finish().indices`.
  [[nodiscard]] std::vector<Vector<D>> kernel_points() const;

  EpsilonKernelStream(EpsilonKernelStream&&) noexcept;
  EpsilonKernelStream& operator=(EpsilonKernelStream&&) noexcept;
  ~EpsilonKernelStream();

 private:
  explicit EpsilonKernelStream(double epsilon);

  double epsilon_;
  std::int64_t surveyed_ = 0;
  std::int64_t selected_ = 0;
  std::unique_ptr<detail::CoreSet> core_;
  std::unique_ptr<detail::KernelBuilder> builder_;
};

}  // namespace pd::dimension
