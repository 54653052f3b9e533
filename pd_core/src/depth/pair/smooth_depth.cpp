#include "depth/pair/smooth_depth.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "depth/difference/barycentric.hpp"
#include "depth/difference/foot_weights.hpp"
#include "depth/distance/gjk_double_double.hpp"
#include "depth/distance/settled_foot.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/features/inscribed_balls.hpp"
#include "depth/features/same_core.hpp"
#include "depth/features/thinnest_axis.hpp"
#include "depth/pair/contact_facets.hpp"
#include "depth/pair/curved_on_facet.hpp"
#include "depth/pair/double_answer.hpp"
#include "depth/pair/scaled_shape.hpp"
#include "depth/pair/smooth_face.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

namespace {

constexpr double kDefaultDelta = 1e-6;
constexpr double kAbsolute = 1e-12;            ///< of L: where a bracket, and `touching`, stop
constexpr double kShareOfDelta = 1 - 0x1p-10;  ///< the rest is left to the rounding of sums with margins
/// Beside margins a core's distance comes to half the digits at little more: bodies at rest on each other stay within
/// kAbsolute of L.
constexpr double kShareBesideMargins = 0x1p-6;

/// Of L: what witnesses may differ by across the normal.
constexpr double kAcross = 1e-9;
/// Of L: how far below the supporting plane points of its face may be.
constexpr double kAside = 0.05;

/// Of the reach: how far witnesses may lie outside their bodies.
constexpr double kOffBody = 1e-10;
/// Planes that may be tried until they do not: all of them, or where a wide bracket is enough.
constexpr int kMostFeet = 16;
constexpr int kFewFeet = 2;
/// Steps in double-double where doubles do not bring witnesses that near.
constexpr int kFineSteps = 64;

/// Beside a margin that is 2^400 times as large, squares of the cores' distances underflow, and what was divided by
/// their roots is no unit vector. What the plane's height misses by that is nothing beside the margin.
Vec3 unit_of(const Vec3& normal) {
  const double length = normal.norm();
  return std::abs(length - 1) > 0x1p-48 ? Vec3(normal / length) : normal;
}

class SmoothQuery {
 public:
  SmoothQuery(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
              PenetrationDepth& out, WarmCertificate* warm, Rolling rolling)
      : a_(a),
        b_(b),
        buffers_(buffers),
        out_(out),
        for_contact_(settings.bracket == Bracket::contact &&
                     (settings.method == Method::automatic || settings.method == Method::expansion)),
        rough_witnesses_(for_contact_ || settings.bracket == Bracket::certified),
        difference_(a, b, buffers.points, for_contact_ ? Rolling::kept : rolling),
        width_(for_contact_ ? settings.contact_tolerance : 0),
        delta_(settings.delta > 0 ? settings.delta : kDefaultDelta),
        taken_out_(difference_.taken_out(0) + difference_.taken_out(1)),
        margin_a_(a.shape->margin() + difference_.taken_out(0)),
        margin_b_(b.shape->margin() + difference_.taken_out(1)),
        margin_(margin_a_ + margin_b_),
        warm_(warm) {}

  void solve() {
    out_.method = Method::expansion;
    if (for_contact_ && curved_on_facet(a_, b_, difference_, width_, warm_, out_)) return;
    buffers_.surface.clear();
    if (!solve_apart_from_memory() && !solve_by_inscribed_balls()) solve_by_expansion();
    if (!proves_overlap()) [[unlikely]]
      answer_within_reach();
    const double lower = out_.contact == ContactClass::overlapping ? out_.lower : out_.distance_lower;
    const double upper = out_.contact == ContactClass::overlapping ? out_.upper : out_.distance_upper;
    out_.bracket_reached = upper <= (1 + delta_) * lower * (1 + 0x1p-48);
    if (!for_contact_) return;
    out_.bracket_reached |= signed_width() <= contact_width();
    keep_wide_contact(size(), out_);
    if (warm_ == nullptr) return;
    for (const int of : {0, 1}) {
      const PosedShape& owner = of == 0 ? a_ : b_;
      if (owner.shape->polytope()) {
        learn_contact_facet(of, *owner.shape->polytope(), owner.pose, out_, warm_->state().facets);
      }
    }
  }

