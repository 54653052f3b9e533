/// @file
/// `pdepth accuracy`: recorder programs driven, their records counted by engine and family; programs that misbehave.
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <pugixml.hpp>

#include "audit/accuracy_engines.hpp"
#include "audit/accuracy_report.hpp"
#include "record_text.hpp"

namespace pd::test {
namespace {

namespace fs = std::filesystem;

class Accuracy : public ::testing::Test, protected TemporaryFolder {
 protected:
  /// A recorder in the shell. Its engine "good" knows the cubes' depth, "bad" sees less, nothing, and what is not
  /// there.
  std::string recorder() {
    const std::string cubes = RecordText().shape("s", R"({"type":"box","half_extents":[1,1,1]})").text();
    const auto contact = [](const char* x, const char* reported) {
      RecordText text("");
      text.contact("s", "s", std::string(R"(,"pose_b":{"translation":[)") + x + ",0,0]}", reported);
      return text.text().substr(1);
    };
    write("good", cubes + contact("1.5", R"({"depth":0.5,"normal":[-1,0,0]})") + contact("3", "null"));
    write("bad", cubes + contact("1.5", R"({"depth":0.4999,"normal":[-1,0,0]})") + contact("1", "null") +
                     contact("3", R"({"depth":0.25})") + contact("1", R"({"depth":"nan"})"));
    const std::string program = write("a recorder", R"(#!/bin/sh
here=$(dirname "$0")
engine=
while [ $# -gt 0 ]; do
  case $1 in
    --list) echo good; echo bad; exit 0 ;;
    --engine) engine=$2; shift ;;
    --out) out=$2; shift ;;
    --family) family=$2; shift ;;
    --cases) cp "$2" "$here/asked"; family=box; shift ;;
  esac
  shift
done
case $family in box|needle|sphere) ;; *) kill -9 $$ ;; esac
cat "$here/$engine" > "$out" && echo $([ "$family" = needle ] && echo 4936 || echo 1234) $([ "$family" = sphere ] && echo 3)
)");
    EXPECT_EQ(::chmod(program.c_str(), 0700), 0);
    return program;
  }
};

TEST_F(Accuracy, CountsWhatARecorderSays) {
  const std::string program = recorder();
  EXPECT_EQ(audit::engines_of(program), (std::vector<std::string>{"good", "bad"}));
  const audit::AccuracyRow good = audit::run_accuracy(program, "good", {"box", ""}, {});
  EXPECT_FALSE(good.failed);
  EXPECT_EQ(good.contacts, 2);
  EXPECT_EQ(good.wrong() + good.above_small, 0);
  EXPECT_EQ(good.nanoseconds, 1234);
  const audit::AccuracyRow bad = audit::run_accuracy(program, "bad", {"box", ""}, {});
  EXPECT_EQ(bad.contacts, 4);
  EXPECT_EQ(bad.missed, 1);
  EXPECT_EQ(bad.phantom, 1);
  EXPECT_EQ(bad.above_small, 2) << "the depth that is short, and the phantom";
  EXPECT_EQ(bad.above_large, 1);
  EXPECT_EQ(bad.no_answer, 1);
  EXPECT_EQ(bad.wrong(), 3);
  EXPECT_NEAR(bad.worst, 1.25 / 5, 1e-12);
}

TEST_F(Accuracy, PairsAtWhichAnEngineAborts) {
  const audit::AccuracyRow row = audit::run_accuracy(recorder(), "good", {"sphere", ""}, {});
  EXPECT_FALSE(row.failed) << "the other pairs count";
  EXPECT_EQ(row.nanoseconds, 1234);
  EXPECT_EQ(row.aborted, 3);
  EXPECT_EQ(row.contacts, 2 + 3);
  EXPECT_EQ(row.no_answer, 3);
  EXPECT_EQ(row.wrong(), 3);
}

TEST_F(Accuracy, TimeOfAnEngineIsTheGeometricMeanOverFamilies) {
  const audit::AccuracyTable table =
      audit::run_engines({{recorder(), "good"}}, {{"box", ""}, {"prism", ""}, {"needle", ""}}, {}, false);
  EXPECT_EQ(table.at(0, 2).nanoseconds, 4936);
  EXPECT_NEAR(table.total(0).nanoseconds, 2468, 1e-9) << "the family whose run failed has no time";
  EXPECT_EQ(table.total(0).contacts, 4);
}

