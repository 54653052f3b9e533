#include "structure/overlay/posed_diagram.hpp"

#include <algorithm>

#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/facet_of_difference.hpp"

namespace pd::detail {

namespace {

double norm1(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }

}  // namespace

void pose_edges(const PosedPair& pair, bool of_a, PosedDiagram& diagram) {
  const ConvexPolytope& body = of_a ? pair.a() : pair.b();
  diagram.point_error = pair.vector_error();
  diagram.points.resize(static_cast<std::size_t>(body.num_vertices()));
  double reach = 0;
  for (int v = 0; v < body.num_vertices(); ++v) {
    PairVector posed;  // R_A a = -(R_A (0 - a)), or R_B b
    (of_a ? posed.a_from : posed.b_to) = v;
    Vec3& point = diagram.points[static_cast<std::size_t>(v)];
    point = pair.approximate(posed);
    reach = std::max(reach, norm1(point));
  }
  diagram.reach = reach * (1 + 4 * kUnitRoundoff) + 3 * diagram.point_error;
  // The difference of two points, rounded.
  diagram.edge_error = (2 * diagram.point_error + kUnitRoundoff * 2 * diagram.reach) * (1 + 4 * kUnitRoundoff);
  diagram.half_edges.resize(static_cast<std::size_t>(body.num_half_edges()));
  double total = 0;
  for (int h = 0; h < body.num_half_edges(); ++h) {
    const HalfEdge half_edge = body.half_edge(h);
    const Vec3 v = diagram.points[static_cast<std::size_t>(body.half_edge(half_edge.twin).origin)] -
                   diagram.points[static_cast<std::size_t>(half_edge.origin)];
    const double size = norm1(v);
    diagram.half_edges[static_cast<std::size_t>(h)] = {{v.x(), v.y(), v.z()}, size};
    total += size;
  }
  diagram.edge_size = body.num_half_edges() > 0 ? total / body.num_half_edges() + diagram.edge_error : 1;
  for (PosedDiagram::Edge& edge : diagram.half_edges) edge.size += diagram.edge_size;
}

void pose_facets(const ConvexPolytope& body, const PosedDiagram& other, PosedDiagram& diagram) {
  const double error = diagram.edge_error;
  const std::size_t count = static_cast<std::size_t>(body.num_facets());
  diagram.facets.resize(count);
  diagram.normal_errors.resize(count);
  diagram.cell.assign(count, -1);
  for (std::size_t f = 0; f < count; ++f) {
    const auto corner = FacetOfDifference::corners(body, static_cast<int>(f));
    const Vec3& origin = diagram.points[static_cast<std::size_t>(corner[0])];
    const Vec3 u = diagram.points[static_cast<std::size_t>(corner[1])] - origin;
    const Vec3 v = diagram.points[static_cast<std::size_t>(corner[2])] - origin;
    const Vec3 n = u.cross(v);
    // A coordinate is u_j v_k - u_k v_j: input errors, then two products and a difference (3u of the sum of
    // magnitudes).
    const double su = norm1(u), sv = norm1(v), sn = norm1(n);
    const double normal_error = (error * (su + sv + 2 * error) + 3 * kUnitRoundoff * su * sv) * (1 + 8 * kUnitRoundoff);
    diagram.normal_errors[f] = normal_error;
    // <e, n> errs by |e|_1 (error(n) + 4u |n|_1), the latter for products and sums, and by error(e) (|n|_1 + 3
    // error(n)).
    const double slope = normal_error + 4 * kUnitRoundoff * sn;
    const double constant = other.edge_error * (sn + 3 * normal_error) + 0x1p-900;
    diagram.facets[f] = {{n.x(), n.y(), n.z()}, std::max(slope, constant / other.edge_size) * (1 + 16 * kUnitRoundoff)};
  }
}

}  // namespace pd::detail
