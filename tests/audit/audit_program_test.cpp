/// @file
/// `pdepth audit` from outside: what is wrong with a record, exit codes, files, the same bytes with any thread count.
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <string>

#include "record_text.hpp"

namespace pd::test {
namespace {

using Json = nlohmann::json;

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;
};

class AuditProgram : public ::testing::Test, protected TemporaryFolder {
 protected:
  Outcome run(const std::string& arguments) {
    const std::string command = "cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' " + arguments + " > out 2> err";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out"), read("err")};
  }
  Outcome audit(const std::string& record, const std::string& options = "") {
    write("record.jsonl", record);
    return run("audit record.jsonl " + options);
  }
};

RecordText cubes() { return RecordText().shape("s", R"({"type":"box","half_extents":[1,1,1]})"); }

std::string at(const std::string& x) { return R"(,"pose_b":{"translation":[)" + x + ",0,0]}"; }

TEST_F(AuditProgram, WritesTheAnswerOfTheProtocol) {
  const RecordText record = cubes()
                                .contact("s", "s", at("1.5"), R"({"depth":0.5,"normal":[-1,0,0]})")
                                .contact("s", "s", at("1.5"), R"({"depth":0.25})")
                                .contact("s", "s", at("1"), "null")
                                .contact("s", "s", at("3"), R"({"depth":0.25})");
  const Outcome result = audit(record.text(), "--json --worst 3");
  EXPECT_EQ(result.status, 0) << result.err;
  const Json answer = Json::parse(result.out);
  EXPECT_EQ(answer.at("contacts"), 4);
  EXPECT_EQ(answer.at("judged"), 4);
  EXPECT_EQ(answer.at("missed"), 1);
  EXPECT_EQ(answer.at("phantom"), 1);
  EXPECT_EQ(answer.at("unanswered"), 0);
  EXPECT_NEAR(answer.at("depth_error").at("max").get<double>(), 1.25 / 5, 1e-14);
  EXPECT_NEAR(answer.at("depth_error").at("p50").get<double>(), 0.25 / 3.5, 0.01);
  EXPECT_TRUE(answer.at("point_error").at("max").is_null());
  EXPECT_TRUE(answer.at("point_error").at("p99").is_null());
  ASSERT_EQ(answer.at("by_kind").size(), 1U);
  EXPECT_EQ(answer.at("by_kind")[0].at("kind"), "box-box");
  EXPECT_EQ(answer.at("by_kind")[0].at("missed"), 1);
  const Json& worst = answer.at("worst");
  ASSERT_EQ(worst.size(), 3U);
  EXPECT_EQ(worst[0].at("contact"), 3);
  EXPECT_EQ(worst[0].at("column"), "missed");
  EXPECT_NEAR(worst[0].at("error").get<double>(), 1.0 / 3, 1e-14);
  EXPECT_TRUE(worst[0].at("reported").is_null());
  EXPECT_EQ(worst[1].at("contact"), 4);
  EXPECT_EQ(worst[1].at("column"), "depth_error");
  EXPECT_EQ(worst[1].at("exact").at("class"), "separated");
  EXPECT_EQ(worst[1].at("reported"), Json::parse(R"({"depth":0.25})"));
  // The line that asks again gives the same answer.
  write("again.jsonl", worst[0].at("query").dump() + "\n");
  const Json again = Json::parse(run("query again.jsonl").out);
  EXPECT_EQ(again.at("id"), 3);
  EXPECT_EQ(again.at("depth"), worst[0].at("exact").at("depth"));
  EXPECT_EQ(again.at("depth"), 1.0);
}

TEST_F(AuditProgram, RefusesLinesByNameAndJudgesTheRest) {
  RecordText record = cubes();                                                                      // lines 1, 2
  record.contact("s", "t", "", "null");                                                             // 3 unknown shape
  record.contact("s", "s", R"(,"pose_b":{"rotation_row_major":[1,0,0,0,1,0,0,0,2]})", "null");      // 4
  record.contact("s", "s", R"(,"pose_b":{"translation":["nan",0,0]})", "null");                     // 5
  record.contact("s", "s", R"(,"pose_b":{"translation":[NaN,0,0]})", "null");                       // 6
  record.contact("s", "s", R"(,"speed":1)", "null");                                                // 7
  record.shape("s", R"({"type":"sphere","radius":1})");                                             // 8 twice
  record.shape("u", R"({"type":"sphere","radius":-1})");                                            // 9
  record.line("");                                                                                  // 10 skipped
  record.line(kHeader);                                                                             // 11
  record.contact("s", "s", "", R"({"depth":1,"normal":[0,0,0]})");                                  // 12
  record.contact("s", "s", "", R"({"normal":[1,0,0]})");                                            // 13
  record.line(R"({"contact":1,"a":"s","b":"s"})");                                                  // 14
  record.line("[]");                                                                                // 15
  record.contact("s", "v", "", "null").shape("v", R"({"type":"sphere","radius":1})");               // 16 too early
  record.contact("s", "v", at("1.5"), R"({"depth":0.5})");                                          // 18 right
  const Outcome result = audit(record.text() + R"({"contact":9,"a":"s","b":"s","repo)", "--json");  // 19 cut off
  EXPECT_EQ(result.status, 2);
  const Json answer = Json::parse(result.out);
  EXPECT_EQ(answer.at("contacts"), 1);
  EXPECT_EQ(answer.at("judged"), 1);
  const std::vector<std::pair<int, std::string>> expected{
      {3, "bad_value"},      {4, "not_a_rotation"}, {5, "non_finite"}, {6, "bad_json"},        {7, "bad_value"},
      {8, "bad_value"},      {9, "bad_value"},      {11, "bad_value"}, {12, "zero_direction"}, {13, "missing_field"},
      {14, "missing_field"}, {15, "bad_json"},      {16, "bad_value"}, {19, "bad_json"}};
  const Json& errors = answer.at("errors");
  ASSERT_EQ(errors.size(), expected.size()) << errors.dump(1);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(errors[i].at("line"), expected[i].first);
    EXPECT_EQ(errors[i].at("code"), expected[i].second) << errors[i].dump();
  }
  EXPECT_NE(result.err.find("record.jsonl:4: not_a_rotation: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("at pose_b.rotation_row_major"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find(":15: bad_json: a line must be one JSON object with a \"shape\" or a \"contact\""),
            std::string::npos)
      << result.err;
  const std::string table = run("audit record.jsonl").out;
  EXPECT_NE(table.find("1 judged of 9;"), std::string::npos) << "eight lines name a contact and are refused\n" << table;
}

