/// @file
/// Faults of meshes by name and place; crossings of triangles against the exact class of two flat bodies.
#include "pd/shape/mesh_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "shape/mesh/triangle_crossings.hpp"

namespace pd {
namespace {

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> corners;

  void face(std::vector<std::int32_t> loop) {
    corners.insert(corners.end(), loop.begin(), loop.end());
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  [[nodiscard]] SurfaceReport check() const {
    const auto report = check_mesh({points, offsets, corners});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return report ? *report : SurfaceReport{};
  }
  /// The loop of each face the other way.
  [[nodiscard]] Mesh turned() const {
    Mesh other = *this;
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
      std::reverse(other.corners.begin() + offsets[f], other.corners.begin() + offsets[f + 1]);
    }
    return other;
  }
  void append(const Mesh& other) {
    const auto first = static_cast<std::int32_t>(points.size());
    points.insert(points.end(), other.points.begin(), other.points.end());
    for (std::size_t f = 0; f + 1 < other.offsets.size(); ++f) {
      std::vector<std::int32_t> loop(other.corners.begin() + other.offsets[f],
                                     other.corners.begin() + other.offsets[f + 1]);
      for (std::int32_t& v : loop) v += first;
      face(loop);
    }
  }
};

/// A prism over a polygon that runs counter-clockwise.
Mesh prism(const std::vector<std::array<double, 2>>& outline, double low, double high) {
  Mesh mesh;
  const auto n = static_cast<std::int32_t>(outline.size());
  for (const double z : {low, high}) {
    for (const auto& p : outline) mesh.points.emplace_back(p[0], p[1], z);
  }
  std::vector<std::int32_t> bottom, top;
  for (std::int32_t i = 0; i < n; ++i) {
    bottom.insert(bottom.begin(), i);
    top.push_back(n + i);
    mesh.face({i, (i + 1) % n, n + (i + 1) % n, n + i});
  }
  mesh.face(bottom);
  mesh.face(top);
  return mesh;
}
Mesh box(double low, double high) { return prism({{low, low}, {high, low}, {high, high}, {low, high}}, low, high); }
Mesh angle_bracket() { return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1); }

/// Each face with points of its own, as STL files have them.
Mesh soup(const Mesh& mesh) {
  Mesh parts;
  for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
    std::vector<std::int32_t> loop;
    for (std::int32_t k = mesh.offsets[f]; k < mesh.offsets[f + 1]; ++k) {
      loop.push_back(static_cast<std::int32_t>(parts.points.size()));
      parts.points.push_back(mesh.points[static_cast<std::size_t>(mesh.corners[static_cast<std::size_t>(k)])]);
    }
    parts.face(loop);
  }
  return parts;
}

std::array<std::int64_t, kMeshFaults> only(MeshFault fault, std::int64_t count) {
  std::array<std::int64_t, kMeshFaults> counts{};
  counts[static_cast<std::size_t>(fault)] = count;
  return counts;
}
constexpr std::array<std::int64_t, kMeshFaults> kNone{};

TEST(MeshCheck, ABoxIsASolidAndConvex) {
  for (const Mesh& mesh : {box(-1, 2), soup(box(-1, 2))}) {
    const SurfaceReport report = mesh.check();
    EXPECT_EQ(report.counts, kNone);
    EXPECT_TRUE(report.solid());
    EXPECT_TRUE(report.convex);
    EXPECT_TRUE(report.crossings_searched);
    EXPECT_NEAR(report.relative_volume, 1, 1e-14);
    EXPECT_EQ(report.vertices, 8);
    EXPECT_EQ(report.shells, 1);
    EXPECT_EQ(report.size, 3);
  }
}

TEST(MeshCheck, AnAngleBracketIsASolidAndNotConvex) {
  const SurfaceReport report = angle_bracket().check();
  EXPECT_EQ(report.counts, kNone);
  EXPECT_TRUE(report.solid());
  EXPECT_FALSE(report.convex);
  EXPECT_NEAR(report.relative_volume, 3.0 / 8, 1e-14);
}

