#include "pd/shape/halfspaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "numeric/at.hpp"
#include "numeric/estimate.hpp"
#include "numeric/quotient.hpp"

namespace pd {

namespace {

using detail::at;
using detail::Dyadic;
using detail::Estimate;

constexpr std::size_t kMostPlanes = 1 << 13;
constexpr double kLargest = 1e100;
/// What reaches farther than this times the largest distance of a plane from the origin is called unbounded.
constexpr double kBound = 0x1p46;

std::optional<Error> check(std::span<const Halfspace3> planes) {
  if (planes.size() < 4) {
    return Error{ErrorCode::too_few_points,
                 "a bounded solid needs 4 halfspaces at least, here are " + std::to_string(planes.size()), "planes"};
  }
  if (planes.size() > kMostPlanes) {
    return Error{ErrorCode::limit_exceeded, "at most " + std::to_string(kMostPlanes) + " halfspaces", "planes"};
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string where = "planes[" + std::to_string(i) + "]";
    const double largest = planes[i].normal.cwiseAbs().maxCoeff();
    if (!planes[i].normal.allFinite() || !std::isfinite(planes[i].offset)) {
      return Error{ErrorCode::non_finite, "a halfspace needs finite numbers", where};
    }
    if (largest == 0) return Error{ErrorCode::zero_direction, "a halfspace needs a normal that is not zero", where};
    if (largest > kLargest || largest < 1 / kLargest || std::abs(planes[i].offset) > kLargest ||
        (planes[i].offset != 0 && std::abs(planes[i].offset) < 1 / kLargest)) {
      return Error{ErrorCode::out_of_range, "normals and offsets lie between 1e-100 and 1e100, offsets may be 0",
                   where};
    }
  }
  return std::nullopt;
}

template <class N>
struct Vector {
  N x, y, z;
};
template <class N>
Vector<N> normal(const Halfspace3& h) {
  return {N(h.normal.x()), N(h.normal.y()), N(h.normal.z())};
}
template <class N>
Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class N>
N dot(const Vector<N>& a, const Vector<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The common point of three planes as (x / w, y / w, z / w), by Cramer's rule.
template <class N>
struct Meeting {
  Vector<N> x;
  N w;
};
template <class N>
Meeting<N> meeting(const Halfspace3& a, const Halfspace3& b, const Halfspace3& c) {
  const Vector<N> na = normal<N>(a), nb = normal<N>(b), nc = normal<N>(c);
  const Vector<N> bc = cross(nb, nc), ca = cross(nc, na), ab = cross(na, nb);
  const N oa(a.offset), ob(b.offset), oc(c.offset);
  return {{oa * bc.x + ob * ca.x + oc * ab.x, oa * bc.y + ob * ca.y + oc * ab.y, oa * bc.z + ob * ca.z + oc * ab.z},
          dot(na, bc)};
}

/// The body's facets, one plane after the other: a polygon in the plane whose edges are other planes, cut by all.
class FacetCutter {
 public:
  /// The last six planes are those of a box round everything.
  FacetCutter(std::vector<Halfspace3> planes, int first_of_box) : planes_(std::move(planes)), box_(first_of_box) {}

  struct Corner {
    std::array<int, 3> planes;
  };

  /// Appends the corners of the facet in plane i. @return whether the facet has an area.
  bool cut(int i, std::vector<Corner>& corners) {
    own_ = i;
    start();
    for (int l = 0; l < box_ && !edges_.empty(); ++l) {
      if (l != i) clip(l);
    }
    for (int k = 0; k < static_cast<int>(edges_.size()); ++k) corners.push_back({{own_, before(k), edges_[at(k)]}});
    return !edges_.empty();
  }
  [[nodiscard]] bool reaches_box(const Corner& c) const {
    return std::any_of(c.planes.begin(), c.planes.end(), [&](int p) { return p >= box_; });
  }
  [[nodiscard]] Vec3 rounded(const Corner& c) const {
    const auto m = meeting<Dyadic>(planes_[at(c.planes[0])], planes_[at(c.planes[1])], planes_[at(c.planes[2])]);
    return {detail::quotient(m.x.x, m.w), detail::quotient(m.x.y, m.w), detail::quotient(m.x.z, m.w)};
  }

 private:
  [[nodiscard]] int before(int k) const { return edges_[at(k == 0 ? static_cast<int>(edges_.size()) - 1 : k - 1)]; }

  /// The plane's cut with the box: the four of its planes that stand most across, in turn.
  void start() {
    const Vec3 n = planes_[at(own_)].normal;
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    edges_ = {box_ + 2 * a, box_ + 2 * b, box_ + 2 * a + 1, box_ + 2 * b + 1};
    places_.clear();
    for (int k = 0; k < 4; ++k) places_.push_back(place(k));
  }

  /// Corner k in doubles with a bound of its error along each axis; an infinite one where doubles lose it.
  struct Place {
    Vec3 x;
    double error;
  };
  [[nodiscard]] Place place(int k) const {
    const auto m = meeting<Estimate>(planes_[at(own_)], planes_[at(before(k))], planes_[at(edges_[at(k)])]);
    const double w = std::abs(m.w.value) - m.w.error;
    Place r{Vec3::Zero(), std::numeric_limits<double>::infinity()};
    if (!(w > 0)) return r;
    r.x = Vec3(m.x.x.value, m.x.y.value, m.x.z.value) / m.w.value;
    const double wide = std::max({m.x.x.error, m.x.y.error, m.x.z.error});
    r.error = (wide + r.x.cwiseAbs().maxCoeff() * m.w.error) / w * 1.01 + 0x1p-51 * r.x.cwiseAbs().maxCoeff();
    if (!std::isfinite(r.error)) r.error = std::numeric_limits<double>::infinity();
    return r;
  }

  /// -1: corner k lies inside halfspace l, 0 on its plane, 1 outside.
  [[nodiscard]] int side(int k, int l) const {
    const Halfspace3& h = planes_[at(l)];
    const Place& p = places_[at(k)];
    const double weight = h.normal.cwiseAbs().sum();
    const double value = h.normal.dot(p.x) - h.offset;
    const double air = weight * p.error + 0x1p-49 * (weight * p.x.cwiseAbs().maxCoeff() + std::abs(h.offset));
    if (value < -air) return -1;
    if (value > air) return 1;
    const auto evaluate = [&]<class N>() {
      const auto m = meeting<N>(planes_[at(own_)], planes_[at(before(k))], planes_[at(edges_[at(k)])]);
      return std::array<N, 2>{dot(normal<N>(h), m.x) - N(h.offset) * m.w, m.w};
    };
    return detail::exact_sign([&]<class N>() { return evaluate.template operator()<N>()[0]; }) *
           detail::exact_sign([&]<class N>() { return evaluate.template operator()<N>()[1]; });
  }

  void clip(int l) {
    const int n = static_cast<int>(edges_.size());
    sides_.clear();
    bool out = false, in = false;
    for (int k = 0; k < n; ++k) {
      sides_.push_back(side(k, l));
      out = out || sides_.back() > 0;
      in = in || sides_.back() < 0;
    }
    if (!out) return;
    kept_.clear();
    bool cut = false;
    for (int k = 0; in && k < n; ++k) {
      const int next = (k + 1) % n;
      // Edge k runs from corner k to the next one; the part of it inside has a length where an end is inside.
      if (sides_[at(k)] < 0 || sides_[at(next)] < 0) {
        kept_.push_back(edges_[at(k)]);
        if (sides_[at(next)] >= 0 && !cut) {
          kept_.push_back(l);
          cut = true;
        }
      }
    }
    std::swap(edges_, kept_);
    places_.clear();
    for (int k = 0; k < static_cast<int>(edges_.size()); ++k) places_.push_back(place(k));
  }

  std::vector<Halfspace3> planes_;
  int box_;
  int own_ = 0;
  std::vector<int> edges_, kept_;  ///< counter-clockwise or clockwise; corner k is where edge k begins
  std::vector<Place> places_;
  std::vector<int> sides_;
};

/// Each by a power of two, so that its largest component lies in [1, 2): exact, and signs of degree 4 stay in range.
std::vector<Halfspace3> scaled(std::span<const Halfspace3> planes, double& reach) {
  std::vector<Halfspace3> r(planes.begin(), planes.end());
  reach = 0;
  for (Halfspace3& h : r) {
    const int exponent = std::ilogb(h.normal.cwiseAbs().maxCoeff());
    for (double* x : {&h.normal.x(), &h.normal.y(), &h.normal.z(), &h.offset}) *x = std::ldexp(*x, -exponent);
    reach = std::max(reach, std::abs(h.offset));
  }
  return r;
}

bool same(const Halfspace3& a, const Halfspace3& b) { return a.normal == b.normal && a.offset == b.offset; }

Expected<ConvexPolytope> hull_of(std::vector<Vec3>& points) {
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::array{a.x(), a.y(), a.z()} < std::array{b.x(), b.y(), b.z()};
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  Expected<ConvexPolytope> hull = ConvexPolytope::from_points(points);
  if (hull && hull->affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional, "the halfspaces enclose a body without thickness; a solid is needed",
                 "planes"};
  }
  return hull;
}

}  // namespace

Expected<ConvexPolytope> polytope_of_halfspaces(std::span<const Halfspace3> given) {
  if (auto error = check(given)) return *std::move(error);
  double reach = 0;
  std::vector<Halfspace3> planes = scaled(given, reach);
  // A plane is given once; a body of planes through the origin alone is a cone or a point.
  std::vector<Halfspace3> distinct;
  std::sort(planes.begin(), planes.end(), [](const Halfspace3& a, const Halfspace3& b) {
    return std::array{a.normal.x(), a.normal.y(), a.normal.z(), a.offset} <
           std::array{b.normal.x(), b.normal.y(), b.normal.z(), b.offset};
  });
  std::unique_copy(planes.begin(), planes.end(), std::back_inserter(distinct), same);
  const int count = static_cast<int>(distinct.size());
  const double box = kBound * (reach > 0 ? reach : 1);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) distinct.push_back({sign * Vec3::Unit(axis), box});
  }
  FacetCutter cutter(std::move(distinct), count);
  std::vector<FacetCutter::Corner> corners;
  bool any = false;
  for (int i = 0; i < count; ++i) any = cutter.cut(i, corners) || any;
  if (!any) {
    return Error{ErrorCode::bad_value, "the halfspaces have no interior point in common: nothing, or less than an area",
                 "planes"};
  }
  if (std::any_of(corners.begin(), corners.end(), [&](const auto& c) { return cutter.reaches_box(c); })) {
    return Error{ErrorCode::unbounded, "the halfspaces must enclose a bounded body", "planes"};
  }
  std::vector<Vec3> points;
  for (const FacetCutter::Corner& c : corners) points.push_back(cutter.rounded(c));
  return hull_of(points);
}

}  // namespace pd
