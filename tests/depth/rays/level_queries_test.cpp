/// @file
/// [D] Lemma 5.3 and Corollary 5.5 for every level of a hierarchy: points, segments and bodies of up to 9 vertices that
/// move along a direction, against a brute force of whole numbers.
///
/// The moved body S + t d meets the interior of a level's polytope A where n . t d < max n.a - min n.s for every normal
/// n of a facet of A - S. Those are among the normals of triples of A, of triples of S, and of a pair of each: all of
/// them are tried, whether facets or not, since the inequality holds for any n.
#include "pd/depth/level_queries.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "oracle/wanted_cases.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using Whole = std::int64_t;
__extension__ using Wide = __int128;
struct Whole3 {
  Whole x, y, z;
};
Whole dot(const Whole3& u, const Whole3& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
Whole3 minus(const Whole3& u, const Whole3& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
Whole3 cross(const Whole3& u, const Whole3& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}
Whole3 whole(const Vec3& v) {
  return {static_cast<Whole>(v.x()), static_cast<Whole>(v.y()), static_cast<Whole>(v.z())};
}
std::vector<Whole3> whole(const scenes::Points& points) {
  std::vector<Whole3> out;
  for (const Vec3& p : points) out.push_back(whole(p));
  return out;
}

/// max n . p.
Whole reach(const std::vector<Whole3>& points, const Whole3& n) {
  Whole most = std::numeric_limits<Whole>::min();
  for (const Whole3& p : points) most = std::max(most, dot(n, p));
  return most;
}

struct Quotient {
  Wide numerator, denominator;  ///< the latter positive
};
bool less(const Quotient& a, const Quotient& b) { return a.numerator * b.denominator < b.numerator * a.denominator; }

/// The open interval of t, nothing where it is empty.
class Sweep {
 public:
  explicit Sweep(const Whole3& d) : d_(d) {}
  /// n . t d < offset, and for -n likewise.
  void cut(const Whole3& n, Whole offset) {
    const Whole slope = dot(n, d_);
    if (slope == 0) {
      empty_ = empty_ || offset <= 0;
      return;
    }
    const Quotient q{slope > 0 ? offset : -offset, slope > 0 ? slope : -slope};
    if (slope > 0 && (!leave_ || less(q, *leave_))) leave_ = q;
    if (slope < 0 && (!enter_ || less(*enter_, q))) enter_ = q;
  }
  [[nodiscard]] bool meets() const { return !empty_ && less(*enter_, *leave_); }
  [[nodiscard]] const Quotient& enter() const { return *enter_; }
  [[nodiscard]] const Quotient& leave() const { return *leave_; }

 private:
  Whole3 d_;
  bool empty_ = false;
  std::optional<Quotient> enter_, leave_;
};

/// A level's polytope: its points, and the normals of all triples with how far it reaches along them.
struct Level {
  struct Normal {
    Whole3 n;
    Whole reach;
  };
  std::vector<Whole3> points;
  std::vector<Normal> normals;

  explicit Level(std::vector<Whole3> p) : points(std::move(p)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = i + 1; j < points.size(); ++j) {
        for (std::size_t k = j + 1; k < points.size(); ++k) {
          const Whole3 n = cross(minus(points[j], points[i]), minus(points[k], points[i]));
          if (n.x == 0 && n.y == 0 && n.z == 0) continue;
          for (const Whole3& way : {n, minus({0, 0, 0}, n)}) {
            // Only a facet of A bounds A - S with A's own normal.
            if (reach(points, way) == dot(way, points[i])) normals.push_back({way, dot(way, points[i])});
          }
        }
      }
    }
  }

  [[nodiscard]] Sweep sweep(const std::vector<Whole3>& small, const Whole3& d) const {
    Sweep out(d);
    const auto cut = [&](const Whole3& n) {
      if (n.x == 0 && n.y == 0 && n.z == 0) return;
      for (const Whole3& way : {n, minus({0, 0, 0}, n)}) {
        out.cut(way, reach(points, way) + reach(small, minus({0, 0, 0}, way)));
      }
    };
    for (const Normal& normal : normals) {
      out.cut(normal.n, normal.reach + reach(small, minus({0, 0, 0}, normal.n)));
    }
    for (std::size_t i = 0; i < small.size(); ++i) {
      for (std::size_t j = i + 1; j < small.size(); ++j) {
        const Whole3 edge = minus(small[j], small[i]);
        for (std::size_t k = j + 1; k < small.size(); ++k) cut(cross(edge, minus(small[k], small[i])));
        for (std::size_t a = 0; a < points.size(); ++a) {
          for (std::size_t b = a + 1; b < points.size(); ++b) cut(cross(edge, minus(points[b], points[a])));
        }
      }
    }
    return out;
  }
};

