/// @file
/// Depth of unions of convex parts against two judges that share nothing with it: unions of boxes with integer corners,
/// where P is a set of unit cells and every answer is known exactly, and the exact oracle of convex pairs with samples.
#include "pd/compound/compound_depth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "compound/scene_compounds.hpp"
#include "oracle/depth_oracle.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace pd {
namespace {

Pose at(const Vec3& translation) { return *Pose::from_matrix(Mat3::Identity(), translation); }

/// A box [low, high] with integer corners.
struct Cells {
  std::array<int, 3> low;
  std::array<int, 3> high;
};

std::vector<Cells> random_boxes(int count, int range, scenes::Random& random) {
  std::vector<Cells> boxes;
  for (int k = 0; k < count; ++k) {
    Cells box{};
    for (std::size_t i = 0; i < 3; ++i) {
      box.low[i] = random.integer(-range, range - 1);
      box.high[i] = random.integer(box.low[i] + 1, range);
    }
    boxes.push_back(box);
  }
  return boxes;
}

Compound compound_of_cells(const std::vector<Cells>& boxes) {
  std::vector<Compound::Part> parts;
  for (const Cells& box : boxes) {
    scenes::Points corners;
    for (int c = 0; c < 8; ++c) {
      Vec3 x;
      for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        x[i] = (c >> i & 1) != 0 ? box.high[k] : box.low[k];
      }
      corners.push_back(x);
    }
    parts.push_back({*ConvexPolytope::from_points(corners), Pose()});
  }
  return *Compound::from_parts(std::move(parts));
}

/// P as a set of unit cells: what a person would count on squared paper.
class CellOracle {
 public:
  CellOracle(const std::vector<Cells>& a, const std::vector<Cells>& b) {
    for (const Cells& x : a) {
      for (const Cells& y : b) {
        Cells p{};
        for (std::size_t i = 0; i < 3; ++i) {
          p.low[i] = y.low[i] - x.high[i];
          p.high[i] = y.high[i] - x.low[i];
        }
        pieces_.push_back(p);
      }
    }
  }

  [[nodiscard]] ContactClass contact() const {
    bool inside = true, held = false;
    for (int c = 0; c < 8; ++c) inside = inside && covered({(c & 1) - 1, (c >> 1 & 1) - 1, (c >> 2 & 1) - 1});
    for (const Cells& p : pieces_) {
      held = held ||
             (p.low[0] <= 0 && p.high[0] >= 0 && p.low[1] <= 0 && p.high[1] >= 0 && p.low[2] <= 0 && p.high[2] >= 0);
    }
    return inside ? ContactClass::overlapping : held ? ContactClass::touching : ContactClass::separated;
  }

  /// Squared distance from the origin to the nearest cell that is not covered.
  [[nodiscard]] int depth_squared() const {
    int reach = 1;
    for (const Cells& p : pieces_) {
      for (std::size_t i = 0; i < 3; ++i) reach = std::max({reach, -p.low[i], p.high[i]});
    }
    int best = 3 * (reach + 1) * (reach + 1);
    const auto away = [](int low) { return low > 0 ? low : low < -1 ? -low - 1 : 0; };
    for (int x = -reach - 1; x <= reach; ++x) {
      for (int y = -reach - 1; y <= reach; ++y) {
        for (int z = -reach - 1; z <= reach; ++z) {
          const int d = away(x) * away(x) + away(y) * away(y) + away(z) * away(z);
          if (d < best && !covered({x, y, z})) best = d;
        }
      }
    }
    return best;
  }

  /// Least t >= 0 for which t e_axis is not inside: half-open steps along the axis.
  [[nodiscard]] int depth_along(int axis, int sign) const {
    for (int t = 0;; ++t) {
      // The point t and its eight cells.
      bool inside = true;
      for (int c = 0; c < 8; ++c) {
        std::array<int, 3> cell{(c & 1) - 1, (c >> 1 & 1) - 1, (c >> 2 & 1) - 1};
        cell[static_cast<std::size_t>(axis)] += sign * t;
        inside = inside && covered(cell);
      }
      if (!inside) return t;
    }
  }

 private:
  [[nodiscard]] bool covered(const std::array<int, 3>& cell) const {
    for (const Cells& p : pieces_) {
      bool in = true;
      for (std::size_t i = 0; i < 3; ++i) in = in && p.low[i] <= cell[i] && cell[i] < p.high[i];
      if (in) return true;
    }
    return false;
  }

