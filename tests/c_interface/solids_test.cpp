/// @file
/// Solids of closed meshes through the C interface: the answers of C++ in every bit, parts where a query needs them,
/// and refusals by name.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "c_interface/c_library.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_depth.hpp"
#include "pd/solid/solid_parts.hpp"
#include "solid/solid_families.hpp"

namespace pd::c_test {
namespace {

using test::Cells;
using test::Mesh;

/// Holds a mesh's numbers as long as the struct that names them is read.
struct Faces {
  std::vector<double> points;
  pdepth_faces faces = sized<pdepth_faces>();

  explicit Faces(const Mesh& mesh) : points(numbers_of(mesh.points)) {
    faces.points = points.data();
    faces.num_points = static_cast<int64_t>(mesh.points.size());
    faces.offsets = mesh.offsets.data();
    faces.num_faces = static_cast<int64_t>(mesh.offsets.size()) - 1;
    faces.vertices = mesh.corners.data();
  }
};

Shape solid(const Context& context, const Mesh& mesh, std::int32_t turn_faces = 0) {
  const Faces read(mesh);
  return make_shape(context, &pdepth_mesh_solid, &read.faces, turn_faces);
}

const Cells kHook{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}};

/// The hook, turned by a rotation that is rounded into its corners, so that no doubles hold its parts.
Mesh turned_hook() {
  Mesh mesh = test::mesh_of(kHook);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& point : mesh.points) point = turn * point;
  // Squares are no longer planar, so they are cut.
  Mesh cut;
  cut.points = mesh.points;
  for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
    const std::int32_t* const c = &mesh.corners[static_cast<std::size_t>(mesh.offsets[f])];
    cut.add({c[0], c[1], c[2]});
    cut.add({c[0], c[2], c[3]});
  }
  return cut;
}

class CSolids : public testing::Test {
 protected:
  pdepth_answer depth(const pdepth_shape* a, const pdepth_shape* b, const Pose& pose_b = Pose()) {
    pdepth_question question = question_of(a, b);
    question.pose_b = pose_of(pose_b);
    auto answer = sized<pdepth_answer>();
    EXPECT_EQ(pdepth_depth(context_.get(), &question, &answer), PDEPTH_OK) << error_of(context_);
    return answer;
  }
  std::string refusal(const Mesh& mesh) {
    const Faces read(mesh);
    pdepth_shape* shape = nullptr;
    EXPECT_NE(pdepth_mesh_solid(context_.get(), &read.faces, 0, &shape), PDEPTH_OK);
    EXPECT_EQ(shape, nullptr);
    return error_of(context_);
  }

  Context context_ = make_context();
};

void expect_bits(const pdepth_answer& c, const PenetrationDepth& answer) {
  EXPECT_EQ(c.contact, static_cast<std::int32_t>(answer.contact));
  EXPECT_EQ(c.bracket_reached, answer.bracket_reached ? 1 : 0);
  EXPECT_EQ(c.depth, answer.depth);
  EXPECT_EQ(c.lower, answer.lower);
  EXPECT_EQ(c.upper, answer.upper);
  EXPECT_EQ(c.distance, answer.distance);
  EXPECT_EQ(c.distance_lower, answer.distance_lower);
  EXPECT_EQ(c.distance_upper, answer.distance_upper);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(c.translation[k], answer.translation[k]);
    EXPECT_EQ(c.witness_a[k], answer.witness_a[k]);
    EXPECT_EQ(c.witness_b[k], answer.witness_b[k]);
  }
}

