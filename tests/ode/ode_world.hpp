/// @file
/// Worlds of ODE for tests and measurements: bodies on a plane, stepped with contact joints.
#pragma once

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "pd/ode/install.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::test {

/// ODE, initialised while any of these lives.
struct OdeLibrary {
  OdeLibrary() { dInitODE2(0); }
  ~OdeLibrary() { dCloseODE(); }
  OdeLibrary(const OdeLibrary&) = delete;
  OdeLibrary& operator=(const OdeLibrary&) = delete;
};

/// The arrays of a convex geom, to which ODE refers. ODE wants the origin inside.
struct OdeHull {
  std::vector<dReal> planes, points;
  std::vector<unsigned int> polygons;
  unsigned int num_planes = 0, num_points = 0;

  explicit OdeHull(const std::vector<Vec3>& corners) {
    const ConvexPolytope hull = *ConvexPolytope::from_points(corners);
    num_points = static_cast<unsigned int>(hull.num_vertices());
    num_planes = static_cast<unsigned int>(hull.num_facets());
    for (int v = 0; v < hull.num_vertices(); ++v) {
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<dReal>(hull.vertex(v)[k]));
    }
    for (int f = 0; f < hull.num_facets(); ++f) {
      const auto around = hull.facet_vertices(f);
      for (int k = 0; k < 3; ++k) planes.push_back(static_cast<dReal>(hull.facet_normal(f)[k]));
      planes.push_back(static_cast<dReal>(hull.facet_normal(f).dot(hull.vertex(around[0]))));
      polygons.push_back(static_cast<unsigned int>(around.size()));
      polygons.insert(polygons.end(), around.begin(), around.end());
    }
  }
  /// The geom, of whose points pdepth is told.
  [[nodiscard]] dGeomID geom(dSpaceID space) const {
    const dGeomID made = dCreateConvex(space, planes.data(), num_planes, points.data(), num_points, polygons.data());
    ode_convex(made, points.data(), num_points);
    return made;
  }
};

inline void place(dGeomID geom, const Vec3& position, const Mat3& rotation = Mat3::Identity()) {
  dMatrix3 rows{};
  for (int i = 0; i < 9; ++i) rows[i / 3 * 4 + i % 3] = static_cast<dReal>(rotation(i / 3, i % 3));
  dGeomSetPosition(geom, static_cast<dReal>(position[0]), static_cast<dReal>(position[1]),
                   static_cast<dReal>(position[2]));
  dGeomSetRotation(geom, rows);
}

/// All contacts of two geoms.
inline std::vector<dContactGeom> contacts_of(dGeomID first, dGeomID second, int room = 16) {
  std::vector<dContactGeom> contacts(static_cast<std::size_t>(room));
  const int count = dCollide(first, second, room, contacts.data(), sizeof(dContactGeom));
  contacts.resize(static_cast<std::size_t>(count));
  return contacts;
}

/// A world with gravity along -z. Bodies weigh 1 kg each.
class OdeWorld {
 public:
  OdeWorld() : world_(dWorldCreate()), space_(dHashSpaceCreate(nullptr)), joints_(dJointGroupCreate(0)) {
    dWorldSetGravity(world_, 0, 0, static_cast<dReal>(-9.81));
    // The exact solver (dWorldStep) ends early where equal boxes share their weight equally; this one does not.
    dWorldSetQuickStepNumIterations(world_, 60);
    dWorldSetCFM(world_, static_cast<dReal>(1e-5));
  }
  ~OdeWorld() {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;

  [[nodiscard]] dSpaceID space() const { return space_; }
  [[nodiscard]] dWorldID world() const { return world_; }
  [[nodiscard]] const std::vector<dBodyID>& bodies() const { return bodies_; }
  [[nodiscard]] int contacts_of_step() const { return contacts_; }

  /// A hull that lives as long as the world.
  const OdeHull& keep(const std::vector<Vec3>& corners) { return hulls_.emplace_back(corners); }
  /// Puts a geom on a body of its own. Its inertia is that of a box of these sides.
  dBodyID body(dGeomID geom, const Vec3& position, const Vec3& sides, const Mat3& rotation = Mat3::Identity()) {
    const dBodyID body = dBodyCreate(world_);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, static_cast<dReal>(sides[0]), static_cast<dReal>(sides[1]),
                     static_cast<dReal>(sides[2]));
    dBodySetMass(body, &mass);
    dGeomSetBody(geom, body);
    place(geom, position, rotation);
    bodies_.push_back(body);
    return body;
  }
  dBodyID box(const Vec3& sides, const Vec3& position, const Mat3& rotation = Mat3::Identity()) {
    return body(
        dCreateBox(space_, static_cast<dReal>(sides[0]), static_cast<dReal>(sides[1]), static_cast<dReal>(sides[2])),
        position, sides, rotation);
  }

