/// @file
/// Places where a solid fits exactly into another: cells of a grid, whose answers are known in whole numbers, images of
/// them by affine maps and rotations, moulds of stars, and single contacts of every kind.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "oracle/wanted_cases.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid/solid_families.hpp"

namespace pd::test {
namespace {

Pose moved(const Vec3& by) { return *Pose::from_matrix(Mat3::Identity(), by); }

/// True if no cell of one set meets the interior of a cell of the other, A's moved by halves of a cell in `by`.
bool are_free(const Cells& a, const Cells& b, const std::array<int, 3>& by) {
  for (const auto& p : a) {
    for (const auto& q : b) {
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k) meets = meets && std::abs(2 * p[k] + by[k] - 2 * q[k]) < 2;
      if (meets) return false;
    }
  }
  return true;
}

/// Free where it stands, and at no place that is half a cell away along all three axes. `by` is even, so that these
/// places lie in the sectors that planes along the axes make.
bool is_seat_of_cells(const Cells& a, const Cells& b, const std::array<int, 3>& by) {
  if (!are_free(a, b, by)) return false;
  for (int k = 0; k < 8; ++k) {
    const auto step = [&](int axis) { return by[static_cast<std::size_t>(axis)] + (k >> axis & 1 ? 1 : -1); };
    if (are_free(a, b, {step(0), step(1), step(2)})) return false;
  }
  return true;
}

Mesh mapped(Mesh mesh, const Mat3& by) {
  for (Vec3& p : mesh.points) p = by * p;
  return mesh;
}

/// Cells around a hole, from those of a box of which `a` is cut out, in two of three cases with an opening.
Cells mould_of(const Cells& a, std::mt19937_64& random) {
  for (;;) {
    Cells box;
    for (int x = -3; x < 4; ++x) {
      for (int y = -3; y < 4; ++y) {
        for (int z = -3; z < 4; ++z) {
          if (a.count({x, y, z}) == 0) box.insert({x, y, z});
        }
      }
    }
    const std::size_t axis = random() % 3;
    const int level = static_cast<int>(random() % 5) - 2;
    std::erase_if(box, [&](const auto& cell) { return cell[axis] > level; });
    if (MeshSolid::from_faces(mesh_of(box).view())) return box;
  }
}

TEST(SolidSeat, CellsOfAGridAndTheirImages) {
  std::mt19937_64 random(4);
  int touching = 0, seats = 0;
  const int cases = wanted_cases("PD_SOLID_CASES", 120);
  for (int i = 0; i < cases; ++i) {
    const Cells a = random_cells(random, 1 + static_cast<int>(random() % 4));
    const Cells b =
        i % 2 == 0 ? mould_of(a, random) : random_cells(random, 3 + static_cast<int>(random() % 12), {1, 0, 0});
    const auto step = [&]() -> int { return random() % 3 == 0 ? static_cast<int>(random() % 3) - 1 : 0; };
    const std::array<int, 3> cells = {step(), step(), step()};
    const bool known = is_seat_of_cells(a, b, {2 * cells[0], 2 * cells[1], 2 * cells[2]});
    Mat3 map = Mat3::Identity();
    if (i % 4 >= 2) map << 3, 1, 0, -1, 2, 1, 0, 1, 5;
    const Vec3 way = map * Vec3(cells[0], cells[1], cells[2]);
    Mesh mesh_a = mapped(mesh_of(a), map);
    for (Vec3& p : mesh_a.points) p += way;
    const MeshSolid solid_a = solid_of(mesh_a), solid_b = solid_of(mapped(mesh_of(b), map));
    // Both in one pose: numbers are no longer doubles, and the two fit all the same.
    const Pose pose = i % 3 == 0 ? Pose() : *Pose::from_quaternion({0.36, 0.48, -0.64, 0.48}, {0.1, 0.2, 0.3});
    const ContactClass contact = classify({&solid_a, pose}, {&solid_b, pose});
    touching += contact == ContactClass::touching;
    const Expected<bool> found = is_seat({&solid_a, pose}, {&solid_b, pose});
    ASSERT_TRUE(found) << i << found.error().message;
    ASSERT_EQ(*found, known) << i;
    ASSERT_EQ(*is_seat({&solid_b, pose}, {&solid_a, pose}), known) << i << ": exchanged";
    seats += known;
  }
  EXPECT_GT(touching, cases / 3);
  EXPECT_GT(seats, cases / 12);
  EXPECT_GT(touching, seats + cases / 12);
}

/// A star in a box from which it is cut out cannot move. Without the box's upper half it can, if nothing of the star
/// reaches below what is above it.
TEST(SolidSeat, StarsInTheirMoulds) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 6; ++i) {
    const Mesh star = mesh_of(random_star(random, i % 3, Vec3::Zero()));
    Mesh mould = mesh_of(Cells{{0, 0, 0}});
    for (Vec3& p : mould.points) p = 4 * p - Vec3::Constant(2);
    const auto first = static_cast<std::int32_t>(mould.points.size());
    mould.points.insert(mould.points.end(), star.points.begin(), star.points.end());
    for (std::size_t f = 0; f + 1 < star.offsets.size(); ++f) {
      const std::int32_t* const c = &star.corners[static_cast<std::size_t>(star.offsets[f])];
      mould.add({first + c[0], first + c[2], first + c[1]});
    }
    const MeshSolid a = solid_of(star), b = solid_of(mould);
    EXPECT_TRUE(*is_seat({&a, Pose()}, {&b, Pose()})) << i;
    EXPECT_FALSE(*is_seat({&a, Pose()}, {&a, Pose()})) << "overlapping";
    EXPECT_FALSE(*is_seat({&a, moved({9, 0, 0})}, {&b, Pose()})) << "apart";
  }
}

