/// @file
/// Meshes that are solids, and the words by which others are refused.
#include "pd/shape/mesh_solid.hpp"

#include <gtest/gtest.h>

#include "solid_families.hpp"

namespace pd::test {
namespace {

const Cells kAngle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

/// The first word of the refusal.
std::string word_of(const Mesh& mesh, const MeshSolidSettings& settings = {}) {
  const Expected<MeshSolid> solid = MeshSolid::from_faces(mesh.view(), settings);
  return solid ? "" : solid.error().message.substr(0, solid.error().message.find(':'));
}

void append(Mesh& mesh, const Mesh& more, const Vec3& by, double times) {
  const auto first = static_cast<std::int32_t>(mesh.points.size());
  for (const Vec3& p : more.points) mesh.points.emplace_back(times * p + by);
  for (const std::int32_t c : more.corners) mesh.corners.push_back(first + c);
  const std::int32_t corners = mesh.offsets.back();
  for (std::size_t f = 1; f < more.offsets.size(); ++f) mesh.offsets.push_back(corners + more.offsets[f]);
}

Mesh turned(const Mesh& mesh) {
  Mesh out = mesh;
  for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
    std::reverse(out.corners.begin() + mesh.offsets[f], out.corners.begin() + mesh.offsets[f + 1]);
  }
  return out;
}

TEST(MeshSolidTest, TrianglesKnowTheirNeighbours) {
  const MeshSolid solid = solid_of(mesh_of(kAngle));
  EXPECT_EQ(solid.triangles().size(), 28u);
  for (std::size_t t = 0; t < solid.triangles().size(); ++t) {
    const MeshSolid::Triangle& here = solid.triangles()[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const MeshSolid::Triangle& there = solid.triangle(here.neighbours[k]);
      const auto back = std::find(there.neighbours.begin(), there.neighbours.end(), static_cast<std::int32_t>(t));
      ASSERT_NE(back, there.neighbours.end());
      const auto m = static_cast<std::size_t>(back - there.neighbours.begin());
      EXPECT_EQ(there.vertices[m], here.vertices[(k + 1) % 3]);
      EXPECT_EQ(there.vertices[(m + 1) % 3], here.vertices[k]);
    }
  }
}

TEST(MeshSolidTest, RefusedByNameWithThePlace) {
  Mesh open = mesh_of(kAngle);
  open.offsets.pop_back();
  open.corners.resize(static_cast<std::size_t>(open.offsets.back()));
  EXPECT_EQ(word_of(open), "open_edge");
  const Expected<MeshSolid> refused = MeshSolid::from_faces(open.view());
  EXPECT_EQ(refused.error().code, ErrorCode::not_closed);
  EXPECT_NE(refused.error().where.find("faces["), std::string::npos);

  Mesh flipped = mesh_of(kAngle);
  std::reverse(flipped.corners.begin(), flipped.corners.begin() + 4);
  EXPECT_EQ(word_of(flipped), "flipped_face");
  EXPECT_EQ(word_of(mesh_of(Cells{{0, 0, 0}, {1, 1, 0}})), "not_manifold");
  Mesh crossing = mesh_of(kAngle);
  append(crossing, mesh_of(Cells{{0, 0, 0}}), {0.5, 0.25, 0.25}, 1);
  EXPECT_EQ(word_of(crossing), "self_crossing");
  EXPECT_EQ(word_of(turned(mesh_of(kAngle))), "inside_out");
  EXPECT_EQ(word_of(turned(mesh_of(kAngle)), {.turn_faces = true}), "");
  EXPECT_EQ(word_of(Mesh{{Vec3::Zero()}, {0}, {}}).substr(0, 13), "a solid needs");
}

/// A part inside of a part is counted twice; a cavity has to lie in a part.
TEST(MeshSolidTest, PartsAndCavitiesAlternate) {
  Mesh nested = mesh_of(kAngle);
  append(nested, mesh_of(Cells{{0, 0, 0}}), {0.25, 0.25, 0.25}, 0.5);
  EXPECT_EQ(word_of(nested), "inside_out");
  Mesh hollow = mesh_of(kAngle);
  append(hollow, turned(mesh_of(Cells{{0, 0, 0}})), {0.25, 0.25, 0.25}, 0.5);
  EXPECT_EQ(word_of(hollow), "");
  append(hollow, mesh_of(Cells{{0, 0, 0}}), {0.375, 0.375, 0.375}, 0.25);
  EXPECT_EQ(word_of(hollow), "") << "a part within the cavity";
  Mesh in_notch = mesh_of(kAngle);
  append(in_notch, turned(mesh_of(Cells{{0, 0, 0}})), {1.25, 1.25, 0.25}, 0.5);
  EXPECT_EQ(word_of(in_notch), "inside_out") << "the box of the angle holds the cavity, the angle does not";
}

/// A corner in the middle of a neighbour's edge: the polygon is cut so that both halves have their triangle.
TEST(MeshSolidTest, CornersInTheMiddleOfEdges) {
  Mesh mesh = mesh_of(Cells{{0, 0, 0}});
  Mesh split;
  split.points = mesh.points;
  split.points.push_back(0.5 * (mesh.points[0] + mesh.points[1]));
  const auto middle = static_cast<std::int32_t>(split.points.size() - 1);
  for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
    for (std::int32_t k = mesh.offsets[f]; k < mesh.offsets[f + 1]; ++k) {
      const std::int32_t p = mesh.corners[static_cast<std::size_t>(k)];
      const std::int32_t q =
          mesh.corners[static_cast<std::size_t>(k + 1 == mesh.offsets[f + 1] ? mesh.offsets[f] : k + 1)];
      split.corners.push_back(p);
      if ((p == 0 && q == 1) || (p == 1 && q == 0)) split.corners.push_back(middle);
    }
    split.offsets.push_back(static_cast<std::int32_t>(split.corners.size()));
  }
  const MeshSolid solid = solid_of(split);
  EXPECT_EQ(solid.triangles().size(), 14u);
}

}  // namespace
}  // namespace pd::test
