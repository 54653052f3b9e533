// Contacts of compounds and sheets as one body each, without an engine.
#include "pd/union_contact/union_manifold.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pd/compound/compound_depth.hpp"

namespace pd::test {
namespace {

Pose at(double x, double y, double z) { return Pose::from_trusted_matrix(Mat3::Identity(), Vec3(x, y, z)); }

PieceBody box(double half) { return PieceBody::of_compound(Compound(*ConvexPolytope::box(Vec3::Constant(half)))); }

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> corners;
  void add(std::initializer_list<std::int32_t> face) {
    corners.insert(corners.end(), face);
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  [[nodiscard]] MeshView view() const { return {points, offsets, corners}; }
};

/// The square [-1, 1]^2 at z = 0 in cells of a quarter, two triangles each, facing up.
Mesh floor_of_cells(double scale = 1) {
  Mesh mesh;
  for (int i = 0; i <= 8; ++i) {
    for (int j = 0; j <= 8; ++j) mesh.points.emplace_back(scale * (0.25 * i - 1), scale * (0.25 * j - 1), 0);
  }
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const int corner = 9 * i + j;
      mesh.add({corner, corner + 9, corner + 10});
      mesh.add({corner, corner + 10, corner + 1});
    }
  }
  return mesh;
}

/// Five flush boxes in a row along x, their common top at z = 0.
PieceBody slab() {
  std::vector<Compound::Part> parts;
  for (int i = 0; i < 5; ++i) parts.push_back({*ConvexPolytope::box({0.5, 1, 0.5}), at(i - 2.0, 0, -0.5)});
  return PieceBody::of_compound(*Compound::from_parts(parts));
}

class UnionManifolds : public testing::Test {
 protected:
  UnionManifold ask(const PosedPieces& a, const PosedPieces& b) {
    auto found = union_manifold(a, b, settings_, scratch_);
    EXPECT_TRUE(found) << (found ? "" : found.error().message);
    return found ? std::move(found).value() : UnionManifold();
  }
  std::string refusal(const PosedPieces& a, const PosedPieces& b) {
    const auto found = union_manifold(a, b, settings_, scratch_);
    return found ? "" : std::string(to_string(found.error().code)) + " " + found.error().where;
  }
  /// The box of half extent 0.2 at height `z` stands on four points of one depth.
  void expect_stands(const PieceBody& ground, double x, double depth) {
    SCOPED_TRACE(x);
    const PieceBody body = box(0.2);
    const UnionManifold found = ask({&body, at(x, 0.013, 0.2 - depth)}, {&ground, Pose()});
    ASSERT_EQ(found.patches.size(), 1U);
    const UnionContactPatch& patch = found.patches[0];
    ASSERT_EQ(patch.count, 4);
    double spread = 0;
    for (const UnionContactPoint& point : patch.points) {
      EXPECT_LT((point.normal - Vec3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(point.contact.depth, depth, 1e-12);
      spread = std::max(spread, (point.contact.position_b - patch.points[0].contact.position_b).norm());
    }
    EXPECT_NEAR(spread, 0.4 * std::sqrt(2.0), 2e-3);
  }

  UnionContactSettings settings_{.breaking_threshold = 0.02};
  Scratch depth_;
  ManifoldScratch manifold_;
  UnionManifoldScratch scratch_{depth_, manifold_};
};

TEST_F(UnionManifolds, ABoxThatSlidesOverInnerEdgesMeetsNone) {
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view()), flush = slab();
  for (const double depth : {1e-4, 0.0, -1e-4, 0.01}) {
    for (int i = 0; i < 24; ++i) {
      expect_stands(floor, 0.0125 * i, depth);
      expect_stands(flush, 0.04 * i, depth);
    }
  }
}

TEST_F(UnionManifolds, PiecesThatCoverEachOtherLeaveASheetAsOne) {
  Mesh square;
  square.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.add({0, 1, 2});
  square.add({0, 2, 3});
  const PieceBody floor = *PieceBody::of_sheet(square.view());
  const ConvexPolytope half = *ConvexPolytope::box({0.3, 0.3, 0.2});
  const PieceBody stacked =
      PieceBody::of_compound(*Compound::from_parts({{half, at(0, 0, -0.2)}, {half, at(0, 0, 0.2)}}));
  // The sheet cuts the lower box near its top, at the seam, and the upper one near its bottom.
  for (const double z : {0.05, 0.0, -0.05}) {
    SCOPED_TRACE(z);
    const UnionManifold found = ask({&stacked, at(0.01, 0.02, z)}, {&floor, Pose()});
    ASSERT_FALSE(found.patches.empty());
    const Vec3 side = z < 0 ? -Vec3::UnitZ() : Vec3(Vec3::UnitZ());
    double deepest = 0;
    for (const UnionContactPatch& patch : found.patches) {
      EXPECT_LT((patch.normal - side).norm(), 1e-12);
      for (int k = 0; k < patch.count; ++k) {
        deepest = std::max(deepest, patch.points[static_cast<std::size_t>(k)].contact.depth);
      }
    }
    EXPECT_NEAR(deepest, 0.4 - std::abs(z), 1e-12);
  }
}

TEST_F(UnionManifolds, AFarReachMergesNoPoints) {
  for (const double reach : {0.02, 1.0, 100.0, 1e6}) {
    SCOPED_TRACE(reach);
    settings_.breaking_threshold = reach;
    expect_stands(slab(), 0.3, 1e-4);
  }
}

TEST_F(UnionManifolds, CoveredContactsAreCounted) {
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view()), body = box(0.2);
  // The box's side stands 1e-5 beyond an edge of the mesh: of that triangle alone it would leave sideways.
  EXPECT_GT(ask({&body, at(0.05001, 0.013, 0.1999)}, {&floor, Pose()}).covered, 0);
  EXPECT_EQ(ask({&body, at(0.123, 0.013, 0.1999)}, {&floor, Pose()}).covered, 0);
}

