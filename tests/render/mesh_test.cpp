#include "pd/render/mesh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace pd::render {
namespace {

/// Signed volume by the divergence theorem: positive and right only for a closed surface turned outwards.
double enclosed_volume(const Mesh& mesh) {
  const auto point = [&](std::size_t i) {
    const auto& p = mesh.vertices[mesh.triangles[i]].position;
    return Vec3(mesh.unit * Vec3(p[0], p[1], p[2]));
  };
  double volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    volume += point(i).dot(point(i + 1).cross(point(i + 2))) / 6;
  }
  return volume;
}

constexpr double kPi = std::numbers::pi;

TEST(Mesh, SurfacesAreClosedAndTurnedOutwards) {
  EXPECT_NEAR(enclosed_volume(*box_mesh({1, 2, 3})), 48, 1e-4);
  EXPECT_NEAR(enclosed_volume(*sphere_mesh(2)), 4 / 3.0 * kPi * 8, 0.3);
  EXPECT_NEAR(enclosed_volume(*ellipsoid_mesh({1, 2, 3})), 4 / 3.0 * kPi * 6, 0.25);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(enclosed_volume(*cylinder_mesh(1, 2, axis)), kPi * 4, 0.05);
    EXPECT_NEAR(enclosed_volume(*cone_mesh(1, 2, axis)), kPi * 4 / 3, 0.02);
    EXPECT_NEAR(enclosed_volume(*capsule_mesh(1, 2, axis)), kPi * 4 + 4 / 3.0 * kPi, 0.1);
  }
}

TEST(Mesh, EveryShapeOfTheLibraryHasASurface) {
  EXPECT_NEAR(enclosed_volume(*shape_mesh(*ConvexShape::sphere(1))), 4 / 3.0 * kPi, 0.05);
  EXPECT_NEAR(enclosed_volume(*shape_mesh(*ConvexShape::capsule(1, 2, 1))), kPi * 4 + 4 / 3.0 * kPi, 0.2);
  EXPECT_NEAR(enclosed_volume(*shape_mesh(*ConvexShape::cone(1, 2, 0))), kPi * 4 / 3, 0.02);
  // A ball of radius 1 at the origin and the tangent cone from it to a ball of radius 1/2, 2 away: a cap each, and the
  // frustum between the circles where they touch it.
  const auto club = ConvexShape::hull_of_spheres(std::vector<Sphere>{{{0, 0, 0}, 1}, {{2, 0, 0}, 0.5}});
  const double sine = 0.25, cosine = std::sqrt(1 - sine * sine);
  const auto cap = [&](double radius, double height) { return kPi * height * height * (3 * radius - height) / 3; };
  const double frustum = kPi * cosine * cosine * (2 - 0.5 * sine) * (1 + 0.5 + 0.25) / 3;
  EXPECT_NEAR(enclosed_volume(*shape_mesh(*club)), cap(1, 1 + sine) + frustum + cap(0.5, 0.5 * (1 - sine)), 0.05);
  // Steiner's formula for the unit cube swept by a ball: V + S r + 3 pi r^2 + 4/3 pi r^3.
  const double r = 0.25;
  const auto box = ConvexPolytope::box({0.5, 0.5, 0.5});
  const auto rounded = ConvexShape(*box).with_margin(r);
  EXPECT_NEAR(enclosed_volume(*shape_mesh(*rounded)), 1 + 6 * r + 3 * kPi * r * r + 4 / 3.0 * kPi * r * r * r, 0.02);
}

TEST(Mesh, PolytopeInksItsEdgesAndKeepsFacetColours) {
  const auto box = ConvexPolytope::box({1, 1, 1});
  const MeshRef plain = polytope_mesh(*box);
  EXPECT_EQ(plain->feature_edges.size(), 12u);
  EXPECT_EQ(plain->triangles.size(), 36u);
  EXPECT_NEAR(enclosed_volume(*plain), 8, 1e-5);
  const std::vector<Colour> colours(6, palette::kNearestFacet);
  const MeshRef coloured = polytope_mesh(*box, colours);
  for (const Mesh::Vertex& vertex : coloured->vertices) {
    EXPECT_EQ(vertex.tint[3], 1.0f);
    EXPECT_EQ(vertex.tint[0], palette::kNearestFacet.r);
  }
}

TEST(Mesh, FlatBodiesAreDrawable) {
  const std::vector<Vec3> segment = {{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(polytope_mesh(*ConvexPolytope::from_points(segment))->feature_edges.size(), 1u);
  const std::vector<Vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const MeshRef sheet = polytope_mesh(*ConvexPolytope::from_points(square));
  EXPECT_EQ(sheet->feature_edges.size(), 4u);
  EXPECT_EQ(sheet->triangles.size(), 12u);
}

TEST(Mesh, TinyAndHugeBodiesKeepTheirShape) {
  for (const double scale : {1e-60, 1e60}) {
    const MeshRef mesh = box_mesh(scale * Vec3(1, 0.5, 0.25));
    EXPECT_EQ(mesh->unit, scale);
    EXPECT_EQ(std::abs(mesh->vertices.front().position[1]), 0.5f);
  }
}

TEST(Mesh, CreasesSplitSmoothFromFlat) {
  // A tent of two right-angled sheets: one crease, six boundary edges less the shared one twice.
  const std::vector<Vec3> points = {{0, 0, 0}, {0, 1, 0}, {1, 0, -1}, {-1, 0, -1}};
  const std::vector<std::array<std::int32_t, 3>> triangles = {{0, 2, 1}, {0, 1, 3}};
  EXPECT_EQ(triangle_mesh(points, triangles, 10)->feature_edges.size(), 5u);
  EXPECT_EQ(triangle_mesh(points, triangles, 120)->feature_edges.size(), 4u);
}

}  // namespace
}  // namespace pd::render
