#include <algorithm>
#include <cmath>

#include "compound/facets_answer.hpp"
#include "compound/part_pairs.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/root_sum.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/refused_vector.hpp"

namespace pd {

using detail::Dyadic;
using detail::Dyadic3;
using detail::FacetsAnswer;
using detail::PairsResult;
using detail::RootSum;
using detail::UnionPair;

Expected<UnionDirectionalDepth> directional_depth(const PosedCompound& a, const PosedCompound& b, const Vec3& direction,
                                                  Scratch& scratch, const UnionSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (const auto error = detail::refuse_direction(direction)) return *error;
  if (auto refused = detail::refuse_settings(settings)) return *std::move(refused);
  const Expected<UnionPair> pair = UnionPair::pose(a, b);
  if (!pair) return pair.error();
  if (!pair->polytopes) {
    return Error{
        ErrorCode::unsupported,
        "the directional depth of a union is for parts that are polytopes without a margin; of two convex bodies "
        "either may be curved",
        ""};
  }
  UnionDirectionalDepth out;
  const PairsResult pairs = classify_pairs(*pair, scratch, settings.delta, nullptr, out.work);
  out.contact = pairs.contact;
  FacetsAnswer answer(*pair, settings, out.work);
  if (out.contact == ContactClass::touching) {
    std::optional<FacetsAnswer::Where> where;
    const Expected<ContactClass> contact = answer.class_of_touching(where);
    if (!contact) return contact.error();
    out.contact = *contact;
  }
  if (out.contact != ContactClass::overlapping) return out;
  answer.find(HUGE_VAL);

  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  const Dyadic3 given = detail::to_dyadic(direction);
  const Dyadic3 exact{given.x.scaled(-exponent), given.y.scaled(-exponent), given.z.scaled(-exponent)};
  const auto hit = answer.boundary().along(detail::scaled(direction, -exponent), exact);
  if (auto refused = answer.refused()) return *std::move(refused);
  answer.count();
  // A ray from inside a bounded set leaves it.
  const Dyadic numerator = hit->t.numerator.scaled(pair->scale_exponent());
  const RootSum length(Dyadic(0.0), 1, numerator * numerator * dot(exact, exact),
                       hit->t.denominator * hit->t.denominator);
  out.lower = length.round_down();
  out.upper = length.round_up(out.lower);
  out.depth = std::clamp(detail::to_double(length.approximate()), out.lower, out.upper);
  out.normal = answer.normal(hit->where);
  out.part_a = answer.piece(hit->where).part_a;
  out.part_b = answer.piece(hit->where).part_b;
  pair->name_parts(out.part_a, out.part_b);
  answer.features(hit->where, out.feature_a, out.feature_b);
  return out;
}

Expected<ContactClass> point_in_difference(const PosedCompound& a, const PosedCompound& b, const Vec3& point,
                                           Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  const Expected<UnionPair> pair = UnionPair::pose(a, b);
  if (!pair) return pair.error();
  ContactClass contact = ContactClass::separated;
  for (const PosedShape& part_a : pair->a) {
    for (const PosedShape& part_b : pair->b) {
      const Expected<ContactClass> one = point_in_difference(part_a, part_b, point, scratch);
      if (!one) return one.error();
      contact = std::max(contact, *one);
      if (contact == ContactClass::overlapping) return contact;
    }
  }
  if (contact == ContactClass::separated || !pair->polytopes) return contact;
  // On a common wall of several P_ij: inside, unless some of it is free there.
  UnionStatistics work;
  const UnionSettings settings;
  FacetsAnswer answer(*pair, settings, work);
  answer.find(point.norm() * (1 + 0x1p-40));
  bool held = false;
  const auto where = answer.boundary().at(detail::scaled(point, -pair->scale_exponent()), held);
  if (auto refused = answer.refused()) return *std::move(refused);
  return held && !where ? ContactClass::overlapping : ContactClass::touching;
}

}  // namespace pd
