/// @file
/// `pd_record.h`: what a program in C99 writes is read, to the bit.
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pd/record/pd_record.h"
#include "record_text.hpp"

namespace pd::test {
namespace {

using audit::Column;

class RecordHeader : public ::testing::Test, protected TemporaryFolder {
 protected:
  /// @return the file.
  std::string write_in_c() {
    const std::string file = path() / "c.jsonl";
    EXPECT_EQ(std::system(("'" RECORD_IN_C "' '" + file + "'").c_str()), 0);
    return file;
  }
};

TEST_F(RecordHeader, ARecordWrittenInCIsJudged) {
  const Audited audited = audit_file(write_in_c());
  EXPECT_EQ(audited.audit->header.engine, "an engine, written in C");
  EXPECT_EQ(audited.audit->header.unit, "mm");
  EXPECT_FALSE(audited.audit->header.single_precision);
  EXPECT_EQ(audited.audit->shapes.size(), 8U);
  ASSERT_EQ(audited.judgements.size(), 8U);
  const auto& judged = audited.judgements;
  EXPECT_NEAR(*judged[0].depth_error, 0, 1e-15);
  EXPECT_NEAR(*judged[0].normal_excess, 0, 1e-15);
  EXPECT_NEAR(*judged[0].point_error, 0, 1e-15);
  EXPECT_NEAR(*judged[1].depth_error, 0, 1e-15);
  EXPECT_NEAR(*judged[1].normal_excess, 0, 1e-15);
  EXPECT_FALSE(judged[1].missed);
  EXPECT_TRUE(judged[2].missed);
  for (const std::size_t i : {3, 4, 5}) EXPECT_NEAR(*judged[i].depth_error, 0, 1e-12) << i;
  for (const std::size_t i : {6, 7}) EXPECT_TRUE(judged[i].missed) << i;
  ASSERT_EQ(audited.audit->summary.refused(), 1);
  EXPECT_EQ(audited.audit->summary.refusals()[0].refusal.code, "non_finite");
  EXPECT_EQ(audited.audit->summary.refusals()[0].line, 18);
}

TEST_F(RecordHeader, NumbersReadBackToTheSameBits) {
  const std::string file = path() / "numbers.jsonl";
  pd_record record;
  ASSERT_TRUE(pd_record_open(&record, file.c_str(), "bits", PD_RECORD_FLOAT64, nullptr));
  const double values[9] = {0.1,  1.0 / 3, 5e-324, -1.7976931348623157e308, static_cast<double>(0.1F), -0.0,
                            1e22, 3,       1e-5};
  pd_record_convex(&record, "points", values, 3, 0);
  ASSERT_TRUE(pd_record_close(&record));
  std::istringstream lines(read("numbers.jsonl"));
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  const auto vertices = nlohmann::json::parse(line).at("is").at("vertices");
  for (int i = 0; i < 9; ++i) {
    const auto value = vertices[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)].get<double>();
    EXPECT_EQ(value, values[i]);
  }
}

// The program on the page of documentation, and its text.
TEST_F(RecordHeader, TheTwentyLinesOfThePageWork) {
  const std::string file = path() / "page.jsonl";
  ASSERT_EQ(std::system(("'" RECORDER_OF_THE_PAGE "' '" + file + "'").c_str()), 0);
  const Audited audited = audit_file(file);
  EXPECT_EQ(audited.total().judged, 60);
  EXPECT_EQ(audited.total().missed + audited.total().phantom + audited.audit->summary.refused(), 0);
  EXPECT_LE(audited.max(Column::depth_error), 1e-12);
  const auto text_of = [](const std::string& name) {
    std::stringstream text;
    text << std::ifstream(std::string(PROJECT_SOURCE_DIR) + name).rdbuf();
    return text.str();
  };
  const std::string program = text_of("/tests/audit/recorder_in_twenty_lines.c");
  ASSERT_GT(program.size(), 500U);
  EXPECT_NE(text_of("/demos/audit/README.md").find("```c\n" + program + "```"), std::string::npos);
}

TEST_F(RecordHeader, SaysWhenNothingCanBeWritten) {
  pd_record record;
  EXPECT_FALSE(pd_record_open(&record, (path() / "no" / "x").c_str(), "e", PD_RECORD_FLOAT32, nullptr));
  pd_record_sphere(&record, "ball", 1);
  pd_record_contact(&record, "ball", nullptr, "ball", nullptr, nullptr);
  EXPECT_FALSE(pd_record_close(&record));
  ASSERT_TRUE(pd_record_open(&record, "/dev/full", "e", PD_RECORD_FLOAT32, nullptr));
  for (int i = 0; i < 10000; ++i) pd_record_contact(&record, "ball", nullptr, "ball", nullptr, nullptr);
  EXPECT_FALSE(pd_record_close(&record)) << "a full disk";
}

}  // namespace
}  // namespace pd::test
