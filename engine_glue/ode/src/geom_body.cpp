#include "geom_body.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <shared_mutex>
#include <unordered_map>
#include <utility>

#include "pd/ode/install.hpp"

namespace pd {

namespace detail {

namespace {

/// Two boxes of one geom differ by rounding; a stale one differs by more. Relative to the coordinates.
constexpr double kBoxRounding = 64 * static_cast<double>(std::numeric_limits<dReal>::epsilon());

struct ToldPoints {
  std::shared_mutex mutex;
  std::unordered_map<dGeomID, std::shared_ptr<const ConvexPoints>> geoms;

  static ToldPoints& instance() {
    static ToldPoints told;
    return told;
  }
};

std::string text_of(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

BodyNumbers of_primitive(dGeomID geom) {
  dReal radius = 0, length = 0;
  switch (dGeomGetClass(geom)) {
    case dSphereClass:
      return {BodyKind::sphere, {static_cast<double>(dGeomSphereGetRadius(geom)), 0, 0}};
    case dBoxClass: {
      dVector3 sides;
      dGeomBoxGetLengths(geom, sides);
      return {
          BodyKind::box,
          {static_cast<double>(sides[0]) / 2, static_cast<double>(sides[1]) / 2, static_cast<double>(sides[2]) / 2}};
    }
    case dCapsuleClass:
      dGeomCapsuleGetParams(geom, &radius, &length);
      return {BodyKind::capsule, {static_cast<double>(radius), static_cast<double>(length) / 2, 0}};
    default:
      dGeomCylinderGetParams(geom, &radius, &length);
      return {BodyKind::cylinder, {static_cast<double>(radius), static_cast<double>(length) / 2, 0}};
  }
}

}  // namespace

std::shared_ptr<const ConvexPoints> told_points(dGeomID geom) {
  ToldPoints& told = ToldPoints::instance();
  const std::shared_lock lock(told.mutex);
  const auto found = told.geoms.find(geom);
  return found == told.geoms.end() ? nullptr : found->second;
}

Expected<GeomNumbers> geom_numbers(dGeomID geom) {
  if (dGeomGetClass(geom) != dConvexClass) return GeomNumbers{of_primitive(geom), geom};
  auto told = told_points(geom);
  if (told == nullptr) {
    return Error{ErrorCode::unsupported, "its points were not told: call pd::ode_convex(geom, points, count)",
                 "points"};
  }
  GeomNumbers found{{BodyKind::hull, {}, told->points}, geom};
  found.owner = std::move(told);
  return found;
}

Expected<Pose> geom_pose(dGeomID geom) {
  const dReal* place = dGeomGetPosition(geom);
  const dReal* rows = dGeomGetRotation(geom);
  Mat3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = static_cast<double>(rows[i / 3 * 4 + i % 3]);
  return checked_pose(rotation,
                      {static_cast<double>(place[0]), static_cast<double>(place[1]), static_cast<double>(place[2])});
}

bool is_in_its_box(dGeomID geom, const GeomNumbers& numbers, const Pose& pose) {
  if (numbers.numbers.kind != BodyKind::hull) return true;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  double reach = 0;
  const auto& points = numbers.numbers.points;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const Vec3 local(points[i], points[i + 1], points[i + 2]);
    const Vec3 p = pose.rotation() * local + pose.translation();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    reach = std::max(reach, local.cwiseAbs().maxCoeff());
  }
  dReal box[6];
  dGeomGetAABB(geom, box);
  const double slack = kBoxRounding * (reach + pose.translation().cwiseAbs().maxCoeff());
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(static_cast<double>(box[2 * axis]) - low[axis]) <= slack)) return false;
    if (!(std::abs(static_cast<double>(box[2 * axis + 1]) - high[axis]) <= slack)) return false;
  }
  return true;
}

Expected<Halfspace3> plane_of(dGeomID geom) {
  dVector4 numbers;
  dGeomPlaneGetParams(geom, numbers);
  const Vec3 normal(static_cast<double>(numbers[0]), static_cast<double>(numbers[1]), static_cast<double>(numbers[2]));
  const double offset = static_cast<double>(numbers[3]), length = normal.norm();
  if (!(std::abs(length - 1) <= 1e-3) || !(std::abs(offset) <= kLargestBody)) {
    return Error{ErrorCode::bad_value, "a plane needs a normal and a finite offset", "plane"};
  }
  return Halfspace3{normal / length, offset / length};
}

std::string name_of(dGeomID geom) {
  const int geom_class = dGeomGetClass(geom);
  if (geom_class == dPlaneClass) return "a plane";
  if (geom_class == dConvexClass) return "a convex geom";
  const std::array<double, 3> size = of_primitive(geom).size;
  switch (geom_class) {
    case dSphereClass:
      return "a sphere of radius " + text_of(size[0]);
    case dBoxClass:
      return "a box of sides " + text_of(2 * size[0]) + ", " + text_of(2 * size[1]) + ", " + text_of(2 * size[2]);
    default:
      return std::string(geom_class == dCapsuleClass ? "a capsule" : "a cylinder") + " of radius " + text_of(size[0]) +
             " and length " + text_of(2 * size[1]);
  }
}

}  // namespace detail

void ode_convex(dGeomID geom, const dReal* points, unsigned int count) {
  auto told = std::make_shared<detail::ConvexPoints>();
  for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(count); ++i) {
    told->points.push_back(static_cast<double>(points[i]));
  }
  detail::ToldPoints& all = detail::ToldPoints::instance();
  const std::scoped_lock lock(all.mutex);
  all.geoms[geom] = std::move(told);
}

void forget_ode_convex(dGeomID geom) {
  detail::ToldPoints& all = detail::ToldPoints::instance();
  const std::scoped_lock lock(all.mutex);
  all.geoms.erase(geom);
}

}  // namespace pd
