#include "depth/distance/gjk.hpp"

#include <algorithm>
#include <limits>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

struct Candidate {
  double squared = std::numeric_limits<double>::infinity();
  Vec3 point = Vec3::Zero();
  int members[4] = {0, 0, 0, 0};
  double weights[4] = {0, 0, 0, 0};
  int count = 0;
};

void consider(Candidate& best, const DifferenceVertex* simplex, std::initializer_list<int> members,
              std::initializer_list<double> weights) {
  Candidate c;
  for (const int m : members) c.members[c.count++] = m;
  int k = 0;
  double total = 0;
  for (const double w : weights) {
    if (!(w > 0)) return;
    c.weights[k++] = w;
    total += w;
  }
  // Whatever rounding did to the weights of a near-degenerate simplex, the point is a convex combination: it lies in P.
  for (int i = 0; i < c.count; ++i) {
    c.weights[i] /= total;
    c.point += c.weights[i] * simplex[c.members[i]].x;
  }
  c.squared = c.point.squaredNorm();
  if (c.squared < best.squared) best = c;
}

void consider_edge(Candidate& best, const DifferenceVertex* s, int i, int j) {
  const Vec3 e = s[j].x - s[i].x;
  const double squared = e.squaredNorm();
  if (!(squared > 0)) return;
  // Each weight from its own end keeps both accurate.
  consider(best, s, {i, j}, {s[j].x.dot(e) / squared, -s[i].x.dot(e) / squared});
}

/// False where the origin's projection lies outside.
bool consider_triangle(Candidate& best, const DifferenceVertex* s, int i, int j, int k) {
  const Vec3 n = (s[j].x - s[i].x).cross(s[k].x - s[i].x);
  const double squared = n.squaredNorm();
  if (!(squared > 0)) return false;
  const double wi = n.dot(s[j].x.cross(s[k].x)) / squared;
  const double wj = n.dot(s[k].x.cross(s[i].x)) / squared;
  const double wk = n.dot(s[i].x.cross(s[j].x)) / squared;
  consider(best, s, {i, j, k}, {wi, wj, wk});
  return wi > 0 && wj > 0 && wk > 0;
}

/// No angle at the first corner below 2^-10.
bool is_well_shaped(const DifferenceVertex* s) {
  const Vec3 u = s[1].x - s[0].x, v = s[2].x - s[0].x;
  return u.cross(v).squaredNorm() > 0x1p-20 * u.squaredNorm() * v.squaredNorm();
}

/// Certain only beyond rounding: four nearly coplanar points enclose nothing.
bool inside_tetrahedron(const DifferenceVertex* s) {
  double size = 0;
  for (int i = 0; i < 4; ++i) size = std::max(size, s[i].x.cwiseAbs().maxCoeff());
  const double noise = 256 * kUnitRoundoff * size * size * size;
  const double volume = (s[1].x - s[0].x).cross(s[2].x - s[0].x).dot(s[3].x - s[0].x);
  const double side = volume < 0 ? -1 : 1;
  const auto inside = [&](double v) { return side * v > noise; };
  return inside(s[1].x.cross(s[2].x).dot(s[3].x)) && inside(-s[0].x.cross(s[2].x).dot(s[3].x)) &&
         inside(s[0].x.cross(s[1].x).dot(s[3].x)) && inside(-s[0].x.cross(s[1].x).dot(s[2].x));
}

}  // namespace

Vec3 closest_point_on_simplex(DifferenceVertex (&simplex)[4], int& count, double (&weights)[4], bool planar) {
  if (count == 4 && !planar && inside_tetrahedron(simplex)) {
    weights[0] = weights[1] = weights[2] = weights[3] = 0.25;
    return Vec3::Zero();
  }
  Candidate best;
  // A triangle that holds the projection holds the nearest point: bodies at rest end here. In a slender one
  // rounding may say so, too.
  const bool inside = count == 3 && is_well_shaped(simplex) && consider_triangle(best, simplex, 0, 1, 2);
  for (int i = 0; i < count && !inside; ++i) {
    consider(best, simplex, {i}, {1.0});
    for (int j = i + 1; j < count; ++j) {
      consider_edge(best, simplex, i, j);
      for (int k = j + 1; k < count; ++k) consider_triangle(best, simplex, i, j, k);
    }
  }
  for (int i = 0; i < best.count; ++i) {
    simplex[i] = simplex[best.members[i]];  // members ascend, so nothing is overwritten before it is read
    weights[i] = best.weights[i];
  }
  count = best.count;
  return best.point;
}

}  // namespace pd::detail
