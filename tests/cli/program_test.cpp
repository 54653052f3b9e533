/// @file
/// The program from outside: exit codes, text for people, JSON for programs.
#include <sys/wait.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "protocol_lines.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;
};

class Program : public ::testing::Test, protected TemporaryFolder {
 protected:
  void SetUp() override {
    write("cube.obj",
          "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
          "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    write("spike.off", "OFF\n4 4 6\n0 0 0.5\n2 0 4\n-1 2 4\n-1 -2 4\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n");
  }

  Outcome run(const std::string& arguments, const std::string& input = "") {
    write("in", input);
    const std::string command =
        "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' " + arguments + " < in > out 2> err";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
  }
};

TEST_F(Program, VersionAndHelp) {
  const Outcome version = run("--version");
  EXPECT_EQ(version.status, 0);
  EXPECT_TRUE(version.out.starts_with("pdepth ")) << version.out;
  const Outcome help = run("--help");
  EXPECT_EQ(help.status, 0);
  for (const char* words : {"depth", "query", "demo", "Examples:", "Exit codes:"}) {
    EXPECT_NE(help.out.find(words), std::string::npos) << words;
  }
  for (const char* command : {"depth", "query", "demo"}) EXPECT_EQ(run(std::string(command) + " --help").status, 0);
}

TEST_F(Program, BadUsageIsTwo) {
  for (const char* arguments :
       {"", "dance", "depth", "depth cube.obj", "query --threads -1", "query --threads x", "query nowhere.jsonl",
        "query /", "query --max-line 0", "query --max-vertices 0", "query --speed", "depth cube.obj nowhere.obj",
        "depth cube.obj spike.off --pose-a 1,2", "depth cube.obj spike.off --pose-a 1,2,x",
        "depth cube.obj spike.off --pose-a 0,0,0,2,0,0,0", "depth cube.obj spike.off --method magic",
        "demo nothing-of-that-name"}) {
    const Outcome result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.out << result.err;
    EXPECT_FALSE(result.err.empty() && result.out.empty()) << arguments;
  }
}

TEST_F(Program, QueryFromStandardInputAndFile) {
  const std::string lines = depth_line(kUnitBox, kUnitBox, R"("pose_b":{"translation":[1.5,0,0]})") + "\nrubbish\n";
  const Outcome piped = run("query", lines);
  EXPECT_EQ(piped.status, 0) << "an error object is an answer";
  write("lines.jsonl", lines);
  const Outcome from_file = run("query lines.jsonl --threads 2");
  EXPECT_EQ(from_file.status, 0);
  std::istringstream answers(from_file.out);
  std::string first;
  std::string second;
  ASSERT_TRUE(std::getline(answers, first) && std::getline(answers, second));
  EXPECT_EQ(Json::parse(first).at("depth"), 0.5);
  EXPECT_EQ(code_of(Json::parse(second)), "bad_json");
  EXPECT_EQ(run("query -", lines).status, 0);
}

TEST_F(Program, QueryLimits) {
  const std::string mesh = R"({"id":1,"query":"hull","a":{"type":"mesh","path":"cube.obj"}})";
  EXPECT_EQ(code_of(Json::parse(run("query", mesh).out)), "");
  EXPECT_EQ(code_of(Json::parse(run("query --no-files", mesh).out)), "unreadable_file");
  EXPECT_EQ(code_of(Json::parse(run("query --max-vertices 7", mesh).out)), "limit_exceeded");
  EXPECT_EQ(code_of(Json::parse(run("query --max-line 10", mesh).out)), "limit_exceeded");
}

TEST_F(Program, UnwritableOutputIsOne) {
  write("lines.jsonl", depth_line(kUnitBox, kUnitBox));
  const std::string command =
      "'" PDEPTH_PROGRAM "' query '" + (path() / "lines.jsonl").string() + "' > /dev/full 2> /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
}

TEST_F(Program, DepthForPeople) {
  const Outcome result = run("depth spike.off cube.obj");
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* words : {"overlap", "depth", "bracket", "translation", "direction", "vertex 0", "facet", "0.5"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
  }
  EXPECT_NE(run("depth spike.off cube.obj --pose-a 0,0,2.5").out.find("apart"), std::string::npos);
  EXPECT_NE(run("depth spike.off cube.obj --pose-a \"0 0 0.5\"").out.find("touch"), std::string::npos);
  EXPECT_EQ(run("depth spike.off cube.obj --pose-a -0.25,0,0").status, 0) << "a pose may begin with a minus";
}

TEST_F(Program, DepthForPrograms) {
  const Outcome result = run("depth spike.off cube.obj --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const Json answer = Json::parse(result.out);
  EXPECT_EQ(answer.at("class"), "overlapping");
  EXPECT_EQ(answer.at("depth"), 0.5);
  EXPECT_EQ(answer.at("translation"), Json({0.0, 0.0, 0.5}));
  EXPECT_EQ(answer.at("feature").at("a"), Json::array({0}));
}

TEST_F(Program, PolygonForPeopleAndPrograms) {
  write("frame.json", R"({"outer":[[0,0],[10,0],[10,10],[0,10]],"holes":[[[3,3],[3,7],[7,7],[7,3]]]})");
  write("peg.svg", R"(<svg xmlns="http://www.w3.org/2000/svg"><rect width="1" height="1"/></svg>)");
  const Outcome people = run("polygon frame.json peg.svg --place-q 2.25,4");
  ASSERT_EQ(people.status, 0) << people.err;
  for (const char* words : {"0.75", "(0.75, 0)", "1 hole", "convex", "moves Q clear of P", "edge at holes[0]"}) {
    EXPECT_NE(people.out.find(words), std::string::npos) << words << "\n" << people.out;
  }
  const auto depth = [&](const std::string& more) {
    const Outcome result = run("polygon frame.json peg.svg --json --place-q 2.25,4 " + more);
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out).at("depth");
  };
  EXPECT_EQ(depth(""), 0.75);
  EXPECT_EQ(depth("--direction 0,1"), 6.0);
  EXPECT_EQ(depth("--complete"), 3.25);
  EXPECT_EQ(depth("--direction 2,0 --complete"), 7.75);
  EXPECT_NEAR(depth("--margin 0.25").get<double>(), 1.25, 1e-6);  // half more on the whole
  EXPECT_NEAR(depth("--margin 0.25,0").get<double>(), 1, 1e-6);
  write("wide.svg", R"(<svg xmlns="http://www.w3.org/2000/svg"><rect width="4" height="4"/></svg>)");
  const Outcome fits = run("polygon frame.json wide.svg --place-q 3,3 --seats");
  for (const char* words : {"fits exactly where it is", "(3, 3)"}) {
    EXPECT_NE(fits.out.find(words), std::string::npos) << words << "\n" << fits.out;
  }
  EXPECT_EQ(run("polygon frame.json wide.svg --seats --margin 1").status, 2);
  write("bow.svg", R"(<svg><path id="bow" d="M0 0L4 4L4 0L0 4z"/></svg>)");
  const Outcome crossed = run("polygon bow.svg peg.svg");
  EXPECT_EQ(crossed.status, 2);
  EXPECT_NE(crossed.err.find("<path id=\"bow\">: outer[0], the edge from (0.0, 0.0) to (4.0, 4.0): the edges "
                             "that start at outer[0] and outer[2] cross"),
            std::string::npos)
      << crossed.err;
  EXPECT_EQ(run("polygon frame.json peg.svg --direction 0,0").status, 2);
  EXPECT_EQ(run("polygon frame.json peg.svg --direction 1").status, 2);
  EXPECT_EQ(run("polygon frame.json peg.svg --flatness 0").status, 2);
  EXPECT_EQ(run("polygon frame.json nowhere.svg").status, 2);
}

TEST_F(Program, PolygonAwayForGood) {
  // A bent channel: at its end Q is free, can come out round the corner, and is 3 from the left side.
  write("bent.json", R"({"outer":[[0,0],[10,0],[10,10],[9,10],[9,3],[1,3],[1,5],[7,5],[7,10],[0,10]]})");
  write("peg.json", R"({"outer":[[0,0],[1,0],[1,1],[0,1]]})");
  const auto depth = [&](const std::string& options) {
    const Outcome result = run("polygon --json --place-q 2,3.5 " + options + " bent.json peg.json");
    EXPECT_EQ(result.status, 0) << options << result.err;
    return Json::parse(result.out).at("depth");
  };
  EXPECT_EQ(depth("--complete"), 0.0);
  EXPECT_EQ(depth("--complete=escape"), 0.0);
  EXPECT_EQ(depth("--complete=straight"), 3.0);
  EXPECT_EQ(depth("--direction 1,0 --complete"), 8.0);
  EXPECT_EQ(depth("--direction 1,0 --complete=straight"), 8.0);
  EXPECT_EQ(depth("--direction 1,0 --complete=escape"), 0.0);
  const Outcome people = run("polygon bent.json peg.json --place-q 2,3.5 --complete=straight");
  EXPECT_NE(people.out.find("Straight on in this direction"), std::string::npos) << people.out;
  const Outcome unknown = run("polygon bent.json peg.json --complete=sideways");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("sideways"), std::string::npos) << unknown.err;
}

TEST_F(Program, PolygonPicture) {
  if (run("demo").out.find("dobkin") == std::string::npos) GTEST_SKIP() << "this build draws no pictures";
  write("plate.svg", R"(<svg width="40mm" viewBox="0 0 40 40"><path d="M0 0H40V30H0zM5 5v9h9v-9z"/></svg>)");
  write("disc.svg", R"(<svg width="40mm" viewBox="0 0 40 40"><circle cx="20" cy="10" r="3"/></svg>)");
  const Outcome result = run("polygon plate.svg disc.svg --picture out.png");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find(" mm"), std::string::npos) << result.out;
  EXPECT_TRUE(read("out.png").starts_with("\x89PNG"));
}

TEST_F(Program, DifferenceDemoDrawsAnyTwoMeshes) {
  if (run("demo").out.find("difference") == std::string::npos) GTEST_SKIP() << "this build has no demos";
  const std::string command = "demo difference spike.off cube.obj --size 640x360 --out drawn";
  const Outcome result = run(command);
  if (result.status == 1) GTEST_SKIP() << "no off-screen graphics here: " << result.err;
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(read("drawn/difference.png").starts_with("\x89PNG"));
  EXPECT_EQ(Json::parse(read("drawn/difference.json")).at("depth"), 0.5);
  EXPECT_EQ(run(command).status, 2) << "what is there is not replaced unasked";
  EXPECT_EQ(run(command + " --force").status, 0);
  EXPECT_EQ(run("demo difference cube.obj --out other").status, 2) << "two meshes, or none";
  EXPECT_EQ(run("depth spike.off cube.obj --picture pair.png").status, 0);
  EXPECT_TRUE(read("pair.png").starts_with("\x89PNG"));
}

TEST_F(Program, DepthTracesItsSearch) {
  const Outcome traced = run("depth cube.obj spike.off --method expansion --trace search.jsonl");
  EXPECT_EQ(traced.status, 0) << traced.err;
  EXPECT_EQ(traced.err, "");
  const std::string lines = read("search.jsonl");
  EXPECT_EQ(lines.rfind("{\"query\":\"depth\"", 0), 0U);
  EXPECT_NE(lines.find("\n{\"step\":0,"), std::string::npos);
  EXPECT_NE(lines.find("\n{\"end\":"), std::string::npos);
  EXPECT_NE(lines.find("\n{\"answer\":{"), std::string::npos);
  EXPECT_EQ(run("depth cube.obj spike.off --trace /no/such/folder/x").status, 1);
  const Outcome none = run("depth cube.obj spike.off --method overlay --trace none.jsonl");
  EXPECT_EQ(none.status, 0);
  EXPECT_NE(none.err.find("no polytope was expanded"), std::string::npos);

  if (run("demo").out.find("difference") == std::string::npos) GTEST_SKIP() << "this build has no demos";
  EXPECT_EQ(run("demo difference cube.obj spike.off --trace search.jsonl").status, 2);
  EXPECT_EQ(run("demo difference --trace missing.jsonl").status, 2);
  EXPECT_EQ(run("demo difference --trace none.jsonl --out nothing").status, 2);
  const Outcome drawn = run("demo difference --trace search.jsonl --out drawn --size 320x180");
  if (drawn.status == 1) GTEST_SKIP() << "no off-screen graphics here: " << drawn.err;
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_GT(std::filesystem::file_size(path() / "drawn" / "search_strip.png"), 10'000U);
}

TEST_F(Program, DepthTakesEveryKindOfPose) {
  for (const char* pose : {"0,0,1", "0,0,1,1,0,0,0", "0,0,1,1,0,0,0,1,0,0,0,1"}) {
    const Outcome result = run(std::string("depth cube.obj cube.obj --json --pose-b ") + pose);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(Json::parse(result.out).at("depth"), 1.0) << pose;
  }
}

TEST_F(Program, SimplifyEnclosesTheScanOrIsEnclosed) {
  std::string cloud;
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < 2000; ++i) {
    const double z = (2 * i + 1) / 2000.0 - 1, r = std::sqrt(1 - z * z), a = 2.4 * i;
    points.push_back({3 * r * std::cos(a), r * std::sin(a), z});
    std::ostringstream line;
    line.precision(17);
    line << "v " << points.back()[0] << " " << points.back()[1] << " " << points.back()[2] << "\n";
    cloud += line.str();
  }
  write("cloud.obj", cloud);
  const auto hull = [&](const std::string& name) {
    std::vector<std::array<double, 3>> vertices;
    std::istringstream text(read(name));
    for (std::string word; text >> word;) {
      if (word == "v") {
        vertices.emplace_back();
        text >> vertices.back()[0] >> vertices.back()[1] >> vertices.back()[2];
      }
    }
    return vertices;
  };
  const auto extent = [](const std::vector<std::array<double, 3>>& of, double x, double y, double z) {
    double most = -1e300;
    for (const auto& p : of) most = std::max(most, x * p[0] + y * p[1] + z * p[2]);
    return most;
  };
  const Outcome outer = run("simplify cloud.obj --epsilon 0.05 -o outer.obj");
  ASSERT_EQ(outer.status, 0) << outer.err;
  ASSERT_EQ(run("simplify cloud.obj --epsilon 0.05 --side inner -o inner.obj").status, 0);
  const auto around = hull("outer.obj"), within = hull("inner.obj");
  EXPECT_LT(around.size(), 200u);
  EXPECT_LT(within.size(), 120u);
  for (int i = 0; i < 500; ++i) {
    const double x = std::sin(1.0 + i), y = std::sin(2.0 + 1.7 * i), z = std::sin(0.3 + 2.3 * i);
    const double width = extent(points, x, y, z) + extent(points, -x, -y, -z);
    EXPECT_GE(extent(around, x, y, z), extent(points, x, y, z));
    EXPECT_LE(extent(around, x, y, z), extent(points, x, y, z) + 0.025 * width);
    EXPECT_LE(extent(within, x, y, z), extent(points, x, y, z));
    EXPECT_GE(extent(within, x, y, z) + extent(within, -x, -y, -z), 0.95 * width);
  }
  EXPECT_EQ(run("simplify missing.ply -o x.obj").status, 2);
  EXPECT_EQ(run("simplify cloud.obj --epsilon 2 -o x.obj").status, 2);
  EXPECT_EQ(run("simplify cloud.obj -o nowhere/x.obj").status, 1);
}

/// The volume of each group of an OBJ.
std::vector<double> group_volumes(const std::string& obj) {
  std::vector<double> volumes;
  std::vector<Vec3> points;
  std::istringstream text(obj);
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "o") volumes.push_back(0);
    if (word == "v") {
      points.emplace_back();
      words >> points.back().x() >> points.back().y() >> points.back().z();
    }
    if (word != "f") continue;
    std::vector<Vec3> loop;
    for (std::size_t v = 0; words >> v;) loop.push_back(points.at(v - 1));
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) volumes.back() += loop[0].dot(loop[k].cross(loop[k + 1])) / 6;
  }
  return volumes;
}

