/// @file
/// A stranger's program on the door to FCL: two cubes, their signed distance by pdepth.
#include <fcl/fcl.h>

#include <cstdio>
#include <memory>
#include <pd/fcl/signed_distance.hpp>

int main() {
  const auto cube = std::make_shared<fcl::Boxd>(1, 1, 1);
  const fcl::CollisionObjectd a(cube);
  fcl::CollisionObjectd b(cube);
  b.setTranslation({0.75, 0, 0});
  pd::FclQueries queries;
  fcl::DistanceResultd result;
  const double distance = queries.distance(&a, &b, fcl::DistanceRequestd(), result);
  std::printf("depth %g, %lld pairs left to FCL\n", -distance, static_cast<long long>(queries.left_to_fcl()));
}
