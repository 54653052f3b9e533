#include "depth/rays/ray_shooting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "depth/difference/exact_support.hpp"
#include "numeric/unit_roundoff.hpp"

namespace pd::detail {

namespace {

/// A relative width of a shot's bracket that asks for no second line.
constexpr double kSquareEnough = 1e-9;

/// sqrt(x) as a fraction in [1, 2) and an exponent of two, so that no exponent overflows; relative error below 2^-51.
std::pair<double, int> root(const Dyadic& x) {
  int e = x.exponent() + static_cast<int>(msb(x.mantissa()));
  if (e % 2 != 0) --e;
  return {std::sqrt(x.scaled(-e).to_double()), e / 2};
}

/// Words of 64 bits between the coordinates' leading bits, rounded: sums of their products are as long.
std::int64_t spread_words(const Dyadic3& v) {
  int least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
  for (const Dyadic* x : {&v.x, &v.y, &v.z}) {
    if (x->sign() == 0) continue;
    const int top = x->exponent() + static_cast<int>(msb(boost::multiprecision::abs(x->mantissa())));
    least = std::min(least, top);
    most = std::max(most, top);
  }
  return least > most ? 0 : (static_cast<std::int64_t>(most) - least + 32) / 64;
}

}  // namespace

double ratio(const Dyadic& x, const Dyadic& y) {
  const auto top = [](const Dyadic& d) {
    return d.exponent() + static_cast<int>(msb(boost::multiprecision::abs(d.mantissa())));
  };
  if (x.sign() == 0) return 0;
  const int ex = top(x), ey = top(y);
  return std::ldexp(x.scaled(-ex).to_double() / y.scaled(-ey).to_double(), ex - ey);
}

RayShot PolytopeShooter::shoot(const Vec3& direction) {
  ++shots_;
  const std::int64_t signs = pair_->stages().exact;
  const DirectionSigns ray(*pair_, direction);
  const Portal portal = find_portal(ray, hierarchies_);
  support_calls_ += portal.support_calls;
  corners_ = portal.corners;
  const std::array<VertexPair, 3>& corner = corners_;
  const auto to = [&](std::size_t i) {
    return pair_->exact(PairVector::difference(corner[0].a, corner[0].b, corner[i].a, corner[i].b));
  };
  plane_.normal = cross(to(1), to(2));
  plane_.offset = dot(pair_->exact(PairVector::point(corner[0].a, corner[0].b)), plane_.normal);
  const Dyadic& factor = pair_->homogeneous_factor();

  if (const std::int64_t words = spread_words(plane_.normal); words > 0) {
    // A sign is the sum of some four products; of short numbers the bookkeeping costs as much as of eight words.
    const std::int64_t length = std::max<std::int64_t>(words, 8);
    spread_work_ += 4 * length * length * (pair_->stages().exact - signs);
  }

  RayShot shot;
  const double t = ratio(plane_.offset, dot(ray.exact(), plane_.normal) * factor);
  shot.lower = t * (1 - 0x1p-48);
  shot.upper = t * (1 + 0x1p-48);
  shot.normal = ExactDirection(plane_.normal).unit;
  const auto [length, exponent] = root(dot(plane_.normal, plane_.normal));
  shot.height = ratio(plane_.offset.scaled(-exponent), factor * Dyadic(length)) * (1 + 0x1p-48);
  return shot;
}

Vec3 crossing_on_a(const PosedPair& pair, const std::array<VertexPair, 3>& corners, const Vec3& direction) {
  Vec3 x[3];
  for (std::size_t i = 0; i < 3; ++i) x[i] = pair.approximate(PairVector::point(corners[i].a, corners[i].b));
  double weights[3], total = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    weights[i] = std::max(0.0, x[(i + 1) % 3].cross(x[(i + 2) % 3]).dot(direction));
    total += weights[i];
  }
  Vec3 local = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    local += (total > 0 ? weights[i] / total : 1.0 / 3) * pair.a().vertex(corners[i].a);
  }
  return pair.pose_a().apply(local);
}