TEST_F(UnionManifolds, ASwapTurnsTheAnswer) {
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view()), body = box(0.2);
  const PosedPieces stands{&body, at(0.051, 0.013, 0.1999)}, under{&floor, Pose()};
  const UnionManifold one = ask(stands, under), other = ask(under, stands);
  ASSERT_EQ(one.patches.size(), 1U);
  ASSERT_EQ(other.patches.size(), 1U);
  EXPECT_EQ(other.normal, Vec3(0, 0, -1));
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(one.patches[0].points[k].contact.position_a, other.patches[0].points[k].contact.position_b);
    EXPECT_EQ(one.patches[0].points[k].piece_b, other.patches[0].points[k].piece_a);
  }
}

TEST_F(UnionManifolds, AOneSidedSheetIsLeftByItsFront) {
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view()), body = box(0.2);
  const PosedPieces mostly_under{&body, at(0.051, 0.013, -0.1)}, under{&body, at(0.051, 0.013, -0.21)};
  EXPECT_EQ(ask(mostly_under, {&floor, Pose()}).normal, Vec3(0, 0, -1));
  settings_.one_sided = true;
  const UnionManifold found = ask(mostly_under, {&floor, Pose()});
  EXPECT_EQ(found.normal, Vec3(0, 0, 1));
  EXPECT_NEAR(found.patches.at(0).points[0].contact.depth, 0.3, 1e-12);
  const UnionManifold none = ask(under, {&floor, Pose()});
  EXPECT_TRUE(none.patches.empty());
  EXPECT_TRUE(none.normal.isZero(0));
}

