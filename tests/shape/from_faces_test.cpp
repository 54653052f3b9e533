/// ConvexPolytope::from_faces: right surfaces give the hull's own storage, wrong ones are refused by name and place.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/verify.hpp"
#include "shape/point_clouds.hpp"

namespace pd {
namespace {

using test::Points;
using Faces = std::vector<std::vector<std::int32_t>>;

Expected<ConvexPolytope> build(const Points& points, const Faces& faces) {
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> vertices;
  for (const auto& face : faces) {
    vertices.insert(vertices.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::int32_t>(vertices.size()));
  }
  return ConvexPolytope::from_faces(points, offsets, vertices);
}

void expect_refusal(const Points& points, const Faces& faces, ErrorCode code, const std::string& where) {
  const auto built = build(points, faces);
  ASSERT_FALSE(built.has_value());
  EXPECT_EQ(to_string(built.error().code), to_string(code)) << built.error().message;
  EXPECT_EQ(built.error().where, where) << built.error().message;
  EXPECT_FALSE(built.error().message.empty());
}

void expect_same(const ConvexPolytope& p, const ConvexPolytope& q) {
  ASSERT_EQ(p.num_vertices(), q.num_vertices());
  ASSERT_EQ(p.num_half_edges(), q.num_half_edges());
  ASSERT_EQ(p.num_facets(), q.num_facets());
  for (int v = 0; v < p.num_vertices(); ++v) {
    EXPECT_EQ(p.vertex(v), q.vertex(v));
    EXPECT_EQ(p.caller_id(v), q.caller_id(v));
  }
  for (int h = 0; h < p.num_half_edges(); ++h) {
    EXPECT_EQ(p.half_edge(h).origin, q.half_edge(h).origin);
    EXPECT_EQ(p.half_edge(h).twin, q.half_edge(h).twin);
    EXPECT_EQ(p.half_edge(h).next, q.half_edge(h).next);
    EXPECT_EQ(p.half_edge(h).facet, q.half_edge(h).facet);
  }
}

const Points kCube = {{-1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {-1, 1, 1},
                      {1, -1, -1},  {1, -1, 1},  {1, 1, -1},  {1, 1, 1}};
const Faces kCubeFaces = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};

Faces faces_of(const ConvexPolytope& p) {
  Faces faces;
  for (int f = 0; f < p.num_facets(); ++f) {
    std::vector<std::int32_t> face;
    for (const int v : p.facet_vertices(f)) face.push_back(p.caller_id(v));
    faces.push_back(face);
  }
  return faces;
}

TEST(FromFaces, Cube) {
  const auto built = build(kCube, kCubeFaces);
  ASSERT_TRUE(built.has_value());
  EXPECT_EQ(verify_polytope(*built), "");
  expect_same(*built, *ConvexPolytope::from_points(kCube));
}

TEST(FromFaces, TrianglesAreMerged) {
  Faces triangles;
  for (const auto& f : kCubeFaces) {
    triangles.push_back({f[0], f[1], f[2]});
    triangles.push_back({f[0], f[2], f[3]});
  }
  const auto built = build(kCube, triangles);
  ASSERT_TRUE(built.has_value());
  expect_same(*built, *ConvexPolytope::from_points(kCube));
}

TEST(FromFaces, SubdividedCube) {
  // Every side as a grid of quads: vertices inside edges and facets.
  constexpr int n = 4;
  Points points;
  Faces faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      const auto index = [&](int u, int v) {
        Vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        const auto found = std::find(points.begin(), points.end(), p);
        if (found != points.end()) return static_cast<std::int32_t>(found - points.begin());
        points.push_back(p);
        return static_cast<std::int32_t>(points.size() - 1);
      };
      for (int u = 0; u < n; ++u) {
        for (int v = 0; v < n; ++v) {
          std::vector<std::int32_t> face = {index(u, v), index(u + 1, v), index(u + 1, v + 1), index(u, v + 1)};
          if (side == 0) std::reverse(face.begin(), face.end());
          faces.push_back(face);
        }
      }
    }
  }
  const auto built = build(points, faces);
  ASSERT_TRUE(built.has_value()) << built.error().message;
  EXPECT_EQ(verify_polytope(*built), "");
  expect_same(*built, *ConvexPolytope::from_points(points));
  EXPECT_EQ(built->num_vertices(), 8);

  Faces hole = faces;
  hole.erase(hole.begin() + 5);
  EXPECT_EQ(build(points, hole).error().code, ErrorCode::not_closed);
}

TEST(FromFaces, UnusedAndDuplicatePoints) {
  Points points = {{100, 100, 100}};  // not used by any face: no part of the body
  points.insert(points.end(), kCube.begin(), kCube.end());
  points.insert(points.end(), kCube.begin(), kCube.end());
  Faces faces = kCubeFaces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (auto& v : faces[f]) v += f % 2 == 0 ? 1 : 9;  // split vertices, as in files with normals
  }
  const auto built = build(points, faces);
  ASSERT_TRUE(built.has_value()) << built.error().message;
  EXPECT_EQ(built->num_vertices(), 8);
  // The lowest id that a face uses: vertex 7 of the cube occurs in odd faces only.
  for (int v = 0; v < 8; ++v) EXPECT_EQ(built->caller_id(v), v == 7 ? 16 : 1 + v);
}

