/// @file
/// The query `decomposition`.
#include "protocol_lines.hpp"

namespace pd::test {
namespace {

std::string line(const std::string& a, const std::string& b, const std::string& more) {
  return R"({"id":1,"query":"decomposition","a":)" + a + R"(,"b":)" + b + "," + more + "}";
}

constexpr const char* kTurned = R"("pose_b":{"quaternion_wxyz":[0.8,0.4,0.4,0.2],"translation":[0.1,0.2,0.3]})";

TEST(DecompositionQuery, SizesAndProof) {
  const Json reply = answer(line(kUnitBox, kUnitBox, std::string(kTurned) + R"(,"verify":true)"));
  EXPECT_EQ(reply.at("class"), "overlapping");
  EXPECT_EQ(reply.at("missing"), 0);
  EXPECT_EQ(reply.at("extra"), 0);
  EXPECT_EQ(reply.at("sign_violations"), 0);
  EXPECT_EQ(reply.at("signs_checked"), reply.at("K_edge_edge"));
  EXPECT_GE(reply.at("max_cover"), 1);
  EXPECT_GE(reply.at("sum_products"), reply.at("K_edge_edge"));
  std::int64_t pairs = 0;
  for (const Json& c : reply.at("size_classes")) pairs += c.at("pairs").get<std::int64_t>();
  EXPECT_EQ(reply.at("pairs"), pairs);
}

TEST(DecompositionQuery, WithoutVerifyNothingIsClaimed) {
  const Json reply = answer(line(kUnitBox, kUnitBox, kTurned));
  EXPECT_TRUE(reply.contains("sum_sizes"));
  EXPECT_FALSE(reply.contains("missing"));
}

TEST(DecompositionQuery, BodiesApartBreakNoSign) {
  const Json reply = answer(line(kUnitBox, kUnitBox, R"("pose_b":{"translation":[9,0.5,0.25]},"verify":true)"));
  EXPECT_EQ(reply.at("class"), "separated");
  EXPECT_EQ(reply.at("missing"), 0);
  EXPECT_EQ(reply.at("signs_checked"), 0);
}

TEST(DecompositionQuery, Refusals) {
  const Json smooth = answer(line(kUnitBox, R"({"type":"ellipsoid","radii":[1,1,2]})", kTurned));
  EXPECT_EQ(code_of(smooth), "unsupported");
  EXPECT_EQ(where_of(smooth), "b");
  const Json rounded = answer(line(R"({"type":"sphere","radius":1})", kUnitBox, kTurned));
  EXPECT_EQ(code_of(rounded), "unsupported");
  const Json verify = answer(line(kUnitBox, kUnitBox, R"("verify":1)"));
  EXPECT_EQ(code_of(verify), "bad_value");
  EXPECT_EQ(where_of(verify), "verify");
}

}  // namespace
}  // namespace pd::test
