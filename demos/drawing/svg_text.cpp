#include "drawing/svg_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <utility>

#include "files/decimal_number.hpp"
#include "support/refusal.hpp"

namespace pd::drawing {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

constexpr std::array<std::pair<std::string_view, double>, 8> kUnits = {{
    {"", 1.0},
    {"px", 1.0},
    {"in", 96.0},
    {"cm", 96 / 2.54},
    {"mm", 96 / 25.4},
    {"Q", 96 / 101.6},
    {"pt", 96.0 / 72},
    {"pc", 16.0},
}};

/// Cosine and sine, exact at quarter turns.
Point2 turn(double degrees) {
  const double quarters = degrees / 90;
  if (quarters == std::floor(quarters) && std::abs(quarters) < 1e9) {
    constexpr std::array<Point2, 4> kQuarters = {Point2{1, 0}, Point2{0, 1}, Point2{-1, 0}, Point2{0, -1}};
    return kQuarters[static_cast<std::size_t>((static_cast<long>(quarters) % 4 + 4) % 4)];
  }
  const double radians = degrees * std::numbers::pi / 180;
  return {std::cos(radians), std::sin(radians)};
}

PlaneMap one_transform(const std::string& name, const std::vector<double>& n, const SvgScanner& scanner) {
  const auto takes = [&](bool good, const char* words) {
    if (!good) scanner.refuse(name + " takes " + words + " numbers, not " + std::to_string(n.size()));
  };
  if (name == "matrix") {
    takes(n.size() == 6, "6");
    return {n[0], n[1], n[2], n[3], n[4], n[5]};
  }
  if (name == "translate") {
    takes(n.size() == 1 || n.size() == 2, "1 or 2");
    return {1, 0, 0, 1, n[0], n.size() == 2 ? n[1] : 0};
  }
  if (name == "scale") {
    takes(n.size() == 1 || n.size() == 2, "1 or 2");
    return {n[0], 0, 0, n.size() == 2 ? n[1] : n[0], 0, 0};
  }
  if (name == "rotate") {
    takes(n.size() == 1 || n.size() == 3, "1 or 3");
    const Point2 t = turn(n[0]);
    const PlaneMap about_origin = {t[0], t[1], -t[1], t[0], 0, 0};
    if (n.size() == 1) return about_origin;
    return PlaneMap{1, 0, 0, 1, n[1], n[2]}.after(about_origin).after({1, 0, 0, 1, -n[1], -n[2]});
  }
  if (name == "skewX" || name == "skewY") {
    takes(n.size() == 1, "1");
    const Point2 t = turn(n[0]);
    if (t[0] == 0) scanner.refuse(name + " by a right angle maps the plane to a line");
    const double slope = t[1] / t[0];
    return name == "skewX" ? PlaneMap{1, 0, slope, 1, 0, 0} : PlaneMap{1, slope, 0, 1, 0, 0};
  }
  scanner.refuse("unknown function \"" + name + "\"; known: matrix, translate, scale, rotate, skewX, skewY");
}

}  // namespace

void SvgScanner::skip_blanks() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
}

void SvgScanner::skip_separator() {
  skip_blanks();
  if (peek() == ',') {
    ++at_;
    skip_blanks();
  }
}

bool SvgScanner::number_ahead() const {
  std::size_t i = at_;
  if (i < text_.size() && (text_[i] == '+' || text_[i] == '-')) ++i;
  if (i < text_.size() && text_[i] == '.') ++i;
  return i < text_.size() && is_digit(text_[i]);
}

double SvgScanner::number() {
  if (!number_ahead()) refuse("a number is missing");
  double value = 0;
  const char* const rest = query::read_decimal(text_.data() + at_, text_.data() + text_.size(), value);
  if (!std::isfinite(value)) refuse("a number lies past the range of doubles");
  at_ = static_cast<std::size_t>(rest - text_.data());
  return value;
}

bool SvgScanner::flag() {
  const char c = peek();
  if (c != '0' && c != '1') refuse("an arc's flag must be 0 or 1");
  ++at_;
  return c == '1';
}

std::string SvgScanner::word() {
  std::string word;
  while (!done() && (std::isalnum(static_cast<unsigned char>(peek())) != 0 || peek() == '%')) word += take();
  return word;
}

