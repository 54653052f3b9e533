#include "depth/pair/polytope_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/distance/gjk_double_double.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/polytope_double.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// GJK in double-double for polytopes needs some ten steps; each takes up to a microsecond.
constexpr int kMaxDoubleDoubleSteps = 32;

double largest_coordinate(const InnerSurface& surface) {
  double largest = 0;
  for (const DifferenceVertex& v : surface.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
  return largest;
}

/// The face whose plane is turned most nearly along a unit vector.
int face_along(const InnerSurface& surface, const Vec3& unit) {
  int best = -1;
  double cosine = -2;
  for (int f = 0; f < surface.slots(); ++f) {
    if (!(surface.key(f) < std::numeric_limits<double>::infinity())) continue;
    const Vec3 normal = surface.normal(f);
    const double along = normal.dot(unit) / normal.norm();
    if (along > cosine) {
      cosine = along;
      best = f;
    }
  }
  return best;
}

/// The surface winds round the origin: its bounds, as far as the search brought them together.
void answer_inside(PolytopeQuery& query, const ExpansionResult& found, PenetrationDepth& out) {
  const InnerSurface& surface = query.buffers.surface;
  HeightOfFace least =
      upper_bound_of_nearest_faces(query.with_supports(), surface, query.buffers.stack, out.statistics.support_calls);
  if (found.upper < least.upper) least = {found.upper, found.normal, face_along(surface, found.normal)};
  set_depth(query.pair, found.lower, least.upper, least.normal, out);
  set_contact_of_face(query, least.face >= 0 ? least.face : found.face, least.normal, out);
  out.bracket_reached =
      least.upper - found.lower <= query.widest_bracket() || least.upper <= (1 + query.settings.delta) * found.lower;
}

/// The signed distance of the cores, between a plane and a point.
class CoreInterval {
 public:
  explicit CoreInterval(PolytopeQuery& query, Statistics& statistics) : query_(query), statistics_(statistics) {}

  double lower = -std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitX();  ///< P lies below -lower along it
  ClosestPoint nearest;         ///< nearest.upper is the upper end

  void bound_below(double height_of_p, const Vec3& unit) {
    if (-height_of_p > lower) {
      lower = -height_of_p;
      normal = unit;
    }
  }
  /// P's height along a direction, both ways; a zero vector has none.
  void look_along(const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return;
    for (const Vec3& unit : {Vec3(direction / length), Vec3(-direction / length)}) {
      const PolytopeDifference& difference = query_.with_supports();
      const DifferenceVertex s =
          difference.certified_support(unit, difference.support(unit, nullptr), query_.buffers.stack);
      ++statistics_.support_calls;
      bound_below(s.x.dot(unit) + support_plane_error(difference), unit);
    }
  }

  /// Across what is flat: P is, where both bodies are flat or slender and lie in one plane, or cross.
  void look_across_flat_bodies() {
    const Vec3 across_a = across(*query_.pair.a, *query_.pair.pose_a);
    const Vec3 across_b = across(*query_.pair.b, *query_.pair.pose_b);
    const int dimension_a = query_.pair.a->affine_dimension(), dimension_b = query_.pair.b->affine_dimension();
    if (dimension_a == 2) look_along(across_a);
    if (dimension_b == 2) look_along(across_b);
    if (dimension_a > 1 || dimension_b > 1) return;
    // Two segments span a plane, or one line; a point spans nothing.
    const Vec3 plane = across_a.cross(across_b);
    look_along(plane);
    for (const Vec3& line : {across_a, across_b}) {
      int least = 0;
      line.cwiseAbs().minCoeff(&least);
      look_along(line.cross(Vec3::Unit(least)));
    }
    if (dimension_a == 0 && dimension_b == 0) look_along(Vec3::UnitX());
  }
  /// Edges that round to nothing have no direction across them.
  void look_along_axes_if_unbounded() {
    for (int k = 0; k < 3 && !std::isfinite(lower); ++k) look_along(Vec3::Unit(k));
  }

 private:
  /// The normal of a polygon, the direction of a segment, 0 of a point; in the caller's axes. From edges as posed:
  /// a host's rotation may be one only up to single precision.
  static Vec3 across(const ConvexPolytope& body, const Pose& pose) {
    if (body.affine_dimension() == 0 || body.affine_dimension() == 3) return Vec3::Zero();
    const Vec3 u = pose.rotation() * (body.vertex(1) - body.vertex(0));
    if (body.affine_dimension() == 1) return u;
    const auto loop = body.facet_vertices(0);
    const Vec3 corner = body.vertex(loop[0]);
    return (pose.rotation() * (body.vertex(loop[1]) - corner)).cross(pose.rotation() * (body.vertex(loop[2]) - corner));
  }

  PolytopeQuery& query_;
  Statistics& statistics_;
};

/// Witnesses of the nearest point; features of those corners of its simplex that lie in P's supporting plane along the
/// normal, within `width`. A simplex round the origin has others, too, on facets that do not touch.
void set_contact_along(const PolytopePair& pair, const ClosestPoint& nearest, double width, PenetrationDepth& out) {
  set_witnesses(pair, nearest.simplex, nearest.weights, nearest.count, out);
  const auto height = [&](int i) { return nearest.simplex[i].x.dot(out.normal); };
  int top = 0;
  for (int i = 1; i < nearest.count; ++i) {
    if (height(i) > height(top)) top = i;
  }
  DifferenceVertex corners[3] = {nearest.simplex[top], nearest.simplex[top], nearest.simplex[top]};
  int count = 1;
  for (int i = 0; i < nearest.count && count < 3; ++i) {
    if (i != top && height(i) >= height(top) - width) corners[count++] = nearest.simplex[i];
  }
  set_features(pair, corners, out);
}

void answer_near_boundary(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out) {
  const PolytopeDifference& difference = query.with_supports();
  const DifferenceVertex first = difference.support(surface.normal, nullptr);
  CoreInterval cores(query, out.statistics);
  cores.nearest = closest_point(query, {&first, 1}, out.statistics);
  if (answer_apart(query, cores.nearest, out)) return;
  const ClosestPointWithNormal fine = closest_point_double_double(
      difference, first, 0, query.width(), kMaxDoubleDoubleSteps, query.buffers.stack, out.statistics.support_calls);
  if (fine.nearest.upper <= cores.nearest.upper) cores.nearest = fine.nearest;
  cores.bound_below(-fine.nearest.lower, fine.normal);
  if (surface.upper < std::numeric_limits<double>::infinity()) cores.bound_below(surface.upper, surface.normal);
  double largest = largest_coordinate(query.buffers.surface);
  const ClosestPoint& nearest = cores.nearest;
  for (int i = 0; i < nearest.count; ++i) largest = std::max(largest, nearest.simplex[i].x.cwiseAbs().maxCoeff());
  const double limit = query.widest_bracket();
  const auto narrow = [&] { return nearest.upper - cores.lower <= limit; };
  for (int i = 2; i < nearest.count && !narrow(); ++i) {
    const Vec3 corner = nearest.simplex[0].x;
    cores.look_along((nearest.simplex[i - 1].x - corner).cross(nearest.simplex[i].x - corner));
  }
  if (!narrow() && surface.face >= 0) {
    const HeightOfFace least = upper_bound_of_nearest_faces(difference, query.buffers.surface, query.buffers.stack,
                                                            out.statistics.support_calls);
    cores.bound_below(least.upper, least.normal);
  }
  if (!narrow()) cores.look_across_flat_bodies();
  cores.look_along_axes_if_unbounded();
  cores.lower = std::min(cores.lower, nearest.upper);
  out.normal = cores.normal;
  set_contact_along(query.pair, nearest, limit, out);
  set_signed_distance(query.pair.margins.both(), cores.lower, nearest.upper, out);
  out.bracket_reached = narrow();
  keep_wide_contact(largest, out);
}

}  // namespace

bool answer_at_one_place(PolytopeQuery& query, PenetrationDepth& out) {
  if (!query.for_contact()) return false;
  const double reach = query.difference.reach();
  if (!(2 * reach <= query.width().length || reach == 0)) return false;
  ClosestPoint nearest;
  nearest.count = 1;
  nearest.simplex[0] = query.difference.posed_vertex(0, 0);
  nearest.weights[0] = 1;
  out.method = Method::expansion;
  out.normal = Vec3::UnitX();
  set_contact_of_simplex(query.pair, nearest, out);
  set_signed_distance(query.pair.margins.both(), -reach, reach, out);
  return true;
}

bool answer_contact(PolytopeQuery& query, PenetrationDepth& out) {
  const ExpansionResult& surface = query.surface;
  if (answer_at_one_place(query, out)) return true;
  if (surface.face >= 0 && surface.lower > 0) {
    answer_inside(query, surface, out);
  } else {
    out.method = Method::expansion;
    answer_near_boundary(query, surface, out);
  }
  return true;
}

}  // namespace pd::detail
