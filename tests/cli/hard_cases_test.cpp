/// @file
/// The hard cases through the protocol: bad inputs refused by name, pairs answered with the oracle's depth. Skipped
/// where the folder is not beside the sources.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "protocol_lines.hpp"
#include "scenes/single_precision.hpp"

namespace pd::test {
namespace {

std::filesystem::path hard_cases() {
  return std::filesystem::path(PROJECT_SOURCE_DIR) / ".." / "shared" / "hard_cases";
}

Json read_file(const std::string& name) {
  std::ifstream file(hard_cases() / name);
  return file ? Json::parse(file) : Json();
}

/// Doubles out as text that reads back; JSON numbers of the files go through unchanged.
std::string number_preserving_dump(const Json& value) { return value.dump(); }

/// The query that a case of bad_inputs.json stands for; empty where the protocol cannot say it.
std::string line_of(const Json& test_case) {
  const std::string kind = test_case.at("kind");
  const Json& input = test_case.at("input");
  if (kind == "convex" || kind == "convex_mesh") {
    if (input.contains("face_count")) return {};  // faces without their indices
    Json shape = input;
    shape["type"] = "convex";
    return depth_line(number_preserving_dump(shape), kUnitBox);
  }
  if (kind == "box") {
    Json shape = input;
    shape["type"] = "box";
    return depth_line(number_preserving_dump(shape), kUnitBox);
  }
  if (kind == "pose") {
    Json pose = input;
    if (pose.contains("rotation")) {
      pose["rotation_row_major"] = pose["rotation"];
      pose.erase("rotation");
    }
    return depth_line(kUnitBox, kUnitBox, "\"pose_a\":" + number_preserving_dump(pose));
  }
  if (kind == "option") {
    if (input.contains("relative_error")) {
      return depth_line(kUnitBox, kUnitBox, "\"delta\":" + input["relative_error"].dump());
    }
    if (input.contains("margin")) {
      return depth_line(R"({"type":"box","half_extents":[1,1,1],"margin":)" + input["margin"].dump() + "}", kUnitBox);
    }
    if (input["tolerance"] != 0) return depth_line(kUnitBox, kUnitBox, "\"delta\":" + input["tolerance"].dump());
  }
  if (kind == "limits") {
    const int n = input.at("sphere_points");
    Json vertices = Json::array();
    for (int i = 0; i < n; ++i) {
      // A spiral over the sphere.
      const double z = n == 1 ? 1 : 1 - 2.0 * i / (n - 1);
      const double angle = 2.399963229728653 * i;
      const double r = std::sqrt(std::max(0.0, 1 - z * z));
      vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    return depth_line(Json{{"type", "convex"}, {"vertices", vertices}}.dump(), kUnitBox);
  }
  return {};
}

/// The protocol's words for the error classes of the file.
const std::map<std::string, std::set<std::string>>& codes_of_class() {
  static const std::map<std::string, std::set<std::string>> kCodes = {
      {"not_finite", {"non_finite"}},
      {"too_few_points", {"too_few_points"}},
      {"bad_extent", {"bad_value"}},
      {"bad_option", {"bad_value"}},
      {"out_of_range", {"out_of_range"}},
      {"not_rotation", {"not_a_rotation", "bad_value"}},
      {"bad_quaternion", {"not_a_rotation", "bad_value"}},
      {"bad_index", {"bad_faces"}},
      {"bad_face", {"bad_faces"}},
      {"bad_orientation", {"bad_faces"}},
      {"not_closed", {"not_closed"}},
      {"too_many_points", {"limit_exceeded"}},
  };
  return kCodes;
}

void expect_finite(const Json& value) {
  if (value.is_number()) {
    EXPECT_TRUE(std::isfinite(value.get<double>()));
  }
  if (value.is_structured()) {
    for (const Json& element : value) expect_finite(element);
  }
}

TEST(HardCases, BadInputs) {
  const Json file = read_file("bad_inputs.json");
  if (file.is_null()) GTEST_SKIP() << "hard_cases is not here";
  int asked = 0;
  for (const Json& test_case : file.at("cases")) {
    const std::string line = line_of(test_case);
    if (line.empty()) continue;
    ++asked;
    const std::string name = test_case.at("name");
    const std::string expect = test_case.at("expect");
    const Json reply = answer(line);
    const std::string code = code_of(reply);
    expect_finite(reply);
    if (expect == "accept" || expect == "reject_or_flat_policy") {
      // Flat bodies are bodies here; only an empty list is none.
      EXPECT_EQ(code, "") << name << reply.dump();
    } else if (expect == "reject") {
      EXPECT_EQ(codes_of_class().at(test_case.at("error_class")).count(code), 1u) << name << reply.dump();
    } else if (!code.empty()) {
      EXPECT_EQ(codes_of_class().at(test_case.at("error_class")).count(code), 1u) << name << reply.dump();
    }
  }
  EXPECT_GE(asked, 40);
}

TEST(HardCases, DuplicatesChangeNoBit) {
  const std::string clean =
      R"({"type":"convex","vertices":[[-1,-1,-1],[-1,-1,1],[-1,1,-1],[-1,1,1],[1,-1,-1],[1,-1,1],[1,1,-1],[1,1,1]]})";
  const std::string doubled =
      R"({"type":"convex","vertices":[[-1,-1,-1],[-1,-1,-1],[-1,-1,1],[-1,1,-1],[-1,1,1],[1,-1,-1],[0.5,0,0],[1,-1,1],[1,1,-1],[1,1,1],[1,1,1]]})";
  const std::string other = R"({"type":"convex","vertices":[[0.3,0.2,0.1],[3,0.5,0.25],[0.5,3,0.125],[0.25,0.5,3]]})";
  Json a = answer(depth_line(clean, other));
  Json b = answer(depth_line(doubled, other));
  for (const char* key : {"class", "depth", "lower", "upper", "translation", "normal", "witness_a", "witness_b"}) {
    EXPECT_EQ(a.at(key).dump(), b.at(key).dump()) << key;
  }
}

/// Single precision first where a case says so.
Json as_stored(const Json& value, bool single) {
  if (value.is_number() && single) return scenes::to_single(value.get<double>());
  if (!value.is_structured()) return value;
  Json result = value;
  for (auto& element : result) element = as_stored(element, single);
  return result;
}

void check_pairs(const std::string& name) {
  const Json file = read_file(name);
  if (file.is_null()) GTEST_SKIP() << "hard_cases is not here";
  int checked = 0;
  for (const Json& test_case : file.at("cases")) {
    const bool single = test_case.at("number_format") == "float32";
    Json line{{"id", test_case.at("name")}, {"query", "depth"}};
    line["a"] = as_stored(test_case.at("shapeA"), single);
    line["b"] = as_stored(test_case.at("shapeB"), single);
    line["pose_a"] = as_stored(test_case.at("poseA"), single);
    line["pose_b"] = as_stored(test_case.at("poseB"), single);
    const Json reply = answer(line.dump());
    ASSERT_EQ(code_of(reply), "") << line.dump().substr(0, 500) << reply.dump();
    const Json& oracle = test_case.at("oracle");
    const auto decimal = [](const Json& v) {
      return v.is_string() ? std::stod(v.get<std::string>()) : v.get<double>();
    };
    const bool curved = !oracle.contains("abs_error_bound") || oracle.at("abs_error_bound").is_null();
    const double oracle_depth = decimal(oracle.at("depth"));
    const double tolerance = decimal(test_case.at("tol"));
    const double depth = reply.at("depth");
    if (curved) {
      // The oracle swept directions: its depth is an upper bound.
      EXPECT_LE(depth, oracle_depth * (1 + 1e-6) + 1e-12) << test_case.at("name") << reply.dump();
      EXPECT_GE(depth, oracle_depth * 0.99 - tolerance) << test_case.at("name") << reply.dump();
    } else {
      EXPECT_NEAR(depth, oracle_depth, tolerance) << test_case.at("name") << reply.dump();
      // The oracle read its numbers as decimals, so that 0.6 is 3/5 there; on the stored doubles some of its kissing
      // pairs lie an ulp to either side.
      const double off = std::max(depth, reply.at("distance").get<double>());
      const double oracle_off = std::abs(decimal(oracle.at("signed_distance")));
      const bool ulp_apart = std::max(off, oracle_off) <= 0x1p-53 * decimal(oracle.at("scale"));
      if (!ulp_apart) {
        EXPECT_EQ(reply.at("class"), oracle.at("class")) << test_case.at("name") << reply.dump();
      }
    }
    EXPECT_LE(reply.at("lower").get<double>(), reply.at("upper").get<double>());
    ++checked;
  }
  EXPECT_GT(checked, 0);
}

TEST(HardCases, PairsFcl) { check_pairs("pairs_fcl.json"); }
TEST(HardCases, PairsIssues) { check_pairs("pairs_issues.json"); }
TEST(HardCases, PairsLibccd) { check_pairs("pairs_libccd.json"); }
TEST(HardCases, PairsMujoco) { check_pairs("pairs_mujoco.json"); }
TEST(HardCases, PairsOther) { check_pairs("pairs_other.json"); }
TEST(HardCases, PairsOwn) { check_pairs("pairs_own.json"); }

TEST(HardCases, Hulls) {
  const Json file = read_file("hulls.json");
  if (file.is_null()) GTEST_SKIP() << "hard_cases is not here";
  for (const Json& test_case : file.at("cases")) {
    if (test_case.at("oracle").is_null()) continue;
    const Json& oracle = test_case.at("oracle");
    const Json points = as_stored(test_case.at("points"), test_case.value("number_format", "") == "float32");
    const Json reply =
        answer(Json{{"id", 1}, {"query", "hull"}, {"a", {{"type", "convex"}, {"vertices", points}}}}.dump());
    ASSERT_EQ(code_of(reply), "") << test_case.at("name");
    EXPECT_EQ(reply.at("affine_dim"), oracle.at("affine_dim")) << test_case.at("name");
    if (oracle.at("affine_dim") == 3) {
      EXPECT_EQ(reply.at("vertices").size(), oracle.at("hull_vertices").get<std::size_t>()) << test_case.at("name");
      EXPECT_EQ(reply.at("facets").size(), oracle.at("hull_facets").get<std::size_t>()) << test_case.at("name");
    } else {
      EXPECT_TRUE(reply.at("facets").empty());
    }
  }
}

}  // namespace
}  // namespace pd::test
