/// @file
/// What one line may cost: points counted while they are read, a bound of time and of memory, records of lines, Ctrl-C.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "bench/measure/sanitized.hpp"
#include "protocol/line/bounded_line.hpp"
#include "protocol/stream/line_budget.hpp"
#include "protocol_lines.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

using query::answer_within;
using query::LineBudget;
using query::Session;

std::string list_of_points(int count) {
  std::string text = "[";
  for (int i = 0; i < count; ++i) {
    text += (i == 0 ? "[0," : ",[0,") + std::to_string(i % 7) + "," + std::to_string(i) + "]";
  }
  return text + "]";
}

TEST(LineLimits, PointsAreCountedWhileTheyAreRead) {
  query::Limits limits;
  limits.max_vertices = 100;
  const auto hull = [&](const std::string& vertices, const std::string& behind) {
    return answer(R"({"id":7,"query":"hull","a":{"type":"convex","vertices":)" + vertices + "}}" + behind, limits);
  };
  EXPECT_EQ(code_of(hull(list_of_points(100), "")), "");
  const Json refused = hull(list_of_points(101), "");
  EXPECT_EQ(code_of(refused), "limit_exceeded");
  EXPECT_EQ(where_of(refused), "a.vertices");
  EXPECT_EQ(refused.at("id"), 7);
  // The reading ends at the limit: what is wrong behind it is never met.
  EXPECT_EQ(code_of(hull(list_of_points(101), "}}} no JSON")), "limit_exceeded");
  EXPECT_EQ(code_of(hull(list_of_points(100), "}}} no JSON")), "bad_json");
  const Json nested = answer(R"({"query":"depth","a":{"type":"compound","parts":[{"shape":)" + std::string(kUnitBox) +
                                 R"(},{"shape":{"type":"convex","vertices":)" + list_of_points(101) + "}}]}}",
                             limits);
  EXPECT_EQ(where_of(nested), "a.parts[1].shape.vertices");
  // Any other kind of list is bounded by the count of its values.
  std::string empty = "[";
  for (int i = 0; i < 150'000; ++i) empty += "[],";
  EXPECT_EQ(code_of(answer(R"({"query":"hull","a":)" + empty + "0]}", limits)), "limit_exceeded");
}

TEST(LineLimits, ListsThatAreNoPointsAreReadAsEver) {
  const auto code_and_place = [](const std::string& vertices) {
    const Json reply = answer(R"({"query":"hull","a":{"type":"convex","vertices":)" + vertices + "}}");
    return code_of(reply) + " " + where_of(reply);
  };
  EXPECT_EQ(code_and_place("[]"), "too_few_points a.vertices");
  EXPECT_EQ(code_and_place("[[0,0,0],[1,2]]"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place("[[0,0,0],[1,2,3,4]]"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place(R"([[0,0,0],[1,2,3],[0,"nan",1],[3,3,3]])"), "non_finite a.vertices[2]");
  EXPECT_EQ(code_and_place("[[0,0,0],[1,[2],3]]"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place("[[0,0,0],7]"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place(R"([[0,0,0],{"x":1}])"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place("[[0,0,0],[]]"), "bad_value a.vertices[1]");
  EXPECT_EQ(code_and_place("[[0,0,0],[1,1,1]]"), " ");
  EXPECT_EQ(code_and_place("[[0,0,1e999]]"), "bad_json ");
  // An id goes back as it came.
  const Json reply = answer(R"({"id":{"vertices":[[1,2,3]]},"query":"hull","a":)" + std::string(kUnitBox) + "}");
  EXPECT_EQ(reply.at("id"), Json::parse(R"({"vertices":[[1,2,3]]})"));
}

TEST(LineBudget, AnOrdinaryLineHasItsOrdinaryAnswer) {
  Session session;
  const std::string line = R"({"id":3,"query":"hull","a":)" + std::string(kUnitBox) + "}";
  Json within = Json::parse(answer_within(line, session, {.milliseconds = 60'000, .megabytes = 2'000}).text);
  Json without = answer(line);
  within.erase("stats");
  without.erase("stats");
  EXPECT_EQ(within, without);
}

TEST(LineBudget, TimeEndsWithTheBracketSoFar) {
  Session session;
  // Nearly balls: a bracket of 1e-9 takes as many rays as a search may shoot.
  const std::string line =
      R"({"id":"slow","query":"depth","method":"grid","delta":1e-9,"a":{"type":"ellipsoid","radii":[1,1.0001,1.0002]},)"
      R"("b":{"type":"ellipsoid","radii":[1,1.0003,1.0001]},"pose_b":{"quaternion_wxyz":[0.5,0.5,0.5,0.5]}})";
  const Json cut = Json::parse(answer_within(line, session, {.milliseconds = 100, .megabytes = 0}).text);
  EXPECT_EQ(cut.at("id"), "slow");
  if (code_of(cut).empty()) {
    EXPECT_EQ(cut.at("bracket_reached"), false);
    EXPECT_LE(cut.at("lower"), 2.0001);
    EXPECT_GE(cut.at("upper"), 2.0001);
  } else {
    EXPECT_EQ(code_of(cut), "limit_exceeded");  // a machine so slow that even the coarse run was not ready
  }
  // What has no bracket is refused, and the next line answered.
  const std::string hull =
      R"({"id":1,"query":"hull","a":{"type":"convex","vertices":)" + list_of_points(400'000) + "}}";
  // Where the system keeps this process from its clock for as long as the hull takes, the answer is ready by then:
  // again.
  bool refused = false;
  for (int i = 0; i < 25 && !refused; ++i) {
    refused = code_of(Json::parse(answer_within(hull, session, {.milliseconds = 2, .megabytes = 0}).text)) ==
              "limit_exceeded";
  }
  EXPECT_TRUE(refused);
}

/// The coarse run starts where half the time is over: before that, a line that asks for no body brought the stream
/// down.
TEST(LineBudget, ALineWithoutABodyIsRefused) {
  Session session;
  for (const char* rest : {"", R"(,"b":null)", R"(,"b":[])", R"(,"b":{"type":7})"}) {
    const std::string line =
        R"({"id":1,"query":"depth","a":{"type":"convex","vertices":)" + list_of_points(5'000) + "}" + rest + "}";
    for (int i = 0; i < 10; ++i) {
      const Json reply = Json::parse(answer_within(line, session, {.milliseconds = 2, .megabytes = 100}).text);
      EXPECT_NE(code_of(reply), "") << reply;
    }
  }
}

TEST(LineBudget, WordsInAnIdAreNoAnswer) {
  Session session;
  const LineBudget budget{.milliseconds = 60'000, .megabytes = 0};
  // What the answer says is set in data: an id that holds the same words changes nothing.
  const std::string id =
      R"({"bracket_reached":false,"code":"limit_exceeded","error":{"code":"limit_exceeded"},"translation":[1]})";
  const std::string line = R"({"id":)" + id + R"(,"query":"hull","a":)" + kUnitBox + "}";
  for (const query::LineAnswer& answer : {answer_within(line, session, budget), query::answer_line(line, session)}) {
    EXPECT_TRUE(answer.text.starts_with(R"({"id":)" + id + ",\"vertices\"")) << answer.text;
    EXPECT_FALSE(answer.unreached);
    EXPECT_FALSE(answer.limit_exceeded);
  }
  const std::string depth = R"({"id":)" + id + R"(,"query":"depth","a":)" + kUnitBox + R"(,"b":)" + kUnitBox + "}";
  const auto coarse = query::answer_coarsely(depth, session);
  ASSERT_TRUE(coarse.has_value());
  EXPECT_TRUE(coarse->unreached);
  EXPECT_EQ(Json::parse(coarse->text).at("bracket_reached"), false);
  EXPECT_TRUE(coarse->text.starts_with(R"({"id":)" + id + ",\"class\"")) << coarse->text;
  session.limits.max_vertices = 2;
  const query::LineAnswer limited =
      answer_within(R"({"id":)" + id + R"(,"query":"hull","a":{"type":"convex","vertices":)" + list_of_points(3) + "}}",
                    session, budget);
  EXPECT_TRUE(limited.limit_exceeded);
  EXPECT_TRUE(limited.text.starts_with(R"({"id":)" + id + ",\"error\"")) << limited.text;
}

TEST(LineBudget, AnIdMayHoldNumbersThatNoDoubleHolds) {
  Session session;
  const LineBudget budget{.milliseconds = 60'000, .megabytes = 0};
  for (const std::string id : {"1e999", "-1e-999", R"([1,{"x":[1e400,2]}])", R"({"a":1E+308000})"}) {
    const std::string line = R"({"query":"hull","id":)" + id + R"( ,"a":)" + kUnitBox + "}";
    for (const query::LineAnswer& answer : {answer_within(line, session, budget), query::answer_line(line, session)}) {
      EXPECT_TRUE(answer.text.starts_with(R"({"id":)" + id + ",\"vertices\"")) << answer.text;
    }
    const std::string beside = R"({"id":)" + id + R"(,"query":"hull","a":1e999})";
    const query::LineAnswer refused = query::answer_line(beside, session);
    EXPECT_TRUE(refused.text.starts_with(R"({"id":)" + id + ",\"error\":{\"code\":\"bad_json\"")) << refused.text;
  }
}

/// A process that had no time to read the line leaves it to the parent to find the id, in the line's first megabyte.
TEST(LineBudget, TheIdIsFoundInALineThatNobodyRead) {
  EXPECT_EQ(query::id_of_line(R"({"x":[{"id":1}],"y":{"id":2}, "id" : [1e999, "\"id\":"] ,"id":4})"),
            R"([1e999, "\"id\":"])");
  EXPECT_EQ(query::id_of_line(R"({"x":{"id":3})"), "null");
  EXPECT_EQ(query::id_of_line(R"({"x":}, "id":3})"), "null");
  EXPECT_EQ(query::id_of_line(R"([{"id":3}])"), "null");
  EXPECT_EQ(query::id_of_line(std::string(200'000, '[')), "null");
  EXPECT_EQ(query::id_of_line(R"({"x":")" + std::string(2'000'000, ' ') + R"(","id":3})"), "null");
  Session session;
  for (int i = 0; i < 20; ++i) {
    const query::LineAnswer answer = answer_within(R"({"query":"hull","id":"mine","a":)" + std::string(kUnitBox) + "}",
                                                   session, {.milliseconds = 1, .megabytes = 0});
    EXPECT_TRUE(answer.text.starts_with(R"({"id":"mine",)")) << answer.text;
  }
}

/// The parent holds the line and nothing of what it says: the line's own process meets the limits, while it reads.
TEST(LineBudget, TheIdIsKnownBeforeTheLineIsRead) {
  Session session;
  std::string line = R"({"id":[1.0, 2],"query":"hull","x":[)";
  for (int i = 0; i < 1'500'000; ++i) line += "{},";
  line += "{}]}";
  for (int i = 0; i < 25; ++i) {  // a machine may be so quick, or so slow, that another limit ends the line
    const query::LineAnswer answer = answer_within(line, session, {.milliseconds = 20, .megabytes = 0});
    EXPECT_EQ(code_of(Json::parse(answer.text)), "limit_exceeded");
    EXPECT_TRUE(answer.limit_exceeded);
    if (answer.text.starts_with(R"({"id":[1.0, 2],"error")")) return;
  }
  ADD_FAILURE() << "the id was never known";
}

TEST(LineBudget, MemoryEndsTheLineAndNoOther) {
#if defined(PD_SANITIZED)
  GTEST_SKIP() << "a sanitizer's shadow takes address space without bound";
#endif
  Session session;
  const std::string line =
      R"({"id":1,"query":"hull","a":{"type":"convex","vertices":)" + list_of_points(1'000'000) + "}}";
  EXPECT_EQ(code_of(Json::parse(answer_within(line, session, {.milliseconds = 0, .megabytes = 1}).text)),
            "limit_exceeded");
  const std::string next = R"({"id":2,"query":"hull","a":)" + std::string(kUnitBox) + "}";
  EXPECT_EQ(code_of(Json::parse(answer_within(next, session, {.milliseconds = 0, .megabytes = 400}).text)), "");
}

class ProgramWithFiles : public ::testing::Test, protected TemporaryFolder {
 protected:
  int run(const std::string& command) {
    const int status = std::system(("cd '" + path().string() + "' && " + command).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  const std::string program_ = "'" PDEPTH_PROGRAM "'";
};

TEST_F(ProgramWithFiles, ARecordReplaysToTheSameBits) {
  const std::string lines = depth_line(kUnitBox, R"({"type":"ellipsoid","radii":[1,2,3]})") + "\n" +
                            depth_line(kUnitBox, kUnitBox, R"("pose_b":{"translation":[0.1,0.3,1e-17]})") + "\n" +
                            R"({"id":9,"query":"depth","a":{"type":"ellipsoid","radii":[1e10,1,1]},"b":)" + kUnitBox +
                            "}\n";
  write("lines", lines);
  const std::string strip = " | sed 's/\"nanoseconds\":[0-9]*//' ";
  ASSERT_EQ(run(program_ + " query lines --record all" + strip + "> first"), 0);
  EXPECT_EQ(read("all"), lines);
  ASSERT_EQ(run(program_ + " query all" + strip + "> second"), 0);
  EXPECT_EQ(read("first"), read("second"));
  ASSERT_EQ(run(program_ + " query lines --record some --record-unreached > answers"), 0);
  EXPECT_EQ(read("some"), lines.substr(lines.rfind("{\"id\":9")));
  ASSERT_EQ(run(program_ + " query lines --record none --record-above 1e9 > answers"), 0);
  EXPECT_EQ(read("none"), "");
  EXPECT_EQ(run(program_ + " query lines --record /nowhere/to/be > answers 2> words"), 1);
  // An id that holds the words of a limit is none.
  write("fooling", R"({"id":{"code":"limit_exceeded","bracket_reached":false},"query":"hull","a":)" +
                       std::string(kUnitBox) + "}\n");
  ASSERT_EQ(run(program_ + " query fooling --record fooled --record-unreached > answers"), 0);
  EXPECT_EQ(read("fooled"), "");
}

TEST_F(ProgramWithFiles, RecordsAreAppendedLineByLine) {
  const std::string line = R"({"query":"hull","a":)" + std::string(kUnitBox) + "}\n";
  // A line that a full disk has cut is not glued to the next.
  write("record", line.substr(0, 20));
  write("lines", line);
  ASSERT_EQ(run(program_ + " query lines --record record > answers"), 0);
  EXPECT_EQ(read("record"), line.substr(0, 20) + "\n" + line);
  // Several programs that append to one record.
  std::string many;
  const std::string long_line = R"({"id":")" + std::string(5'000, 'x') + R"(","query":"hull","a":)" + kUnitBox + "}\n";
  for (int i = 0; i < 300; ++i) many += long_line;
  write("many", many);
  ASSERT_EQ(run("for i in 1 2 3; do " + program_ + " query many --threads 2 --record shared > answers$i & done; wait"),
            0);
  std::istringstream lines(read("shared"));
  int count = 0;
  for (std::string each; std::getline(lines, each); ++count) ASSERT_EQ(each + "\n", long_line) << count;
  EXPECT_EQ(count, 900);
}

TEST_F(ProgramWithFiles, ARecordIsNotItsOwnInput) {
  const std::string line = R"({"query":"hull","a":)" + std::string(kUnitBox) + "}\n";
  for (const char* command : {" query lines --record lines > answers", " query - --record lines < lines > answers",
                              " query lines --record link > answers", " query lines >> lines"}) {
    write("lines", line);
    if (!std::filesystem::exists(path() / "link")) std::filesystem::create_symlink("lines", path() / "link");
    EXPECT_EQ(run("ulimit -f 1000; " + program_ + command + " 2> words"), 2) << command;
    EXPECT_EQ(read("lines"), line) << command;
    EXPECT_NE(read("words").find("is the input"), std::string::npos) << read("words");
  }
}

TEST_F(ProgramWithFiles, MinimiseKeepsWhatThePredicateAsksFor) {
  write(
      "line",
      R"({"id":1,"query":"hull","a":{"type":"convex","vertices":[[0.123,5,1],[1,0,0],[0,1,0],[0.7,0.8,"nan"],[4,4,4]]}})"
      "\n");
  const std::string predicate = "--predicate \"" + program_ + " query | grep -q non_finite\"";
  ASSERT_EQ(run(program_ + " minimise line " + predicate + " > small 2> words"), 0);
  EXPECT_EQ(Json::parse(read("small")),
            Json::parse(R"({"query":"hull","a":{"type":"convex","vertices":[[0,0,"nan"]]}})"));
  write("fine", R"({"query":"hull","a":{"type":"box","half_extents":[1,1,1]}})");
  EXPECT_EQ(run(program_ + " minimise fine " + predicate + " > small 2> words"), 2);
}

/// What a run of the program took at its most, and the program's own processes with it, in bytes.
std::size_t most_memory(const std::string& input, std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), {"pdepth", "query"});
  arguments.push_back(input.c_str());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::execv(PDEPTH_PROGRAM, const_cast<char* const*>(arguments.data()));
    ::_exit(127);
  }
  int status = -1;
  rusage used{};
  EXPECT_EQ(::wait4(child, &status, 0, &used), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  return static_cast<std::size_t>(used.ru_maxrss) * 1024;
}

TEST_F(ProgramWithFiles, ALineTakesAFewTimesItsOwnMemory) {
#if defined(PD_SANITIZED)
  GTEST_SKIP() << "a sanitizer's shadow and quarantine take memory of their own";
#endif
  constexpr std::size_t kSize = 57'000'000;
  for (const char* values : {"{},", "[],", "{\"k\":0},", "\"\",", "1,", "[[0,0,0]],"}) {
    std::string line = R"({"id":1,"query":"hull","x":[)";
    line.reserve(kSize + 100);
    while (line.size() < kSize) line += values;
    line += "0]}";
    const std::string file = write("long", line);
    EXPECT_LT(most_memory(file, {}), 4 * kSize) << values;
    if (values[0] != '{') continue;
    EXPECT_LT(most_memory(file, {"--max-time", "10000"}), 4 * kSize) << values;
    EXPECT_LT(most_memory(file, {"--max-time", "100", "--max-memory", "100", "--max-vertices", "100"}), 3 * kSize)
        << values;
  }
}

/// A program that waits for its next line: its first answer shows that it is there.
TEST_F(ProgramWithFiles, InterruptedProgramEndsWith130) {
  int in[2], out[2];
  ASSERT_EQ(::pipe(in), 0);
  ASSERT_EQ(::pipe(out), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::dup2(in[0], STDIN_FILENO);
    ::dup2(out[1], STDOUT_FILENO);
    ::close(in[1]);
    ::execl(PDEPTH_PROGRAM, "pdepth", "query", nullptr);
    ::_exit(127);
  }
  ::close(in[0]);
  ::close(out[1]);
  const std::string line = std::string(R"({"query":"hull","a":)") + kUnitBox + "}\n";
  ASSERT_EQ(::write(in[1], line.data(), line.size()), static_cast<ssize_t>(line.size()));
  char byte = 0;
  ASSERT_EQ(::read(out[0], &byte, 1), 1);
  ASSERT_EQ(::kill(child, SIGINT), 0);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  // A shell shows 130 for a death by the signal, too; this is an exit.
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 130);
  ::close(in[1]);
  ::close(out[0]);
}

}  // namespace
}  // namespace pd::test
