#include "support/report_parts.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "audit/audit_stream.hpp"
#include "audit/contact_figure.hpp"
#include "protocol/line/json_writer.hpp"
#include "report/html_text.hpp"
#include "report/page.hpp"

namespace pd::demo {

namespace {

constexpr std::size_t kWorstDrawn = 2;

void write_body(std::string_view key, const PosedShape& body, query::JsonWriter& json) {
  const ConvexPolytope& polytope = *body.shape->polytope();
  json.key(key).begin_object().key("type").string("convex").key("vertices").begin_array();
  for (int v = 0; v < polytope.num_vertices(); ++v) json.vector(polytope.vertex(v));
  json.end_array();
  if (body.shape->margin() > 0) json.key("margin").number(body.shape->margin());
  json.end_object();
  json.key("pose_" + std::string(key)).begin_object().key("translation").vector(body.pose.translation());
  json.key("rotation_row_major").begin_array();
  for (int i = 0; i < 9; ++i) json.number(body.pose.rotation()(i / 3, i % 3));
  json.end_array().end_object();
}

std::string line_of(const PosedShape& a, const PosedShape& b) {
  if (a.shape->polytope() == nullptr || b.shape->polytope() == nullptr) return {};
  std::string text;
  query::JsonWriter json(text);
  json.begin_object().key("id").integer(1).key("query").string("depth");
  write_body("a", a, json);
  write_body("b", b, json);
  json.end_object();
  return text;
}

std::vector<std::string> audit_row(const std::string& contender, const audit::Totals& total) {
  const auto largest = [&](audit::Column column) {
    const audit::ErrorQuantiles& errors = total.of(column);
    return errors.count() > 0 ? report::short_number(errors.max()) : std::string("-");
  };
  return {report::escaped(contender),
          fmt::format("{}", total.judged),
          fmt::format("{}", total.missed),
          fmt::format("{}", total.phantom),
          fmt::format("{}", total.unanswered),
          largest(audit::Column::depth_error),
          largest(audit::Column::normal_excess),
          largest(audit::Column::point_error)};
}

/// False where the record cannot be read.
bool audit_file(const std::filesystem::path& file, audit::Audit& result) {
  const int input = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (input < 0) return false;
  audit::AuditSettings settings;
  settings.worst_kept = kWorstDrawn;
  settings.limits.files = false;
  audit::audit_record(input, settings, {}, result);
  ::close(input);
  return result.end == audit::Audit::End::read && result.summary.refused() == 0;
}

}  // namespace

std::string page_file(const DemoOptions& options, const std::filesystem::path& file) {
  return (options.page_folder / file).generic_string();
}

report::PairFigure answered_pair(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                 const std::string& title, const std::string& file_name) {
  report::PairFigure figure;
  figure.title = title;
  figure.file_name = file_name;
  figure.a = report::eye_polytopes(*a.shape, a.pose);
  figure.b = report::eye_polytopes(*b.shape, b.pose);
  figure.p = report::eye_difference(figure.a, figure.b);
  figure.normal = answer.normal;
  if (answer.contact != ContactClass::touching) figure.exact = {answer.witness_a, answer.witness_b};
  figure.depth = answer.depth;
  figure.exact_words =
      answer.contact == ContactClass::separated
          ? fmt::format("apart by {} in [{}, {}]", answer.distance, answer.distance_lower, answer.distance_upper)
          : fmt::format("depth {} in [{}, {}]", answer.depth, answer.lower, answer.upper);
  figure.line = line_of(a, b);
  return figure;
}

std::string audited_records(const DemoOptions& options, const std::vector<RecordOfRun>& records) {
  std::vector<std::vector<std::string>> rows{{"contacts by", "judged", "missed", "phantom", "no answer",
                                              "depth error, max", "normal excess, max", "points off, max"}};
  std::string drawn;
  fmt::print("  {:<46} {:>8} {:>7} {:>8} {:>10} {:>10}\n", "contacts recorded and audited", "judged", "missed",
             "phantom", "depth err", "normal");
  for (const RecordOfRun& record : records) {
    audit::Audit result;
    if (!audit_file(record.file, result)) {
      rows.push_back({report::escaped(record.contender), "the record cannot be read"});
      continue;
    }
    const audit::Totals& total = result.summary.total();
    rows.push_back(audit_row(record.contender, total));
    fmt::print("  {:<46} {:>8} {:>7} {:>8} {:>10} {:>10}\n", record.contender, total.judged, total.missed,
               total.phantom, rows.back()[5], rows.back()[6]);
    std::vector<std::string> figures;
    for (const audit::WorstContact& worst : result.summary.worst()) {
      if (worst.error <= result.tolerance) continue;
      auto figure = audit::contact_figure(worst, result.tolerance);
      figure.file_name = record.file.stem().string() + "_" + figure.file_name;
      figures.push_back(report::pair_figure(figure));
    }
    if (figures.empty()) continue;
    drawn += fmt::format("<h3>The worst contacts of: {}</h3>\n", report::escaped(record.contender));
    drawn += report::pairs(figures);
  }
  std::string text =
      "<h3>Contacts against the exact answer</h3>\n<p class=\"quiet\">Every contact of both worlds was "
      "recorded and judged on its own numbers; errors relative to a pair's size.</p>\n";
  text += report::table(rows) + "<p class=\"quiet\">The records:";
  for (const RecordOfRun& record : records) {
    const std::string file = page_file(options, record.file.filename());
    text += fmt::format(" <a href=\"{0}\">{0}</a>", report::escaped(file));
  }
  return text + "; <code>pdepth audit</code> judges them.</p>\n" + drawn;
}

}  // namespace pd::demo
