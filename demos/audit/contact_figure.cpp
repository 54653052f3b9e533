#include "audit/contact_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "audit/audit_answer.hpp"
#include "audit/body_extent.hpp"
#include "protocol/line/json_writer.hpp"
#include "report/html_text.hpp"

namespace pd::audit {

namespace {

/// The exact side of a figure, as words and as a way of A.
void draw_answer(const PenetrationDepth& answer, report::PairFigure& figure) {
  figure.normal = answer.normal;
  switch (answer.contact) {
    case ContactClass::overlapping:
      figure.depth = answer.depth;
      figure.exact = {answer.witness_a, answer.witness_b};
      figure.exact_words = fmt::format("depth {} in [{}, {}]", answer.depth, answer.lower, answer.upper);
      break;
    case ContactClass::touching:
      figure.exact_words = "touching, depth 0";
      break;
    case ContactClass::separated:
      figure.exact = {answer.witness_a, answer.witness_b};
      figure.exact_words =
          fmt::format("apart by {} in [{}, {}]", answer.distance, answer.distance_lower, answer.distance_upper);
      break;
  }
}

/// The part of a half-space's boundary near a body, seen from both sides.
report::EyePolytope plane_near(const Vec3& normal, const Vec3& on_plane, double radius) {
  Vec3 axis = Vec3::Zero();
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  axis[least] = 1;
  const Vec3 right = axis.cross(normal).stableNormalized() * radius;
  const Vec3 forward = normal.cross(right);
  report::EyePolytope square;
  square.points = {on_plane - right - forward, on_plane + right - forward, on_plane + right + forward,
                   on_plane - right + forward};
  square.polygons = {{0, 1, 2, 3}, {3, 2, 1, 0}};
  square.normals = {normal, -normal};
  square.edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  return square;
}

/// A body and a half-space; `body` is what is drawn of the former.
void draw_plane(const RecordedContact& contact, const std::vector<report::EyePolytope>& body,
                report::PairFigure& figure) {
  const bool a_is_plane = contact.a->halfspace.has_value();
  const PlaneContact exact = plane_contact(contact);
  const Vec3 normal = exact.normal.stableNormalized();
  const double depth = 0.5 * exact.depth.lower + 0.5 * exact.depth.upper;
  Vec3 deepest = body.front().points.front();
  Vec3 low = deepest;
  Vec3 high = deepest;
  for (const report::EyePolytope& part : body) {
    for (const Vec3& p : part.points) {
      if (p.dot(normal) < deepest.dot(normal)) deepest = p;
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const Vec3 on_plane = deepest + depth * normal;
  const Vec3 below_centre = 0.5 * (low + high);
  const Vec3 middle = below_centre + (on_plane - below_centre).dot(normal) * normal;
  (a_is_plane ? figure.a : figure.b).push_back(plane_near(normal, middle, 0.8 * (high - low).norm()));
  figure.normal = a_is_plane ? Vec3(-normal) : normal;
  const Vec3 from = a_is_plane ? on_plane : deepest;
  figure.exact = {from, from + depth * figure.normal};
  figure.exact_words = fmt::format("{} {} in [{}, {}]", depth < 0 ? "apart, depth" : "depth", depth, exact.depth.lower,
                                   exact.depth.upper);
}

void draw_report(const RecordedContact& contact, report::PairFigure& figure) {
  if (!contact.report) {
    figure.reported_words = "no contact";
    return;
  }
  const Report& report = *contact.report;
  figure.reported_words = fmt::format("{} {}", report.depth < 0 ? "apart by" : "depth", std::abs(report.depth));
  if (!report.normal) return;
  const Vec3 normal = report.normal->stableNormalized();
  const double turned = std::acos(std::clamp(normal.dot(figure.normal), -1.0, 1.0)) * 180 / 3.14159265358979;
  figure.reported_words += fmt::format(", along a normal {} degrees from the exact one", report::short_number(turned));
  Vec3 from = figure.exact ? figure.exact->from : Vec3::Zero();
  if (!report.points.empty() && report.points.front().position_a) from = *report.points.front().position_a;
  figure.reported = {from, from + report.depth * normal};
}

}  // namespace

report::PairFigure contact_figure(const WorstContact& worst, double tolerance) {
  const RecordedContact& contact = worst.contact;
  report::PairFigure figure;
  std::string column(worst.column);
  std::replace(column.begin(), column.end(), '_', ' ');
  const std::string id = query::shortened(contact.id_text, 40);
  figure.title = fmt::format("contact {}, line {}: {} {} of its size ({})", id, worst.line, column,
                             report::short_number(worst.error), kind_of(contact));
  figure.file_name = fmt::format("contact_line_{}", worst.line);
  figure.line = query_line(worst, tolerance);
  if (contact.a->body) figure.a = report::eye_polytopes(*contact.a->body, contact.pose_a);
  if (contact.b->body) figure.b = report::eye_polytopes(*contact.b->body, contact.pose_b);
  const bool plane = contact.a->halfspace || contact.b->halfspace;
  if (plane) {
    draw_plane(contact, contact.a->body ? figure.a : figure.b, figure);
  } else {
    Scratch scratch;
    const auto answer = body_depth(contact, std::min(tolerance / 10, 1.0), scratch);
    if (answer) draw_answer(*answer, figure);
    figure.p = report::eye_difference(figure.a, figure.b);
  }
  draw_report(contact, figure);
  return figure;
}

}  // namespace pd::audit