TEST_F(CSolids, AnswersAreThoseOfCpp) {
  std::mt19937_64 random(43);
  Scratch scratch;
  int contacts[3] = {};
  const Shape box = make_shape(context_, &pdepth_box, std::array<double, 3>{0.7, 0.4, 0.6}.data());
  const MeshSolid box_mesh = *MeshSolid::from_polytope(*ConvexPolytope::box({0.7, 0.4, 0.6}));
  for (int i = 0; i < 12; ++i) {
    const Mesh mesh = i % 3 == 0 ? turned_hook() : test::mesh_of(test::random_cells(random, 4));
    const Shape body = solid(context_, mesh);
    const MeshSolid twin = *MeshSolid::from_faces(mesh.view());
    std::uniform_real_distribution<double> number(-1, 1);
    const Vec3 shift = Vec3{number(random), number(random), number(random)} * (1 + i % 4);
    const double half = number(random);
    const Pose pose = *Pose::from_quaternion({std::cos(half), 0, 0, std::sin(half)}, shift);
    const pdepth_answer solids = depth(body.get(), body.get(), pose);
    expect_bits(solids, *penetration_depth(PosedSolid{&twin, Pose()}, PosedSolid{&twin, pose}, scratch));
    expect_bits(depth(body.get(), box.get(), pose),
                *penetration_depth(PosedSolid{&twin, Pose()}, PosedSolid{&box_mesh, pose}, scratch));
    ++contacts[solids.contact];
  }
  EXPECT_GT(contacts[PDEPTH_SEPARATED], 2);
  EXPECT_GT(contacts[PDEPTH_OVERLAPPING], 2);
}

TEST_F(CSolids, TheBudgetIsTheCallers) {
  std::mt19937_64 random(77);
  const Mesh mesh = test::mesh_of(test::random_star(random, 2, Vec3::Zero()));
  const Shape star = solid(context_, mesh);
  const MeshSolid twin = *MeshSolid::from_faces(mesh.view());
  const Pose pose = *Pose::from_quaternion({0.36, 0.48, -0.64, 0.48}, {0.7, 0.5, 0.25});
  Scratch scratch;
  auto settings = sized<pdepth_settings>();
  settings.max_points = 3000;
  pdepth_question question = question_of(star.get(), star.get());
  question.pose_b = pose_of(pose);
  question.settings = &settings;
  auto answer = sized<pdepth_answer>();
  ASSERT_EQ(pdepth_depth(context_.get(), &question, &answer), PDEPTH_OK) << error_of(context_);
  EXPECT_EQ(answer.bracket_reached, 0);
  expect_bits(answer,
              *penetration_depth(PosedSolid{&twin, Pose()}, PosedSolid{&twin, pose}, scratch, {.max_points = 3000}));
}

/// Curved and swept shapes stand beside any solid, also one whose parts no doubles hold.
TEST_F(CSolids, ConvexShapesBesideSolids) {
  const ConvexShape ball = *ConvexShape::sphere(0.5);
  const Shape c_ball = make_shape(context_, &pdepth_sphere, 0.5);
  Scratch scratch;
  int contacts[3] = {};
  for (const Mesh& mesh : {test::mesh_of(kHook), turned_hook()}) {
    const Shape hook = solid(context_, mesh);
    const MeshSolid twin = *MeshSolid::from_faces(mesh.view());
    for (const double height : {0.5, 1.25, 1.5, 2.5}) {
      const Pose pose = *Pose::from_matrix(Mat3::Identity(), Vec3(0.5, height, 0.5));
      const pdepth_answer answer = depth(hook.get(), c_ball.get(), pose);
      expect_bits(answer, *penetration_depth(PosedSolid{&twin, Pose()}, PosedShape{&ball, pose}, scratch));
      ++contacts[answer.contact];
      if (answer.contact != PDEPTH_SEPARATED) continue;
      EXPECT_EQ(answer.feature_a.part, PDEPTH_PART_MESH);
      EXPECT_EQ(answer.feature_b.kind, PDEPTH_FEATURE_NONE);
    }
    // Now the ball comes first.
    pdepth_question question = question_of(c_ball.get(), hook.get());
    question.pose_a = pose_of(*Pose::from_matrix(Mat3::Identity(), Vec3(0.5, 1.25, 0.5)));
    auto answer = sized<pdepth_answer>();
    ASSERT_EQ(pdepth_depth(context_.get(), &question, &answer), PDEPTH_OK) << error_of(context_);
    EXPECT_EQ(answer.contact, PDEPTH_OVERLAPPING);
    EXPECT_EQ(answer.bracket_reached, 1);
  }
  // A flat polytope is asked as a part of a union.
  const Shape hook = solid(context_, test::mesh_of(kHook));
  const std::array<double, 9> corners{0, 0, 0, 0.25, 0, 0, 0, 0.25, 0};
  const Shape triangle = make_shape(context_, &pdepth_convex_hull, corners.data(), 3);
  EXPECT_EQ(depth(hook.get(), triangle.get(), *Pose::from_matrix(Mat3::Identity(), Vec3(0.5, 0.5, 0.75))).depth, 0.25);
  EXPECT_GT(contacts[PDEPTH_SEPARATED], 0);
  EXPECT_GT(contacts[PDEPTH_TOUCHING], 0);
  EXPECT_GT(contacts[PDEPTH_OVERLAPPING], 3);
}

