// Queries of any dimension through the line protocol: answers against hand-made bodies, refusals by name.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include "cli/protocol_lines.hpp"
#include "cli/temporary_folder.hpp"

namespace pd::test {
namespace {

const std::string kSquare = R"({"points":[[0,0],[2,0],[2,1],[0,1],[1,0.5]]})";
const std::string kCube4 = [] {
  std::string text = R"({"points":[)";
  for (int s = 0; s < 16; ++s) {
    text += s > 0 ? ",[" : "[";
    for (int k = 0; k < 4; ++k) text += std::string(k > 0 ? "," : "") + ((s >> k & 1) != 0 ? "1" : "-1");
    text += "]";
  }
  return text + "]}";
}();
const std::string kSquareHalfspaces = R"({"halfspaces":[[1,0,2],[-1,0,0],[0,1,1],[0,-1,0],[1,1,9]]})";

std::string line(const std::string& query, const std::string& body, const std::string& more) {
  return R"({"id":7,"query":")" + query + R"(","a":)" + body + "," + more + "}";
}

std::string number(double x) { return Json(x).dump(); }

TEST(DimensionQueries, DirectionalWidths) {
  for (const char* method : {"kernel", "exact"}) {
    const Json a =
        answer(line("approx_directional_width", kSquare,
                    R"("epsilon":0.01,"directions":[[3,0],[0,1],[1,1]],"method":")" + std::string(method) + "\""));
    ASSERT_EQ(code_of(a), "") << a;
    EXPECT_NEAR(a["widths"][0].get<double>(), 2, 0.02);
    EXPECT_NEAR(a["widths"][1].get<double>(), 1, 0.01);
    EXPECT_NEAR(a["widths"][2].get<double>(), 3 / std::sqrt(2.0), 0.03);
    EXPECT_EQ(a["pairs"][2], Json::parse("[2,0]"));
  }
  // A body of halfspaces has no points to name: the pairs are coordinates.
  const Json a = answer(line("approx_directional_width", kSquareHalfspaces, R"("epsilon":0.01,"directions":[[1,1]])"));
  ASSERT_EQ(code_of(a), "") << a;
  EXPECT_NEAR(a["widths"][0].get<double>(), 3 / std::sqrt(2.0), 0.03);
  EXPECT_EQ(a["pairs"][0][0].size(), 2u);
}

TEST(DimensionQueries, WidthOfACubeInFourDimensionsAndOfItsImage) {
  const Json a = answer(line("approx_width", kCube4, R"("epsilon":0.01)"));
  ASSERT_EQ(code_of(a), "") << a;
  EXPECT_NEAR(a["width"].get<double>(), 2, 0.02);
  EXPECT_LE(a["lower"].get<double>(), 2);
  const std::string image =
      kSquare.substr(0, kSquare.size() - 1) + R"(,"affine":{"matrix":[[1,0],[0,0.1]],"translation":[5,5]}})";
  const Json b = answer(line("approx_width", image, R"("epsilon":0.001,"backend":"exact")"));
  ASSERT_EQ(code_of(b), "") << b;
  EXPECT_NEAR(b["width"].get<double>(), 0.1, 1e-4);
}

TEST(DimensionQueries, ApproximationsInEitherRepresentation) {
  const Json h = answer(line("approximate", kSquare, R"("epsilon":0.01,"representation":"halfspaces")"));
  ASSERT_EQ(code_of(h), "") << h;
  EXPECT_EQ(h["halfspaces"].size(), 4u);
  // Outer: no corner is cut off.
  for (const Json& row : h["halfspaces"]) {
    for (const double x : {0.0, 2.0}) {
      for (const double y : {0.0, 1.0}) {
        EXPECT_LE(row[0].get<double>() * x + row[1].get<double>() * y, row[2].get<double>());
      }
    }
  }
  const Json p =
      answer(line("approximate", kSquareHalfspaces, R"("epsilon":0.01,"representation":"points","side":"inner")"));
  ASSERT_EQ(code_of(p), "") << p;
  for (const Json& row : p["points"]) {
    EXPECT_LE(row[0].get<double>(), 2);
    EXPECT_GE(row[1].get<double>(), 0);
  }
}

// Bodies composed of others are queried as those of points are. kSquare is [0, 2] x [0, 1].
TEST(DimensionQueries, ComposedBodiesHaveWidthsAndApproximations) {
  const std::string moved = R"({"points":[[1,0],[5,0],[5,4],[1,4]]})";  // [1, 5] x [0, 4]
  const auto composed = [&](const std::string& kind) { return "{\"" + kind + "\":[" + kSquare + "," + moved + "]}"; };
  struct Case {
    const char* kind;
    double width, along_x, along_y;
  };
  // The hull's thinnest extent is along y, whose lower corners are in a line; the intersection is [1, 2] x [0, 1].
  for (const Case& c : {Case{"sum_of", 5, 6, 5}, Case{"hull_of", 4, 5, 4}, Case{"intersection_of", 1, 1, 1}}) {
    SCOPED_TRACE(c.kind);
    for (const char* backend : {"kernel", "exact"}) {
      const std::string more = R"("epsilon":0.01,"backend":")" + std::string(backend) + "\"";
      const Json width = answer(line("approx_width", composed(c.kind), more));
      ASSERT_EQ(code_of(width), "") << width;
      EXPECT_LE(width["lower"].get<double>(), c.width * (1 + 1e-9));
      EXPECT_GE(width["upper"].get<double>(), c.width * (1 - 1e-9));
      EXPECT_LE(width["upper"].get<double>(), 1.01 * width["lower"].get<double>());
      const Json small = answer(line("approximate", composed(c.kind), more + R"(,"representation":"points")"));
      ASSERT_EQ(code_of(small), "") << small;
      double least = 1e9, most = -1e9;
      for (const Json& p : small["points"]) {
        least = std::min(least, p[0].get<double>());
        most = std::max(most, p[0].get<double>());
      }
      EXPECT_GE(most - least, c.along_x * (1 - 1e-9));
      EXPECT_LE(most - least, c.along_x * 1.01);
    }
    const Json widths =
        answer(line("approx_directional_width", composed(c.kind), R"("epsilon":0.01,"directions":[[1,0],[0,-2]])"));
    ASSERT_EQ(code_of(widths), "") << widths;
    EXPECT_NEAR(widths["widths"][0].get<double>(), c.along_x, 0.01 * c.along_x);
    EXPECT_NEAR(widths["widths"][1].get<double>(), c.along_y, 0.01 * c.along_y);
    EXPECT_EQ(widths["pairs"][0][0].size(), 2u) << "coordinates: such points are in no list";
    EXPECT_EQ(code_of(answer(line("epsilon_kernel", composed(c.kind), R"("epsilon":0.1)"))), "unsupported");
  }
  const std::string apart = "{\"intersection_of\":[" + kSquare + R"(,{"points":[[7,0],[8,0],[7,1]]}]})";
  EXPECT_EQ(code_of(answer(line("approx_width", apart, R"("epsilon":0.1)"))), "bad_value");
  EXPECT_EQ(code_of(answer(line("approx_width", R"({"sum_of":[]})", R"("epsilon":0.1)"))), "bad_value");
}