TEST(FromFaces, HullsOfCloudsPassTheirOwnCheck) {
  for (const Points& points : {test::sphere_cloud(2000, 1), test::cube_sides(2000, 2), test::cospherical(1001)}) {
    const ConvexPolytope p = *ConvexPolytope::from_points(points);
    const auto built = build(points, faces_of(p));
    ASSERT_TRUE(built.has_value()) << built.error().message << " at " << built.error().where;
    expect_same(p, *built);
  }
}

TEST(FromFaces, BadLists) {
  const auto with = [](std::size_t face, std::vector<std::int32_t> loop) {
    Faces faces = kCubeFaces;
    faces[face] = std::move(loop);
    return faces;
  };
  expect_refusal(kCube, with(1, {4, 6, 7, 9}), ErrorCode::bad_faces, "faces[1]");
  expect_refusal(kCube, with(1, {4, 6, 7, 8}), ErrorCode::bad_faces, "faces[1]");  // the first that is not there
  expect_refusal(kCube, with(1, {4, 6, 7, -1}), ErrorCode::bad_faces, "faces[1]");
  expect_refusal(kCube, with(2, {0, 1}), ErrorCode::bad_faces, "faces[2]");
  expect_refusal(kCube, with(3, {2, 3, 7, 3}), ErrorCode::bad_faces, "faces[3]");
  expect_refusal(kCube, {}, ErrorCode::bad_faces, "faces");
  const std::vector<std::int32_t> vertices = {0, 1, 2, 3};
  for (const std::vector<std::int32_t>& offsets :
       {std::vector<std::int32_t>{}, {0}, {1, 4}, {0, 3}, {0, 9, 4}, {0, -3, 4}, {0, 5}}) {
    EXPECT_EQ(ConvexPolytope::from_faces(kCube, offsets, vertices).error().code, ErrorCode::bad_faces);
  }
}

TEST(FromFaces, OpenSurfaces) {
  Faces open = kCubeFaces;
  open.pop_back();
  const auto built = build(kCube, open);
  ASSERT_FALSE(built.has_value());
  EXPECT_EQ(built.error().code, ErrorCode::not_closed);
  EXPECT_EQ(built.error().where.substr(0, 6), "faces[");
}

TEST(FromFaces, Orientation) {
  Faces one = kCubeFaces;
  std::reverse(one[5].begin(), one[5].end());
  EXPECT_EQ(build(kCube, one).error().code, ErrorCode::bad_faces);
  Faces all = kCubeFaces;
  for (auto& face : all) std::reverse(face.begin(), face.end());
  expect_refusal(kCube, all, ErrorCode::bad_faces, "faces[0]");
  // The face's own corners come last, level with it.
  std::swap(all[0], all[1]);
  expect_refusal(kCube, all, ErrorCode::bad_faces, "faces[0]");
}

TEST(FromFaces, NotConvex) {
  // A dent: one corner of the cube pulled inside, its faces cut into triangles round it.
  Points dented = kCube;
  dented[7] = {-0.5, -0.5, -0.5};
  Faces faces = {{0, 1, 3, 2}, {0, 4, 5, 1}, {0, 2, 6, 4}, {7, 5, 4}, {7, 4, 6},
                 {7, 6, 2},    {7, 2, 3},    {7, 3, 1},    {7, 1, 5}};
  EXPECT_EQ(build(dented, faces).error().code, ErrorCode::not_convex);
  // A twisted quad is no face.
  Points twisted = kCube;
  twisted[7] = {1.25, 1.25, 1.5};
  EXPECT_EQ(build(twisted, kCubeFaces).error().code, ErrorCode::not_convex);
  // By one ulp as well.
  twisted = kCube;
  twisted[7].x() = std::nextafter(1.0, 2);
  EXPECT_EQ(build(twisted, kCubeFaces).error().code, ErrorCode::not_convex);
  // Two bodies side by side.
  Points two = kCube;
  Faces both = kCubeFaces;
  for (const Vec3& p : kCube) two.push_back(p + Vec3(5, 0, 0));
  for (auto face : kCubeFaces) {
    for (auto& v : face) v += 8;
    both.push_back(face);
  }
  EXPECT_EQ(build(two, both).error().code, ErrorCode::not_convex);
  // A body inside another.
  for (std::size_t i = 8; i < 16; ++i) two[i] = 0.5 * kCube[i - 8];
  EXPECT_EQ(build(two, both).error().code, ErrorCode::not_convex);
}

TEST(FromFaces, FacesMustBeConvexPolygons) {
  // The right outline met in the wrong order.
  Faces faces = kCubeFaces;
  faces[5] = {1, 7, 5, 3};
  EXPECT_FALSE(build(kCube, faces).has_value());
}

TEST(FromFaces, FlatSurfaces) {
  const Points square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto built = build(square, {{0, 1, 2, 3}, {3, 2, 1, 0}});
  ASSERT_FALSE(built.has_value());
  EXPECT_EQ(built.error().code, ErrorCode::not_full_dimensional);
}

}  // namespace
}  // namespace pd
