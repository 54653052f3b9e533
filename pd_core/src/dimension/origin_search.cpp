#include "dimension/origin_search.hpp"

#include <cmath>

#include "dimension/least_norm_simplex.hpp"
#include "dimension/nested_ternary.hpp"
#include "dimension/origin_frame.hpp"

namespace pd::dimension::detail {

namespace {

/// How far the body is grown, in parts of its width on each side, and what that leaves.
struct OriginGrowth {
  double least;      ///< covers the oracle's error: h_K <= h' + least * w'
  double used;       ///< the grown points lie in K_epsilon, and so do they after moving by `slack`
  double slack;      ///< a length of the frame: K_epsilon holds the grown body swept by a ball of this radius
  double separable;  ///< a length: where O is not in K_epsilon, some unit u has h'(u) + least * w'(u) <= -separable
};

OriginGrowth growth_of(const SupportBody& body, const OriginFrame& frame, double epsilon) {
  const double error = body.relative_error();
  const double least = error / (1 - error);
  const double used = 0.4375 * epsilon;  // 7/16: between least <= epsilon / 3 and epsilon / 2
  const double width = 2 * frame.inner_radius();
  return {least, used, (0.5 * epsilon - used) * width, (0.5 * epsilon - least) * width};
}

/// One oracle call or two for a direction that may separate.
struct Probe {
  enum class Kind { separates, beyond, grown } kind;
  Point point;  ///< of the grown body, with <point, u> > 0; none where the direction separates
};

/// Asks in the unit direction u whether it separates O from K; if not, finds a point of the grown body beyond O.
Probe probe(const OriginFrame& frame, const OriginGrowth& growth, const Point& u) {
  using Kind = Probe::Kind;
  Point high = frame.support(u);
  const double reach = high.dot(u);
  if (reach + 2 * growth.least + frame.rounding() < 0) return {Kind::separates, high};  // widths are at most 2
  // A point just beyond O makes slow progress: grown ones lie beyond by a part of the width.
  if (reach > growth.used * frame.inner_radius()) return {Kind::beyond, high};
  const Point low = frame.support(-u);
  const double width = (high - low).dot(u);
  if (reach + growth.least * width + frame.rounding() < 0) return {Kind::separates, high};
  return {Kind::grown, high + growth.used * (high - low)};
}

/// GJK: the point of the simplex nearest to O, until the simplex holds O or a direction separates. @return false where
/// it came to no end within its steps or doubles no longer tell its points apart.
bool descend(const OriginFrame& frame, const OriginGrowth& growth, OriginAnswer& answer) {
  LeastNormSimplex simplex(frame.center());
  const int steps = 16 + 8 * static_cast<int>(frame.center().size());
  double norm = frame.center().norm();
  for (int step = 0; step < steps; ++step) {
    if (norm <= growth.slack) {
      answer.contains = true;
      return true;
    }
    const Point u = simplex.nearest() / -norm;
    const Probe found = probe(frame, growth, u);
    if (found.kind == Probe::Kind::separates) {
      answer.contains = false;
      answer.direction = frame.to_body(u);
      return true;
    }
    if (!simplex.add(found.point)) return false;
    const double next = simplex.nearest().norm();
    if (!(next < norm * (1 - 1e-9))) return false;
    norm = next;
  }
  return false;
}

/// The ellipsoid method on the directions: every probe that does not separate leaves the half of the directions u with
/// <point, u> < 0. Where O is not in K_epsilon, a ball of directions is never cut; so once the ellipsoid is smaller
/// than that ball, O is in K_epsilon.
void cut_directions(const OriginFrame& frame, const OriginGrowth& growth, OriginAnswer& answer) {
  const Eigen::Index size = frame.center().size();
  const double n = static_cast<double>(size);
  // h' + least * w' changes by at most this much a unit of u, and unit directions within `radius` of a separating one
  // separate.
  const double slope = frame.center().norm() + 1 + 2 * growth.least;
  const double radius = std::min(0.5, 0.5 * growth.separable / slope);
  Point u = Point::Zero(size);
  LiftedMatrix shape = LiftedMatrix::Identity(size, size) * 2.25;  // holds the unit ball grown by `radius`
  double log_volume = n * std::log(1.5);                           // of the ellipsoid over the unit ball's
  Point cut = frame.center();                                      // in K: separating directions have <centre, u> < 0
  double beyond = 0;
  while (log_volume > n * std::log(radius)) {
    const Point image = product(shape, cut);
    const double spread = std::sqrt(cut.dot(image));
    const double depth = beyond / spread;  // of the cut, in the ellipsoid's own unit
    if (!(depth < 1)) break;               // nothing is left
    const double step = (1 + n * depth) / (n + 1);
    const double shrink = n * n / (n * n - 1) * (1 - depth * depth);
    u -= image * (step / spread);
    const double flattening = 2 * step / ((1 + depth) * spread * spread);
    for (Eigen::Index k = 0; k < size; ++k) add_scaled(&shape(0, k), -flattening * image(k), image.data(), size);
    shape *= shrink;
    log_volume += 0.5 * (n * std::log(shrink) + std::log1p(-2 * step / (1 + depth)));
    ++answer.cuts;

    const double length = u.norm();
    const Probe found = probe(frame, growth, Point(u / length));
    if (found.kind == Probe::Kind::separates) {
      answer.contains = false;
      answer.direction = frame.to_body(u / length);
      return;
    }
    cut = found.point;
    beyond = cut.dot(u);
  }
  answer.contains = true;
}

/// Lemma 13 by Lemmas 14 and 15: the least value of h' + least * w' over v = (w, -1), w in [-alpha, alpha]^(N-1), where
/// the last axis points to K's centre.
void minimise_envelope(const OriginFrame& frame, const OriginGrowth& growth, OriginAnswer& answer) {
  const Eigen::Index size = frame.center().size();
  const double height = frame.center().norm();
  // h(v) >= -height + inner |v|: only |v| < height / inner can separate.
  const double alpha = height / frame.inner_radius();
  const LiftedMatrix axes = frame_along(frame.center() / height);
  const auto envelope = [&](const Point& w) {
    const Point v = product(axes, w);
    const Point high = frame.support(v);
    const double reach = high.dot(v);
    const double width = growth.least == 0 ? 0.0 : (high - frame.support(-v)).dot(v);
    const double value = reach + growth.least * width;
    if (value + frame.rounding() * v.norm() < 0) {
      answer.contains = false;
      answer.direction = frame.to_body(v);
    }
    return value;
  };
  NestedTernary search{.half_side = alpha,
                       .slope = height + 1 + 2 * growth.least,
                       .tolerance = growth.separable / std::pow(8.0, static_cast<double>(size - 1))};
  answer.contains = true;
  search.minimise(size, envelope, [&] { return !answer.contains; });
}

}  // namespace

double ternary_oracle_error(double epsilon, int dimension, double fatness) {
  return 0.25 * epsilon * fatness * fatness * std::pow(8.0, -(dimension - 1));
}

OriginAnswer locate_origin(const SupportBody& body, const OriginSettings& settings) {
  const OriginFrame frame(body);
  const OriginGrowth growth = growth_of(body, frame, settings.epsilon);
  OriginAnswer answer;
  const double distance = frame.center().norm();
  if (distance <= frame.inner_radius()) return answer;
  if (distance > 1 + frame.rounding()) {  // outside the outer ball
    answer.contains = false;
    answer.direction = frame.to_body(-frame.center());
    return answer;
  }
  if (!(2 * frame.rounding() < growth.separable)) {
    answer.decided = false;
    return answer;
  }
  if (settings.method == OriginMethod::nested_ternary) {
    minimise_envelope(frame, growth, answer);
  } else if (!descend(frame, growth, answer)) {
    cut_directions(frame, growth, answer);
  }
  answer.supports = frame.supports();
  return answer;
}

}  // namespace pd::dimension::detail
