#include "depth/certificate/exact_answer.hpp"

#include <cassert>
#include <cmath>

#include "depth/certificate/separating_translation.hpp"
#include "depth/certificate/witness_points.hpp"
#include "numeric/root_sum.hpp"
#include "numeric/unit_roundoff.hpp"
#include "numeric/vector_double_double.hpp"

namespace pd::detail {

namespace {

/// The supporting features in a direction where the cores do not overlap: at most one of them a facet, its partner a
/// vertex.
void set_features(const PosedPair& pair, const ExactDirection& normal, PenetrationDepth& out) {
  const SupportFaces faces{support_face_a(pair, normal), support_face_b(pair, normal)};
  const FacetFeatures features = features_of(pair, faces, normal.unit);
  out.feature_a = features.on_a;
  out.feature_b = features.on_b;
}

void clear_lengths(PenetrationDepth& out) {
  out.translation = Vec3::Zero();
  out.depth = out.lower = out.upper = 0;
  out.distance = out.distance_lower = out.distance_upper = 0;
}

/// base + sign * |level| / (weight |normal|) as it is.
RootSum root_of(const NearestPlane& plane, const Dyadic& r) {
  return RootSum(r, plane.level.sign() < 0 ? -1 : 1, plane.level * plane.level,
                 plane.weight * plane.weight * dot(plane.normal.exact, plane.normal.exact));
}

/// The overlapping part of an answer, from the exact value.
void fill_exactly(const PosedPair& pair, Separation& separation, const RootSum& value, const Margins& margins,
                  Bracket bracket, PenetrationDepth& out) {
  out.contact = ContactClass::overlapping;
  out.lower = value.round_down();
  out.upper = shortest_translation(pair, separation, value.approximate(), value.round_up(out.lower), margins.both(),
                                   bracket, out.translation);
  out.depth = out.upper;
}

/// Class, bracket, normal and translation from the plane and the margins.
void finish(const PosedPair& pair, const NearestPlane& plane, const Margins& margins, PenetrationDepth& out) {
  const Dyadic r = Dyadic(margins.a) + Dyadic(margins.b);
  const RootSum value = root_of(plane, r);
  Separation separation(plane, r);
  out.normal = high(separation.unit());
  clear_lengths(out);

  const int sign = value.compare(Dyadic());
  if (sign == 0) {
    out.contact = ContactClass::touching;
  } else if (sign < 0) {
    out.contact = ContactClass::separated;
    const RootSum distance = value.negated();
    out.distance_lower = distance.round_down();
    out.distance_upper = distance.round_up(out.distance_lower);
    out.distance = out.distance_upper;
  } else {
    fill_exactly(pair, separation, value, margins, Bracket::tightest, out);
  }
}

/// The largest double <= value and the smallest >= value, where the error leaves no doubt.
bool round_certainly(const DoubleDouble& value, double error, double& down, double& up) {
  // Normalised: value.hi is the nearest double, and lo tells on which side of it the value lies.
  const DoubleDouble v = quick_two_sum(value.hi, value.lo);
  if (error == 0 && v.lo == 0) {
    down = up = v.hi;
    return v.hi > 0x1p-900;
  }
  if (!(v.hi > 0x1p-900) || !(std::abs(v.lo) > error) || !(error < 0x1p-60 * v.hi)) return false;
  down = v.lo > 0 ? v.hi : std::nextafter(v.hi, 0.0);
  up = v.lo > 0 ? std::nextafter(v.hi, HUGE_VAL) : v.hi;
  return true;
}

/// A bracket and a translation along the rounded normal, as wide as doubles ask for; false when that is too wide.
///
/// For the rounded normal m, h_P(m) exceeds <p, n> of the nearest plane by at most |m - n| |x| over P, and both |m| - 1
/// and |m - n| are below 2u: 2u |x| and, for the product with the length, 8u of it.
bool fill_certified(const PosedPair& pair, const PairVector& point, const Separation& separation,
                    PenetrationDepth& out) {
  const double depth = to_double(separation.depth());
  const double reach =
      pair.a().radius() + pair.b().radius() + (pair.pose_b().translation() - pair.pose_a().translation()).norm();
  const double slack = 16 * kUnitRoundoff * (reach + depth) + separation.depth_error();
  if (!(depth > 4 * slack) || !(depth > 0x1p-900)) return false;
  // A point of P bounds L from below; L itself costs twelve supports.
  const double size = std::ldexp(pair.approximate(point).cwiseAbs().maxCoeff(), pair.scale_exponent());
  if (!(1.5 * slack < kCertifiedWidth * size) && !(1.5 * slack < kCertifiedWidth * largest_coordinate(pair))) {
    return false;
  }
  out.contact = ContactClass::overlapping;
  out.lower = depth * (1 - 4 * kUnitRoundoff) - separation.depth_error();
  out.depth = depth + 0.5 * slack;
  out.upper = depth + slack;
  out.translation = out.depth * out.normal;
  return true;
}

void set_witnesses(const CorePoints& core, const Margins& margins, PenetrationDepth& out) {
  out.witness_a = core.a - margins.a * out.normal;
  out.witness_b = core.b + margins.b * out.normal;
}

PairVector first_point(const ProvenSeparation& proof) {
  return PairVector::point(proof.simplex[0].a, proof.simplex[0].b);
}

/// Cores apart by less than their margins: the depth is what is left of these.
bool fill_overlapping_margins(const PosedPair& pair, const ProvenSeparation& proof, Separation& separation,
                              const Margins& margins, Bracket bracket, PenetrationDepth& out) {
  if (bracket == Bracket::certified && fill_certified(pair, first_point(proof), separation, out)) return true;
  double up = 0;
  if (!round_certainly(separation.depth(), separation.depth_error(), out.lower, up)) return false;
  out.contact = ContactClass::overlapping;
  out.upper = shortest_translation(pair, separation, separation.depth(), up, margins.both(), bracket, out.translation);
  out.depth = out.upper;
  return true;
}

/// Bodies apart for certain, in a bracket of neighbouring doubles or, where that is not asked for, of the error.
bool fill_distance(const PosedPair& pair, const ProvenSeparation& proof, const Separation& separation, Bracket bracket,
                   PenetrationDepth& out) {
  const DoubleDouble distance = -separation.depth();
  const double error = separation.depth_error();
  double down = 0, up = 0;
  if (!round_certainly(distance, error, down, up)) {
    const double size = std::ldexp(pair.approximate(first_point(proof)).cwiseAbs().maxCoeff(), pair.scale_exponent());
    const double slack = error + 0x1p-51 * distance.hi;
    if (bracket != Bracket::certified || !(distance.hi > 0x1p-900) || !(distance.hi > 2 * slack)) return false;
    if (!(2 * slack < kCertifiedWidth * size)) return false;
    down = distance.hi - slack;
    up = distance.hi + slack;
  }
  out.contact = ContactClass::separated;
  out.distance_lower = down;
  out.distance_upper = up;
  out.distance = up;
  return true;
}

}  // namespace

void answer_overlapping(const PosedPair& pair, const FacetOfDifference& facet, const Margins& margins, Bracket bracket,
                        SupportFaces& faces, PenetrationDepth& out) {
  const FacetPlane plane = measure_facet(pair, facet);
  [[maybe_unused]] const bool supporting = collect_faces(pair, facet, plane, faces);
  assert(supporting);
  answer_overlapping(pair, facet, plane, faces, margins, bracket, out);
}

void answer_overlapping(const PosedPair& pair, const FacetOfDifference& facet, const FacetPlane& plane,
                        const SupportFaces& faces, const Margins& margins, Bracket bracket, PenetrationDepth& out) {
  clear_lengths(out);
  if (plane.known()) {
    Separation separation(pair, facet, plane, margins.a, margins.b);
    out.normal = high(separation.unit());
    double up = 0;
    if (bracket == Bracket::certified && fill_certified(pair, facet.point(), separation, out)) {
      // done
    } else if (round_certainly(separation.depth(), separation.depth_error(), out.lower, up)) {
      out.contact = ContactClass::overlapping;
      out.upper =
          shortest_translation(pair, separation, separation.depth(), up, margins.both(), bracket, out.translation);
      out.depth = out.upper;
    } else {
      fill_exactly(pair, separation, root_of(separation.plane(), separation.radius()), margins, bracket, out);
    }
  } else {
    const Dyadic r = Dyadic(margins.a) + Dyadic(margins.b);
    Separation separation(exact_plane(pair, facet), r);
    out.normal = high(separation.unit());
    fill_exactly(pair, separation, root_of(separation.plane(), r), margins, bracket, out);
  }
  const FacetFeatures features = features_of(pair, faces, out.normal);
  out.feature_a = features.on_a;
  out.feature_b = features.on_b;
  const Vec3 core_translation = out.translation - margins.both() * out.normal;
  set_witnesses(witness_points_overlapping(pair, faces, out.normal, core_translation), margins, out);
}

void answer_touching(const PosedPair& pair, const ExactDirection& normal, const ExactClosestPoint& nearest,
                     const Margins& margins, PenetrationDepth& out) {
  finish(pair, {normal, Dyadic(1.0), Dyadic()}, margins, out);
  set_features(pair, normal, out);
  CorePoints core = witness_points_separated(pair, nearest.simplex.data(), nearest.weights.data(), nearest.count);
  core.b = core.a;  // one point, computed on A
  set_witnesses(core, margins, out);
}

void answer_separated(const PosedPair& pair, const ExactClosestPoint& nearest, const Margins& margins,
                      PenetrationDepth& out) {
  const NearestPlane plane = exact_plane(nearest);
  finish(pair, plane, margins, out);
  set_features(pair, plane.normal, out);
  set_witnesses(witness_points_separated(pair, nearest.simplex.data(), nearest.weights.data(), nearest.count), margins,
                out);
}

bool answer_separated(const PosedPair& pair, const ProvenSeparation& proof, const SupportFaces& faces,
                      const Margins& margins, Bracket bracket, PenetrationDepth& out) {
  clear_lengths(out);
  out.normal = high(proof.plane.unit);
  Separation separation(pair, proof, margins.a, margins.b);
  if (separation.depth().hi > 0) {
    if (!fill_overlapping_margins(pair, proof, separation, margins, bracket, out)) return false;
  } else if (!fill_distance(pair, proof, separation, bracket, out)) {
    return false;
  }
  const FacetFeatures features = features_of(pair, faces, out.normal);
  out.feature_a = features.on_a;
  out.feature_b = features.on_b;
  set_witnesses(witness_points_separated(pair, proof.simplex.data(), proof.weights.data(), proof.count), margins, out);
  return true;
}

}  // namespace pd::detail
