#include "pd/bullet/shape_conversion.hpp"

#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btMinkowskiSumShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "shapes/mixed_bits.hpp"

namespace pd {

namespace {

/// The sum of two polytopes has at most the product of their vertices; beyond this the hull of the products would cost
/// more than a frame (about 0.1 s).
constexpr std::size_t kMaxSumPairs = 65536;

Error unsupported(std::string message) { return {ErrorCode::unsupported, std::move(message), {}}; }

/// A refusal that names the Bullet type.
Expected<ConvexShape> named(Expected<ConvexShape> form, const btConvexShape& shape) {
  if (form) return form;
  const Error& refusal = form.error();
  return Error{refusal.code, refusal.message, shape.getName() + (refusal.where.empty() ? "" : "." + refusal.where)};
}

/// Hands every triangle corner of a mesh to `visit`.
template <class Visit>
class CornerVisitor : public btInternalTriangleIndexCallback {
 public:
  explicit CornerVisitor(Visit& visit) : visit_(visit) {}
  void internalProcessTriangleIndex(btVector3* triangle, int, int) override {
    for (int i = 0; i < 3; ++i) {
      visit_(triangle[i]);
    }
  }

 private:
  Visit& visit_;
};

/// The core of a box or cylinder, whose margin lies inside of it.
struct InsideMargin {
  btVector3 half_extents;
  btScalar margin;
};

/// A margin that reaches a half extent would leave no core on that axis. Bullet goes on with half extents below zero:
/// its support then picks the opposite corner and comes out at the right place again, straight along an axis. So the
/// outer extents are those that Bullet rests on, and the margin is as large as they allow.
InsideMargin inside_margin(const btConvexInternalShape& shape) {
  const btVector3& half = shape.getImplicitShapeDimensions();
  const btScalar margin = shape.getMarginNonVirtual();
  const btScalar least = std::min({half.x(), half.y(), half.z()});
  const btScalar outer = least + margin;
  if (least > 0 || !(outer > 0)) return {half, margin};
  /// The core keeps this share of the least outer half extent.
  constexpr btScalar kCore = btScalar(0x1p-10);
  const btScalar excess = kCore * outer - least;
  return {half + btVector3(excess, excess, excess), margin - excess};
}

/// Calls `visit` with the corners of a box.
template <class Visit>
void visit_corners(const btVector3& half, Visit&& visit) {
  for (int i = 0; i < 8; ++i) {
    visit(btVector3((i & 1) ? half.x() : -half.x(), (i & 2) ? half.y() : -half.y(), (i & 4) ? half.z() : -half.z()));
  }
}

/// Calls `visit` with the points whose hull is the core of a polyhedral shape, scaled as Bullet's support scales them.
/// @return false where the type is not polyhedral.
template <class Visit>
bool for_each_point(const btConvexShape& shape, Visit&& visit) {
  const auto visit_scaled = [&](const auto& points) {
    for (int i = 0; i < points.getNumPoints(); ++i) visit(points.getScaledPoint(i));
    return true;
  };
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
    case BOX_2D_SHAPE_PROXYTYPE: {
      const btVector3 core = inside_margin(static_cast<const btConvexInternalShape&>(shape)).half_extents;
      const btVector3 h(std::max(core.x(), btScalar(0)), std::max(core.y(), btScalar(0)),
                        std::max(core.z(), btScalar(0)));
      visit_corners(h, visit);
      return true;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      return visit_scaled(static_cast<const btConvexHullShape&>(shape));
    case CONVEX_POINT_CLOUD_SHAPE_PROXYTYPE:
      return visit_scaled(static_cast<const btConvexPointCloudShape&>(shape));
    case TRIANGLE_SHAPE_PROXYTYPE: {
      const auto& triangle = static_cast<const btTriangleShape&>(shape);
      for (int i = 0; i < 3; ++i) {
        visit(triangle.getVertexPtr(i));
      }
      return true;
    }
    case TETRAHEDRAL_SHAPE_PROXYTYPE:
    case CUSTOM_POLYHEDRAL_SHAPE_TYPE: {
      const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
      for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
        btVector3 vertex;
        polyhedron.getVertex(i, vertex);
        visit(vertex);
      }
      return true;
    }
    case CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE: {
      const auto* mesh = static_cast<const btConvexTriangleMeshShape&>(shape).getMeshInterface();
      const btVector3 everything(btScalar(BT_LARGE_FLOAT), btScalar(BT_LARGE_FLOAT), btScalar(BT_LARGE_FLOAT));
      CornerVisitor<std::remove_reference_t<Visit>> visitor(visit);
      mesh->InternalProcessAllTriangles(&visitor, -everything, everything);
      return true;
    }
    default:
      return false;
  }
}

/// The margin with which Bullet's narrow phase sees the shape.
double bullet_margin(const btConvexShape& shape) { return static_cast<double>(shape.getMarginNonVirtual()); }

/// The margin around the core of a polyhedral shape.
double margin_around_core(const btConvexShape& shape) {
  const int type = shape.getShapeType();
  if (type != BOX_SHAPE_PROXYTYPE && type != BOX_2D_SHAPE_PROXYTYPE) return bullet_margin(shape);
  return static_cast<double>(inside_margin(static_cast<const btConvexInternalShape&>(shape)).margin);
}

Expected<ConvexShape> swept_hull(const std::vector<Vec3>& points, double margin) {
  auto polytope = ConvexPolytope::from_points(points);
  if (!polytope) return polytope.error();
  return ConvexShape(std::move(polytope).value()).with_margin(margin);
}

Expected<ConvexShape> from_cylinder(const btCylinderShape& shape) {
  const InsideMargin inside = inside_margin(shape);
  const int axis = shape.getUpAxis();
  const auto radius = static_cast<double>(inside.half_extents[axis == 0 ? 1 : 0]);
  const auto half_height = static_cast<double>(inside.half_extents[axis]);
  const auto margin = static_cast<double>(inside.margin);
  if (half_height <= 0) {
    return unsupported("a cylinder without height has no exact form: give it a half height above zero");
  }
  if (radius <= 0) {
    Vec3 end = Vec3::Zero();
    end[axis] = half_height;
    return swept_hull({-end, end}, margin);
  }
  const auto core = ConvexShape::cylinder(radius, half_height, axis);
  return core ? core->with_margin(margin) : core;
}

Expected<ConvexShape> from_capsule(const btCapsuleShape& shape) {
  Vec3 end = Vec3::Zero();
  end[shape.getUpAxis()] = static_cast<double>(shape.getHalfHeight());
  return swept_hull({-end, end}, bullet_margin(shape));
}

Expected<ConvexShape> from_multisphere(const btMultiSphereShape& shape) {
  const btVector3& scaling = shape.getLocalScaling();
  if (scaling.x() != scaling.y() || scaling.x() != scaling.z()) {
    return unsupported("a multisphere scaled differently along its axes has no exact form: scale it uniformly");
  }
  std::vector<Sphere> spheres;
  for (int i = 0; i < shape.getSphereCount(); ++i) {
    spheres.push_back(
        {to_pd(shape.getSpherePosition(i) * scaling), static_cast<double>(shape.getSphereRadius(i) * scaling.x())});
  }
  return ConvexShape::hull_of_spheres(spheres);
}

Expected<ConvexShape> from_cone(const btConeShape& shape) {
  const auto radius = static_cast<double>(shape.getRadius()), height = static_cast<double>(shape.getHeight());
  if (radius <= 0 || height <= 0) {
    return unsupported("a cone without radius or height has no exact form: give it both above zero");
  }
  const auto core = ConvexShape::cone(radius, 0.5 * height, shape.getConeUpIndex());
  return core ? core->with_margin(bullet_margin(shape)) : core;
}

Expected<ConvexShape> from_uniform_scaling(const btUniformScalingShape& shape) {
  const double factor = static_cast<double>(shape.getUniformScalingFactor());
  const auto child = to_convex_shape(*shape.getChildShape());
  if (!child) {
    return child;
  }
  if (const ConvexPolytope* polytope = child->polytope()) {
    std::vector<Vec3> points;
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      points.push_back(factor * polytope->vertex(v));
    }
    return swept_hull(points, factor * child->margin());
  }
  const auto scaled = [&]() -> Expected<ConvexShape> {
    if (const auto* cylinder = std::get_if<Cylinder>(&child->core())) {
      return ConvexShape::cylinder(factor * cylinder->radius, factor * cylinder->half_height, cylinder->axis);
    }
    if (const auto* cone = std::get_if<Cone>(&child->core())) {
      return ConvexShape::cone(factor * cone->radius, factor * cone->half_height, cone->axis);
    }
    if (const auto* hull = std::get_if<SphereHull>(&child->core())) {
      std::vector<Sphere> spheres;
      for (const Sphere& s : hull->spheres()) spheres.push_back({factor * s.centre, factor * s.radius});
      return ConvexShape::hull_of_spheres(spheres);
    }
    return unsupported("a uniform scaling shape of this child has no exact form");
  }();
  return scaled ? scaled->with_margin(factor * child->margin()) : scaled;
}