  std::vector<Cells> pieces_;
};

/// Neither law nor bracket is broken, and the translation separates every pair of parts exactly.
void expect_sound(const UnionDepth& answer, const PosedCompound& a, const PosedCompound& b) {
  EXPECT_LE(answer.lower, answer.upper);
  EXPECT_NEAR(answer.normal.norm(), 1, 1e-15);
  if (answer.contact != ContactClass::overlapping) return;
  EXPECT_GT(answer.lower, 0);
  EXPECT_LE(answer.translation.norm(), answer.upper * (1 + 1e-15));
  const double size = 1 + answer.upper;
  EXPECT_LT((answer.witness_b - answer.witness_a - answer.translation).norm(), 1e-13 * size);
  EXPECT_LT((answer.normal * answer.depth - answer.translation).norm(), 1e-12 * size);
  const auto parts_a = *a.body->posed(a.pose), parts_b = *b.body->posed(b.pose);
  const auto body = [](const PosedShape& part) {
    scenes::Points points;
    for (int v = 0; v < part.shape->polytope()->num_vertices(); ++v) {
      points.push_back(part.shape->polytope()->vertex(v));
    }
    return oracle::Body(points);
  };
  for (const PosedShape& x : parts_a) {
    for (const PosedShape& y : parts_b) {
      if (x.shape->margin() > 0 || y.shape->margin() > 0) continue;
      const oracle::Body body_a = body(x), body_b = body(y);
      const oracle::ExactPair pair(body_a, x.pose, body_b, y.pose, answer.translation);
      EXPECT_NE(judge(pair, {.distance = false}).contact, ContactClass::overlapping);
    }
  }
}

/// No placement below the lower bound is free: random ones, judged by the class of every pair of parts.
void expect_no_nearer(const UnionDepth& answer, const PosedCompound& a, const PosedCompound& b, int samples) {
  scenes::Random random(77);
  Scratch scratch;
  const auto parts_a = *a.body->posed(a.pose), parts_b = *b.body->posed(b.pose);
  for (int k = 0; k < samples; ++k) {
    const double reach = answer.lower * (1 - 1e-9) * std::cbrt(random.uniform(0.2, 1));
    const Vec3 t = reach * random.direction();
    bool held = false;
    for (const PosedShape& x : parts_a) {
      for (const PosedShape& y : parts_b) {
        held = held || *point_in_difference(x, y, t, scratch) != ContactClass::separated;
      }
    }
    EXPECT_TRUE(held) << "free at (" << t.transpose() << "), below " << answer.lower;
  }
}