SweptShooter::SweptShooter(const PosedShape& a, const PosedShape& b, std::vector<PointPair>& points,
                           double inner_radius, double relative)
    : difference_(a, b, points),
      points_(points),
      margin_a_(a.shape->margin()),
      margin_b_(b.shape->margin()),
      inner_radius_(inner_radius),
      relative_(relative),
      reach_(difference_.reach() + margin_a_ + margin_b_),
      error_(difference_.point_error() + difference_.support_error() + 8 * kUnitRoundoff * reach_) {}

SweptShooter::Corner SweptShooter::support(const Vec3& direction) {
  ++support_calls_;
  const double length = direction.norm();
  const DifferenceVertex s = difference_.support(direction, nullptr);
  PointPair points = difference_.points(s);
  points.a -= margin_a_ / length * direction;
  points.b += margin_b_ / length * direction;
  return {s.x + (margin_a_ + margin_b_) / length * direction, points};
}

/// A triangle of points of P that the line along `unit` crosses, counter-clockwise seen against it: the planar portal
/// search of the projection along the line, as in `PortalSearch`.
std::array<SweptShooter::Corner, 3> SweptShooter::enclose(const Vec3& unit) {
  std::array<Corner, 3> v;
  v[0] = support(unit.unitOrthogonal());
  const auto across = [&](const Vec3& w, double sign) {
    const Vec3 d = sign * unit.cross(w);
    return support(d.squaredNorm() > 0 ? d : unit.unitOrthogonal());
  };
  v[1] = across(v[0].x, 1);
  v[2] = across(v[0].x, -1);
  const auto side = [&](const Vec3& x, const Vec3& y) { return x.cross(y).dot(unit); };
  for (double last = -std::numeric_limits<double>::infinity(); side(v[1].x, v[2].x) < 0;) {
    const Vec3 step = v[2].x - v[1].x;
    const Corner s = across(step, -1);
    // How far the side has moved outwards; the origin lies inside by more than rounding, so that it ends.
    const double moved = side(v[1].x, v[2].x) / step.norm();
    if (!(moved > last)) break;
    last = moved;
    (side(v[0].x, s.x) > 0 ? v[1] : v[2]) = s;
  }
  if ((v[1].x - v[0].x).cross(v[2].x - v[0].x).dot(unit) < 0) std::swap(v[1], v[2]);
  return v;
}

RayShot SweptShooter::shoot(const Vec3& direction) {
  ++shots_;
  points_.clear();
  const double length = direction.norm();
  const Vec3 unit = direction / length;
  RayShot shot;
  shot.upper = std::numeric_limits<double>::infinity();
  shot.height = std::numeric_limits<double>::infinity();
  push_portal(unit, unit, shot);
  // A line in a plane of symmetry may meet triangles edge-on only, which doubles cannot push. A line beside it meets
  // them squarely, and what that costs is counted.
  constexpr double kTilts[] = {0x1p-40, 0x1p-32, 0x1p-24};
  const Vec3 across = unit.unitOrthogonal();
  const Vec3 beside = 0.8 * across + 0.6 * unit.cross(across);
  for (const double tilt : kTilts) {
    if (shot.upper <= (1 + std::max(relative_, kSquareEnough)) * shot.lower) break;
    if (shot.upper - shot.lower <= absolute_error()) break;
    for (const double sense : {tilt, -tilt}) push_portal(unit, (unit + sense * beside).normalized(), shot);
  }
  shot.lower = std::max(shot.lower, inner_radius_ * (1 - 0x1p-48)) / length * (1 - 0x1p-50);
  shot.upper = shot.upper / length * (1 + 0x1p-50);
  return shot;
}

