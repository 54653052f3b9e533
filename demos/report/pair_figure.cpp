#include "report/pair_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/html_text.hpp"
#include "report/pair_drawing.hpp"

namespace pd::report {

namespace {

/// Ways are cut off there, in units of half the picture: engines report depths of any size.
constexpr double kLongestWay = 3;

/// A rotation whose third row is the normal.
Mat3 upright(const Vec3& normal) {
  Vec3 axis = Vec3::Zero();
  Eigen::Index least = 0;
  normal.cwiseAbs().minCoeff(&least);
  axis[least] = 1;
  const Vec3 right = axis.cross(normal).stableNormalized();
  Mat3 frame;
  frame.row(0) = right;
  frame.row(1) = normal.cross(right);
  frame.row(2) = normal;
  return frame;
}

/// Brings what is drawn into the cube [-1, 1]^3.
struct Placement {
  Mat3 frame;
  Vec3 centre = Vec3::Zero();
  double scale = 1;

  /// Requires points.
  Placement(const Mat3& turned, const std::vector<DrawnBody>& bodies) : frame(turned) {
    Vec3 low = Vec3::Constant(1e308);
    Vec3 high = -low;
    for (const DrawnBody& body : bodies) {
      for (const Vec3& p : body.shape.points) {
        low = low.cwiseMin(frame * p);
        high = high.cwiseMax(frame * p);
      }
    }
    centre = 0.5 * low + 0.5 * high;
    const double half = (0.5 * high - 0.5 * low).stableNorm();
    scale = half > 0 ? half : 1;
  }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return (frame * p - centre) / scale; }
};

PairView placed(const Mat3& frame, std::vector<DrawnBody> bodies, std::vector<DrawnWay> ways,
                std::optional<double> radius) {
  PairView view;
  const Placement place(frame, bodies);
  for (DrawnBody& body : bodies) {
    for (Vec3& p : body.shape.points) p = place(p);
    for (Vec3& n : body.shape.normals) n = frame * n;
  }
  for (DrawnWay& way : ways) {
    way.from = place(way.from);
    way.to = place(way.to);
    const Vec3 along = way.to - way.from;
    if (along.stableNorm() > kLongestWay) way.to = way.from + kLongestWay * along.stableNormalized();
  }
  view.bodies = std::move(bodies);
  view.ways = std::move(ways);
  if (radius) view.ball = DrawnBall{place(Vec3::Zero()), *radius / place.scale};
  return view;
}

void add(std::vector<DrawnBody>& bodies, const std::vector<EyePolytope>& shapes, BodyRole role) {
  for (const EyePolytope& shape : shapes) bodies.push_back({shape, role});
}

std::vector<PairView> views_of(const PairFigure& pair) {
  const Mat3 frame = upright(pair.normal);
  std::vector<DrawnBody> bodies;
  add(bodies, pair.a, BodyRole::a);
  add(bodies, pair.b, BodyRole::b);
  std::vector<DrawnWay> ways;
  if (pair.reported) ways.push_back({pair.reported->from, pair.reported->to, true});
  if (pair.exact) ways.push_back({pair.exact->from, pair.exact->to, false});
  std::vector<PairView> views{placed(frame, std::move(bodies), ways, std::nullopt)};
  if (pair.p.empty()) return views;
  std::vector<DrawnBody> difference;
  add(difference, pair.p, BodyRole::difference);
  for (DrawnWay& way : ways) way = {Vec3::Zero(), way.to - way.from, way.reported};
  views.push_back(placed(frame, std::move(difference), std::move(ways), pair.depth));
  return views;
}

/// For a link that hands the line over as a file.
std::string percent_encoded(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-_.~").find(c) != std::string_view::npos;
    if (plain) {
      result += c;
    } else {
      result += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return result;
}

std::string caption(const PairFigure& pair) {
  std::string text = fmt::format("<figcaption><h3>{}</h3>\n<p><span class=\"key exact\"></span>exact: {}</p>\n",
                                 escaped(pair.title), escaped(pair.exact_words));
  if (!pair.reported_words.empty()) {
    text += fmt::format("<p><span class=\"key reported\"></span>reported: {}</p>\n", escaped(pair.reported_words));
  }
  if (!pair.line.empty()) {
    text += fmt::format(
        "<p><a download=\"{0}.jsonl\" href=\"data:application/jsonl,{1}%0A\">{0}.jsonl</a> holds the pair: "
        "<code>pdepth query {0}.jsonl</code> answers it again.</p>\n<details><summary>The line to "
        "paste</summary><pre>{2}</pre></details>\n",
        escaped(pair.file_name), percent_encoded(pair.line), escaped(pair.line));
  }
  return text + "</figcaption>\n";
}

}  // namespace

std::string pair_figure(const PairFigure& pair) {
  const std::vector<PairView> views = views_of(pair);
  std::string text = "<figure class=\"pair\">\n<div class=\"views\">\n";
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string_view what =
        i == 0 ? "A (blue) and B (amber) where they stand" : "P = B + (-A) about the origin O";
    fmt::format_to(out, "<div class=\"view\">{}<p class=\"quiet\">{}</p></div>\n",
                   drawing_of(views[i], fmt::format("{}: {}", pair.title, what)), what);
  }
  fmt::format_to(out,
                 "</div>\n<button type=\"button\" class=\"turn\" hidden=\"hidden\">Turn in space</button>\n{}<script "
                 "type=\"application/json\">{}</script>\n</figure>\n",
                 caption(pair), script_json(json_of(views)));
  return text;
}

}  // namespace pd::report
