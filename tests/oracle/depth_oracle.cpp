#include "oracle/depth_oracle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>

#include "oracle/quad_filter.hpp"

namespace pd::oracle {

namespace {

constexpr double kUlp = 0x1p-53;
/// Bits of coordinates from which quadruple precision is cheaper than the exact comparison.
constexpr int kWide = 512;

/// A direction that may be a facet normal of P.
struct Candidate {
  enum class Kind { facet_of_a, facet_of_b, edges };
  Kind kind;
  int i;
  int j;
  int sign;
  double lower;  ///< h_P(n) / |n| is not below this
};

IVec exact_normal(const ExactPair& pair, const Candidate& c) {
  const auto facet = [](const Body::Facet& f, auto&& point) {
    return cross(point(f.corner[1]) - point(f.corner[0]), point(f.corner[2]) - point(f.corner[0]));
  };
  switch (c.kind) {
    case Candidate::Kind::facet_of_a:
      return -facet(pair.a().facets[c.i], [&](int v) -> const IVec& { return pair.point_a(v); });
    case Candidate::Kind::facet_of_b:
      return facet(pair.b().facets[c.i], [&](int v) -> const IVec& { return pair.point_b(v); });
    case Candidate::Kind::edges:
      break;
  }
  const Body::Edge& e = pair.a().edges[c.i];
  const Body::Edge& f = pair.b().edges[c.j];
  IVec n = cross(pair.point_a(e.to) - pair.point_a(e.from), pair.point_b(f.to) - pair.point_b(f.from));
  return c.sign > 0 ? n : -n;
}

/// For every facet direction of one body, which edges of the other lie on its outer side (with certainty missing,
/// both).
struct SideBits {
  std::size_t words = 0;
  std::vector<std::uint64_t> maybe_positive;
  std::vector<std::uint64_t> maybe_negative;

  void fill(const std::vector<Vec3>& normals, const std::vector<Vec3>& edges) {
    words = (edges.size() + 63) / 64;
    maybe_positive.assign(words * normals.size(), 0);
    maybe_negative.assign(words * normals.size(), 0);
    std::vector<double> x(words * 64, 0);
    std::vector<double> y(words * 64, 0);
    std::vector<double> z(words * 64, 0);
    for (std::size_t j = 0; j < edges.size(); ++j) {
      x[j] = edges[j].x();
      y[j] = edges[j].y();
      z[j] = edges[j].z();
    }
    constexpr double kError = 256 * kUlp;  // unit normal and unit edge err by less than 100 ulp together
    double value[64];
    for (std::size_t f = 0; f < normals.size(); ++f) {
      const Vec3& n = normals[f];
      for (std::size_t w = 0; w < words; ++w) {
        for (std::size_t k = 0; k < 64; ++k) {
          value[k] = x[w * 64 + k] * n.x() + y[w * 64 + k] * n.y() + z[w * 64 + k] * n.z();
        }
        std::uint64_t positive = 0;
        std::uint64_t negative = 0;
        for (std::size_t k = 0; k < 64; ++k) {
          positive |= static_cast<std::uint64_t>(value[k] > -kError) << k;
          negative |= static_cast<std::uint64_t>(value[k] < kError) << k;
        }
        maybe_positive[f * words + w] = positive;
        maybe_negative[f * words + w] = negative;
      }
    }
  }
  /// Edges whose great circle may cross the arc between the normals of two facets (-1, -1: the arc of a segment, a
  /// whole great circle).
  [[nodiscard]] std::uint64_t crossing(int left, int right, std::size_t w) const {
    if (left < 0 || right < 0) return ~std::uint64_t{0};
    const std::size_t l = static_cast<std::size_t>(left) * words + w;
    const std::size_t r = static_cast<std::size_t>(right) * words + w;
    return (maybe_positive[l] & maybe_negative[r]) | (maybe_negative[l] & maybe_positive[r]);
  }
};

class Search {
 public:
  Search(const ExactPair& pair, QuadFiltering filtering) : pair_(pair), filtering_(filtering) {}

  /// Finds the least h_P(n) / |n|; returns its sign, and stops early when it is negative.
  int run(Verdict& verdict) {
    if (facets() < 0 || edges() < 0) return -1;
    return decide(verdict);
  }

 private:
  // Evaluates a candidate in doubles. Returns -1 when it separates for certain.
  int consider(Candidate c, const Vec3& unit, double error) {
    const double h = pair_.support(unit);
    if (h + error < 0) return -1;
    c.lower = h - error;
    if (c.lower <= upper_) candidates_.push_back(c);
    upper_ = std::min(upper_, h + error);
    return 1;
  }

