#include "shape/posed_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/expansion.hpp"
#include "numeric/unit_roundoff.hpp"
#include "numeric/unrounded.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

/// Loss by underflow inside a scaled double or double-double evaluation; far below every rounding term that matters.
constexpr double kUnderflow = 0x1p-900;

/// The nine numerators of R(q) |q|^2.
std::array<Dyadic, 9> homogeneous_rotation(const std::array<double, 4>& q) {
  const Dyadic w(q[0]), x(q[1]), y(q[2]), z(q[3]), two(2.0);
  const Dyadic ww = w * w, xx = x * x, yy = y * y, zz = z * z;
  const Dyadic xy = x * y, xz = x * z, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
  return {ww + xx - yy - zz, two * (xy - wz), two * (xz + wy), two * (xy + wz),  ww - xx + yy - zz,
          two * (yz - wx),   two * (xz - wy), two * (yz + wx), ww - xx - yy + zz};
}

/// R's numerators, and |q|^2 or 1.
void numerators(const Pose& pose, Dyadic (&rotation)[9], Dyadic& denominator) {
  if (!pose.is_quaternion()) {
    for (int i = 0; i < 9; ++i) rotation[i] = Dyadic(pose.rotation()(i / 3, i % 3));
    denominator = Dyadic(1.0);
    return;
  }
  const std::array<Dyadic, 9> entries = homogeneous_rotation(pose.quaternion_wxyz());
  std::copy(entries.begin(), entries.end(), rotation);
  denominator = Dyadic(0.0);
  for (const double c : pose.quaternion_wxyz()) denominator = denominator + Dyadic(c) * Dyadic(c);
}

/// Largest coordinate of |R| |v| over the vertices, bounded by the box of |v|.
double reach(const ConvexPolytope& polytope, const ColumnsDD& columns, double scale) {
  const Vec3& box = polytope.max_abs_coordinates();
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int j = 0; j < 3; ++j) sum += std::abs(columns[j].hi[i]) * (box[j] * scale);
    largest = std::max(largest, sum);
  }
  return largest;
}

/// R (scale (to - from)) in doubles; an absent index stands for the local origin.
Vec3 rotate(const ConvexPolytope& p, const double (&r)[9], double scale, int to, int from) {
  if (to < 0 && from < 0) return Vec3::Zero();
  double v[3] = {0, 0, 0};
  if (to >= 0) {
    v[0] = p.x()[to];
    v[1] = p.y()[to];
    v[2] = p.z()[to];
  }
  if (from >= 0) {
    v[0] -= p.x()[from];
    v[1] -= p.y()[from];
    v[2] -= p.z()[from];
  }
  for (double& c : v) c *= scale;
  return {r[0] * v[0] + r[1] * v[1] + r[2] * v[2], r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
          r[6] * v[0] + r[7] * v[1] + r[8] * v[2]};
}

/// Q (to - from). False where a coordinate is too large or small.
bool difference_of(const ConvexPolytope& p, const AxisExchange& exchange, int to, int from, DifferenceVector& out) {
  const double* const coordinates[3] = {p.x(), p.y(), p.z()};
  Expansion<2>* const turned[3] = {&out.x, &out.y, &out.z};
  for (std::size_t k = 0; k < 3; ++k) {
    const double* const x = coordinates[exchange.axis[k]];
    double t = to >= 0 ? x[to] : 0, f = from >= 0 ? x[from] : 0;
    if (!fits_expansions(t) || !fits_expansions(f)) return false;
    if (exchange.sign[k] < 0) std::swap(t, f);
    *turned[k] = difference(t, f);
  }
  return true;
}

/// Adds sign R (to - from), or sign (to - from) without a rotation. Each coordinate of the difference must be exact.
bool add_rotated(const ConvexPolytope& p, const double* r, double sign, int to, int from, UnroundedSum (&sums)[3]) {
  if (to < 0 && from < 0) return true;
  const double* const coordinates[3] = {p.x(), p.y(), p.z()};
  for (int j = 0; j < 3; ++j) {
    const DoubleDouble d = two_sum(to >= 0 ? coordinates[j][to] : 0, from >= 0 ? -coordinates[j][from] : 0);
    if (d.lo != 0) return false;
    if (r == nullptr) {
      sums[j].add(sign * d.hi);
    } else {
      for (int i = 0; i < 3; ++i) sums[i].add_product(r[3 * i + j], sign * d.hi);
    }
  }
  return true;
}

