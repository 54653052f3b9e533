/// @file
/// The small languages inside SVG's attributes: numbers, lengths, transforms, path data. All refuse by name
/// (`query::Refusal`, bad_value or unsupported), with the place in the text.
///
/// [SVG] "Scalable Vector Graphics (SVG) 2", sections 7 (coordinates, transforms), 9 (paths), appendix B.2 (arcs).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drawing/plane_curve.hpp"

namespace pd::drawing {

/// Reads a text from left to right.
class SvgScanner {
 public:
  /// `what` names the text in refusals: "path data", "transform".
  SvgScanner(std::string_view text, std::string_view what) : text_(text), what_(what) {}

  void skip_blanks();
  /// Blanks and at most one comma.
  void skip_separator();
  [[nodiscard]] bool done() const { return at_ == text_.size(); }
  [[nodiscard]] char peek() const { return done() ? '\0' : text_[at_]; }
  char take() { return done() ? '\0' : text_[at_++]; }
  /// Is the next thing a number?
  [[nodiscard]] bool number_ahead() const;
  double number();
  /// The 0 or 1 of an arc, which may stand without a blank behind it.
  bool flag();
  /// Letters, digits and '%' up to the next other character.
  std::string word();
  [[noreturn]] void refuse(const std::string& message) const;

 private:
  std::string_view text_;
  std::string_view what_;
  std::size_t at_ = 0;
};

/// A length with its unit as written: "", "px", "mm", "cm", "in", "pt", "pc", "Q", "%".
struct SvgLength {
  double value = 0;
  std::string unit;
};
/// Relative units other than % (em, ex, vw, ...) are unsupported.
[[nodiscard]] SvgLength parse_length(std::string_view text, std::string_view what);
/// CSS pixels of one such unit (1 for ""). Requires an absolute one.
[[nodiscard]] double pixels_of(std::string_view unit);
/// In user units; % is unsupported.
[[nodiscard]] double parse_user_length(std::string_view text, std::string_view what);

/// matrix, translate, scale, rotate, skewX, skewY, any number of them.
[[nodiscard]] PlaneMap parse_transform(std::string_view text);

/// A subpath, closed by a line where the text left it open.
using SvgRing = std::vector<PlaneCurve>;
/// M L H V C S Q T A Z and their relative forms. A subpath that is a point is left out.
[[nodiscard]] std::vector<SvgRing> parse_path(std::string_view text);

/// The arc of the path command A: ends, half axes, the angle of the first one in degrees, flags.
/// @return a line where a radius is 0; radii that do not reach are scaled up ([SVG] B.2.5).
[[nodiscard]] PlaneCurve elliptical_arc(const Point2& from, const Point2& to, Point2 radii, double degrees, bool large,
                                        bool sweep);

}  // namespace pd::drawing
