#include "pd/compound/compound_depth.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "compound/octree_depth.hpp"
#include "compound/part_pairs.hpp"
#include "compound/union_boundary.hpp"
#include "depth/pair/canonical_order.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/number_text.hpp"
#include "numeric/root_sum.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

using detail::DifferenceFacet;
using detail::Dyadic;
using detail::Dyadic3;
using detail::PairsResult;
using detail::PartDifferences;
using detail::RootSum;
using detail::UncoveredBoundary;
using detail::UnionPair;

std::optional<Error> refuse_settings(const UnionSettings& settings) {
  if (!(settings.delta > 0 && settings.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  }
  if (!(settings.resolution >= 0 && std::isfinite(settings.resolution))) {
    return Error{ErrorCode::bad_value, "a resolution must be a length >= 0", "resolution"};
  }
  return std::nullopt;
}

/// |t| rounded up, exactly.
double length_above(const Vec3& t) {
  const Dyadic3 exact = detail::to_dyadic(t);
  const RootSum length(Dyadic(0.0), 1, dot(exact, exact), Dyadic(1.0));
  return length.round_up(length.round_down());
}

Vec3 scaled(const Vec3& v, int exponent) {
  return {std::ldexp(v.x(), exponent), std::ldexp(v.y(), exponent), std::ldexp(v.z(), exponent)};
}

/// The features of a facet of P_ij as the protocol names them: a vertex stands for a larger face that is parallel to
/// the other body's facet.
void set_features(const DifferenceFacet& facet, const detail::DifferenceCorner& heaviest, Feature& on_a,
                  Feature& on_b) {
  on_a = facet.on_a;
  on_b = facet.on_b;
  if (on_a.kind == Feature::Kind::facet) {
    on_b = {Feature::Kind::vertex, heaviest.b, -1};
  } else if (on_b.kind == Feature::Kind::facet) {
    on_a = {Feature::Kind::vertex, heaviest.a, -1};
  }
}

/// x of a facet's polygon as a convex combination of its corners: three of the fan from the first corner.
struct Combination {
  std::array<std::size_t, 3> corner{0, 0, 0};
  std::array<double, 3> weight{1, 0, 0};
};

Combination combination(const detail::PlanePolygon& polygon, const Vec3& x) {
  Combination best;
  double least = HUGE_VAL;
  const Vec3& first = polygon.corners[0];
  for (std::size_t k = 1; k + 1 < polygon.corners.size(); ++k) {
    const Vec3 u = polygon.corners[k] - first, v = polygon.corners[k + 1] - first, w = x - first;
    const Vec3 n = u.cross(v);
    const double area = n.squaredNorm();
    if (!(area > 0)) continue;
    const double s = std::clamp(w.cross(v).dot(n) / area, 0.0, 1.0);
    const double t = std::clamp(u.cross(w).dot(n) / area, 0.0, 1.0 - s);
    const double error = (first + s * u + t * v - x).squaredNorm();
    if (error < least) {
      least = error;
      best = {{0, k, k + 1}, {1 - s - t, s, t}};
    }
  }
  return best;
}

class FacetsAnswer {
 public:
  FacetsAnswer(const UnionPair& pair, const UnionSettings& settings, UnionStatistics& work)
      : pair_(pair), settings_(settings), work_(work) {}

  /// Builds the P_ij that come within `reach` of a point.
  std::optional<Error> build(double reach) {
    const int exponent = pair_.scale_exponent();
    auto built = PartDifferences::build(pair_.a, pair_.boxes_a, pair_.b, pair_.boxes_b, exponent,
                                        std::ldexp(reach, -exponent), settings_.max_facets);
    if (!built) {
      return Error{ErrorCode::limit_exceeded,
                   "the differences of the parts have more than " + std::to_string(settings_.max_facets) +
                       " facets; the octree answers within (1 + delta)",
                   "max_facets"};
    }
    differences_.emplace(*std::move(built));
    boundary_.emplace(*differences_);
    work_.facets = 0;
    for (const detail::PartDifference& piece : differences_->pieces()) {
      work_.facets += static_cast<std::int64_t>(piece.facets.size());
    }
    return std::nullopt;
  }

  UncoveredBoundary& boundary() { return *boundary_; }

  /// Adds what was done; called once for each build.
  void count() {
    exact_signs_ += differences_->planes().exact_signs();
    work_.polygons += boundary_->counts().polygons;
    work_.cuts += boundary_->counts().cuts;
  }

  [[nodiscard]] const detail::PartDifference& piece(const UncoveredBoundary::Spot& spot) const {
    return differences_->pieces()[spot.piece];
  }
  [[nodiscard]] const DifferenceFacet& facet(const UncoveredBoundary::Spot& spot) const {
    return piece(spot).facets[spot.facet];
  }
  [[nodiscard]] Vec3 normal(const UncoveredBoundary::Spot& spot) const {
    return differences_->planes().normal(spot.polygon.plane).normalized();
  }

  [[nodiscard]] std::int64_t exact_signs() const { return exact_signs_; }

  void fill_overlapping(const UncoveredBoundary::Nearest& nearest, UnionDepth& out) const {
    const int exponent = pair_.scale_exponent();
    const UncoveredBoundary::Spot& spot = nearest.spot;
    const Vec3 free = boundary_->free_placement(spot);
    out.contact = ContactClass::overlapping;
    out.translation = scaled(free, exponent);
    out.lower = std::ldexp(nearest.lower, exponent);
    out.upper = std::max(out.lower, length_above(out.translation));
    out.depth = out.upper;
    out.normal = nearest.foot ? normal(spot) : Vec3(free.normalized());
    if (!(out.upper > 0)) out.normal = normal(spot);
    out.distance = out.distance_lower = out.distance_upper = 0;
    set_witnesses(spot, out);
  }

  void set_witnesses(const UncoveredBoundary::Spot& spot, UnionDepth& out) const {
    const DifferenceFacet& f = facet(spot);
    out.part_a = piece(spot).part_a;
    out.part_b = piece(spot).part_b;
    const Combination c = combination(f.polygon, spot.x);
    const PosedShape& a = pair_.a[static_cast<std::size_t>(out.part_a)];
    Vec3 point = Vec3::Zero();
    std::size_t heaviest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      point += c.weight[i] * a.pose.apply(a.shape->polytope()->vertex(f.corners[c.corner[i]].a));
      if (c.weight[i] > c.weight[heaviest]) heaviest = i;
    }
    out.witness_a = point;
    out.witness_b = point + out.translation;
    set_features(f, f.corners[c.corner[heaviest]], out.feature_a, out.feature_b);
  }

 private:
  const UnionPair& pair_;
  const UnionSettings& settings_;
  UnionStatistics& work_;
  std::int64_t exact_signs_ = 0;
  std::optional<PartDifferences> differences_;
  std::optional<UncoveredBoundary> boundary_;
};

