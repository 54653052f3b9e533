/// @file
/// The JSON answer of an audit, and the line that asks again.
#include <algorithm>
#include <limits>

#include "audit/audit_answer.hpp"
#include "audit/exact_depth.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::audit {

namespace {

using query::JsonWriter;

void write_errors(Column column, const Totals& totals, JsonWriter& json) {
  const ErrorQuantiles& errors = totals.of(column);
  json.key(to_string(column)).begin_object();
  const auto write = [&](std::string_view name, double value) {
    json.key(name);
    if (errors.count() > 0) {
      json.number(value);
    } else {
      json.null();
    }
  };
  write("p50", errors.count() > 0 ? errors.quantile(0.50) : 0);
  write("p99", errors.count() > 0 ? errors.quantile(0.99) : 0);
  write("max", errors.max());
  json.key("count").integer(errors.count());
  json.end_object();
}

void write_totals(const Totals& totals, JsonWriter& json) {
  json.key("contacts").integer(totals.contacts);
  json.key("judged").integer(totals.judged);
  json.key("missed").integer(totals.missed);
  json.key("phantom").integer(totals.phantom);
  json.key("unanswered").integer(totals.unanswered);
  for (const Column column : kColumns) write_errors(column, totals, json);
}

/// A half-space's answer: its class by the sign of the middle, its normal the way in which A leaves B.
void write_plane_answer(const RecordedContact& contact, JsonWriter& json) {
  const PlaneContact plane = plane_contact(contact);
  const SignedDepth& x = plane.depth;
  const double middle = (x.lower + x.upper) / 2;
  const bool inside = x.lower > 0;
  const bool apart = x.upper < 0;
  json.key("class").string(inside ? "overlapping" : apart ? "separated" : "touching");
  json.key("depth").number(inside ? middle : 0);
  json.key("lower").number(inside ? x.lower : 0);
  json.key("upper").number(inside ? x.upper : 0);
  json.key("distance").number(apart ? -middle : 0);
  json.key("normal").vector(contact.b->halfspace ? plane.normal.normalized() : Vec3(-plane.normal.normalized()));
}

void write_exact(const WorstContact& worst, double tolerance, JsonWriter& json) {
  json.begin_object();
  if (worst.contact.a->halfspace || worst.contact.b->halfspace) {
    write_plane_answer(worst.contact, json);
  } else {
    Scratch scratch;
    const auto answer = body_depth(worst.contact, std::min(tolerance / 10, 1.0), scratch);
    if (answer) query::write_depth_fields(*answer, json);
  }
  json.end_object();
}

void write_worst(const Audit& audit, JsonWriter& json) {
  json.key("worst").begin_array();
  for (const WorstContact& worst : audit.summary.worst()) {
    json.begin_object();
    json.key("contact").raw(worst.contact.id_text);
    json.key("line").integer(worst.line);
    json.key("kind").string(kind_of(worst.contact));
    json.key("error").number(worst.error);
    json.key("column").string(worst.column);
    json.key("exact");
    write_exact(worst, audit.tolerance, json);
    json.key("reported").raw(member_text(worst.text, "reported"));
    if (const std::string line = query_line(worst, audit.tolerance); !line.empty()) json.key("query").raw(line);
    json.end_object();
  }
  json.end_array();
}

}  // namespace

std::string audit_json(const Audit& audit, const std::vector<ConditionOutcome>& conditions) {
  std::string text;
  JsonWriter json(text);
  json.begin_object();
  json.key("engine").string(audit.header.engine);
  json.key("scalar").string(audit.header.single_precision ? "float32" : "float64");
  json.key("unit").string(audit.header.unit);
  json.key("tolerance").number(audit.tolerance);
  write_totals(audit.summary.total(), json);
  json.key("refused_lines").integer(audit.summary.refused());
  json.key("by_kind").begin_array();
  for (const auto& [kind, totals] : audit.summary.by_kind()) {
    json.begin_object().key("kind").string(kind);
    write_totals(totals, json);
    json.end_object();
  }
  json.end_array();
  write_worst(audit, json);
  json.key("errors").begin_array();
  for (const RefusedLine& refused : audit.summary.refusals()) {
    json.begin_object().key("line").integer(refused.line);
    json.key("code").string(refused.refusal.code);
    json.key("message").string(refused.refusal.message);
    json.key("where").string(refused.refusal.where);
    json.end_object();
  }
  json.end_array();
  json.key("fail_on").begin_array();
  for (const ConditionOutcome& outcome : conditions) {
    json.begin_object().key("name").string(outcome.condition.name);
    json.key("limit").number(outcome.condition.limit);
    json.key("found").number(outcome.found);
    json.key("holds").boolean(outcome.holds);
    json.end_object();
  }
  json.end_array().end_object();
  return text;
}

SignedDepth worst_interval(const WorstContact& worst, double tolerance) {
  Scratch scratch;
  const double scale = contact_scale(worst.contact);
  return signed_depth(worst.contact, tolerance, scale > 0 ? scale : 1, scratch).value_or(SignedDepth());
}

std::string query_line(const WorstContact& worst, double tolerance) {
  const RecordedContact& contact = worst.contact;
  if (contact.a->halfspace || contact.b->halfspace) return {};
  std::string text;
  JsonWriter json(text);
  json.begin_object().key("id").raw(contact.id_text).key("query").string("depth");
  const auto write_side = [&](std::string_view name, std::string_view pose_name, const RecordedShape& shape) {
    json.key(name).raw(shape.text);
    const std::string_view pose = member_text(worst.text, pose_name);
    if (!pose.empty()) json.key(pose_name).raw(pose);
  };
  write_side("a", "pose_a", *contact.a);
  write_side("b", "pose_b", *contact.b);
  const bool is_union = contact.a->is_union || contact.b->is_union;
  json.key("delta").number(std::min(1.0, std::max(tolerance / 10, is_union ? kFinestUnionDelta : 0)));
  json.end_object();
  return text;
}

}  // namespace pd::audit
