#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "audit/error_quantiles.hpp"
#include "scenes/shape_families.hpp"

namespace pd::test {
namespace {

// Against the sorted numbers themselves, over three hundred powers of ten.
TEST(ErrorQuantiles, WithinOnePercentOfTheSortedNumbers) {
  scenes::Random random(3);
  for (const int count : {1, 2, 7, 100, 5000}) {
    audit::ErrorQuantiles quantiles;
    std::vector<double> values;
    for (int i = 0; i < count; ++i) {
      const double value = i % 10 == 3 ? 0 : std::pow(10.0, random.uniform(-300, 5));
      quantiles.add(value);
      values.push_back(value);
    }
    std::sort(values.begin(), values.end());
    EXPECT_EQ(quantiles.count(), count);
    EXPECT_EQ(quantiles.max(), values.back()) << "exact";
    for (const double share : {0.01, 0.5, 0.99, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::ceil(share * count));
      const double exact = values[std::max<std::size_t>(rank, 1) - 1];
      EXPECT_NEAR(quantiles.quantile(share), exact, 0.01 * exact) << count << " " << share;
    }
  }
}

TEST(ErrorQuantiles, OrderDoesNotMatter) {
  audit::ErrorQuantiles up;
  audit::ErrorQuantiles down;
  for (int i = 0; i < 1000; ++i) {
    up.add(1e-9 * i * i);
    down.add(1e-9 * (999 - i) * (999 - i));
  }
  for (const double share : {0.1, 0.5, 0.9, 0.99}) EXPECT_EQ(up.quantile(share), down.quantile(share));
}

}  // namespace
}  // namespace pd::test