TEST_F(Program, DecomposeWritesConvexPartsWithACertifiedError) {
  write("L.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
        "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n");
  for (const char* side : {"", " --inside"}) {
    const Outcome two = run(std::string("decompose L.obj --error 1e-3 -o parts.obj") + side);
    ASSERT_EQ(two.status, 0) << two.err;
    EXPECT_NE(two.out.find("error_reached yes"), std::string::npos) << two.out;
    EXPECT_NE(two.out.find("at most 0, certified; asked: 0.001"), std::string::npos) << two.out;
    const std::vector<double> volumes = group_volumes(read("parts.obj"));
    ASSERT_EQ(volumes.size(), 2u);
    EXPECT_NEAR(volumes[0] + volumes[1], 3, 1e-12);
  }
  const Json facts = Json::parse(run("decompose L.obj --error 1e-3 -o parts.obj --json").out);
  EXPECT_EQ(facts.at("parts"), 2);
  EXPECT_EQ(facts.at("error_reached"), true);
  EXPECT_LE(facts.at("error").get<double>(), 1e-3);
  EXPECT_EQ(facts.at("side"), "outer");
  // Volumes that no double holds are told as such.
  for (const char* power : {"e-300", "e150"}) {
    std::string scaled = read("L.obj");
    for (const char digit : {'1', '2'}) {
      for (std::size_t at = 0; (at = scaled.find(std::string(" ") + digit, at)) < scaled.find("\nf"); at += 2) {
        scaled.insert(at + 2, power);
      }
    }
    write("scaled.obj", scaled);
    const Outcome found = run("decompose scaled.obj -o scaled_parts.obj");
    EXPECT_EQ(found.status, 0) << found.err;
    EXPECT_NE(found.out.find("beyond what a double holds"), std::string::npos) << found.out;
    const Json same = Json::parse(run("decompose scaled.obj -o scaled_parts.obj --json").out);
    EXPECT_EQ(same.at("parts"), 2);
    EXPECT_TRUE(same.at("solid_volume").is_null());
  }
  ASSERT_EQ(run("decompose L.obj --error 20% -o one.obj").status, 0);
  EXPECT_EQ(group_volumes(read("one.obj")), std::vector<double>{3.5});
  const Outcome early = run("decompose L.obj --error 1e-3 --max-parts 1 -o early.obj");
  EXPECT_EQ(early.status, 3);
  EXPECT_NE(early.out.find("error_reached no"), std::string::npos) << early.out;
  EXPECT_EQ(group_volumes(read("early.obj")).size(), 1u);
}

