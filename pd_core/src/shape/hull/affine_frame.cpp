#include "shape/hull/affine_frame.hpp"

#include <cmath>

namespace pd::detail {
namespace {

Vec3 scaled(const HullPoints& points, int i) { return {points[i].x, points[i].y, points[i].z}; }

/// The index that maximises `measure`, the first of equals.
template <class Measure>
int first_largest(const HullPoints& points, Measure measure) {
  int best = 0;
  double best_value = -1;
  for (int i = 0; i < points.size(); ++i) {
    const double value = measure(i);
    if (value > best_value) {
      best = i;
      best_value = value;
    }
  }
  return best;
}

/// `guess` where it is independent of the frame so far, else the first point that is, else -1.
template <class Dependent>
int first_independent(const HullPoints& points, int guess, Dependent dependent) {
  if (!dependent(guess)) return guess;
  for (int i = 0; i < points.size(); ++i) {
    if (!dependent(i)) return i;
  }
  return -1;
}

}  // namespace

AffineFrame find_affine_frame(const HullPoints& points) {
  AffineFrame frame;
  auto& [a, b, c, d] = frame.points;
  a = 0;
  b = 0;
  for (int i = 1; i < points.size(); ++i) {
    if (points.less(i, a)) a = i;
    if (!points.less(i, b) && !points.equal(i, b)) b = i;
  }
  if (points.equal(a, b)) {
    b = -1;
    return frame;
  }
  frame.dimension = 1;

  const Vec3 origin = scaled(points, a);
  const Vec3 along = scaled(points, b) - origin;
  c = first_independent(
      points, first_largest(points, [&](int i) { return along.cross(scaled(points, i) - origin).squaredNorm(); }),
      [&](int i) { return points.collinear(frame.points[0], frame.points[1], i); });
  if (c < 0) return frame;
  frame.dimension = 2;

  const Vec3 normal = along.cross(scaled(points, c) - origin);
  d = first_independent(
      points, first_largest(points, [&](int i) { return std::abs(normal.dot(scaled(points, i) - origin)); }),
      [&](int i) { return points.orient3d(frame.points[0], frame.points[1], frame.points[2], i) == 0; });
  if (d >= 0) frame.dimension = 3;
  return frame;
}

}  // namespace pd::detail