Expected<ConvexShape> from_minkowski_sum(const btMinkowskiSumShape& shape) {
  const auto a = to_convex_shape(*shape.getShapeA());
  if (!a) {
    return a;
  }
  const auto b = to_convex_shape(*shape.getShapeB());
  if (!b) {
    return b;
  }
  if (a->polytope() == nullptr || b->polytope() == nullptr) {
    return unsupported(
        "a Minkowski sum with a smooth core has no exact form: sum polyhedral shapes, spheres or capsules");
  }
  const std::size_t pairs =
      static_cast<std::size_t>(a->polytope()->num_vertices()) * static_cast<std::size_t>(b->polytope()->num_vertices());
  if (pairs > kMaxSumPairs) {
    return unsupported("the Minkowski sum has more than 65,536 vertex pairs: use hulls of fewer vertices");
  }
  const Pose pose_a = to_pd(shape.getTransformA());
  const Pose pose_b = to_pd(shape.GetTransformB());
  std::vector<Vec3> points;
  points.reserve(pairs);
  for (int i = 0; i < a->polytope()->num_vertices(); ++i) {
    for (int j = 0; j < b->polytope()->num_vertices(); ++j) {
      points.push_back(pose_a.apply(a->polytope()->vertex(i)) - pose_b.apply(b->polytope()->vertex(j)));
    }
  }
  return swept_hull(points, a->margin() + b->margin());
}

