#include "dart_object.hpp"

#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CapsuleShape.hpp>
#include <dart/dynamics/ConeShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/EllipsoidShape.hpp>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/MultiSphereConvexHullShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/PyramidShape.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <limits>

namespace pd::detail {

namespace {

using namespace dart::dynamics;

Expected<ConvexShape> of_points(const std::vector<Vec3>& points) {
  auto hull = ConvexPolytope::from_points(points);
  if (!hull) return hull.error();
  return ConvexShape(*std::move(hull));
}

/// The volume inside of a surface, and the sum of its faces' area vectors, which is 0 if the surface is closed.
struct Enclosed {
  double volume = 0;
  Vec3 open = Vec3::Zero();
  double area = 0;

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 across = (b - a).cross(c - a) / 2;
    volume += a.dot(across) / 3;
    open += across;
    area += across.norm();
  }
};

/// A mesh counts as convex if it differs from its hull by no more than this share of the volume: readers of meshes
/// round the corners to single precision.
constexpr double kFlatness = 1e-6;

Enclosed enclosed_by(const ConvexPolytope& hull) {
  Enclosed sum;
  for (int f = 0; f < hull.num_facets(); ++f) {
    const auto around = hull.facet_vertices(f);
    for (std::size_t i = 2; i < around.size(); ++i) {
      sum.add(hull.vertex(around[0]), hull.vertex(around[i - 1]), hull.vertex(around[i]));
    }
  }
  return sum;
}

/// The hull of all meshes of a scene, as DART's detectors take them, if the faces enclose as much as their hull.
Expected<ConvexShape> of_mesh(const MeshShape& mesh) {
  std::vector<Vec3> points;
  Enclosed sum;
  const aiScene* scene = mesh.getMesh();
  for (unsigned int m = 0; scene != nullptr && m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto vertex = [&](unsigned int v) -> Vec3 {
      const aiVector3D& p = part.mVertices[v];
      return mesh.getScale().cwiseProduct(Vec3(p.x, p.y, p.z));
    };
    for (unsigned int f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      for (unsigned int c = 0; c < face.mNumIndices; ++c) {
        if (face.mIndices[c] >= part.mNumVertices) {
          return Error{ErrorCode::bad_faces, "a face names a vertex that is not there", "mesh"};
        }
        points.push_back(vertex(face.mIndices[c]));
      }
      for (unsigned int c = 2; c < face.mNumIndices; ++c) {
        sum.add(vertex(face.mIndices[0]), vertex(face.mIndices[c - 1]), vertex(face.mIndices[c]));
      }
    }
  }
  auto hull = ConvexPolytope::from_points(points);
  if (!hull) return Error{hull.error().code, hull.error().message, "mesh (" + hull.error().where + ")"};
  const double volume = enclosed_by(*hull).volume;
  if (!(sum.open.norm() <= kFlatness * sum.area)) {
    return Error{ErrorCode::not_closed, "its faces do not close", "mesh"};
  }
  if (!(std::abs(std::abs(sum.volume) - volume) <= kFlatness * volume)) {
    return Error{ErrorCode::not_convex, "it is not convex", "mesh"};
  }
  return ConvexShape(*std::move(hull));
}

Expected<ConvexShape> of_pyramid(const PyramidShape& pyramid) {
  const double x = pyramid.getBaseWidth() / 2, y = pyramid.getBaseDepth() / 2, z = pyramid.getHeight() / 2;
  if (!(x > 0 && y > 0 && z > 0)) return Error{ErrorCode::bad_value, "a pyramid's sizes are positive", "size"};
  return of_points({{-x, -y, -z}, {x, -y, -z}, {-x, y, -z}, {x, y, -z}, {0, 0, z}});
}

Expected<ConvexShape> of_spheres(const MultiSphereConvexHullShape& hull) {
  std::vector<Sphere> spheres;
  for (const auto& [radius, centre] : hull.getSpheres()) spheres.push_back({centre, radius});
  return ConvexShape::hull_of_spheres(spheres);
}

/// The numbers of a primitive; nothing for other shapes.
std::optional<BodyNumbers> primitive(const Shape& shape) {
  if (const auto* box = dynamic_cast<const BoxShape*>(&shape)) {
    const Vec3 half = box->getSize() / 2;
    return BodyNumbers{BodyKind::box, {half[0], half[1], half[2]}};
  }
  if (const auto* sphere = dynamic_cast<const SphereShape*>(&shape)) {
    return BodyNumbers{BodyKind::sphere, {sphere->getRadius(), 0, 0}};
  }
  if (const auto* ellipsoid = dynamic_cast<const EllipsoidShape*>(&shape)) {
    const Vec3 radii = ellipsoid->getRadii();
    return BodyNumbers{BodyKind::ellipsoid, {radii[0], radii[1], radii[2]}};
  }
  if (const auto* cylinder = dynamic_cast<const CylinderShape*>(&shape)) {
    return BodyNumbers{BodyKind::cylinder, {cylinder->getRadius(), cylinder->getHeight() / 2, 0}};
  }
  if (const auto* capsule = dynamic_cast<const CapsuleShape*>(&shape)) {
    return BodyNumbers{BodyKind::capsule, {capsule->getRadius(), capsule->getHeight() / 2, 0}};
  }
  if (const auto* cone = dynamic_cast<const ConeShape*>(&shape)) {
    return BodyNumbers{BodyKind::cone, {cone->getRadius(), cone->getHeight() / 2, 0}};
  }
  return std::nullopt;
}

/// The solid that a shape is; `unsupported` for shapes that pdepth does not know.
Expected<ConvexShape> solid_of(const Shape& shape) {
  if (const auto numbers = primitive(shape)) return make_body(*numbers);
  if (const auto* mesh = dynamic_cast<const MeshShape*>(&shape)) return of_mesh(*mesh);
  if (const auto* pyramid = dynamic_cast<const PyramidShape*>(&shape)) return of_pyramid(*pyramid);
  if (const auto* hull = dynamic_cast<const MultiSphereConvexHullShape*>(&shape)) return of_spheres(*hull);
  return Error{ErrorCode::unsupported, "pdepth answers for convex shapes and planes", "shape"};
}

DartRefusal kind_of(const Shape& shape, const Error& error) {
  if (error.code == ErrorCode::unsupported && error.where == "shape") return DartRefusal::shape;
  return shape.is<MeshShape>() ? DartRefusal::mesh : DartRefusal::size;
}

DartBody refused(const ShapeFrame& frame, DartRefusal kind, const Error& error) {
  DartBody body;
  body.refusal = NamedDartRefusal{kind, name_of(frame) + ", " + error.where + ": " + error.message};
  body.radius = std::numeric_limits<double>::infinity();
  return body;
}

}  // namespace

