// A body beside one a thousand times as long: contact points stay on their bodies.
#include <gtest/gtest.h>

#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::test {
namespace {

// The nearest face of the surface is a sliver that does not hold the origin's foot, and its neighbours' planes differ
// by more than rounding: the witness on the small body was .11 off, a hundred times its size.
TEST(SmallOnLarge, WitnessesStayOnTheSmallBody) {
  const std::vector<Vec3> points = {{-0.00012891326330012712, 0.0004896367334675529, 0.0008623440379480435},
                                    {-0.0007761765878611102, 0.0005676212770957302, 0.0002745104556196292},
                                    {-0.0008347866708299176, 0.00040649892667327786, -0.00037133520815858014},
                                    {0.000874771671079632, -0.0004840302704548837, -2.211833537860374e-05},
                                    {-0.00029607131617742747, -0.0009095615412805978, -0.00029161546317064426},
                                    {-0.000398974571725987, -5.808077821724637e-05, -0.0009151207102441427},
                                    {-0.0007000982383928001, -6.702671360734735e-05, -0.0007108937165725243},
                                    {-0.0009215213953741101, -0.0003820270592918988, -6.966809769569763e-05}};
  const ConvexShape small = *ConvexPolytope::from_points(points);
  const ConvexShape large = *ConvexPolytope::box({0.6037951258160341, 0.9142161409165865, 0.6040909825970986});
  const Pose pose_small = *Pose::from_quaternion(
      {0.8124097239041145, -0.4184161542421268, -0.3863654139713709, -0.12506050240583794}, Vec3::Zero());
  const Pose pose_large =
      *Pose::from_quaternion({0.13770934123809664, 0.31060606030288485, -0.5453811279947048, -0.7662371942591363},
                             {0.03095445130472616, -0.4489036197372789, -1.1666485069944181});
  Scratch scratch;
  const PenetrationDepth exact = penetration_depth({&small, pose_small}, {&large, pose_large}, scratch);
  for (const Bracket bracket : {Bracket::certified, Bracket::contact}) {
    DepthSettings settings;
    settings.bracket = bracket;
    const PenetrationDepth found = penetration_depth({&small, pose_small}, {&large, pose_large}, scratch, settings);
    EXPECT_LE((found.witness_a - exact.witness_a).norm(), 1e-12);
    EXPECT_LE((found.witness_b - exact.witness_b).norm(), 1e-12);
    const PenetrationDepth swapped = penetration_depth({&large, pose_large}, {&small, pose_small}, scratch, settings);
    EXPECT_LE((swapped.witness_b - exact.witness_a).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace pd::test
