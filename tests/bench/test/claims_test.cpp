/// @file
/// Fits and verdicts of the table of claims.
#include "bench/measure/claims.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pd::bench {
namespace {

TEST(PowerLaw, ExactPowersHaveNoInterval) {
  const std::vector<double> x = {1, 2, 4, 8};
  const std::vector<double> y = {3, 12, 48, 192};
  const PowerLaw law = fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, 2, 1e-12);
  EXPECT_NEAR(law.low, 2, 1e-12);
  EXPECT_NEAR(law.high, 2, 1e-12);
  EXPECT_NEAR(law.last, 2, 1e-12);
}

// log y = 0, 2, 1, 3 over log x = 0, 1, 2, 3: slope 0.8, residual sum 1.8, t(2; 0.975) = 4.30265.
TEST(PowerLaw, IntervalIsStudents) {
  const double e = std::exp(1.0);
  const std::vector<double> x = {1, e, e * e, e * e * e};
  const std::vector<double> y = {1, e * e, e, e * e * e};
  const PowerLaw law = fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, 0.8, 1e-12);
  EXPECT_NEAR(law.high - law.exponent, 4.302652730 * std::sqrt(1.8 / 2 / 5), 1e-6);
  EXPECT_NEAR(law.exponent - law.low, law.high - law.exponent, 1e-12);
}

TEST(PowerLaw, WhatCannotBeFittedIsNotANumber) {
  const std::vector<double> same = {2, 2, 2}, zeros = {0, 0, 0}, y = {1, 2, 3};
  EXPECT_TRUE(std::isnan(fit_power_law(same, y).exponent));
  EXPECT_TRUE(std::isnan(fit_power_law(y, zeros).exponent));
  EXPECT_TRUE(std::isnan(fit_power_law(std::span(y).first(2), y).low));
}

Growth powers(double exponent) {
  Growth growth{"family", "counter", "m"};
  for (const double m : {8.0, 16.0, 32.0, 64.0}) growth.add(m, std::pow(m, exponent));
  return growth;
}

TEST(ClaimTable, ABoundThatDoesNotHoldIsARow) {
  const Claim claim{"Claim", "says so"};
  ClaimTable table;
  table.add_growth(claim, powers(1.2), 1.3);
  table.add_growth(claim, powers(1.4), 1.3);
  table.add_growth(claim, powers(1.4));
  table.add_value(claim, "family", "ratio", "m = 8", 0.6, 0.5);
  Growth rough = powers(1.25);
  rough.y[1] *= 1.2;
  table.add_growth(claim, std::move(rough), 1.3);
  table.add_order(claim, powers(1.95), 2, 0.1);
  const std::vector<Finding>& rows = table.findings();
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].verdict, Verdict::holds);
  EXPECT_EQ(rows[1].verdict, Verdict::fails);
  EXPECT_EQ(rows[2].verdict, Verdict::reported);
  EXPECT_EQ(rows[3].verdict, Verdict::fails);
  EXPECT_EQ(rows[4].verdict, Verdict::undecided);
  EXPECT_EQ(rows[5].verdict, Verdict::holds);
  EXPECT_EQ(table.failures(), 2);
  EXPECT_NE(to_csv(rows).find("Claim,family,counter,m = 8..64,"), std::string::npos);
  EXPECT_NE(to_markdown(rows, "").find("| ratio | m = 8 | 0.6 | - | - | <= 0.5 | FAILS |"), std::string::npos);
  EXPECT_NE(points_csv(rows).find("Claim,family,counter,m,8,"), std::string::npos);
}

}  // namespace
}  // namespace pd::bench
