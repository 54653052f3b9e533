// Polygons whose rings touch in single points: which of them are polygons, by areas and connected pieces, and what they
// are answered, by the oracle that tries everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "pd/planar/polygon_depth.hpp"
#include "planar/polygon_oracle.hpp"
#include "planar/small_polygons.hpp"

namespace {

using oracle::Rings;
using oracle::Vec;
using pd::ErrorCode;
using pd::Leave;
using pd::PlanarContact;
using pd::Point2;
using pd::Polygon;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::test::made;
using pd::test::SmallPolygons;
using pd::test::text;

double cross(const Vec& a, const Vec& b, const Vec& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The plane in vertical slabs between the places where rings bend or cross: what lies inside an odd number of rings.
class Slabs {
 public:
  explicit Slabs(const Rings& rings) {
    for (const auto& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) edges_.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      places_.push_back(edges_[i][0][0]);
      for (std::size_t j = 0; j < i; ++j) add_crossing(edges_[i], edges_[j]);
    }
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end(), [](double a, double b) { return b - a < 1e-9; }),
                  places_.end());
    for (std::size_t k = 0; k + 1 < places_.size(); ++k) add_slab(places_[k], places_[k + 1]);
  }
  [[nodiscard]] double area() const { return area_; }
  /// Parts of the inside that are connected through more than points.
  [[nodiscard]] int parts() const {
    std::vector<std::size_t> root(cells_.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      for (std::size_t j = 0; j < cells_.size(); ++j) {
        if (cells_[i].right != cells_[j].left) continue;
        if (std::min(cells_[i].at_right[1], cells_[j].at_left[1]) -
                std::max(cells_[i].at_right[0], cells_[j].at_left[0]) >
            1e-9) {
          root[find(i)] = find(j);
        }
      }
    }
    int count = 0;
    for (std::size_t i = 0; i < root.size(); ++i) count += root[i] == i ? 1 : 0;
    return count;
  }

 private:
  using Edge = std::array<Vec, 2>;
  struct Cell {
    double left, right;
    std::array<double, 2> at_left, at_right;
  };

  void add_crossing(const Edge& e, const Edge& f) {
    const double at_f = cross(e[0], e[1], f[0]), at_g = cross(e[0], e[1], f[1]);
    if (at_f == at_g || at_f * at_g > 0 || cross(f[0], f[1], e[0]) * cross(f[0], f[1], e[1]) > 0) return;
    places_.push_back(f[0][0] + at_f / (at_f - at_g) * (f[1][0] - f[0][0]));
  }
  void add_slab(double left, double right) {
    const auto height = [](const Edge& e, double x) {
      return e[0][1] + (x - e[0][0]) / (e[1][0] - e[0][0]) * (e[1][1] - e[0][1]);
    };
    const double middle = 0.5 * (left + right);
    std::vector<Edge> here;
    for (const Edge& e : edges_) {
      if (std::min(e[0][0], e[1][0]) < middle && std::max(e[0][0], e[1][0]) > middle) here.push_back(e);
    }
    std::sort(here.begin(), here.end(),
              [&](const Edge& a, const Edge& b) { return height(a, middle) < height(b, middle); });
    for (std::size_t i = 0; i + 1 < here.size(); i += 2) {
      const Edge &a = here[i], &b = here[i + 1];
      area_ += (right - left) * (height(b, middle) - height(a, middle));
      cells_.push_back({left, right, {height(a, left), height(b, left)}, {height(a, right), height(b, right)}});
    }
  }

  std::vector<Edge> edges_;
  std::vector<double> places_;
  std::vector<Cell> cells_;
  double area_ = 0;
};

bool share_a_segment(const Rings& rings) {
  std::vector<std::array<Vec, 2>> edges;
  for (const auto& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto &e = edges[i], &f = edges[j];
      if (cross(e[0], e[1], f[0]) != 0 || cross(e[0], e[1], f[1]) != 0) continue;
      if (std::max(std::min(e[0], e[1]), std::min(f[0], f[1])) < std::min(std::max(e[0], e[1]), std::max(f[0], f[1]))) {
        return true;
      }
    }
  }
  return false;
}

