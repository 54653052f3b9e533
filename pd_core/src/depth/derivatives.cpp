#include "pd/depth/derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "depth/features/direction_search.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/small_decompositions.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

using detail::PlaneFace;
using detail::PlanePoint;
using detail::PosedCore;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Curved bodies: the least relative error that the search reaches for every shape and size.
constexpr double kCurvedDelta = 1e-12;

/// Curved bodies: what leans from the normal by less belongs to the face across it, as the normal itself is known to
/// sqrt(2e-12) radians only; of bodies apart to the witnesses' error divided by the distance.
constexpr double kCurvedLean = 1e-5;

/// One body where it meets the other: lengths relative to A's translation.
struct Side {
  PosedCore core;
  Vec3 arm;           ///< from the body's own translation to its core's witness
  Vec3 witness;       ///< of the core
  Vec3 outward;       ///< of the body there
  double sign;        ///< of the body in b - a
  int flats = 0;      ///< dimension of the face across the normal
  Vec3 flat[2] = {};  ///< unit vectors along it
  double inside = 0;  ///< of the witness in that face
};

/// The pair where it meets, all that the derivatives need.
struct Meeting {
  Side sides[2];
  Vec3 normal;
  std::array<Vec3, 2> across;  ///< the plane across the normal
  double core_depth = 0;       ///< signed, of the cores
  double size = 0;             ///< L
  bool curved = false;
  TieTolerance tolerance{};
};

double size_of_difference(const PosedCore& a, const PosedCore& b) {
  double size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 d = sign * Vec3::Unit(axis);
      size = std::max(size, std::abs((b.support(d) - a.support(-d))[axis]));
    }
  }
  return size;
}

Meeting meet(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer) {
  const Vec3& origin = a.pose.translation();
  const Vec3& n = answer.normal;
  const double margin_a = a.shape->margin(), margin_b = b.shape->margin();
  const Vec3 on_a = answer.witness_a + margin_a * n, on_b = answer.witness_b - margin_b * n;
  const Vec3 u = n.unitOrthogonal();
  Meeting m{{{PosedCore(a, origin), on_a - origin, on_a - origin, -n, -1},
             {PosedCore(b, origin), on_b - b.pose.translation(), on_b - origin, n, 1}},
            n,
            {u, n.cross(u)}};
  m.core_depth = -answer.signed_distance() - margin_a - margin_b;
  m.size = size_of_difference(m.sides[0].core, m.sides[1].core) + margin_a + margin_b;
  m.curved = m.sides[0].core.curved() || m.sides[1].core.curved();
  m.tolerance = m.curved ? kCurvedTie : kPolytopeTie;
  return m;
}

/// The face of a body across the normal, seen from its witness; sets the body's flats.
PlaneFace face_of(Side& side, const Meeting& m) {
  std::vector<Vec3> points;
  const double lean = m.curved ? kCurvedLean : m.tolerance.tie;
  side.core.near_face(side.outward, lean * m.size, lean, points);
  PlaneFace face(points, side.witness, m.across);
  std::array<PlanePoint, 2> directions;
  side.flats = face.extent(m.tolerance.reach_of_points * m.size, directions);
  for (int k = 0; k < side.flats; ++k) {
    const PlanePoint& d = directions[static_cast<std::size_t>(k)];
    side.flat[k] = d.x() * m.across[0] + d.y() * m.across[1];
  }
  side.inside = face.inside(side.flats, directions);
  return face;
}

/// The shortest x for which x[0] columns[0] + x[1] columns[1] comes nearest to `goal`: the longer column is made an
/// axis, and a second column that hardly leaves this axis counts as parallel to it.
PlanePoint shortest_solution(const PlanePoint (&columns)[2], const PlanePoint& goal) {
  const int first = columns[1].squaredNorm() > columns[0].squaredNorm() ? 1 : 0, second = 1 - first;
  const double length = columns[first].norm();
  PlanePoint solution = PlanePoint::Zero();
  if (length == 0) return solution;
  const PlanePoint axis = columns[first] / length, aside(-axis.y(), axis.x());
  const double along = axis.dot(columns[second]), across = aside.dot(columns[second]);
  if (std::abs(across) > 2 * std::numeric_limits<double>::epsilon() * length) {
    solution[second] = aside.dot(goal) / across;
    solution[first] = (axis.dot(goal) - along * solution[second]) / length;
  } else {
    const double scale = axis.dot(goal) / (length * length + along * along);
    solution[first] = scale * length;
    solution[second] = scale * along;
  }
  return solution;
}

