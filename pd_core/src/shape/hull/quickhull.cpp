#include "shape/hull/quickhull.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "numeric/unit_roundoff.hpp"

namespace pd::detail {
namespace {

// Each component of the rounded normal is off by at most 4u(1 + O(u)) times the sum P_i of the magnitudes of its two
// products (two differences, product, subtraction), against a point and a vertex at most 2 apart in every coordinate;
// the products and sums of height and offset add 8u P_i. Together below 20u (P_0 + P_1 + P_2), u = 2^-53; 24 covers the
// rounding of the bound. Underflow adds less than kUnderflow.
constexpr double kHeightError = 24 * kUnitRoundoff;
constexpr double kUnderflow = 1e-300;

// The hull first grows in breadth: growing one corner at a time gives its vertices degrees of order n where two long
// curves face each other, and then time of order n^2 (two parabolas of 10^5 points: 14.7 s, against 0.27 s). With this
// many triangles the rest of each is small, and depth first is twice as fast as breadth on spheres, since it stays in
// the cache.
constexpr std::size_t kFrontierSize = 2048;

}  // namespace

HullTriangle Quickhull::make_triangle(int a, int b, int c) const {
  const HullPoint& p = points_[a];
  const HullPoint& q = points_[b];
  const HullPoint& r = points_[c];
  const double ux = q.x - p.x;
  const double uy = q.y - p.y;
  const double uz = q.z - p.z;
  const double vx = r.x - p.x;
  const double vy = r.y - p.y;
  const double vz = r.z - p.z;
  const double magnitude = std::abs(uy * vz) + std::abs(uz * vy) + std::abs(uz * vx) + std::abs(ux * vz) +
                           std::abs(ux * vy) + std::abs(uy * vx);
  HullTriangle t;
  t.vertex[0] = a;
  t.vertex[1] = b;
  t.vertex[2] = c;
  t.normal[0] = uy * vz - uz * vy;
  t.normal[1] = uz * vx - ux * vz;
  t.normal[2] = ux * vy - uy * vx;
  t.offset = t.normal[0] * p.x + t.normal[1] * p.y + t.normal[2] * p.z;
  t.error = kHeightError * magnitude + kUnderflow;
  t.furthest_height = 0;
  t.first_outside = -1;
  t.mark = -1;
  if (p.x == q.x && q.x == r.x) align_with_axis(t, 0);
  if (p.y == q.y && q.y == r.y) align_with_axis(t, 1);
  if (p.z == q.z && q.z == r.z) align_with_axis(t, 2);
  return t;
}

void Quickhull::align_with_axis(HullTriangle& t, int axis) const {
  if (!points_.scaling_exact()) return;
  const int sign = points_.orient2d(t.vertex[0], t.vertex[1], t.vertex[2], axis);
  const HullPoint& p = points_[t.vertex[0]];
  const double coordinate = axis == 0 ? p.x : (axis == 1 ? p.y : p.z);
  for (int k = 0; k < 3; ++k) t.normal[k] = k == axis ? sign : 0;
  t.offset = sign * coordinate;
  t.error = 0;
}

Quickhull::Quickhull(HullPoints& points, const AffineFrame& frame) : points_(points) {
  auto [a, b, c, d] = frame.points;
  if (points.orient3d(a, b, c, d) > 0) std::swap(b, c);  // d below (a, b, c)
  // A hull of n vertices has 2n - 4 triangles; few points more than that are ever seen where all of many are vertices.
  triangles_.reserve(std::min(2 * static_cast<std::size_t>(points.size()), kFrontierSize) + 4);
  triangles_ = {make_triangle(a, b, c), make_triangle(a, d, b), make_triangle(b, d, c), make_triangle(c, d, a)};
  constexpr std::int32_t neighbours[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
  for (int t = 0; t < 4; ++t) {
    for (int i = 0; i < 3; ++i) at(t).neighbour[i] = neighbours[t][i];
  }
}

void Quickhull::add_outside(std::int32_t triangle, int p) {
  HullTriangle& t = at(triangle);
  const double height = t.height(points_[p]);
  const bool furthest = t.first_outside < 0 || height > t.furthest_height ||
                        // Of equally high points the lexicographically least is a vertex of the face that they span,
                        // and of duplicates the lowest id speaks for all.
                        (height == t.furthest_height && points_.less(p, t.first_outside));
  if (furthest) {
    points_[p].next = t.first_outside;
    t.first_outside = p;
    t.furthest_height = height;
  } else {
    points_[p].next = points_[t.first_outside].next;
    points_[t.first_outside].next = p;
  }
}

void Quickhull::insert(int first, int last) {
  std::vector<std::int32_t> living;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t) {
    if (!at(t).dead()) living.push_back(t);
  }
  for (int p = first; p < last; ++p) {
    for (const std::int32_t t : living) {
      if (side(at(t), p) > 0) {
        add_outside(t, p);
        break;
      }
    }
  }
  for (const std::int32_t t : living) {
    if (at(t).first_outside >= 0) pending_.push_back(t);
  }
  std::vector<std::int32_t> wave;
  while (!pending_.empty() && triangles_.size() <= kFrontierSize) {
    wave.swap(pending_);
    pending_.clear();
    for (const std::int32_t t : wave) {
      if (at(t).first_outside >= 0) add_vertex(t);
    }
  }
  std::erase_if(pending_, [&](std::int32_t t) { return at(t).first_outside < 0; });
  std::sort(pending_.begin(), pending_.end(),
            [&](std::int32_t s, std::int32_t t) { return at(s).first_outside > at(t).first_outside; });
  while (!pending_.empty()) {
    const std::int32_t t = pending_.back();
    pending_.pop_back();
    if (at(t).first_outside >= 0) add_vertex(t);
  }
}

std::int32_t Quickhull::allocate() {
  if (free_.empty()) {
    triangles_.emplace_back();
    return static_cast<std::int32_t>(triangles_.size() - 1);
  }
  const std::int32_t t = free_.back();
  free_.pop_back();
  return t;
}

void Quickhull::find_rim(std::int32_t seed, int p) {
  stamp_ += 2;
  const std::int32_t is_seen = stamp_;
  const std::int32_t is_unseen = stamp_ + 1;
  seen_.clear();
  rim_.clear();
  // Depth first with the edges of each triangle in order, starting behind the edge of entry, meets the rim in order.
  at(seed).mark = is_seen;
  seen_.push_back(seed);
  visits_.assign(1, {seed, 0, 3});
  while (!visits_.empty()) {
    Visit& visit = visits_.back();
    if (visit.edges_left == 0) {
      visits_.pop_back();
      continue;
    }
    const int edge = visit.first_edge;
    visit.first_edge = (edge + 1) % 3;
    --visit.edges_left;
    const HullTriangle& t = at(visit.triangle);
    const std::int32_t n = t.neighbour[edge];
    HullTriangle& beyond = at(n);
    if (beyond.mark == is_seen) continue;
    const int from = t.vertex[edge];
    int back = 0;
    while (beyond.vertex[(back + 1) % 3] != from) ++back;
    if (beyond.mark != is_unseen) beyond.mark = side(beyond, p) > 0 ? is_seen : is_unseen;
    if (beyond.mark == is_seen) {
      seen_.push_back(n);
      visits_.push_back({n, (back + 1) % 3, 2});
    } else {
      rim_.push_back({from, beyond.vertex[back], n, back});
    }
  }
}

void Quickhull::add_vertex(std::int32_t triangle) {
  const int p = at(triangle).first_outside;
  find_rim(triangle, p);

  fan_.clear();
  for (const RimEdge& edge : rim_) {
    const std::int32_t t = allocate();
    at(t) = make_triangle(edge.from, edge.to, p);
    at(t).neighbour[0] = edge.beyond;
    at(edge.beyond).neighbour[edge.beyond_edge] = t;
    fan_.push_back(t);
  }
  const std::size_t n = fan_.size();
  for (std::size_t i = 0; i < n; ++i) {
    assert(rim_[i].to == rim_[(i + 1) % n].from);
    at(fan_[i]).neighbour[1] = fan_[(i + 1) % n];
    at(fan_[i]).neighbour[2] = fan_[(i + n - 1) % n];
  }

  // A point above a seen triangle that is still outside lies above a triangle of the fan: above a seen and an unseen
  // triangle it is above the one between them, by a look along their edge.
  for (const std::int32_t s : seen_) {
    for (int q = at(s).first_outside; q >= 0;) {
      const int next = points_[q].next;
      if (q != p) {
        for (const std::int32_t t : fan_) {
          if (side(at(t), q) > 0) {
            add_outside(t, q);
            break;
          }
        }
      }
      q = next;
    }
    at(s).first_outside = HullTriangle::kDead;
    free_.push_back(s);
  }
  for (const std::int32_t t : fan_) {
    if (at(t).first_outside >= 0) pending_.push_back(t);
  }
}

void Quickhull::compact() {
  std::vector<std::int32_t> place(triangles_.size(), -1);
  std::int32_t count = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (!triangles_[t].dead()) place[t] = count++;
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (place[t] < 0) continue;
    HullTriangle moved = triangles_[t];
    for (std::int32_t& n : moved.neighbour) n = place[static_cast<std::size_t>(n)];
    at(place[t]) = moved;
  }
  triangles_.resize(static_cast<std::size_t>(count));
  free_.clear();
}

}  // namespace pd::detail
