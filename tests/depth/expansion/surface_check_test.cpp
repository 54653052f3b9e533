/// @file
/// The invariants of an expanding polytope: sound surfaces keep them while they grow, and each rule notices what breaks
/// it.

#include "depth/expansion/surface_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "depth/expansion/exact_hull.hpp"
#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {
namespace {

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3{normal(random), normal(random), normal(random)}.normalized();
}

/// A tetrahedron around the origin, then points on the sphere, inserted where they are seen.
void grow(InnerSurface& surface, int points, std::mt19937_64& random, const std::function<void()>& after_each) {
  surface.clear();
  for (const Vec3& x : {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}) {
    surface.vertices.push_back({x.normalized(), 0, 0});
  }
  ASSERT_TRUE(surface.start_tetrahedron(1e-12));
  after_each();
  for (int i = 4; i < points; ++i) {
    const Vec3 x = random_direction(random);
    surface.vertices.push_back({x, i, i});
    for (int f = 0; f < surface.slots(); ++f) {
      if (surface.key(f) == InnerSurface::kRemoved) continue;
      if (surface.normal(f).dot(x - surface.vertices[surface.face(f).v[0]].x) <= 1e-9) continue;
      ASSERT_TRUE(surface.insert(f, static_cast<int>(surface.vertices.size()) - 1));
      break;
    }
    after_each();
  }
}

SurfaceSnapshot sound_surface() {
  std::mt19937_64 random(5);
  InnerSurface surface;
  grow(surface, 20, random, [] {});
  SurfaceSnapshot all;
  surface.snapshot(all);
  return all;
}

TEST(SurfaceCheck, GrowingSurfacesKeepEveryRule) {
  InnerSurface surface;
  // Past the sizes where slots are taken from a list and where the nearest face comes from a heap.
  for (const int points : {8, 40, 400}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(points));
    grow(surface, points, random, [&] {
      const auto fault = surface.validate();
      ASSERT_FALSE(fault) << to_string(fault->rule) << " at face " << fault->face << " of " << surface.size();
    });
    SurfaceSnapshot all;
    surface.snapshot(all);
    EXPECT_EQ(static_cast<int>(all.faces.size()), 2 * points - 4);
    EXPECT_FALSE(find_fault(all, true)) << "points of a sphere lie all on their hull";
  }
}

TEST(SurfaceCheck, TheOriginMayStillBeOutside) {
  SurfaceSnapshot all = sound_surface();
  for (Vec3& x : all.points) x += Vec3(2, 0, 0);
  for (SurfaceSnapshot::Face& f : all.faces) {
    f.distance = f.normal.dot(all.points[static_cast<std::size_t>(f.v[0])]) / f.normal.norm() - 1e-12;
  }
  const auto nearest = std::min_element(all.faces.begin(), all.faces.end(),
                                        [](const auto& x, const auto& y) { return x.distance < y.distance; });
  all.nearest = static_cast<int>(nearest - all.faces.begin());
  ASSERT_LT(nearest->distance, 0);
  EXPECT_FALSE(find_fault(all, true));
}

void expect_broken(const SurfaceSnapshot& surface, SurfaceRule rule, bool convex = false) {
  const auto fault = find_fault(surface, convex);
  ASSERT_TRUE(fault) << to_string(rule);
  EXPECT_EQ(fault->rule, rule) << to_string(fault->rule);
}

TEST(SurfaceCheck, NoticesBrokenLinks) {
  SurfaceSnapshot all = sound_surface();
  std::swap(all.faces[3].adj[0], all.faces[3].adj[1]);
  expect_broken(all, SurfaceRule::links);
  all = sound_surface();
  all.faces[7].adj[2] = 4 * static_cast<int>(all.faces.size());
  expect_broken(all, SurfaceRule::links);
  all = sound_surface();
  all.faces[7].v[2] = static_cast<int>(all.points.size());
  expect_broken(all, SurfaceRule::links);
  all = sound_surface();
  all.faces[0].adj[1] = -1;
  expect_broken(all, SurfaceRule::links);
}

TEST(SurfaceCheck, NoticesAFaceTurnedOver) {
  SurfaceSnapshot all = sound_surface();
  // Its neighbours still point at the edges where they were.
  std::swap(all.faces[4].v[0], all.faces[4].v[1]);
  expect_broken(all, SurfaceRule::senses);
  all = sound_surface();
  all.faces[4].v[1] = all.faces[4].v[0];
  expect_broken(all, SurfaceRule::senses);
}

TEST(SurfaceCheck, NoticesADistanceThatIsNoLowerBound) {
  SurfaceSnapshot all = sound_surface();
  all.faces[5].distance *= 1 + 0x1p-40;
  expect_broken(all, SurfaceRule::keys);
  all = sound_surface();
  // A normal that is not across the face: its corners no longer lie that far along it.
  all.faces[5].normal += 0.01 * all.faces[5].normal.unitOrthogonal() * all.faces[5].normal.norm();
  expect_broken(all, SurfaceRule::keys);
  all = sound_surface();
  all.points[6] *= 0.9;
  expect_broken(all, SurfaceRule::keys);
}

TEST(SurfaceCheck, NoticesANearerFace) {
  SurfaceSnapshot all = sound_surface();
  all.nearest = all.nearest == 0 ? 1 : 0;
  expect_broken(all, SurfaceRule::nearest);
  all.nearest = -1;
  expect_broken(all, SurfaceRule::nearest);
}

