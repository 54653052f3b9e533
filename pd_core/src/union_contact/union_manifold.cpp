#include "pd/union_contact/union_manifold.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "depth/pair/scaled_shape.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/contact/farthest_point.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/union_contact/deep_union.hpp"
#include "pd/union_contact/one_sided.hpp"
#include "pd/union_contact/patches.hpp"
#include "pd/union_contact/straddled.hpp"
#include "union_contact/piece_exit.hpp"
#include "union_contact/piece_store.hpp"

namespace pd {

using namespace detail;

namespace {

/// Rounding of poses in double, a few times over (as of `seam_slack`).
constexpr double kRounding = 0x1p-46;
/// Two bodies may have so many directions of contact.
constexpr int kMostPatches = 8;
/// One answer asks no more pairs of pieces.
constexpr std::size_t kMostPiecePairs = std::size_t{1} << 20;
/// Points are told apart as if the breaking threshold were at least this share of the smaller body's half diagonal, so
/// that noise is told from depth even at a threshold of 0, and at most all of it, so that a far reach merges none.
constexpr double kLeastScale = 0x1p-8;
/// For bodies of size 1, a threshold or way that is longer than this makes no difference.
constexpr double kFar = 0x1p64;
/// A body that follows a way out of a triangle so much farther is off the triangle beyond rounding.
constexpr double kClear = 1 + 0x1p-6;

TriangleBox grown(const TriangleBox& box, double by) {
  return {(box.low.array() - by).matrix(), (box.high.array() + by).matrix()};
}

/// The pieces near the other body are those whose boxes come near the box around that body.
class NearStanding final : public NearSides {
 public:
  NearStanding(StandingPieces& a, StandingPieces& b) : a_(a), b_(b) {}
  bool collect(double reach, NearSide& a, NearSide& b) override {
    return collect(a_, b_.whole_box(), reach, a) && collect(b_, a_.whole_box(), reach, b);
  }

 private:
  bool collect(StandingPieces& body, const TriangleBox& other, double reach, NearSide& side) {
    body.meeting(grown(other, reach), side.numbers);
    side.posed.clear();
    for (const int i : side.numbers) {
      side.posed.push_back(body.posed(i));
    }
    return !side.posed.empty();
  }
  StandingPieces& a_;
  StandingPieces& b_;
};

/// One question. A sheet, if there is one, is B.
class Asked {
 public:
  Asked(StandingPieces& a, StandingPieces& b, const UnionContactSettings& settings, UnionManifoldScratch& scratch)
      : a_(a), b_(b), settings_(settings), scratch_(scratch) {
    depth_settings_.beyond = settings.breaking_threshold;
  }

  /// Asks all pairs of pieces that are near. @return false if there are too many
  bool ask_pairs();
  /// Adds the way out of the whole if it is needed. @return false if that is over its budget
  bool leave_as_one();
  void choose();
  [[nodiscard]] const Patches& patches() const { return patches_; }
  [[nodiscard]] std::pair<int, int> pieces_of(int pair) const {
    const auto [i, j] = pairs_[static_cast<std::size_t>(pair)];
    return {a_.number(i), b_.number(j)};
  }
  [[nodiscard]] std::int64_t covered() const { return covered_; }

 private:
  void ask(int i, int j);
  /// Adds the contacts along the fronts of triangles that piece i stands through, if no contact of it leads off them.
  void add_fronts(int i);
  /// Adds the way out of the whole of A along the front of a triangle.
  void add_front(int i, const OneSided::Behind& behind);
  /// Returns the side by which A is to leave a triangle: its front, or the one that A's middle is on.
  [[nodiscard]] Vec3 side_of(int j, const Vec3& middle);
  /// Adds the way out of the whole off a sheet where no contact of a piece is left that overlaps.
  void leave_straddled();
  PiecePair pair_of(PieceAmong& around_a, PieceAmong& around_b, const PosedShape& a, const PosedShape& b) const;
  void add(int i, int j, const ContactManifold& points) {
    pairs_.emplace_back(i, j);
    patches_.add(points, static_cast<int>(pairs_.size()) - 1, a_.number(i), b_.number(j));
  }