TEST_F(Accuracy, ProgramsThatFail) {
  EXPECT_TRUE(audit::engines_of(path() / "nobody").empty());
  EXPECT_TRUE(audit::run_accuracy(path() / "nobody", "good", {"box", ""}, {}).failed);
  const std::string program = recorder();
  EXPECT_TRUE(audit::run_accuracy(program, "good", {"prism", ""}, {}).failed) << "it killed itself";
  EXPECT_TRUE(audit::run_accuracy(program, "none", {"box", ""}, {}).failed) << "it wrote no record";
}

TEST_F(Accuracy, TheCommand) {
  const std::string command = "'" PDEPTH_PROGRAM "' accuracy --recorder '" + recorder() + "' --families ";
  const std::string out = " > '" + (path() / "out").string() + "' 2>&1";
  EXPECT_EQ(WEXITSTATUS(std::system((command + "box --csv '" + (path() / "table.csv").string() + "'" + out).c_str())),
            0);
  EXPECT_NE(read("out").find("good "), std::string::npos) << read("out");
  EXPECT_NE(read("table.csv").find("\nbad,box,0,4,1,1,2,1,1,"), std::string::npos) << read("table.csv");
  EXPECT_EQ(WEXITSTATUS(std::system((command + "box,prism" + out).c_str())), 2) << "a run failed";
  EXPECT_EQ(WEXITSTATUS(std::system((command + "nonsense" + out).c_str())), 2);
}

TEST_F(Accuracy, ThePageForPeople) {
  const std::string command = "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' accuracy --recorder '" +
                              recorder() + "' --families box --report page > out 2>&1";
  ASSERT_EQ(WEXITSTATUS(std::system(command.c_str())), 0) << read("out");
  const std::string page = read("page/report.html");
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(page.c_str(), pugi::parse_full));
  EXPECT_EQ(document.select_nodes("//section[@id='engines']//tbody/tr").size(), 2U);
  EXPECT_EQ(document.select_nodes("//section[@id='families']//tbody/tr").size(), 1U);
  EXPECT_STREQ(document.select_node("//section[@id='families']//tbody/tr/td[3]").node().text().get(), "3");
  EXPECT_EQ(document.select_nodes("//figure[@class='pair']").size(), 1U) << "the good one has no worst contact";
  EXPECT_NE(page.find("bad, box: contact"), std::string::npos);
}

TEST_F(Accuracy, PairsOfARecordAndOfMeshes) {
  fs::create_directory(path() / "meshes");
  write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
  write("meshes/b.off", "OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n");
  write("meshes/c.stl", "solid rubbish");
  const std::string command = "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' accuracy --recorder '" +
                              recorder() + "' --engines good --pairs 3 ";
  ASSERT_EQ(WEXITSTATUS(std::system((command + "--meshes meshes > out 2>&1").c_str())), 0) << read("out");
  EXPECT_NE(read("out").find("c.stl is left out"), std::string::npos) << read("out");
  // The record that the recorder got: two hulls, each against the next at four depths.
  const std::string asked = read("asked");
  EXPECT_EQ(std::count(asked.begin(), asked.end(), '\n'), 1 + 2 + 2 * 4 * 3);
  write("record.jsonl", asked);
  const std::string audit = "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' audit record.jsonl > out";
  EXPECT_EQ(WEXITSTATUS(std::system(audit.c_str())), 0);
  EXPECT_NE(read("out").find("24 judged of 24"), std::string::npos) << read("out");
  write("mine.jsonl", asked);
  ASSERT_EQ(WEXITSTATUS(std::system((command + "--cases mine.jsonl > out 2>&1").c_str())), 0) << read("out");
  EXPECT_EQ(read("asked"), asked);
  EXPECT_NE(read("out").find("mine "), std::string::npos) << read("out");
  ASSERT_EQ(WEXITSTATUS(std::system((command + "--engines great > out 2>&1").c_str())), 2);
  EXPECT_NE(read("out").find("--engines: there is no engine \"great\"; known: good, bad\n"), std::string::npos)
      << read("out");
  EXPECT_EQ(read("out").find("no engine to ask"), std::string::npos) << read("out");
  EXPECT_EQ(WEXITSTATUS(std::system((command + "--meshes nowhere > out 2>&1").c_str())), 2);
}

}  // namespace
}  // namespace pd::test
