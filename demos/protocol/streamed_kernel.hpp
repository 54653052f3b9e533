/// @file
/// Kernels and widths of points in a file, which are never all in memory.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "files/points_file.hpp"
#include "pd/dimension/epsilon_kernel.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/limits.hpp"
#include "support/refusal.hpp"

namespace pd::query {

/// Calls `visit` with chunks of the file's points.
template <int D, class Visit>
void visit_chunks(PointsFile& file, Visit&& visit) {
  constexpr std::size_t kPointsAtATime = 65536;
  std::vector<double> numbers;
  std::vector<dimension::Vector<D>> chunk;
  while (file.next(numbers, kPointsAtATime)) {
    chunk.clear();
    for (std::size_t i = 0; i < numbers.size(); i += D) {
      chunk.push_back(Eigen::Map<const Eigen::Matrix<double, D, 1>>(numbers.data() + i));
    }
    visit(chunk);
  }
  file.rewind();
}

/// @param node  the file's name. @return a stream that has seen the file twice.
template <int D>
dimension::EpsilonKernelStream<D> kernel_of_file(const Node& node, const Limits& limits, double epsilon) {
  using Stream = dimension::EpsilonKernelStream<D>;
  Expected<Stream> made = Stream::create(epsilon);
  if (!made) node.refuse(made.error());
  Stream kernel = *std::move(made);
  try {
    PointsFile file(read_string(node), limits.max_file_points());
    visit_chunks<D>(file, [&](const auto& chunk) {
      if (const auto error = kernel.survey(chunk)) node.refuse(*error);
    });
    if (const auto error = kernel.end_survey()) node.refuse(*error);
    visit_chunks<D>(file, [&](const auto& chunk) { kernel.select(chunk); });
  } catch (const Refusal& refusal) {
    if (!refusal.where.empty()) throw;
    node.refuse(refusal.code, refusal.message);
  }
  return kernel;
}

/// h(v) + h(-v) over all points of the file.
template <int D>
double extent_of_file(const Node& node, const Limits& limits, const dimension::Vector<D>& direction) {
  double most = -std::numeric_limits<double>::infinity(), least = -most;
  try {
    PointsFile file(read_string(node), limits.max_file_points());
    visit_chunks<D>(file, [&](const auto& chunk) {
      for (const dimension::Vector<D>& p : chunk) {
        const double at = direction.dot(p);
        most = std::max(most, at);
        least = std::min(least, at);
      }
    });
  } catch (const Refusal& refusal) {
    if (!refusal.where.empty()) throw;
    node.refuse(refusal.code, refusal.message);
  }
  return most - least;
}

}  // namespace pd::query
