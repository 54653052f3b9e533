#include "audit/record_reader.hpp"

#include <utility>

#include "protocol/line/json_writer.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::audit {

namespace {

constexpr std::string_view kVersion = "pdepth-contacts/1";

Report read_report(const query::Node& node) {
  query::require_object(node);
  query::allow_only(node, {"depth", "normal", "points"});
  Report report;
  report.depth = query::read_number(node.at("depth"));
  if (const auto normal = node.find("normal")) {
    report.normal = query::read_vector(*normal);
    if (report.normal->isZero(0)) normal->refuse("zero_direction", "a normal needs a length other than zero");
  }
  if (const auto points = node.find("points")) {
    query::require_array(*points, "an array of contact points");
    for (std::size_t i = 0; i < points->size(); ++i) {
      const query::Node point = points->element(i);
      query::require_object(point);
      query::allow_only(point, {"position_a", "position_b", "depth"});
      Report::Point positions;
      if (const auto a = point.find("position_a")) positions.position_a = query::read_vector(*a);
      if (const auto b = point.find("position_b")) positions.position_b = query::read_vector(*b);
      if (const auto depth = point.find("depth")) (void)query::read_number(*depth);
      report.points.push_back(positions);
    }
  }
  return report;
}

/// Reads over the text of valid JSON, a token's worth at a time.
class JsonScanner {
 public:
  explicit JsonScanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] char peek() const { return text_[at_]; }
  void skip_blanks_and(char separator) {
    while (!at_end() && (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == separator)) ++at_;
  }

  /// The value that begins here.
  std::string_view value() {
    const std::size_t begin = at_;
    int depth = 0;
    bool in_string = false;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (in_string) {
        if (c == '\\') ++at_;
        if (c == '"') in_string = false;
      } else if (c == '"') {
        in_string = true;
      } else if (c == '{' || c == '[') {
        ++depth;
      } else if (c == '}' || c == ']') {
        if (depth == 0) break;
        --depth;
      } else if ((c == ',' || c == ':' || c == ' ' || c == '\t' || c == '\r') && depth == 0) {
        break;
      }
    }
    return text_.substr(begin, at_ - begin);
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string_view member_text(std::string_view line, std::string_view key) {
  JsonScanner scanner(line);
  scanner.skip_blanks_and('{');
  while (!scanner.at_end() && scanner.peek() == '"') {
    const std::string_view name = scanner.value();
    scanner.skip_blanks_and(':');
    const std::string_view value = scanner.value();
    if (name.size() == key.size() + 2 && name.substr(1, key.size()) == key) return value;
    scanner.skip_blanks_and(',');
  }
  return {};
}

RecordedShape read_shape_line(const query::Node& line, std::string_view text, std::int64_t line_number,
                              const query::Limits& limits) {
  query::allow_only(line, {"shape", "is"});
  (void)query::read_string(line.at("shape"));
  RecordedShape shape = read_recorded_shape(line.at("is"), limits);
  shape.line = line_number;
  shape.text = member_text(text, "is");
  return shape;
}

void ShapeTable::define(const query::Node& line, RecordedShape shape) {
  const query::Node id_node = line.at("shape");
  const std::string id = query::read_string(id_node);
  if (const auto taken = shapes_.find(id); taken != shapes_.end()) {
    id_node.refuse("bad_value", "the shape \"" + query::shortened(id) + "\" is defined on line " +
                                    std::to_string(taken->second.line) + " already");
  }
  shapes_.emplace(id, std::move(shape));
}

const RecordedShape& ShapeTable::named(const query::Node& node, std::int64_t line_number) const {
  const std::string id = query::read_string(node);
  const auto found = shapes_.find(id);
  if (found == shapes_.end() || found->second.line >= line_number) {
    node.refuse("bad_value", "no shape \"" + query::shortened(id) + "\" is defined before this line");
  }
  return found->second;
}

RecordHeader read_header(const query::Node& line) {
  const query::Node version = line.at("record");
  if (query::read_string(version) != kVersion) {
    version.refuse("unsupported", "this reads records of the version \"" + std::string(kVersion) + "\"");
  }
  query::allow_only(line, {"record", "engine", "scalar", "unit", "note"});
  RecordHeader header;
  header.engine = query::read_string(line.at("engine"));
  const query::Node scalar = line.at("scalar");
  const std::string word = query::read_string(scalar);
  if (word != "float32" && word != "float64") scalar.refuse("bad_value", "must be \"float32\" or \"float64\"");
  header.single_precision = word == "float32";
  const auto unit = line.find("unit");
  header.unit = unit ? query::read_string(*unit) : "m";
  return header;
}

RecordedContact read_contact(const query::Node& line, std::string_view text, std::int64_t line_number,
                             const ShapeTable& shapes) {
  query::allow_only(line, {"contact", "time", "a", "pose_a", "b", "pose_b", "reported"});
  RecordedContact contact;
  contact.id_text = member_text(text, "contact");
  if (const auto time = line.find("time")) (void)query::read_number(*time);
  contact.a = &shapes.named(line.at("a"), line_number);
  contact.b = &shapes.named(line.at("b"), line_number);
  contact.pose_a = query::read_optional_pose(line, "pose_a");
  contact.pose_b = query::read_optional_pose(line, "pose_b");
  const query::Node reported = line.at("reported");
  if (!reported.json().is_null()) contact.report = read_report(reported);
  if (contact.a->halfspace && contact.b->halfspace) {
    line.at("b").refuse("unsupported", "two half-spaces have no depth");
  }
  return contact;
}

}  // namespace pd::audit