/// Adds coordinate k of sign R (to - from), whose columns are doubles. False where the sum needs more than
/// double-double.
bool add_coordinate(const ConvexPolytope& p, const ColumnsDD& r, int k, double sign, int to, int from,
                    DoubleDouble& sum) {
  constexpr double kLeastProduct = 0x1p-900;  // below it the error of a product may be lost
  const double* const coordinates[3] = {p.x(), p.y(), p.z()};
  const auto add_product = [&](double entry, double x) {
    if (std::abs(entry) == 1) return add_exactly(sum, entry * x);
    const DoubleDouble product = two_product(entry, x);
    return (x == 0 || std::abs(product.hi) > kLeastProduct) && add_exactly(sum, product.hi) &&
           add_exactly(sum, product.lo);
  };
  for (int j = 0; j < 3; ++j) {
    const double entry = sign * r[j].hi[k];
    if (entry == 0) continue;
    if (to >= 0 && !add_product(entry, coordinates[j][to])) return false;
    if (from >= 0 && !add_product(-entry, coordinates[j][from])) return false;
  }
  return true;
}

/// Rows of R that pass one coordinate on, or its opposite: of a matrix as they stand; of a quaternion those whose other
/// two entries vanish, whatever the third rounds to. @return whether all do.
bool find_own_coordinates(const ConvexPolytope& p, const Pose& pose, std::uint32_t zeros, const double (&r)[9],
                          PosedPair::OwnCoordinate (&own)[3]) {
  if (zeros == 0) return false;
  const double* const coordinates[3] = {p.x(), p.y(), p.z()};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      const std::uint32_t others = (7u & ~(1u << j)) << (3 * k);
      if ((zeros & others) != others || !(pose.is_quaternion() || std::abs(r[3 * k + j]) == 1)) continue;
      own[k] = {coordinates[j], r[3 * k + j] > 0 ? 1.0 : -1.0, j};
    }
  }
  return own[0].x != nullptr && own[1].x != nullptr && own[2].x != nullptr;
}

/// Adds sign (x[to] - x[from]). False where the sum needs more than double-double.
bool add_own_coordinate(const double* x, double sign, int to, int from, DoubleDouble& sum) {
  return (to < 0 || add_exactly(sum, sign * x[to])) && (from < 0 || add_exactly(sum, -sign * x[from]));
}

Dyadic3 rotate(const ConvexPolytope& p, const Dyadic (&r)[9], int to, int from) {
  if (to < 0 && from < 0) return {};
  const Vec3 zero = Vec3::Zero();
  const Dyadic3 v = to_dyadic(to >= 0 ? p.vertex(to) : zero) - to_dyadic(from >= 0 ? p.vertex(from) : zero);
  return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
          r[6] * v.x + r[7] * v.y + r[8] * v.z};
}

}  // namespace

