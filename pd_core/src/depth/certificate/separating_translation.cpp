#include "depth/certificate/separating_translation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "numeric/expansion.hpp"
#include "numeric/instruction_sets.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

/// Within these magnitudes (or zero) squares and their roundings are exact in expansions.
bool squares_exactly(double x) {
  const double magnitude = std::abs(x);
  return x == 0 || (magnitude >= 0x1p-450 && magnitude <= 0x1p450);
}

Expansion<2> square(double x) {
  const DoubleDouble p = two_product(x, x);
  Expansion<2> e;
  e.push(p.lo);
  e.push(p.hi);
  return e;
}

/// |t| <= length, exactly.
bool no_longer_than(const Vec3& t, double length) {
  if (squares_exactly(t.x()) && squares_exactly(t.y()) && squares_exactly(t.z()) && squares_exactly(length)) {
    return sum(sum(sum(square(t.x()), square(t.y())), square(t.z())), square(length), -1).sign() <= 0;
  }
  const Dyadic3 exact = to_dyadic(t);
  return (Dyadic(length) * Dyadic(length) - dot(exact, exact)).sign() >= 0;
}

constexpr int kMostSteps = 64;  ///< of a coordinate, either way
constexpr int kWidth = 4;
constexpr int kRowLanes = (2 * kMostSteps + 1 + kWidth - 1) / kWidth * kWidth;

/// Candidates that differ in one coordinate only, by -inner .. inner ulps, before another is solved for.
struct RowOfCandidates {
  double excess = 0;      ///< how far beyond the plane the middle one lies, the solved coordinate unchanged
  double base = 0;        ///< its coordinate,
  double ulp = 0;         ///< the steps of that,
  double component = 0;   ///< and the normal's
  double rise = 0;        ///< how far a step of the solved coordinate leads beyond the plane
  double most_steps = 0;  ///< of the solved coordinate within its leeway
  double height = 0;      ///< of the cap
  double doubt = 0;       ///< nearer than this to the plane `reached` must be asked
  int inner = 0;
};

/// Where `solve` may succeed: not 0 in the lane of such a candidate. A candidate lands on the first multiple of `rise`
/// beyond the plane, which may be too far out, or not beyond it at all where the solved coordinate would leave its
/// leeway; whatever rounding leaves open may succeed. Nearly all candidates of a search that finds none end here.
/// @return whether any lane is not 0.
PD_CLONES bool hopeful_candidates(const RowOfCandidates& row, std::int64_t (&hopeful)[kRowLanes]) {
  typedef double Lanes __attribute__((vector_size(8 * kWidth)));
  typedef std::int64_t Mask __attribute__((vector_size(8 * kWidth)));
  const auto magnitude = [](const Lanes& x) __attribute__((always_inline)) { return x < 0.0 ? -x : x; };
  Mask any = {0, 0, 0, 0};
  Lanes j = Lanes{0, 1, 2, 3} - static_cast<double>(row.inner);
  for (int i = 0; i <= 2 * row.inner; i += kWidth, j += static_cast<double>(kWidth)) {
    const Lanes aside = row.component * ((row.base + j * row.ulp) - row.base);
    const Lanes excess = row.excess + aside;
    const Lanes error = 0x1p-49 * (std::abs(row.excess) + magnitude(aside)) + 0x1p-96;
    const Lanes room = 1.001 * row.height + 2.0 * error;
    const Lanes steps = -excess / row.rise;
    const Lanes count = magnitude(steps);
    const Lanes fraction = steps - ((steps + 0x1.8p52) - 0x1.8p52);  // from the nearest whole number
    const Lanes landed = (fraction > 0.0 ? 1.0 - fraction : -fraction) * row.rise;
    const Mask held =
        (count > row.most_steps + 2) & ((excess > room) | (excess + 3.0 * row.rise < -(error + row.doubt)));
    const Mask free = (count < row.most_steps - 2) & (landed > room) & (landed < row.rise - 2.0 * error);
    const Mask open = ~((count < 0x1p50) & (held | free));
    __builtin_memcpy(hopeful + i, &open, sizeof(open));
    any |= open;
  }
  return (any[0] | any[1] | any[2] | any[3]) != 0;
}

/// L and the margins together, which cost twelve supports and are seldom needed.
class Extent {
 public:
  Extent(const PosedPair& pair, double margin) : pair_(pair), margin_(margin) {}

