#include <fmt/format.h>

#include <utility>

#include "BulletCollision/CollisionShapes/btBoxShape.h"
#include "BulletCollision/CollisionShapes/btCapsuleShape.h"
#include "BulletCollision/CollisionShapes/btConeShape.h"
#include "BulletCollision/CollisionShapes/btConvexHullShape.h"
#include "BulletCollision/CollisionShapes/btCylinderShape.h"
#include "BulletCollision/CollisionShapes/btMultiSphereShape.h"
#include "BulletCollision/CollisionShapes/btSphereShape.h"
#include "BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h"
#include "BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h"
#include "BulletCollision/NarrowPhaseCollision/btMinkowskiPenetrationDepthSolver.h"
#include "BulletCollision/NarrowPhaseCollision/btPointCollector.h"
#include "BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h"
#include "bench/peers/solver.hpp"

namespace pd::bench {

namespace {

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

btTransform to_bullet(const Pose& pose) {
  const Mat3& r = pose.rotation();
  btMatrix3x3 basis;
  for (int i = 0; i < 3; ++i) basis[i] = to_bullet(Vec3(r.row(i).transpose()));
  return btTransform(basis, to_bullet(pose.translation()));
}

Vec3 from_bullet(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

std::unique_ptr<btConvexShape> hull_of(const ConvexShape& shape) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& p : vertices_of(shape)) hull->addPoint(to_bullet(p), false);
  hull->setMargin(0);
  hull->recalcLocalAabb();
  return hull;
}

/// Bullet has none of its own.
ATTRIBUTE_ALIGNED16(class)
BulletEllipsoid final : public btConvexInternalShape {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  explicit BulletEllipsoid(const btVector3& radii) : radii_(radii) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    setMargin(0);
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
    const btVector3 scaled = radii_ * direction;
    const btScalar length = scaled.length();
    return length > 0 ? radii_ * scaled / length : btVector3(radii_.x(), 0, 0);
  }
  btVector3 localGetSupportingVertex(const btVector3& direction) const override {
    return localGetSupportingVertexWithoutMargin(direction);
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* supports, int count)
      const override {
    for (int i = 0; i < count; ++i) supports[i] = localGetSupportingVertexWithoutMargin(directions[i]);
  }
  void calculateLocalInertia(btScalar, btVector3 & inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "Ellipsoid"; }

 private:
  btVector3 radii_;
};

/// Bullet's own shape of each kind, with no margin but the radius of spheres and capsules. Axes run along z.
std::unique_ptr<btConvexShape> shape_of(const ConvexShape& shape) {
  std::unique_ptr<btConvexShape> made;
  const auto scalar = [](double x) { return static_cast<btScalar>(x); };
  if (const auto* e = std::get_if<Ellipsoid>(&shape.core())) {
    made.reset(new BulletEllipsoid(to_bullet(e->radii)));
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.core())) {
    made =
        std::make_unique<btCylinderShapeZ>(to_bullet(Vec3(cylinder->radius, cylinder->radius, cylinder->half_height)));
  } else if (const auto* cone = std::get_if<Cone>(&shape.core())) {
    made = std::make_unique<btConeShapeZ>(scalar(cone->radius), scalar(2 * cone->half_height));
  } else if (const auto* hull = std::get_if<SphereHull>(&shape.core())) {
    std::vector<btVector3> centres;
    std::vector<btScalar> radii;
    for (const Sphere& s : hull->spheres()) {
      centres.push_back(to_bullet(s.centre));
      radii.push_back(scalar(s.radius + shape.margin()));
    }
    made = std::make_unique<btMultiSphereShape>(centres.data(), radii.data(), static_cast<int>(radii.size()));
  } else if (shape.polytope()->num_vertices() == 1) {
    return std::make_unique<btSphereShape>(scalar(shape.margin()));
  } else if (shape.polytope()->num_vertices() == 2) {
    return std::make_unique<btCapsuleShapeZ>(scalar(shape.margin()), scalar(length_of(shape)));
  } else if (const auto half = half_extents_of(shape)) {
    made = std::make_unique<btBoxShape>(to_bullet(*half));
  } else {
    return hull_of(shape);
  }
  made->setMargin(0);
  return made;
}

using MakeShape = std::unique_ptr<btConvexShape> (*)(const ConvexShape&);

/// `calcPenDepth` as the pair detector calls it, on hulls with margin 0.
template <class DepthSolver>
class BulletAttempt final : public Attempt {
 public:
  BulletAttempt(const Bodies& bodies, DepthSolver& solver, MakeShape make)
      : solver_(solver), a_(make(bodies.a)), b_(make(bodies.b)) {}
  void stand(const Pose& a, const Pose& b) override {
    pose_a_ = to_bullet(a);
    pose_b_ = to_bullet(b);
  }
  void run() override {
    direction_.setZero();
    found_ = solver_.calcPenDepth(simplex_, a_.get(), b_.get(), pose_a_, pose_b_, direction_, witness_a_, witness_b_,
                                  nullptr);
  }
  [[nodiscard]] Answer answer() const override {
    const Vec3 translation = from_bullet(witness_b_) - from_bullet(witness_a_);
    return {found_, translation.norm(), translation};
  }

