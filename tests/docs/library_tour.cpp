/// @file
/// The further samples of the page on C++, compiled and run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <pd/compound/compound_depth.hpp>
#include <pd/depth/directional_depth.hpp>
#include <pd/depth/minkowski_difference.hpp>
#include <pd/depth/penetration_depth.hpp>
#include <pd/depth/scratch.hpp>
#include <pd/depth/warm_certificate.hpp>
#include <pd/depth/width.hpp>
#include <pd/shape/compound.hpp>
#include <pd/shape/mesh_solid.hpp>
#include <pd/solid/solid_depth.hpp>
#include <pd/structure/decomposition.hpp>
#include <pd/structure/polyhedral_hierarchy.hpp>
#include <vector>

namespace {

pd::Pose at(double x, double y, double z) { return *pd::Pose::from_matrix(pd::Mat3::Identity(), {x, y, z}); }

void refuse() {
  // [refuse]
  const std::vector<pd::Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}};
  const pd::Expected<pd::ConvexPolytope> hull = pd::ConvexPolytope::from_points(points);
  if (!hull) std::printf("%s at %s\n", to_string(hull.error().code).data(), hull.error().where.c_str());
  // [/refuse]
}

void frames(pd::Scratch& scratch) {
  const pd::ConvexShape cube = *pd::ConvexPolytope::box({0.5, 0.5, 0.5});
  // [frames]
  pd::WarmCertificate memory;  // one for each pair of bodies
  const pd::DepthSettings contact{.bracket = pd::Bracket::certified};
  double deepest = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const pd::Pose falling = at(0, 0, 1 - 0.002 * frame);
    deepest = std::max(deepest,
                       pd::penetration_depth({&cube, falling}, {&cube, pd::Pose()}, scratch, contact, &memory).depth);
  }
  std::printf("after 60 frames %.3f deep\n", deepest);
  // [/frames]
}

void directions(pd::Scratch& scratch) {
  // [directions]
  const pd::ConvexPolytope duct = *pd::ConvexPolytope::box({0.2, 1, 0.2}),
                           wall = *pd::ConvexPolytope::box({2.5, 0.1, 1.5});
  const pd::ConvexShape a(duct), b(wall);
  const auto up = pd::directional_depth({&a, pd::Pose()}, {&b, pd::Pose()}, {0, 0, 1}, scratch);
  if (up) std::printf("the duct leaves the wall upwards after %.2f\n", up->depth);
  // [/directions]
  // [hierarchies]
  const auto inner = [](const pd::ConvexPolytope& body) {
    return *pd::PolyhedralHierarchy::build(body, pd::HierarchyKind::inner);
  };
  const pd::PolyhedralHierarchy levels_a = inner(duct), levels_b = inner(wall);
  const pd::DirectionalHierarchies both{&levels_a, &levels_b};
  const auto again = pd::directional_depth({&a, pd::Pose()}, {&b, pd::Pose()}, {0, 0, 1}, scratch,
                                           pd::DirectionalMethod::hierarchy, &both);
  std::printf("the same by %zu levels: %.2f\n", levels_a.levels().size(), again ? again->depth : -1);
  // [/hierarchies]
}

void structures(pd::Scratch& scratch) {
  // [difference]
  const pd::ConvexPolytope cube = *pd::ConvexPolytope::box({0.5, 0.5, 0.5}),
                           slab = *pd::ConvexPolytope::box({2, 1, 0.25});
  const pd::Mat3 turn = Eigen::AngleAxisd(0.5, pd::Vec3::UnitZ()).toRotationMatrix();
  const pd::Pose turned = *pd::Pose::from_matrix(turn, {0, 0, 0});
  const auto p = pd::minkowski_difference(cube, turned, slab, pd::Pose());
  if (p)
    std::printf("P has %zu vertices and %lld facets\n", p->vertices.size(), static_cast<long long>(p->num_facets()));
  // [/difference]
  // [width]
  const pd::ConvexShape body(slab);
  const pd::Width width = pd::width({&body, pd::Pose()}, scratch);
  std::printf("the slab is %.1f thin, along z: %.0f\n", width.width, std::abs(width.normal.z()));
  // [/width]
  // [bipartite]
  const pd::Decomposition pairs = pd::Decomposition::of(cube, turned, slab, pd::Pose());
  std::printf("%d complete bipartite graphs hold the edge-edge facets\n", pairs.num_pairs());
  // [/bipartite]
}

void solids(pd::Scratch& scratch) {
  // [compound]
  const pd::ConvexShape arm = *pd::ConvexPolytope::box({2, 0.5, 0.5}), post = *pd::ConvexPolytope::box({0.5, 2, 0.5});
  const pd::Compound corner = *pd::Compound::from_parts({{arm, at(1.5, 0, 0)}, {post, at(0, 1.5, 0)}});
  const pd::Compound cube = pd::ConvexShape(*pd::ConvexPolytope::box({0.5, 0.5, 0.5}));
  const auto out = pd::penetration_depth({&cube, at(0.8, 0.75, 0)}, {&corner, pd::Pose()}, scratch);
  if (out) std::printf("out of both arms: %.3f\n", out->depth);
  // [/compound]
  // [solid]
  const std::vector<pd::Vec3> points = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0},
                                        {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}};
  const std::vector<int> corners = {5, 4, 3, 2, 1, 0, 6, 7, 8,  9, 10, 11, 0,  1,  7, 6, 1, 2,
                                    8, 7, 2, 3, 9, 8, 3, 4, 10, 9, 4,  5,  11, 10, 5, 0, 6, 11};
  const std::vector<int> offsets = {0, 6, 12, 16, 20, 24, 28, 32, 36};  // where each face begins in `corners`
  const pd::MeshView mesh{.points = points, .offsets = offsets, .corners = corners};
  const pd::Expected<pd::MeshSolid> bracket = pd::MeshSolid::from_faces(mesh);
  if (!bracket) {
    std::fprintf(stderr, "%s\n", bracket.error().message.c_str());
    std::exit(1);
  }
  const auto met = pd::penetration_depth({&*bracket, pd::Pose()}, {&*bracket, at(1.25, 0, 0)}, scratch);
  if (met) std::printf("two brackets: %.2f deep\n", met->depth);
  // [/solid]
}

}  // namespace

int main() {
  pd::Scratch scratch;
  refuse();
  frames(scratch);
  directions(scratch);
  structures(scratch);
  solids(scratch);
}
