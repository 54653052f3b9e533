#include "oracle/grid_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "oracle/exact_sum.hpp"

namespace pd::oracle::grid {

namespace {

/// Eight numbers of 16 bits.
typedef std::int16_t Lane8 __attribute__((vector_size(16), may_alias));
constexpr int kLanes = 8;

Lane8 load(const std::int16_t* from) { return *reinterpret_cast<const Lane8*>(from); }
void store(std::int16_t* to, Lane8 value) { *reinterpret_cast<Lane8*>(to) = value; }
Lane8 all(std::int32_t value) { return Lane8{} + static_cast<std::int16_t>(value); }
Lane8 larger(Lane8 a, Lane8 b) { return a > b ? a : b; }
Lane8 smaller(Lane8 a, Lane8 b) { return a < b ? a : b; }

/// The largest and least <n, p> over points, of eight directions.
struct Range8 {
  Lane8 high;
  Lane8 low;
};
Range8 range(const std::vector<Int3>& points, Lane8 x, Lane8 y, Lane8 z) {
  Range8 r{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Lane8 value = x * all(points[i].x) + y * all(points[i].y) + z * all(points[i].z);
    r.high = i == 0 ? value : larger(r.high, value);
    r.low = i == 0 ? value : smaller(r.low, value);
  }
  return r;
}

using Long3 = std::array<std::int64_t, 3>;

std::int64_t dot(const Long3& a, const Int3& b) { return a[0] * b.x + a[1] * b.y + a[2] * b.z; }

/// The point of a face's affine hull nearest to the origin, where it lies in the face: w / weight, and the whole number
/// w . p that is the same for every p of the face.
struct Foot {
  bool inside = false;
  Long3 w{};
  std::int64_t weight = 1;
  std::int64_t level = 0;
};

Foot foot_of_point(const Int3& p) { return {true, {p.x, p.y, p.z}, 1, grid::dot(p, p)}; }

Foot foot_of_segment(const Int3& p, const Int3& q) {
  const Int3 e = q - p;
  const std::int64_t length = grid::dot(e, e);
  const std::int64_t along = -grid::dot(p, e);
  if (along < 0 || along > length) return {};
  Foot f{true, {p.x * length + along * e.x, p.y * length + along * e.y, p.z * length + along * e.z}, length, 0};
  f.level = dot(f.w, p);
  return f;
}

Foot foot_of_triangle(const Int3& p, const Int3& q, const Int3& r) {
  const Int3 n = cross(q - p, r - p);
  if (n.is_zero()) return {};
  const auto left = [&](const Int3& from, const Int3& to) {
    const Int3 c = cross(from, to);
    return std::int64_t{n.x} * c.x + std::int64_t{n.y} * c.y + std::int64_t{n.z} * c.z >= 0;
  };
  if (!left(p, q) || !left(q, r) || !left(r, p)) return {};
  const std::int64_t height = grid::dot(n, p);
  Foot f{true, {height * n.x, height * n.y, height * n.z}, grid::dot(n, n), 0};
  f.level = dot(f.w, p);
  return f;
}

/// |w|^2 is level / weight.
bool nearer(const Foot& f, const Foot& g) { return f.level * g.weight < g.level * f.weight; }

/// At most four points of P, affinely independent, and the least foot of their faces.
struct Simplex {
  std::array<Int3, 4> point;
  std::size_t size = 0;

  /// The origin lies in the tetrahedron.
  [[nodiscard]] bool holds_origin() const {
    if (size < 4) return false;
    for (std::size_t k = 0; k < 4; ++k) {
      const Int3& p = point[(k + 1) % 4];
      const Int3 n = cross(point[(k + 2) % 4] - p, point[(k + 3) % 4] - p);
      const std::int64_t apex = grid::dot(n, point[k] - p);
      const std::int64_t origin = -grid::dot(n, p);
      if ((apex > 0 && origin < 0) || (apex < 0 && origin > 0)) return false;
    }
    return true;
  }