 private:
  DepthSolver& solver_;
  std::unique_ptr<btConvexShape> a_;
  std::unique_ptr<btConvexShape> b_;
  btTransform pose_a_;
  btTransform pose_b_;
  btVoronoiSimplexSolver simplex_;
  btVector3 direction_;
  btVector3 witness_a_;
  btVector3 witness_b_;
  bool found_ = false;
};

template <class DepthSolver>
class BulletSolver final : public Solver {
 public:
  explicit BulletSolver(std::string_view name, MakeShape make = hull_of) : name_(name), make_(make) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override {
    return sizeof(btScalar) == sizeof(float) ? Precision::binary32 : Precision::binary64;
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<BulletAttempt<DepthSolver>>(bodies, solver_, make_);
  }

 private:
  std::string_view name_;
  MakeShape make_;
  DepthSolver solver_;
};

/// The pair detector as Bullet's convex algorithm sets it up: on hulls with margin 0 and without a penetration solver,
/// or with the EPA on Bullet's own shapes.
class BulletApart final : public Attempt {
 public:
  BulletApart(const Bodies& bodies, bool limited, bool overlapping)
      : limited_(limited),
        a_(overlapping ? shape_of(bodies.a) : hull_of(bodies.a)),
        b_(overlapping ? shape_of(bodies.b) : hull_of(bodies.b)),
        solver_(overlapping ? &epa_ : nullptr) {}
  void stand(const Pose& a, const Pose& b) override {
    input_.m_transformA = to_bullet(a);
    input_.m_transformB = to_bullet(b);
  }
  void limit(double distance) override {
    if (limited_) input_.m_maximumDistanceSquared = static_cast<btScalar>(distance * distance);
  }
  void run() override {
    result_ = btPointCollector();
    btGjkPairDetector detector(a_.get(), b_.get(), &simplex_, solver_);
    detector.getClosestPoints(input_, result_, nullptr);
  }
  [[nodiscard]] Answer answer() const override {
    // Without a result it says that nothing is within the limit; without a limit it has lost its way.
    if (!result_.m_hasResult) return {false, 0, Vec3::Zero(), limited_ ? std::numeric_limits<double>::infinity() : 0};
    const double distance = static_cast<double>(result_.m_distance);
    return {distance < 0, std::max(-distance, 0.0), -distance * from_bullet(result_.m_normalOnBInWorld),
            std::max(distance, 0.0)};
  }

 private:
  bool limited_;
  std::unique_ptr<btConvexShape> a_;
  std::unique_ptr<btConvexShape> b_;
  btGjkEpaPenetrationDepthSolver epa_;
  btConvexPenetrationDepthSolver* solver_;
  btVoronoiSimplexSolver simplex_;
  btDiscreteCollisionDetectorInterface::ClosestPointInput input_;
  btPointCollector result_;
};

class BulletApartSolver final : public Solver {
 public:
  BulletApartSolver(std::string_view name, bool limited, bool overlapping = false)
      : name_(name), limited_(limited), overlapping_(overlapping) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override {
    return sizeof(btScalar) == sizeof(float) ? Precision::binary32 : Precision::binary64;
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<BulletApart>(bodies, limited_, overlapping_);
  }

 private:
  std::string_view name_;
  bool limited_;
  bool overlapping_;
};

}  // namespace

void add_bullet_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<BulletApartSolver>(kBulletGjk, false));
  solvers.push_back(std::make_unique<BulletApartSolver>("bullet-beyond", true));
}

void add_bullet_curved(Solvers& solvers) {
  solvers.push_back(std::make_unique<BulletSolver<btGjkEpaPenetrationDepthSolver>>(kBulletEpa, shape_of));
  solvers.push_back(std::make_unique<BulletApartSolver>("bullet-pair", false, true));
}

void add_bullet(Solvers& solvers) {
  solvers.push_back(std::make_unique<BulletSolver<btGjkEpaPenetrationDepthSolver>>(kBulletEpa));
  solvers.push_back(std::make_unique<BulletSolver<btMinkowskiPenetrationDepthSolver>>("bullet-minkowski"));
}

std::string bullet_note() {
  return fmt::format("Bullet {}.{:02} ({}), hulls with margin 0", BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100,
                     sizeof(btScalar) == sizeof(float) ? "float" : "double");
}

}  // namespace pd::bench