TEST_F(CSolids, PartsServeWhereTheMeshCannot) {
  const Mesh mesh = test::mesh_of(kHook);
  const Shape hook = solid(context_, mesh);
  const Shape ball = make_shape(context_, &pdepth_sphere, 0.5);
  const Compound parts = SolidParts::from_solid(*MeshSolid::from_faces(mesh.view()))->inner();
  const Shape swept = make_shape(context_, &pdepth_with_margin, hook.get(), 0.25);
  EXPECT_EQ(depth(swept.get(), ball.get(), *Pose::from_matrix(Mat3::Identity(), Vec3(-1, 0.5, 0.5))).distance, 0.25);
  const pdepth_part part{hook.get(), {PDEPTH_POSE_TRANSLATION, 0, {0, 0, 5}}};
  const Shape whole = make_shape(context_, &pdepth_compound, &part, 1);
  const Shape box = make_shape(context_, &pdepth_box, std::array<double, 3>{0.5, 0.5, 0.5}.data());
  EXPECT_EQ(depth(whole.get(), box.get(), *Pose::from_matrix(Mat3::Identity(), Vec3(0.5, 0.5, 4.75))).depth, 0.25);
  auto support = sized<pdepth_support_answer>();
  const std::array<double, 3> along{1, 0, 0};
  ASSERT_EQ(pdepth_support(context_.get(), hook.get(), nullptr, along.data(), &support), PDEPTH_OK);
  EXPECT_EQ(support.value, 3);
  auto info = sized<pdepth_shape_info>();
  ASSERT_EQ(pdepth_shape_describe(context_.get(), hook.get(), 0, &info), PDEPTH_OK);
  EXPECT_EQ(info.is_convex, 0);
  EXPECT_EQ(info.parts, static_cast<std::int32_t>(parts.parts().size()));

  const Shape turned = solid(context_, turned_hook());
  const pdepth_question question = question_of(turned.get(), whole.get());
  auto answer = sized<pdepth_answer>();
  EXPECT_EQ(pdepth_depth(context_.get(), &question, &answer), PDEPTH_UNSUPPORTED);
  EXPECT_NE(error_of(context_).find("question.a"), std::string::npos) << error_of(context_);
  const pdepth_question manifold = question_of(hook.get(), ball.get());
  auto points = sized<pdepth_manifold>();
  EXPECT_EQ(pdepth_contact_manifold(context_.get(), &manifold, 0, &points), PDEPTH_UNSUPPORTED);
}

TEST_F(CSolids, FeaturesAreFacesOfTheCallersMesh) {
  const Shape hook = solid(context_, test::mesh_of(kHook));
  const Shape box = make_shape(context_, &pdepth_box, std::array<double, 3>{0.25, 0.25, 0.25}.data());
  const pdepth_answer answer = depth(hook.get(), box.get(), *Pose::from_matrix(Mat3::Identity(), Vec3(2.5, 0.5, 1.25)));
  EXPECT_EQ(answer.contact, PDEPTH_TOUCHING);
  ASSERT_EQ(answer.feature_a.kind, PDEPTH_FEATURE_FACET);
  EXPECT_EQ(answer.feature_a.part, PDEPTH_PART_MESH);
  EXPECT_EQ(answer.feature_b.part, 0);
  std::array<std::int32_t, 4> corners{};
  std::int32_t count = 4;
  ASSERT_EQ(pdepth_feature_points(context_.get(), hook.get(), &answer.feature_a, corners.data(), &count), PDEPTH_OK);
  ASSERT_EQ(count, 4);
  const Mesh mesh = test::mesh_of(kHook);
  for (const std::int32_t corner : corners) EXPECT_EQ(mesh.points[static_cast<std::size_t>(corner)].z(), 1);
}

