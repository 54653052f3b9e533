#include "oracle/grid_answer_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "oracle/exact_sum.hpp"
#include "oracle/judging.hpp"

namespace pd::oracle::grid {

namespace {

Vec3 translation_of(const Placement& at) {
  return {static_cast<double>(at.translation[0]), static_cast<double>(at.translation[1]),
          static_cast<double>(at.translation[2])};
}

/// |v| <= length, exact.
bool at_most(const Vec3& v, double length) {
  // Times 2^400: what is below 2^-800 then counts as that, which only makes the length smaller by less than 2^-1600.
  ExactSum<8> sum;
  for (const double x : {v.x(), v.y(), v.z()}) {
    const double scaled = x == 0 ? 0 : std::max(std::abs(x), 0x1p-800) * 0x1p400;
    sum.add_product(scaled, scaled);
  }
  const double scaled = length * 0x1p400;
  sum.add_product(-scaled, scaled);
  return sum.sign() <= 0;
}

class Checker {
 public:
  Checker(const Judge& judge, const Verdict& verdict, const Question& question, const PenetrationDepth& answer)
      : judge_(judge), verdict_(verdict), question_(question), answer_(answer) {
    extent_ = verdict.extent;
    size_ = question.hull_a->radius() + question.hull_b->radius() +
            (translation_of(question.b.at) - translation_of(question.a.at)).norm();
    const double largest = std::max(answer.witness_a.cwiseAbs().maxCoeff(), answer.witness_b.cwiseAbs().maxCoeff());
    // A witness is stored in the common frame: its own rounding is beyond anybody's power.
    tolerance_ = 8 * ulp_of(extent_) + 2 * ulp_of(largest);
    // A certified answer may name any direction inside its bracket.
    if (question.bracket != Bracket::tightest) tolerance_ += allowed_width();
  }

  Findings run() {
    if (!finite()) return std::move(findings_);
    if (answer_.contact != verdict_.contact) {
      // Of contact, too: no signed distance on this grid but 0 is as small as its interval is wide.
      fail(Promise::contact, "class " + std::string(pd::to_string(answer_.contact)) + " instead of " +
                                 std::string(pd::to_string(verdict_.contact)));
      return std::move(findings_);
    }
    const double length = answer_.normal.norm();
    if (std::abs(length - 1) > 4 * 0x1p-52) fail(Promise::normal, text("normal of length 1 + %g", length - 1, 0));
    if (!answer_.bracket_reached) fail(Promise::width, "bracket_reached is false");
    switch (answer_.contact) {
      case ContactClass::overlapping:
        overlapping();
        break;
      case ContactClass::touching:
        touching();
        break;
      case ContactClass::separated:
        separated();
        break;
    }
    witness(question_.a, answer_.witness_a, "witness_a");
    witness(question_.b, answer_.witness_b, "witness_b");
    return std::move(findings_);
  }

 private:
  void fail(Promise promise, std::string what) { findings_.wrong.push_back({promise, std::move(what)}); }

  [[nodiscard]] double allowed_width() const {
    return std::max(kCertifiedWidth * size_, question_.bracket == Bracket::contact ? kContactTolerance : 0);
  }

  bool finite() {
    const double numbers[] = {answer_.depth,    answer_.lower,          answer_.upper,
                              answer_.distance, answer_.distance_lower, answer_.distance_upper};
    bool all = answer_.translation.allFinite() && answer_.normal.allFinite() && answer_.witness_a.allFinite() &&
               answer_.witness_b.allFinite();
    for (const double x : numbers) all = all && std::isfinite(x);
    if (!all) fail(Promise::finite, "non_finite numbers in the answer");
    return all;
  }

