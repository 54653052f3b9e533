#include "pd/union_contact/one_sided.hpp"

#include <algorithm>

namespace pd {

namespace {

/// Sine: less than a degree behind an edge is the noise of normals there.
constexpr double kSideways = 0.02;
constexpr std::size_t kMostWays = 4;

}  // namespace

void OneSided::clear() {
  behind_.clear();
  ways_.clear();
}

bool OneSided::admit(const PenetrationDepth& answer, const Vec3& front, int triangle) {
  if (answer.normal.dot(front) >= -kSideways) return true;
  if (answer.contact == ContactClass::overlapping) add_behind(triangle, front);
  return false;
}

const std::vector<Vec3>& OneSided::ways_out() {
  std::stable_sort(ways_.begin(), ways_.end(),
                   [](const Vec3& x, const Vec3& y) { return x.squaredNorm() > y.squaredNorm(); });
  if (ways_.size() > kMostWays) ways_.resize(kMostWays);
  return ways_;
}

}  // namespace pd