  /// What is left of a near-ball may be thinner than rounding lets a search see: the bracket is wide, and need not be.
  bool asks_for_whole_cores() const {
    return !out_.bracket_reached && out_.contact == ContactClass::overlapping && taken_out_ > 0 &&
           out_.upper - out_.lower > kAbsolute * size();
  }

 private:
  void solve_by_expansion() {
    SmoothFace nearest = nearest_face();
    const ExpansionResult& core = nearest.found;
    switch (core.status) {
      case ExpansionStatus::separated:
      case ExpansionStatus::touching:
        solve_apart(core);
        return;
      default:
        if (core.face >= 0 && core.lower > 0) {
          fill_overlapping(nearest);
        } else {
          solve_apart(core);
        }
    }
  }

  /// False where bodies overlap beside margins so much larger than the cores that squares of lengths underflowed.
  [[nodiscard]] bool proves_overlap() const {
    if (out_.contact != ContactClass::overlapping || margin_ <= difference_.reach()) return true;
    return out_.lower <= out_.upper && out_.normal.allFinite() && out_.witness_a.allFinite();
  }

  /// Takes any direction: the core of P lies within its reach.
  [[gnu::cold, gnu::noinline]] void answer_within_reach() {
    const Vec3 normal = Vec3::UnitX();
    const DifferenceVertex farthest = difference_.support(normal, nullptr);
    const double reach = difference_.reach() * (1 + 0x1p-50);
    set_depth(margin_ - reach, margin_ + reach, normal);
    out_.witness_a = difference_.points(farthest).a - margin_a_ * normal;
    out_.witness_b = out_.witness_a + out_.translation;
  }

  SmoothFace nearest_face() {
    ExpansionGoal goal;
    goal.relative = delta_;
    goal.absolute = kAbsolute;
    goal.touching = kAbsolute;
    // Relative to the whole cores.
    goal.width = std::max(width_, kShareOfDelta * delta_ * taken_out_);
    goal.touching_width = 0.5 * width_;
    return nearest_smooth_face(a_, b_, difference_, goal, purpose(), buffers_, out_.statistics);
  }

  [[nodiscard]] FacePurpose purpose() const {
    if (for_contact_) return FacePurpose::contact;
    return rough_witnesses_ ? FacePurpose::bracket : FacePurpose::foot;
  }