/// Rings that are simple each, by their areas: holes lie in the outer ring and beside each other.
bool is_polygon(const Rings& rings) {
  if (share_a_segment(rings)) return false;
  double area = Slabs({rings[0]}).area();
  for (std::size_t h = 1; h < rings.size(); ++h) {
    const double hole = Slabs({rings[h]}).area();
    if (std::abs(Slabs({rings[0], rings[h]}).area() - (Slabs({rings[0]}).area() - hole)) > 1e-9) return false;
    for (std::size_t g = 1; g < h; ++g) {
      if (std::abs(Slabs({rings[g], rings[h]}).area() - (Slabs({rings[g]}).area() + hole)) > 1e-9) return false;
    }
    area -= hole;
  }
  const Slabs all(rings);
  return std::abs(all.area() - area) < 1e-9 && all.parts() == 1;
}

Rings frame_with(const std::vector<std::vector<Vec>>& holes) {
  Rings rings = {{{0, 0}, {8, 0}, {8, 8}, {0, 8}}};
  rings.insert(rings.end(), holes.begin(), holes.end());
  return rings;
}

void expect_refused(const Rings& rings, const std::string& where, const std::string& words) {
  const auto polygon = Polygon::from_rings(rings[0], std::vector<std::vector<Point2>>(rings.begin() + 1, rings.end()));
  ASSERT_FALSE(polygon.has_value()) << text(rings);
  EXPECT_EQ(polygon.error().code, ErrorCode::bad_value);
  EXPECT_EQ(polygon.error().where, where) << polygon.error().message;
  EXPECT_NE(polygon.error().message.find(words), std::string::npos) << polygon.error().message;
}

TEST(TouchingRings, PointsAreSharedAndSegmentsAreNot) {
  const Polygon on_edge = made(frame_with({{{4, 0}, {5, 2}, {3, 2}}}));  // a corner on the middle of an edge
  EXPECT_EQ(on_edge.num_vertices(), 8);                                  // the edge is two
  EXPECT_EQ(on_edge.num_rings(), 2);
  const Polygon on_vertex = made(frame_with({{{0, 0}, {3, 2}, {2, 3}}}));
  EXPECT_EQ(on_vertex.num_vertices(), 7);
  const Polygon chain =
      made(frame_with({{{2, 2}, {4, 3}, {2, 4}}, {{4, 3}, {6, 2}, {6, 4}}, {{6, 4}, {7, 6}, {5, 6}}}));
  EXPECT_EQ(chain.num_rings(), 4);
  int shared = 0;
  for (int v = 0; v < chain.num_vertices(); ++v) shared += chain.next_here(v) != v ? 1 : 0;
  EXPECT_EQ(shared, 4);

  expect_refused(frame_with({{{2, 0}, {5, 0}, {3, 2}}}), "holes[0][0]", "overlap along a segment");
  expect_refused(frame_with({{{1, 1}, {3, 1}, {2, 3}}, {{2, 1}, {4, 1}, {4, 0.5}}}), "holes[1][0]", "overlap");
  expect_refused(frame_with({{{8, 2}, {10, 1}, {10, 3}}}), "holes[0][0]", "outside");
  expect_refused(frame_with({{{1, 1}, {7, 4}, {1, 7}}, {{1, 1}, {3, 3}, {2, 4}}}), "holes[1][0]",
                 "holes[1] starts inside holes[0];");
  expect_refused(frame_with({{{4, -1}, {5, 0}, {4, 2}, {3, 0}}}), "outer[0]", "cross");  // through its own vertices
}