TEST(UnionOfParts, IntegerBoxesAreCountedExactly) {
  scenes::Random random(11);
  Scratch scratch;
  int overlapping = 0, touching = 0, walls = 0;
  for (int k = 0; k < 300; ++k) {
    const auto boxes = [&] {
      const int most = random.integer(1, 3);
      return random_boxes(random.integer(1, 4), most, random);
    };
    const auto boxes_a = boxes(), boxes_b = boxes();
    const Compound a = compound_of_cells(boxes_a), b = compound_of_cells(boxes_b);
    const CellOracle oracle(boxes_a, boxes_b);
    const PosedCompound posed_a{&a, Pose()}, posed_b{&b, Pose()};
    const UnionDepth answer = *penetration_depth(posed_a, posed_b, scratch);
    ASSERT_EQ(answer.contact, oracle.contact()) << "pair " << k;
    EXPECT_TRUE(answer.exact);
    expect_sound(answer, posed_a, posed_b);
    if (answer.contact == ContactClass::touching) ++touching;
    if (answer.contact != ContactClass::overlapping) continue;
    ++overlapping;
    const int squared = oracle.depth_squared();
    EXPECT_LE(answer.lower * answer.lower, squared * (1 + 4e-16)) << "pair " << k;
    EXPECT_GE(answer.upper * answer.upper, squared * (1 - 4e-16)) << "pair " << k;
    EXPECT_LT(answer.upper - answer.lower, 1e-14) << "pair " << k;
    ContactClass deepest = ContactClass::separated;
    const std::vector<PosedShape> parts_a = *a.posed(Pose()), parts_b = *b.posed(Pose());
    for (const PosedShape& x : parts_a) {
      for (const PosedShape& y : parts_b) deepest = std::max(deepest, penetration_depth(x, y, scratch).contact);
    }
    if (deepest == ContactClass::touching) ++walls;
    const int axis = random.integer(0, 2), sign = random.integer(0, 1) == 0 ? -1 : 1;
    const auto along = directional_depth(posed_a, posed_b, Vec3(Vec3::Unit(axis) * (3.0 * sign)), scratch);
    ASSERT_TRUE(along.has_value());
    EXPECT_EQ(along->depth, oracle.depth_along(axis, sign)) << "pair " << k;
    EXPECT_EQ(along->lower, along->upper);
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_GT(touching, 10);
  EXPECT_GT(walls, 0) << "no pair stood on a wall of zero width";
}

TEST(UnionOfParts, OctreeAgreesWithCountedCells) {
  scenes::Random random(12);
  Scratch scratch;
  for (int k = 0; k < 25; ++k) {
    const auto boxes_a = random_boxes(2, 2, random), boxes_b = random_boxes(2, 2, random);
    const Compound a = compound_of_cells(boxes_a), b = compound_of_cells(boxes_b);
    const PosedCompound posed_a{&a, Pose()}, posed_b{&b, Pose()};
    UnionSettings settings;
    settings.method = UnionMethod::octree;
    settings.delta = 0.05;
    const UnionDepth answer = *penetration_depth(posed_a, posed_b, scratch, settings);
    const CellOracle oracle(boxes_a, boxes_b);
    ASSERT_EQ(answer.contact, oracle.contact()) << "pair " << k;
    if (answer.contact != ContactClass::overlapping) continue;
    const double depth = std::sqrt(oracle.depth_squared());
    EXPECT_LE(answer.lower, depth * (1 + 1e-15)) << "pair " << k;
    EXPECT_GE(answer.upper, depth * (1 - 1e-15)) << "pair " << k;
    EXPECT_TRUE(answer.closed) << "pair " << k;
    EXPECT_LE(answer.upper, 1.05 * answer.lower) << "pair " << k;
    expect_sound(answer, posed_a, posed_b);
  }
}

TEST(UnionOfParts, ASlotOfZeroWidthIsNoWayOut) {
  Scratch scratch;
  const Compound cube(ConvexShape(*ConvexPolytope::box({0.5, 0.5, 0.5})));
  // A cube that stands between the legs of a U: with play of any width it is free, without play it is not.
  const Compound wide = compound_of(scenes::letter_u(1 + 0x1p-40)), exact = compound_of(scenes::letter_u(1));
  const PosedCompound here{&cube, Pose()};
  EXPECT_EQ(penetration_depth(here, {&wide, Pose()}, scratch)->contact, ContactClass::separated);
  const UnionDepth held = *penetration_depth(here, {&exact, Pose()}, scratch);
  EXPECT_EQ(held.contact, ContactClass::overlapping);
  EXPECT_EQ(held.depth, 1.5);
  const UnionDepth by_octree =
      *penetration_depth(here, {&exact, Pose()}, scratch, {.method = UnionMethod::octree, .delta = 0.05});
  EXPECT_EQ(by_octree.contact, ContactClass::overlapping);
  EXPECT_LE(by_octree.lower, 1.5);
  EXPECT_GE(by_octree.upper, 1.5);
  EXPECT_LE(by_octree.upper, 1.05 * by_octree.lower);
  const UnionSettings few{.method = UnionMethod::octree, .max_facets = 1};
  const auto refused = penetration_depth(here, {&exact, Pose()}, scratch, few);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
  const auto up = directional_depth(here, {&exact, Pose()}, Vec3::UnitY(), scratch);
  EXPECT_EQ(up->depth, 1.5);
  EXPECT_EQ(*point_in_difference(here, {&exact, Pose()}, Vec3(0, 1.5, 0), scratch), ContactClass::touching);
  EXPECT_EQ(*point_in_difference(here, {&exact, Pose()}, Vec3(0, 1.25, 0), scratch), ContactClass::overlapping);
}

TEST(UnionOfParts, APlaceInsideACavityIsFree) {
  Scratch scratch;
  const Compound room = compound_of(scenes::room(1, 0.25));
  const Compound cube(ConvexShape(*ConvexPolytope::box({0.5, 0.5, 0.5})));
  const UnionDepth in = *penetration_depth({&cube, at({0.625, 0, 0})}, {&room, Pose()}, scratch);
  EXPECT_EQ(in.depth, 0.125);
  EXPECT_EQ(in.translation, Vec3(-0.125, 0, 0));
  const UnionDepth out = *penetration_depth({&cube, at({1.5, 0, 0})}, {&room, Pose()}, scratch);
  EXPECT_EQ(out.depth, 0.25);
  EXPECT_EQ(out.translation, Vec3(0.25, 0, 0));
}

TEST(UnionOfParts, AConvexPairIsTheConvexAnswer) {
  scenes::Random random(5);
  Scratch scratch;
  for (int k = 0; k < 20; ++k) {
    const scenes::PointPair pair =
        scenes::make_pair(scenes::PairFamily::sphere, 12, scenes::DepthClass::mid, static_cast<std::uint64_t>(k));
    const ConvexShape a = *ConvexPolytope::from_points(pair.a), b = *ConvexPolytope::from_points(pair.b);
    const Compound union_a(a), union_b(b);
    const PenetrationDepth convex = penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch);
    const PosedCompound posed_a{&union_a, pair.pose_a}, posed_b{&union_b, pair.pose_b};
    const UnionDepth same = *penetration_depth(posed_a, posed_b, scratch);
    EXPECT_EQ(same.depth, convex.depth);
    EXPECT_EQ(same.translation, convex.translation);
    UnionSettings settings;
    settings.method = UnionMethod::facets;
    const UnionDepth answer = *penetration_depth(posed_a, posed_b, scratch, settings);
    ASSERT_EQ(answer.contact, convex.contact);
    EXPECT_LE(answer.lower, convex.upper);
    EXPECT_GE(answer.upper, convex.lower);
    EXPECT_LT(answer.upper - answer.lower, 1e-14);
  }
}