/// lower <= q |d| <= upper, to what a quotient and a root of long doubles err by, and no double between them.
void expect_bracket(double lower, double upper, const Quotient& q, const Whole3& d) {
  const long double value = static_cast<long double>(q.numerator) / static_cast<long double>(q.denominator) *
                            std::sqrt(static_cast<long double>(dot(d, d)));
  const long double slack = 1e-18L * std::abs(value);
  EXPECT_LE(lower, value + slack);
  EXPECT_GE(upper, value - slack);
  EXPECT_LE(upper, std::nextafter(lower, std::numeric_limits<double>::infinity()));
}

scenes::Points whole_points(int n, int range, scenes::Random& random) {
  scenes::Points points;
  for (int i = 0; i < n; ++i) {
    points.push_back(random.integer_point(-range, range));
  }
  return points;
}

/// Points of a sphere's shell, so that nearly all of them are vertices.
scenes::Points whole_shell(int n, int range, scenes::Random& random) {
  scenes::Points points;
  for (int i = 0; i < n; ++i) points.push_back((range * random.direction()).array().round().matrix());
  return points;
}

TEST(LevelQueries, PointsSegmentsAndSmallBodiesAtEveryLevelAgainstWholeNumbers) {
  const int moves = test::wanted_cases("PD_LEVEL_LINES", 12);
  scenes::Random random(test::wanted_seed(73));
  int met = 0, missed = 0, grazed = 0, coarse = 0, segments = 0;
  for (const int range : {3, 20, 300}) {
    for (const int n : {8, 16, 32}) {
      const auto points = range == 3 ? whole_points(n, range, random) : whole_shell(n, range, random);
      const ConvexPolytope body = *ConvexPolytope::from_points(points);
      ASSERT_EQ(body.affine_dimension(), 3);
      const PolyhedralHierarchy hierarchy = *PolyhedralHierarchy::build(body, HierarchyKind::inner);
      for (int i = 0; i < static_cast<int>(hierarchy.levels().size()); ++i) {
        scenes::Points left;
        for (int v = 0; v < body.num_vertices(); ++v) {
          if (hierarchy.last_level(v) >= i) left.push_back(body.vertex(v));
        }
        const Level level(whole(left));
        for (int k = 0; k < moves && !testing::Test::HasFailure(); ++k) {
          SCOPED_TRACE(testing::Message() << range << " " << n << " level " << i << " move " << k);
          const int size = k % 4 == 3 ? random.integer(3, 9) : (k % 4 == 2 ? 1 : 2);
          scenes::Points small = whole_points(size, std::max(1, range / 2), random);
          const Vec3 away =
              Eigen::Vector3i{random.integer(-range, range), random.integer(-range, range), 0}.cast<double>();
          for (Vec3& p : small) p += away;
          Vec3 d = random.integer_point(-range, range);
          if (d.isZero(0)) d.x() = 1;
          const ConvexPolytope moved = *ConvexPolytope::from_points(small);
          const LevelCrossing found = *crossing_of_level(hierarchy, i, moved, d);
          const Sweep expected = level.sweep(whole(small), whole(d));
          ASSERT_EQ(found.meets, expected.meets());
          coarse += i > 0 ? 1 : 0;
          segments += moved.num_vertices() == 2 ? 1 : 0;
          if (!found.meets) {
            ++missed;
            continue;
          }
          ++met;
          grazed += found.leave_upper - found.enter_lower < 0.05 * range ? 1 : 0;
          expect_bracket(found.enter_lower, found.enter_upper, expected.enter(), whole(d));
          expect_bracket(found.leave_lower, found.leave_upper, expected.leave(), whole(d));
        }
      }
    }
  }
  RecordProperty("moves", met + missed);
  RecordProperty("segments", segments);
  EXPECT_GT(met, 10 * moves);
  EXPECT_GT(missed, 3 * moves);
  EXPECT_GT(grazed, 0);
  EXPECT_GT(coarse, 20 * moves);
  EXPECT_GT(segments, 10 * moves);
}

}  // namespace
}  // namespace pd