  /// Largest |coordinate| that the search has seen: L from below.
  double size() const {
    double largest = 0;
    for (const DifferenceVertex& v : buffers_.surface.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
    return std::max(largest + taken_out_, 0x1p-1000);
  }

  bool solve_by_inscribed_balls() {
    std::int64_t& calls = out_.statistics.support_calls;
    const auto is_narrow = [&](const std::optional<InscribedBallsDepth>& balls) {
      return balls && balls->upper - balls->lower <= kShareOfDelta * delta_ * (balls->lower + taken_out_);
    };
    auto balls = ball_in_core_depth(a_, b_, difference_, calls);
    if (!is_narrow(balls)) balls = inscribed_balls_depth(a_, b_, difference_, calls);
    if (!is_narrow(balls)) return false;
    const Vec3& normal = balls->normal;
    answer_overlapping(balls->lower,
                       foot_between({normal, balls->upper}, balls->on_a + difference_.taken_out(0) * normal,
                                    balls->on_b - difference_.taken_out(1) * normal));
    return true;
  }

  /// Where the cores were apart, the points round the nearest one of P are there still, or nearly. False, and nothing
  /// said, where they overlap now, or rounding or the class of touching bodies are at stake.
  bool solve_apart_from_memory() {
    if (!warm_ || warm_->state().smooth.count == 0) return false;
    WarmSmoothPoints& last = warm_->state().smooth;
    const int count = std::exchange(last.count, 0);
    if (last.taken_out != taken_out_) return false;
    if (!same_core(*last.a, *a_.shape) || !same_core(*last.b, *b_.shape)) return false;
    DifferenceVertex start[3];
    for (int i = 0; i < count; ++i) start[i] = difference_.vertex(last.on_a[i], last.on_b[i]);
    const ClosestPoint nearest =
        closest_point(difference_, std::span(start).first(static_cast<std::size_t>(count)), relative_of_distance(),
                      width_of_distance(), buffers_.stack, out_.statistics.support_calls);
    if (!nearest.certified) return false;
    const double unclear = 2 * kAbsolute * difference_.reach();
    if (!for_contact_ && nearest.lower - margin_ <= unclear && nearest.upper - margin_ >= -unclear) return false;
    const ClosestPoint fine = fine_in_margins(nearest);
    const ClosestPoint& found = fine.certified ? fine : nearest;
    const Vec3 unit = unit_of(found.normal);
    answer_apart(found, unit, {unit, -found.lower});
    out_.warm = true;
    return true;
  }

  void remember_apart(const ClosestPoint& nearest) {
    if (!warm_ || nearest.count > 3) return;
    WarmSmoothPoints& memory = warm_->state().smooth;
    if (!memory.a || !same_core(*memory.a, *a_.shape)) memory.a = *a_.shape;
    if (!memory.b || !same_core(*memory.b, *b_.shape)) memory.b = *b_.shape;
    memory.count = nearest.count;
    memory.taken_out = taken_out_;
    for (int i = 0; i < nearest.count; ++i) {
      memory.on_a[i] = difference_.points(nearest.simplex[i]).local_a;
      memory.on_b[i] = difference_.points(nearest.simplex[i]).local_b;
    }
  }

  void fill_overlapping(SmoothFace& nearest) {
    const ExpansionResult& core = nearest.found;
    double weights[3];
    if (nearest.foot_known) {
      std::copy(std::begin(nearest.weights), std::end(nearest.weights), weights);
    } else {
      project_origin(nearest.corners, core.normal, weights);
      const double near = kAcross * size();
      if (miss_across(nearest.corners, core.normal, weights) > near) find_corners(nearest, near, weights);
    }
    const auto [on_a, on_b] = combination(nearest.corners, weights, 3);
    answer_overlapping(core.lower, foot_between({core.normal, core.upper}, on_a, on_b));
  }

  /// The last triangle is thin, one of several in a plane, or not across the normal that proves the depth, which is
  /// open by the root of the bracket's width: kAside covers its corners all the same.
  void find_corners(SmoothFace& nearest, double near, double (&weights)[3]) {
    const ExpansionResult& core = nearest.found;
    double least_height = core.lower - near;
    for (DifferenceVertex& corner : nearest.corners) {
      const double height = corner.x.dot(core.normal);
      if (height < core.lower - kAside * size()) {
        corner = difference_.support(core.normal, nullptr);
      } else {
        least_height = std::min(least_height, height);
      }
    }
    find_foot(*nearest.searched, core.normal, least_height, nearest.corners, weights);
  }

  /// Points of the cores whose difference should be the foot on the plane.
  [[nodiscard]] static Foot foot_between(const WayOut& plane, const Vec3& on_a, const Vec3& on_b) {
    const Vec3 unit = unit_of(plane.normal);
    return {unit, plane.upper, on_a, (on_b - on_a - plane.upper * unit).norm()};
  }

  void answer_overlapping(double lower, Foot foot) {
    double allowed = kOffBody * difference_.reach();
    if (rough_witnesses_) allowed = std::max({allowed, width_, 2 * (foot.height - lower)});
    if (!(foot.missed <= allowed)) {
      if (!std::isfinite(foot.missed)) foot.missed = std::numeric_limits<double>::infinity();
      foot = settled_foot(difference_, foot, allowed, rough_witnesses_ ? kFewFeet : kMostFeet, buffers_.stack,
                          out_.statistics.support_calls);
    }
    out_.contact = ContactClass::overlapping;
    set_depth(lower + margin_, foot.height + margin_, foot.normal);
    out_.witness_a = foot.on_a - margin_a_ * out_.normal;
    out_.witness_b = out_.witness_a + out_.translation;
  }

  void set_depth(double lower, double upper, const Vec3& normal) {
    out_.lower = std::max(0.0, lower * (1 - 0x1p-52));
    out_.depth = upper * (1 + 0x1p-52);
    out_.upper = upper * (1 + 0x1p-50);
    out_.normal = unit_of(normal);
    out_.translation = out_.depth * out_.normal;
  }

  /// The combinations of A's and B's points of these corners.
  [[nodiscard]] std::pair<Vec3, Vec3> combination(const DifferenceVertex* corners, const double* weights,
                                                  int count) const {
    Vec3 a = Vec3::Zero();
    Vec3 b = Vec3::Zero();
    double total = 0;
    for (int i = 0; i < count; ++i) {
      const double w = std::max(0.0, weights[i]);
      a += w * difference_.points(corners[i]).a;
      b += w * difference_.points(corners[i]).b;
      total += w;
    }
    return {a / total, b / total};
  }

  void set_witnesses(const ClosestPoint& nearest) {
    const auto [a, b] = combination(nearest.simplex, nearest.weights, nearest.count);
    out_.witness_a = a - margin_a_ * out_.normal;
    out_.witness_b = b + margin_b_ * out_.normal;
  }

  /// A support of P along the normal would be a corner of each body where many are tied; the nearest point of P is one
  /// that they share.
  void fill_touching(const Vec3& normal, const ClosestPoint& nearest) {
    out_.contact = ContactClass::touching;
    out_.normal = unit_of(normal);
    set_witnesses(nearest);
    out_.witness_b = out_.witness_a;
  }

  /// Of what is left of the cores' distance between the margins (BracketWidth::margin). Contacts ask for a length, and
  /// where they have margins for nothing else.
  double relative_of_distance() const {
    if (margin_ > taken_out_) return for_contact_ ? 0 : kShareBesideMargins * delta_;
    return taken_out_ > 0 ? kShareOfDelta * delta_ : delta_;
  }
  BracketWidth width_of_distance() const { return {0.25 * kAbsolute, 0.5 * width_, margin_}; }

  /// The translation of bodies that overlap by their margins is as long as the lower end says, their points are as far
  /// apart as the upper one: both are brought together, so that witnesses lie on the bodies. Not certified where they
  /// need not be.
  [[nodiscard]] ClosestPoint fine_in_margins(const ClosestPoint& nearest) {
    const double allowed = kOffBody * difference_.reach();
    const bool wide = nearest.upper - nearest.lower > allowed;
    if (rough_witnesses_ || !wide || !(nearest.lower > 0 && nearest.upper < margin_) || nearest.count > 3) return {};
    const BracketWidth width{0, 0.5 * allowed, 0};
    std::int64_t& calls = out_.statistics.support_calls;
    const auto count = static_cast<std::size_t>(nearest.count);
    const ClosestPoint fine =
        closest_point(difference_, std::span(nearest.simplex).first(count), 0, width, buffers_.stack, calls);
    if (fine.certified) return fine;
    ClosestPointWithNormal finest =
        closest_point_double_double(difference_, nearest.simplex[0], 0, width, kFineSteps, buffers_.stack, calls);
    finest.nearest.normal = finest.normal;
    return finest.nearest;
  }

  /// The cores are apart, or so close that only their distance (within kAbsolute of zero) is known.
  void solve_apart(const ExpansionResult& core) {
    const DifferenceVertex first = difference_.support(core.normal, nullptr);
    const double relative = relative_of_distance();
    const BracketWidth width = width_of_distance();
    ClosestPoint nearest =
        closest_point(difference_, {&first, 1}, relative, width, buffers_.stack, out_.statistics.support_calls);
    Vec3 proven = nearest.normal;
    if (!nearest.certified) {
      const ClosestPointWithNormal near = closest_point_double_double(
          difference_, first, relative, width,
          for_contact_ ? ContactBudget::kDoubleDoubleSteps : std::numeric_limits<int>::max(), buffers_.stack,
          out_.statistics.support_calls);
      nearest = near.nearest;
      proven = near.normal;
    }
    if (const ClosestPoint fine = fine_in_margins(nearest); fine.certified) {
      nearest = fine;
      proven = fine.normal;
    }
    // The cores' signed distance is at most h(normal), certified by the expansion where they are not apart.
    const bool touches = core.status == ExpansionStatus::touching && margin_ == 0;
    const bool directed = nearest.lower > 0 && !touches;
    WayOut out{unit_of(directed ? proven : core.normal), directed ? -nearest.lower : std::max(0.0, core.upper)};
    if (!directed && !touches && !for_contact_) {
      const WayOut thin = thinnest_axis(a_, b_, difference_);
      if (thin.upper < out.upper) out = thin;
    }
    answer_apart(nearest, out.normal, out, touches);
  }

  /// From the bracket of the cores' distance. `normal` is its direction; `out` leads out where margins overlap.
  /// @param touches  the cores are known to touch, and have no margins.
  void answer_apart(const ClosestPoint& nearest, const Vec3& normal, WayOut out, bool touches = false) {
    const double touching = kAbsolute * std::max(size(), nearest.point.cwiseAbs().maxCoeff());
    if (nearest.lower > 0) remember_apart(nearest);
    const double round = 4 * kUnitRoundoff * (nearest.upper + margin_);
    const double distance_lower = std::max(0.0, nearest.lower) - margin_ - round;
    const double distance_upper = nearest.upper - margin_ + round;
    if (for_contact_) {
      answer_contact(nearest, normal, out);
      return;
    }
    if (touches || (distance_upper <= touching && distance_lower >= -touching)) {
      fill_touching(normal, nearest);
      return;
    }
    if (distance_lower > 0 || distance_upper > touching) {
      out_.contact = ContactClass::separated;
      out_.normal = normal;
      set_witnesses(nearest);
      out_.distance_lower = std::max(0.0, distance_lower);
      out_.distance_upper = distance_upper;
      out_.distance = std::clamp((out_.witness_a - out_.witness_b).norm(), out_.distance_lower, out_.distance_upper);
      return;
    }
    out_.contact = ContactClass::overlapping;
    if (!std::isfinite(out.upper)) out = thinnest_axis(a_, b_, difference_);
    set_depth(margin_ - nearest.upper, margin_ + out.upper, out.normal);
    set_witnesses(nearest);
    out_.witness_b = out_.witness_a + out_.translation;
  }

  /// The same for Bracket::contact: the signed distance lies between -out.upper and nearest.upper, less the margins.
  void answer_contact(const ClosestPoint& nearest, const Vec3& normal, WayOut out) {
    if (!std::isfinite(out.upper)) out = thinnest_axis(a_, b_, difference_);
    const bool apart = nearest.lower > 0;
    out_.normal = apart ? normal : out.normal;
    set_witnesses(nearest);
    set_signed_distance(margin_, apart ? nearest.lower : -out.upper, nearest.upper, out_);
  }
  double contact_width() const { return std::max(2 * kAbsolute * size(), width_) * (1 + 0x1p-48); }
  double signed_width() const {
    if (out_.contact == ContactClass::overlapping) return out_.upper - out_.lower;
    return out_.distance_upper - out_.distance_lower + out_.upper;
  }

  const PosedShape& a_;
  const PosedShape& b_;
  ScratchBuffers& buffers_;
  PenetrationDepth& out_;
  bool for_contact_;
  bool rough_witnesses_;  ///< as near to their bodies as the bracket is wide
  SmoothDifference difference_;
  double width_;  ///< Bracket::contact: of the interval
  double delta_;
  double taken_out_;
  double margin_a_;  ///< with the balls that are taken out of the cores
  double margin_b_;
  double margin_;
  WarmCertificate* warm_;
};

/// Points of an answer are relative to the translation of A until here.
void move_witnesses(const Vec3& translation_a, PenetrationDepth& out) {
  out.witness_a += translation_a;
  out.witness_b += translation_a;
}

/// The narrower one of this answer and one for the whole cores.
[[gnu::cold, gnu::noinline]] void narrow_by_whole_cores(const PosedShape& a, const PosedShape& b,
                                                        const DepthSettings& settings, ScratchBuffers& buffers,
                                                        PenetrationDepth& out) {
  PenetrationDepth whole;
  SmoothQuery(a, b, settings, buffers, whole, nullptr, Rolling::kept).solve();
  whole.statistics.support_calls += out.statistics.support_calls;
  whole.statistics.facets_visited += out.statistics.facets_visited;
  if (whole.upper - whole.lower < out.upper - out.lower) out = whole;
}

inline void solve(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                  PenetrationDepth& out, WarmCertificate* warm) {
  SmoothQuery query(a, b, settings, buffers, out, warm, Rolling::taken_out);
  query.solve();
  if (query.asks_for_whole_cores()) [[unlikely]]
    narrow_by_whole_cores(a, b, settings, buffers, out);
}

}  // namespace

void smooth_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                  PenetrationDepth& out, WarmCertificate* warm) {
  const int exponent = extreme_exponent(a, b);
  if (exponent == 0) {
    solve(a, b, settings, buffers, out, warm);
    move_witnesses(a.pose.translation(), out);
    return;
  }
  const ScaledPair near(a, b, exponent);
  const PosedShape near_a = near.a(), near_b = near.b();
  DepthSettings near_settings = settings;
  near_settings.contact_tolerance = std::ldexp(settings.contact_tolerance, -exponent);
  solve(near_a, near_b, near_settings, buffers, out, nullptr);
  scale_answer(out, exponent);
  move_witnesses(a.pose.translation(), out);
}

}  // namespace pd::detail