void SvgScanner::refuse(const std::string& message) const {
  query::refuse("bad_value", std::string(what_) + ", character " + std::to_string(at_ + 1) + ": " + message, "");
}

SvgLength parse_length(std::string_view text, std::string_view what) {
  SvgScanner scanner(text, what);
  scanner.skip_blanks();
  SvgLength length{scanner.number(), scanner.word()};
  scanner.skip_blanks();
  if (!scanner.done()) scanner.refuse("a length is a number and a unit");
  if (length.unit == "%") return length;
  for (const auto& [unit, pixels] : kUnits) {
    if (unit == length.unit) return length;
  }
  query::refuse("unsupported",
                std::string(what) + ": the unit \"" + length.unit +
                    "\" depends on what is round the drawing; use px, mm, cm, in, pt, pc, Q or none",
                "");
}

double pixels_of(std::string_view unit) {
  for (const auto& [known, pixels] : kUnits) {
    if (known == unit) return pixels;
  }
  return 1;
}

double parse_user_length(std::string_view text, std::string_view what) {
  const SvgLength length = parse_length(text, what);
  if (length.unit == "%") {
    query::refuse("unsupported", std::string(what) + ": a percentage of the page; give a length", "");
  }
  return length.value * pixels_of(length.unit);
}

PlaneMap parse_transform(std::string_view text) {
  SvgScanner scanner(text, "transform");
  PlaneMap map;
  scanner.skip_blanks();
  if (text.substr(0, text.find_last_not_of(" \t\r\n") + 1) == "none") return map;
  while (!scanner.done()) {
    const std::string name = scanner.word();
    scanner.skip_blanks();
    if (scanner.take() != '(') scanner.refuse("a function and its numbers in parentheses are expected");
    std::vector<double> numbers;
    scanner.skip_blanks();
    while (scanner.number_ahead()) {
      numbers.push_back(scanner.number());
      scanner.skip_separator();
    }
    if (scanner.take() != ')') scanner.refuse("\")\" is missing; angles are in degrees, lengths in user units");
    map = map.after(one_transform(name, numbers, scanner));
    scanner.skip_separator();
  }
  return map;
}

PlaneCurve elliptical_arc(const Point2& from, const Point2& to, Point2 radii, double degrees, bool large, bool sweep) {
  PlaneCurve arc{.from = from, .to = to};
  if (radii[0] == 0 || radii[1] == 0 || from == to) return arc;
  radii = {std::abs(radii[0]), std::abs(radii[1])};
  const Point2 axis = turn(degrees);
  // Half the chord in the frame of the axes, on the unit circle.
  const double hx = 0.5 * (from[0] - to[0]), hy = 0.5 * (from[1] - to[1]);
  double x = (axis[0] * hx + axis[1] * hy) / radii[0], y = (-axis[1] * hx + axis[0] * hy) / radii[1];
  const double reach = std::hypot(x, y);
  if (reach > 1) {
    radii = {radii[0] * reach, radii[1] * reach};
    x /= reach;
    y /= reach;
  }
  const double height = std::sqrt(std::max(0.0, (1 - x * x - y * y) / (x * x + y * y))) * (large == sweep ? -1 : 1);
  const Point2 c = {height * y, -height * x};  // the centre, seen from the chord's middle
  arc.kind = PlaneCurve::Kind::arc;
  arc.control = {Point2{radii[0] * axis[0], radii[0] * axis[1]}, Point2{-radii[1] * axis[1], radii[1] * axis[0]}};
  arc.centre = {0.5 * (from[0] + to[0]) + c[0] * arc.control[0][0] + c[1] * arc.control[1][0],
                0.5 * (from[1] + to[1]) + c[0] * arc.control[0][1] + c[1] * arc.control[1][1]};
  arc.start = std::atan2(y - c[1], x - c[0]);
  arc.sweep = std::atan2(-y - c[1], -x - c[0]) - arc.start;
  if (sweep && arc.sweep <= 0) arc.sweep += 2 * std::numbers::pi;
  if (!sweep && arc.sweep >= 0) arc.sweep -= 2 * std::numbers::pi;
  return arc;
}

}  // namespace pd::drawing
