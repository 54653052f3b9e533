#include "pd/union_contact/one_sided.hpp"

#include <algorithm>

namespace pd {

namespace {

/// Sines: less than a degree behind an edge is the noise of normals there; 25 degrees around the back's normal.
constexpr double kSideways = 0.02;
constexpr double kThrough = 0.9;
constexpr std::size_t kMostWays = 4;

}  // namespace

void OneSided::clear() {
  behind_.clear();
  ways_.clear();
}

bool OneSided::admit(const PenetrationDepth& answer, const Vec3& front, int triangle) {
  const bool overlapping = answer.contact == ContactClass::overlapping;
  const double ahead = answer.normal.dot(front);
  if (ahead >= -kSideways) {
    if (overlapping) ways_.emplace_back(answer.depth * answer.normal);
    return true;
  }
  if (overlapping && ahead < -kThrough) behind_.push_back({triangle, front});
  return false;
}

const std::vector<Vec3>& OneSided::ways_out() {
  std::stable_sort(ways_.begin(), ways_.end(),
                   [](const Vec3& x, const Vec3& y) { return x.squaredNorm() > y.squaredNorm(); });
  if (ways_.size() > kMostWays) ways_.resize(kMostWays);
  return ways_;
}

}  // namespace pd
