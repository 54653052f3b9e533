/// @file
/// An allocation that fails ends the call by std::bad_alloc and nothing else: what was built so far is given back (the
/// sanitizers watch), and the same scratch answers the next call as if nothing had been.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <new>

#include "depth/allocator.hpp"
#include "oracle/judged_pair.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/minkowski_difference.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/depth/width.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::test {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;

struct Workplace {
  Scratch scratch;
  ManifoldScratch manifold;
  WarmCertificate warm;
  WarmUnion warm_union;
};
using Numbers = std::vector<double>;
using Ask = std::function<Numbers(Workplace&)>;

Numbers numbers_of(const PenetrationDepth& d) {
  return {static_cast<double>(d.contact),
          d.depth,
          d.lower,
          d.upper,
          d.distance,
          d.normal.x(),
          d.normal.y(),
          d.witness_a.x(),
          d.witness_b.z()};
}

/// Fails the first, second, ... allocation of a call (each of the first forty, then one in some), in a fresh
/// workplace, which then has to answer as an unharmed one does.
/// @return how many calls were ended
int harm(const Ask& ask) {
  Workplace unharmed;
  const Numbers expected = ask(unharmed);
  int ended = 0;
  for (std::int64_t n = 1; n < 20000; n += n < 40 ? 1 : n / 4) {
    Workplace place;
    fail_allocation(n);
    try {
      (void)ask(place);
    } catch (const std::bad_alloc&) {
      ++ended;
    }
    if (!fail_allocation(0)) return ended;  // std::stable_sort does without
    EXPECT_EQ(ask(place), expected) << "after allocation " << n << " failed";
  }
  return ended;
}

TEST(FailedAllocations, EveryMethodOfDepth) {
  for (const PairFamily family : {PairFamily::sphere, PairFamily::box, PairFamily::single_precision}) {
    const JudgedPair pair = JudgedPair::of_family(family, 16, DepthClass::mid, 7);
    for (const Method method : {Method::automatic, Method::expansion, Method::overlay, Method::decomposition,
                                Method::grid, Method::shallow}) {
      for (const Bracket bracket : {Bracket::tightest, Bracket::certified, Bracket::contact}) {
        SCOPED_TRACE(testing::Message() << pair.name() << ' ' << to_string(method) << ' ' << static_cast<int>(bracket));
        DepthSettings settings{.method = method, .bracket = bracket};
        if (method == Method::grid || method == Method::shallow) settings.delta = 0.5;
        EXPECT_GT(harm([&](Workplace& place) {
                    return numbers_of(penetration_depth(pair.a(), pair.b(), place.scratch, settings));
                  }),
                  0);
      }
    }
  }
}

/// What a memory has learned of the pair by then may stand, so that bits may differ from a cold answer's.
TEST(FailedAllocations, WarmMemories) {
  const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, 16, DepthClass::mid, 7);
  const ConvexShape cone = *ConvexShape::cone(0.6, 0.8, 1);
  const Pose apart = *Pose::from_quaternion({0.7, 0.1, 0.5, -0.5}, {1.4, 1.3, 0.2});
  const std::pair<PosedShape, PosedShape> pairs[] = {{pair.a(), pair.b()}, {{&cone, Pose()}, {&cone, apart}}};
  for (const auto& [a, b] : pairs) {
    EXPECT_GT(harm([&, a = a, b = b](Workplace& place) -> Numbers {
                Numbers rounded;
                for (int frame = 0; frame < 3; ++frame) {
                  const PenetrationDepth d = penetration_depth(a, b, place.scratch, {}, &place.warm);
                  rounded.push_back(std::round(1e9 * d.signed_distance()));
                }
                return rounded;
              }),
              0);
  }
}

TEST(FailedAllocations, RoundedAndCurvedBodies) {
  const ConvexShape box = *ConvexPolytope::box({1, 0.5, 0.3});
  const ConvexShape shapes[] = {
      *box.with_margin(0.1), *ConvexShape::cylinder(0.5, 1, 2), *ConvexShape::ellipsoid({1, 0.7, 0.4}),
      *ConvexShape::cone(0.6, 0.8, 1),
      *ConvexShape::hull_of_spheres(std::vector<Sphere>{{{0, 0, 0}, 0.6}, {{0.5, 0, 0.3}, 0.2}})};
  const Pose pose = *Pose::from_quaternion({0.7, 0.1, 0.5, -0.5}, {0.4, 0.3, 0.2});
  for (const ConvexShape& a : shapes) {
    for (const ConvexShape& b : shapes) {
      EXPECT_GT(harm([&](Workplace& place) {
                  return numbers_of(penetration_depth({&a, Pose()}, {&b, pose}, place.scratch));
                }),
                0);
    }
  }
}

TEST(FailedAllocations, WhatTheNumbersOfExactArithmeticNeed) {
  const JudgedPair pair = JudgedPair::of_family(PairFamily::scales, 12, DepthClass::mid, 3);
  EXPECT_GT(harm([&](Workplace& place) { return numbers_of(penetration_depth(pair.a(), pair.b(), place.scratch)); }),
            20);
}

