/// @file
/// Which four points of many stand for a patch, and that it is the same four in the next step.

#include "pd/union_contact/patches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pd::test {
namespace {

constexpr double kThreshold = 0.02;

/// Points round two rings of thirteen that face two ways, all places and depths a little off each time: of two points
/// the farthest from a third is now this, now that one.
class NoisyRings {
 public:
  void add_to(Patches& patches) {
    std::uniform_real_distribution<double> noise(-1, 1);
    for (int i = 0; i < 26; ++i) {
      const double angle = 0.2416609733530613 * i;
      ContactManifold manifold;
      manifold.normal = i % 2 == 0 ? Vec3::UnitY() : Vec3(0.8, 0.6, 0);
      const Vec3 across = manifold.normal.unitOrthogonal();
      const Vec3 place = std::cos(angle) * across + std::sin(angle) * manifold.normal.cross(across);
      const auto off = [&] { return 1e-3 * noise(random_); };
      manifold.points[0] = {Vec3::Zero(), place + Vec3{off(), off(), off()}, 0.01 + 1e-3 * off(), i};
      manifold.count = 1;
      patches.add(manifold, i, i, 0);
    }
  }

 private:
  std::mt19937 random_{7};
};

/// The pieces of a step's points, patch by patch.
std::vector<std::vector<int>> pieces_of(const Patches& patches) {
  std::vector<std::vector<int>> all;
  for (int p = 0; p < patches.size(); ++p) {
    std::vector<int> pieces;
    for (int k = 0; k < patches[p].count; ++k) pieces.push_back(patches[p].points[static_cast<std::size_t>(k)].piece);
    std::sort(pieces.begin(), pieces.end());
    all.push_back(pieces);
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<LastPatch> as_last(const Patches& patches) {
  std::vector<LastPatch> last;
  for (int p = 0; p < patches.size(); ++p) {
    LastPatch& one = last.emplace_back();
    one.normal = patches[p].normal;
    one.count = patches[p].count;
    for (std::size_t k = 0; k < static_cast<std::size_t>(one.count); ++k) {
      one.places[k] = patches[p].points[k].contact.position_b;
    }
  }
  return last;
}

/// How often of a hundred steps the choice was another than that of the step before.
int changes(bool remembers) {
  NoisyRings rings;
  Patches patches;
  std::vector<LastPatch> last;
  std::vector<std::vector<int>> before;
  int count = 0;
  for (int step = 0; step < 100; ++step) {
    patches.clear();
    rings.add_to(patches);
    patches.choose(8, kThreshold, remembers ? last : std::vector<LastPatch>());
    EXPECT_EQ(patches.size(), 2);
    const auto now = pieces_of(patches);
    count += step > 0 && now != before ? 1 : 0;
    before = now;
    last = as_last(patches);
  }
  return count;
}

TEST(Patches, TheChoiceLastsFromStepToStep) {
  EXPECT_GT(changes(false), 30);
  EXPECT_LE(changes(true), 1);
}

TEST(Patches, ChosenAgainTheyAreTheSame) {
  NoisyRings rings;
  Patches patches;
  std::vector<LastPatch> last;
  for (int step = 0; step < 20; ++step) {
    patches.clear();
    rings.add_to(patches);
    patches.choose(8, kThreshold, last);
    const auto first = pieces_of(patches);
    patches.choose(8, kThreshold, last);
    EXPECT_EQ(pieces_of(patches), first) << step;
    last = as_last(patches);
  }
}

TEST(Patches, TheDeepestIsAlwaysThere) {
  NoisyRings rings;
  Patches patches;
  std::vector<LastPatch> last;
  for (int step = 0; step < 50; ++step) {
    patches.clear();
    rings.add_to(patches);
    ContactManifold deeper;
    deeper.normal = Vec3::UnitY();
    deeper.points[0] = {Vec3::Zero(), Vec3(0.3 * step / 50, 0, 0.1), 0.012, 100};
    deeper.count = 1;
    patches.add(deeper, 100, 100, 0);
    patches.choose(8, kThreshold, last);
    const auto all = pieces_of(patches);
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const auto& pieces) { return pieces.back() == 100; }));
    last = as_last(patches);
  }
}

TEST(Patches, OnesOfTheLastStepGoOnAndEmptyOnesMakeRoom) {
  Patches patches;
  const auto add = [&](const Vec3& normal, int piece) {
    ContactManifold manifold;
    manifold.normal = normal;
    manifold.points[0] = {Vec3::Zero(), normal, 0, piece};
    manifold.count = 1;
    patches.add(manifold, piece, piece, 0);
  };
  std::vector<LastPatch> last(2);
  last[0].normal = Vec3::UnitX();
  last[1].normal = Vec3::UnitY();
  add(Vec3::UnitZ(), 0);
  add(Vec3(0.1, 1, 0).normalized(), 1);
  patches.choose(2, kThreshold, last);
  ASSERT_EQ(patches.size(), 2);
  EXPECT_EQ(patches[0].last, 1);
  EXPECT_EQ(patches[0].points[0].piece, 1);
  EXPECT_EQ(patches[1].last, -1);
  EXPECT_EQ(patches[1].points[0].piece, 0);
}