// The two mistakes that recorders make are named; one bad contact of an engine among good ones is none of them.
TEST_F(AuditProgram, SaysWhenTheRecorderSeemsWrong) {
  const auto outcome = [&](const char* wrong, int bad, int good) {
    RecordText record = cubes();
    for (int i = 0; i < bad; ++i) record.contact("s", "s", at("1.5"), wrong);
    for (int i = 0; i < good; ++i) record.contact("s", "s", at("1.5"), R"({"depth":0.5,"normal":[-1,0,0]})");
    return audit(record.text(), "--report page").out;
  };
  const char* normal = R"({"depth":0.5,"normal":[1,0,0]})";
  const char* depth = R"({"depth":-0.5,"normal":[-1,0,0]})";
  EXPECT_NE(outcome(normal, 3, 1).find("hint: 3 of 4 normals"), std::string::npos);
  EXPECT_NE(read("page/report.html").find("The recorder may be wrong"), std::string::npos);
  EXPECT_NE(outcome(depth, 3, 1).find("hint: 3 of 4 depths"), std::string::npos);
  EXPECT_EQ(outcome(normal, 1, 3).find("hint"), std::string::npos);
  EXPECT_EQ(outcome(depth, 1, 3).find("hint"), std::string::npos);
  EXPECT_EQ(outcome(R"({"depth":0.1,"normal":[0,1,0]})", 3, 0).find("hint"), std::string::npos) << "wrong either way";
  EXPECT_EQ(read("page/report.html").find("The recorder may be wrong"), std::string::npos);
}

TEST_F(AuditProgram, RefusesWhatIsNoRecord) {
  for (const char* record : {"", "\n\n", "rubbish\n", R"({"shape":"s","is":{"type":"sphere","radius":1}})",
                             R"({"record":"pdepth-contacts/2","engine":"e","scalar":"float32"})",
                             R"({"record":"pdepth-contacts/1","engine":"e","scalar":"half"})",
                             R"({"record":"pdepth-contacts/1","engine":"e"})"}) {
    const Outcome result = audit(record, "--json");
    EXPECT_EQ(result.status, 2) << record;
    EXPECT_TRUE(result.out.empty()) << record;
    EXPECT_NE(result.err.find("record.jsonl:"), std::string::npos) << result.err;
  }
  EXPECT_EQ(run("audit nowhere.jsonl").status, 2);
  EXPECT_EQ(audit(cubes().text(), "--tolerance 0").status, 2);
  for (const char* condition : {"missd=0", "missed", "missed=", "missed=x", "missed=-1", "missed=0,", "=1"}) {
    EXPECT_EQ(audit(cubes().text(), std::string("--fail-on ") + condition).status, 2) << condition;
  }
}

