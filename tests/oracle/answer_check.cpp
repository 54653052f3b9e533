#include "oracle/answer_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "oracle/judging.hpp"

namespace pd::oracle {

namespace {

/// Depths below which `Bracket::tightest` may miss the shortest translation of doubles by some steps more.
constexpr double kSearchedBlindly = 0x1p-960;

/// |v| of a double vector, exactly.
ExactLength exact_length(const Vec3& v) {
  Scaled sum;
  for (int k = 0; k < 3; ++k) sum = sum + to_scaled(v[k]) * to_scaled(v[k]);
  return {sum.mantissa, 1, sum.exponent};
}

class Checker {
 public:
  Checker(const ExactPair& pair, const Verdict& verdict, const Question& question, const PenetrationDepth& answer)
      : pair_(pair),
        verdict_(verdict),
        question_(question),
        answer_(answer),
        extent_(difference_extent(pair)),
        size_(size_of_numbers(*question.a, *question.pose_a, *question.b, *question.pose_b)) {
    const double largest = std::max(answer.witness_a.cwiseAbs().maxCoeff(), answer.witness_b.cwiseAbs().maxCoeff());
    // A witness is stored in the common frame: its own rounding is beyond anybody's power.
    tolerance_ = 8 * ulp_of(extent_) + 2 * ulp_of(largest);
    // A certified answer may name any direction inside its bracket.
    if (question.bracket == Bracket::certified) tolerance_ += kCertifiedWidth * size_;
  }

  Findings run() {
    if (!finite()) return findings_;
    if (answer_.contact != verdict_.contact) {
      fail(Promise::contact, "class " + std::string(to_string(answer_.contact)) + " instead of " +
                                 std::string(to_string(verdict_.contact)));
      return findings_;
    }
    const double length = answer_.normal.norm();
    if (std::abs(length - 1) > 4 * 0x1p-52) fail(Promise::normal, text("normal of length 1 + %g", length - 1, 0));
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
    witness(false, pair_.a(), answer_.witness_a);
    witness(true, pair_.b(), answer_.witness_b);
    return findings_;
  }

 private:
  void fail(Promise promise, std::string what) { findings_.wrong.push_back({promise, std::move(what)}); }

  bool finite() {
    const double numbers[] = {answer_.depth,    answer_.lower,          answer_.upper,
                              answer_.distance, answer_.distance_lower, answer_.distance_upper};
    bool all = answer_.translation.allFinite() && answer_.normal.allFinite() && answer_.witness_a.allFinite() &&
               answer_.witness_b.allFinite();
    for (const double x : numbers) all = all && std::isfinite(x);
    if (!all) fail(Promise::finite, "non_finite numbers in the answer");
    return all;
  }

  void bracket(const ExactLength& truth, double lower, double middle, double upper, const char* name) {
    if (lower < 0 || truth.compare(lower) > 0) {
      fail(Promise::bracket, std::string(name) + text(" bracket: lower %.17g above %.17g", lower, truth.approximate()));
    }
    if (truth.compare(upper) < 0) {
      fail(Promise::bracket, std::string(name) + text(" bracket: upper %.17g below %.17g", upper, truth.approximate()));
    }
    if (middle < lower * (1 - 0x1p-51) || middle > upper * (1 + 0x1p-51)) {
      fail(Promise::bracket, std::string(name) + text(" outside its bracket: %.17g, lower %.17g", middle, lower));
    }
    const double width = upper - lower;
    if (extent_ > 0) findings_.relative_width = width / extent_;
    const double allowed = question_.bracket == Bracket::certified ? kCertifiedWidth * size_ : 4e-15 * extent_;
    // Where the extent is denormal, one step of the doubles is the least width there is.
    if (width > std::max(allowed, 2 * std::numeric_limits<double>::denorm_min())) {
      fail(Promise::width, std::string(name) + text(" width %g for L = %g", width, extent_));
    }
    if (question_.bracket == Bracket::tightest) {
      const double down = truth.round_down();
      double up = std::nextafter(truth.round_up(), INFINITY);
      for (int i = 0; i < 6 && up < kSearchedBlindly; ++i) up = std::nextafter(up, INFINITY);
      if (lower < down) {
        fail(Promise::width, std::string(name) + text(" tightest: lower %.17g below %.17g", lower, down));
      }
      if (upper > up) fail(Promise::width, std::string(name) + text(" tightest: upper %.17g above %.17g", upper, up));
    }
  }

