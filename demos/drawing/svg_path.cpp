// Path data ([SVG] section 9.3): letters with their numbers, repeated without the letter, relative where it is small.
#include <cctype>
#include <string_view>
#include <utility>

#include "drawing/svg_text.hpp"

namespace pd::drawing {

namespace {

class PathReader {
 public:
  explicit PathReader(std::string_view text) : scanner_(text, "path data") {}

  std::vector<SvgRing> read() {
    scanner_.skip_blanks();
    while (!scanner_.done()) {
      const char letter = scanner_.peek();
      if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(letter) == std::string_view::npos) {
        scanner_.refuse("a command is expected: M L H V C S Q T A Z, or small for relative coordinates");
      }
      if (!begun_ && letter != 'M' && letter != 'm') scanner_.refuse("a path begins with M");
      scanner_.take();
      command(letter);
    }
    close();
    return std::move(rings_);
  }

 private:
  void command(char letter) {
    relative_ = std::islower(static_cast<unsigned char>(letter)) != 0;
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    scanner_.skip_blanks();
    if (kind == 'Z') {
      close();
      smooth_ = ' ';
      return;
    }
    segment(kind);
    scanner_.skip_separator();
    // Further pairs after M are lines.
    while (scanner_.number_ahead()) {
      segment(kind == 'M' ? 'L' : kind);
      scanner_.skip_separator();
    }
  }

  double number() {
    const double value = scanner_.number();
    scanner_.skip_separator();
    return value;
  }
  Point2 point() {
    const double x = number(), y = number();
    return relative_ ? Point2{here_[0] + x, here_[1] + y} : Point2{x, y};
  }

  void segment(char kind) {
    PlaneCurve curve{.from = here_};
    switch (kind) {
      case 'M':
        close();
        here_ = start_ = point();
        begun_ = true;
        smooth_ = ' ';
        return;
      case 'H':
        curve.to = {number() + (relative_ ? here_[0] : 0), here_[1]};
        break;
      case 'V':
        curve.to = {here_[0], number() + (relative_ ? here_[1] : 0)};
        break;
      case 'C':
      case 'S':
        curve.kind = PlaneCurve::Kind::cubic;
        curve.control[0] = kind == 'C' ? point() : reflected('C');
        curve.control[1] = point();
        curve.to = point();
        break;
      case 'Q':
      case 'T':
        curve.kind = PlaneCurve::Kind::quadratic;
        curve.control[0] = kind == 'Q' ? point() : reflected('Q');
        curve.to = point();
        break;
      case 'A': {
        const double rx = number(), ry = number(), degrees = number();
        const bool large = flag(), sweep = flag();
        curve = elliptical_arc(here_, point(), {rx, ry}, degrees, large, sweep);
        break;
      }
      default:
        curve.to = point();
        break;
    }
    // Only a curve of the same family hands its last control point on.
    smooth_ = curve.kind == PlaneCurve::Kind::cubic ? 'C' : (curve.kind == PlaneCurve::Kind::quadratic ? 'Q' : ' ');
    last_control_ = curve.control[smooth_ == 'C' ? 1 : 0];
    here_ = curve.to;
    ring_.push_back(curve);
  }

  bool flag() {
    const bool value = scanner_.flag();
    scanner_.skip_separator();
    return value;
  }

  [[nodiscard]] Point2 reflected(char family) const {
    if (smooth_ != family) return here_;
    return {2 * here_[0] - last_control_[0], 2 * here_[1] - last_control_[1]};
  }

  void close() {
    bool moved = false;
    for (const PlaneCurve& curve : ring_) {
      moved = moved || curve.to != start_ || curve.kind != PlaneCurve::Kind::line;
    }
    if (moved) {
      if (here_ != start_) ring_.push_back({.from = here_, .to = start_});
      rings_.push_back(std::move(ring_));
    }
    ring_.clear();
    here_ = start_;
  }

  SvgScanner scanner_;
  std::vector<SvgRing> rings_;
  SvgRing ring_;
  Point2 here_ = {}, start_ = {}, last_control_ = {};
  char smooth_ = ' ';  ///< family of the curve before: C, Q or none
  bool relative_ = false, begun_ = false;
};

}  // namespace

std::vector<SvgRing> parse_path(std::string_view text) { return PathReader(text).read(); }

}  // namespace pd::drawing
