#include "pd/compound/compound_depth.hpp"

#include <cmath>
#include <utility>

#include "compound/facets_answer.hpp"
#include "compound/octree_depth.hpp"
#include "compound/part_pairs.hpp"
#include "compound/union_memory.hpp"
#include "depth/pair/canonical_order.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

using detail::FacetsAnswer;
using detail::PairsResult;
using detail::UnionMemory;
using detail::UnionPair;

/// The pairs' answer, for unions whose interiors are disjoint.
void set_from_pair(const PairsResult& pairs, UnionDepth& out) {
  static_cast<PenetrationDepth&>(out) = pairs.nearest;
  out.part_a = pairs.part_a;
  out.part_b = pairs.part_b;
}

Expected<UnionDepth> solve_by_facets(const UnionPair& pair, Scratch& scratch, const UnionSettings& settings,
                                     UnionMemory* memory) {
  UnionDepth out;
  out.exact = true;
  const PairsResult pairs = classify_pairs(pair, scratch, settings.delta, memory, out.work);
  set_from_pair(pairs, out);
  const bool convex = pair.a.size() == 1 && pair.b.size() == 1;
  if (pairs.contact == ContactClass::separated || (convex && settings.method == UnionMethod::automatic)) {
    if (memory != nullptr) memory->keep(pairs.part_a, pairs.part_b, Vec3::Zero());
    out.warm = pairs.remembered;
    return out;
  }
  FacetsAnswer answer(pair, settings, out.work);
  double known_lower = pairs.nearest.lower;
  if (pairs.contact == ContactClass::touching) {
    std::optional<FacetsAnswer::Where> where;
    const Expected<ContactClass> contact = answer.class_of_touching(where);
    if (!contact) return contact.error();
    if (*contact == ContactClass::touching) {
      if (!where) return out;
      // The pair on whose free facet the origin lies.
      out.part_a = answer.piece(*where).part_a;
      out.part_b = answer.piece(*where).part_b;
      const PenetrationDepth own = penetration_depth(pair.a[static_cast<std::size_t>(out.part_a)],
                                                     pair.b[static_cast<std::size_t>(out.part_b)], scratch);
      const Statistics statistics = out.statistics;
      static_cast<PenetrationDepth&>(out) = own;
      out.statistics = statistics;
      out.normal = answer.normal(*where);
      return out;
    }
    known_lower = 0;
  }
  const double reach = memory != nullptr ? free_reach(pair, *memory, scratch) : pair.box_exit();
  if (auto refused = answer.solve_overlapping(known_lower, reach, memory, out)) return *std::move(refused);
  // What lies beyond the reach was not looked at.
  if (memory != nullptr && out.upper > reach) {
    if (auto refused = answer.solve_overlapping(known_lower, pair.box_exit(), memory, out)) return *std::move(refused);
  }
  out.statistics.exact_signs += answer.exact_signs();
  if (memory != nullptr) memory->keep(pairs.part_a, pairs.part_b, out.translation);
  out.warm = pairs.remembered;
  return out;
}

/// The parts times 2^-exponent about a point, in world coordinates.
Compound scaled_about(const Vec3& centre, const std::vector<PosedShape>& parts, int exponent) {
  std::vector<Compound::Part> scaled;
  for (const PosedShape& part : parts) {
    const Vec3 translation = detail::times_power(part.pose.translation() - centre, -exponent);
    scaled.push_back(
        {detail::scaled(*part.shape, -exponent), Pose::from_trusted_matrix(part.pose.rotation(), translation)});
  }
  return *Compound::from_parts(std::move(scaled));
}

/// Bodies with curved parts are answered at size 1, where products of lengths neither over- nor underflow.
Expected<UnionDepth> solve_scaled(const UnionPair& pair, const Vec3& centre, Scratch& scratch,
                                  const UnionSettings& settings) {
  const int exponent = pair.scale_exponent();
  const Compound near_a = scaled_about(centre, pair.a, exponent), near_b = scaled_about(centre, pair.b, exponent);
  UnionSettings near_settings = settings;
  near_settings.resolution = std::ldexp(settings.resolution, -exponent);
  Expected<UnionDepth> solved = penetration_depth({&near_a, Pose()}, {&near_b, Pose()}, scratch, near_settings);
  if (!solved) return solved.error();
  UnionDepth out = std::move(solved).value();
  detail::scale_answer(out, exponent);
  out.witness_a += centre;
  out.witness_b += centre;
  pair.name_parts(out.part_a, out.part_b);
  return out;
}

}  // namespace

Expected<UnionDepth> penetration_depth(const PosedCompound& a, const PosedCompound& b, Scratch& scratch,
                                       const UnionSettings& settings, WarmUnion* warm) {
  const detail::FloatingPointGuard guard;
  if (auto refused = detail::refuse_settings(settings)) return *std::move(refused);
  Expected<UnionPair> posed = UnionPair::pose(a, b);
  if (!posed) return posed.error();
  UnionPair pair = std::move(posed).value();
  if (settings.method == UnionMethod::facets && !pair.polytopes) {
    return Error{ErrorCode::unsupported, "the facets of the difference are known for polytopes without a margin only",
                 ""};
  }
  if (!pair.polytopes && pair.scale_exponent() != 0) {
    return solve_scaled(pair, a.pose.translation(), scratch, settings);
  }
  // A pair is solved in one order, whichever way it was asked.
  const bool exchanged = pair.exchange_to_canonical_order();
  const bool facets =
      settings.method == UnionMethod::facets || (settings.method == UnionMethod::automatic && pair.polytopes);
  std::optional<detail::UnionMemory> memory;
  if (warm != nullptr && facets) memory.emplace(warm->state(), pair, exchanged);
  Expected<UnionDepth> solved = facets ? solve_by_facets(pair, scratch, settings, memory ? &*memory : nullptr)
                                       : detail::solve_by_octree(pair, scratch, settings);
  if (!solved) return solved.error();
  UnionDepth out = std::move(solved).value();
  pair.name_parts(out.part_a, out.part_b);
  if (exchanged) {
    detail::exchange_bodies(out);
    std::swap(out.part_a, out.part_b);
  }
  detail::clear_negative_zeros(out);
  return out;
}

}  // namespace pd
