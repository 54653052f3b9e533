#include <fmt/format.h>

#include <utility>

#include "BulletCollision/CollisionShapes/btConvexHullShape.h"
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

void fill(btConvexHullShape& hull, const ConvexShape& shape) {
  for (const Vec3& p : vertices_of(shape)) hull.addPoint(to_bullet(p), false);
  hull.setMargin(0);
  hull.recalcLocalAabb();
}

/// `calcPenDepth` as the pair detector calls it, on hulls with margin 0.
template <class DepthSolver>
class BulletAttempt final : public Attempt {
 public:
  BulletAttempt(const Bodies& bodies, DepthSolver& solver) : solver_(solver) {
    fill(a_, bodies.a);
    fill(b_, bodies.b);
  }
  void stand(const Pose& a, const Pose& b) override {
    pose_a_ = to_bullet(a);
    pose_b_ = to_bullet(b);
  }
  void run() override {
    direction_.setZero();
    found_ = solver_.calcPenDepth(simplex_, &a_, &b_, pose_a_, pose_b_, direction_, witness_a_, witness_b_, nullptr);
  }
  [[nodiscard]] Answer answer() const override {
    const Vec3 translation = from_bullet(witness_b_) - from_bullet(witness_a_);
    return {found_, translation.norm(), translation};
  }

 private:
  DepthSolver& solver_;
  btConvexHullShape a_;
  btConvexHullShape b_;
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
  explicit BulletSolver(std::string_view name) : name_(name) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override {
    return sizeof(btScalar) == sizeof(float) ? Precision::binary32 : Precision::binary64;
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<BulletAttempt<DepthSolver>>(bodies, solver_);
  }

 private:
  std::string_view name_;
  DepthSolver solver_;
};

/// The pair detector as Bullet's convex algorithm sets it up, on hulls with margin 0 and without a penetration solver.
class BulletApart final : public Attempt {
 public:
  BulletApart(const Bodies& bodies, bool limited) : limited_(limited) {
    fill(a_, bodies.a);
    fill(b_, bodies.b);
  }
  void stand(const Pose& a, const Pose& b) override {
    input_.m_transformA = to_bullet(a);
    input_.m_transformB = to_bullet(b);
  }
  void limit(double distance) override {
    if (limited_) input_.m_maximumDistanceSquared = static_cast<btScalar>(distance * distance);
  }
  void run() override {
    result_ = btPointCollector();
    btGjkPairDetector detector(&a_, &b_, &simplex_, nullptr);
    detector.getClosestPoints(input_, result_, nullptr);
  }
  [[nodiscard]] Answer answer() const override {
    // Without a result it says that nothing is within the limit; without a limit it has lost its way.
    if (!result_.m_hasResult) return {false, 0, Vec3::Zero(), limited_ ? std::numeric_limits<double>::infinity() : 0};
    const double distance = static_cast<double>(result_.m_distance);
    return {distance < 0, 0, -distance * from_bullet(result_.m_normalOnBInWorld), std::max(distance, 0.0)};
  }

 private:
  bool limited_;
  btConvexHullShape a_;
  btConvexHullShape b_;
  btVoronoiSimplexSolver simplex_;
  btDiscreteCollisionDetectorInterface::ClosestPointInput input_;
  btPointCollector result_;
};

class BulletApartSolver final : public Solver {
 public:
  BulletApartSolver(std::string_view name, bool limited) : name_(name), limited_(limited) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override {
    return sizeof(btScalar) == sizeof(float) ? Precision::binary32 : Precision::binary64;
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<BulletApart>(bodies, limited_);
  }

 private:
  std::string_view name_;
  bool limited_;
};

}  // namespace

void add_bullet_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<BulletApartSolver>(kBulletGjk, false));
  solvers.push_back(std::make_unique<BulletApartSolver>("bullet-beyond", true));
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