void SweptShooter::push_portal(const Vec3& unit, const Vec3& line, RayShot& shot) {
  std::array<Corner, 3> v = enclose(line);
  const auto side = [&](const Vec3& x, const Vec3& y) { return x.cross(y).dot(line); };
  // The crossing moves outwards at every step; where rounding holds it back for so long, it has come to its end.
  constexpr int kStalled = 32;
  for (int stalled = 0; stalled < kStalled; ++stalled) {
    const Vec3 n = (v[1].x - v[0].x).cross(v[2].x - v[0].x);
    const double size = n.norm();
    const double slope = n.dot(line) / size;
    if (!(slope > 0)) break;  // the triangle has shrunk to rounding
    const Vec3 normal = n / size;
    const double level = std::max({v[0].x.dot(normal), v[1].x.dot(normal), v[2].x.dot(normal)});
    const Crossing crossing = cross_triangle(v, line);
    // A convex combination of points within error_ of P, however flat their triangle; the ray passes it by `aside`.
    // What is within e of P is inside after a shrinking by r / (r + e) about the origin, r the inner radius.
    const Vec3 x = crossing.on_b - crossing.on_a;
    const double along = x.dot(unit);
    const double aside = (x - along * unit).norm();
    const double inside = along * (inner_radius_ / (inner_radius_ + 4 * error_ + aside) * (1 - 0x1p-48));
    if (inside > shot.lower) {
      stalled = 0;
      shot.lower = inside;
      crossing_ = crossing;
    }
    const Corner s = support(normal);
    const double height = s.x.dot(normal) + error_, slope_of_ray = normal.dot(unit);
    if (slope_of_ray > 0 && height / slope_of_ray < shot.upper) {
      shot.upper = height / slope_of_ray * (1 + 0x1p-48);
      shot.normal = normal;
      shot.height = height * (1 + 0x1p-48);
    }
    if (shot.upper <= (1 + relative_) * shot.lower || s.x.dot(normal) - level <= 2 * error_) break;
    int replaced = -1;
    for (int i = 0; i < 3 && replaced < 0; ++i) {
      if (side(v[static_cast<std::size_t>(i)].x, s.x) <= 0 &&
          side(v[static_cast<std::size_t>((i + 1) % 3)].x, s.x) > 0) {
        replaced = (i + 2) % 3;
      }
    }
    if (replaced < 0) break;
    v[static_cast<std::size_t>(replaced)] = s;
  }
}

SweptShooter::Crossing SweptShooter::cross_triangle(const std::array<Corner, 3>& v, const Vec3& line) {
  const auto side = [&](const Vec3& x, const Vec3& y) { return x.cross(y).dot(line); };
  const auto combined = [](const double(&w)[3], const Vec3& x, const Vec3& y, const Vec3& z) {
    return Vec3((w[0] * x + w[1] * y + w[2] * z) / (w[0] + w[1] + w[2]));
  };
  double w[3] = {std::max(0.0, side(v[1].x, v[2].x)), std::max(0.0, side(v[2].x, v[0].x)),
                 std::max(0.0, side(v[0].x, v[1].x))};
  const double total = w[0] + w[1] + w[2];
  if (!(total > 0)) return {v[0].points.a, v[0].points.b};
  for (double& weight : w) weight /= total;
  // Areas of a triangle far from the origin are mostly rounding: one step of Newton's along its edges, which are not.
  const Vec3 x = combined(w, v[0].x, v[1].x, v[2].x);
  const Vec3 aside = x - x.dot(line) * line;
  const Vec3 edge_1 = v[1].x - v[0].x, edge_2 = v[2].x - v[0].x;
  const double area = side(edge_1, edge_2);
  if (area > 0) {
    const double w_1 = w[1] - side(aside, edge_2) / area, w_2 = w[2] - side(edge_1, aside) / area;
    w[0] = std::max(0.0, 1 - w_1 - w_2);
    w[1] = std::max(0.0, w_1);
    w[2] = std::max(0.0, w_2);
    if (!(w[0] + w[1] + w[2] > 0.5)) return {v[0].points.a, v[0].points.b};
  }
  return {combined(w, v[0].points.a, v[1].points.a, v[2].points.a),
          combined(w, v[0].points.b, v[1].points.b, v[2].points.b)};
}

}  // namespace pd::detail
