/// @file
/// The reader of JSON against nlohmann's parser: the same verdict and the same events, on whole and on spoilt text.
#include "protocol/line/json_reader.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace pd::test {
namespace {

using Json = nlohmann::json;
using query::JsonEnd;

/// Writes down what it is told, by either reader; says no at the event `stop`.
class Events final : public nlohmann::json_sax<Json> {
 public:
  explicit Events(int stop = -1) : stop_(stop) {}
  bool null() override { return add("null"); }
  bool boolean(bool value) override { return add(value ? "true" : "false"); }
  bool number_integer(number_integer_t value) override { return add("i" + std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add("u" + std::to_string(value)); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return number_float(value); }
  static bool takes_any_number() { return false; }
  bool number_float(double value) { return add("d" + std::to_string(std::bit_cast<std::uint64_t>(value))); }
  bool string(string_t& value) override { return add("s" + value); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return start_object(); }
  bool start_object() { return add("{"); }
  bool key(string_t& value) override { return add("k" + value); }
  bool member(std::string_view text) {
    members.emplace_back(text);
    return true;
  }
  bool end_object() override { return add("}"); }
  bool start_array(std::size_t /*size*/) override { return start_array(); }
  bool start_array() { return add("["); }
  bool end_array() override { return add("]"); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

  std::vector<std::string> told;
  std::vector<std::string> members;  ///< texts of members' values, which nlohmann's parser does not tell

 private:
  bool add(std::string event) {
    told.push_back(std::move(event));
    return static_cast<int>(told.size()) != stop_;
  }
  int stop_;
};

JsonEnd read_json(const std::string& text, Events& events) { return query::JsonReader<Events>(text, events).read(); }

/// @return whether the text is JSON
bool expect_the_same(const std::string& text) {
  Events own, other;
  const JsonEnd end = read_json(text, own);
  const bool is_json = Json::sax_parse(text.begin(), text.end(), &other);
  EXPECT_EQ(end, is_json ? JsonEnd::done : JsonEnd::broken) << text;
  if (is_json) {
    EXPECT_EQ(own.told, other.told) << text;
  }
  return is_json;
}

constexpr const char* kLine =
    R"({"contact":12,"time":0.5,"a":"h0","pose_a":{"translation":[0,-0,-3],"quaternion_wxyz":[0.009244448184159738,)"
    R"(-4.339e-02,0.7437756271088144E+0,1]} , "b":"h1","reported":{"depth":-0.131363324,"normal":[ 0.58 ,0.6,1e-5],)"
    R"("points":[]},"x":{},"y":[true,false,null,"",18446744073709551615,-9223372036854775808,4.9e-324]} )";

TEST(JsonReader, ReadsWhatIsJson) {
  EXPECT_TRUE(expect_the_same(kLine));
  for (const char* text : {"{}",
                           "[]",
                           " [ ] ",
                           "7",
                           "-0.0",
                           "-0",
                           "\"a b\"",
                           "[1,[2,[3]],{\"k\":{}}]",
                           "{ \"a\" : 1 }",
                           R"("\"\\\/\b\f\n\r\t\u0041\u00e9\u20AC\ud83d\uDE00\u0000")",
                           "\"\xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80 \x7F\"",
                           R"({"\u0069d":1})",
                           "18446744073709551616",
                           "-9223372036854775809",
                           "12345678901234567890123456789",
                           "1e-999",
                           "-1e-999",
                           "0e999999999999999999999",
                           "0.00000e400",
                           "1e-99999999999999999999",
                           "4.9e-324",
                           "2e-324"}) {
    EXPECT_TRUE(expect_the_same(text)) << text;
  }
  // Five hundred zeros on either side of the point: a number of ordinary size.
  const std::string zeros(500, '0');
  EXPECT_TRUE(expect_the_same("1" + zeros + "e-500"));
  EXPECT_TRUE(expect_the_same("0." + zeros + "1e+501"));
  EXPECT_TRUE(expect_the_same("0." + zeros + "1"));
  EXPECT_FALSE(expect_the_same("1" + zeros));
  EXPECT_FALSE(expect_the_same("0." + zeros + "1e+810"));
}

TEST(JsonReader, RefusesWhatIsNone) {
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
                           "\"\t\"",
                           "\"\xFF\"",
                           "\"\xC0\x80\"",
                           "\"\xC3\"",
                           "\"\xC3(\"",
                           "\"\xE0\x80\x80\"",
                           "\"\xED\xA0\x80\"",
                           "\"\xF0\x80\x80\x80\"",
                           "\"\xF4\x90\x80\x80\"",
                           "\"\xF5\x80\x80\x80\"",
                           "\"\x80\"",
                           "\"\\",
                           "\"\\x\"",
                           "\"\\u12\"",
                           "\"\\u12g4\"",
                           "\"\\ud800\"",
                           "\"\\ud800\\u0041\"",
                           "\"\\udc00\"",
                           "1e999",
                           "-1e999",
                           "1e99999999999999999999",
                           "NaN",
                           "[1}",
                           "{\"a\":1]"}) {
    EXPECT_FALSE(expect_the_same(text)) << text;
  }
}