PosedPair::PosedPair(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b,
                     const Vec3& origin)
    : a_(&a), b_(&b), pose_a_(&pose_a), pose_b_(&pose_b), origin_(origin) {
  const Vec3 offset = pose_b.translation() - pose_a.translation();
  const double largest = std::max({a.max_abs_coordinate(), b.max_abs_coordinate(), offset.cwiseAbs().maxCoeff(),
                                   origin.cwiseAbs().maxCoeff(), 0x1p-1000});
  // Rescale only where a product of three lengths could leave the range of doubles: within it scaling changes no bit.
  if (largest > 0x1p100 || largest < 0x1p-100) {
    scale_exponent_ = std::ilogb(largest);
    scale_ = std::ldexp(1.0, -scale_exponent_);
    outwards_ = std::ldexp(1.0, scale_exponent_);
  }
  const double scale = scale_;

  rotations_in_double_double(pose_a, pose_b, body_a_.columns, body_b_.columns);
  for (int i = 0; i < 9; ++i) {
    body_a_.rotation[i] = to_double(body_a_.columns[i % 3][i / 3]);
    body_b_.rotation[i] = to_double(body_b_.columns[i % 3][i / 3]);
  }
  double offset_size = 0;
  double offset_scaled[3];
  DoubleDouble offset_exact[3];
  for (int i = 0; i < 3; ++i) {
    offset_exact[i] = two_sum(pose_b.translation()[i] * scale, -(pose_a.translation()[i] * scale));
    offset_size = std::max(offset_size, std::abs(offset_exact[i].hi) + std::abs(origin[i] * scale));
    offset_exact[i] = offset_exact[i] - DoubleDouble{origin[i] * scale, 0};
    offset_scaled[i] = offset_exact[i].hi;
    offset_dd_.set(i, offset_exact[i]);
  }
  offset_dd_.set(3, {});
  offset_ = Vec3(offset_scaled[0], offset_scaled[1], offset_scaled[2]);
  exchange_ = relative_exchange(pose_a, pose_b);
  zeros_a_ = zero_entries(pose_a);
  zeros_b_ = same_rotation() ? zeros_a_ : zero_entries(pose_b);
  doubles_rotate_ = scale_exponent_ == 0 && origin.isZero(0) && stored_in_doubles(pose_a, body_a_.columns) &&
                    stored_in_doubles(pose_b, body_b_.columns) && offset_exact[0].lo == 0 && offset_exact[1].lo == 0 &&
                    offset_exact[2].lo == 0;

  if (scale_exponent_ == 0 && origin.isZero(0)) {
    const bool all_a = find_own_coordinates(a, pose_a, zeros_a_, body_a_.rotation, own_a_);
    const bool all_b = find_own_coordinates(b, pose_b, zeros_b_, body_b_.rotation, own_b_);
    all_own_coordinates_ = doubles_rotate_ && all_a && all_b;
  }
  if (exchange_) {
    zeros_a_ = zero_entries(AxisExchange{});
    zeros_b_ = zero_entries(*exchange_);
    if (!exchange_->is_identity()) std::ranges::copy(exchange_->matrix(), exchange_matrix_);
  }

  // Each body's term: difference, rotation entry, product and two sums of a vector of at most twice the reach: 5u; then
  // two sums of at most the total. The double-double count is the same with 2^-104 (its basic operations err by <
  // 5u^2). Largest error / bound that `bound_ratios` found: 0.237 in doubles, 0.006 in double-double.
  const auto error_of_size = [](double size) {
    return VectorError{8 * kUnitRoundoff * size + kUnderflow, 32 * 0x1p-103 * size + kUnderflow};
  };
  const double size_a = 2 * reach(a, body_a_.columns, scale), size_b = 2 * reach(b, body_b_.columns, scale);
  body_a_.error = error_of_size(size_a);
  body_b_.error = error_of_size(size_b);
  const VectorError error = error_of_size(size_a + size_b + offset_size);
  vector_error_ = error.rounded;
  vector_error_dd_ = error.fine;
}

Vec3 PosedPair::approximate(const PairVector& v) const {
  Vec3 r =
      rotate(*b_, body_b_.rotation, scale_, v.b_to, v.b_from) - rotate(*a_, body_a_.rotation, scale_, v.a_to, v.a_from);
  if (v.translated) r += offset_;
  return r;
}

TurnedSum PosedPair::turned(const PairVector& v) const {
  return {LocalVector(*b_, body_b_.columns, scale_, v.b_to, v.b_from),
          LocalVector(*a_, body_a_.columns, -scale_, v.a_to, v.a_from), v.translated ? &offset_dd_ : nullptr};
}

void PosedPair::approximate_dd(const PairVector& v, FourDoubleDoubles& out) const {
  // A vertex alone: no step below would round. A sum of zeros is +0, as theirs.
  if (all_own_coordinates_ && !v.translated && v.a_from < 0 && v.b_from < 0 && (v.a_to < 0) != (v.b_to < 0)) {
    const bool of_b = v.b_to >= 0;
    const OwnCoordinate(&own)[3] = of_b ? own_b_ : own_a_;
    const int vertex = of_b ? v.b_to : v.a_to;
    for (int k = 0; k < 3; ++k) out.set(k, {(of_b ? own[k].sign : -own[k].sign) * own[k].x[vertex] + 0.0, 0});
    out.set(3, {});
    return;
  }
  const TurnedSum sum = turned(v);
  with_products([&](auto products) __attribute__((always_inline)) {
    DoubleDoubleLanesBy<decltype(products)> lanes;
    add_up(lanes, sum);
    store(out, lanes);
  });
}

Vec3DD PosedPair::in_frame_of_a(const Vec3DD& x) const { return turned_back(body_a_.columns, x); }
Vec3DD PosedPair::in_frame_of_b(const Vec3DD& x) const { return turned_back(body_b_.columns, x); }