  void bracket(const Fraction& square, double lower, double middle, double upper, const char* name) {
    const std::string what = std::string(name) + " bracket: ";
    const double about = std::sqrt(static_cast<double>(square.numerator) / static_cast<double>(square.denominator));
    if (lower < 0 || compare_square(lower, square) > 0) {
      fail(Promise::bracket, what + text("lower %.17g above %.17g", lower, about));
      return;
    }
    if (upper < 0 || compare_square(upper, square) < 0) {
      fail(Promise::bracket, what + text("upper %.17g below %.17g", upper, about));
      return;
    }
    if (middle < lower * (1 - 0x1p-51) || middle > upper * (1 + 0x1p-51)) {
      fail(Promise::bracket, what + text("%.17g outside, lower %.17g", middle, lower));
    }
    if (question_.bracket == Bracket::tightest) {
      check_rounding(square, lower, upper, what);
    } else if (upper - lower > allowed_width()) {
      fail(Promise::width, what + text("width %g for L = %g", upper - lower, extent_));
    }
  }

  /// lower and upper are the value rounded down and up; of a depth, upper may be the next double.
  void check_rounding(const Fraction& square, double lower, double upper, const std::string& what) {
    const double down = root_down(square);
    const double up = root_up(square);
    const bool late = upper == std::nextafter(up, upper) && upper != up;
    const bool may_be_late = answer_.contact == ContactClass::overlapping && !(down == up && translation_is_exact());
    if (lower != down || (upper != up && !(late && may_be_late))) {
      fail(Promise::width, what + text("%.17g to %.17g is not the value rounded down and up", lower, upper));
    }
    findings_.upper_is_next = late;
  }

  /// Of a depth that is a double: whether the translation of just that length along the answered normal, which of
  /// several optimal ones is the canonical, is made of doubles.
  [[nodiscard]] bool translation_is_exact() const {
    // The only translations of that length are h n / |n|^2 for the optimal n.
    return std::any_of(verdict_.normals.begin(), verdict_.normals.end(), [&](const Int3& n) {
      const std::int32_t n2 = dot(n, n);
      const auto h = static_cast<std::int32_t>(std::lround(judge_.support(n.to_vec3())));
      if (!(n.to_vec3().normalized().dot(answer_.normal) > 1 - 1e-9)) return false;
      const auto is_double = [&](std::int32_t c) {
        const auto divisor = static_cast<std::uint32_t>(n2 / std::gcd(h * c, n2));
        return std::has_single_bit(divisor);
      };
      return is_double(n.x) && is_double(n.y) && is_double(n.z);
    });
  }

  void zero(double value, const char* name) {
    if (value != 0) fail(Promise::zero, std::string(name) + text(" = %g instead of 0", value, 0));
  }
  void no_depth() {
    zero(answer_.depth, "depth");
    zero(answer_.lower, "lower");
    if (question_.bracket != Bracket::contact || answer_.contact != ContactClass::touching)
      zero(answer_.upper, "upper");
    zero(answer_.translation.cwiseAbs().maxCoeff(), "translation");
  }
  void no_distance() {
    zero(answer_.distance, "distance");
    zero(answer_.distance_lower, "distance_lower");
    if (question_.bracket != Bracket::contact || answer_.contact != ContactClass::touching) {
      zero(answer_.distance_upper, "distance_upper");
    }
  }

  void overlapping() {
    no_distance();
    bracket(verdict_.depth_squared, answer_.lower, answer_.depth, answer_.upper, "depth");
    const Vec3& t = answer_.translation;
    if (question_.bracket != Bracket::contact) {
      if (!judge_.separates(t)) fail(Promise::translation, "translation does not separate");
      if (!at_most(t, answer_.upper)) {
        fail(Promise::translation,
             text("translation longer than upper %.17g by %g", answer_.upper, t.norm() - answer_.upper));
      }
    } else if (const double left = -judge_.clearance(answer_.upper * answer_.normal); left > tolerance_) {
      fail(Promise::translation, text("upper * normal leaves an overlap of %g, allowed %g", left, tolerance_));
    }
    near(Promise::witness, answer_.witness_b - answer_.witness_a, t, "witness_b - witness_a against translation");
    near(Promise::normal, answer_.depth * answer_.normal, t, "depth * normal against translation");
    const double missing = judge_.support(answer_.normal) - answer_.upper;
    if (missing > tolerance_) {
      fail(Promise::normal,
           text("the way out along the normal is %g longer than upper, allowed %g", missing, tolerance_));
    }
    if (question_.bracket == Bracket::tightest) {
      optimal_normal();
      features();
    }
  }

