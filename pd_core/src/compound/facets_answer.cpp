#include "compound/facets_answer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "numeric/root_sum.hpp"

namespace pd::detail {

namespace {

/// x of a facet's polygon as a convex combination of its corners: three of the fan from the first corner.
struct Combination {
  std::array<std::size_t, 3> corner{0, 0, 0};
  std::array<double, 3> weight{1, 0, 0};
};

Combination combination(const PlanePolygon& polygon, const Vec3& x) {
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

/// The corner that a point of a facet lies nearest to, by weight.
std::size_t heaviest_of(const Combination& c) {
  return static_cast<std::size_t>(std::max_element(c.weight.begin(), c.weight.end()) - c.weight.begin());
}

}  // namespace

std::optional<Error> refuse_settings(const UnionSettings& settings) {
  if (!(settings.delta > 0 && settings.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  }
  if (!(settings.resolution >= 0 && std::isfinite(settings.resolution))) {
    return Error{ErrorCode::bad_value, "a resolution must be a length >= 0", "resolution"};
  }
  return std::nullopt;
}

Vec3 scaled(const Vec3& v, int exponent) {
  return {std::ldexp(v.x(), exponent), std::ldexp(v.y(), exponent), std::ldexp(v.z(), exponent)};
}

void FacetsAnswer::find(double reach) {
  const int exponent = pair_.scale_exponent();
  differences_.emplace(PartDifferences::find(pair_.a, pair_.boxes_a, pair_.b, pair_.boxes_b, exponent,
                                             std::ldexp(reach, -exponent), settings_.max_facets));
  boundary_.emplace(*differences_);
}

Error FacetsAnswer::too_many_facets() const {
  return {ErrorCode::limit_exceeded,
          "the differences of the parts have more than " + std::to_string(settings_.max_facets) +
              " facets; fewer parts have fewer (in C++, UnionSettings also allows more, or the octree)",
          "max_facets"};
}

std::optional<Error> FacetsAnswer::solve_overlapping(double known_lower, double reach, UnionMemory* memory,
                                                     UnionDepth& out) {
  find(reach);
  const int exponent = pair_.scale_exponent();
  const auto nearest = boundary_->nearest(std::ldexp(known_lower, -exponent), std::ldexp(reach, -exponent), memory);
  if (!nearest) return too_many_facets();
  set_overlapping(*nearest, out);
  if (differences_->limit_exceeded()) return too_many_facets();
  count();
  return std::nullopt;
}

Expected<ContactClass> FacetsAnswer::class_of_touching(std::optional<Where>& where) {
  find(0);
  bool held = false;
  where = boundary_->at(Vec3::Zero(), held);
  if (differences_->limit_exceeded()) return too_many_facets();
  count();
  return held && !where ? ContactClass::overlapping : ContactClass::touching;
}

void FacetsAnswer::count() {
  exact_signs_ += differences_->planes().exact_signs();
  work_.facets = differences_->num_facets();
  work_.cells += boundary_->counts().cells;
  work_.polygons += boundary_->counts().polygons;
  work_.cuts += boundary_->counts().cuts;
}

void FacetsAnswer::set_overlapping(const UnionBoundary::Nearest& nearest, UnionDepth& out) const {
  const int exponent = pair_.scale_exponent();
  const Vec3 free = boundary_->free_placement(nearest.where);
  out.contact = ContactClass::overlapping;
  out.translation = scaled(free, exponent);
  out.lower = std::ldexp(nearest.lower, exponent);
  out.upper = std::max(out.lower, length_rounded_up(out.translation));
  out.depth = out.upper;
  // If no doubles lie between two pieces that nearly meet, the nearest placement is farther than the boundary.
  out.bracket_reached = out.closed = out.upper <= (1 + settings_.delta) * out.lower;
  out.normal = nearest.projection ? normal(nearest.where) : Vec3(free.normalized());
  if (!(out.upper > 0)) out.normal = normal(nearest.where);
  out.distance = out.distance_lower = out.distance_upper = 0;
  set_witnesses(nearest.where, out);
}

void FacetsAnswer::set_witnesses(const Where& where, UnionDepth& out) const {
  const DifferenceFacet& f = facet(where);
  out.part_a = piece(where).part_a;
  out.part_b = piece(where).part_b;
  const Combination c = combination(f.polygon, where.x);
  const PosedShape& a = pair_.a[static_cast<std::size_t>(out.part_a)];
  out.witness_a = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    out.witness_a += c.weight[i] * a.pose.apply(a.shape->polytope()->vertex(f.corners[c.corner[i]].a));
  }
  out.witness_b = out.witness_a + out.translation;
  features(where, out.feature_a, out.feature_b);
}

void FacetsAnswer::features(const Where& where, Feature& on_a, Feature& on_b) const {
  const DifferenceFacet& f = facet(where);
  const Combination c = combination(f.polygon, where.x);
  const VertexPair& heaviest = f.corners[c.corner[heaviest_of(c)]];
  on_a = f.on_a;
  on_b = f.on_b;
  if (on_a.kind == Feature::Kind::facet) {
    on_b = {Feature::Kind::vertex, heaviest.b, -1};
  } else if (on_b.kind == Feature::Kind::facet) {
    on_a = {Feature::Kind::vertex, heaviest.a, -1};
  }
}

}  // namespace pd::detail