/// A hash over the bits of everything that the conversion reads.
class Fingerprint {
 public:
  void add(std::uint64_t word) { lanes_[0].add(word); }
  void add(double x) { lanes_[0].add(x); }
  /// Each lane waits for its own last product alone: a hull's points are compared in a third of the time.
  void add(const btVector3& v) {
    for (std::size_t k = 0; k < 3; ++k) lanes_[k].add(static_cast<double>(v[static_cast<int>(k)]));
  }
  void add(const btTransform& transform) {
    for (int i = 0; i < 3; ++i) add(transform.getBasis()[i]);
    add(transform.getOrigin());
  }
  [[nodiscard]] std::uint64_t value() const {
    return detail::MixedBits(lanes_[0]).add(lanes_[1].value()).add(lanes_[2].value()).value();
  }

 private:
  std::array<detail::MixedBits, 3> lanes_{detail::MixedBits(0xCBF29CE484222325ULL),
                                          detail::MixedBits(0x9AE16A3B2F90404FULL),
                                          detail::MixedBits(0xC2B2AE3D27D4EB4FULL)};
};

Expected<ConvexShape> form_of(const btConvexShape& shape) {
  // Bullet takes margins off the distance of the cores, whatever their sign.
  if (bullet_margin(shape) < 0) return unsupported("a negative margin has no exact form: give it one of zero or more");
  std::vector<Vec3> points;
  if (for_each_point(shape, [&](const btVector3& point) { points.push_back(to_pd(point)); })) {
    return swept_hull(points, margin_around_core(shape));
  }
  switch (shape.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
      return swept_hull({Vec3::Zero()}, bullet_margin(shape));
    case CAPSULE_SHAPE_PROXYTYPE:
      return from_capsule(static_cast<const btCapsuleShape&>(shape));
    case CYLINDER_SHAPE_PROXYTYPE:
      return from_cylinder(static_cast<const btCylinderShape&>(shape));
    case CONE_SHAPE_PROXYTYPE:
      return from_cone(static_cast<const btConeShape&>(shape));
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
      return from_multisphere(static_cast<const btMultiSphereShape&>(shape));
    case UNIFORM_SCALING_SHAPE_PROXYTYPE:
      return from_uniform_scaling(static_cast<const btUniformScalingShape&>(shape));
    case CONVEX_2D_SHAPE_PROXYTYPE:
      return to_convex_shape(*static_cast<const btConvex2dShape&>(shape).getChildShape());
    case MINKOWSKI_SUM_SHAPE_PROXYTYPE:
    case MINKOWSKI_DIFFERENCE_SHAPE_PROXYTYPE:  // what btMinkowskiSumShape calls itself
      return from_minkowski_sum(static_cast<const btMinkowskiSumShape&>(shape));
    default:
      return unsupported("a convex type of the host's own that is not polyhedral has no exact form");
  }
}

}  // namespace