  [[nodiscard]] double exact() {
    if (!(exact_ >= 0)) exact_ = largest_coordinate(pair_) + margin_;
    return exact_;
  }
  /// A bound from below, by one point of P.
  [[nodiscard]] double least() {
    if (!(least_ >= 0)) {
      const double coordinate = pair_.approximate(PairVector::point(0, 0)).cwiseAbs().maxCoeff();
      const double certain = (coordinate - 4 * pair_.vector_error()) * (1 - 0x1p-40);
      least_ = std::max(0.0, std::ldexp(certain, pair_.scale_exponent())) + margin_ * (1 - 0x1p-40);
    }
    return least_;
  }

 private:
  const PosedPair& pair_;
  double margin_;
  double exact_ = -1;
  double least_ = -1;
};

/// The search for one `upper`. The cap between plane and sphere is less than an ulp high but about 1e8 ulps wide, so it
/// holds many triples: two coordinates walk near the exact translation, the third (the one with the finest ulps) is
/// solved for. Candidates are sifted in double-double before they are proved.
///
/// Next to t* = depth * unit, known in double-double, all that matters is small: with e = t - t*, t lies <unit, e>
/// beyond the plane, and |t|^2 exceeds the square of `upper` by 2 depth <unit, e> + |e|^2 less the cap's share. Both
/// are sums of products of ordinary doubles whose errors, some 2^-50 of e, are as small as double-double's.
///
/// Solving puts a candidate so close beyond the plane (2^-92 of the depth where the normal's last coordinate is 1e-6)
/// that the error of the plane itself decides, and decides alike for all of them: the plane is taken that much farther
/// out, where the cap has room for it.
class TranslationSearch {
 public:
  /// Lengths are brought near 1 by a power of two.
  TranslationSearch(Separation& separation, Extent& extent, const DoubleDouble& depth, double upper)
      : separation_(separation), extent_(extent), true_upper_(upper), exponent_(std::ilogb(upper)) {
    scale_ = std::ldexp(1.0, exponent_);
    const bool ordinary = std::abs(exponent_) <= kOrdinaryExponent;
    const double shrink = ordinary ? 1 / scale_ : 0;
    const auto near_one = [&](double x) { return ordinary ? x * shrink : std::ldexp(x, -exponent_); };
    upper_ = near_one(upper);
    depth_ = {near_one(depth.hi), near_one(depth.lo)};
    height_ = to_double(DoubleDouble{upper_, 0} - depth_);
    slack_ = near_one(separation.slack(depth));
    double farther = 0;
    if (slack_ < 0.25 * height_) {
      farther = slack_;
      depth_ = depth_ + DoubleDouble{slack_, 0};
      height_ = to_double(DoubleDouble{upper_, 0} - depth_);
    }
    const Vec3DD& unit = separation.unit();
    components_[0] = unit.x;
    components_[1] = unit.y;
    components_[2] = unit.z;
    for (int i = 0; i < 3; ++i) {
      const DoubleDouble product = components_[i] * depth_;
      base_[i] = product.hi;
      residue_[i] = product.lo;
    }
    if (!ordinary || !separation.measured()) return;
    aside_.usable = true;
    aside_.farther = farther;
    aside_.cap = height_ * (2 * depth_.hi + height_);
    // Of <unit, t> - depth: the plane's own errors over |t|_1 <= sqrt(3) |t|, the length of `unit`, and double-double.
    aside_.doubt = near_one(separation.depth_error()) + 2 * (6 * separation.unit_error() + 16 * kUdd);
    aside_.doubt_of_length = kDoubt + 16 * separation.unit_error();
  }

  [[nodiscard]] const Vec3& translation() const { return translation_; }

  bool at_base() {
    const double e[3] = {-residue_[0], -residue_[1], -residue_[2]};
    const Verdict told = judged(e);
    if (told == Verdict::open) return accept(base_, excess_of_length(base_));
    if (told == Verdict::accepted) translation_ = scale_ * base_;
    return told == Verdict::accepted;
  }