TEST(MeshCheck, AThinSlitIsNotConvexAndRoundedNumbersAre) {
  // The slit is 1e-3 wide and takes 1e-4 of the volume; its bottom ends on the sides of the box.
  const SurfaceReport slit = prism({{0, 0}, {1, 0}, {1, 1}, {0.501, 1}, {0.5, 0.9}, {0.5, 1}, {0, 1}}, 0, 1).check();
  EXPECT_TRUE(slit.solid());
  EXPECT_FALSE(slit.convex);
  // A cylinder of 100 sides, turned, its corners rounded to six digits: flat faces bend by as much.
  std::vector<std::array<double, 2>> outline;
  for (int i = 0; i < 100; ++i) outline.push_back({std::cos(0.02 * i * M_PI), std::sin(0.02 * i * M_PI)});
  Mesh round = prism(outline, 0, 1);
  for (Vec3& p : round.points) {
    p = Vec3(0.36 * p.x() - 0.48 * p.y() + 0.8 * p.z(), 0.8 * p.x() + 0.6 * p.y(),
             -0.48 * p.x() + 0.64 * p.y() + 0.6 * p.z());
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 1e6) / 1e6;
  }
  const SurfaceReport report = round.check();
  EXPECT_EQ(report.counts, kNone);
  EXPECT_TRUE(report.convex);
}

TEST(MeshCheck, NamesOpenEdgesAndFlippedFaces) {
  Mesh open = box(0, 1);
  open.corners.resize(open.corners.size() - 4);  // the lid
  open.offsets.pop_back();
  SurfaceReport report = open.check();
  EXPECT_EQ(report.counts, only(MeshFault::open_edge, 4));
  ASSERT_EQ(report.findings.size(), 4u);
  EXPECT_EQ(report.findings[0].edge, (std::array<std::int32_t, 2>{4, 5}));
  EXPECT_EQ(report.findings[0].faces, (std::array<std::int32_t, 2>{0, -1}));
  EXPECT_FALSE(report.closed());
  EXPECT_FALSE(report.convex);

  Mesh flipped = box(0, 1);
  std::reverse(flipped.corners.end() - 4, flipped.corners.end());
  report = flipped.check();
  EXPECT_EQ(report.counts, only(MeshFault::flipped_face, 4));
  EXPECT_EQ(report.findings[0].faces[1], 5);
  EXPECT_FALSE(report.solid());
}

TEST(MeshCheck, NamesWhereSheetsMeet) {
  Mesh edge = box(0, 1);
  edge.append(prism({{1, 1}, {2, 1}, {2, 2}, {1, 2}}, 0, 1));
  SurfaceReport report = edge.check();
  EXPECT_EQ(report.counts, only(MeshFault::not_manifold, 1)) << "an edge of four faces";
  EXPECT_EQ(report.findings[0].edge, (std::array<std::int32_t, 2>{2, 6}));

  Mesh vertex = box(0, 1);
  vertex.append(box(1, 2));
  report = vertex.check();
  EXPECT_EQ(report.counts, only(MeshFault::not_manifold, 1)) << "a vertex of two boxes";
  EXPECT_EQ(report.findings[0].edge[1], -1);
  EXPECT_EQ(report.shells, 2);
}

TEST(MeshCheck, NamesCrossingFaces) {
  Mesh crossed = box(0, 1);
  crossed.append(prism({{0.25, 0.25}, {0.75, 0.25}, {0.75, 0.75}, {0.25, 0.75}}, 0.5, 1.5));
  SurfaceReport report = crossed.check();
  EXPECT_EQ(report.count(MeshFault::self_crossing), 4) << "the lid and the four sides that pass through it";
  EXPECT_TRUE(report.closed() && report.oriented() && report.manifold());
  EXPECT_FALSE(report.solid());

  Mesh flush = box(0, 1);
  flush.append(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 2, 3));
  EXPECT_EQ(flush.check().counts, kNone);
  flush.points[8] = Vec3(0.5, 0.5, 1);  // a corner of the second box on the lid of the first
  EXPECT_GT(flush.check().count(MeshFault::self_crossing), 0);

  // A face that lies folded upon its neighbour.
  Mesh fold;
  fold.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 0}};
  fold.face({0, 1, 2});
  fold.face({1, 0, 3});
  EXPECT_EQ(fold.check().count(MeshFault::self_crossing), 1);
}

TEST(MeshCheck, CavitiesAreNotInsideOut) {
  Mesh hollow = box(0, 3);
  hollow.append(box(1, 2).turned());
  const SurfaceReport report = hollow.check();
  EXPECT_EQ(report.counts, kNone);
  EXPECT_TRUE(report.solid());
  EXPECT_FALSE(report.convex) << "two shells";
  EXPECT_NEAR(report.relative_volume, 26.0 / 27, 1e-14);

  EXPECT_EQ(box(0, 3).turned().check().counts, only(MeshFault::inside_out, 1));
  EXPECT_TRUE(box(0, 3).turned().check().convex) << "whichever side the faces show";
  EXPECT_FALSE(angle_bracket().turned().check().convex);
  EXPECT_NEAR(box(0, 3).turned().check().relative_volume, -1, 1e-14);
}