TEST_F(UnionManifolds, ASlenderBodyThroughASheetHasAContact) {
  // The shortest way off each triangle alone leads over an inner edge, which the next triangle covers.
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view());
  const ConvexShape needle = *ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, -0.2}, {0.03, 0.05, 0.8}});
  const ConvexShape pin = *ConvexShape::capsule(0.01, 0.5, 2), bar = *ConvexShape::capsule(0.01, 0.2, 0);
  for (const bool one_sided : {false, true}) {
    settings_.one_sided = one_sided;
    for (int i = 0; i < 100; ++i) {
      SCOPED_TRACE(i);
      const double x = 0.0049 * i, y = 0.0031 * i;
      const PieceBody thin = PieceBody::of_compound(Compound(needle)), round = PieceBody::of_compound(Compound(pin));
      const PieceBody jack = PieceBody::of_compound(*Compound::from_parts({{needle, Pose()}, {bar, at(0, 0, 0.3)}}));
      const UnionManifold sharp = ask({&thin, at(x, y, 0)}, {&floor, Pose()});
      const UnionManifold blunt = ask({&round, at(x, y, 0.31)}, {&floor, Pose()});
      const UnionManifold crossed = ask({&jack, at(x, y, 0)}, {&floor, Pose()});
      for (const UnionManifold* found : {&sharp, &blunt, &crossed}) {
        ASSERT_FALSE(found->patches.empty());
        EXPECT_LT((found->normal - Vec3::UnitZ()).norm(), 1e-9);
        EXPECT_NEAR(found->patches[0].points[0].contact.depth, 0.2, 1e-9);
      }
    }
  }
}