  /// Within 4 ulp of L, a coordinate, of the exact translation.
  /// @param widely  else the steps of other coordinates than the one solved for are left out.
  bool near_base(bool widely) {
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int i, int j) { return std::abs(base_[i]) > std::abs(base_[j]); });
    const double scale = std::abs(base_[order[0]]);
    // A coordinate that is nearly a zero of the normal hardly moves the plane's side, but lengthens t: it stays, or
    // goes.
    int live = 1;
    while (live < 3 && std::abs(base_[order[live]]) > 0x1p-20 * scale) ++live;
    solved_ = order[live - 1];
    if (live < 3) {
      Vec3 bare = base_;
      for (int i = live; i < 3; ++i) {
        if (bare[order[i]] != 0 && std::abs(bare[order[i]]) <= leeway()) bare[order[i]] = 0;
      }
      if (solve(bare)) return true;
    }
    if (solve(base_)) return true;
    if (live == 1 || !widely) return false;
    // An exact depth that is a double leaves a cap of no height: only the exact translation itself could do.
    if (!(height_ > 0)) return false;
    return walk(order, live);
  }

 private:
  /// Steps of the coordinates that are not solved for, from the exact translation's.
  bool walk(const int (&order)[3], int live) {
    const int first = order[0];
    const int second = order[1];
    const int steps = reach(first);
    const int inner = live == 3 ? reach(second) : 0;
    if (live == 3) prepare_rows(second, inner);
    // What the other coordinates can make up for once the first is chosen.
    double range = height_;
    for (int i = 1; i < live; ++i) range += 1.01 * std::abs(components_[order[i]].hi) * (leeway() + ulp(order[i]));
    const double step = ulp(first), inner_step = ulp(second);
    for (int i = -steps; i <= steps; ++i) {
      Vec3 t = base_;
      t[first] += i * step;
      const double excess = beyond_plane(t);
      if (std::abs(excess) > range) continue;
      if (live < 3) {
        if (solve(t)) return true;
        continue;
      }
      row_.excess = excess;
      if (row_.rise > 0 && !hopeful_candidates(row_, hopeful_)) continue;
      for (int j = -inner; j <= inner; ++j) {
        Vec3 candidate = t;
        candidate[second] += j * inner_step;
        if ((row_.rise > 0 && hopeful_[j + inner] == 0) || !solve(candidate)) continue;
        return true;
      }
    }
    return false;
  }

  /// How far a candidate lies beyond the plane, off by less than 2^-50 of that and of an ulp.
  [[nodiscard]] double beyond_plane(const Vec3& t) const {
    if (aside_.usable) {
      const Vec3 e = (t - base_) - residue_;
      return components_[0].hi * e[0] + components_[1].hi * e[1] + components_[2].hi * e[2];
    }
    DoubleDouble rest = depth_;
    for (int k = 0; k < 3; ++k) rest = rest - components_[k] * t[k];
    return -to_double(rest);
  }

  /// What all rows of `hopeful_candidates` share. No rise where the steps of the solved coordinate are not all alike.
  void prepare_rows(int second, int inner) {
    const double size = std::abs(base_[solved_]);
    const double step = ulp(solved_);
    const double margin = leeway() + 4 * step;
    const double binade = std::ldexp(1.0, std::ilogb(size));
    const bool alike = size - margin > binade && size + margin < 2 * binade;
    row_.rise = alike ? std::abs(components_[solved_].hi) * step : 0;
    row_.base = base_[second];
    row_.ulp = ulp(second);
    row_.component = components_[second].hi;
    row_.inner = inner;
    row_.most_steps = leeway() / step;
    row_.height = height_;
    row_.doubt = (2 * slack_ + 0x1p-90) * (1 + base_.cwiseAbs().sum() + 3 * kMostSteps * leeway());
  }

  [[nodiscard]] double ulp(int i) const { return std::nextafter(std::abs(base_[i]), HUGE_VAL) - std::abs(base_[i]); }
  /// Steps to try of a coordinate, either way. Where 2^31 of them and more make up the leeway, a few or many are the
  /// same place; the comparison stands before the conversion, which is undefined there and differs between machines.
  [[nodiscard]] int reach(int i) {
    const double steps = leeway() / ulp(i);
    return steps < 0x1p31 ? std::clamp(static_cast<int>(steps), 4, kMostSteps) : 4;
  }

  static double ulps_of(double extent) { return 4 * (std::nextafter(extent, HUGE_VAL) - extent); }
  double leeway() {
    if (leeway_ == 0) leeway_ = ulps_of(std::ldexp(extent_.exact(), -exponent_));
    return leeway_;
  }
  /// `distance > leeway()`, mostly without L itself.
  [[nodiscard]] bool beyond_leeway(double distance) {
    return distance > ulps_of(std::max(std::ldexp(extent_.least(), -exponent_), 0.5 * upper_)) && distance > leeway();
  }

  /// |t|^2 less the square of `upper`, off by less than kDoubt.
  [[nodiscard]] double excess_of_length(const Vec3& t) const {
    const DoubleDouble squared = two_product(t.x(), t.x()) + two_product(t.y(), t.y()) + two_product(t.z(), t.z());
    return (squared - two_product(upper_, upper_)).hi;
  }

  enum class Verdict : std::uint8_t { rejected, accepted, open };

  /// Of t* + e, where doubles tell: whether it is no longer than `upper`, and reaches the plane.
  [[nodiscard]] Verdict judged(const double (&e)[3]) const {
    if (!aside_.usable) return Verdict::open;
    const double along[3] = {components_[0].hi * e[0], components_[1].hi * e[1], components_[2].hi * e[2]};
    const double size = std::abs(along[0]) + std::abs(along[1]) + std::abs(along[2]);
    if (!(size < kAside)) return Verdict::open;
    const double beyond = along[0] + along[1] + along[2];
    const double longer = 2 * depth_.hi * beyond + (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) - aside_.cap;
    if (longer > aside_.doubt_of_length) return Verdict::rejected;
    const double gap = beyond + aside_.farther;
    const double error = aside_.doubt + 0x1p-50 * (size + aside_.farther);
    if (gap < -error) return Verdict::rejected;
    return gap > error && longer < -aside_.doubt_of_length ? Verdict::accepted : Verdict::open;
  }

  /// @param excess  `excess_of_length(candidate)`.
  bool accept(const Vec3& candidate, double excess) {
    const Vec3 t = scale_ * candidate;
    // A quotient of numbers hundreds of powers of two apart may be none.
    if (!t.allFinite()) return false;
    if (!no_longer(candidate, excess, t) || !separation_.reached(t)) return false;
    translation_ = t;
    return true;
  }
  /// |t| <= upper, exactly; t is the candidate at its size.
  [[nodiscard]] bool no_longer(const Vec3& candidate, double excess, const Vec3& t) const {
    // Below, what a coordinate loses as a subnormal number may be more than the doubt.
    if (exponent_ > -900) {
      if (std::abs(excess) > kDoubt) return excess < 0;
      if ((candidate.array() != 0).count() == 1) return candidate.cwiseAbs().sum() <= upper_;
    }
    return no_longer_than(t, true_upper_);
  }

  /// Solves for one coordinate, given the other two.
  bool solve(const Vec3& t) {
    const Verdict told = aside_.usable ? solve_in_doubles(t) : Verdict::open;
    return told == Verdict::open ? solve_in_double_double(t) : told == Verdict::accepted;
  }

  /// Finds what double-double does, or leaves it open.
  Verdict solve_in_doubles(Vec3 t) {
    const double component = components_[solved_].hi;
    double e[3];
    double others = 0, size = 0, widest = 0;
    for (int i = 0; i < 3; ++i) {
      if (i == solved_) continue;
      e[i] = (t[i] - base_[i]) - residue_[i];
      const double along = components_[i].hi * e[i];
      others += along;
      size += std::abs(along);
      widest = std::max(widest, std::abs(e[i]));
    }
    const double shift = residue_[solved_] - others / component;
    if (!(std::max(widest, std::abs(shift)) < kAside)) return Verdict::open;
    double& x = t[solved_];
    const double base = base_[solved_];
    x = base + shift;
    // The leeway is never less than 4 ulps of half of `upper`.
    if (std::abs(x - base) > 0x1p-51 && beyond_leeway(std::abs(x - base))) x = base;
    double excess = 0;
    for (int outward = 0; outward < 2; ++outward) {
      if (outward > 0) x = std::nextafter(x, component > 0 ? HUGE_VAL : -HUGE_VAL);
      e[solved_] = (x - base) - residue_[solved_];
      const double along = component * e[solved_];
      excess = others + along;
      if (!(std::abs(excess) > 0x1p-48 * (size + std::abs(along)) + 0x1p-100)) return Verdict::open;
      if (excess > 0) break;
    }
    if (excess > 1.001 * height_) return Verdict::rejected;
    const Verdict told = judged(e);
    if (told == Verdict::accepted) translation_ = scale_ * t;
    return told;
  }

  bool solve_in_double_double(Vec3 t) {
    const DoubleDouble& component = components_[solved_];
    DoubleDouble rest = depth_;
    for (int i = 0; i < 3; ++i) {
      if (i != solved_) rest = rest - components_[i] * t[i];
    }
    t[solved_] = to_double(rest / component);
    if (beyond_leeway(std::abs(t[solved_] - base_[solved_]))) t[solved_] = base_[solved_];
    DoubleDouble excess = component * t[solved_] - rest;
    const double outward = component.hi > 0 ? HUGE_VAL : -HUGE_VAL;
    if (excess.hi < 0) {
      t[solved_] = std::nextafter(t[solved_], outward);
      excess = component * t[solved_] - rest;
    }
    if (excess.hi > height_ * 1.0001) return false;
    const double longer = excess_of_length(t);
    if (longer > kDoubt) return false;
    if (accept(t, longer)) return true;
    // Below what double-double resolves (a body of size 1 and one of 1e-300), the plane may lie an ulp further out.
    if (excess.hi > 0x1p-95) return false;
    t[solved_] = std::nextafter(t[solved_], outward);
    return accept(t, excess_of_length(t));
  }

  /// Of squares of lengths in [1, 2): double-double errs by 2^-100 of them.
  static constexpr double kDoubt = 0x1p-90;
  /// Beyond these powers of two products with the scale may leave the range of doubles.
  static constexpr int kOrdinaryExponent = 900;
  /// From t*, in units of the depth: farther away 2^-50 of it is more than double-double's errors.
  static constexpr double kAside = 0x1p-46;

  /// What `judged` needs besides t*.
  struct Aside {
    bool usable = false;
    double farther = 0;  ///< how much farther out the plane was taken
    double cap = 0;      ///< the square of `upper` less that of the depth
    double doubt = 0;
    double doubt_of_length = 0;
  };

  Separation& separation_;
  Extent& extent_;
  double true_upper_;
  int exponent_;
  double scale_;  ///< 2^exponent_
  double upper_;
  DoubleDouble depth_;
  DoubleDouble components_[3];
  Vec3 base_;     ///< t*, rounded,
  Vec3 residue_;  ///< and what t* is more than that
  Aside aside_;
  double height_;
  double slack_;       ///< of the plane (Separation::slack)
  double leeway_ = 0;  ///< 0: not asked for yet
  RowOfCandidates row_;
  std::int64_t hopeful_[kRowLanes];
  int solved_ = 0;
  Vec3 translation_ = Vec3::Zero();
};