  /// Keeps the face that holds the point nearest to the origin, and tells that point.
  Foot reduce() {
    Foot best;
    Simplex kept;
    const auto consider = [&](const Foot& f, std::initializer_list<Int3> face) {
      if (!f.inside || (best.inside && !nearer(f, best))) return;
      best = f;
      kept.size = face.size();
      std::copy(face.begin(), face.end(), kept.point.begin());
    };
    for (std::size_t i = 0; i < size; ++i) {
      consider(foot_of_point(point[i]), {point[i]});
      for (std::size_t j = 0; j < i; ++j) {
        consider(foot_of_segment(point[i], point[j]), {point[i], point[j]});
        for (std::size_t k = 0; k < j; ++k) {
          consider(foot_of_triangle(point[i], point[j], point[k]), {point[i], point[j], point[k]});
        }
      }
    }
    *this = kept;
    return best;
  }
};

}  // namespace

int compare_square(double x, const Fraction& value) {
  if (value.numerator == 0) return x > 0 ? 1 : 0;
  if (x < 0x1p-200) return -1;  // x^2 times the denominator is below 1
  // x^2 as two doubles, times the denominator, exactly.
  const auto denominator = static_cast<double>(value.denominator);
  const double c = 0x1.0000002p27 * x;
  const double high = c - (c - x);
  const double low = x - high;
  ExactSum<8> sum;
  sum.add_product(high * high, denominator);  // halves of a double: their products are doubles
  sum.add_product(2 * high * low, denominator);
  sum.add_product(low * low, denominator);
  sum.add(-static_cast<double>(value.numerator));
  return sum.sign();
}

double root_down(const Fraction& value) {
  double x = std::sqrt(static_cast<double>(value.numerator) / static_cast<double>(value.denominator));
  while (compare_square(x, value) > 0) x = std::nextafter(x, 0.0);
  for (;;) {
    const double next = std::nextafter(x, std::numeric_limits<double>::infinity());
    if (compare_square(next, value) > 0) return x;
    x = next;
  }
}

double root_up(const Fraction& value) {
  const double down = root_down(value);
  return compare_square(down, value) == 0 ? down : std::nextafter(down, std::numeric_limits<double>::infinity());
}

Judge::Judge() : lanes_() {}

void Judge::turn(const PlacedBody& placed, Turned& turned) {
  const AxisRotation& r = axis_rotations()[static_cast<std::size_t>(placed.at.rotation)];
  const auto all_of = [&](const std::vector<Int3>& from, std::vector<Int3>& to) {
    to.clear();
    for (const Int3& v : from) to.push_back(r.apply(v));
  };
  all_of(placed.body->vertices, turned.vertices);
  all_of(placed.body->directions, turned.directions);
  all_of(placed.body->normals, turned.normals);
}

void Judge::add_direction(const Int3& n) {
  const auto k = static_cast<std::size_t>(count_);
  lanes_.x[k] = static_cast<std::int16_t>(n.x);
  lanes_.y[k] = static_cast<std::int16_t>(n.y);
  lanes_.z[k] = static_cast<std::int16_t>(n.z);
  count_ += !n.is_zero();
}

void Judge::list_directions() {
  count_ = 0;
  for (const Int3& n : a_.normals) add_direction(n);
  for (const Int3& n : b_.normals) add_direction(n);
  for (const Int3& e : a_.directions) {
    for (const Int3& f : b_.directions) add_direction(cross(e, f));
  }
}

void Judge::find_extents() {
  for (int k = 0; k < count_; k += kLanes) {
    const Lane8 x = load(lanes_.x + k);
    const Lane8 y = load(lanes_.y + k);
    const Lane8 z = load(lanes_.z + k);
    const Range8 a = range(a_.vertices, x, y, z);
    const Range8 b = range(b_.vertices, x, y, z);
    const Lane8 moved = x * all(offset_.x) + y * all(offset_.y) + z * all(offset_.z);
    store(lanes_.high + k, b.high - a.low + moved);
    store(lanes_.low + k, b.low - a.high + moved);
  }
}

void Judge::decide() {
  // Both signs of a direction are candidates: h_P(n) = high and h_P(-n) = -low.
  std::int64_t best_h = 0;
  std::int64_t best_n2 = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int k = 0; k < count_; ++k) {
      const Int3 n{lanes_.x[k], lanes_.y[k], lanes_.z[k]};
      const std::int64_t n2 = grid::dot(n, n);
      const std::int64_t h = std::min<std::int64_t>(lanes_.high[k], -lanes_.low[k]);
      if (h < 0) {
        verdict_.contact = ContactClass::separated;
        return;
      }
      const std::int64_t order = best_n2 == 0 ? -1 : h * h * best_n2 - best_h * best_h * n2;
      if (pass == 0 && order < 0) {
        best_h = h;
        best_n2 = n2;
      }
      if (pass == 1 && order == 0) {
        if (lanes_.high[k] == h) verdict_.normals.push_back(n);
        if (-lanes_.low[k] == h) verdict_.normals.push_back(-n);
      }
    }
  }
  verdict_.contact = best_h > 0 ? ContactClass::overlapping : ContactClass::touching;
  verdict_.depth_squared = {best_h * best_h, best_n2};
}

