#include "depth/facets/arc_culling.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "depth/facets/line_kernels.hpp"
#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

/// Vertices of the other body that the surface uses, each once. Returns their number.
std::size_t choose_vertices(const InnerSurface& surface, bool of_a, std::array<std::int32_t, kMaskProbes>& chosen) {
  std::size_t count = 0;
  for (const DifferenceVertex& v : surface.vertices) {
    const std::int32_t vertex = of_a ? v.a : v.b;
    const auto end = chosen.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::find(chosen.begin(), end, vertex) != end) continue;
    chosen[count++] = vertex;
    if (count == kMaskProbes) break;
  }
  return count;
}

/// Single precision errs by less than 32 of its u where both terms have length 1 at most, with what a matrix that is a
/// rotation only up to rounding adds to a normal's length.
void mark_far_facets(const BodySide& body, const PolytopeDifference& difference, const InnerSurface& surface,
                     double upper, NearArcs& out) {
  const Mat3 turn = normal_matrix(body.own_pose);
  const double stretch = std::sqrt(1 + (turn.transpose() * turn - Mat3::Identity()).norm());
  // The cofactors times the matrix are its determinant.
  const double growth = turn.col(0).dot(body.own_pose.rotation().col(0)) / difference.reach();
  const double sign = body.is_a ? -1 : 1;
  std::array<std::int32_t, kMaskProbes> chosen;
  const std::size_t count = choose_vertices(surface, !body.is_a, chosen);
  ProbeArrays test_points;
  for (std::size_t k = 0; k < kMaskProbes; ++k) {
    const Vec3 posed = body.other_pose.rotation() * body.other.vertex(chosen[k < count ? k : 0]);
    const Vec3 x = turn.transpose() * (difference.offset() - sign * posed) * (sign / difference.reach());
    test_points.x[k] = static_cast<float>(x.x());
    test_points.y[k] = static_cast<float>(x.y());
    test_points.z[k] = static_cast<float>(x.z());
  }
  const int facets = body.own.num_facets();
  out.far.resize(static_cast<std::size_t>(facets));
  out.levels.resize(static_cast<std::size_t>(facets));
  const double level = upper * stretch + 0x1p-19;
  for (int f = 0; f < facets; ++f) {
    const double height = growth * body.own.vertex(body.own.facet_vertices(f)[0]).dot(body.own.facet_normal(f));
    out.levels[static_cast<std::size_t>(f)] = static_cast<float>(level - height);
  }
  probes_beyond(body.own.facet_normal(0).data(), facets, test_points, out.levels.data(), out.far.data());
}

void keep_edges(const ConvexPolytope& body, NearArcs& out) {
  const int count = body.num_half_edges();
  out.kept.resize(static_cast<std::size_t>(count));
  std::size_t n = 0;
  for (int h = 0; h < count; ++h) {
    const HalfEdge e = body.half_edge(h);
    // Written in any case and counted where it stays: no branch to guess.
    out.kept[n] = h;
    const int other = body.half_edge(e.twin).facet;
    n += static_cast<std::size_t>(
        static_cast<int>(e.twin > h) &
        static_cast<int>((out.far[static_cast<std::size_t>(e.facet)] & out.far[static_cast<std::size_t>(other)]) == 0));
  }
  out.kept.resize(n);
}

}  // namespace

void find_near_arcs(const BodySide& body, const PolytopeDifference& difference, const InnerSurface& surface,
                    double upper, NearArcs& out) {
  mark_far_facets(body, difference, surface, upper, out);
  keep_edges(body.own, out);
}

}  // namespace pd::detail
