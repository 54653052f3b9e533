#include "structure/hierarchy/plane_descent.hpp"

#include <algorithm>
#include <cmath>

namespace pd::detail {

PlaneDescent::PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction)
    : hierarchy_(hierarchy), direction_(direction) {
  choose_sideways();
  const ConvexPolytope& body = hierarchy.polytope();
  int best = -1;
  double most = -HUGE_VAL;
  for (const std::int32_t v : hierarchy.coarsest()) {
    ++evaluations_;
    const double value = body.vertex(v).dot(direction_);
    if (value <= most) continue;
    best = v;
    most = value;
  }
  enter(best);
}

PlaneDescent::PlaneDescent(const PolyhedralHierarchy& hierarchy, const Vec3& direction, int vertex)
    : hierarchy_(hierarchy), direction_(direction) {
  choose_sideways();
  enter(vertex);
}

/// Any direction across will do; one that is in no simple ratio to the body's edges has fewer ties.
void PlaneDescent::choose_sideways() {
  int least = 0;
  direction_.cwiseAbs().minCoeff(&least);
  const Vec3 across = direction_.cross(Vec3::Unit(least));
  sideways_ = across + 0.6180339887498949 * direction_.cross(across) / direction_.cwiseAbs().maxCoeff();
}

PlaneDescent::Shadow PlaneDescent::shadow(int v) {
  ++evaluations_;
  const Vec3 step = hierarchy_.polytope().vertex(v) - at_;
  return {step.dot(sideways_), step.dot(direction_)};
}

void PlaneDescent::enter(int vertex) {
  vertex_ = vertex;
  at_ = hierarchy_.polytope().vertex(vertex);
  level_ = hierarchy_.last_level(vertex);
  const auto star = hierarchy_.star(vertex);
  // Every step points down in the shadow, or is level: its boundary leaves `vertex` along the first and the last by
  // angle. What rises does so by rounding only: neighbours in one contact plane.
  std::array<std::size_t, 2> spokes{0, 0};
  std::array<Shadow, 2> best{};
  for (std::size_t k = 0; k < star.size(); ++k) {
    Shadow s = shadow(star[k].neighbour);
    s.up = std::min(s.up, 0.0);
    const auto turn = [&](const Shadow& other) { return s.along * other.up - s.up * other.along; };
    if (k == 0 || turn(best[0]) > 0 || (turn(best[0]) == 0 && s.along < best[0].along)) {
      best[0] = s;
      spokes[0] = k;
    }
    if (k == 0 || turn(best[1]) < 0 || (turn(best[1]) == 0 && s.along > best[1].along)) {
      best[1] = s;
      spokes[1] = k;
    }
  }
  for (const int side : {0, 1}) {
    set_edge(side, spokes[static_cast<std::size_t>(side)], vertex);
    edges_[static_cast<std::size_t>(side)].along = best[static_cast<std::size_t>(side)].along;
    edges_[static_cast<std::size_t>(side)].up = best[static_cast<std::size_t>(side)].up;
  }
}

/// The edge from `vertex` to the given spoke of its own star.
void PlaneDescent::set_edge(int side, std::size_t spoke, int of) {
  const auto star = hierarchy_.star(of);
  Edge& edge = edges_[static_cast<std::size_t>(side)];
  edge.to = star[spoke].neighbour;
  edge.faces = {star[(spoke + star.size() - 1) % star.size()].face, star[spoke].face};
}

bool PlaneDescent::next(int finest) {
  for (;;) {
    // The next step back that changes a triangle at the two edges.
    int u = -1, step = finest - 1;
    for (const Edge& edge : edges_) {
      for (const std::int32_t f : edge.faces) {
        const int creator = hierarchy_.creator(f);
        if (creator < 0) continue;
        const int last = hierarchy_.last_level(creator);
        if (last <= step) continue;
        step = last;
        u = creator;
      }
    }
    if (u < 0) return false;
    if (shadow(u).up > 0) {
      enter(u);
      return true;
    }
    level_ = step;
    refine(0, u);
    refine(1, u);
  }
}

void PlaneDescent::refine(int side, int u) {
  Edge& edge = edges_[static_cast<std::size_t>(side)];
  std::array<bool, 2> hidden{};
  for (std::size_t i = 0; i < 2; ++i) hidden[i] = hierarchy_.creator(edge.faces[i]) == u;
  if (!hidden[0] && !hidden[1]) return;
  const auto star = hierarchy_.star(u);
  const std::size_t d = star.size();
  std::size_t mine = 0;
  while (star[mine].neighbour != vertex_) ++mine;
  const Shadow s = shadow(u);
  const double turn = s.along * edge.up - s.up * edge.along;
  if ((hidden[0] && hidden[1]) || (side == 0 ? turn > 0 : turn < 0)) {
    // The edge to u: to its right, seen from `vertex`, the triangle of u with the neighbour before, to its left after.
    edge.to = u;
    edge.faces = {star[mine].face, star[(mine + d - 1) % d].face};
    edge.along = s.along;
    edge.up = s.up;
    return;
  }
  const bool after = star[(mine + 1) % d].neighbour == edge.to;
  edge.faces[hidden[0] ? 0 : 1] = after ? star[mine].face : star[(mine + d - 1) % d].face;
}

}  // namespace pd::detail
