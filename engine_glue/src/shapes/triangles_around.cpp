#include "shapes/triangles_around.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

class TrianglesAround::Reader : public btTriangleCallback {
 public:
  Reader(const btVector3& lower, const btVector3& upper, std::vector<MeshTriangle>& triangles)
      : lower_(lower), upper_(upper), triangles_(triangles) {}

  void processTriangle(btVector3* corners, int part, int index) override {
    btVector3 lower = corners[0], upper = corners[0];
    for (int i = 1; i < 3; ++i) {
      lower.setMin(corners[i]);
      upper.setMax(corners[i]);
    }
    // Trees of quantised boxes, and heightfields, offer more than what the box meets.
    if (!boxes_meet(lower, upper, lower_, upper_)) return;
    const Vec3 first = to_pd(corners[0]);
    const Vec3 across = (to_pd(corners[1]) - first).cross(to_pd(corners[2]) - first);
    const double size = std::abs(across.x()) + std::abs(across.y()) + std::abs(across.z());
    // Also skips what is not a number.
    if (!(size > 0 && size < std::numeric_limits<double>::infinity())) {
      ++skipped;
      return;
    }
    triangles_.push_back({{corners[0], corners[1], corners[2]}, lower, upper, across, part, index});
  }

  int skipped = 0;

 private:
  const btVector3& lower_;
  const btVector3& upper_;
  std::vector<MeshTriangle>& triangles_;
};

int TrianglesAround::read(const btConcaveShape& mesh, const btVector3& lower, const btVector3& upper) {
  mesh_ = &mesh;
  lower_ = lower;
  upper_ = upper;
  read_.clear();
  Reader reader(lower_, upper_, read_);
  mesh.processAllTriangles(&reader, lower, upper);
  order_.clear();
  for (std::size_t i = 0; i < read_.size(); ++i) order_.emplace_back(read_[i].number(), i);
  std::sort(order_.begin(), order_.end(), [&](const auto& x, const auto& y) {
    return x.first != y.first ? x.first < y.first : comes_before(read_[x.second], read_[y.second]);
  });
  triangles_.clear();
  for (const auto& [number, i] : order_) triangles_.push_back(read_[i]);
  return reader.skipped;
}

std::size_t TrianglesAround::find(int part, int index, const btVector3* corners) const {
  const std::uint64_t number = MeshTriangle::number_of(part, index);
  auto at = std::lower_bound(triangles_.begin(), triangles_.end(), number,
                             [](const MeshTriangle& x, std::uint64_t n) { return x.number() < n; });
  for (; at != triangles_.end() && at->number() == number; ++at) {
    if (std::equal(at->corners, at->corners + 3, corners)) return static_cast<std::size_t>(at - triangles_.begin());
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