TEST(JsonReader, SpoiltLinesHaveTheSameVerdict) {
  std::mt19937_64 random(16);
  const std::string letters = "{}[]\",:.-+eE0123456789tfn \t\\/axu\xC3\xA9";
  int read = 0, broken = 0;
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
    ++(expect_the_same(text) ? read : broken);
    if (HasFailure()) return;
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(broken, 1000);
}

TEST(JsonReader, DoublesAreTheNearest) {
  std::mt19937_64 random(17);
  for (int i = 0; i < 50'000; ++i) {
    std::string text = std::to_string(random() % 1000) + ".";
    text += std::to_string(random());
    if (i % 2 == 0) text += "e" + std::to_string(static_cast<int>(random() % 640) - 320);
    expect_the_same(text);
    if (HasFailure()) return;
  }
}

TEST(JsonReader, TellsMembersByteForByte) {
  Events events;
  ASSERT_EQ(read_json(R"({"a": 1.50e0 ,"b":{"c" : [1, 2 ]},"d":"\u0041"})", events), JsonEnd::done);
  EXPECT_EQ(events.members, (std::vector<std::string>{"1.50e0", "[1, 2 ]", R"({"c" : [1, 2 ]})", R"("\u0041")"}));
  // Not before it is known that the text is not cut short.
  Events cut;
  ASSERT_EQ(read_json(R"({"a":12x,"b":1})", cut), JsonEnd::broken);
  EXPECT_TRUE(cut.members.empty());
}

TEST(JsonReader, SaysWhereAndWhy) {
  const auto words = [](const std::string& text) {
    Events events;
    query::JsonReader<Events> reader(text, events);
    EXPECT_EQ(reader.read(), JsonEnd::broken) << text;
    return std::to_string(reader.error_position()) + " " + std::string(reader.error());
  };
  EXPECT_EQ(words("[1,]"), "4 a value is missing");
  EXPECT_EQ(words("[1,NaN]"), "4 NaN and Infinity are no numbers of JSON");
  EXPECT_EQ(words("[-Infinity]"), "3 NaN and Infinity are no numbers of JSON");
  EXPECT_EQ(words("{\"a\" 1}"), "6 a colon is missing behind a key");
  EXPECT_EQ(words("[1e999]"), "2 a number is past the range of doubles");
  EXPECT_EQ(words("[1] x"), "5 the text goes on behind its value");
  EXPECT_EQ(words("\"abc"), "5 a string has no end");
}

TEST(JsonReader, StopsWhereTheHandlerSays) {
  Events whole;
  ASSERT_EQ(read_json(kLine, whole), JsonEnd::done);
  const int count = static_cast<int>(whole.told.size());
  for (int stop = 1; stop <= count; ++stop) {
    Events events(stop);
    EXPECT_EQ(read_json(kLine, events), JsonEnd::stopped);
    EXPECT_EQ(static_cast<int>(events.told.size()), stop);
  }
}

}  // namespace
}  // namespace pd::test