/// Class of a union whose pairs touch at best: a placement on walls of zero width is inside.
Expected<ContactClass> class_of_touching(FacetsAnswer& answer, std::optional<UncoveredBoundary::Spot>& spot) {
  if (auto refused = answer.build(0)) return *std::move(refused);
  bool held = false;
  spot = answer.boundary().at(Vec3::Zero(), held);
  answer.count();
  return held && !spot ? ContactClass::overlapping : ContactClass::touching;
}

/// The pairs' answer, for unions whose interiors are disjoint.
void take_pair(const PairsResult& pairs, UnionDepth& out) {
  static_cast<PenetrationDepth&>(out) = pairs.nearest;
  out.part_a = pairs.part_a;
  out.part_b = pairs.part_b;
}

Expected<UnionDepth> solve_by_facets(const UnionPair& pair, Scratch& scratch, const UnionSettings& settings) {
  UnionDepth out;
  out.exact = true;
  const PairsResult pairs = classify_pairs(pair, scratch, settings.delta, out.work);
  take_pair(pairs, out);
  if (pairs.contact == ContactClass::separated) return out;
  const bool convex = pair.a.size() == 1 && pair.b.size() == 1;
  if (convex && settings.method == UnionMethod::automatic) return out;
  FacetsAnswer answer(pair, settings, out.work);
  double known_lower = pairs.nearest.lower;
  if (pairs.contact == ContactClass::touching) {
    std::optional<UncoveredBoundary::Spot> spot;
    const Expected<ContactClass> contact = class_of_touching(answer, spot);
    if (!contact) return contact.error();
    if (*contact == ContactClass::touching) {
      if (!spot) return out;
      // The pair on whose free facet the origin lies.
      out.part_a = answer.piece(*spot).part_a;
      out.part_b = answer.piece(*spot).part_b;
      const PenetrationDepth own = penetration_depth(pair.a[static_cast<std::size_t>(out.part_a)],
                                                     pair.b[static_cast<std::size_t>(out.part_b)], scratch);
      const Statistics statistics = out.statistics;
      static_cast<PenetrationDepth&>(out) = own;
      out.statistics = statistics;
      out.normal = answer.normal(*spot);
      return out;
    }
    known_lower = 0;
  }
  if (auto refused = answer.build(pair.box_exit())) return *std::move(refused);
  answer.fill_overlapping(answer.boundary().nearest(std::ldexp(known_lower, -pair.scale_exponent())), out);
  answer.count();
  out.statistics.exact_signs += answer.exact_signs();
  return out;
}

}  // namespace