const PosedPair::ExactPlacing& PosedPair::exact_placing() const {
  if (exact_) return *exact_;
  ExactPlacing& made = exact_.emplace();
  Dyadic denominator_a, denominator_b;
  numerators(*pose_a_, made.rotation_a, denominator_a);
  numerators(*pose_b_, made.rotation_b, denominator_b);
  made.homogeneous_factor = denominator_a * denominator_b;
  // Bring both bodies to the common denominator once.
  for (int i = 0; i < 9; ++i) {
    made.rotation_a[i] = made.rotation_a[i] * denominator_b;
    made.rotation_b[i] = made.rotation_b[i] * denominator_a;
  }
  made.offset = (to_dyadic(pose_b_->translation()) - to_dyadic(pose_a_->translation()) - to_dyadic(origin_)) *
                made.homogeneous_factor;
  return made;
}

const Dyadic& PosedPair::homogeneous_factor() const { return exact_placing().homogeneous_factor; }

bool PosedPair::unrounded(const PairVector& v, const double* turn_a, const double* turn_b, Vec3& out) const {
  UnroundedSum sums[3];
  if (!add_rotated(*b_, turn_b, 1, v.b_to, v.b_from, sums) || !add_rotated(*a_, turn_a, -1, v.a_to, v.a_from, sums)) {
    return false;
  }
  for (int i = 0; i < 3; ++i) {
    if (v.translated) sums[i].add(offset_[i]);
    if (!sums[i].exact()) return false;
    out[i] = sums[i].value();
  }
  return true;
}

bool PosedPair::exact_coordinate(const PairVector& v, int k, DoubleDouble& out) const {
  out = v.translated ? offset_dd_[k] : DoubleDouble{};
  if (has_own_coordinate(k)) {
    const OwnCoordinate &of_a = own_a_[k], &of_b = own_b_[k];
    return add_own_coordinate(of_b.x, of_b.sign, v.b_to, v.b_from, out) &&
           add_own_coordinate(of_a.x, -of_a.sign, v.a_to, v.a_from, out);
  }
  return doubles_rotate_ && add_coordinate(*b_, body_b_.columns, k, 1, v.b_to, v.b_from, out) &&
         add_coordinate(*a_, body_a_.columns, k, -1, v.a_to, v.a_from, out);
}

std::uint32_t PosedPair::zero_coordinates(const PairVector& v) const {
  if (v.translated) return 0;
  return detail::zero_coordinates(*a_, zeros_a_, v.a_from, v.a_to) &
         detail::zero_coordinates(*b_, zeros_b_, v.b_from, v.b_to);
}

template <int N>
bool PosedPair::unrounded(const PairVector* const (&vectors)[N], Vec3 (&out)[N]) const {
  // Signs of products of vectors that turn together do not see the turn.
  bool shifted = false, of_a = false, of_b = false;
  for (const PairVector* const v : vectors) {
    shifted = shifted || v->translated;
    of_a = of_a || v->a_to >= 0 || v->a_from >= 0;
    of_b = of_b || v->b_to >= 0 || v->b_from >= 0;
  }
  const bool one_frame = !shifted && (exchange_ || !of_a || !of_b);
  if (!one_frame && !doubles_rotate_) return false;
  const double* const turn_a = one_frame ? nullptr : body_a_.rotation;
  const double* const turn_b = !one_frame ? body_b_.rotation : of_a ? turn_into_frame_of_a() : nullptr;
  for (int i = 0; i < N; ++i) {
    if (!unrounded(*vectors[i], turn_a, turn_b, out[i])) return false;
  }
  return true;
}

Dyadic3 PosedPair::exact(const PairVector& v) const {
  const ExactPlacing& placing = exact_placing();
  Vec3 whole;
  if (doubles_rotate_ && unrounded(v, body_a_.rotation, body_b_.rotation, whole)) {
    const Dyadic3 x = to_dyadic(whole);
    return pose_a_->is_quaternion() || pose_b_->is_quaternion() ? x * placing.homogeneous_factor : x;
  }
  Dyadic3 r = rotate(*b_, placing.rotation_b, v.b_to, v.b_from) - rotate(*a_, placing.rotation_a, v.a_to, v.a_from);
  if (v.translated) r = r + placing.offset;
  std::int64_t words = 0;
  for (const Dyadic* x : {&r.x, &r.y, &r.z}) words = std::max<std::int64_t>(words, x->mantissa().backend().size());
  exact_work_ += words * words;
  return r;
}