TEST(UnionOfParts, FamiliesAgainstTheExactOracle) {
  scenes::Random random(3);
  Scratch scratch;
  std::vector<scenes::PartList> bodies{scenes::letter_l(), scenes::letter_u(1), scenes::cross(), scenes::stack(4, 0.5),
                                       scenes::room(1, 0.25)};
  bodies.push_back(scenes::dumbbell(12, random));
  bodies.push_back(scenes::rubble(4, 8, random));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Compound a = compound_of(bodies[i]), b = compound_of(bodies[(i + 2) % bodies.size()]);
    const Pose pose = random.pose(random.direction() * 0.7);
    const PosedCompound posed_a{&a, pose}, posed_b{&b, Pose()};
    const UnionDepth answer = *penetration_depth(posed_a, posed_b, scratch);
    expect_sound(answer, posed_a, posed_b);
    if (answer.contact != ContactClass::overlapping) continue;
    EXPECT_LT(answer.upper - answer.lower, 2e-14);
    expect_no_nearer(answer, posed_a, posed_b, 60);
    UnionSettings settings;
    settings.method = UnionMethod::octree;
    settings.delta = 0.1;
    const UnionDepth rough = *penetration_depth(posed_a, posed_b, scratch, settings);
    EXPECT_LE(rough.lower, answer.upper);
    EXPECT_GE(rough.upper, answer.lower);
    EXPECT_TRUE(rough.closed);
    // Swapped, everything is turned round.
    const UnionDepth swapped = *penetration_depth(posed_b, posed_a, scratch);
    EXPECT_LE(swapped.lower, answer.upper);
    EXPECT_GE(swapped.upper, answer.lower);
    // Along the answer's own translation the ray is free no later than there.
    const auto along = directional_depth(posed_a, posed_b, answer.translation, scratch);
    ASSERT_TRUE(along.has_value());
    EXPECT_GE(along->depth, answer.lower * (1 - 1e-12));
    EXPECT_LE(along->depth, answer.upper * (1 + 1e-9));
  }
}

TEST(UnionOfParts, SweptPartsByOctree) {
  Scratch scratch;
  // A U of rounded bars and a ball between the legs: the way up is 1 + 0.25 + 0.25.
  const Compound u = *compound_of(scenes::letter_u(1)).with_margin(0.25);
  const Compound ball(*ConvexShape::sphere(0.375));
  const UnionDepth answer = *penetration_depth({&ball, at({0, 0.5, 0})}, {&u, Pose()}, scratch);
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_FALSE(answer.exact);
  EXPECT_TRUE(answer.closed);
  EXPECT_LE(answer.upper, 1.01 * answer.lower);
  // Free height: the ball's centre above the rims, (0.5 + s)^2 + y^2 >= 0.625^2 with the rims at x = 0.5, y = 1.
  const double free = 1 + std::sqrt(0.625 * 0.625 - 0.5 * 0.5) - 0.5;
  EXPECT_LE(answer.lower, free * (1 + 1e-12));
  EXPECT_GE(answer.upper, free * (1 - 1e-12));
}

