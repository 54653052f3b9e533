/// @file
/// A recorded search written and read back, and the first line of its file as a query of its own.

#include "protocol/search_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "cli/temporary_folder.hpp"
#include "protocol/answer_line.hpp"

namespace pd::query {
namespace {

Pair two_boxes() {
  const Pose tilted = Pose::from_quaternion({0.8, 0.48, 0.36, 0.0}, {0.35, -0.25, 1.02}).value();
  return {{ConvexPolytope::box({1, 0.5, 0.25}).value(), {}},
          {ConvexPolytope::box({1.3, 0.9, 0.6}).value(), {}},
          tilted,
          Pose()};
}

SearchFile read_back(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_search_file(folder.write("search.jsonl", text));
}

TEST(SearchFile, ReadsBackWhatWasWritten) {
  const Pair pair = two_boxes();
  SearchRecorder recorder(pair, "expansion");
  struct Both final : SearchObserver {
    explicit Both(SearchRecorder& r) : recorder(r) {}
    void on_step(const SearchStep& step) override {
      recorder.on_step(step);
      steps.push_back(step);
    }
    void on_end(const SearchEnd& end) override {
      recorder.on_end(end);
      ends.push_back(end);
    }
    SearchRecorder& recorder;
    std::vector<SearchStep> steps;
    std::vector<SearchEnd> ends;
  } both(recorder);
  Scratch scratch;
  observe_searches(scratch, &both);
  DepthSettings settings;
  settings.method = Method::expansion;  // by themselves boxes are answered by their axes, without a search
  const PenetrationDepth answer = penetration_depth(pair.posed_a(), pair.posed_b(), scratch, settings);
  recorder.add_answer(answer, pair, 1);

  const SearchFile read = read_back(recorder.lines());
  ASSERT_EQ(read.steps.size(), both.steps.size());
  ASSERT_GT(read.steps.size(), 1U);
  for (std::size_t i = 0; i < read.steps.size(); ++i) {
    const SearchStep &x = read.steps[i], &y = both.steps[i];
    EXPECT_EQ(x.arithmetic, y.arithmetic);
    EXPECT_EQ(x.number, y.number);
    EXPECT_EQ(x.vertices, y.vertices);
    EXPECT_EQ(x.faces, y.faces);
    EXPECT_EQ(x.distances, y.distances);
    EXPECT_EQ(x.nearest, y.nearest);
    EXPECT_EQ(x.normal, y.normal);
    EXPECT_EQ(x.support, y.support);
    EXPECT_EQ(x.lower, y.lower);
    EXPECT_EQ(x.upper, y.upper);
  }
  ASSERT_EQ(read.ends.size(), both.ends.size());
  EXPECT_EQ(read.ends.back().outcome, both.ends.back().outcome);

  // The first line is the query itself.
  Session session;
  const std::string line = recorder.lines().substr(0, recorder.lines().find('\n'));
  const std::string answered = answer_line(line, session).text;
  EXPECT_NE(answered.find("\"class\":\"overlapping\""), std::string::npos) << answered;
  std::string depth;
  append_number(depth, answer.depth);
  EXPECT_NE(answered.find("\"depth\":" + depth), std::string::npos) << answered;
}

TEST(SearchFile, SaysWhichLineIsWrong) {
  const Pair pair = two_boxes();
  const std::string head = SearchRecorder(pair, "auto").lines();
  const auto refusal_of = [&](const std::string& rest) -> std::string {
    try {
      (void)read_back(head + rest);
    } catch (const Refusal& refusal) {
      return refusal.message + " | " + refusal.where;
    }
    return "";
  };
  EXPECT_EQ(refusal_of(""), "");
  EXPECT_NE(refusal_of("{\"surprise\":1}\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal_of("{\"step\":0").find("line 2"), std::string::npos);
  const std::string step =
      R"({"step":0,"arithmetic":"double","lower":null,"upper":null,"nearest":0,"normal":[0,0,1],)"
      R"("support":[0,0,1],"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]],"distances":[0]})";
  EXPECT_EQ(refusal_of(step + "\n"), "");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string out = step;
    return out.replace(out.find(from), from.size(), to) + "\n";
  };
  EXPECT_NE(refusal_of(changed("[[0,1,2]]", "[[0,1,3]]")).find("faces[0][2]"), std::string::npos);
  EXPECT_NE(refusal_of(changed("\"nearest\":0", "\"nearest\":1")).find("nearest"), std::string::npos);
  EXPECT_NE(refusal_of(changed("\"distances\":[0]", "\"distances\":[]")).find("distances"), std::string::npos);
  EXPECT_NE(refusal_of(changed("double", "single")).find("arithmetic"), std::string::npos);
  EXPECT_THROW((void)read_search_file("/no/such/file"), Refusal);
}

}  // namespace
}  // namespace pd::query