namespace {

/// Error of det(u, v, w) when each coordinate of the three errs by its `e` and the evaluation by `relative` of the
/// permanent, which is at most the product of the 1-norms. Multilinear, so telescoping over the three arguments bounds
/// it.
double determinant_error(double u, double v, double w, double eu, double ev, double ew, double relative) {
  u += 3 * eu;
  v += 3 * ev;
  w += 3 * ew;
  return (relative * u * v * w + (eu * v * w + ev * u * w + ew * u * v)) * (1 + 16 * kUnitRoundoff) + kUnderflow;
}

double norm1(const Vec3& v) { return std::abs(v.x()) + std::abs(v.y()) + std::abs(v.z()); }
Vec3 high(const Vec3DD& v) { return {v.x.hi, v.y.hi, v.z.hi}; }
int sign(double x) { return (x > 0) - (x < 0); }

}  // namespace

int PosedPair::sign_determinant(const PairVector& u, const PairVector& v, const PairVector& w) const {
  const std::optional<int> rounded = sign_determinant_rounded(u, v, w);
  return rounded ? *rounded : determinant(exact(u), exact(v), exact(w)).sign();
}

std::optional<int> PosedPair::sign_determinant_rounded(const PairVector& u, const PairVector& v,
                                                       const PairVector& w) const {
  const VectorError eu = error_of(u), ev = error_of(v), ew = error_of(w);
  {
    const Vec3 x = approximate(u), y = approximate(v), z = approximate(w);
    const double value = x.dot(y.cross(z));
    if (std::abs(value) >
        determinant_error(norm1(x), norm1(y), norm1(z), eu.rounded, ev.rounded, ew.rounded, 8 * kUnitRoundoff)) {
      ++stages_.filtered;
      return sign(value);
    }
  }
  if (vanishes_term_by_term(u, v, w)) {
    ++stages_.exact;
    return 0;
  }
  Vec3 whole[3];
  if (unrounded<3>({&u, &v, &w}, whole) && orient3d(Vec3::Zero(), whole[1], whole[2], whole[0]) == 0) {
    ++stages_.exact;  // double-double could not have told
    return 0;
  }
  {
    const Vec3DD x = approximate_dd(u), y = approximate_dd(v), z = approximate_dd(w);
    const double value = dot(x, cross(y, z)).hi;
    if (std::abs(value) >
        determinant_error(norm1(high(x)), norm1(high(y)), norm1(high(z)), eu.fine, ev.fine, ew.fine, 32 * 0x1p-104)) {
      ++stages_.double_double;
      return sign(value);
    }
  }
  ++stages_.exact;
  const std::optional<int> told = sign_by_differences({&u, &v, &w});
  return told ? told : sign_in_one_frame({&u, &v, &w});
}

std::optional<int> PosedPair::sign_in_one_frame(const PairVector* const (&vectors)[3]) const {
  bool of_a = false, of_b = false;
  for (const PairVector* const v : vectors) {
    if (v->translated) return std::nullopt;
    of_a = of_a || v->a_to >= 0 || v->a_from >= 0;
    of_b = of_b || v->b_to >= 0 || v->b_from >= 0;
  }
  if (of_a && of_b && !exchange_) return std::nullopt;
  const auto place = [&](const ConvexPolytope& p, int v) {
    return to_dyadic(v >= 0 ? p.vertex(v) : Vec3(Vec3::Zero()));
  };
  const AxisExchange exchange = of_a && of_b ? *exchange_ : AxisExchange{};
  const auto place_b = [&](int v) { return to_dyadic(v >= 0 ? exchange.of(b_->vertex(v)) : Vec3(Vec3::Zero())); };
  Dyadic3 whole[3];
  for (int i = 0; i < 3; ++i) {
    const PairVector& v = *vectors[i];
    whole[i] = (place_b(v.b_to) - place_b(v.b_from)) - (place(*a_, v.a_to) - place(*a_, v.a_from));
    std::int64_t words = 0;
    for (const Dyadic* x : {&whole[i].x, &whole[i].y, &whole[i].z}) {
      words = std::max<std::int64_t>(words, x->mantissa().backend().size());
    }
    exact_work_ += words * words;
  }
  const int sign = determinant(whole[0], whole[1], whole[2]).sign();
  // A matrix that is taken as it stands may turn the order of three vectors.
  const bool turned = of_a ? pose_a_->is_quaternion() : pose_b_->is_quaternion();
  return sign == 0 || turned ? std::optional(sign) : std::nullopt;
}