TEST(UnionOfParts, SettingsAreChecked) {
  Scratch scratch;
  const Compound cube(ConvexShape(*ConvexPolytope::box({0.5, 0.5, 0.5})));
  const Compound ball(*ConvexShape::sphere(1));
  const PosedCompound posed{&cube, Pose()}, round{&ball, Pose()};
  for (const double delta : {0.0, -1.0, 1.5, std::nan("")}) {
    UnionSettings settings;
    settings.delta = delta;
    const auto answer = penetration_depth(posed, posed, scratch, settings);
    ASSERT_FALSE(answer.has_value());
    EXPECT_EQ(answer.error().where, "delta");
  }
  UnionSettings exact;
  exact.method = UnionMethod::facets;
  EXPECT_EQ(penetration_depth(posed, round, scratch, exact).error().code, ErrorCode::unsupported);
  UnionSettings few;
  few.method = UnionMethod::facets;
  few.max_facets = 3;
  EXPECT_EQ(penetration_depth(posed, posed, scratch, few).error().code, ErrorCode::limit_exceeded);
  EXPECT_EQ(directional_depth(posed, posed, Vec3::Zero(), scratch).error().code, ErrorCode::zero_direction);
  EXPECT_EQ(directional_depth(posed, round, Vec3::UnitX(), scratch).error().code, ErrorCode::unsupported);
}

TEST(UnionDepth, OrderOfPartsChangesNoBit) {
  scenes::Random random(77);
  Scratch scratch;
  for (int round = 0; round < 60 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE(round);
    // Boxes of the integer grid tie often; a few curved parts take the other way.
    const Compound a = compound_of_cells(random_boxes(3, 3, random)), b = compound_of_cells(random_boxes(3, 3, random));
    std::vector<Compound::Part> parts(a.parts().begin(), a.parts().end());
    if (round % 6 == 0) parts[1].shape = *ConvexShape::ellipsoid(Vec3(1, 2, 1.5));
    const Compound given = *Compound::from_parts(parts);
    const Compound turned = *Compound::from_parts({parts[2], parts[0], parts[1]});
    const int place[3] = {1, 2, 0};
    UnionSettings settings;
    settings.delta = 0.25;
    const UnionDepth x = *penetration_depth({&given, Pose()}, {&b, Pose()}, scratch, settings);
    const UnionDepth y = *penetration_depth({&turned, Pose()}, {&b, Pose()}, scratch, settings);
    EXPECT_EQ(x.contact, y.contact);
    EXPECT_EQ(x.lower, y.lower);
    EXPECT_EQ(x.upper, y.upper);
    EXPECT_EQ(x.distance, y.distance);
    EXPECT_EQ(x.normal, y.normal);
    EXPECT_EQ(x.translation, y.translation);
    EXPECT_EQ(x.witness_a, y.witness_a);
    EXPECT_EQ(x.witness_b, y.witness_b);
    EXPECT_EQ(x.part_b, y.part_b);
    // Equal parts stand for each other.
    const auto same_part = [&](std::int32_t in_given, std::int32_t in_turned) {
      const Compound::Part& one = given.parts()[static_cast<std::size_t>(in_given)];
      const Compound::Part& other = turned.parts()[static_cast<std::size_t>(in_turned)];
      if (!one.shape.polytope() || !other.shape.polytope()) return place[in_given] == in_turned;
      return one.shape.polytope()->vertex(0) == other.shape.polytope()->vertex(0) &&
             one.shape.polytope()->vertex(7) == other.shape.polytope()->vertex(7);
    };
    EXPECT_TRUE(same_part(x.part_a, y.part_a));
    EXPECT_EQ(x.feature_a.kind, y.feature_a.kind);
    EXPECT_EQ(x.feature_a.first, y.feature_a.first);
    if (round % 6 == 0) continue;
    const auto ray_x = directional_depth({&given, Pose()}, {&b, Pose()}, Vec3(1, 1, 0), scratch);
    const auto ray_y = directional_depth({&turned, Pose()}, {&b, Pose()}, Vec3(1, 1, 0), scratch);
    EXPECT_EQ(ray_x->upper, ray_y->upper);
    if (ray_x->contact == ContactClass::overlapping) {
      EXPECT_TRUE(same_part(ray_x->part_a, ray_y->part_a));
    }
  }
}

}  // namespace
}  // namespace pd