class PointsFiles : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::filesystem::path text_ = folder_.path() / "points.txt";
  const std::filesystem::path npy_ = folder_.path() / "points.npy";
};

TEST_F(PointsFiles, TextAndNumpyGiveTheSameKernel) {
  constexpr int kPoints = 1000;
  std::ofstream text(text_);
  std::ofstream npy(npy_, std::ios::binary);
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000, 3), }";
  header.resize(117, ' ');
  header += '\n';
  npy << "\x93NUMPY" << '\x01' << '\0' << static_cast<char>(header.size()) << '\0' << header;
  text << "# x y z\n";
  for (int i = 0; i < kPoints; ++i) {
    const double p[3] = {i % 10 * 1.0, i / 10 % 10 * 1.0, i / 100 * 1.0};
    text << p[0] << ", " << p[1] << " " << p[2] << "\n";
    npy.write(reinterpret_cast<const char*>(p), sizeof(p));
  }
  text.close();
  npy.close();
  const auto kernel = [&](const std::filesystem::path& path) {
    return answer(line("epsilon_kernel", R"({"points_file":")" + path.string() + "\"}", R"("epsilon":0.01)"));
  };
  const Json a = kernel(text_), b = kernel(npy_);
  ASSERT_EQ(code_of(a), "") << a;
  EXPECT_EQ(a["indices"], b["indices"]);
  for (const int corner : {0, 9, 90, 99, 900, 909, 990, 999}) {
    EXPECT_NE(std::find(a["indices"].begin(), a["indices"].end(), corner), a["indices"].end()) << corner;
  }
  const std::string wide = line("approx_width", R"({"points_file":")" + npy_.string() + "\"}", R"("epsilon":0.01)");
  EXPECT_NEAR(answer(wide)["width"].get<double>(), 9, 0.09);
  query::Limits limits;
  limits.files = false;
  EXPECT_EQ(code_of(answer(wide, limits)), "unsupported");
}