/// Witnesses anew, from the supports in the normal's direction and the flats: the weights of a nearly flat triangle of
/// P, from which a search at 1e-12 takes them, may be off by far more than the depth.
void place_witnesses(Meeting& m) {
  Side& a = m.sides[0];
  Side& b = m.sides[1];
  (void)face_of(a, m);
  (void)face_of(b, m);
  const int flats = a.flats + b.flats;
  if (flats > 2) return;
  const Vec3 on_a = a.core.support(a.outward), on_b = b.core.support(b.outward);
  PlanePoint along[2] = {PlanePoint::Zero(), PlanePoint::Zero()};
  PlanePoint miss;
  for (int row = 0; row < 2; ++row) {
    const Vec3& across = m.across[static_cast<std::size_t>(row)];
    miss[row] = -(on_b - on_a).dot(across);
    for (int k = 0; k < a.flats; ++k) along[k][row] = -a.flat[k].dot(across);
    for (int k = 0; k < b.flats; ++k) along[a.flats + k][row] = b.flat[k].dot(across);
  }
  const PlanePoint moves = shortest_solution(along, miss);
  const auto place = [&](Side& side, Vec3 point, int first) {
    for (int k = 0; k < side.flats; ++k) point += moves[first + k] * side.flat[k];
    side.arm += point - side.witness;
    side.witness = point;
  };
  place(a, on_a, 0);
  place(b, on_b, a.flats);
}

void find_flags(Meeting& m, DepthDerivatives& out) {
  const PlaneFace face_a = face_of(m.sides[0], m), face_b = face_of(m.sides[1], m);
  const double tie = m.tolerance.tie * m.size, reach = m.tolerance.reach_of_points * m.size;
  // P's outside sees one nearest point.
  out.unique_direction = m.core_depth < -tie;
  if (!out.unique_direction) {
    const double limit = m.core_depth + tie;
    // Faces that lean are no boundary of P: a disc of theirs excludes nothing.
    const double disc = m.curved ? 0 : detail::disc_in_difference(face_a, face_b);
    const double cone = detail::cone_of_disc(m.core_depth, disc, limit, m.tolerance.reach);
    out.unique_direction = !another_direction_within(m.sides[0].core, m.sides[1].core, {m.normal, cone}, limit,
                                                     out.answer.statistics.support_calls);
  }
  // Inside, the foot lies within a facet of P: where the faces' dimensions add up to more than its two, it is the
  // difference of many pairs.
  const bool many = m.core_depth > tie && m.sides[0].flats + m.sides[1].flats > 2;
  out.unique_witness = out.unique_direction && !many && !share_more_than_the_centre(face_a, face_b, tie, reach);
}

