#include "depth/difference/foot_weights.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "depth/difference/barycentric.hpp"

namespace pd::detail {

namespace {

Vec3 across(const Vec3& point, const Vec3& normal) { return point - point.dot(normal) * normal; }

Vec3 combination(const DifferenceVertex (&corners)[3], const double (&weights)[3]) {
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (int i = 0; i < 3; ++i) {
    const double weight = std::max(0.0, weights[i]);
    sum += weight * corners[i].x;
    total += weight;
  }
  return sum / total;
}

/// The nearest of the triangle's inside, where its weights are good for something, and its edges. @return its distance.
double nearest_in_triangle(const DifferenceVertex (&corners)[3], const Vec3& normal, double (&weights)[3]) {
  project_origin(corners, normal, weights);
  double best = miss_across(corners, normal, weights);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vec3 edge = across(corners[j].x - corners[i].x, normal);
    const double squared = edge.squaredNorm();
    const double along = squared > 0 ? std::clamp(-across(corners[i].x, normal).dot(edge) / squared, 0.0, 1.0) : 0;
    double tried[3] = {};
    tried[i] = 1 - along;
    tried[j] = along;
    const double miss = miss_across(corners, normal, tried);
    if (miss < best) {
      best = miss;
      std::copy(std::begin(tried), std::end(tried), weights);
    }
  }
  return best;
}

}  // namespace

double miss_across(const DifferenceVertex (&corners)[3], const Vec3& normal, const double (&weights)[3]) {
  const double miss = across(combination(corners, weights), normal).norm();
  return std::isfinite(miss) ? miss : std::numeric_limits<double>::infinity();
}

void find_foot(std::span<const DifferenceVertex> vertices, const Vec3& normal, double least_height,
               DifferenceVertex (&corners)[3], double (&weights)[3]) {
  double miss = nearest_in_triangle(corners, normal, weights);
  for (;;) {
    const Vec3 from_line = across(combination(corners, weights), normal);
    const DifferenceVertex* next = nullptr;
    double least = from_line.squaredNorm();
    for (const DifferenceVertex& vertex : vertices) {
      if (vertex.x.dot(normal) < least_height) continue;
      if (const double along = across(vertex.x, normal).dot(from_line); along < least) {
        least = along;
        next = &vertex;
      }
    }
    if (next == nullptr) return;
    // A point that is not the foot lies on an edge: the corner across it has no weight.
    DifferenceVertex tried[3] = {corners[0], corners[1], corners[2]};
    double tried_weights[3];
    tried[std::distance(weights, std::min_element(weights, weights + 3))] = *next;
    const double tried_miss = nearest_in_triangle(tried, normal, tried_weights);
    if (!(tried_miss < miss)) return;
    miss = tried_miss;
    std::copy(std::begin(tried), std::end(tried), corners);
    std::copy(std::begin(tried_weights), std::end(tried_weights), weights);
  }
}

}  // namespace pd::detail