void Judge::find_nearest() {
  Simplex simplex;
  simplex.point[0] = offset_ + b_.vertices[0] - a_.vertices[0];
  simplex.size = 1;
  for (;;) {
    if (simplex.holds_origin()) return;
    const Foot foot = simplex.reduce();
    if (foot.level == 0) return;
    const auto by_level = [&](const Int3& p, const Int3& q) { return dot(foot.w, p) < dot(foot.w, q); };
    const Int3 a = *std::max_element(a_.vertices.begin(), a_.vertices.end(), by_level);
    const Int3 b = *std::min_element(b_.vertices.begin(), b_.vertices.end(), by_level);
    const Int3 p = offset_ + b - a;
    if (dot(foot.w, p) >= foot.level) {  // P lies beyond the plane through w across w
      verdict_.nearest = foot.w;
      verdict_.distance_squared = {foot.level, foot.weight};
      return;
    }
    // Off the affine hull of what is kept, since every point of that has the level.
    simplex.point[simplex.size++] = p;
  }
}

void Judge::find_extent() {
  verdict_.extent = 0;
  const auto span_of = [&](auto coordinate) {
    const auto by = [&](const Int3& p, const Int3& q) { return coordinate(p) < coordinate(q); };
    const auto [a_low, a_high] = std::minmax_element(a_.vertices.begin(), a_.vertices.end(), by);
    const auto [b_low, b_high] = std::minmax_element(b_.vertices.begin(), b_.vertices.end(), by);
    const int high = coordinate(offset_) + coordinate(*b_high) - coordinate(*a_low);
    const int low = coordinate(offset_) + coordinate(*b_low) - coordinate(*a_high);
    verdict_.extent = std::max({verdict_.extent, std::abs(high), std::abs(low)});
  };
  span_of([](const Int3& p) { return p.x; });
  span_of([](const Int3& p) { return p.y; });
  span_of([](const Int3& p) { return p.z; });
}

const Verdict& Judge::judge(const PlacedBody& a, const PlacedBody& b) {
  turn(a, a_);
  turn(b, b_);
  std::array<std::int32_t, 3> offset{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t d = b.at.translation[k] - a.at.translation[k];
    if (std::abs(d) > kMostOffset) throw std::invalid_argument("the bodies are too far apart for 16 bits");
    offset[k] = static_cast<std::int32_t>(d);
  }
  offset_ = {offset[0], offset[1], offset[2]};
  verdict_.normals.clear();
  verdict_.depth_squared = {};
  verdict_.distance_squared = {};
  verdict_.nearest = {};
  find_extent();
  list_directions();
  find_extents();
  // A flat P has no width across its plane, which is that of a polygon or of two edges; a segment has no plane listed.
  verdict_.flat_difference = count_ == 0;
  for (int k = 0; k < count_; ++k) verdict_.flat_difference |= lanes_.high[k] == lanes_.low[k];
  if (verdict_.flat_difference) {
    find_nearest();
    verdict_.contact = verdict_.distance_squared.numerator == 0 ? ContactClass::touching : ContactClass::separated;
    return verdict_;
  }
  decide();
  if (verdict_.contact == ContactClass::separated) {
    find_nearest();
    if (verdict_.distance_squared.numerator == 0) throw std::logic_error("apart by a plane, yet the origin lies in P");
  }
  return verdict_;
}

bool Judge::separates(const Vec3& t) const {
  // Times 2^500, so that no product underflows.
  const Vec3 scaled = t * 0x1p500;
  const auto beyond = [&](const Int3& n, std::int32_t h) {
    ExactSum<8> sum;
    sum.add_product(scaled.x(), n.x);
    sum.add_product(scaled.y(), n.y);
    sum.add_product(scaled.z(), n.z);
    sum.add(-std::ldexp(h, 500));
    return sum.sign() >= 0;
  };
  // The likely ones first: those are exact ties but for the rounding of t.
  for (const bool likely : {true, false}) {
    for (int k = 0; k < count_; ++k) {
      const Int3 n{lanes_.x[k], lanes_.y[k], lanes_.z[k]};
      for (const int sign : {1, -1}) {
        const std::int32_t h = sign > 0 ? lanes_.high[k] : -lanes_.low[k];
        const Int3 m = sign > 0 ? n : -n;
        const double rounded = m.to_vec3().dot(t) - h;
        if ((rounded > -1e-6) == likely && beyond(m, h)) return true;
      }
    }
  }
  return false;
}

double Judge::clearance(const Vec3& t) const {
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < count_; ++k) {
    const Vec3 n(lanes_.x[k], lanes_.y[k], lanes_.z[k]);
    most = std::max(most, std::max(n.dot(t) - lanes_.high[k], lanes_.low[k] - n.dot(t)) / n.norm());
  }
  return most;
}

double Judge::support(const Vec3& n) const {
  const auto lower = [&](const Int3& p, const Int3& q) { return n.dot(p.to_vec3()) < n.dot(q.to_vec3()); };
  const Int3& b = *std::max_element(b_.vertices.begin(), b_.vertices.end(), lower);
  const Int3& a = *std::min_element(a_.vertices.begin(), a_.vertices.end(), lower);
  return n.dot((offset_ + b - a).to_vec3());
}

}  // namespace pd::oracle::grid