TEST_F(PointsFiles, StreamedWidthsAreThoseOfAllPoints) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::string points;
  std::vector<std::array<double, 3>> all;
  for (int i = 0; i < 4000; ++i) {
    const double x = normal(random), y = normal(random), z = normal(random), r = std::sqrt(x * x + y * y + z * z);
    all.push_back({x / r, 2 * y / r, 3 * z / r});
    points +=
        (i == 0 ? "[" : ",[") + number(all.back()[0]) + "," + number(all.back()[1]) + "," + number(all.back()[2]) + "]";
  }
  std::ofstream text(text_);
  for (const auto& p : all) text << number(p[0]) << " " << number(p[1]) << " " << number(p[2]) << "\n";
  text.close();
  const std::string file = R"({"points_file":")" + text_.string() + "\"}";
  const std::string given = R"({"points":[)" + points + "]}";
  const auto extent = [&](const Json& v) {
    double most = -10, least = 10;
    for (const auto& p : all) {
      const double at = p[0] * v[0].get<double>() + p[1] * v[1].get<double>() + p[2] * v[2].get<double>();
      most = std::max(most, at);
      least = std::min(least, at);
    }
    return most - least;
  };
  for (const double epsilon : {0.1, 0.01, 1e-3}) {
    const std::string rest = "\"epsilon\":" + number(epsilon);
    const Json streamed = answer(line("approx_width", file, rest)), held = answer(line("approx_width", given, rest));
    ASSERT_EQ(code_of(streamed), "") << streamed;
    const double lower = streamed["lower"].get<double>(), upper = streamed["upper"].get<double>();
    EXPECT_LE(upper, (1 + epsilon) * lower);
    EXPECT_NEAR(upper, extent(streamed["direction"]), 1e-8);
    EXPECT_LE(lower, held["upper"].get<double>());
    EXPECT_LE(held["lower"].get<double>(), upper);
    // The ends are points of the file.
    const std::string directions = R"(,"directions":[[1,0,0],[0,1,2],[1,-1,1]])";
    const Json widths = answer(line("approx_directional_width", file, rest + directions));
    ASSERT_EQ(code_of(widths), "") << widths;
    const Json asked = Json::parse(
        "[[1,0,0],[0,0.4472135954999579,0.8944271909999159],"
        "[0.5773502691896258,-0.5773502691896258,0.5773502691896258]]");
    for (std::size_t i = 0; i < 3; ++i) {
      const double width = widths["widths"][i].get<double>(), truth = extent(asked[i]);
      EXPECT_LE(width, truth * (1 + 1e-12));
      EXPECT_GE(width, (1 - epsilon) * truth);
      const auto& p = all[widths["pairs"][i][0].get<std::size_t>()];
      const auto& q = all[widths["pairs"][i][1].get<std::size_t>()];
      double between = 0;
      for (std::size_t k = 0; k < 3; ++k) between += asked[i][k].get<double>() * (p[k] - q[k]);
      EXPECT_NEAR(between, width, 1e-12);
    }
  }
}