  StandingPieces& a_;
  StandingPieces& b_;
  const UnionContactSettings& settings_;
  UnionManifoldScratch& scratch_;
  DepthSettings depth_settings_;
  std::vector<std::pair<int, int>> pairs_;
  Patches patches_;
  DeepUnion deep_;
  OneSided one_sided_;
  StraddledTriangles straddled_;
  std::int64_t covered_ = 0;
};

PiecePair Asked::pair_of(PieceAmong& around_a, PieceAmong& around_b, const PosedShape& a, const PosedShape& b) const {
  return {.a = a,
          .b = b,
          .around_a = a_.size() > 1 ? &around_a : nullptr,
          .around_b = b_.size() > 1 ? &around_b : nullptr,
          .threshold = settings_.breaking_threshold,
          .way = settings_.way,
          .pose_rounding = kRounding,
          .cover = scratch_.cover,
          .manifold = scratch_.manifold};
}

void Asked::ask(int i, int j) {
  if (b_.shape(j) == nullptr) return;
  const PosedShape a = a_.posed(i), b = b_.posed(j);
  const PenetrationDepth depth = penetration_depth(a, b, scratch_.depth, depth_settings_);
  if (depth.signed_distance() > settings_.breaking_threshold) return;
  const Vec3 front = settings_.one_sided ? b_.front(j) : Vec3(Vec3::Zero());
  if (settings_.one_sided && !one_sided_.admit(depth, front, j)) return;
  PieceAmong around_a(a_, i), around_b(b_, j);
  PiecePair pair = pair_of(around_a, around_b, a, b);
  pair.front = front;
  ContactManifold points = contact_manifold(a, b, depth, settings_.breaking_threshold, scratch_.manifold);
  covered_ += keep_uncovered(pair, depth, AnswerPoints::made, points);
  if (!b_.is_sheet()) {
    deep_.add({depth, a, b, i, j}, points);
  } else if (points.count > 0) {
    one_sided_.add_way(std::max(deepest_of(points), 0.0) * points.normal);
  } else if (a_.size() > 1) {
    straddled_.note({i, j}, -depth.signed_distance(), points);
  } else if (depth.contact == ContactClass::overlapping) {
    const Vec3 normal = b_.front(j);
    one_sided_.add_behind(j, side_of(j, 0.5 * (farthest_point(a, normal) + farthest_point(a, -normal))));
  }
  add(i, j, points);
}

void Asked::add_fronts(int i) {
  const PosedShape a = a_.posed(i);
  const std::vector<Vec3>& ways = one_sided_.ways_out();
  for (const OneSided::Behind& behind : one_sided_.behind()) {
    const PosedShape b = b_.posed(behind.triangle);
    const bool left = std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
      // The body is moved a little farther than touching, which rounding would decide.
      const PosedShape moved{a.shape,
                             Pose::from_trusted_matrix(a.pose.rotation(), a.pose.translation() + kClear * way)};
      return penetration_depth(moved, b, scratch_.depth, depth_settings_).contact != ContactClass::overlapping;
    });
    if (!left) add_front(i, behind);
  }
}

void Asked::add_front(int i, const OneSided::Behind& behind) {
  const PosedShape a = a_.posed(i), b = b_.posed(behind.triangle);
  PieceAmong around_a(a_, i), around_b(b_, behind.triangle);
  PiecePair pair = pair_of(around_a, around_b, a, b);
  pair.front = behind.front;
  add(i, behind.triangle, along_front(pair, FrontPoints::any));
}

Vec3 Asked::side_of(int j, const Vec3& middle) {
  const PosedShape b = b_.posed(j);
  const Vec3 normal = b_.front(j);
  if (settings_.one_sided) return normal;
  return side_towards(middle, normal, b.pose.apply(b.shape->polytope()->vertex(0)));
}

void Asked::leave_straddled() {
  const TriangleBox box = a_.whole_box();
  const Vec3 middle = 0.5 * (box.low + box.high);
  for (const auto& [i, j] : straddled_.need_way_out(patches_)) add_front(i, {j, side_of(j, middle)});
}

bool Asked::ask_pairs() {
  const double reach = settings_.breaking_threshold;
  std::vector<int> near_a, near_b;
  a_.meeting(grown(b_.whole_box(), reach), near_a);
  std::size_t asked = 0;
  for (const int i : near_a) {
    b_.meeting(grown(a_.box(i), reach), near_b);
    asked += near_b.size();
    if (asked > kMostPiecePairs) return false;
    one_sided_.clear();
    for (const int j : near_b) ask(i, j);
    add_fronts(i);
  }
  leave_straddled();
  return true;
}