TEST(SurfaceCheck, NoticesASurfaceInsideOut) {
  SurfaceSnapshot all = sound_surface();
  // Every face turned over, with its links: closed and oriented, but it winds around the origin -1 times.
  for (SurfaceSnapshot::Face& f : all.faces) {
    std::swap(f.v[1], f.v[2]);
    std::swap(f.adj[0], f.adj[2]);
    for (std::int32_t& beyond : f.adj) {
      const std::int32_t e = beyond & 3;
      beyond = (beyond & ~3) + (e == 0 ? 2 : e == 2 ? 0 : 1);
    }
  }
  expect_broken(all, SurfaceRule::winding);
}

TEST(SurfaceCheck, NoticesADentWhereConvexityIsPromised) {
  SurfaceSnapshot all = sound_surface();
  all.points[9] *= 0.8;
  for (SurfaceSnapshot::Face& f : all.faces) {
    const auto at = [&](int i) { return all.points[static_cast<std::size_t>(f.v[i])]; };
    f.normal = (at(1) - at(0)).cross(at(2) - at(0));
    f.distance = f.normal.dot(at(0)) / f.normal.norm() - 1e-12;
  }
  const auto nearest = std::min_element(all.faces.begin(), all.faces.end(),
                                        [](const auto& x, const auto& y) { return x.distance < y.distance; });
  all.nearest = static_cast<int>(nearest - all.faces.begin());
  expect_broken(all, SurfaceRule::convex, true);
  EXPECT_FALSE(find_fault(all, false)) << "the surface in doubles does not promise convexity";
}

/// The product that tells on which side of a sliver the origin lies is all rounding: its sign must not count.
TEST(SurfaceCheck, TheOriginCloselyBehindASliver) {
  constexpr double kHalfWidth = 1e-8, kBelow = 1e-13;
  const Vec3 corners[4] = {
      {-1, -kHalfWidth, -kBelow}, {1, -kHalfWidth, -kBelow}, {0.5, kHalfWidth, -kBelow}, {0, 0, 1}};
  const std::int32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  std::mt19937_64 random(6);
  for (int round = 0; round < 100; ++round) {
    const Vec3 x = random_direction(random), y = x.cross(random_direction(random)).normalized(), z = x.cross(y);
    SurfaceSnapshot all;
    for (const Vec3& c : corners) all.points.push_back(c.x() * x + c.y() * y + c.z() * z);
    for (std::int32_t f = 0; f < 4; ++f) {
      SurfaceSnapshot::Face face{{faces[f][0], faces[f][1], faces[f][2]}, {}, {}, 0};
      for (std::int32_t e = 0; e < 3; ++e) {
        for (std::int32_t g = 0; g < 4; ++g) {
          for (std::int32_t h = 0; h < 3; ++h) {
            const bool across = faces[g][h] == faces[f][(e + 1) % 3] && faces[g][(h + 1) % 3] == faces[f][e];
            if (across) face.adj[e] = 4 * g + h;
          }
        }
      }
      // The sliver's normal is known; that of its corners would be rounding, too.
      const auto at = [&](int i) { return all.points[static_cast<std::size_t>(face.v[i])]; };
      face.normal = f == 0 ? Vec3(-z) : Vec3((at(1) - at(0)).cross(at(2) - at(0)));
      face.distance = f == 0 ? 0.5 * kBelow : 0.5 * face.normal.dot(at(0)) / face.normal.norm();
      ASSERT_GT(face.distance, 0);
      all.faces.push_back(face);
    }
    all.nearest = 0;
    const auto fault = find_fault(all, false);
    EXPECT_FALSE(fault) << to_string(fault->rule) << " at face " << fault->face << ", round " << round;
  }
}

TEST(ExactHull, StaysAConvexHullOfNearlyDegeneratePoints) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  ExactHull hull;
  int inserted = 0;
  for (int trial = 0; trial < 20; ++trial) {
    hull.clear();
    // Rims of a slender cylinder: faces along it are as long as it is and as wide as rounding.
    const double width = trial % 2 == 0 ? 1 : 1e-8;
    const auto point = [&](int i) {
      const double angle = width * std::numbers::pi * unit(random);
      return DifferenceVertex{{std::cos(angle), std::sin(angle), i % 2 == 0 ? 3.0 : -3.0}, i, i};
    };
    hull.vertices.push_back({{-1, 0, 3}, 0, 0});
    hull.vertices.push_back({{-1, 0.5, -3}, 0, 0});
    for (int i = 0; i < 4; ++i) hull.vertices.push_back(point(i));
    ASSERT_TRUE(hull.start());
    ASSERT_FALSE(hull.validate());
    for (int i = 4; i < 60; ++i) {
      hull.vertices.push_back(point(i));
      for (int f = 0; f < hull.slots(); ++f) {
        if (!hull.face(f).alive || !hull.insert(f)) continue;
        ++inserted;
        break;
      }
      const auto fault = hull.validate();
      ASSERT_FALSE(fault) << to_string(fault->rule) << " trial " << trial << " point " << i;
    }
  }
  EXPECT_GT(inserted, 200);
}

}  // namespace
}  // namespace pd::detail