/// The linear conditions on the change of the normal (two numbers across it) and on the witnesses' moves along the
/// flats of their faces (one number a flat), lengths divided by L.
class FirstOrder {
 public:
  /// Requires m.sides' flats to be two at most.
  explicit FirstOrder(const Meeting& m) : m_(m) {
    for (int i = 0; i < 2; ++i) {
      const Side& side = m.sides[i];
      curvature_[i] = side.flats < 2 ? side.core.curvature(side.outward, side.witness, side.flats) : Mat3::Zero();
    }
    for (const Side& side : m.sides) {
      for (int k = 0; k < side.flats; ++k) flats_.push_back({&side, side.flat[k]});
    }
    const int count = static_cast<int>(flats_.size());
    double system[4 * 4] = {};
    const auto entry = [&](int row, int column) -> double& { return system[row + (2 + count) * column]; };
    const Mat3 bend = (curvature_[0] + curvature_[1] - m.core_depth * Mat3::Identity()) / m.size;
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 2; ++column) entry(row, column) = across(row).dot(bend * across(column));
      for (int k = 0; k < count; ++k) {
        entry(row, 2 + k) = flats_[at(k)].side->sign * flats_[at(k)].along.dot(across(row));
        entry(2 + k, row) = flats_[at(k)].along.dot(across(row));
      }
    }
    solver_.emplace(system, 2 + count);
  }

  /// Whether the conditions determine everything (a relative pivot of 1e-9 leaves derivatives half of their digits).
  [[nodiscard]] bool determined() const { return solver_->regular(1e-9); }

  struct Change {
    Vec3 normal;
    Vec3 witness[2];  ///< of the cores
  };
  /// When the body `moving` (0: A, 1: B) moves by `velocity` and turns by `turn`.
  [[nodiscard]] Change change(int moving, const Vec3& velocity, const Vec3& turn) const {
    const int count = static_cast<int>(flats_.size());
    const Side& mover = m_.sides[moving];
    const Vec3 carried = velocity + turn.cross(mover.arm);
    const Vec3 swung = turn.cross(m_.normal);
    const Vec3 known = mover.sign * carried - curvature_[moving] * swung;
    double solution[4] = {};
    for (int row = 0; row < 2; ++row) solution[row] = -known.dot(across(row)) / m_.size;
    for (int k = 0; k < count; ++k) {
      const Flat& flat = flats_[at(k)];
      solution[2 + k] = flat.side == &mover ? -turn.cross(flat.along).dot(m_.normal) : 0;
    }
    solver_->solve(solution);
    Change change;
    change.normal = solution[0] * across(0) + solution[1] * across(1);
    for (int i = 0; i < 2; ++i) {
      const Vec3 bent = i == moving ? Vec3(change.normal - swung) : change.normal;
      change.witness[i] = m_.sides[i].sign * (curvature_[i] * bent);
      if (i == moving) change.witness[i] += carried;
    }
    for (int k = 0; k < count; ++k) {
      change.witness[flats_[at(k)].side == &m_.sides[0] ? 0 : 1] += solution[2 + k] * m_.size * flats_[at(k)].along;
    }
    return change;
  }

 private:
  struct Flat {
    const Side* side;
    Vec3 along;
  };
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] const Vec3& across(int k) const { return m_.across[at(k)]; }

  const Meeting& m_;
  Mat3 curvature_[2];
  std::vector<Flat> flats_;
  std::optional<detail::SmallElimination> solver_;
};

/// Within `kCurvedLean` of the normal a curved body shows arcs, too: a rim next to its disc, a flat ellipsoid. They
/// bend, and are no flats.
/// @return whether the curvature is the same, to a hundredth, within that lean.
bool tell_arcs_from_flats(Side& side) {
  if (!side.core.curved()) return true;
  side.flats = std::min(side.flats, side.core.straight_dimensions(side.outward, kCurvedLean));
  if (side.flats == 2) return true;
  const Mat3 here = side.core.curvature(side.outward, side.witness, side.flats);
  const Vec3 u = side.outward.unitOrthogonal(), v = side.outward.cross(u);
  for (const Vec3& aside : {u, v, Vec3(-u), Vec3(-v)}) {
    const Mat3 there = side.core.curvature(side.outward + kCurvedLean * aside, side.witness, side.flats);
    if (!((there - here).norm() <= .01 * here.norm())) return false;
  }
  return true;
}

