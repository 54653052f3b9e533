#include "structure/bipartite/cube_charts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shape/normal_matrix.hpp"

namespace pd::detail {

namespace {

/// The cube stands askew, so that the arcs of aligned bodies run along none of its edges and axes. Any rotation serves.
Mat3 cube_frame() { return Eigen::Quaterniond(0.81, 0.23, -0.37, 0.31).normalized().toRotationMatrix(); }

class ArcClipper {
 public:
  explicit ArcClipper(std::array<std::vector<ChartSegment>, kCharts>& charts) : charts_(charts) {}

  /// The chord from p to q, directions of any length at most a right angle apart.
  void add(const Vec3& p, const Vec3& q, std::int32_t edge) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) add(p, q, edge, axis, sign);
    }
  }

 private:
  void add(const Vec3& p, const Vec3& q, std::int32_t edge, int axis, double sign) {
    const int i = (axis + 1) % 3;
    const int j = (axis + 2) % 3;
    constexpr double kReach = 1 + kChartOverlap;
    double from = 0;
    double to = 1;
    // Inside where sign w kReach -+ u >= 0 and the same with v; all four >= 0 imply w > 0.
    const double wp = sign * p[axis] * kReach;
    const double wq = sign * q[axis] * kReach;
    for (const auto& [fp, fq] : {std::pair{wp - p[i], wq - q[i]}, std::pair{wp + p[i], wq + q[i]},
                                 std::pair{wp - p[j], wq - q[j]}, std::pair{wp + p[j], wq + q[j]}}) {
      if (fp < 0 && fq < 0) return;
      if (fp < 0) from = std::max(from, fp / (fp - fq));
      if (fq < 0) to = std::min(to, fp / (fp - fq));
    }
    if (!(from <= to)) return;
    const Vec3 a = from > 0 ? Vec3(p + from * (q - p)) : p;
    const Vec3 b = to < 1 ? Vec3(p + to * (q - p)) : q;
    const double wa = sign * a[axis];
    const double wb = sign * b[axis];
    if (!(wa > 0 && wb > 0)) return;  // the chord of a corner of the cube, lost in rounding
    ChartSegment s{a[i] / wa, a[j] / wa, b[i] / wb, b[j] / wb, edge};
    if (s.x0 > s.x1) {
      std::swap(s.x0, s.x1);
      std::swap(s.y0, s.y1);
    }
    charts_[static_cast<std::size_t>(2 * axis + (sign < 0 ? 1 : 0))].push_back(s);
  }

  std::array<std::vector<ChartSegment>, kCharts>& charts_;
};

}  // namespace

void clip_to_charts(const PosedPair& pair, bool of_a, std::array<std::vector<ChartSegment>, kCharts>& charts) {
  const ConvexPolytope& body = of_a ? pair.a() : pair.b();
  const Mat3 frame = cube_frame();
  const Mat3 turn = frame * normal_matrix(of_a ? pair.pose_a() : pair.pose_b());
  const double mirror = of_a ? -1 : 1;
  const auto unit_edge = [&](int h) {
    // Double-double: a short edge far from its frame's origin keeps its direction.
    const int from = body.half_edge(h).origin;
    const int to = body.target(h);
    const Vec3DD e = pair.approximate_dd(of_a ? PairVector::edge_a(from, to) : PairVector::edge_b(from, to));
    return Vec3(frame * Vec3(e.x.hi, e.y.hi, e.z.hi).stableNormalized());
  };
  for (std::vector<ChartSegment>& chart : charts) chart.clear();
  ArcClipper clipper(charts);
  for (int h = 0; h < body.num_half_edges(); ++h) {
    const HalfEdge e = body.half_edge(h);
    if (e.twin < h) continue;
    if (e.facet < 0) {  // a segment: the whole great circle
      const Vec3 axis = unit_edge(h);
      const Vec3 u = axis.unitOrthogonal();
      const Vec3 v = axis.cross(u);
      const Vec3 corners[4] = {u, v, -u, -v};
      for (int k = 0; k < 4; ++k) clipper.add(corners[k], corners[(k + 1) % 4], h);
      continue;
    }
    const Vec3 p = (mirror * (turn * body.facet_normal(e.facet))).normalized();
    const Vec3 q = (mirror * (turn * body.facet_normal(body.half_edge(e.twin).facet))).normalized();
    if (p.dot(q) >= 0) {
      clipper.add(p, q, h);
      continue;
    }
    // The middle lies a quarter turn ahead of p and behind q; both terms have length 1, and their sum is long where p
    // + q is short. Mirrored arcs turn the same way.
    const Vec3 axis = unit_edge(h);
    const Vec3 middle = (axis.cross(p) - axis.cross(q)).normalized();
    clipper.add(p, middle, h);
    clipper.add(middle, q, h);
  }
}

}  // namespace pd::detail