/// Without a search: the exact translation with every coordinate rounded away from zero, which reaches whatever the
/// coordinates are. Lengthens t by three ulps at most, and one for the rounding of its length.
double outward_translation(Separation& separation, const DoubleDouble& depth, double upper, Vec3& translation) {
  const Vec3DD& unit = separation.unit();
  const DoubleDouble components[3] = {unit.x, unit.y, unit.z};
  // A depth below the least number rounds to 0, and the first number away from 0 is far enough.
  const int exponent = std::ilogb(std::max(depth.hi, std::numeric_limits<double>::denorm_min()));
  const DoubleDouble near_one{std::ldexp(depth.hi, -exponent), std::ldexp(depth.lo, -exponent)};
  // One round, as the plane is known to far less than an ulp; growing strides, so that nothing else can hang here.
  for (double ulps = 1;; ulps *= 2) {
    const DoubleDouble length = near_one + DoubleDouble{ulps * 0x1p-52, 0};
    for (int i = 0; i < 3; ++i) {
      const double x = std::ldexp((components[i] * length).hi, exponent);
      const double away = components[i].hi > 0 ? HUGE_VAL : -HUGE_VAL;
      translation[i] = components[i].hi == 0 ? 0 : std::nextafter(x, away);
    }
    if (!separation.reached(translation)) continue;
    while (!no_longer_than(translation, upper)) upper = std::nextafter(upper, HUGE_VAL);
    return upper;
  }
}

}  // namespace