void add_point(Patches& patches, const Vec3& normal, const Vec3& place, double depth, int piece) {
  ContactManifold manifold;
  manifold.normal = normal;
  manifold.points[0] = {Vec3::Zero(), place, depth, piece};
  manifold.count = 1;
  patches.add(manifold, piece, piece, 0);
}

TEST(Patches, WhatTouchesIsWorthMoreThanWhatLiesFartherOut) {
  // A square that touches, and round it one of the double size that is most of the threshold apart.
  Patches patches;
  const double corners[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner(corners[i][0], 0, corners[i][1]);
    add_point(patches, Vec3::UnitY(), corner, 1e-4 + 1e-5 * i, i);
    add_point(patches, Vec3::UnitY(), 2 * corner, -0.7 * kThreshold, 4 + i);
  }
  patches.choose(8, kThreshold, {});
  EXPECT_EQ(pieces_of(patches), (std::vector<std::vector<int>>{{0, 1, 2, 3}}));
  // As deep as the others, they are the better ones.
  patches.clear();
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner(corners[i][0], 0, corners[i][1]);
    add_point(patches, Vec3::UnitY(), corner, 1e-4, i);
    add_point(patches, Vec3::UnitY(), 2 * corner, 1e-4, 4 + i);
  }
  patches.choose(8, kThreshold, {});
  EXPECT_EQ(pieces_of(patches), (std::vector<std::vector<int>>{{4, 5, 6, 7}}));
}

/// Few points are compared one by one, many by their order along a line: it makes no difference.
TEST(Patches, OfManyPointsTheSameOnesRepeatEachOther) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.05 * kThreshold, 0.05 * kThreshold);
  for (int trial = 0; trial < 100; ++trial) {
    Patches few, many;
    for (int i = 0; i < 8; ++i) {
      const Vec3 at{place(random), 0, place(random)};
      const double depth = 1e-4 * (8 - i);
      add_point(few, Vec3::UnitY(), at, depth, i);
      add_point(many, Vec3::UnitY(), at, depth, i);
    }
    for (int i = 0; i < 64; ++i) add_point(many, -Vec3::UnitY(), Vec3(i, 0, 0), 1e-4, 8 + i);
    few.choose(8, kThreshold, {});
    many.choose(8, kThreshold, {});
    ASSERT_EQ(few.size(), 1);
    const auto all = pieces_of(many);
    EXPECT_TRUE(std::find(all.begin(), all.end(), pieces_of(few)[0]) != all.end()) << trial;
  }
}

TEST(Patches, ACornerInAValleyIsHeldFromBothSides) {
  // Four corners of a square, each touched along two ways 16 degrees apart.
  const Vec3 left = Vec3(0.14, 1, 0).normalized(), right = Vec3(-0.14, 1, 0).normalized();
  std::vector<LastPatch> last;
  for (int step = 0; step < 3; ++step) {
    Patches patches;
    const double corners[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (int i = 0; i < 4; ++i) {
      const Vec3 corner(corners[i][0], 0, corners[i][1]);
      add_point(patches, left, corner, 1e-3, i);
      add_point(patches, right, corner + Vec3(2e-3, 0, 0), 1e-3, 4 + i);
    }
    patches.choose(8, kThreshold, last);
    ASSERT_EQ(patches.size(), 2);
    std::vector<int> all;
    for (const auto& pieces : pieces_of(patches)) all.insert(all.end(), pieces.begin(), pieces.end());
    std::sort(all.begin(), all.end());
    EXPECT_EQ(all, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
    // Both go on.
    if (step > 0) {
      EXPECT_EQ(std::abs(patches[0].last - patches[1].last), 1);
    }
    last = as_last(patches);
  }
  // What pushes the same way is one.
  Patches patches;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i % 4 < 2 ? 1 : -1, 0, i % 2 == 0 ? 1 : -1);
    add_point(patches, i < 4 ? left : Vec3(left + Vec3(0.02, 0, 0)).normalized(), corner + Vec3(2e-3 * (i / 4), 0, 0),
              1e-3, i);
  }
  patches.choose(8, kThreshold, {});
  EXPECT_EQ(patches.size(), 1);
}

}  // namespace
}  // namespace pd::test