TEST_F(Program, DecomposeRefusesByName) {
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  const Outcome open = run("decompose open.obj -o parts.obj");
  EXPECT_EQ(open.status, 2);
  EXPECT_NE(open.err.find("open_edge"), std::string::npos) << open.err;
  EXPECT_NE(open.err.find("`pdepth simplify`"), std::string::npos) << open.err;
  write("out.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  const Outcome inside_out = run("decompose out.obj -o parts.obj");
  EXPECT_EQ(inside_out.status, 2);
  EXPECT_NE(inside_out.err.find("--turn-faces"), std::string::npos) << inside_out.err;
  EXPECT_EQ(run("decompose out.obj --turn-faces -o parts.obj").status, 0);
  for (const char* words : {"--error 0", "--error=-1", "--error nan", "--error inf", "--error 0%", "--error much",
                            "--max-parts 0", "--max-steps 0"}) {
    const Outcome refused = run(std::string("decompose cube.obj -o parts.obj ") + words);
    EXPECT_EQ(refused.status, 2) << words;
    EXPECT_FALSE(refused.err.empty()) << words;
  }
  write("cloud.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  const Outcome cloud = run("decompose cloud.xyz -o parts.obj");
  EXPECT_EQ(cloud.status, 2) << cloud.out;
  EXPECT_FALSE(cloud.err.empty());
  EXPECT_EQ(run("decompose cube.obj -o cube.obj").status, 2);
  EXPECT_EQ(run("decompose cube.obj -o parts.stl").status, 2);
  EXPECT_EQ(run("decompose cube.obj -o nowhere/parts.obj").status, 1);
}

TEST_F(Program, EveryMethodAnswersThePairOfPolytopes) {
  for (const char* method : {"auto", "expansion", "overlay", "decomposition", "shallow", "grid"}) {
    const Outcome outcome = run(std::string("depth cube.obj spike.off --json --method ") + method);
    EXPECT_EQ(outcome.status, 0) << method << ": " << outcome.err;
    const auto answer = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(answer["class"], "overlapping") << method;
    EXPECT_LE(double(answer["lower"]), 0.5 * (1 + 0x1p-40)) << method;
    EXPECT_GE(double(answer["upper"]), 0.5 * (1 - 0x1p-40)) << method;
  }
  EXPECT_EQ(run("depth cube.obj spike.off --method guess").status, 2);
}

TEST_F(Program, PicturesAreNamedForWhatTheyAre) {
  const Outcome outcome = run("depth cube.obj spike.off --picture pair.jpg");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("*.png"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path() / "pair.jpg"));
}

}  // namespace
}  // namespace pd::test