  void step(double seconds) {
    collide();
    solve(seconds);
  }
  /// The halves of a step: contact joints, and the bodies' motion.
  void collide() {
    contacts_ = 0;
    dSpaceCollide(space_, this, &near);
  }
  void solve(double seconds) {
    dWorldQuickStep(world_, static_cast<dReal>(seconds));
    dJointGroupEmpty(joints_);
  }
  [[nodiscard]] double fastest() const {
    double speed = 0;
    for (const dBodyID body : bodies_) {
      for (const dReal* v : {dBodyGetLinearVel(body), dBodyGetAngularVel(body)}) {
        speed = std::max(speed,
                         std::hypot(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])));
      }
    }
    return speed;
  }
  static Vec3 position(dBodyID body) {
    const dReal* p = dBodyGetPosition(body);
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  }

 private:
  static void near(void* data, dGeomID first, dGeomID second) {
    auto& world = *static_cast<OdeWorld*>(data);
    const dBodyID body1 = dGeomGetBody(first), body2 = dGeomGetBody(second);
    if (body1 != nullptr && body2 != nullptr && dAreConnectedExcluding(body1, body2, dJointTypeContact) != 0) return;
    dContactGeom found[8];
    const int count = dCollide(first, second, 8, found, sizeof(dContactGeom));
    for (int i = 0; i < count; ++i) {
      dContact contact{};
      contact.surface.mode = dContactApprox1;
      contact.surface.mu = 1;
      contact.geom = found[i];
      dJointAttach(dJointCreateContact(world.world_, world.joints_, &contact), body1, body2);
    }
    world.contacts_ += count;
  }

  dWorldID world_;
  dSpaceID space_;
  dJointGroupID joints_;
  std::vector<dBodyID> bodies_;
  std::deque<OdeHull> hulls_;
  int contacts_ = 0;
};

/// A chassis of boxes on four wheels, which are cylinders, driven along x.
inline dBodyID drive_vehicle(OdeWorld& world, const Vec3& at, double radians_per_second) {
  const dBodyID chassis = world.box({1.2, 0.6, 0.2}, at + Vec3(0, 0, 0.35));
  const Mat3 across = Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitX()).toRotationMatrix();  // the axis along y
  for (const double x : {-0.4, 0.4}) {
    for (const double y : {-0.4, 0.4}) {
      const Vec3 hub = at + Vec3(x, y, 0.21);
      const dBodyID wheel =
          world.body(dCreateCylinder(world.space(), static_cast<dReal>(0.2), static_cast<dReal>(0.12)), hub,
                     {0.4, 0.4, 0.12}, across);
      const dJointID axle = dJointCreateHinge(world.world(), nullptr);
      dJointAttach(axle, chassis, wheel);
      dJointSetHingeAnchor(axle, static_cast<dReal>(hub[0]), static_cast<dReal>(hub[1]), static_cast<dReal>(hub[2]));
      dJointSetHingeAxis(axle, 0, -1, 0);
      dJointSetHingeParam(axle, dParamVel, static_cast<dReal>(radians_per_second));
      dJointSetHingeParam(axle, dParamFMax, 5);
    }
  }
  return chassis;
}

}  // namespace pd::test