  void zero(double value, const char* name) {
    if (value != 0) fail(Promise::zero, std::string("zero expected: ") + name + text(" = %g", value, 0));
  }
  void no_depth() {
    zero(answer_.depth, "depth");
    zero(answer_.lower, "lower");
    zero(answer_.upper, "upper");
    zero(answer_.translation.squaredNorm(), "translation");
  }
  void no_distance() {
    zero(answer_.distance, "distance");
    zero(answer_.distance_lower, "distance_lower");
    zero(answer_.distance_upper, "distance_upper");
  }

  void overlapping() {
    no_distance();
    bracket(verdict_.depth, answer_.lower, answer_.depth, answer_.upper, "depth");
    const ExactPair moved(pair_.a(), *question_.pose_a, pair_.b(), *question_.pose_b, answer_.translation);
    if (!separates(moved)) fail(Promise::translation, "translation does not separate");
    if (exact_length(answer_.translation).compare(answer_.upper) < 0) {
      fail(Promise::translation, text("translation longer than upper %.17g by %g", answer_.upper,
                                      answer_.translation.norm() - answer_.upper));
    }
    near(Promise::witness, answer_.witness_b - answer_.witness_a, answer_.translation,
         "witness_b - witness_a against translation");
    near(Promise::normal, answer_.depth * answer_.normal, answer_.translation, "depth * normal against translation");
    if (question_.bracket == Bracket::tightest) features();
  }

  void touching() {
    no_depth();
    no_distance();
    near(Promise::witness, answer_.witness_b, answer_.witness_a, "witnesses of touching bodies");
    if (verdict_.flat_difference) return;  // every direction out of the plane leads out
    const double out = pair_.support(answer_.normal);
    if (out > 0x1p-44 * pair_.magnitude()) {
      fail(Promise::normal, text("normal of touching bodies leads out only after %g of %g", out, pair_.magnitude()));
    }
  }

  void separated() {
    no_depth();
    if (!verdict_.distance_known) {
      fail(Promise::oracle, "oracle: distance not certified");
      return;
    }
    bracket(verdict_.distance, answer_.distance_lower, answer_.distance, answer_.distance_upper, "distance");
    near(Promise::normal, answer_.distance * answer_.normal, answer_.witness_a - answer_.witness_b,
         "witness_a - witness_b against distance * normal");
  }

  [[nodiscard]] bool separates(const ExactPair& moved) const {
    // The moved pair has its own power of two, but directions carry over.
    return interiors_disjoint(moved, verdict_.normals);
  }

  void near(Promise promise, const Vec3& got, const Vec3& wanted, const char* what) {
    const double error = (got - wanted).cwiseAbs().maxCoeff();
    if (error > tolerance_) fail(promise, std::string(what) + text(" differ by %g, allowed %g", error, tolerance_));
  }

  /// Both features lie in the faces that an optimal direction supports.
  void features() {
    const auto points = [](const Feature& f, const ConvexPolytope& p) {
      std::vector<int> ids;
      if (f.kind == Feature::Kind::vertex) ids = {f.first};
      if (f.kind == Feature::Kind::edge) ids = {f.first, f.second};
      if (f.kind == Feature::Kind::facet && f.first >= 0 && f.first < p.num_facets()) {
        for (const std::int32_t v : p.facet_vertices(f.first)) ids.push_back(v);
      }
      for (int& id : ids) id = id >= 0 && id < p.num_vertices() ? p.caller_id(id) : -1;
      return ids;
    };
    const std::vector<int> a = points(answer_.feature_a, *question_.a);
    const std::vector<int> b = points(answer_.feature_b, *question_.b);
    if (a.empty() || b.empty() || std::count(a.begin(), a.end(), -1) > 0 || std::count(b.begin(), b.end(), -1) > 0) {
      fail(Promise::feature, "feature missing");
      return;
    }
    for (std::size_t k = 0; k < verdict_.normals.size(); ++k) {
      const IVec& n = verdict_.normals[k];
      const Integer value = pair_.exact_support(n, verdict_.unit_normals[k]) - dot(pair_.offset(), n);
      // h = b - a at every pair of points of the two features.
      bool all = true;
      for (const int i : a) {
        for (const int j : b) all = all && dot(pair_.point_b(j) - pair_.point_a(i), n) == value;
      }
      if (all) return;
    }
    fail(Promise::feature, "feature pair is not optimal");
  }