TEST(MeshCheck, FlatnessOfPolygons) {
  Mesh bent = box(0, 1);
  bent.points[6] = Vec3::Constant(1 + 1e-3);
  EXPECT_EQ(bent.check().count(MeshFault::not_planar), 3);
  bent.points[6] = Vec3::Constant(1 + 1e-7);
  EXPECT_EQ(bent.check().counts, kNone) << "within the precision of single numbers";
  EXPECT_TRUE(bent.check().convex);
}

TEST(MeshCheck, DegenerateFacesOfAClosedMeshAreHarmless) {
  Mesh mesh = soup(box(0, 1));
  const auto last = static_cast<std::int32_t>(mesh.points.size());
  mesh.points.emplace_back(0, 0, 0);
  mesh.points.emplace_back(1, 0, 0);
  mesh.points.emplace_back(0, 0, 0);
  mesh.face({last, last + 1, last + 2});
  const SurfaceReport report = mesh.check();
  EXPECT_EQ(report.counts, only(MeshFault::degenerate_face, 1));
  EXPECT_TRUE(report.solid());
  EXPECT_TRUE(report.convex);
}

TEST(MeshCheck, PointsBesideTheSurfaceAreCounted) {
  Mesh mesh = soup(box(0, 1));
  const auto last = static_cast<std::int32_t>(mesh.points.size());
  EXPECT_EQ(mesh.check().loose_points, 0);
  mesh.points.insert(mesh.points.end(), 3, Vec3(9, 9, 9));  // one point, in a face of one corner thrice
  mesh.face({last, last + 1, last + 2});
  mesh.points.emplace_back(5, 5, 5);  // in no face
  const SurfaceReport report = mesh.check();
  EXPECT_EQ(report.counts, only(MeshFault::degenerate_face, 1));
  EXPECT_EQ(report.loose_points, 2);
  EXPECT_TRUE(report.solid());
  EXPECT_TRUE(report.convex);
}

TEST(MeshCheck, FacesWithoutAnAreaAloneBoundNothing) {
  Mesh one_point, line;
  one_point.points.assign(3, Vec3(1, 1, 1));
  one_point.face({0, 1, 2});
  line.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  line.face({0, 1, 2});
  line.face({2, 1, 0});
  for (const Mesh& mesh : {one_point, line}) {
    const SurfaceReport report = mesh.check();
    EXPECT_FALSE(report.has_area());
    EXPECT_FALSE(report.solid());
    const auto solid = MeshSolid::from_faces({mesh.points, mesh.offsets, mesh.corners});
    ASSERT_FALSE(solid.has_value());
    EXPECT_EQ(solid.error().code, ErrorCode::bad_faces);
    EXPECT_EQ(solid.error().where, "faces[0]");
  }
  EXPECT_FALSE(one_point.check().closed());
}

TEST(MeshCheck, SizesFromOneEndOfTheDoublesToTheOther) {
  for (const double size : {1e-300, 1e-150, 1.0, 1e150, 1e299}) {
    Mesh mesh = angle_bracket();
    for (Vec3& p : mesh.points) p *= size;
    const SurfaceReport report = mesh.check();
    EXPECT_EQ(report.counts, kNone) << size;
    EXPECT_FALSE(report.convex) << size;
    Mesh cube = box(0, 1);
    for (Vec3& p : cube.points) p *= size;
    EXPECT_TRUE(cube.check().convex) << size;
  }
}

TEST(MeshCheck, RefusesWhatIsNoMesh) {
  const auto code = [](const Mesh& mesh) {
    const auto report = check_mesh({mesh.points, mesh.offsets, mesh.corners});
    return report ? std::string("none") : std::string(to_string(report.error().code));
  };
  EXPECT_EQ(code({}), "too_few_points");
  Mesh mesh = box(0, 1);
  mesh.corners[3] = 8;
  EXPECT_EQ(code(mesh), "bad_faces");
  EXPECT_EQ(check_mesh({mesh.points, mesh.offsets, mesh.corners}).error().message, "vertex index 8 is outside 0..7");
  mesh = box(0, 1);
  mesh.points[5].x() = -2e300;
  EXPECT_EQ(code(mesh), "out_of_range");
  EXPECT_EQ(check_mesh({mesh.points, mesh.offsets, mesh.corners}).error().message,
            "2e+300 is beyond the largest coordinate 1e+300");
  mesh = box(0, 1);
  mesh.offsets[1] = 9;
  EXPECT_EQ(code(mesh), "bad_faces");
  mesh = box(0, 1);
  mesh.points[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(mesh), "non_finite");
  Mesh cloud;
  cloud.points = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(cloud.check().closed());
  EXPECT_FALSE(cloud.check().solid());
}

