#include "solid/solid_distance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "numeric/unit_roundoff.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::detail {

namespace {

using Corners = std::array<Vec3, 3>;

/// Two points near the closest ones, one of each body.
struct Closest {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  double squared = HUGE_VAL;
  void take(const Vec3& p, const Vec3& q) {
    const double d = (p - q).squaredNorm();
    if (d < squared) *this = {p, q, d};
  }
};

double clamped(double x) { return x > 0 ? std::min(x, 1.0) : 0; }

/// Segments p + s u and q + t v, s and t in [0, 1] (Ericson, "Real-time collision detection", 2005, section 5.1.9).
void nearest_of_edges(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v, Closest& best) {
  const Vec3 r = p - q;
  const double a = u.squaredNorm(), e = v.squaredNorm(), b = u.dot(v), c = u.dot(r), f = v.dot(r);
  const double denominator = a * e - b * b;
  double s = denominator > 0 ? clamped((b * f - c * e) / denominator) : 0;
  double t = (b * s + f) / e;
  if (t < 0) {
    t = 0;
    s = clamped(-c / a);
  } else if (t > 1) {
    t = 1;
    s = clamped((b - c) / a);
  }
  best.take(p + s * u, q + t * v);
}

/// The foot of x in the open triangle, if there is one; edges are asked elsewhere.
bool foot_inside(const Vec3& x, const Corners& t, Vec3& foot) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], w = x - t[0];
  const Vec3 n = u.cross(v);
  const double area = n.squaredNorm();
  const double s = w.cross(v).dot(n), r = u.cross(w).dot(n);
  if (!(s > 0 && r > 0 && s + r < area)) return false;
  foot = t[0] + (s / area) * u + (r / area) * v;
  return true;
}

Closest closest_points(const Corners& a, const Corners& b) {
  Closest best;
  Vec3 foot;
  for (std::size_t k = 0; k < 3; ++k) {
    if (foot_inside(a[k], b, foot)) best.take(a[k], foot);
    if (foot_inside(b[k], a, foot)) best.take(foot, b[k]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 u = a[(i + 1) % 3] - a[i];
    for (std::size_t j = 0; j < 3; ++j) nearest_of_edges(a[i], u, b[j], b[(j + 1) % 3] - b[j], best);
  }
  return best;
}

struct Candidate {
  double lower;  ///< certified
  double near;   ///< the distance in doubles
  std::int32_t a, b;
};

class DistanceSearch {
 public:
  explicit DistanceSearch(const PosedSolids& solids) : solids_(solids) {}

  /// Pairs that may be nearest, those first that seem so.
  std::vector<Candidate> run(std::int64_t& pairs) {
    visit(0, 0, gap(0, 0));
    std::erase_if(candidates_, [&](const Candidate& c) { return c.lower > upper_; });
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
      return x.near != y.near ? x.near < y.near : (x.a != y.a ? x.a < y.a : x.b < y.b);
    });
    pairs += pairs_;
    return std::move(candidates_);
  }

 private:
  [[nodiscard]] const TriangleNode& node(Body body, std::int32_t at) const {
    return solids_.solid(body).nodes()[static_cast<std::size_t>(at)];
  }
  [[nodiscard]] double gap(std::int32_t at_a, std::int32_t at_b) const {
    const TriangleBox a = solids_.box(Body::a, node(Body::a, at_a)), b = solids_.box(Body::b, node(Body::b, at_b));
    return (b.low - a.high).cwiseMax(a.low - b.high).cwiseMax(Vec3::Zero()).norm() * (1 - 0x1p-48);
  }

  void visit(std::int32_t at_a, std::int32_t at_b, double least) {
    if (least > upper_) return;
    const TriangleNode &a = node(Body::a, at_a), &b = node(Body::b, at_b);
    if (a.is_leaf() && b.is_leaf()) {
      test(a, b);
      return;
    }
    const bool split_a = !a.is_leaf() && (b.is_leaf() || (a.high - a.low).maxCoeff() >= (b.high - b.low).maxCoeff());
    const std::int32_t first_a = split_a ? a.left : at_a, second_a = split_a ? a.right : at_a;
    const std::int32_t first_b = split_a ? at_b : b.left, second_b = split_a ? at_b : b.right;
    const double first = gap(first_a, first_b), second = gap(second_a, second_b);
    if (first <= second) {
      visit(first_a, first_b, first);
      visit(second_a, second_b, second);
    } else {
      visit(second_a, second_b, second);
      visit(first_a, first_b, first);
    }
  }

  void test(const TriangleNode& a, const TriangleNode& b) {
    std::array<Corners, TriangleTree::kLeaf> of_b;
    for (std::int32_t t = b.first; t < b.last; ++t) of_b[static_cast<std::size_t>(t - b.first)] = corners(Body::b, t);
    for (std::int32_t s = a.first; s < a.last; ++s) {
      const Corners of_a = corners(Body::a, s);
      for (std::int32_t t = b.first; t < b.last; ++t) test(of_a, s, of_b[static_cast<std::size_t>(t - b.first)], t);
    }
  }
  [[nodiscard]] Corners corners(Body body, std::int32_t triangle) const {
    const PosedTriangle t = solids_.corners(body, triangle);
    return {t[0].x, t[1].x, t[2].x};
  }

  void test(const Corners& a, std::int32_t s, const Corners& b, std::int32_t t) {
    ++pairs_;
    const Closest found = closest_points(a, b);
    const double distance = std::sqrt(found.squared);
    const double slack = 8 * solids_.error();
    if (distance - slack > upper_ * 2 + slack) return;
    double lower = 0;
    if (distance > 0) {
      // A plane between the two bounds their distance, however good the points are.
      const Vec3 normal = (found.a - found.b) / distance;
      const double least = std::min({normal.dot(a[0]), normal.dot(a[1]), normal.dot(a[2])});
      const double most = std::max({normal.dot(b[0]), normal.dot(b[1]), normal.dot(b[2])});
      lower = std::max(0.0, (least - most) * (1 - 8 * kUnitRoundoff) - slack);
    }
    if (lower > upper_) return;
    upper_ = std::min(upper_, distance + slack);
    candidates_.push_back({lower, distance, s, t});
    if (candidates_.size() > kMostKept) {
      std::erase_if(candidates_, [&](const Candidate& c) { return c.lower > upper_; });
    }
  }

  static constexpr std::size_t kMostKept = 4096;
  const PosedSolids& solids_;
  double upper_ = HUGE_VAL;
  std::vector<Candidate> candidates_;
  std::int64_t pairs_ = 0;
};

}  // namespace