TEST_F(AuditProgram, ConditionsAndTheirExitCodes) {
  const std::string record = cubes().contact("s", "s", at("1.5"), R"({"depth":0.25})").text();
  EXPECT_EQ(audit(record, "--fail-on missed=0,phantom=0,depth_error=0.1").status, 0);
  EXPECT_EQ(audit(record, "--fail-on missed=0,depth_error=0.07").status, 3);
  EXPECT_EQ(audit(record, "--fail-on depth_error_absolute=0.2").status, 3);
  EXPECT_EQ(audit(record + "rubbish\n", "--fail-on missed=0").status, 2);
  EXPECT_EQ(audit(record + "rubbish\n", "--fail-on depth_error=0.01").status, 3) << "what fails, fails";
  EXPECT_EQ(audit(record + "rubbish\n", "--fail-on unanswered=0").status, 3);
  const Outcome table = audit(record, "--fail-on depth_error=0.01 --junit audit.xml");
  EXPECT_NE(table.out.find("FAILS  depth_error"), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("box-box"), std::string::npos);
  EXPECT_NE(read("audit.xml").find("failures=\"1\""), std::string::npos) << read("audit.xml");
  EXPECT_EQ(audit(record, "--junit nowhere/audit.xml").status, 1);
}

TEST_F(AuditProgram, ThePageForPeople) {
  const std::string record = cubes()
                                 .contact("s", "s", at("1.5"), R"({"depth":0.25})")
                                 .contact("s", "s", at("1"), "null")
                                 .line(R"({"contact":"<script>&","a":"s","b":"s","reported":{"depth":1e-300}})")
                                 .line("<rubbish>")
                                 .text();
  EXPECT_EQ(audit(record, "--report 'a page' --fail-on missed=0 --worst 9").status, 3);
  const std::string page = read("a page/report.html");
  pugi::xml_document document;
  const auto parsed = document.load_string(page.c_str(), pugi::parse_full);
  ASSERT_TRUE(parsed) << parsed.description();
  EXPECT_EQ(document.select_nodes("//details").size(), 3U);
  EXPECT_GE(document.select_nodes("//svg//rect/title").size(), 2U);
  EXPECT_EQ(document.select_nodes("//tbody/tr").size(), 1U + 3U) << "kinds; version, compiler and machine";
  EXPECT_EQ(document.select_nodes("//tfoot/tr").size(), 1U);
  // Nothing is fetched (tests/pages watches a browser).
  EXPECT_TRUE(document.select_nodes("//script[@src] | //link | //img | //iframe").empty());
  EXPECT_EQ(document.select_nodes("//figure[@class='pair']").size(), 3U);
  EXPECT_EQ(document.select_nodes("//figure//svg[@role='img' and @aria-label]").size(), 6U);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
  // The line to ask again survives the page.
  std::string line;
  for (const auto& pre : document.select_nodes("//figure//details/pre")) line = pre.node().text().get();
  EXPECT_EQ(Json::parse(line).at("query"), "depth") << line;
  EXPECT_EQ(audit(record, "--report /dev/null/x").status, 1);
}

TEST_F(AuditProgram, TheSameBytesWithAnyNumberOfThreads) {
  RecordText record = cubes();
  record.shape("c", R"({"type":"cylinder","radius":0.5,"half_height":1,"axis":"y"})");
  record.shape("f", R"({"type":"plane","normal":[0,1,0],"offset":0})");
  for (int i = 0; i < 6000; ++i) {  // more than a batch
    if (i % 1000 == 999) record.line("rubbish");
    const std::string where = std::to_string(1.0 + 0.0003 * i);
    const std::string shape = i % 50 == 0 ? "c" : i % 7 == 0 ? "f" : "s";
    record.contact("s", shape, at(where),
                   i % 11 == 0 ? "null" : R"({"depth":)" + std::to_string(0.5 - 0.0001 * i) + "}");
  }
  const Outcome one = audit(record.text(), "--json --worst 30 --csv one.csv --threads 1");
  const Outcome two = audit(record.text(), "--json --worst 30 --csv two.csv --threads 2");
  EXPECT_EQ(one.status, 2);
  EXPECT_EQ(one.out, two.out);
  EXPECT_EQ(one.err, two.err);
  const std::string csv = read("one.csv");
  EXPECT_EQ(csv, read("two.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6001);
  EXPECT_EQ(Json::parse(one.out).at("refused_lines"), 6);
}

}  // namespace
}  // namespace pd::test
