/// Hulls against Qhull on random clouds, and against the exact oracle of the shared hard cases.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/verify.hpp"
#include "scenes/single_precision.hpp"
#include "shape/point_clouds.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace pd {
namespace {

using test::Points;

/// Caller ids of Qhull's vertices.
std::set<int> qhull_vertices(const Points& points) {
  std::vector<double> coordinates;
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
  qhT state;
  qhT* qh = &state;
  qh_zero(qh, stderr);
  std::set<int> ids;
  char options[] = "qhull";
  if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options, nullptr, stderr) == 0) {
    vertexT* vertex = nullptr;
    FORALLvertices { ids.insert(qh_pointid(qh, vertex->point)); }
  }
  qh_freeqhull(qh, qh_ALL);
  int current = 0;
  int total = 0;
  qh_memfreeshort(qh, &current, &total);
  return ids;
}

TEST(HullPeers, SameVerticesAsQhullOnRandomClouds) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const Points& points :
         {test::box_cloud(50000, seed), test::ball_cloud(50000, seed), test::sphere_cloud(2000, seed)}) {
      const auto hull = ConvexPolytope::from_points(points);
      ASSERT_TRUE(hull.has_value());
      std::set<int> ids;
      for (int v = 0; v < hull->num_vertices(); ++v) ids.insert(hull->caller_id(v));
      EXPECT_EQ(ids, qhull_vertices(points)) << "seed " << seed;
    }
  }
}

TEST(HullPeers, HardCases) {
  const std::filesystem::path path =
      std::filesystem::path(PROJECT_SOURCE_DIR) / ".." / "shared" / "hard_cases" / "hulls.json";
  std::ifstream file(path);
  if (!file) GTEST_SKIP() << "the shared hard cases are not here";
  const nlohmann::json root = nlohmann::json::parse(file);
  int checked = 0;
  for (const auto& item : root.at("cases")) {
    const std::string name = item.at("name");
    const bool single = item.at("number_format") == "float32";
    Points points;
    for (const auto& p : item.at("points")) {
      Vec3 v;
      for (std::size_t k = 0; k < 3; ++k) {
        const double number = p.at(k).get<double>();
        v[static_cast<int>(k)] = single ? scenes::to_single(number) : number;
      }
      points.push_back(v);
    }
    const auto hull = ConvexPolytope::from_points(points);
    ASSERT_TRUE(hull.has_value()) << name;
    EXPECT_EQ(verify_polytope(*hull), "") << name;
    const auto& oracle = item.at("oracle");
    if (oracle.is_null()) continue;
    EXPECT_EQ(hull->affine_dimension(), oracle.at("affine_dim").get<int>()) << name;
    // (0, 6000, 0) of this case lies inside the edge from (0, 0, 0) to (0, 12000, 0); the oracle counts it.
    const int counted_on_edges = name == "issue_pcl6161" ? 1 : 0;
    EXPECT_EQ(hull->num_vertices(), oracle.at("hull_vertices").get<int>() - counted_on_edges) << name;
    if (hull->affine_dimension() == 3) {
      // The oracle counts facets and edges of solids only.
      EXPECT_EQ(hull->num_facets(), oracle.at("hull_facets").get<int>()) << name;
      EXPECT_EQ(hull->num_edges(), oracle.at("hull_edges").get<int>()) << name;
    }
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace pd
