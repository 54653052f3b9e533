/// @file
/// Surfaces whose points have moved: rebuilding keeps them closed and oriented and makes them convex again.

#include "depth/expansion/inner_surface.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

#include "depth/expansion/cached_surface.hpp"

namespace pd::detail {
namespace {

using Cached = std::pair<std::vector<VertexPair>, std::vector<CachedFace>>;

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3{normal(random), normal(random), normal(random)}.normalized();
}

/// The hull of points on a sphere round the origin; a vertex' id is its point's index.
Cached hull_of_sphere(int points, std::mt19937_64& random, InnerSurface& surface, std::vector<Vec3>& at) {
  surface.clear();
  const Vec3 corners[4] = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  at.clear();
  for (int i = 0; i < points; ++i) {
    at.push_back(i < 4 ? corners[i].normalized() : random_direction(random));
    surface.vertices.push_back({at.back(), i, i});
  }
  EXPECT_TRUE(surface.start_tetrahedron(1e-12));
  for (int v = 4; v < points; ++v) {
    for (int f = 0; f < surface.slots(); ++f) {
      if (surface.key(f) == InnerSurface::kRemoved) continue;
      if (surface.normal(f).dot(surface.vertices[v].x - surface.vertices[surface.face(f).v[0]].x) <= 0) continue;
      EXPECT_TRUE(surface.insert(f, v));
      break;
    }
  }
  Cached cached;
  surface.save(cached.first, cached.second);
  return cached;
}

void restore(const Cached& cached, const std::vector<Vec3>& at, InnerSurface& surface) {
  surface.clear();
  for (const auto& v : cached.first) surface.vertices.push_back({at[static_cast<std::size_t>(v.a)], v.a, v.b});
  surface.restore(cached.second);
}

struct Shape {
  int faces = 0;
  int reflex = 0;  ///< edges
  double volume = 0;
  double least_key = InnerSurface::kRemoved;
  bool closed = true;
};

Shape measure(const InnerSurface& surface) {
  Shape out;
  std::map<std::pair<int, int>, int> edges;
  for (int f = 0; f < surface.slots(); ++f) {
    if (surface.key(f) == InnerSurface::kRemoved) continue;
    const SurfaceTriangle& face = surface.face(f);
    ++out.faces;
    out.least_key = std::min(out.least_key, surface.key(f));
    const Vec3& p = surface.vertices[face.v[0]].x;
    out.volume += p.dot(surface.vertices[face.v[1]].x.cross(surface.vertices[face.v[2]].x)) / 6;
    for (int e = 0; e < 3; ++e) {
      ++edges[{face.v[e], face.v[(e + 1) % 3]}];
      const SurfaceTriangle& other = surface.face(face.adj[e] >> 2);
      const int h = face.adj[e] & 3;
      out.closed &= surface.key(face.adj[e] >> 2) != InnerSurface::kRemoved && other.adj[h] == 4 * f + e &&
                    other.v[h] == face.v[(e + 1) % 3] && other.v[(h + 1) % 3] == face.v[e];
      const Vec3& apex = surface.vertices[other.v[(h + 2) % 3]].x;
      out.reflex += surface.normal(f).dot(apex - p) > 1e-12 ? 1 : 0;
    }
  }
  for (const auto& [edge, count] : edges) out.closed &= count == 1 && edges.count({edge.second, edge.first}) == 1;
  return out;
}

TEST(InnerSurface, RebuildsTheHullOfWhatMatters) {
  InnerSurface surface;
  std::vector<Vec3> at;
  for (int trial = 0; trial < 100; ++trial) {
    std::mt19937_64 random(static_cast<std::uint64_t>(trial) + 1);
    const int points = 5 + trial % 30;
    const Cached cached = hull_of_sphere(points, random, surface, at);
    for (Vec3& x : at) x += 0.4 * random_direction(random);
    restore(cached, at, surface);
    ASSERT_TRUE(surface.rebuild(1e-12)) << trial;
    const Shape rebuilt = measure(surface);
    ASSERT_TRUE(rebuilt.closed) << trial;
    ASSERT_EQ(rebuilt.reflex, 0) << trial;
    ASSERT_LE(rebuilt.faces, 2 * 14 - 4) << trial;
    bool newest = false;
    for (const DifferenceVertex& v : surface.vertices) newest |= v.a == cached.first.back().a;
    ASSERT_TRUE(newest) << trial;
  }
  surface.clear();
  for (int i = 0; i < 6; ++i) surface.vertices.push_back({Vec3(i, i * i, 0), i, i});
  EXPECT_FALSE(surface.rebuild(1e-12)) << "flat";
}

}  // namespace
}  // namespace pd::detail