TEST(FailedAllocations, QueriesBesideDepth) {
  const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, 24, DepthClass::mid, 11);
  const PosedShape a = pair.a();
  const PosedShape b = pair.b();
  const Ask asks[] = {
      [&](Workplace& place) -> Numbers {
        const auto d = directional_depth(a, b, {1, 2, 3}, place.scratch);
        return {d->depth, d->lower, d->upper};
      },
      [&](Workplace& place) -> Numbers {
        const auto d = directional_depth(a, b, {1, 2, 3}, place.scratch, DirectionalMethod::hierarchy);
        return {d->depth, d->lower, d->upper};
      },
      [&](Workplace& place) -> Numbers {
        const Width w = width(a, place.scratch);
        return {w.width, w.lower, w.upper};
      },
      [&](Workplace&) -> Numbers {
        const auto p = minkowski_difference(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose);
        return {static_cast<double>(p->num_facets())};
      },
      [&](Workplace& place) -> Numbers {
        const PenetrationDepth answer = penetration_depth(a, b, place.scratch);
        const ContactManifold points = contact_manifold(a, b, answer, 0.02, place.manifold);
        return {static_cast<double>(points.count), points.points[0].depth};
      },
      [&](Workplace& place) -> Numbers {
        MovingShape moving{a, {{0, 0, 1}, {1, 2, 0}}};
        moving.start.pose = Pose::from_trusted_matrix(a.pose.rotation(), a.pose.translation() - Vec3(0, 0, 9));
        const TimeOfImpact t = time_of_impact(moving, {b, {}}, 20, place.scratch);
        return {t.time, t.certified, t.contact.distance};
      },
  };
  for (const Ask& ask : asks) EXPECT_GT(harm(ask), 0) << &ask - asks;
}

TEST(FailedAllocations, Building) {
  scenes::Random random(5);
  const scenes::Points points = scenes::sphere_hull(60, random);
  EXPECT_GT(harm([&](Workplace&) -> Numbers {
              const auto hull = ConvexPolytope::from_points(points);
              return {static_cast<double>(hull->num_facets()), hull->radius()};
            }),
            10);
  const ConvexPolytope hull = *ConvexPolytope::from_points(points);
  EXPECT_GT(harm([&](Workplace&) -> Numbers {
              const auto levels = PolyhedralHierarchy::build(hull, HierarchyKind::inner);
              return {static_cast<double>(levels->levels().size())};
            }),
            10);
}

TEST(FailedAllocations, Unions) {
  const ConvexShape box = *ConvexPolytope::box({1, 0.2, 0.2});
  const Compound cross =
      *Compound::from_parts({{box, Pose()}, {box, *Pose::from_quaternion({M_SQRT1_2, 0, 0, M_SQRT1_2}, Vec3::Zero())}});
  const Pose pose = *Pose::from_quaternion({0.7, 0.5, 0.1, 0.5}, {0.1, 0.2, 0});
  for (const UnionMethod method : {UnionMethod::facets, UnionMethod::octree}) {
    UnionSettings settings;
    settings.method = method;
    settings.delta = 0.5;
    EXPECT_GT(harm([&](Workplace& place) {
                return numbers_of(*penetration_depth(PosedCompound{&cross, Pose()}, PosedCompound{&cross, pose},
                                                     place.scratch, settings));
              }),
              20);
  }
}

TEST(FailedAllocations, WarmUnions) {
  const ConvexShape box = *ConvexPolytope::box({1, 0.2, 0.2});
  const Compound cross =
      *Compound::from_parts({{box, Pose()}, {box, *Pose::from_quaternion({M_SQRT1_2, 0, 0, M_SQRT1_2}, Vec3::Zero())}});
  EXPECT_GT(harm([&](Workplace& place) -> Numbers {
              Numbers numbers;
              for (int frame = 0; frame < 3; ++frame) {
                const Pose pose = *Pose::from_quaternion({0.7, 0.5, 0.1, 0.5}, {0.1 + 0.001 * frame, 0.2, 0});
                const auto d = penetration_depth(PosedCompound{&cross, Pose()}, PosedCompound{&cross, pose},
                                                 place.scratch, {}, &place.warm_union);
                numbers.push_back(d->lower);
              }
              return numbers;
            }),
            20);
}

TEST(FailedAllocations, Polygons) {
  const std::vector<Point2> ell = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
  const std::vector<Point2> triangle = {{0, 0}, {0.5, 0}, {0, 0.5}};
  EXPECT_GT(harm([&](Workplace&) -> Numbers {
              const Polygon p = *Polygon::from_rings(ell);
              const Polygon q = *Polygon::from_rings(triangle);
              const auto difference = PolygonDifference::of(p, q);
              return {difference->depth({0.2, 0.3}).depth, difference->escape_depth({0.2, 0.3}).depth};
            }),
            20);
}

}  // namespace
}  // namespace pd::test
