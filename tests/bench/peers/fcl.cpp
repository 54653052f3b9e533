#include <fcl/config.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "bench/peers/solver.hpp"

namespace pd::bench {

namespace {

std::shared_ptr<fcl::CollisionGeometryd> hull_of(const ConvexShape& shape) {
  const ConvexPolytope& polytope = *shape.polytope();
  auto points = std::make_shared<std::vector<fcl::Vector3d>>();
  for (const Vec3& p : vertices_of(shape)) points->push_back(p);
  auto faces = std::make_shared<std::vector<int>>();
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const auto corners = polytope.facet_vertices(f);
    faces->push_back(static_cast<int>(corners.size()));
    faces->insert(faces->end(), corners.begin(), corners.end());
  }
  return std::make_shared<fcl::Convexd>(points, polytope.num_facets(), faces);
}

/// Axes run along z.
std::shared_ptr<fcl::CollisionGeometryd> to_fcl(const ConvexShape& shape) {
  if (const auto* e = std::get_if<Ellipsoid>(&shape.core())) return std::make_shared<fcl::Ellipsoidd>(e->radii);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.core())) {
    return std::make_shared<fcl::Cylinderd>(cylinder->radius, 2 * cylinder->half_height);
  }
  if (const auto* cone = std::get_if<Cone>(&shape.core())) {
    return std::make_shared<fcl::Coned>(cone->radius, 2 * cone->half_height);
  }
  if (shape.polytope()->num_vertices() == 1) return std::make_shared<fcl::Sphered>(shape.margin());
  if (shape.polytope()->num_vertices() == 2) return std::make_shared<fcl::Capsuled>(shape.margin(), length_of(shape));
  return hull_of(shape);
}

fcl::Transform3d to_fcl(const Pose& pose) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  t.linear() = pose.rotation();
  t.translation() = pose.translation();
  return t;
}

enum class FclQuery : std::uint8_t { signed_distance, contact, distance_libccd, distance_own };

class FclAttempt final : public Attempt {
 public:
  FclAttempt(const Bodies& bodies, FclQuery query) : query_(query), a_(to_fcl(bodies.a)), b_(to_fcl(bodies.b)) {}
  void stand(const Pose& a, const Pose& b) override {
    a_.setTransform(to_fcl(a));
    b_.setTransform(to_fcl(b));
  }
  void run() override {
    answer_ = {};
    // FCL reports an EPA that lost its way by an exception.
    try {
      if (query_ == FclQuery::signed_distance) {
        signed_distance();
      } else if (query_ == FclQuery::contact) {
        contact();
      } else {
        distance(query_ == FclQuery::distance_own ? fcl::GST_INDEP : fcl::GST_LIBCCD);
      }
    } catch (const std::exception&) {
      answer_ = {};
    }
  }
  [[nodiscard]] Answer answer() const override { return answer_; }

 private:
  void signed_distance() {
    const fcl::DistanceRequestd request(true, true);
    fcl::DistanceResultd result;
    const double distance = fcl::distance(&a_, &b_, request, result);
    if (!(distance < 0)) return;
    answer_ = {true, -distance, Vec3(result.nearest_points[1] - result.nearest_points[0])};
  }
  void distance(fcl::GJKSolverType solver) {
    fcl::DistanceRequestd request(true);
    request.gjk_solver_type = solver;
    fcl::DistanceResultd result;
    const double distance = fcl::distance(&a_, &b_, request, result);
    answer_ = {distance < 0, 0, Vec3(result.nearest_points[1] - result.nearest_points[0]), std::max(distance, 0.0)};
  }
  void contact() {
    const fcl::CollisionRequestd request(1, true);
    fcl::CollisionResultd result;
    if (fcl::collide(&a_, &b_, request, result) == 0) return;
    const fcl::Contactd& c = result.getContact(0);
    // The normal points from A to B.
    answer_ = {true, c.penetration_depth, Vec3(-c.penetration_depth * c.normal)};
  }

  FclQuery query_;
  fcl::CollisionObjectd a_;
  fcl::CollisionObjectd b_;
  Answer answer_;
};

class FclSolver final : public Solver {
 public:
  FclSolver(std::string_view name, FclQuery query) : name_(name), query_(query) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary64; }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<FclAttempt>(bodies, query_);
  }

 private:
  std::string_view name_;
  FclQuery query_;
};

}  // namespace

void add_fcl(Solvers& solvers) {
  solvers.push_back(std::make_unique<FclSolver>(kFclDistance, FclQuery::signed_distance));
  solvers.push_back(std::make_unique<FclSolver>("fcl-contact", FclQuery::contact));
}

void add_fcl_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<FclSolver>("fcl-libccd", FclQuery::distance_libccd));
  solvers.push_back(std::make_unique<FclSolver>("fcl-own-gjk", FclQuery::distance_own));
}

std::string fcl_note() { return "FCL " FCL_VERSION " (double, libccd below)"; }

}  // namespace pd::bench
