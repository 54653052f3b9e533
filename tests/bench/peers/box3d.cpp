#include <box3d/collision.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "bench/peers/solver.hpp"
#include "scenes/single_precision.hpp"

extern "C" {
// box3d's separating axis test is in no public header; b3CollideHulls calls it and clips a manifold afterwards.
#include <manifold.h>
}

namespace pd::bench {

namespace {

b3Vec3 to_b3(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
Vec3 from_b3(const b3Vec3& v) { return {v.x, v.y, v.z}; }

/// Of b3CreateHull: 128 half-edge pairs.
constexpr int kMostVertices = 44;

enum class Kind : std::uint8_t { sphere, capsule, hull, other };

Kind kind_of(const ConvexShape& shape) {
  const ConvexPolytope* polytope = shape.polytope();
  if (polytope == nullptr) return Kind::other;
  if (polytope->num_vertices() == 1) return Kind::sphere;
  if (polytope->num_vertices() == 2) return Kind::capsule;
  return polytope->affine_dimension() == 3 ? Kind::hull : Kind::other;
}

/// Boxes are box3d's own.
class Box3dBody {
 public:
  explicit Box3dBody(const ConvexShape& shape) : kind(kind_of(shape)) {
    const auto radius = static_cast<float>(shape.margin());
    for (const Vec3& p : vertices_of(shape)) points.push_back(to_b3(p));
    if (kind == Kind::sphere) sphere = {points[0], radius};
    if (kind == Kind::capsule) capsule = {points[0], points[1], radius};
    if (kind != Kind::hull) return;
    if (const auto half = half_extents_of(shape)) {
      const b3Vec3 h = to_b3(*half);
      box_ = b3MakeBoxHull(h.x, h.y, h.z);
      hull = &box_.base;
    } else if (points.size() <= static_cast<std::size_t>(kMostVertices)) {
      const auto count = static_cast<int>(points.size());
      made_ = b3CreateHull(points.data(), count, count);
      hull = made_;
    }
  }
  ~Box3dBody() {
    if (made_ != nullptr) b3DestroyHull(made_);
  }
  Box3dBody(const Box3dBody&) = delete;
  Box3dBody& operator=(const Box3dBody&) = delete;

  Kind kind;
  std::vector<b3Vec3> points;
  b3Sphere sphere{};
  b3Capsule capsule{};
  const b3HullData* hull = nullptr;  ///< none where box3d refuses it

 private:
  b3BoxHull box_{};
  b3HullData* made_ = nullptr;
};

/// B in A's frame.
b3Transform relative(const Pose& a, const Pose& b) {
  const Mat3 turn = a.rotation().transpose() * b.rotation();
  const Eigen::Quaterniond q = Eigen::Quaterniond(turn).normalized();
  return {to_b3(a.rotation().transpose() * (b.translation() - a.translation())),
          {to_b3(q.vec()), static_cast<float>(q.w())}};
}

class Box3dDepth final : public Attempt {
 public:
  explicit Box3dDepth(const Bodies& bodies)
      : one_(bodies.a), other_(bodies.b), swapped_(other_.kind == Kind::hull && one_.kind != Kind::hull) {}
  void stand(const Pose& a, const Pose& b) override {
    const Pose first = scenes::to_single(swapped_ ? b : a), second = scenes::to_single(swapped_ ? a : b);
    to_world_ = first.rotation();
    transform_ = relative(first, second);
  }
  void run() override {
    const Box3dBody& a = swapped_ ? other_ : one_;
    const Box3dBody& b = swapped_ ? one_ : other_;
    if (a.kind == Kind::hull && b.kind == Kind::hull) {
      const b3AxisQuery query = b3ComputeSeparatingAxis(a.hull, b.hull, transform_, true);
      const b3SeparatingAxis axis = b3GetBestAxis(&query);
      separation_ = axis.separation;
      normal_ = axis.normal;
      return;
    }
    collide(a, b);
  }
  [[nodiscard]] Answer answer() const override {
    const double depth = -static_cast<double>(separation_);
    // The normal points from the first body to the second.
    const Vec3 translation = (swapped_ ? depth : -depth) * (to_world_ * from_b3(normal_));
    return {depth > 0, std::max(depth, 0.0), translation};
  }

 private:
  void collide(const Box3dBody& a, const Box3dBody& b) {
    b3LocalManifold manifold{};
    std::array<b3LocalManifoldPoint, 32> points;
    manifold.points = points.data();
    constexpr int kCapacity = 32;
    b3SimplexCache cache{};
    if (a.kind == Kind::hull && b.kind == Kind::capsule) {
      b3CollideHullAndCapsule(&manifold, kCapacity, a.hull, &b.capsule, transform_, &cache);
    } else if (a.kind == Kind::hull) {
      b3CollideHullAndSphere(&manifold, kCapacity, a.hull, &b.sphere, transform_, &cache);
    } else if (a.kind == Kind::capsule) {
      b3CollideCapsules(&manifold, kCapacity, &a.capsule, &b.capsule, transform_);
    } else {
      b3CollideSpheres(&manifold, kCapacity, &a.sphere, &b.sphere, transform_);
    }
    separation_ = std::numeric_limits<float>::infinity();
    for (int i = 0; i < manifold.pointCount; ++i) {
      separation_ = std::min(separation_, points[static_cast<std::size_t>(i)].separation);
    }
    normal_ = manifold.normal;
  }

  Box3dBody one_;
  Box3dBody other_;
  bool swapped_;
  Mat3 to_world_ = Mat3::Identity();
  b3Transform transform_{};
  float separation_ = 0;
  b3Vec3 normal_{};
};

/// GJK, which takes points without their hull.
class Box3dApart final : public Attempt {
 public:
  Box3dApart(const Bodies& bodies, bool warm) : warm_(warm), a_(bodies.a), b_(bodies.b) {
    input_.proxyA = {a_.points.data(), static_cast<int>(a_.points.size()), 0};
    input_.proxyB = {b_.points.data(), static_cast<int>(b_.points.size()), 0};
  }
  void stand(const Pose& a, const Pose& b) override {
    const Pose first = scenes::to_single(a);
    to_world_ = first.rotation();
    input_.transform = relative(first, scenes::to_single(b));
  }
  void run() override {
    if (!warm_) cache_ = {};
    output_ = b3ShapeDistance(&input_, &cache_, nullptr, 0);
  }
  [[nodiscard]] Answer answer() const override {
    const double distance = output_.distance;
    return {!(distance > 0), 0, to_world_ * (from_b3(output_.pointB) - from_b3(output_.pointA)), distance};
  }

 private:
  bool warm_;
  Box3dBody a_;
  Box3dBody b_;
  Mat3 to_world_ = Mat3::Identity();
  b3DistanceInput input_{};
  b3SimplexCache cache_{};
  b3DistanceOutput output_{};
};

class Box3dSolver final : public Solver {
 public:
  [[nodiscard]] std::string_view name() const override { return "box3d-sat"; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    const Kind a = kind_of(bodies.a), b = kind_of(bodies.b);
    if (a == Kind::other || b == Kind::other) return false;
    // Capsules against spheres are in no family.
    if (a != b && a != Kind::hull && b != Kind::hull) return false;
    const auto refused = [](const ConvexShape& shape) {
      const Box3dBody body(shape);
      return body.kind == Kind::hull && body.hull == nullptr;
    };
    return !refused(bodies.a) && !refused(bodies.b);
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<Box3dDepth>(bodies);
  }
};

class Box3dApartSolver final : public Solver {
 public:
  Box3dApartSolver(std::string_view name, bool warm) : name_(name), warm_(warm) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    return std::max(bodies.a.polytope()->num_vertices(), bodies.b.polytope()->num_vertices()) <=
           B3_MAX_SHAPE_CAST_POINTS;
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<Box3dApart>(bodies, warm_);
  }

 private:
  std::string_view name_;
  bool warm_;
};

}  // namespace

void add_box3d(Solvers& solvers) { solvers.push_back(std::make_unique<Box3dSolver>()); }

void add_box3d_apart(Solvers& solvers) {
  solvers.push_back(std::make_unique<Box3dApartSolver>("box3d-gjk", false));
  solvers.push_back(std::make_unique<Box3dApartSolver>("box3d-gjk-warm", true));
}

std::string box3d_note() { return "box3d (float), separating axis test alone; GJK for bodies apart"; }

}  // namespace pd::bench