  /// The normal is that of an optimal facet of P, but for the grid of doubles that the translation lies on.
  void optimal_normal() {
    double least = 1;
    for (const Int3& n : verdict_.normals) {
      const Vec3 optimal = n.to_vec3();
      if (optimal.dot(answer_.normal) > 0) {
        least = std::min(least, optimal.cross(answer_.normal).norm() / optimal.norm());
      }
    }
    if (least * answer_.depth > tolerance_) fail(Promise::normal, text("normal off every optimal one by %g", least, 0));
  }

  void touching() {
    no_depth();
    no_distance();
    if (answer_.upper + answer_.distance_upper > allowed_width()) {
      fail(Promise::width, text("touching within %g and %g", answer_.upper, answer_.distance_upper));
    }
    near(Promise::witness, answer_.witness_b, answer_.witness_a, "witnesses of touching bodies");
    if (verdict_.flat_difference) return;  // every direction out of the plane leads out
    const double out = judge_.support(answer_.normal);
    if (out > tolerance_) fail(Promise::normal, text("normal of touching bodies leads out only after %g", out, 0));
  }

  void separated() {
    no_depth();
    bracket(verdict_.distance_squared, answer_.distance_lower, answer_.distance, answer_.distance_upper, "distance");
    const Vec3 apart = answer_.witness_a - answer_.witness_b;
    near(Promise::witness, answer_.distance * answer_.normal, apart, "witness_a - witness_b against distance * normal");
    // P lies beyond the plane at the distance across -normal.
    const double missing = judge_.support(answer_.normal) + answer_.distance_lower;
    if (missing > tolerance_) {
      fail(Promise::normal, text("the plane across the normal proves %g less than the distance", missing, 0));
    }
    if (question_.bracket == Bracket::tightest) {
      const Vec3 w(static_cast<double>(verdict_.nearest[0]), static_cast<double>(verdict_.nearest[1]),
                   static_cast<double>(verdict_.nearest[2]));
      near(Promise::normal, -answer_.distance * w.normalized(), answer_.distance * answer_.normal,
           "the nearest point of P against distance * normal");
    }
  }

  void near(Promise promise, const Vec3& got, const Vec3& wanted, const char* what) {
    const double error = (got - wanted).cwiseAbs().maxCoeff();
    if (error > tolerance_) fail(promise, std::string(what) + text(" differ by %g, allowed %g", error, tolerance_));
  }

  /// Both features lie in the faces that an optimal direction supports.
  void features() {
    const auto corners = [](const Feature& f, const ConvexPolytope& p, const PlacedBody& body) {
      std::vector<int> ids;
      if (f.kind == Feature::Kind::vertex) ids = {f.first};
      if (f.kind == Feature::Kind::edge) ids = {f.first, f.second};
      if (f.kind == Feature::Kind::facet && f.first >= 0 && f.first < p.num_facets()) {
        for (const std::int32_t v : p.facet_vertices(f.first)) ids.push_back(v);
      }
      std::vector<Int3> points;
      for (const int id : ids) {
        if (id < 0 || id >= p.num_vertices()) return std::vector<Int3>{};
        const Int3& local = body.body->points[static_cast<std::size_t>(p.caller_id(id))];
        points.push_back(axis_rotations()[static_cast<std::size_t>(body.at.rotation)].apply(local));
      }
      return points;
    };
    const std::vector<Int3> a = corners(answer_.feature_a, *question_.hull_a, question_.a);
    const std::vector<Int3> b = corners(answer_.feature_b, *question_.hull_b, question_.b);
    if (a.empty() || b.empty()) {
      fail(Promise::feature, "feature missing");
      return;
    }
    for (const Int3& n : verdict_.normals) {
      const auto least_a = [&](const Int3& p) {
        return std::all_of(judge_.vertices_a().begin(), judge_.vertices_a().end(),
                           [&](const Int3& q) { return dot(n, p) <= dot(n, q); });
      };
      const auto most_b = [&](const Int3& p) {
        return std::all_of(judge_.vertices_b().begin(), judge_.vertices_b().end(),
                           [&](const Int3& q) { return dot(n, p) >= dot(n, q); });
      };
      if (std::all_of(a.begin(), a.end(), least_a) && std::all_of(b.begin(), b.end(), most_b)) return;
    }
    fail(Promise::feature, "feature pair is not optimal");
  }