std::optional<int> PosedPair::sign_by_differences(const PairVector* const (&vectors)[3]) const {
  bool of_a = false, of_b = false;
  for (const PairVector* const v : vectors) {
    const bool has_a = v->a_to >= 0 || v->a_from >= 0, has_b = v->b_to >= 0 || v->b_from >= 0;
    if (v->translated || has_a == has_b) return std::nullopt;
    of_a = of_a || has_a;
    of_b = of_b || has_b;
  }
  const bool one_frame = exchange_ || !of_a || !of_b;
  AxisExchange exchange_a, exchange_b;
  if (!one_frame) {
    if (!exchanges_axes(*pose_a_, body_a_.columns) || !exchanges_axes(*pose_b_, body_b_.columns)) return std::nullopt;
    exchange_a = exchange_of(body_a_.columns);
    exchange_b = exchange_of(body_b_.columns);
  } else if (of_a && of_b) {
    exchange_b = *exchange_;
  }
  DifferenceVector differences[3];
  for (int i = 0; i < 3; ++i) {
    const PairVector& v = *vectors[i];
    const bool is_b = v.b_to >= 0 || v.b_from >= 0;
    if (!(is_b ? difference_of(*b_, exchange_b, v.b_to, v.b_from, differences[i])
               : difference_of(*a_, exchange_a, v.a_from, v.a_to, differences[i]))) {
      return std::nullopt;
    }
  }
  const int sign = sign_of_determinant(differences[0], differences[1], differences[2]);
  // A matrix that is taken as it stands may turn the order of three vectors.
  if (one_frame && sign != 0) return std::nullopt;
  return sign;
}

int PosedPair::sign_dot(const PairVector& u, const PairVector& v) const {
  const VectorError eu = error_of(u), ev = error_of(v);
  {
    const Vec3 x = approximate(u), y = approximate(v);
    const double a = norm1(x) + 3 * eu.rounded, b = norm1(y) + 3 * ev.rounded;
    const double value = x.dot(y);
    if (std::abs(value) >
        (4 * kUnitRoundoff * a * b + (eu.rounded * b + ev.rounded * a)) * (1 + 16 * kUnitRoundoff) + kUnderflow) {
      ++stages_.filtered;
      return sign(value);
    }
  }
  {
    const Vec3DD x = approximate_dd(u), y = approximate_dd(v);
    const double a = norm1(high(x)) + 3 * eu.fine, b = norm1(high(y)) + 3 * ev.fine;
    const double value = dot(x, y).hi;
    if (std::abs(value) >
        (16 * 0x1p-104 * a * b + (eu.fine * b + ev.fine * a)) * (1 + 16 * kUnitRoundoff) + kUnderflow) {
      ++stages_.double_double;
      return sign(value);
    }
  }
  ++stages_.exact;
  return dot(exact(u), exact(v)).sign();
}

bool PosedPair::parallel(const PairVector& u, const PairVector& v) const {
  const Vec3 x = approximate(u), y = approximate(v);
  const double eu = error_of(u).rounded, ev = error_of(v).rounded;
  const double a = norm1(x) + 3 * eu, b = norm1(y) + 3 * ev;
  const Vec3 c = x.cross(y);
  if (c.cwiseAbs().maxCoeff() >
      (4 * kUnitRoundoff * a * b + (eu * b + ev * a)) * (1 + 16 * kUnitRoundoff) + kUnderflow) {
    ++stages_.filtered;
    return false;
  }
  ++stages_.exact;
  if (cross_vanishes_term_by_term(zero_coordinates(u), zero_coordinates(v))) return true;
  Vec3 whole[2];
  if (unrounded<2>({&u, &v}, whole)) return collinear(Vec3::Zero(), whole[0], whole[1]);
  const Dyadic3 e = cross(exact(u), exact(v));
  return e.x.sign() == 0 && e.y.sign() == 0 && e.z.sign() == 0;
}

}  // namespace pd::detail
