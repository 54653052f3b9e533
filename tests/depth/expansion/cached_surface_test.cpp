/// @file
/// Remembered surfaces: the faces that are left alone are farther than the nearest one that was looked at, however the
/// bodies moved.

#include "depth/expansion/cached_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

/// Squared distance of the origin from a triangle (Ericson 2005, section 5.1.5).
double squared_distance(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return a.squaredNorm();
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return b.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (a + d1 / (d1 - d3) * ab).squaredNorm();
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return c.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (a + d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return (b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  }
  return (a + (vb * ab + vc * ac) / (va + vb + vc)).squaredNorm();
}

TEST(RememberedSurface, LeavesOnlyFarFacesAlone) {
  Scratch scratch;
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3{normal(random), normal(random), normal(random)}.normalized(); };
  int looks = 0;
  int refused = 0;
  int left_alone = 0;
  for (const scenes::PairFamily family : {scenes::PairFamily::sphere, scenes::PairFamily::prism}) {
    for (const int n : {12, 60}) {  // of 8 it remembers facets (facets/remembered_pieces_test.cpp)
      for (const scenes::DepthClass depth : {scenes::DepthClass::shallow, scenes::DepthClass::mid}) {
        const scenes::PointPair points = scenes::make_pair(family, n, depth, 4);
        const ConvexShape shape_a(*ConvexPolytope::from_points(points.a));
        const ConvexShape shape_b(*ConvexPolytope::from_points(points.b));
        const PosedShape a{&shape_a, points.pose_a}, b{&shape_b, points.pose_b};
        WarmCertificate certificate;
        for (int k = 0; k < 4; ++k) {
          (void)penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &certificate);
        }
        const WarmState& state = certificate.state();
        ASSERT_GT(state.reference.clearance, 0);
        // The pair's canonical order may be the other one.
        const bool swapped = !state.reference.a->same_storage(*shape_a.polytope());
        for (int trial = 0; trial < 300; ++trial) {
          const double size = std::pow(10.0, -4 + 3.5 * trial / 300);
          const auto moved = [&](const Pose& pose) {
            const double angle = size * normal(random);
            const Mat3 turn = Eigen::AngleAxisd(angle, direction()).toRotationMatrix();
            const double way = 0.3 * size * normal(random);
            return Pose::from_trusted_matrix(turn * pose.rotation(), pose.translation() + way * direction());
          };
          const Pose pose_a = moved(points.pose_a), pose_b = moved(points.pose_b);
          const PolytopeDifference difference(*state.reference.a, swapped ? pose_b : pose_a, *state.reference.b,
                                              swapped ? pose_a : pose_b);
          RememberedFace near;
          ++looks;
          if (!nearest_remembered(state, difference, near)) {
            ++refused;
            continue;
          }
          std::vector<double> distances;
          for (const CachedFace& face : state.faces) {
            Vec3 x[3];
            for (int i = 0; i < 3; ++i) {
              const VertexPair& v = state.vertices[static_cast<std::size_t>(face.vertex[i])];
              x[i] = difference.posed_vertex(v.a, v.b).x;
            }
            distances.push_back(std::sqrt(squared_distance(x[0], x[1], x[2])));
          }
          ASSERT_GE(*std::min_element(distances.begin(), distances.end()), near.distance - 1e-14);
          left_alone += static_cast<int>(distances.size()) - near.faces_seen;
        }
      }
    }
  }
  // Both happen, or nothing was tested: far jumps, and slow movement that leaves most faces alone.
  EXPECT_GT(refused, looks / 10);
  EXPECT_GT(looks - refused, looks / 10);
  EXPECT_GT(left_alone, 5 * (looks - refused));
}

}  // namespace
}  // namespace pd::detail