DartBody dart_body(const ShapeFrame& frame) {
  const auto shape = frame.getShape();
  if (!shape) return refused(frame, DartRefusal::shape, {ErrorCode::unsupported, "the frame has none", "shape"});
  if (const auto* plane = dynamic_cast<const PlaneShape*>(shape.get())) {
    const double length = plane->getNormal().norm();
    if (!(std::abs(length - 1) <= 1e-6) || !(std::abs(plane->getOffset()) <= kLargestBody)) {
      return refused(frame, DartRefusal::size,
                     {ErrorCode::bad_value, "a plane needs a normal of length 1 and a finite offset", "plane"});
    }
    DartBody body;
    body.ground = Halfspace3{plane->getNormal() / length, plane->getOffset() / length};
    body.radius = std::numeric_limits<double>::infinity();
    return body;
  }
  auto solid = solid_of(*shape);
  if (!solid) return refused(frame, kind_of(*shape, solid.error()), solid.error());
  DartBody body;
  body.radius = bounding_radius(*solid);
  if (!(body.radius >= kLeastBody && body.radius <= kLargestBody)) {
    return refused(frame, kind_of(*shape, {ErrorCode::out_of_range, "", ""}),
                   {ErrorCode::out_of_range, "a body's size lies between 1e-100 and 1e100", "size"});
  }
  if (const auto* box = dynamic_cast<const BoxShape*>(shape.get())) body.half_extents = box->getSize() / 2;
  body.shape = *std::move(solid);
  return body;
}

std::string name_of(const ShapeFrame& frame) {
  const auto shape = frame.getShape();
  return "\"" + frame.getName() + "\" (" + (shape ? shape->getType() : "no shape") + ")";
}

void DartObject::convert_if_changed() {
  const auto shape = getShape();
  const std::pair<std::size_t, std::size_t> now =
      shape ? std::pair(shape->getID(), shape->getVersion()) : std::pair(std::size_t{0}, std::size_t{0});
  if (converted_ == now) return;
  body_ = dart_body(*getShapeFrame());
  converted_ = now;
}

void DartObject::updateEngineData() {
  // DART asks to refresh an object where its frame's version changed, which a new shape need not do.
  convert_if_changed();
  const Eigen::Isometry3d& place = getTransform();
  auto pose = checked_pose(place.linear(), place.translation());
  bad_pose_.reset();
  if (pose) {
    pose_ = *pose;
  } else {
    bad_pose_ = NamedDartRefusal{DartRefusal::pose, name_of(*getShapeFrame()) + ", its pose: " + pose.error().message};
  }
}

Halfspace3 DartObject::ground() const {
  const Vec3 normal = pose_.rotation() * body_.ground->normal;
  return {normal, body_.ground->offset + normal.dot(pose_.translation())};
}

void DartGroup::addCollisionObjectToEngine(dart::collision::CollisionObject* object) {
  auto* added = static_cast<DartObject*>(object);
  if (std::find(objects_.begin(), objects_.end(), added) == objects_.end()) objects_.push_back(added);
}

void DartGroup::addCollisionObjectsToEngine(const std::vector<dart::collision::CollisionObject*>& objects) {
  for (auto* object : objects) addCollisionObjectToEngine(object);
}

void DartGroup::removeCollisionObjectFromEngine(dart::collision::CollisionObject* object) {
  std::erase(objects_, static_cast<DartObject*>(object));
}

bool spheres_meet(const DartObject& a, const DartObject& b) {
  const double reach = a.body().radius + b.body().radius;
  return a.refusal() || b.refusal() || !((a.pose().translation() - b.pose().translation()).norm() > reach);
}

}  // namespace pd::detail