/// The surface of a solid's mesh is the caller's points, its polygons cut into triangles.
TEST_F(CSolids, TheMeshCanBeDrawn) {
  const Mesh mesh = test::mesh_of(kHook);
  const Shape hook = solid(context_, mesh);
  auto info = sized<pdepth_shape_info>();
  ASSERT_EQ(pdepth_shape_describe(context_.get(), hook.get(), PDEPTH_PART_MESH, &info), PDEPTH_OK);
  ASSERT_EQ(info.vertices, static_cast<std::int32_t>(mesh.points.size()));
  ASSERT_EQ(info.facets, static_cast<std::int32_t>(2 * (mesh.offsets.size() - 1)));
  std::vector<double> points(3 * mesh.points.size());
  std::vector<std::int32_t> offsets(static_cast<std::size_t>(info.facets) + 1), corners(3 * offsets.size() - 3);
  auto surface = sized<pdepth_surface>();
  surface.points = points.data();
  surface.offsets = offsets.data();
  surface.corners = corners.data();
  ASSERT_EQ(pdepth_shape_surface(context_.get(), hook.get(), PDEPTH_PART_MESH, &surface), PDEPTH_OK);
  EXPECT_EQ(points, numbers_of(mesh.points));
  double volume = 0;
  const auto corner = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(corners[k])]; };
  for (std::size_t k = 0; k < corners.size(); k += 3) volume += corner(k).dot(corner(k + 1).cross(corner(k + 2))) / 6;
  EXPECT_NEAR(volume, 4, 1e-12);
  const Shape ball = make_shape(context_, &pdepth_sphere, 0.5);
  EXPECT_EQ(pdepth_shape_describe(context_.get(), ball.get(), PDEPTH_PART_MESH, &info), PDEPTH_OUT_OF_RANGE);
}

TEST_F(CSolids, MeshesThatBoundNoSolidAreNamed) {
  Mesh open = test::mesh_of(kHook);
  open.offsets.pop_back();
  EXPECT_EQ(refusal(open).find("not_closed: open_edge"), 0U) << refusal(open);
  Mesh turned = test::mesh_of(kHook);
  for (std::size_t f = 0; f + 1 < turned.offsets.size(); ++f) {
    std::reverse(turned.corners.begin() + turned.offsets[f], turned.corners.begin() + turned.offsets[f + 1]);
  }
  EXPECT_EQ(refusal(turned).find("bad_faces: inside_out"), 0U) << refusal(turned);
  EXPECT_NE(solid(context_, turned, 1), nullptr);
  Mesh wrong = test::mesh_of(kHook);
  wrong.corners[5] = 1000;
  EXPECT_EQ(refusal(wrong).find("bad_faces"), 0U) << refusal(wrong);
  wrong = test::mesh_of(kHook);
  wrong.points[3].y() = NAN;
  EXPECT_EQ(refusal(wrong).find("non_finite"), 0U) << refusal(wrong);
  EXPECT_NE(refusal(wrong).find("points[3]"), std::string::npos) << refusal(wrong);
  pdepth_shape* shape = nullptr;
  EXPECT_EQ(pdepth_mesh_solid(context_.get(), nullptr, 0, &shape), PDEPTH_NULL_ARGUMENT);
}

/// Parts that are cut in another context's call live as long as the solid, so they come from the solid's own allocator.
TEST_F(CSolids, PartsComeFromTheSolidsOwnMemory) {
  struct Books {
    std::int64_t open = 0;
    static void* allocate(void* user, std::size_t bytes, std::size_t alignment) {
      ++static_cast<Books*>(user)->open;
      return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    }
    static void release(void* user, void* block, std::size_t, std::size_t) {
      --static_cast<Books*>(user)->open;
      std::free(block);
    }
  } books;
  const Shape hook = solid(context_, test::mesh_of(kHook));
  const pdepth_allocator allocator{sizeof allocator, 0, &books, &Books::allocate, &Books::release};
  {
    const Context other = make_context(&allocator);
    auto support = sized<pdepth_support_answer>();
    const std::array<double, 3> along{1, 0, 0};
    ASSERT_EQ(pdepth_support(other.get(), hook.get(), nullptr, along.data(), &support), PDEPTH_OK) << error_of(other);
    EXPECT_GT(books.open, 0);
  }
  EXPECT_EQ(books.open, 0) << "blocks of the other context live on in the solid";
}

}  // namespace
}  // namespace pd::c_test
