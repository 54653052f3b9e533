/// @file
/// The sample of the guide "pdepth beside FCL" (engine_glue/fcl/README.md), compiled and run. A check compares the
/// guide's text with the marked part.
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <pd/fcl/signed_distance.hpp>
#include <vector>

int main() {
  std::vector<fcl::CollisionObjectd> links;
  for (int i = 0; i < 6; ++i) {
    if (i % 2 == 0) {
      links.emplace_back(std::make_shared<fcl::Boxd>(0.2, 0.2, 0.2));
    } else {
      links.emplace_back(std::make_shared<fcl::Capsuled>(0.05, 0.1));
    }
    links.back().setTranslation({0.25 * i, 0, 0});
  }
  // [robot]
  pd::FclQueries queries;  // buffers and converted shapes: one for each thread
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (std::size_t j = i + 1; j < links.size(); ++j) {
      fcl::DistanceResultd result;
      nearest = std::min(nearest, queries.distance(&links[i], &links[j], fcl::DistanceRequestd(), result));
    }
  }
  std::printf("nearest pair: %.3f; %lld pairs left to FCL\n", nearest, static_cast<long long>(queries.left_to_fcl()));
  // [/robot]
  return std::abs(nearest - 0.1) < 1e-12 && queries.left_to_fcl() == 0 ? 0 : 1;
}