TEST(TouchingRings, AnInteriorInTwoPartsIsRefused) {
  expect_refused(frame_with({{{0, 0}, {4, 3}, {8, 8}, {3, 4}}}), "holes[0][3]", "cut in two");
  expect_refused(frame_with({{{0, 4}, {2, 3}, {3, 4}, {2, 5}}, {{3, 4}, {5, 3}, {8, 4}, {5, 5}}}), "holes[1][3]",
                 "cut in two");
  // Three holes around a triangle: each touches the two others.
  expect_refused(frame_with({{{2, 2}, {6, 2}, {4, 1}}, {{6, 2}, {4, 6}, {7, 5}}, {{4, 6}, {2, 2}, {1, 5}}}),
                 "holes[1][0]", "cut in two");
  // With a way through, the interior is connected again.
  EXPECT_EQ(
      made(frame_with({{{2, 2}, {6, 2}, {4, 1}}, {{6, 2}, {4, 6}, {7, 5}}, {{4, 6}, {2, 3}, {1, 5}}})).num_rings(), 4);
}

// Rings that are simple each, at random on a lattice: refused or not as areas and connected parts tell.
TEST(TouchingRings, ArePolygonsWhereAreasAndPartsSaySo) {
  SmallPolygons next(42);
  int taken = 0, refused = 0;
  for (int i = 0; i < pd::test::planar_cases(250); ++i) {
    const int grid = next.whole(4, 8);
    const double side = grid;
    Rings rings = {{{0, 0}, {side, 0}, {side, side}, {0, side}}};
    if (i % 3 == 0) rings = next.simple(6, grid, false);
    for (int tries = 0; tries < 6; ++tries) {
      Rings with = rings;
      with.push_back(next.hole_at(rings, grid));
      if (!Polygon::from_rings(with.back())) continue;
      const bool found =
          Polygon::from_rings(with[0], std::vector<std::vector<Point2>>(with.begin() + 1, with.end())).has_value();
      ASSERT_EQ(found, is_polygon(with)) << text(with);
      ++(found ? taken : refused);
      if (found) rings = with;
    }
  }
  EXPECT_GT(taken, pd::test::planar_cases(250) / 4);
  EXPECT_GT(refused, taken);
}

void expect_near(double value, const pd::PolygonDepth& answer, const std::string& what) {
  EXPECT_NEAR(answer.depth, value, 1e-8) << what;
  EXPECT_TRUE(answer.upper == answer.lower || answer.upper == std::nextafter(answer.lower, 1e300)) << what;
}

void judge(const Rings& p, const Rings& q, SmallPolygons& next, PolygonMethod method) {
  const PolygonDifference r = *PolygonDifference::of(made(p), made(q), method);
  const oracle::PolygonOracle truth(p, q);
  for (int i = 0; i < 2; ++i) {
    const Point2 y = {next.eighths(-2, 6), next.eighths(-2, 6)};
    const Point2 d = {double(next.whole(-3, 3)), double(next.whole(1, 3))};
    const std::string what = "p " + text(p) + " q " + text(q) + " y " + std::to_string(y[0]) + "," +
                             std::to_string(y[1]) + " d " + std::to_string(d[0]) + "," + std::to_string(d[1]);
    const pd::PolygonDepth deep = r.depth(y);
    EXPECT_EQ(to_string(deep.contact), truth.contact(y)) << what;
    expect_near(deep.contact == PlanarContact::overlapping ? truth.depth(y) : 0, deep, "depth " + what);
    expect_near(truth.depth_along(y, d), r.depth_along(y, d), "along " + what);
    expect_near(truth.straight_exit(y, d), r.depth_along(y, d, Leave::straight), "straight " + what);
  }
  EXPECT_TRUE(r.statistics().facts_hold) << text(p) << " q " << text(q);
}

TEST(TouchingRings, ImplicitAgainstTheOracle) {
  SmallPolygons next(20261127);
  for (int i = 0; i < pd::test::planar_cases(60) && !HasFailure(); ++i) {
    const int grid = next.whole(3, 6);
    judge(next.touching(grid), next.convex(5, next.whole(1, grid)), next, PolygonMethod::implicit);
  }
}

