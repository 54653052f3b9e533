#include "record/record_shapes.hpp"

#include <BulletCollision/CollisionShapes/btBox2dShape.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvex2dShape.h>
#include <BulletCollision/CollisionShapes/btUniformScalingShape.h>

#include <initializer_list>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/record/record_shape.hpp"
#include "shapes/mixed_bits.hpp"

namespace pd::detail {

namespace {

/// A key of what is added, unlike those of other kinds of shapes by `kind`.
std::uint64_t key_of(std::uint64_t kind, std::initializer_list<Vec3> points, double last = 0) {
  MixedBits bits(kind);
  for (const Vec3& point : points) bits.add(point.x()).add(point.y()).add(point.z());
  return bits.add(last).value();
}

/// Of a box to its corners; none of other shapes.
std::optional<Vec3> half_extents(const btConvexShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return to_pd(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
    case BOX_2D_SHAPE_PROXYTYPE:
      return to_pd(static_cast<const btBox2dShape&>(shape).getHalfExtentsWithMargin());
    case CONVEX_2D_SHAPE_PROXYTYPE:
      return half_extents(*static_cast<const btConvex2dShape&>(shape).getChildShape());
    case UNIFORM_SCALING_SHAPE_PROXYTYPE: {
      const auto& scaled = static_cast<const btUniformScalingShape&>(shape);
      auto half = half_extents(*scaled.getChildShape());
      if (half) *half *= static_cast<double>(scaled.getUniformScalingFactor());
      return half;
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

template <class Write>
std::string RecordShapes::known(std::uint64_t number, Write&& write_it) {
  const auto [entry, fresh] = ids_.try_emplace(number, static_cast<std::int64_t>(ids_.size()));
  std::string id = "s" + std::to_string(entry->second);
  if (fresh) write_it(id);
  return id;
}

std::optional<std::string> RecordShapes::convex(pd_record& record, const btConvexShape& shape) {
  const std::uint64_t number = shape_fingerprint(shape);
  if (ids_.contains(number)) return known(number, [](const std::string&) {});
  const auto body = to_convex_shape(shape);
  if (!body) return std::nullopt;
  return known(number, [&](const std::string& id) { record_shape(record, id, *body); });
}

std::optional<std::string> RecordShapes::sharp(pd_record& record, const btConvexShape& shape) {
  const auto half = half_extents(shape);
  if (!half) return convex(record, shape);
  const std::uint64_t key = key_of(0xB0C5, {*half});
  if (half->minCoeff() > 0) {
    return known(key, [&](const std::string& id) { pd_record_box(&record, id.c_str(), half->data(), 0); });
  }
  std::vector<double> corners;  // a rectangle
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) corners.push_back(((i >> axis) & 1) != 0 ? (*half)[axis] : -(*half)[axis]);
  }
  return known(key, [&](const std::string& id) { pd_record_convex(&record, id.c_str(), corners.data(), 8, 0); });
}

std::string RecordShapes::plane(pd_record& record, const btStaticPlaneShape& shape) {
  const Vec3 normal = to_pd(shape.getPlaneNormal());
  const auto offset = static_cast<double>(shape.getPlaneConstant());
  return known(key_of(0x91A7E, {normal}, offset),
               [&](const std::string& id) { pd_record_plane(&record, id.c_str(), normal.data(), offset); });
}

std::string RecordShapes::triangle(pd_record& record, const ConvexShape& triangle) {
  MixedBits bits(0x741A);
  const ConvexPolytope& polytope = *triangle.polytope();
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    for (const double x : polytope.vertex(v)) bits.add(x);
  }
  return known(bits.add(triangle.margin()).value(), [&](const std::string& id) { record_shape(record, id, triangle); });
}

}  // namespace pd::detail