PenetrationDepth answer_of_triangles(const PosedSolids& solids, std::int32_t triangle_a, std::int32_t triangle_b,
                                     Scratch& scratch) {
  const auto shape = [&](Body body, std::int32_t triangle) -> ConvexShape {
    const MeshSolid& solid = solids.solid(body);
    const auto& v = solid.triangle(triangle).vertices;
    const Corners points = {solid.vertex(v[0]), solid.vertex(v[1]), solid.vertex(v[2])};
    return *ConvexPolytope::from_points(points);
  };
  const ConvexShape a = shape(Body::a, triangle_a), b = shape(Body::b, triangle_b);
  return penetration_depth({&a, solids.pose(Body::a)}, {&b, solids.pose(Body::b)}, scratch,
                           {.bracket = Bracket::tightest});
}

void set_distance(const PosedSolids& solids, Scratch& scratch, SolidDepth& out) {
  constexpr double kTight = 1e-12;
  constexpr std::size_t kMostAsked = 4096;
  const std::vector<Candidate> candidates = DistanceSearch(solids).run(out.work.triangle_pairs);
  // rest[i] is the least lower bound of the candidates from i on.
  std::vector<double> rest(candidates.size() + 1, HUGE_VAL);
  for (std::size_t i = candidates.size(); i-- > 0;) {
    rest[i] = std::min(rest[i + 1], std::ldexp(candidates[i].lower, solids.scale_exponent()));
  }
  double lower = HUGE_VAL;
  std::int32_t best_a = -1, best_b = -1;
  for (std::size_t i = 0; i < std::min(candidates.size(), kMostAsked); ++i) {
    if (best_a >= 0 && rest[i] >= out.distance_upper) break;
    const Candidate& c = candidates[i];
    const PenetrationDepth answer = answer_of_triangles(solids, c.a, c.b, scratch);
    lower = std::min(lower, answer.distance_lower);
    if (best_a < 0 || answer.distance_upper < out.distance_upper) {
      static_cast<PenetrationDepth&>(out) = answer;
      best_a = c.a;
      best_b = c.b;
    }
    if (std::min(lower, rest[i + 1]) * (1 + kTight) >= out.distance_upper) {
      lower = std::min(lower, rest[i + 1]);
      break;
    }
    if (i + 1 == kMostAsked) lower = std::min(lower, rest[i + 1]);
  }
  out.distance_lower = std::min(lower, out.distance_upper);
  out.bracket_reached = out.distance_lower * (1 + kTight) >= out.distance_upper;
  out.feature_a = out.feature_b = {};
  out.face_a = solids.solid(Body::a).triangle(best_a).face;
  out.face_b = solids.solid(Body::b).triangle(best_b).face;
}

}  // namespace pd::detail