  int facets() {
    const double error = 1024 * kUlp * pair_.magnitude();
    for (std::size_t f = 0; f < pair_.a().facets.size(); ++f) {
      const Vec3 n = -pair_.rounded_a().facet_normals[f];
      if (consider({Candidate::Kind::facet_of_a, static_cast<int>(f), 0, 1, 0}, n, error) < 0) return -1;
    }
    for (std::size_t f = 0; f < pair_.b().facets.size(); ++f) {
      const Vec3& n = pair_.rounded_b().facet_normals[f];
      if (consider({Candidate::Kind::facet_of_b, static_cast<int>(f), 0, 1, 0}, n, error) < 0) return -1;
    }
    return 1;
  }

  int edges() {
    const Body& a = pair_.a();
    const Body& b = pair_.b();
    if (a.edges.empty() || b.edges.empty()) return 1;
    a_facets_.fill(pair_.rounded_a().facet_normals, pair_.rounded_b().edge_units);
    b_facets_.fill(pair_.rounded_b().facet_normals, pair_.rounded_a().edge_units);
    // A direction of A's edges and one of B's give one normal: it need not be looked at twice.
    seen_.assign(static_cast<std::size_t>(a.num_directions) * b.num_directions, 0);
    const std::size_t words = (b.edges.size() + 63) / 64;
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
      const Body::Edge& e = a.edges[i];
      for (std::size_t w = 0; w < words; ++w) {
        std::uint64_t bits = a_facets_.crossing(e.left, e.right, w);
        if (w + 1 == words && b.edges.size() % 64 != 0) bits &= (std::uint64_t{1} << (b.edges.size() % 64)) - 1;
        while (bits != 0) {
          const std::size_t j = w * 64 + static_cast<std::size_t>(__builtin_ctzll(bits));
          bits &= bits - 1;
          const Body::Edge& f = b.edges[j];
          if (((b_facets_.crossing(f.left, f.right, i / 64) >> (i % 64)) & 1) == 0) continue;
          if (edge_pair(static_cast<int>(i), static_cast<int>(j)) < 0) return -1;
        }
      }
    }
    return 1;
  }

  int edge_pair(int i, int j) {
    const Body::Edge& e = pair_.a().edges[i];
    const Body::Edge& f = pair_.b().edges[j];
    char& seen = seen_[static_cast<std::size_t>(e.direction) * pair_.b().num_directions + f.direction];
    if (seen == 3) return 1;
    const Vec3 c = pair_.rounded_a().edge_units[i].cross(pair_.rounded_b().edge_units[j]);
    const double sine = c.norm();
    if (sine < 0x1p-40) {
      seen = 3;
      const Candidate plus{Candidate::Kind::edges, i, j, 1, -std::numeric_limits<double>::infinity()};
      if (is_zero(exact_normal(pair_, plus))) return 1;  // exactly parallel: no facet of its own
      candidates_.push_back(plus);
      candidates_.push_back({Candidate::Kind::edges, i, j, -1, plus.lower});
      return 1;
    }
    const Vec3 unit = c / sine;
    const double normal_error = 256 * kUlp / sine;
    const double error = (1024 * kUlp + 4 * normal_error) * pair_.magnitude();
    for (const int sign : {1, -1}) {
      const char bit = sign > 0 ? 1 : 2;
      if ((seen & bit) != 0) continue;
      const Vec3 n = sign * unit;
      // n must lie inside both arcs, not opposite to one of them.
      if (e.left >= 0) {
        const auto& normals = pair_.rounded_a().facet_normals;
        if (n.dot(normals[e.left] + normals[e.right]) > 4 * normal_error) continue;
      }
      if (f.left >= 0) {
        const auto& normals = pair_.rounded_b().facet_normals;
        if (n.dot(normals[f.left] + normals[f.right]) < -4 * normal_error) continue;
      }
      seen = static_cast<char>(seen | bit);
      if (consider({Candidate::Kind::edges, i, j, sign, 0}, n, error) < 0) return -1;
    }
    return 1;
  }

  /// A candidate with its normal exact and as accurate as a double can be.
  struct Sharp {
    IVec normal;
    Vec3 unit;
    double lower;
  };

