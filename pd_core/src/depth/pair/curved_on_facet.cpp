#include "depth/pair/curved_on_facet.hpp"

#include <algorithm>

#include "depth/expansion/cached_surface.hpp"
#include "depth/facets/facet_contact.hpp"
#include "depth/pair/contact_facets.hpp"

namespace pd::detail {

namespace {

constexpr double kAbsoluteOnFacet = 1e-12;  ///< of L: no interval need be narrower

}  // namespace

bool curved_on_facet(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference, double width,
                     WarmCertificate* warm, PenetrationDepth& out) {
  const int of = a.shape->polytope() ? 0 : 1;
  const PosedShape& owner = of == 0 ? a : b;
  const ConvexPolytope* polytope = owner.shape->polytope();
  if (polytope == nullptr) return false;
  WarmFacets* facets = warm ? &warm->state().facets : nullptr;
  if (facets != nullptr && !may_try(*facets)) return false;
  int facet = facets != nullptr ? known_facet(*facets, of, *polytope) : -1;
  const bool remembered = facet >= 0;
  const double sense = of == 0 ? -1 : 1;
  if (facet < 0 && polytope->affine_dimension() == 2) {
    // P's centre lies before one of both sides.
    const Vec3 normal = owner.pose.rotation() * polytope->facet_normal(0);
    facet = -sense * difference.centre().dot(normal) >= 0 ? 0 : 1;
  }
  if (facet < 0) return false;
  const Vec3 offset = of == 0 ? difference.offset() : Vec3(-difference.offset());
  const FacetContact contact =
      facet_contact(*polytope, owner.pose.rotation(), facet, offset, difference.centre_of(1 - of),
                    support_plane_error(difference), [&](const Vec3& unit) {
                      return BodyPoint{difference.support_of(1 - of, unit), -1};
                    });
  const bool narrow = contact.certified && contact.upper - contact.lower <=
                                               std::max(kAbsoluteOnFacet * contact.largest, width) * (1 + 0x1p-48);
  if (remembered) count_try(*facets, narrow, kLongestFacetPause);
  if (!narrow) return false;
  set_contact_on_facet(contact, of == 0, {a.shape->margin(), b.shape->margin()},
                       of == 0 ? Vec3(b.pose.translation() - a.pose.translation()) : Vec3(Vec3::Zero()), out);
  out.warm = remembered;
  return true;
}

}  // namespace pd::detail
