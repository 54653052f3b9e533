#include "pair/standing_still.hpp"

#include <cstring>

#include "shapes/moving_body.hpp"

namespace pd::detail {

namespace {

/// A body that has moved by less than this share of the reach of contacts stands still.
constexpr double kHardly = 1.0 / 32;

}  // namespace

StandingStill::Known StandingStill::known(const MeshTriangle& triangle) {
  Known known{triangle.number(), {}};
  for (int i = 0; i < 9; ++i) known.corners[static_cast<std::size_t>(i)] = triangle.corners[i / 3][i % 3];
  return known;
}

bool StandingStill::still(std::span<const StandingChild> children, std::span<const double> radii, btScalar threshold,
                          btScalar margin) const {
  if (threshold_ != threshold || margin_ != margin || children.size() != children_.size()) return false;
  const double hardly = kHardly * static_cast<double>(threshold);
  for (std::size_t i = 0; i < children.size(); ++i) {
    const StandingChild& was = children_[i];
    const StandingChild& is = children[i];
    if (is.index != was.index || is.shape != was.shape || !is.shape) return false;
    if (!(moved_at_most(was.pose, is.pose, radii[i]) <= hardly)) return false;
  }
  return true;
}

void StandingStill::begin(std::span<const StandingChild> children, btScalar threshold, btScalar margin,
                          std::span<const MeshTriangle> triangles) {
  threshold_ = threshold;
  margin_ = margin;
  children_.assign(children.begin(), children.end());
  known_.clear();
  for (const MeshTriangle& triangle : triangles) known_.push_back(known(triangle));
  met_.assign(children.size() * triangles.size(), Met::out_of_reach);
  flat_.assign(children.size(), 0);
}

void StandingStill::find(std::span<const MeshTriangle> triangles, std::vector<int>& places) const {
  places.clear();
  auto at = known_.begin();
  for (const MeshTriangle& triangle : triangles) {
    const Known here = known(triangle);
    const auto same = [&] {
      return at != known_.end() && at->number == here.number &&
             std::memcmp(at->corners.data(), here.corners.data(), sizeof(here.corners)) == 0;
    };
    while (at != known_.end() && at->number < here.number) ++at;
    // A host may give several triangles one number.
    while (!same() && at != known_.end() && at->number == here.number && at->corners < here.corners) ++at;
    places.push_back(same() ? static_cast<int>(at - known_.begin()) : -1);
  }
}

}  // namespace pd::detail