  /// Not farther than the tolerance outside any facet plane (solids), or from the body (flat ones, in doubles).
  void witness(bool of_b, const Body& body, const Vec3& w) {
    // Exact difference from the posed reference, rounded once: far translations cancel exactly.
    const Body at(std::span<const Vec3>(&w, 1));
    const ExactPair from(body, of_b ? *question_.pose_b : *question_.pose_a, at, Pose());
    const double weight = to_double(from.weight());
    const IVec& d = from.offset();
    const Vec3 x(to_double(d.x, from.exponent()) / weight, to_double(d.y, from.exponent()) / weight,
                 to_double(d.z, from.exponent()) / weight);
    const double outside = distance_outside(of_b, body, x);
    // The planes are evaluated in doubles, which costs the check some ulps of its own.
    const double allowed = tolerance_ + 16 * ulp_of(extent_);
    if (outside > allowed) {
      fail(Promise::witness, std::string("witness_") + (of_b ? "b" : "a") +
                                 text(" outside its body by %g, allowed %g", outside, allowed));
    }
  }

  double distance_outside(bool of_b, const Body& body, const Vec3& x) const {
    const ExactPair::Rounded& r = of_b ? pair_.rounded_b() : pair_.rounded_a();
    const auto point = [&](int i) {
      const IVec& p = of_b ? pair_.point_b(i) : pair_.point_a(i);
      const double weight = to_double(pair_.weight());
      return Vec3(to_double(p.x, pair_.exponent()) / weight, to_double(p.y, pair_.exponent()) / weight,
                  to_double(p.z, pair_.exponent()) / weight);
    };
    if (body.dimension == 0) return (x - point(0)).norm();
    if (body.dimension == 1) {
      const Vec3 from = point(body.edges[0].from);
      const Vec3 to = point(body.edges[0].to);
      const double t = std::clamp((x - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
      return (x - from - t * (to - from)).norm();
    }
    double outside = 0;
    for (std::size_t f = 0; f < body.facets.size(); ++f) {
      outside = std::max(outside, r.facet_normals[f].dot(x - point(body.facets[f].corner[0])));
    }
    if (body.dimension == 2) {
      for (std::size_t e = 0; e < body.edges.size(); ++e) {
        // The loop runs counter-clockwise about the first facet's normal unless stored reversed.
        const Body::Edge& edge = body.edges[e];
        const Vec3 outward = r.edge_units[e].cross(r.facet_normals[edge.left]);
        outside = std::max(outside, outward.dot(x - point(edge.from)));
      }
    }
    return outside;
  }

  const ExactPair& pair_;
  const Verdict& verdict_;
  const Question& question_;
  const PenetrationDepth& answer_;
  double extent_;
  double size_;
  double tolerance_ = 0;
  Findings findings_;
};

constexpr std::string_view kPromiseNames[] = {"finite",  "class",  "bracket", "width", "translation",
                                              "witness", "normal", "feature", "zero",  "oracle"};
static_assert(std::size(kPromiseNames) == kPromises);

}  // namespace

std::string_view to_string(Promise promise) { return kPromiseNames[static_cast<std::size_t>(promise)]; }

double difference_extent(const ExactPair& pair) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) {
    const auto range = [&](const ExactPair::Rounded& r) {
      const std::vector<double>& c = k == 0 ? r.x : k == 1 ? r.y : r.z;
      return std::minmax_element(c.begin(), c.end());
    };
    const auto [low_a, high_a] = range(pair.rounded_a());
    const auto [low_b, high_b] = range(pair.rounded_b());
    const double offset = pair.rounded_offset()[k];
    largest = std::max({largest, std::abs(*high_b - *low_a + offset), std::abs(*low_b - *high_a + offset)});
  }
  return std::ldexp(largest, pair.scale());
}

double size_of_numbers(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b) {
  return a.radius() + b.radius() + (pose_b.translation() - pose_a.translation()).norm();
}

Findings check_answer(const ExactPair& pair, const Verdict& verdict, const Question& question,
                      const PenetrationDepth& answer) {
  return Checker(pair, verdict, question, answer).run();
}

}  // namespace pd::oracle