  /// Leaves out what is certainly not least, in quadruple precision. Returns -1 when a candidate separates for certain.
  int discard(std::vector<Sharp>& sharp) const {
    QuadFilter quad(pair_);
    if (filtering_ == QuadFiltering::wide_coordinates && quad.unit_exponent() < kWide) return 1;
    std::vector<std::optional<SquaredHeight>> heights;
    heights.reserve(sharp.size());
    std::optional<Quad> least;
    for (const Sharp& s : sharp) {
      heights.push_back(quad.squared_height(s.normal, s.unit));
      const auto& height = heights.back();
      if (!height) continue;
      if (height->negative) return -1;
      if (!least || height->upper < *least) least = height->upper;
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < sharp.size(); ++k) {
      if (heights[k] && heights[k]->lower > *least) continue;
      if (kept != k) sharp[kept] = std::move(sharp[k]);
      ++kept;
    }
    sharp.resize(kept);
    return 1;
  }

  int decide(Verdict& verdict) {
    // Accurate normals first (exact cross product, then rounded): near-parallel edges lose their large error bounds.
    const double error = 1024 * kUlp * pair_.magnitude();
    std::vector<Sharp> sharp;
    double upper = upper_;
    for (const Candidate& c : candidates_) {
      if (c.lower > upper) continue;
      Sharp s{exact_normal(pair_, c), {}, 0};
      s.unit = to_unit(s.normal);
      const double h = pair_.support(s.unit);
      if (h + error < 0) return -1;
      s.lower = h - error;
      upper = std::min(upper, h + error);
      if (s.lower <= upper) sharp.push_back(std::move(s));
    }
    std::erase_if(sharp, [&](const Sharp& s) { return s.lower > upper; });
    std::sort(sharp.begin(), sharp.end(), [](const Sharp& p, const Sharp& q) { return p.lower < q.lower; });
    if (filtering_ != QuadFiltering::never && sharp.size() > 1 && discard(sharp) < 0) return -1;
    Integer best_h;
    Integer best_n2;
    for (const Sharp& s : sharp) {
      bool repeated = false;
      for (std::size_t k = 0; k < verdict.normals.size() && !repeated; ++k) {
        repeated = verdict.unit_normals[k].dot(s.unit) > 0 &&
                   verdict.unit_normals[k].cross(s.unit).squaredNorm() < 0x1p-80 &&
                   is_zero(cross(verdict.normals[k], s.normal));
      }
      if (repeated) continue;
      Integer h = pair_.exact_support(s.normal, s.unit);
      if (h.sign() < 0) return -1;
      Integer n2 = dot(s.normal, s.normal);
      verdict.compared_exactly += !verdict.normals.empty();
      const int order = verdict.normals.empty() ? -1 : (h * h * best_n2 - best_h * best_h * n2).sign();
      if (order > 0) continue;
      if (order < 0) {
        verdict.normals.clear();
        verdict.unit_normals.clear();
        best_h = std::move(h);
        best_n2 = std::move(n2);
      }
      verdict.normals.push_back(s.normal);
      verdict.unit_normals.push_back(s.unit);
    }
    verdict.depth = pair_.length(best_h * best_h, best_n2);
    return best_h.sign();
  }

  const ExactPair& pair_;
  QuadFiltering filtering_;
  double upper_ = std::numeric_limits<double>::infinity();
  std::vector<Candidate> candidates_;
  std::vector<char> seen_;
  SideBits a_facets_;
  SideBits b_facets_;
};

}  // namespace

Verdict judge(const ExactPair& pair, const JudgeSettings& settings) {
  Verdict verdict;
  verdict.flat_difference = pair.flat_difference();
  if (verdict.flat_difference) {
    verdict.distance_known = exact_distance(pair, verdict.distance);
    verdict.contact = verdict.distance.numerator.is_zero() ? ContactClass::touching : ContactClass::separated;
    return verdict;
  }
  const int sign = Search(pair, settings.quad_filtering).run(verdict);
  verdict.contact = sign > 0 ? ContactClass::overlapping : sign == 0 ? ContactClass::touching : ContactClass::separated;
  if (sign < 0) {
    verdict.normals.clear();
    verdict.unit_normals.clear();
    verdict.depth = {};
    if (settings.distance) verdict.distance_known = exact_distance(pair, verdict.distance);
  }
  return verdict;
}

bool interiors_disjoint(const ExactPair& pair, const std::vector<IVec>& likely_normals) {
  for (const IVec& n : likely_normals) {
    if (pair.exact_support(n, to_unit(n)).sign() <= 0) return true;
  }
  return judge(pair, {.distance = false}).contact != ContactClass::overlapping;
}

}  // namespace pd::oracle
