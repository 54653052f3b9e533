/// @file
/// The quick reader of JSON: the events of the library's parser, or a text declined; never something else.
#include "protocol/quick_json.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace pd::test {
namespace {

using Json = nlohmann::json;
using query::QuickJson;
using query::read_json_quickly;

/// Writes down what it is told; says no at the event `stop`.
class Events final : public nlohmann::json_sax<Json> {
 public:
  explicit Events(int stop = -1) : stop_(stop) {}
  bool null() override { return add("null"); }
  bool boolean(bool value) override { return add(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override { return add("i" + std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add("u" + std::to_string(value)); }
  bool number_float(number_float_t value, const string_t& text) override {
    return add("d" + std::to_string(std::bit_cast<std::uint64_t>(value)) + " " + text);
  }
  bool string(string_t& value) override { return add("s" + value); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return add("{"); }
  bool key(string_t& value) override { return add("k" + value); }
  bool end_object() override { return add("}"); }
  bool start_array(std::size_t /*size*/) override { return add("["); }
  bool end_array() override { return add("]"); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

  std::vector<std::string> told;

 private:
  bool add(std::string event) {
    told.push_back(std::move(event));
    return static_cast<int>(told.size()) != stop_;
  }
  int stop_;
};

QuickJson expect_the_same(const std::string& text) {
  Events quick, whole;
  const QuickJson outcome = read_json_quickly(text, quick);
  const bool is_json = Json::sax_parse(text.begin(), text.end(), &whole);
  EXPECT_NE(outcome, QuickJson::stopped) << text;
  if (outcome == QuickJson::done) {
    EXPECT_TRUE(is_json) << text;
    EXPECT_EQ(quick.told, whole.told) << text;
  }
  return outcome;
}

constexpr const char* kLine =
    R"({"contact":12,"time":0.5,"a":"h0","pose_a":{"translation":[0,-0,-3],"quaternion_wxyz":[0.009244448184159738,)"
    R"(-4.339e-02,0.7437756271088144E+0,1]} , "b":"h1","reported":{"depth":-0.131363324,"normal":[ 0.58 ,0.6,1e-5],)"
    R"("points":[]},"x":{},"y":[true,false,null,"",18446744073709551615,-9223372036854775808,4.9e-324]} )";

TEST(QuickJson, ReadsOrdinaryLines) {
  EXPECT_EQ(expect_the_same(kLine), QuickJson::done);
  for (const char* text : {"{}", "[]", " [ ] ", "7", "-0.0", "\"a b\"", "[1,[2,[3]],{\"k\":{}}]", "{ \"a\" : 1 }"}) {
    EXPECT_EQ(expect_the_same(text), QuickJson::done) << text;
  }
}

TEST(QuickJson, DeclinesWhatNeedsCare) {
  for (const char* text : {"",
                           " ",
                           "[",
                           "[1",
                           "[1,",
                           "[1,]",
                           "[,]",
                           "{\"a\"}",
                           "{\"a\":}",
                           "{\"a\":1,}",
                           "{a:1}",
                           "01",
                           "-",
                           "1.",
                           ".5",
                           "+1",
                           "1e",
                           "1e+",
                           "--1",
                           "tru",
                           "nulls",
                           "1 2",
                           "[1]]",
                           "\"a",
                           "\"a\\n\"",
                           "\"\t\"",
                           "\"\xC3\xA9\"",
                           "\"\xFF\"",
                           "18446744073709551616",
                           "-9223372036854775809",
                           "1e999",
                           "-1e999",
                           "1e-999",
                           "NaN",
                           "[1}",
                           "{\"a\":1]"}) {
    EXPECT_EQ(expect_the_same(text), QuickJson::declined) << text;
  }
}

TEST(QuickJson, SpoiltLinesAreReadAlikeOrDeclined) {
  std::mt19937_64 random(16);
  const std::string letters = "{}[]\",:.-+eE0123456789tfn \t\\/ax";
  int read = 0, declined = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text = kLine;
    for (int change = 0; change <= i % 3; ++change) {
      const std::size_t place = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[place] = letters[random() % letters.size()];
          break;
        case 1:
          text.erase(place, 1 + random() % 3);
          break;
        default:
          text.insert(place, 1, letters[random() % letters.size()]);
      }
    }
    ++(expect_the_same(text) == QuickJson::done ? read : declined);
    if (HasFailure()) return;
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(declined, 1000);
}

TEST(QuickJson, DoublesAreTheNearest) {
  std::mt19937_64 random(17);
  for (int i = 0; i < 50'000; ++i) {
    std::string text = std::to_string(random() % 1000) + "." + std::to_string(random());
    if (i % 2 == 0) text += "e" + std::to_string(static_cast<int>(random() % 640) - 320);
    expect_the_same(text);
    if (HasFailure()) return;
  }
}

TEST(QuickJson, StopsWhereTheHandlerSays) {
  Events whole;
  ASSERT_EQ(read_json_quickly(kLine, whole), QuickJson::done);
  const int count = static_cast<int>(whole.told.size());
  for (int stop = 1; stop <= count; ++stop) {
    Events events(stop);
    EXPECT_EQ(read_json_quickly(kLine, events), QuickJson::stopped);
    EXPECT_EQ(static_cast<int>(events.told.size()), stop);
  }
}

}  // namespace
}  // namespace pd::test
