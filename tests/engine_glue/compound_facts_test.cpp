/// @file
/// What children of a compound are to each other follows their shapes and places from step to step, and costs no more
/// than those that are met.

#include "pieces/compound_facts.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "pd/bullet/shape_cache.hpp"

namespace pd::test {
namespace {

/// Boxes of a metre, side by side along x.
class Row {
 public:
  explicit Row(int count) {
    for (int i = 0; i < count; ++i) {
      shapes_.emplace_back(btVector3(btScalar(.5), btScalar(.5), btScalar(.5)));
      compound_.addChildShape(at(i), &shapes_.back());
    }
  }
  static btTransform at(double x) { return btTransform(btQuaternion::getIdentity(), btVector3(btScalar(x), 0, 0)); }

  /// A step in which some children are near another body.
  void step(const std::vector<int>& near) {
    facts_.begin_pair(++stamp_);
    for (const int child : near) facts_.look_at({compound_, child}, cache_);
  }
  /// How many of a child's facets are covered so.
  int num_covered(int child, FacetCover cover, double slack = 1e-4) {
    int count = 0;
    for (std::size_t facet = 0; facet < 6; ++facet) {
      count += facts_.cover_of({compound_, child}, facet, slack, cache_) == cover ? 1 : 0;
    }
    return count;
  }
  int num_sealed(int child) { return num_covered(child, FacetCover::all); }
  std::vector<int> neighbours(int child) {
    const std::vector<int>* all = facts_.neighbours({compound_, child}, 1e-4, cache_);
    return all != nullptr ? *all : std::vector<int>{-1};
  }
  /// Those that rise above the top of a child near a point of it.
  std::vector<int> rising(int child, double x, double reach) {
    std::vector<int> found;
    EXPECT_TRUE(
        facts_.rising_near({compound_, child}, {Vec3(x, 0, .5), reach, 1e-4}, {Vec3::UnitZ(), .5}, cache_, found));
    return found;
  }
  bool may_hold(int child, const Vec3& point) {
    return facts_.may_hold({compound_, child}, {point, 1e-4, 1e-4}, cache_);
  }
  btCompoundShape& compound() { return compound_; }
  std::size_t num_met() const { return cache_.size(); }

 private:
  std::deque<btBoxShape> shapes_;
  btCompoundShape compound_;
  BulletShapeCache cache_;
  detail::CompoundFacts facts_;
  std::uint64_t stamp_ = 0;
};

TEST(CompoundFacts, FollowChildrenThatComeAndGo) {
  Row row(3);
  row.step({0, 1, 2});
  EXPECT_EQ(row.num_sealed(1), 2);
  EXPECT_EQ(row.num_sealed(0), 1);
  EXPECT_EQ(row.neighbours(1), (std::vector<int>{0, 2}));
  // A neighbour goes, which the other body does not meet.
  row.compound().updateChildTransform(2, Row::at(5));
  row.step({1});
  EXPECT_EQ(row.num_sealed(1), 1);
  EXPECT_EQ(row.neighbours(1), (std::vector<int>{0}));
  // It comes back, met.
  row.compound().updateChildTransform(2, Row::at(2));
  row.step({1, 2});
  EXPECT_EQ(row.num_sealed(1), 2);
  EXPECT_EQ(row.neighbours(1), (std::vector<int>{0, 2}));
  // The last child takes the place of one that is removed.
  row.compound().removeChildShapeByIndex(0);
  row.step({0, 1});
  EXPECT_EQ(row.num_sealed(0), 1);
  EXPECT_EQ(row.neighbours(0), (std::vector<int>{1}));
}

TEST(CompoundFacts, OnlyWhatRisesBesideAContactCanCoverIt) {
  Row row(3);
  row.step({0, 1, 2});
  EXPECT_TRUE(row.rising(1, 1, 2).empty());  // level, to both sides
  row.compound().updateChildTransform(2, btTransform(btQuaternion::getIdentity(), btVector3(2, 0, btScalar(.25))));
  row.step({0, 1, 2});
  EXPECT_EQ(row.rising(1, 1.25, .3), (std::vector<int>{2}));
  EXPECT_TRUE(row.rising(1, 1.25, .2).empty());  // out of reach
  EXPECT_TRUE(row.rising(0, .5, .3).empty());    // no neighbour
}

TEST(CompoundFacts, FacetsBesideANeighbourAreFreeAndThoseItStandsOnAreNot) {
  Row row(2);
  row.step({0, 1});
  EXPECT_EQ(row.num_covered(0, FacetCover::none), 5);
  EXPECT_EQ(row.num_covered(0, FacetCover::some), 0);
  // A step of half a height: the neighbour rises beside the top, which is free still.
  row.compound().updateChildTransform(1, btTransform(btQuaternion::getIdentity(), btVector3(1, 0, btScalar(.5))));
  row.step({0, 1});
  EXPECT_EQ(row.num_covered(0, FacetCover::none), 5);
  EXPECT_EQ(row.num_covered(0, FacetCover::some), 1);
  // It stands on the middle of the top and into it.
  row.compound().updateChildTransform(1, btTransform(btQuaternion::getIdentity(), btVector3(btScalar(.75), 0, 1)));
  row.step({0, 1});
  EXPECT_EQ(row.num_covered(0, FacetCover::none), 5);
  EXPECT_EQ(row.num_covered(0, FacetCover::some), 1);
  row.compound().updateChildTransform(1, btTransform(btQuaternion::getIdentity(), btVector3(btScalar(.75), 0, .5)));
  row.step({0, 1});
  EXPECT_EQ(row.num_covered(0, FacetCover::none), 4);
  EXPECT_EQ(row.num_covered(0, FacetCover::some), 2);
  // Nothing is said for a slack that is wider than neighbours are looked for.
  EXPECT_EQ(row.num_covered(0, FacetCover::some, 1), 6);
}

TEST(CompoundFacts, WhatHoldsAPointTouchesIt) {
  Row row(3);
  row.step({0, 1, 2});
  EXPECT_TRUE(row.may_hold(1, Vec3(.5, 0, .5)));
  EXPECT_TRUE(row.may_hold(1, Vec3(1.5, 0, .5)));
  EXPECT_FALSE(row.may_hold(1, Vec3(.51, 0, .5)));
  EXPECT_FALSE(row.may_hold(0, Vec3(-.5, 0, .5)));
  row.compound().updateChildTransform(2, Row::at(5));
  row.step({1});
  EXPECT_FALSE(row.may_hold(1, Vec3(1.5, 0, .5)));
}

TEST(CompoundFacts, CompareWhatIsMet) {
  Row row(2000);
  for (int i = 0; i < 3; ++i) {
    row.step({1000, 1001});
    EXPECT_EQ(row.num_sealed(1000), 2);
    EXPECT_EQ(row.neighbours(1000), (std::vector<int>{999, 1001}));
  }
  EXPECT_LE(row.num_met(), 4U);
}

}  // namespace
}  // namespace pd::test
