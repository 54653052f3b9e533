#include "protocol/search_file.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "files/regular_file.hpp"

namespace pd::query {

namespace {

constexpr std::string_view kArithmetics[] = {"double", "exact hull", "exact"};
constexpr std::string_view kOutcomes[] = {"certified", "separated", "touching", "undecided", "over budget"};

/// JSON has no infinity.
void write_bound(JsonWriter& writer, double value) {
  if (std::isfinite(value)) {
    writer.number(value);
  } else {
    writer.null();
  }
}

void write_points(JsonWriter& writer, const std::vector<Vec3>& points) {
  writer.begin_array();
  for (const Vec3& x : points) writer.vector(x);
  writer.end_array();
}

void write_body(JsonWriter& writer, std::string_view key, const ConvexPolytope& body, const Pose& pose) {
  std::vector<Vec3> vertices;
  for (int v = 0; v < body.num_vertices(); ++v) vertices.push_back(body.vertex(v));
  writer.key(key).begin_object();
  writer.key("type").string("convex");
  write_points(writer.key("vertices"), vertices);
  writer.end_object();
  writer.key("pose_" + std::string(key)).begin_object();
  writer.key("translation").vector(pose.translation());
  writer.key("rotation_row_major").begin_array();
  for (int i = 0; i < 9; ++i) writer.number(pose.rotation()(i / 3, i % 3));
  writer.end_array();
  writer.end_object();
}

double read_bound(const Node& node, double infinite) { return node.json().is_null() ? infinite : read_number(node); }

std::string_view read_word(const Node& node, std::span<const std::string_view> words) {
  const std::string text = read_string(node);
  for (const std::string_view word : words) {
    if (text == word) return word;
  }
  node.refuse("bad_value", "\"" + shortened(text) + "\" is no word of a trace");
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SearchStep read_step(const Node& line, const Limits& limits) {
  allow_only(
      line, {"step", "arithmetic", "lower", "upper", "nearest", "normal", "support", "vertices", "faces", "distances"});
  SearchStep step;
  step.number = static_cast<int>(read_integer(line.at("step"), 0, std::numeric_limits<int>::max()));
  step.arithmetic = read_word(line.at("arithmetic"), kArithmetics);
  step.lower = read_bound(line.at("lower"), -kInfinity);
  step.upper = read_bound(line.at("upper"), kInfinity);
  step.normal = read_vector(line.at("normal"));
  step.support = read_vector(line.at("support"));
  step.vertices = read_points(line.at("vertices"), limits.max_vertices);
  const Node faces = line.at("faces");
  const Node distances = line.at("distances");
  require_array(faces, "faces");
  require_array(distances, "distances");
  if (faces.size() != distances.size()) distances.refuse("bad_value", "there must be a distance for every face");
  const auto last = static_cast<std::int64_t>(step.vertices.size()) - 1;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Node face = faces.element(f);
    require_array(face, "three vertices");
    if (face.size() != 3) face.refuse("bad_value", "a face has three vertices");
    std::array<std::int32_t, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = static_cast<std::int32_t>(read_integer(face.element(i), 0, last));
    }
    step.faces.push_back(corners);
    step.distances.push_back(read_bound(distances.element(f), -kInfinity));
  }
  step.nearest =
      static_cast<int>(read_integer(line.at("nearest"), 0, static_cast<std::int64_t>(step.faces.size()) - 1));
  return step;
}

SearchEnd read_end(const Node& line) {
  allow_only(line, {"end", "arithmetic", "lower", "upper", "normal"});
  return {read_word(line.at("arithmetic"), kArithmetics), read_word(line.at("end"), kOutcomes),
          read_bound(line.at("lower"), -kInfinity), read_bound(line.at("upper"), kInfinity),
          read_vector(line.at("normal"))};
}

}  // namespace

SearchRecorder::SearchRecorder(const Pair& pair, std::string_view method) {
  JsonWriter writer(lines_);
  writer.begin_object();
  writer.key("query").string("depth");
  writer.key("method").string(method);
  write_body(writer, "a", *pair.a.shape.polytope(), pair.pose_a);
  write_body(writer, "b", *pair.b.shape.polytope(), pair.pose_b);
  writer.end_object();
  lines_ += '\n';
}

void SearchRecorder::on_step(const SearchStep& step) {
  ++steps_;
  JsonWriter writer(lines_);
  writer.begin_object();
  writer.key("step").integer(step.number);
  writer.key("arithmetic").string(step.arithmetic);
  write_bound(writer.key("lower"), step.lower);
  write_bound(writer.key("upper"), step.upper);
  writer.key("nearest").integer(step.nearest);
  writer.key("normal").vector(step.normal);
  writer.key("support").vector(step.support);
  write_points(writer.key("vertices"), step.vertices);
  writer.key("faces").begin_array();
  for (const auto& face : step.faces) {
    writer.begin_array();
    for (const std::int32_t v : face) writer.integer(v);
    writer.end_array();
  }
  writer.end_array();
  writer.key("distances").begin_array();
  for (const double d : step.distances) write_bound(writer, d);
  writer.end_array();
  writer.end_object();
  lines_ += '\n';
}

void SearchRecorder::on_end(const SearchEnd& end) {
  JsonWriter writer(lines_);
  writer.begin_object();
  writer.key("end").string(end.outcome);
  writer.key("arithmetic").string(end.arithmetic);
  write_bound(writer.key("lower"), end.lower);
  write_bound(writer.key("upper"), end.upper);
  writer.key("normal").vector(end.normal);
  writer.end_object();
  lines_ += '\n';
}

void SearchRecorder::add_answer(const PenetrationDepth& answer, const Pair& pair, std::int64_t nanoseconds) {
  JsonWriter writer(lines_);
  writer.begin_object();
  writer.key("answer").begin_object();
  write_depth_answer(answer, pair.a, pair.b, nanoseconds, writer);
  writer.end_object();
  writer.end_object();
  lines_ += '\n';
}

SearchFile read_search_file(const std::filesystem::path& path) {
  std::istringstream file;
  try {
    file.str(RegularFile::open(path.string(), kMaxMeshBytes).read_all());
  } catch (const Refusal& refusal) {
    refuse(refusal.code, path.string() + ": " + refusal.message, "");
  }
  const Limits limits{.max_vertices = 50'000'000};
  std::optional<SearchFile> out;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (is_blank(text)) continue;
    try {
      const ParsedLine parsed = parse_line(text);
      if (parsed.refusal) throw Refusal(*parsed.refusal);
      const Node line(parsed.object);
      if (!out) {
        out.emplace(SearchFile{read_pair(line, limits), {}, {}});
        if (out->pair.a.shape.polytope() == nullptr || out->pair.b.shape.polytope() == nullptr) {
          line.refuse("unsupported", "a trace is drawn for two polytopes");
        }
      } else if (line.find("step")) {
        out->steps.push_back(read_step(line, limits));
      } else if (line.find("end")) {
        out->ends.push_back(read_end(line));
      } else if (!line.find("answer")) {
        line.refuse("bad_value", "a line of a trace has \"step\", \"end\" or \"answer\"");
      }
    } catch (const Refusal& refusal) {
      refuse(refusal.code, path.string() + ", line " + std::to_string(number) + ": " + refusal.message, refusal.where);
    }
  }
  if (!out) refuse("bad_value", path.string() + " is empty: no trace", "");
  return std::move(*out);
}

}  // namespace pd::query