TEST_F(UnionManifolds, WallAndFloorAreTwoPatches) {
  Mesh corner;
  corner.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {0, 2, 2}};
  corner.add({0, 1, 2, 3});
  corner.add({0, 3, 5, 4});
  const PieceBody room = *PieceBody::of_sheet(corner.view()), body = box(0.5);
  const UnionManifold found = ask({&body, at(0.499, 1, 0.498)}, {&room, Pose()});
  ASSERT_EQ(found.patches.size(), 2U);
  EXPECT_LT((found.patches[0].normal - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((found.patches[1].normal - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_EQ(found.patches[0].points[0].piece_b, 0);
  EXPECT_EQ(found.patches[1].points[0].piece_b, 1);
}

TEST_F(UnionManifolds, ABoxDeepInACompoundLeavesTheWhole) {
  const PieceBody ground = slab(), body = box(0.2);
  const UnionManifold found = ask({&body, at(0.45, 0.013, -0.3)}, {&ground, Pose()});
  ASSERT_FALSE(found.patches.empty());
  EXPECT_LT((found.normal - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(found.patches[0].points[0].contact.depth, 0.5, 1e-12);
}

TEST_F(UnionManifolds, ACompoundStandsOnASheet) {
  const PieceBody ground = *PieceBody::of_sheet(floor_of_cells().view()), body = slab();
  const UnionManifold found = ask({&body, at(0, 0, 0.99)}, {&ground, Pose()});
  ASSERT_EQ(found.patches.size(), 1U);
  EXPECT_EQ(found.patches[0].count, 4);
  EXPECT_LT((found.normal - Vec3::UnitZ()).norm(), 1e-12);
}

TEST_F(UnionManifolds, SizesOfAllPowersOfTwoHaveOneAnswer) {
  for (const int exponent : {-900, -120, 120, 900}) {
    const double scale = std::ldexp(1.0, exponent);
    const PieceBody floor = *PieceBody::of_sheet(floor_of_cells(scale).view()), body = box(0.2 * scale);
    settings_.breaking_threshold = 0.02 * scale;
    const UnionManifold found = ask({&body, at(0.051 * scale, 0, 0.1875 * scale)}, {&floor, Pose()});
    ASSERT_EQ(found.patches.size(), 1U) << exponent;
    EXPECT_EQ(found.patches[0].count, 4);
    EXPECT_NEAR(found.patches[0].points[0].contact.depth / scale, 0.0125, 1e-12);
  }
}

TEST_F(UnionManifolds, BadInputIsRefusedByName) {
  const PieceBody floor = *PieceBody::of_sheet(floor_of_cells().view()), body = box(0.2);
  EXPECT_EQ(refusal({&floor, Pose()}, {&floor, Pose()}), "unsupported a");
  settings_.one_sided = true;
  EXPECT_EQ(refusal({&body, Pose()}, {&body, Pose()}), "unsupported one_sided");
  settings_ = {.breaking_threshold = -1};
  EXPECT_EQ(refusal({&body, Pose()}, {&floor, Pose()}), "bad_value breaking_threshold");
  settings_ = {.way = std::nan("")};
  EXPECT_EQ(refusal({&body, Pose()}, {&floor, Pose()}), "bad_value way");
  const auto fault = [](Mesh mesh, double margin = 0) {
    const auto made = PieceBody::of_sheet(mesh.view(), margin);
    return made ? "" : std::string(to_string(made.error().code)) + " " + made.error().where;
  };
  Mesh mesh = floor_of_cells();
  EXPECT_EQ(fault(mesh, -1), "bad_value margin");
  mesh.corners[7] = 81;
  EXPECT_EQ(fault(mesh), "bad_faces faces[2]");
  mesh.corners[7] = 0;
  mesh.points[5].y() = HUGE_VAL;
  EXPECT_EQ(fault(mesh), "non_finite points[5]");
  mesh.points[5].y() = 1e301;
  EXPECT_EQ(fault(mesh), "out_of_range points[5]");
  Mesh line;
  line.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.add({0, 1, 2});
  EXPECT_EQ(fault(line), "too_few_points faces");
}

// A part's contact that is turned to a facet far behind is no way out: this one was 1.52 times as long as the shortest.
TEST_F(UnionManifolds, TheFirstPatchOfDeepUnionsIsAtMostHalfAsLongAgainAsTheirDepth) {
  std::vector<Compound::Part> parts;
  for (const Vec3& cell : std::vector<Vec3>{{0, 1, 0},
                                            {1, 0, 0},
                                            {1, 0, 1},
                                            {1, 1, 0},
                                            {1, 1, 1},
                                            {1, 2, 0},
                                            {1, 2, 1},
                                            {2, 0, 0},
                                            {2, 0, 1},
                                            {2, 1, 0},
                                            {2, 2, 0},
                                            {2, 2, 1}}) {
    parts.push_back({*ConvexPolytope::box(Vec3::Constant(0.5)), at(cell.x() + 0.5, cell.y() + 0.5, cell.z() + 0.5)});
  }
  const Compound cubes = *Compound::from_parts(parts);
  const Compound hull(*ConvexPolytope::from_points(std::vector<Vec3>{
      {2, 0, 1}, {-1, 1, 1}, {-1, -2, 0}, {1, -2, -2}, {0, 0, -1}, {-1, 2, 2}, {-2, -2, 0}, {-1, 0, -1}, {-2, -1, 1}}));
  const Pose pose =
      *Pose::from_quaternion({0.19090204454302068, 0.2453276862728082, -0.036004554482891374, -0.9497759776883249},
                             Vec3(1.3236144022776464, -0.332289380302884, 2.816999718230179));
  const auto depth = penetration_depth({&cubes, Pose()}, {&hull, pose}, scratch_.depth, UnionSettings());
  ASSERT_TRUE(depth);
  const PieceBody a = PieceBody::of_compound(cubes), b = PieceBody::of_compound(hull);
  const UnionManifold found = ask({&a, Pose()}, {&b, pose});
  ASSERT_FALSE(found.patches.empty());
  double deepest = 0;
  for (int i = 0; i < found.patches.front().count; ++i) {
    deepest = std::max(deepest, found.patches.front().points[static_cast<std::size_t>(i)].contact.depth);
  }
  EXPECT_GE(deepest, depth->lower * (1 - 1e-9));
  EXPECT_LE(deepest, 1.5 * depth->upper);
}

}  // namespace
}  // namespace pd::test