/// Two tetrahedra that touch are convex, so that a half-space of directions is free at least, whatever meets.
TEST(SolidSeat, ConvexBodiesThatTouchAreInNoSeat) {
  std::mt19937_64 random(8);
  const auto whole = [&] { return static_cast<double>(static_cast<int>(random() % 7) - 3); };
  int touching = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto tetrahedron = [&](bool above) {
      for (;;) {
        std::vector<Vec3> points;
        for (int k = 0; k < 4; ++k) points.emplace_back(whole(), whole(), (above ? 1 : -1) * std::abs(whole()));
        points[0].setZero();
        points[1].z() = 0;
        const auto hull = ConvexPolytope::from_points(points);
        if (hull && hull->affine_dimension() == 3) return *MeshSolid::from_polytope(*hull);
      }
    };
    const MeshSolid a = tetrahedron(true), b = tetrahedron(false);
    if (classify({&a, Pose()}, {&b, Pose()}) != ContactClass::touching) continue;
    ++touching;
    const Expected<bool> found = is_seat({&a, Pose()}, {&b, Pose()});
    ASSERT_TRUE(found) << i << found.error().message;
    EXPECT_FALSE(*found) << i;
  }
  EXPECT_GT(touching, 1000);
}

/// Spikes: a star whose corners have whole coordinates, beside another. What is free is looked for by small moves.
TEST(SolidSeat, SmallMovesOfStarsThatTouch) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> number;
  int touching = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto star = [&](const Vec3& centre) {
      Mesh mesh = mesh_of(random_star(random, i % 2, Vec3::Zero()));
      for (Vec3& p : mesh.points) p = (2 * p).array().round().matrix() + centre;
      return mesh;
    };
    const auto a = MeshSolid::from_faces(star(Vec3::Zero()).view());
    const auto b =
        MeshSolid::from_faces(star({static_cast<double>(random() % 3), 2, static_cast<double>(random() % 2)}).view());
    if (!a || !b || classify({&*a, Pose()}, {&*b, Pose()}) != ContactClass::touching) continue;
    ++touching;
    const Expected<bool> found = is_seat({&*a, Pose()}, {&*b, Pose()});
    ASSERT_TRUE(found) << i << found.error().message;
    bool free = false;
    for (int k = 0; k < 200 && !free; ++k) {
      const Vec3 way = 0x1p-16 * Vec3(number(random), number(random), number(random));
      free = classify({&*a, moved(way)}, {&*b, Pose()}) == ContactClass::separated;
    }
    ASSERT_EQ(*found, !free) << i;
  }
  EXPECT_GT(touching, 50);
}

/// Vertices of the two that do not meet, a rounding error apart, are refused by name.
TEST(SolidSeat, FeaturesThatAreTooNearAreNamed) {
  const MeshSolid a = solid_of(mesh_of(Cells{{0, 0, 0}}));
  Mesh beside = mesh_of(Cells{{0, 0, 1}});
  for (Vec3& p : beside.points) p.x() += 0x1p-40;
  const MeshSolid b = solid_of(beside);
  const Expected<bool> found = is_seat({&a, Pose()}, {&b, Pose()});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace pd::test