TEST(MeshCheck, SolidsThatTouchHaveSurfacesOfTheirOwn) {
  Mesh mesh = box(0, 1);
  mesh.append(prism({{1, 1}, {2, 1}, {2, 2}, {1, 2}}, 0, 1));  // along an edge
  mesh.append(box(-1, 0));                                     // in a vertex
  mesh.face({0, 0, 1});                                        // no face at all
  const auto surfaces_of = [](const Mesh& m) { return connected_surfaces({m.points, m.offsets, m.corners}); };
  std::vector<std::int32_t> expected(19, 0);
  std::fill(expected.begin() + 6, expected.begin() + 12, 1);
  std::fill(expected.begin() + 12, expected.begin() + 18, 2);
  expected.back() = -1;
  EXPECT_EQ(surfaces_of(mesh), expected);
  EXPECT_EQ(surfaces_of(soup(mesh)), expected) << "points with equal coordinates are one";
  EXPECT_LT(mesh.check().shells, 3) << "the check counts faces with a common edge as one";
  // A face in the mesh's own size is bent, in that of a larger mesh it is not.
  Mesh bent;
  bent.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3333, 0.3333, 0.3333}};
  for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 4}, {2, 3, 4}, {3, 1, 4}}) {
    bent.face({face[0], face[1], face[2]});
  }
  EXPECT_FALSE(bent.check().convex);
  EXPECT_TRUE(check_mesh({bent.points, bent.offsets, bent.corners}, {.extent = 100})->convex);
}

TEST(MeshCheck, TrianglesCrossWhereTheirBodiesAreNotSeparated) {
  std::mt19937_64 random(42);
  Scratch scratch;
  int meeting = 0, judged = 0;
  for (int i = 0; i < 8000; ++i) {
    const auto coordinate = [&] { return static_cast<double>(random() % 5); };
    std::vector<Vec3> points;
    const bool flat = i % 4 == 0;
    for (int k = 0; k < 6; ++k) points.push_back({coordinate(), coordinate(), flat ? 0 : coordinate()});
    std::vector<Vec3> first(points.begin(), points.begin() + 3), second(points.begin() + 3, points.end());
    const auto a = ConvexPolytope::from_points(first), b = ConvexPolytope::from_points(second);
    if (a->affine_dimension() != 2 || b->affine_dimension() != 2) continue;
    const ConvexShape shape_a(*a), shape_b(*b);
    const bool meet = penetration_depth({&shape_a, {}}, {&shape_b, {}}, scratch).contact != ContactClass::separated;
    const bool found = detail::cross(points, {{0, 1, 2}, 0}, {{3, 4, 5}, 1});
    EXPECT_EQ(found, meet) << "pair " << i;
    ++judged;
    meeting += meet;
  }
  EXPECT_GT(judged, 6000);
  EXPECT_GT(meeting, 1200);
  EXPECT_LT(meeting, judged - 1200);
}

TEST(MeshCheck, TrianglesWithACommonVertexCrossWhereTheyMeetElsewhere) {
  // Shrunk towards its other corners by a small rational, a triangle loses the common vertex and nothing else that a
  // grid of this size could hold.
  std::mt19937_64 random(43);
  Scratch scratch;
  int crossing = 0, judged = 0;
  for (int i = 0; i < 8000; ++i) {
    const auto coordinate = [&] { return static_cast<double>(random() % 4); };
    std::vector<Vec3> points;
    for (int k = 0; k < 5; ++k) points.push_back({coordinate(), coordinate(), i % 4 == 0 ? 0 : coordinate()});
    // The part of the first triangle beyond 2^-20 of its way from the common vertex.
    const auto near = [&](std::size_t k) -> Vec3 { return points[0] + 0x1p-20 * (points[k] - points[0]); };
    const auto a = ConvexPolytope::from_points(std::vector<Vec3>{near(1), near(2), points[1], points[2]});
    const auto b = ConvexPolytope::from_points(std::vector<Vec3>{points[0], points[3], points[4]});
    if (a->affine_dimension() != 2 || b->affine_dimension() != 2) continue;
    const ConvexShape shape_a(*a), shape_b(*b);
    const bool meet = penetration_depth({&shape_a, {}}, {&shape_b, {}}, scratch).contact != ContactClass::separated;
    EXPECT_EQ(detail::cross(points, {{1, 0, 2}, 0}, {{3, 4, 0}, 1}), meet) << "pair " << i;
    ++judged;
    crossing += meet;
  }
  EXPECT_GT(judged, 4800);
  EXPECT_GT(crossing, 400);
}

}  // namespace
}  // namespace pd
