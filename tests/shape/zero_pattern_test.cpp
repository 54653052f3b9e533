/// @file
/// Zeros read off the stored numbers: an entry of a rotation is named zero when it is, whatever the other numbers are.
#include "shape/zero_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pd::detail {
namespace {

TEST(ZeroPattern, NamesTheEntriesThatVanishForEveryQuaternionOfAPattern) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> component(0.1, 1);
  for (unsigned zeros = 0; zeros < 15; ++zeros) {
    SCOPED_TRACE(zeros);
    std::uint32_t always = 0x1ff;
    std::uint32_t named = 0;
    for (int draw = 0; draw < 20; ++draw) {
      std::array<double, 4> q{};
      double squared = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        q[k] = (zeros >> k & 1) != 0 ? 0 : component(random);
        squared += q[k] * q[k];
      }
      for (double& c : q) c /= std::sqrt(squared);
      const Pose pose = *Pose::from_quaternion(q, Vec3::Zero());
      for (int k = 0; k < 9; ++k) {
        // On the diagonal two squares may cancel, which the pattern leaves to arithmetic.
        if (k % 4 == 0 || pose.rotation()(k / 3, k % 3) != 0) always &= ~(1u << k);
      }
      named = zero_entries(pose);
    }
    EXPECT_EQ(named, always);
  }
}

}  // namespace
}  // namespace pd::detail