  /// No half-space of the body leaves the witness out by more than the tolerance.
  void witness(const PlacedBody& body, const Vec3& w, const char* name) {
    const AxisRotation& r = axis_rotations()[static_cast<std::size_t>(body.at.rotation)];
    const Vec3 local = w - translation_of(body.at);
    for (const HalfSpace& h : body.body->inside) {
      const Vec3 n = r.apply(h.normal).to_vec3();
      const double outside = (n.dot(local) - h.offset) / n.norm();
      if (outside > tolerance_) {
        fail(Promise::witness, std::string(name) + text(" outside its body by %g, allowed %g", outside, tolerance_));
      }
    }
  }

  const Judge& judge_;
  const Verdict& verdict_;
  const Question& question_;
  const PenetrationDepth& answer_;
  double extent_ = 0;
  double size_ = 0;
  double tolerance_ = 0;
  Findings findings_;
};

/// The numbers of two answers that no order of points or bodies may change.
bool same_lengths(const PenetrationDepth& x, const PenetrationDepth& y) {
  return x.contact == y.contact && x.depth == y.depth && x.lower == y.lower && x.upper == y.upper &&
         x.distance == y.distance && x.distance_lower == y.distance_lower && x.distance_upper == y.distance_upper &&
         x.bracket_reached == y.bracket_reached;
}

bool same_bits(const Vec3& v, const Vec3& w) { return std::memcmp(v.data(), w.data(), 3 * sizeof(double)) == 0; }

bool same_feature(const Feature& f, const Feature& g) {
  return f.kind == g.kind && f.first == g.first && f.second == g.second;
}

constexpr std::string_view kPromiseNames[] = {"finite",  "class",   "bracket", "width", "translation", "normal",
                                              "witness", "feature", "zero",    "swap",  "order"};
static_assert(std::size(kPromiseNames) == kPromises);

}  // namespace

std::string_view to_string(Promise promise) { return kPromiseNames[static_cast<std::size_t>(promise)]; }

Findings check_answer(const Judge& judge, const Verdict& verdict, const Question& question,
                      const PenetrationDepth& answer) {
  return Checker(judge, verdict, question, answer).run();
}

std::vector<Breach> check_swapped(const Judge& judge, const PenetrationDepth& answer, const PenetrationDepth& swapped) {
  if (!same_lengths(answer, swapped)) {
    return {{Promise::swap, text("other numbers for (B, A): depth %.17g, then %.17g", answer.depth, swapped.depth)}};
  }
  if (swapped.translation == -answer.translation && swapped.normal == -answer.normal) return {};
  // Of equal point sets no order can be told.
  std::vector<Int3> a = judge.vertices_a();
  std::vector<Int3> b = judge.vertices_b();
  for (Int3& p : b) p = p + judge.offset();
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  if (a == b) return {};
  return {{Promise::swap, "translation or normal of (B, A) is not the negative"}};
}

std::vector<Breach> check_reordered(const PenetrationDepth& answer, const PenetrationDepth& reordered) {
  const bool same = same_lengths(answer, reordered) && same_bits(answer.translation, reordered.translation) &&
                    same_bits(answer.normal, reordered.normal) && same_bits(answer.witness_a, reordered.witness_a) &&
                    same_bits(answer.witness_b, reordered.witness_b) &&
                    same_feature(answer.feature_a, reordered.feature_a) &&
                    same_feature(answer.feature_b, reordered.feature_b);
  if (same) return {};
  return {{Promise::order,
           text("another answer for the same points: depth %.17g, then %.17g", answer.depth, reordered.depth)}};
}

}  // namespace pd::oracle::grid