TEST_F(PointsFiles, RefusesBadFiles) {
  const std::string missing = line("epsilon_kernel", R"({"points_file":"/nowhere/x.npy"})", R"("epsilon":0.1)");
  EXPECT_EQ(code_of(answer(missing)), "unreadable_file");
  EXPECT_EQ(where_of(answer(missing)), "a.points_file");
  const std::string named = line("epsilon_kernel", R"({"points_file":")" + text_.string() + "\"}", R"("epsilon":0.1)");
  std::ofstream(text_) << "1 2\n3 4 5\n";
  EXPECT_EQ(code_of(answer(named)), "unreadable_file");
  std::ofstream(text_) << "1 2\n3 four\n";
  EXPECT_EQ(code_of(answer(named)), "unreadable_file");
  std::ofstream(text_) << "1 2\n3 nan\n5 6\n1 1\n";
  EXPECT_EQ(code_of(answer(named)), "non_finite");
  std::ofstream(text_) << "1\n2\n";
  EXPECT_EQ(code_of(answer(named)), "out_of_range");
  std::ofstream(npy_) << "\x93NUMPY";
  EXPECT_EQ(code_of(answer(line("epsilon_kernel", R"({"points_file":")" + npy_.string() + "\"}", R"("epsilon":0.1)"))),
            "unreadable_file");
}

TEST(DimensionQueries, RefuseByName) {
  const auto code = [](const std::string& body, const std::string& more) {
    return code_of(answer(line("approx_width", body, more)));
  };
  EXPECT_EQ(code(kSquare, R"("epsilon":0)"), "bad_value");
  EXPECT_EQ(code(kSquare, R"("epsilon":1)"), "bad_value");
  EXPECT_EQ(code(kSquare, R"("epsilon":"nan")"), "non_finite");
  EXPECT_EQ(code(kSquare, R"("backend":"kernel")"), "missing_field");
  EXPECT_EQ(code(kSquare, R"("epsilon":0.1,"backend":"oracle")"), "bad_value");
  EXPECT_EQ(code(kSquare, R"("epsilon":0.1,"delta":1)"), "bad_value");
  EXPECT_EQ(code(R"({"points":[[0],[1]]})", R"("epsilon":0.1)"), "out_of_range");
  EXPECT_EQ(code(R"({"points":[[0,0,0,0,0,0]]})", R"("epsilon":0.1)"), "out_of_range");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,1],[2,2],[3,3]]})", R"("epsilon":0.1)"), "not_full_dimensional");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,1]]})", R"("epsilon":0.1)"), "too_few_points");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,1,1]]})", R"("epsilon":0.1)"), "bad_value");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,"inf"],[1,0]]})", R"("epsilon":0.1)"), "non_finite");
  EXPECT_EQ(code(R"({"halfspaces":[[1,0,1],[0,1,1],[-1,0,1]]})", R"("epsilon":0.1)"), "unbounded");
  EXPECT_EQ(code(R"({"halfspaces":[[1,0,-1],[0,1,1],[-1,0,-1],[0,-1,1]]})", R"("epsilon":0.1)"), "bad_value");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,0],[0,1]],"affine":{"matrix":[[1,1],[1,1]]}})", R"("epsilon":0.1)"),
            "bad_value");
  EXPECT_EQ(code(R"({"points":[[0,0],[1,0],[0,1]],"halfspaces":[]})", R"("epsilon":0.1)"), "bad_value");
  EXPECT_EQ(code_of(answer(line("epsilon_kernel", kSquareHalfspaces, R"("epsilon":0.1)"))), "unsupported");
}

}  // namespace
}  // namespace pd::test