bool Asked::leave_as_one() {
  if (!deep_.needed()) return true;
  NearStanding near(a_, b_);
  DeepUnion::Way way;
  Vec3 last = Vec3::Zero();
  switch (deep_.find_way({near, settings_.breaking_threshold, kRounding, Vec3::Zero()},
                         {scratch_.depth, scratch_.manifold, scratch_.exit}, last, way)) {
    case DeepUnion::Outcome::over_budget:
      return false;
    case DeepUnion::Outcome::apart:
    case DeepUnion::Outcome::unsupported:
      return true;
    case DeepUnion::Outcome::found:
    case DeepUnion::Outcome::nearly:
      break;
  }
  // A contact that is deeper than the way leads on where the bodies are apart already.
  patches_.keep_along(way.points.normal, deepest_of(way.points));
  add(way.piece_a, way.piece_b, way.points);
  return true;
}

void Asked::choose() {
  if (patches_.empty()) return;
  const auto half_diagonal = [](const TriangleBox& box) { return 0.5 * (box.high - box.low).norm(); };
  const double size = std::min(half_diagonal(a_.whole_box()), half_diagonal(b_.whole_box()));
  patches_.choose(kMostPatches, std::clamp(settings_.breaking_threshold, kLeastScale * size, size), {});
}

std::optional<Error> fault_of(const PosedPieces& a, const PosedPieces& b, const UnionContactSettings& settings) {
  if (!(settings.breaking_threshold >= 0) || !std::isfinite(settings.breaking_threshold)) {
    return Error{ErrorCode::bad_value, "a breaking threshold must be 0 or greater", "breaking_threshold"};
  }
  if (!(settings.way >= 0) || !std::isfinite(settings.way)) {
    return Error{ErrorCode::bad_value, "a way must be 0 or greater", "way"};
  }
  if (a.body->is_sheet() && b.body->is_sheet()) {
    return Error{ErrorCode::unsupported, "two sheets have no inside; one of the two bodies must be solid", "a"};
  }
  if (settings.one_sided && !a.body->is_sheet() && !b.body->is_sheet()) {
    return Error{ErrorCode::unsupported, "only a sheet has sides; give one of the two bodies as a sheet", "one_sided"};
  }
  return {};
}

UnionContactPoint turned(UnionContactPoint point) {
  point.normal = Vec3::Zero() - point.normal;
  std::swap(point.contact.position_a, point.contact.position_b);
  std::swap(point.piece_a, point.piece_b);
  return point;
}

UnionManifold manifold_of(const Asked& asked, bool swapped) {
  UnionManifold result;
  result.covered = asked.covered();
  for (int p = 0; p < asked.patches().size(); ++p) {
    const Patch& patch = asked.patches()[p];
    if (patch.count == 0) continue;
    UnionContactPatch& out = result.patches.emplace_back();
    out.count = patch.count;
    std::size_t deepest = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(patch.count); ++k) {
      const PatchPoint& point = patch.points[k];
      const auto [piece_a, piece_b] = asked.pieces_of(point.piece);
      const UnionContactPoint made{point.normal, point.contact, piece_a, piece_b};
      out.points[k] = swapped ? turned(made) : made;
      if (point.contact.depth > patch.points[deepest].contact.depth) deepest = k;
    }
    out.normal = out.points[deepest].normal;
    if (result.patches.size() > 1) continue;
    result.normal = out.normal;
    result.piece_a = out.points[deepest].piece_a;
    result.piece_b = out.points[deepest].piece_b;
  }
  return result;
}