Expected<ConvexShape> to_convex_shape(const btConvexShape& shape) { return named(form_of(shape), shape); }

std::uint64_t shape_fingerprint(const btConvexShape& shape) {
  Fingerprint hash;
  const int type = shape.getShapeType();
  hash.add(static_cast<std::uint64_t>(type));
  hash.add(bullet_margin(shape));
  if (for_each_point(shape, [&](const btVector3& point) { hash.add(point); })) {
    return hash.value();
  }
  switch (type) {
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      hash.add(static_cast<double>(capsule.getHalfHeight()));
      hash.add(static_cast<std::uint64_t>(capsule.getUpAxis()));
      break;
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      hash.add(cylinder.getImplicitShapeDimensions());
      hash.add(static_cast<std::uint64_t>(cylinder.getUpAxis()));
      break;
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      hash.add(static_cast<double>(cone.getRadius()));
      hash.add(static_cast<double>(cone.getHeight()));
      hash.add(static_cast<std::uint64_t>(cone.getConeUpIndex()));
      break;
    }
    case MULTI_SPHERE_SHAPE_PROXYTYPE: {
      const auto& spheres = static_cast<const btMultiSphereShape&>(shape);
      hash.add(spheres.getLocalScaling());
      for (int i = 0; i < spheres.getSphereCount(); ++i) {
        hash.add(spheres.getSpherePosition(i));
        hash.add(static_cast<double>(spheres.getSphereRadius(i)));
      }
      break;
    }
    case UNIFORM_SCALING_SHAPE_PROXYTYPE: {
      const auto& scaled = static_cast<const btUniformScalingShape&>(shape);
      hash.add(static_cast<double>(scaled.getUniformScalingFactor()));
      hash.add(shape_fingerprint(*scaled.getChildShape()));
      break;
    }
    case CONVEX_2D_SHAPE_PROXYTYPE:
      hash.add(shape_fingerprint(*static_cast<const btConvex2dShape&>(shape).getChildShape()));
      break;
    case MINKOWSKI_SUM_SHAPE_PROXYTYPE:
    case MINKOWSKI_DIFFERENCE_SHAPE_PROXYTYPE: {
      const auto& sum = static_cast<const btMinkowskiSumShape&>(shape);
      hash.add(sum.getTransformA());
      hash.add(sum.GetTransformB());
      hash.add(shape_fingerprint(*sum.getShapeA()));
      hash.add(shape_fingerprint(*sum.getShapeB()));
      break;
    }
    default:
      break;
  }
  return hash.value();
}

std::uint64_t shape_signature(const btConvexShape& shape) {
  Fingerprint hash;
  const int type = shape.getShapeType();
  hash.add(static_cast<std::uint64_t>(type));
  hash.add(bullet_margin(shape));
  const auto add_points = [&](const auto& points) {
    hash.add(static_cast<std::uint64_t>(points.getNumPoints()));
    hash.add(std::bit_cast<std::uintptr_t>(points.getUnscaledPoints()));
    hash.add(points.getLocalScalingNV());
  };
  switch (type) {
    case CONVEX_HULL_SHAPE_PROXYTYPE:
      add_points(static_cast<const btConvexHullShape&>(shape));
      break;
    case CONVEX_POINT_CLOUD_SHAPE_PROXYTYPE:
      add_points(static_cast<const btConvexPointCloudShape&>(shape));
      break;
    case BOX_SHAPE_PROXYTYPE:
    case BOX_2D_SHAPE_PROXYTYPE:
    case SPHERE_SHAPE_PROXYTYPE:
    case CAPSULE_SHAPE_PROXYTYPE:
    case CYLINDER_SHAPE_PROXYTYPE:
      hash.add(static_cast<const btConvexInternalShape&>(shape).getImplicitShapeDimensions());
      break;
    default:
      hash.add(shape.getLocalScaling());
      break;
  }
  return hash.value();
}

Expected<ConvexShape> to_sharp_box(const btBoxShape& shape) {
  const btVector3 half = shape.getHalfExtentsWithMargin();
  auto polytope = ConvexPolytope::box(to_pd(half));
  if (polytope) {
    return ConvexShape(std::move(polytope).value());
  }
  // A box without extent on some axis is a rectangle, a segment or a point.
  std::vector<Vec3> points;
  visit_corners(half, [&](const btVector3& corner) { points.push_back(to_pd(corner)); });
  return named(swept_hull(points, 0), shape);
}

}  // namespace pd
