/// @file
/// The stream: order, limits and flushing, by one thread and by several.
#include "protocol/stream/query_stream.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "protocol_lines.hpp"

namespace pd::test {
namespace {

class File {
 public:
  explicit File(const std::string& content = "") {
    char name[] = "/tmp/pd_stream_XXXXXX";
    descriptor_ = ::mkstemp(name);
    path_ = name;
    if (!content.empty()) {
      EXPECT_EQ(::write(descriptor_, content.data(), content.size()), static_cast<ssize_t>(content.size()));
    }
    ::lseek(descriptor_, 0, SEEK_SET);
  }
  ~File() {
    ::close(descriptor_);
    std::filesystem::remove(path_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::vector<Json> lines() const {
    std::ifstream in(path_);
    std::vector<Json> result;
    for (std::string line; std::getline(in, line);) result.push_back(Json::parse(line));
    return result;
  }

 private:
  int descriptor_;
  std::string path_;
};

std::vector<Json> answers_to(const std::string& input, const query::StreamSettings& settings) {
  const File in(input);
  const File out;
  EXPECT_EQ(query::answer_stream(in.descriptor(), out.descriptor(), settings), query::StreamEnd::answered);
  return out.lines();
}

/// A small hull: quick, and another answer for every i.
std::string line_of(int i) {
  return R"({"id":)" + std::to_string(i) + R"(,"query":"hull","a":{"type":"convex","vertices":[[)" + std::to_string(i) +
         ",0,0]]}}";
}

TEST(QueryStream, KeepsTheOrderWithThreads) {
  std::string input;
  constexpr int kLines = 3000;
  for (int i = 0; i < kLines; ++i) input += line_of(i) + "\n";
  for (const int threads : {1, 2, 8}) {
    const std::vector<Json> answers = answers_to(input, {.limits = {}, .threads = threads});
    ASSERT_EQ(answers.size(), static_cast<std::size_t>(kLines)) << threads;
    for (int i = 0; i < kLines; ++i) {
      ASSERT_EQ(answers[static_cast<std::size_t>(i)].at("id"), i);
      ASSERT_EQ(answers[static_cast<std::size_t>(i)].at("vertices")[0][0], i);
    }
  }
}

TEST(QueryStream, SlowAndQuickLinesMixed) {
  std::string input;
  std::string points;
  for (int i = 0; i < 2000; ++i) {
    points += (i ? "," : "") + std::string("[") + std::to_string(i % 13) + "," + std::to_string(i % 17) + "," +
              std::to_string(i * i % 101) + "]";
  }
  for (int i = 0; i < 200; ++i) {
    input += i % 7 == 0 ? R"({"id":)" + std::to_string(i) + R"(,"query":"hull","a":{"type":"convex","vertices":[)" +
                              points + "]}}\n"
                        : "{\"id\":" + std::to_string(i) + "}\n";
  }
  const std::vector<Json> answers = answers_to(input, {.limits = {}, .threads = 4});
  ASSERT_EQ(answers.size(), 200u);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(answers[static_cast<std::size_t>(i)].at("id"), i);
}

TEST(QueryStream, BlankLinesAreSkippedAndTheLastNeedsNoEnd) {
  for (const int threads : {1, 3}) {
    const std::vector<Json> answers =
        answers_to("\n  \r\n" + line_of(1) + "\r\n\n\t\n" + line_of(2), {.limits = {}, .threads = threads});
    ASSERT_EQ(answers.size(), 2u);
    EXPECT_EQ(answers[0].at("id"), 1);
    EXPECT_EQ(answers[1].at("id"), 2);
  }
  EXPECT_TRUE(answers_to("", {}).empty());
  EXPECT_TRUE(answers_to("\n\n", {}).empty());
}

TEST(QueryStream, ErrorsDoNotStopTheStream) {
  const std::vector<Json> answers = answers_to("rubbish\n" + line_of(1) + "\n{\"id\":2}\n" + line_of(3) + "\n", {});
  ASSERT_EQ(answers.size(), 4u);
  EXPECT_EQ(code_of(answers[0]), "bad_json");
  EXPECT_EQ(code_of(answers[1]), "");
  EXPECT_EQ(code_of(answers[2]), "missing_field");
  EXPECT_EQ(code_of(answers[3]), "");
}

TEST(QueryStream, LongLinesAreDroppedNotHeld) {
  query::StreamSettings settings;
  settings.limits.max_line = line_of(1).size();
  for (const int threads : {1, 4}) {
    settings.threads = threads;
    const std::string input = line_of(1) + "\n" + line_of(2) + " \n" + std::string(10'000'000, 'x') + "\n" +
                              line_of(3) + "\n" + std::string(200'000, ' ');
    const std::vector<Json> answers = answers_to(input, settings);
    ASSERT_EQ(answers.size(), 5u);
    EXPECT_EQ(code_of(answers[0]), "") << "exactly the limit is allowed";
    EXPECT_EQ(code_of(answers[1]), "limit_exceeded") << "one byte more is not";
    EXPECT_EQ(code_of(answers[2]), "limit_exceeded");
    EXPECT_TRUE(answers[2].at("id").is_null());
    EXPECT_EQ(code_of(answers[3]), "");
    EXPECT_EQ(code_of(answers[4]), "limit_exceeded");
  }
}

TEST(QueryStream, AnswersEachLineOfAPipeAtOnce) {
  for (const int threads : {1, 2}) {
    int to_stream[2];
    int from_stream[2];
    ASSERT_EQ(::pipe(to_stream), 0);
    ASSERT_EQ(::pipe(from_stream), 0);
    std::thread stream([&] {
      EXPECT_EQ(query::answer_stream(to_stream[0], from_stream[1], {.limits = {}, .threads = threads}),
                query::StreamEnd::answered);
      ::close(from_stream[1]);
    });
    for (int i = 0; i < 20; ++i) {
      const std::string line = line_of(i) + "\n";
      ASSERT_EQ(::write(to_stream[1], line.data(), line.size()), static_cast<ssize_t>(line.size()));
      std::string reply;
      for (char c = 0; ::read(from_stream[0], &c, 1) == 1 && c != '\n';) reply += c;
      EXPECT_EQ(Json::parse(reply).at("id"), i);
    }
    ::close(to_stream[1]);
    stream.join();
    ::close(to_stream[0]);
    ::close(from_stream[0]);
  }
}

TEST(QueryStream, SaysWhenInputOrOutputFails) {
  const File in(line_of(1) + "\n");
  const int full = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  for (const int threads : {1, 2}) {
    ::lseek(in.descriptor(), 0, SEEK_SET);
    EXPECT_EQ(query::answer_stream(in.descriptor(), full, {.limits = {}, .threads = threads}),
              query::StreamEnd::unwritable);
  }
  ::close(full);
  const int folder = ::open("/tmp", O_RDONLY);
  const File out;
  EXPECT_EQ(query::answer_stream(folder, out.descriptor(), {}), query::StreamEnd::unreadable);
  ::close(folder);
}

}  // namespace
}  // namespace pd::test
