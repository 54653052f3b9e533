/// @file
/// The oracle against the shared hard cases, which two other oracles have checked: it must agree before it may judge.

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>

#include "oracle/corpus.hpp"
#include "oracle/depth_oracle.hpp"

namespace pd::oracle {
namespace {

using Decimal = boost::multiprecision::cpp_dec_float_100;

Decimal to_decimal(const ExactLength& length) {
  if (length.numerator.is_zero()) return 0;
  const Decimal ratio = Decimal(length.numerator.str()) / Decimal(length.denominator.str());
  return sqrt(ratio * pow(Decimal(2), length.exponent));
}

std::string word(ContactClass contact) {
  return contact == ContactClass::overlapping ? "overlapping"
         : contact == ContactClass::touching  ? "touching"
                                              : "separated";
}

TEST(OracleHardCases, AgreesOnEveryPolytopePair) {
  const std::vector<PairText> pairs = read_folder(PROJECT_SOURCE_DIR "/../shared/hard_cases");
  if (pairs.empty()) GTEST_SKIP() << "the shared hard cases are not here";
  int judged = 0;
  int to_the_last_digit = 0;
  for (const PairText& p : pairs) {
    if (p.curved) continue;
    SCOPED_TRACE(p.name);
    const Body a(p.shape_a.points);
    const Body b(p.shape_b.points);
    const ExactPair pair(a, make_pose(p.pose_a), b, make_pose(p.pose_b));
    const Verdict v = judge(pair);
    if (v.contact != ContactClass::overlapping) {
      EXPECT_TRUE(v.distance_known || v.contact == ContactClass::touching);
    }
    const Decimal margins = Decimal(p.shape_a.margin) + Decimal(p.shape_b.margin);
    const Decimal core =
        v.contact == ContactClass::overlapping ? Decimal(-to_decimal(v.depth)) : to_decimal(v.distance);
    const Decimal found = core - margins;
    const Decimal expected(p.signed_distance_text);
    const Decimal largest = p.shape_a.points[0].norm() + p.shape_b.points[0].norm() + margins +
                            (p.pose_a.translation - p.pose_b.translation).norm();
    // The files' figures are those of the decimal text, ours those of the doubles that it reads as: half an ulp a
    // number.
    const Decimal error = largest * Decimal("1e-15");
    const bool same_numbers = abs(found - expected) <= largest * Decimal("1e-24");
    if (same_numbers) ++to_the_last_digit;
    EXPECT_LE(abs(found - expected), error) << "found " << found.str(30) << " expected " << p.signed_distance_text;
    if (margins == 0 && (abs(expected) > error || abs(found) == abs(expected))) {
      EXPECT_EQ(word(v.contact), p.contact);
      if (same_numbers && p.tied_directions > 0 && v.contact == ContactClass::overlapping) {
        EXPECT_EQ(static_cast<int>(v.normals.size()), p.tied_directions);
      }
    }
    ++judged;
  }
  std::printf("%d of %zu pairs judged, %d equal to 24 digits\n", judged, pairs.size(), to_the_last_digit);
}

}  // namespace
}  // namespace pd::oracle
