#include "shapes/triangles_around.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "shapes/each_triangle.hpp"

namespace pd::detail {

namespace {

constexpr double kRounding = sizeof(btScalar) == sizeof(float) ? 0x1p-20 : 0x1p-48;

/// By place, where a host gave several triangles one number.
bool comes_before(const MeshTriangle& x, const MeshTriangle& y) {
  for (int i = 0; i < 9; ++i) {
    const btScalar here = x.corners[i / 3][i % 3], there = y.corners[i / 3][i % 3];
    if (here != there) return here < there;
  }
  return false;
}

}  // namespace

BodyReach::BodyReach(const btConvexShape& body, const btTransform& pose, btScalar reach)
    : box_(rounded_box(body, pose)) {
  body.getAabb(pose, lower_, upper_);
  lower_ -= btVector3(reach, reach, reach);
  upper_ += btVector3(reach, reach, reach);
  // What rounding of the boxes may add.
  reach_ = 1.001 * static_cast<double>(reach) + kRounding * (to_pd(lower_).norm() + to_pd(upper_).norm());
}

bool BodyReach::meets(const MeshTriangle& triangle) const {
  if (!boxes_meet(triangle.lower, triangle.upper, lower_, upper_)) return false;
  const Vec3 corners[3] = {to_pd(triangle.corners[0]), to_pd(triangle.corners[1]), to_pd(triangle.corners[2])};
  return !out_of_reach(box_, corners, triangle.across, reach_, kRounding);
}

int TrianglesAround::read(const btConcaveShape& mesh, const btVector3& lower, const btVector3& upper) {
  mesh_ = &mesh;
  lower_ = lower;
  upper_ = upper;
  read_.clear();
  int skipped = 0;
  for_each_triangle(mesh, lower, upper, [&](const btVector3* corners, int part, int index) {
    btVector3 low = corners[0], high = corners[0];
    for (int i = 1; i < 3; ++i) {
      low.setMin(corners[i]);
      high.setMax(corners[i]);
    }
    if (!boxes_meet(low, high, lower, upper)) return;
    const Vec3 first = to_pd(corners[0]);
    const Vec3 across = (to_pd(corners[1]) - first).cross(to_pd(corners[2]) - first);
    // Also skips what is not a number.
    const double size = across.lpNorm<1>();
    if (size > 0 && size < std::numeric_limits<double>::infinity()) {
      read_.push_back({{corners[0], corners[1], corners[2]}, low, high, across, part, index});
    } else {
      ++skipped;
    }
  });
  order_.clear();
  for (std::size_t i = 0; i < read_.size(); ++i) order_.emplace_back(read_[i].number(), i);
  std::sort(order_.begin(), order_.end(), [&](const auto& x, const auto& y) {
    return x.first != y.first ? x.first < y.first : comes_before(read_[x.second], read_[y.second]);
  });
  triangles_.clear();
  corners_.clear();
  for (const auto& [number, i] : order_) {
    const MeshTriangle& triangle = triangles_.emplace_back(read_[i]);
    corners_.push_back({to_pd(triangle.corners[0]), to_pd(triangle.corners[1]), to_pd(triangle.corners[2])});
  }
  return skipped;
}

std::size_t TrianglesAround::find(int part, int index, const btVector3* corners) const {
  const std::uint64_t number = MeshTriangle::number_of(part, index);
  const auto first = std::lower_bound(order_.begin(), order_.end(), std::pair(number, std::size_t{0}));
  for (auto at = static_cast<std::size_t>(first - order_.begin()); at < order_.size() && order_[at].first == number;
       ++at) {
    if (std::equal(triangles_[at].corners, triangles_[at].corners + 3, corners)) return at;
  }
  return triangles_.size();
}

bool TrianglesAround::cover(const btConcaveShape& mesh, const btVector3& lower, const btVector3& upper) const {
  if (mesh_ != &mesh) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (lower[axis] < lower_[axis] || upper[axis] > upper_[axis]) return false;
  }
  return true;
}

}  // namespace pd::detail