/// Returns the contact of the two pieces that decide the depth of the two unions.
Expected<UnionManifold> deciding_pieces(const PosedPieces& a, const PosedPieces& b, double threshold,
                                        UnionManifoldScratch& scratch) {
  const Compound &union_a = *a.body->store().compound, &union_b = *b.body->store().compound;
  const auto depth = penetration_depth({&union_a, a.pose}, {&union_b, b.pose}, scratch.depth, UnionSettings());
  if (!depth) return depth.error();
  const UnionDepth& found = depth.value();
  const auto parts_a = union_a.posed(a.pose), parts_b = union_b.posed(b.pose);
  const ContactManifold points =
      contact_manifold(parts_a.value()[static_cast<std::size_t>(found.part_a)],
                       parts_b.value()[static_cast<std::size_t>(found.part_b)], found, threshold, scratch.manifold);
  UnionManifold result;
  result.normal = found.normal;
  result.piece_a = found.part_a;
  result.piece_b = found.part_b;
  if (points.count == 0) return result;
  UnionContactPatch& patch = result.patches.emplace_back();
  patch.normal = points.normal;
  patch.count = points.count;
  for (std::size_t k = 0; k < static_cast<std::size_t>(points.count); ++k) {
    patch.points[k] = {points.normal, points.points[k], found.part_a, found.part_b};
  }
  return result;
}

/// Returns the exponent of the bodies' size if doubles lack room for products of lengths, else 0. Two bodies that are
/// one point, the origin, have no size to bring to 1.
int extreme_exponent(const StandingPieces& a, const StandingPieces& b) {
  double size = 0;
  for (const StandingPieces* body : {&a, &b}) {
    const TriangleBox box = body->whole_box();
    size = std::max({size, box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff()});
  }
  return size > 0x1p100 || (size > 0 && size < 0x1p-100) ? std::ilogb(size) : 0;
}

/// Answers about the bodies times 2^-exponent, and brings the answer back.
Expected<UnionManifold> at_size_one(const PosedPieces& a, const PosedPieces& b, const UnionContactSettings& settings,
                                    int exponent, UnionManifoldScratch& scratch) {
  const auto pose = [&](const Pose& of) {
    return Pose::from_trusted_matrix(of.rotation(), times_power(of.translation(), -exponent));
  };
  const PieceBody one = scaled(*a.body, -exponent), other = scaled(*b.body, -exponent);
  UnionContactSettings small = settings;
  small.breaking_threshold = std::min(std::ldexp(settings.breaking_threshold, -exponent), kFar);
  small.way = std::min(std::ldexp(settings.way, -exponent), kFar);
  auto found = union_manifold({&one, pose(a.pose)}, {&other, pose(b.pose)}, small, scratch);
  if (!found) return found;
  UnionManifold result = std::move(found).value();
  for (UnionContactPatch& patch : result.patches) {
    for (UnionContactPoint& point : patch.points) {
      point.contact.position_a = times_power(point.contact.position_a, exponent);
      point.contact.position_b = times_power(point.contact.position_b, exponent);
      point.contact.depth = std::ldexp(point.contact.depth, exponent);
    }
  }
  return result;
}

}  // namespace

Expected<UnionManifold> union_manifold(const PosedPieces& a, const PosedPieces& b, const UnionContactSettings& settings,
                                       UnionManifoldScratch& scratch) {
  if (const auto fault = fault_of(a, b, settings)) return *fault;
  auto standing_a = StandingPieces::stand(a), standing_b = StandingPieces::stand(b);
  if (!standing_a) return Error{standing_a.error().code, standing_a.error().message, "pose_a"};
  if (!standing_b) return Error{standing_b.error().code, standing_b.error().message, "pose_b"};
  StandingPieces first = std::move(standing_a).value(), second = std::move(standing_b).value();
  if (const int exponent = extreme_exponent(first, second); exponent != 0) {
    return at_size_one(a, b, settings, exponent, scratch);
  }
  const bool swapped = first.is_sheet();
  Asked asked(swapped ? second : first, swapped ? first : second, settings, scratch);
  if (!asked.ask_pairs()) {
    return Error{ErrorCode::limit_exceeded, "more than 2^20 pairs of pieces are near each other", "a"};
  }
  if (!asked.leave_as_one()) {
    return Error{ErrorCode::limit_exceeded,
                 "the bodies are deep in each other, and the way out of so many pieces takes more than one answer may; "
                 "depth has no such limit",
                 "a"};
  }
  asked.choose();
  UnionManifold result = manifold_of(asked, swapped);
  if (!result.patches.empty() || a.body->is_sheet() || b.body->is_sheet()) return result;
  const std::int64_t covered = result.covered;
  auto deciding = deciding_pieces(a, b, settings.breaking_threshold, scratch);
  if (!deciding) return deciding;
  result = std::move(deciding).value();
  result.covered = covered;
  return result;
}

}  // namespace pd