void differentiate_features(Meeting& m, double margin_a, double margin_b, DepthDerivatives& out) {
  if (!out.unique_witness) return;
  for (Side& side : m.sides) {
    if (!tell_arcs_from_flats(side)) return;
    if (side.flats > 0 && side.inside <= m.tolerance.reach_of_points * m.size) return;
  }
  if (m.sides[0].flats + m.sides[1].flats > 2) return;
  FirstOrder conditions(m);
  if (!conditions.determined()) return;
  out.stable_features = true;
  PoseJacobian* const normals[2] = {&out.normal_by_a, &out.normal_by_b};
  PoseJacobian* const on_a[2] = {&out.witness_a_by_a, &out.witness_a_by_b};
  PoseJacobian* const on_b[2] = {&out.witness_b_by_a, &out.witness_b_by_b};
  for (int moving = 0; moving < 2; ++moving) {
    for (int k = 0; k < 3; ++k) {
      for (const bool turns : {false, true}) {
        const Vec3 unit = Vec3::Unit(k);
        const auto change = conditions.change(moving, turns ? Vec3::Zero() : unit, turns ? unit : Vec3::Zero());
        const auto part = turns ? &PoseJacobian::rotation : &PoseJacobian::translation;
        (normals[moving]->*part).col(k) = change.normal;
        (on_a[moving]->*part).col(k) = change.witness[0] - margin_a * change.normal;
        (on_b[moving]->*part).col(k) = change.witness[1] + margin_b * change.normal;
      }
    }
  }
}

void scale_derivatives(DepthDerivatives& d, int exponent) {
  const double up = std::ldexp(1.0, exponent), down = std::ldexp(1.0, -exponent);
  d.by_a.rotation *= up;
  d.by_b.rotation *= up;
  for (PoseJacobian* j : {&d.normal_by_a, &d.normal_by_b}) j->translation *= down;
  for (PoseJacobian* j : {&d.witness_a_by_a, &d.witness_a_by_b, &d.witness_b_by_a, &d.witness_b_by_b}) {
    j->rotation *= up;
  }
}

}  // namespace

DepthDerivatives depth_derivatives(const PosedShape& a, const PosedShape& b, Scratch& scratch) {
  const detail::FloatingPointGuard guard;
  DepthSettings settings;
  if (!a.shape->polytope() || !b.shape->polytope()) settings.delta = kCurvedDelta;
  if (const int exponent = detail::extreme_exponent(a, b); exponent != 0) {
    const detail::ScaledPair near(a, b, exponent);
    DepthDerivatives out = depth_derivatives(near.a(), near.b(), scratch);
    scale_derivatives(out, exponent);
    const Vec3 on_a = out.answer.witness_a, on_b = out.answer.witness_b;
    out.answer = penetration_depth(a, b, scratch, settings);
    out.signed_depth = -out.answer.signed_distance();
    if (!near.a().shape->polytope() || !near.b().shape->polytope()) {
      out.answer.witness_a = detail::times_power(on_a, exponent) + a.pose.translation();
      out.answer.witness_b = detail::times_power(on_b, exponent) + a.pose.translation();
    }
    return out;
  }
  DepthDerivatives out;
  const PoseJacobian none{Mat3::Constant(kNone), Mat3::Constant(kNone)};
  out.by_a = out.by_b = {Vec3::Constant(kNone), Vec3::Constant(kNone)};
  out.normal_by_a = out.normal_by_b = out.witness_a_by_a = out.witness_a_by_b = none;
  out.witness_b_by_a = out.witness_b_by_b = none;
  out.answer = penetration_depth(a, b, scratch, settings);
  out.signed_depth = -out.answer.signed_distance();
  Meeting m = meet(a, b, out.answer);
  if (m.curved) {
    place_witnesses(m);
    out.answer.witness_a = m.sides[0].witness + a.pose.translation() - a.shape->margin() * m.normal;
    out.answer.witness_b = m.sides[1].witness + a.pose.translation() + b.shape->margin() * m.normal;
  }
  find_flags(m, out);
  if (out.unique_direction) {
    out.by_a.translation = -m.normal;
    out.by_b.translation = m.normal;
  }
  if (out.unique_witness) {
    out.by_a.rotation = -m.sides[0].arm.cross(m.normal);
    out.by_b.rotation = m.sides[1].arm.cross(m.normal);
  }
  differentiate_features(m, a.shape->margin(), b.shape->margin(), out);
  return out;
}

}  // namespace pd
