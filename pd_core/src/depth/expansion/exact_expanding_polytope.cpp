#include "depth/expansion/exact_expanding_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "depth/expansion/pair_hull.hpp"

namespace pd::detail {

namespace {

VertexPair support(const PosedPair& pair, const ExactDirection& direction) {
  return {support_face_a(pair, direction).front(), support_face_b(pair, direction).front()};
}

/// @param scale  lengths of the pair's own are the caller's over this.
void report(const SearchWatch& watch, const PosedPair& pair, const PairHull& hull, int number, int nearest,
            const ExactDirection& direction, double upper, const VertexPair& support, double scale) {
  SurfaceSnapshot snapshot;
  const auto place = [&](const VertexPair& id) {
    const Vec3DD x = pair.approximate_dd(PairVector::point(id.a, id.b));
    return Vec3(scale * to_double(x.x), scale * to_double(x.y), scale * to_double(x.z));
  };
  for (int v = 0; v < hull.num_vertices(); ++v) snapshot.points.push_back(place(hull.vertex(v)));
  for (std::size_t f = 0; f < hull.faces().size(); ++f) {
    const PairHull::Face& face = hull.faces()[f];
    if (!face.alive) continue;
    if (static_cast<int>(f) == nearest) snapshot.nearest = static_cast<int>(snapshot.faces.size());
    snapshot.faces.push_back({{face.v[0], face.v[1], face.v[2]}, {-1, -1, -1}, Vec3::Zero(), scale * face.lower});
  }
  report_step(watch, kExactArithmetic, number, snapshot, scale * hull.face(nearest).lower, scale * upper,
              direction.unit, place(support));
}

/// Finds four affinely independent vertices of P, or shows that P is flat (false).
/// @param given  those to begin with.
bool full_dimensional(const PosedPair& pair, std::span<const VertexPair> given, PairHull& hull,
                      std::int64_t& support_calls, std::optional<ExactDirection>& flat) {
  const auto extends = [&](const Dyadic3& d) {
    if (d.x.sign() == 0 && d.y.sign() == 0 && d.z.sign() == 0) return false;
    for (const int sign : {1, -1}) {
      const ExactDirection direction(sign > 0 ? d : Dyadic3{-d.x, -d.y, -d.z});
      ++support_calls;
      const VertexPair s = support(pair, direction);
      if (hull.is_independent(s)) {
        hull.add_vertex(s);
        return true;
      }
      flat = direction;
    }
    return false;
  };
  const Dyadic one(1.0), zero(0.0);
  const Dyadic3 axes[] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  hull.begin(given);
  while (hull.num_vertices() < 4) {
    // Directions normal to what is spanned, enough to find anything outside it.
    std::vector<Dyadic3> directions;
    if (hull.num_vertices() == 3) {
      directions.push_back(cross(pair.exact(hull.edge(0, 1)), pair.exact(hull.edge(0, 2))));
    } else {
      const bool spans_line = hull.num_vertices() == 2;
      for (const Dyadic3& axis : axes)
        directions.push_back(spans_line ? cross(pair.exact(hull.edge(0, 1)), axis) : axis);
    }
    if (std::none_of(directions.begin(), directions.end(), extends)) return false;
  }
  return true;
}

/// The nearest face that is not known to support P, -1 when all are.
int nearest_candidate(const PairHull& hull) {
  int nearest = -1;
  for (std::size_t f = 0; f < hull.faces().size(); ++f) {
    const PairHull::Face& face = hull.faces()[f];
    if (face.alive && !face.facet && (nearest < 0 || face.lower < hull.face(nearest).lower)) {
      nearest = static_cast<int>(f);
    }
  }
  return nearest;
}

/// Takes a facet of P into account. True where its plane passes through the origin: touching (the origin is known to
/// lie in P, so never beyond it).
bool rank_facet(const PosedPair& pair, PairHull& hull, int facet, const ExactDirection& direction, ExactDepth& result) {
  const Dyadic3& normal = hull.exact_normal(facet);
  const Dyadic height = dot(normal, hull.exact_point(hull.face(facet).v[0]));
  if (height.sign() <= 0) {
    result.contact = ContactClass::touching;
    result.normal = direction;
    return true;
  }
  const SquaredRatio squared{height * height,
                             dot(normal, normal) * pair.homogeneous_factor() * pair.homogeneous_factor()};
  if (!result.normal || compare(squared, result.squared) < 0) {
    result.normal = direction;
    result.squared = squared;
  }
  return false;
}

void report_outcome(const SearchWatch& watch, const ExactDepth& result, double lower, double upper) {
  ExpansionResult end;
  end.status = !result.complete                              ? ExpansionStatus::over_budget
               : result.contact == ContactClass::overlapping ? ExpansionStatus::certified
                                                             : ExpansionStatus::touching;
  end.lower = end.status == ExpansionStatus::touching ? 0 : lower;
  end.upper = end.status == ExpansionStatus::touching ? 0 : upper;
  if (result.normal) end.normal = result.normal->unit;
  report_end(watch, kExactArithmetic, end);
}

}  // namespace

ExactDepth exact_expanding_polytope(const PosedPair& pair, const VertexPair* simplex, int count, int budget,
                                    const SearchWatch& watch) {
  ExactDepth result;
  PairHull hull(pair);
  // 1. and 2.
  const std::span given(simplex, static_cast<std::size_t>(count));
  if (!full_dimensional(pair, given, hull, result.support_calls, result.normal))
    return result;  // flat: at most touching
  result.normal.reset();
  const auto measure = [&](PairHull::Face& face) { hull.measure_finely(face); };
  hull.start(measure);

  const double scale = std::ldexp(1.0, pair.scale_exponent());
  bool touching = false;
  double best_lower = 0;
  double best_upper = std::numeric_limits<double>::infinity();
  // Each pass inserts a vertex of P or finds a face to be a facet for good.
  for (int step = 0;; ++step) {
    // 3.
    const int nearest = nearest_candidate(hull);
    if (nearest < 0 || hull.face(nearest).lower > best_upper) break;
    ++result.facets_visited;
    PairHull::Face& face = hull.face(nearest);
    const ExactDirection direction(hull.exact_normal(nearest));
    result.complete = result.support_calls < budget;
    if (!result.complete) break;
    // 5.
    ++result.support_calls;
    const VertexPair s = support(pair, direction);
    if (watch) report(watch, pair, hull, step, nearest, direction, best_upper, s, scale);
    const int v = hull.add_vertex(s);
    // 9.
    if (hull.side(nearest, v) > 0) {
      hull.insert(nearest, v, measure);
      continue;
    }
    // 7.
    hull.drop_last_vertex();
    face.facet = true;
    touching = rank_facet(pair, hull, nearest, direction, result);
    if (touching) break;
    if (face.upper < best_upper) {
      best_lower = face.lower;
      best_upper = face.upper;
    }
  }
  if (result.complete && !touching) result.contact = ContactClass::overlapping;
  if (watch) report_outcome(watch, result, scale * best_lower, scale * best_upper);
  return result;
}

}  // namespace pd::detail