TEST(TouchingRings, ExplicitAgainstTheOracle) {
  SmallPolygons next(27);
  for (int i = 0; i < pd::test::planar_cases(20) && !HasFailure(); ++i) {
    const int grid = next.whole(3, 5);
    const Rings p = next.touching(grid), q = i % 2 == 0 ? next.touching(3) : next.simple(5, next.whole(2, grid), false);
    judge(p, q, next, PolygonMethod::explicit_sums);
  }
}

TEST(TouchingRings, MethodsGiveTheSameBits) {
  SmallPolygons next(28);
  for (int i = 0; i < pd::test::planar_cases(150); ++i) {
    const int grid = next.whole(3, 9);
    const Rings rings_p = next.touching(grid), rings_q = next.convex(6, next.whole(1, grid));
    const Polygon p = made(rings_p), q = made(rings_q);
    const auto a = *PolygonDifference::of(p, q, PolygonMethod::implicit);
    const auto b = *PolygonDifference::of(p, q, PolygonMethod::explicit_sums);
    ASSERT_TRUE(a.statistics().facts_hold) << text(rings_p) << " q " << text(rings_q);
    ASSERT_EQ(a.statistics().loops, b.statistics().loops) << text(rings_p) << " q " << text(rings_q);
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(0, 6), next.eighths(0, 6)}, d = {next.eighths(-3, 3), next.eighths(1, 2)};
      for (const auto& [x, z] : {std::pair{a.depth(y), b.depth(y)},
                                 {a.depth_along(y, d), b.depth_along(y, d)},
                                 {a.depth_along(y, d, Leave::escape), b.depth_along(y, d, Leave::escape)},
                                 {a.depth_along(y, d, Leave::straight), b.depth_along(y, d, Leave::straight)}}) {
        const bool same =
            x.contact == z.contact && x.lower == z.lower && x.upper == z.upper && x.translation == z.translation;
        ASSERT_TRUE(same) << text(rings_p) << " q " << text(rings_q) << " y " << y[0] << "," << y[1] << ": " << x.depth
                          << " and " << z.depth;
      }
    }
  }
}

// Holes that shrink a little no longer touch: the answers move no farther.
TEST(TouchingRings, HolesThatShrinkChangeLittle) {
  SmallPolygons next(29);
  int compared = 0;
  for (int i = 0; i < pd::test::planar_cases(80); ++i) {
    const Rings touching = next.touching(6), q = next.convex(4, 3);
    Rings shrunk = touching;
    const auto is_triangle = [](const std::vector<Vec>& ring) { return ring.size() == 3; };
    if (!std::all_of(shrunk.begin() + 1, shrunk.end(), is_triangle)) continue;
    for (std::size_t h = 1; h < shrunk.size(); ++h) {
      const auto& t = touching[h];
      const Vec middle = {(t[0][0] + t[1][0] + t[2][0]) / 3, (t[0][1] + t[1][1] + t[2][1]) / 3};
      for (Vec& x : shrunk[h]) x = {x[0] + 1e-9 * (middle[0] - x[0]), x[1] + 1e-9 * (middle[1] - x[1])};
    }
    const auto a = *PolygonDifference::of(made(touching), made(q)), b = *PolygonDifference::of(made(shrunk), made(q));
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(0, 6), next.eighths(0, 6)};
      ASSERT_NEAR(a.depth(y).depth, b.depth(y).depth, 1e-6) << text(touching) << " q " << text(q);
      ASSERT_NEAR(a.escape_depth(y).depth, b.escape_depth(y).depth, 1e-6) << text(touching) << " q " << text(q);
      ++compared;
    }
  }
  EXPECT_GT(compared, pd::test::planar_cases(80));
}

TEST(TouchingRings, FeaturesNameTheTouchedEdge) {
  const Rings rings = frame_with({{{4, 0}, {5, 2}, {3, 2}}});
  const auto r = *PolygonDifference::of(made(rings), made({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}));
  const pd::PolygonDepth answer = r.depth({6, -0.5});
  EXPECT_EQ(answer.depth, 0.5);
  ASSERT_TRUE(answer.feature && answer.feature->p_edge);
  EXPECT_EQ(answer.feature->p, (Polygon::VertexId{-1, 0}));
}

}  // namespace