Expected<UnionDepth> penetration_depth(const PosedCompound& a, const PosedCompound& b, Scratch& scratch,
                                       const UnionSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (auto refused = refuse_settings(settings)) return *std::move(refused);
  Expected<UnionPair> posed = UnionPair::pose(a, b);
  if (!posed) return posed.error();
  UnionPair pair = std::move(posed).value();
  if (settings.method == UnionMethod::facets && !pair.polytopes) {
    return Error{ErrorCode::unsupported, "the facets of the difference are known for polytopes without a margin only",
                 ""};
  }
  // A pair is solved in one order, whichever way it was asked.
  const bool exchanged = pair.exchange_to_canonical_order();
  const bool facets =
      settings.method == UnionMethod::facets || (settings.method == UnionMethod::automatic && pair.polytopes);
  Expected<UnionDepth> solved = facets ? solve_by_facets(pair, scratch, settings)
                                       : Expected<UnionDepth>(detail::solve_by_octree(pair, scratch, settings));
  if (!solved) return solved.error();
  UnionDepth out = std::move(solved).value();
  if (exchanged) {
    detail::exchange_bodies(out);
    std::swap(out.part_a, out.part_b);
  }
  detail::clear_negative_zeros(out);
  return out;
}

Expected<UnionDirectionalDepth> directional_depth(const PosedCompound& a, const PosedCompound& b, const Vec3& direction,
                                                  Scratch& scratch, const UnionSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (!direction.allFinite()) {
    return Error{ErrorCode::non_finite, "a direction needs three finite numbers", "direction"};
  }
  if (direction.isZero(0)) {
    return Error{ErrorCode::zero_direction, "a direction needs a length other than zero", "direction"};
  }
  if (auto refused = refuse_settings(settings)) return *std::move(refused);
  const Expected<UnionPair> pair = UnionPair::pose(a, b);
  if (!pair) return pair.error();
  if (!pair->polytopes) {
    return Error{ErrorCode::unsupported, "directional depth is for polytopes without a margin", ""};
  }
  UnionDirectionalDepth out;
  const PairsResult pairs = classify_pairs(*pair, scratch, settings.delta, out.work);
  out.contact = pairs.contact;
  FacetsAnswer answer(*pair, settings, out.work);
  if (out.contact == ContactClass::touching) {
    std::optional<UncoveredBoundary::Spot> spot;
    const Expected<ContactClass> contact = class_of_touching(answer, spot);
    if (!contact) return contact.error();
    out.contact = *contact;
  }
  if (out.contact != ContactClass::overlapping) return out;
  if (auto refused = answer.build(HUGE_VAL)) return *std::move(refused);

  const int exponent = std::ilogb(direction.cwiseAbs().maxCoeff());
  const Dyadic3 given = detail::to_dyadic(direction);
  const Dyadic3 exact{given.x.scaled(-exponent), given.y.scaled(-exponent), given.z.scaled(-exponent)};
  const auto hit = answer.boundary().along(scaled(direction, -exponent), exact);
  answer.count();
  // A ray from inside a bounded set leaves it.
  const Dyadic numerator = hit->t.numerator.scaled(pair->scale_exponent());
  const RootSum length(Dyadic(0.0), 1, numerator * numerator * dot(exact, exact),
                       hit->t.denominator * hit->t.denominator);
  out.lower = length.round_down();
  out.upper = length.round_up(out.lower);
  out.depth = std::clamp(detail::to_double(length.approximate()), out.lower, out.upper);
  out.normal = answer.normal(hit->spot);
  out.part_a = answer.piece(hit->spot).part_a;
  out.part_b = answer.piece(hit->spot).part_b;
  const DifferenceFacet& facet = answer.facet(hit->spot);
  const Combination c = combination(facet.polygon, hit->spot.x);
  const std::size_t heaviest =
      static_cast<std::size_t>(std::max_element(c.weight.begin(), c.weight.end()) - c.weight.begin());
  set_features(facet, facet.corners[c.corner[heaviest]], out.feature_a, out.feature_b);
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
  if (auto refused = answer.build(point.norm() * (1 + 0x1p-40))) return *std::move(refused);
  bool held = false;
  const auto spot = answer.boundary().at(scaled(point, -pair->scale_exponent()), held);
  return held && !spot ? ContactClass::overlapping : ContactClass::touching;
}

}  // namespace pd