double largest_coordinate(const PosedPair& pair) {
  const auto extreme = [](const ConvexPolytope& body, const Pose& pose, int axis, double sign) {
    const Vec3 row = pose.rotation().row(axis).transpose();
    return row.dot(body.vertex(support_vertex(body, sign * row, -1)));
  };
  const Vec3 offset = pair.pose_b().translation() - pair.pose_a().translation();
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const double x =
          extreme(pair.b(), pair.pose_b(), axis, sign) - extreme(pair.a(), pair.pose_a(), axis, -sign) + offset[axis];
      largest = std::max(largest, std::abs(x));
    }
  }
  return largest;
}

double shortest_translation(const PosedPair& pair, Separation& separation, const DoubleDouble& depth, double upper,
                            double margin, Bracket bracket, Vec3& translation) {
  const bool widely = bracket == Bracket::tightest;
  Extent extent(pair, margin);
  TranslationSearch nearest(separation, extent, depth, upper);
  if (nearest.at_base() || nearest.near_base(widely)) {
    translation = nearest.translation();
    return upper;
  }
  upper = std::nextafter(upper, HUGE_VAL);
  TranslationSearch next(separation, extent, depth, upper);
  if (next.at_base() || next.near_base(widely)) {
    translation = next.translation();
    return upper;
  }
  return outward_translation(separation, depth, upper, translation);
}

}  // namespace pd::detail
