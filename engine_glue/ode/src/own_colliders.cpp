#include "own_colliders.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

// ODE defines these outside of any namespace and declares them in no public header.
int dCollideSphereSphere(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideSphereBox(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideSpherePlane(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideBoxBox(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideBoxPlane(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCapsuleSphere(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCapsuleBox(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCapsuleCapsule(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCapsulePlane(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCapsuleCylinder(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCylinderSphere(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCylinderBox(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCylinderPlane(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideCylinderCylinder(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexPlane(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexSphereCCD(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexBoxCCD(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexCapsuleCCD(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexCylinderCCD(dGeomID, dGeomID, int, dContactGeom*, int);
int dCollideConvexConvexCCD(dGeomID, dGeomID, int, dContactGeom*, int);

namespace pd::detail {

const std::array<OwnCollider, kOwnColliders> own_colliders = {{
    {dSphereClass, dSphereClass, &dCollideSphereSphere},
    {dSphereClass, dBoxClass, &dCollideSphereBox},
    {dSphereClass, dPlaneClass, &dCollideSpherePlane},
    {dBoxClass, dBoxClass, &dCollideBoxBox},
    {dBoxClass, dPlaneClass, &dCollideBoxPlane},
    {dCapsuleClass, dSphereClass, &dCollideCapsuleSphere},
    {dCapsuleClass, dBoxClass, &dCollideCapsuleBox},
    {dCapsuleClass, dCapsuleClass, &dCollideCapsuleCapsule},
    {dCapsuleClass, dPlaneClass, &dCollideCapsulePlane},
    {dCapsuleClass, dCylinderClass, &dCollideCapsuleCylinder},
    {dCylinderClass, dSphereClass, &dCollideCylinderSphere},
    {dCylinderClass, dBoxClass, &dCollideCylinderBox},
    {dCylinderClass, dPlaneClass, &dCollideCylinderPlane},
    {dCylinderClass, dCylinderClass, &dCollideCylinderCylinder},
    {dConvexClass, dPlaneClass, &dCollideConvexPlane},
    {dConvexClass, dSphereClass, &dCollideConvexSphereCCD},
    {dConvexClass, dBoxClass, &dCollideConvexBoxCCD},
    {dConvexClass, dCapsuleClass, &dCollideConvexCapsuleCCD},
    {dConvexClass, dCylinderClass, &dCollideConvexCylinderCCD},
    {dConvexClass, dConvexClass, &dCollideConvexConvexCCD},
}};

namespace {

struct DestroyGeom {
  void operator()(dGeomID geom) const { dGeomDestroy(geom); }
};
using OwnedGeom = std::unique_ptr<dxGeom, DestroyGeom>;

/// A geom of about half a unit around the origin.
OwnedGeom sample(int geom_class) {
  // A cube: ODE refers to these arrays as long as the geom lives.
  static constexpr dReal kPlanes[] = {1, 0,  0, 0.4f, -1, 0, 0, 0.4f, 0, 1, 0,  0.4f,
                                      0, -1, 0, 0.4f, 0,  0, 1, 0.4f, 0, 0, -1, 0.4f};
  static constexpr dReal kPoints[] = {-0.4f, -0.4f, -0.4f, 0.4f, -0.4f, -0.4f, -0.4f, 0.4f, -0.4f, 0.4f, 0.4f, -0.4f,
                                      -0.4f, -0.4f, 0.4f,  0.4f, -0.4f, 0.4f,  -0.4f, 0.4f, 0.4f,  0.4f, 0.4f, 0.4f};
  static constexpr unsigned int kPolygons[] = {4, 1, 3, 7, 5, 4, 0, 4, 6, 2, 4, 2, 6, 7, 3,
                                               4, 0, 1, 5, 4, 4, 4, 5, 7, 6, 4, 0, 2, 3, 1};
  switch (geom_class) {
    case dSphereClass:
      return OwnedGeom(dCreateSphere(nullptr, 0.4f));
    case dBoxClass:
      return OwnedGeom(dCreateBox(nullptr, 0.9f, 0.7f, 0.8f));
    case dCapsuleClass:
      return OwnedGeom(dCreateCapsule(nullptr, 0.3f, 0.4f));
    case dCylinderClass:
      return OwnedGeom(dCreateCylinder(nullptr, 0.4f, 0.7f));
    case dPlaneClass:
      return OwnedGeom(dCreatePlane(nullptr, 0, 0, 1, 0.125f));
    default:
      return OwnedGeom(dCreateConvex(nullptr, kPlanes, 6, kPoints, 8, kPolygons));
  }
}

void stand_askew(dGeomID geom, dReal x) {
  if (dGeomGetClass(geom) == dPlaneClass) return;
  dMatrix3 rotation;
  dRFromAxisAndAngle(rotation, 1, 0.5f, x, 0.3f + x);
  dGeomSetRotation(geom, rotation);
  dGeomSetPosition(geom, x, 0.1f, 0.3f * x);
}

constexpr int kAsked = 8;
using Contacts = std::array<dContactGeom, kAsked>;

bool same_numbers(const dContactGeom& a, const dContactGeom& b) {
  return std::memcmp(a.pos, b.pos, 3 * sizeof(dReal)) == 0 && std::memcmp(a.normal, b.normal, 3 * sizeof(dReal)) == 0 &&
         a.depth == b.depth && a.g1 == b.g1 && a.g2 == b.g2;
}

}  // namespace

int collide_by_ode(dGeomID first, dGeomID second, int flags, dContactGeom* contacts, int skip) {
  const int class1 = dGeomGetClass(first), class2 = dGeomGetClass(second);
  const auto own = std::find_if(own_colliders.begin(), own_colliders.end(),
                                [&](const OwnCollider& o) { return o.first == class1 && o.second == class2; });
  if (own == own_colliders.end()) return 0;
  if (class1 != class2) return own->function(first, second, flags, contacts, skip);
  // ODE calls an override of one class with its geoms exchanged, and exchanges the answer.
  const int count = own->function(second, first, flags, contacts, skip);
  for (int i = 0; i < count; ++i) {
    dContactGeom& contact = contact_at(contacts, skip, i);
    for (int k = 0; k < 3; ++k) contact.normal[k] = -contact.normal[k];
    std::swap(contact.g1, contact.g2);
    std::swap(contact.side1, contact.side2);
  }
  return count;
}

void put_back(const OwnCollider& own) {
  dSetColliderOverride(own.first, own.second, own.first == own.second ? &collide_by_ode : own.function);
}

bool stands_in_table(const OwnCollider& own) {
  const OwnedGeom a = sample(own.first), b = sample(own.second);
  stand_askew(a.get(), 0.1f);
  stand_askew(b.get(), 0.4f);
  Contacts found{}, expected{};
  constexpr int kSkip = sizeof(dContactGeom);
  const int count = dCollide(a.get(), b.get(), kAsked, found.data(), kSkip);
  return count > 0 && count == own.function(a.get(), b.get(), kAsked, expected.data(), kSkip) &&
         std::equal(found.begin(), found.begin() + count, expected.begin(), &same_numbers);
}

}  // namespace pd::detail
