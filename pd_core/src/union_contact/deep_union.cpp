#include "pd/union_contact/deep_union.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compound/part_pairs.hpp"
#include "pd/contact/farthest_point.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/union_contact/union_piece.hpp"
#include "union_contact/piece_exit.hpp"

namespace pd {

namespace {

/// Share of the smaller piece's radius from which on pieces are deep. Contacts that solvers leave behind are far below.
constexpr double kDeep = 0.25;
/// Share of the smaller piece's extent along the way out from which on a thin piece is deep: a piece between two others
/// is in one of them by half of its extent.
constexpr double kDeepForThin = 0.4;
/// Thin pieces count where so few pairs are near, and where the bodies come by less than this share of their depth in a
/// step: a plate that is held in a robot, and not walls of shells that meet.
constexpr std::size_t kFewPairs = 64;
constexpr double kHeld = 0.5;
/// Share of the smaller piece's radius below which no extent is asked for.
constexpr double kResting = 0x1p-10;
/// cos 45 degrees.
constexpr double kTogether = 0.7;
/// Ways out that are no longer than this times the deepest pair's depth, which none is shorter than, are short enough.
constexpr double kShort = 1.5;
/// If a way is no longer than this times that depth, a shorter one is not looked for.
constexpr double kShortest = 1.05;
/// The ways of so many of the deepest pieces are tried.
constexpr std::size_t kMostOwnWays = 4;
/// Pieces that one straight way may have to pass.
constexpr int kMostStops = 12;
/// One answer may take so many pairs of pieces and facets of their differences.
constexpr std::size_t kMostPairs = 1 << 10;
constexpr std::int64_t kMostFacets = 1 << 14;

/// Tells whether a piece is through another one by a good part of its extent along the way out. A thin plate is so deep
/// long before its radius counts.
bool is_deep_for_thin(const PiecesAnswer& answer, double radius) {
  if (answer.depth.depth < kResting * radius) return false;
  const auto thicker = [&](const PosedShape& piece) {
    return answer.depth.depth < kDeepForThin * reach_along(piece, piece, answer.depth.normal);
  };
  return !thicker(answer.a) || !thicker(answer.b);
}

bool all_polytopes(const std::vector<PosedShape>& pieces) {
  return std::all_of(pieces.begin(), pieces.end(),
                     [](const PosedShape& piece) { return piece.shape->polytope() != nullptr; });
}

PosedShape moved_by(const PosedShape& piece, const Vec3& way) {
  return {piece.shape, Pose::from_trusted_matrix(piece.pose.rotation(), piece.pose.translation() + way)};
}

}  // namespace

void DeepUnion::clear() {
  deepest_pair_.depth.depth = 0;
  deepest_left_ = 0;
  own_ways_.clear();
  solid_.clear();
  thin_.clear();
}

void DeepUnion::add(const PiecesAnswer& answer, const ContactManifold& left) {
  const PenetrationDepth& depth = answer.depth;
  if (depth.contact != ContactClass::overlapping) return;
  own_ways_.emplace_back(depth.depth, depth.normal);
  if (depth.depth > deepest_pair_.depth.depth) deepest_pair_ = answer;
  if (left.count > 0) deepest_left_ = std::max(deepest_left_, detail::deepest_of(left));
  const double radius = std::min(bounding_radius(*answer.a.shape), bounding_radius(*answer.b.shape));
  const bool deep = depth.depth >= kDeep * radius;
  if (deep) solid_.add(depth, left);
  if (deep || is_deep_for_thin(answer, radius)) thin_.add(depth, left);
}

void DeepUnion::DeepPairs::add(const PenetrationDepth& depth, const ContactManifold& left) {
  deepest = std::max(deepest, depth.depth);
  if (left.count == 0) return;
  // A facet that stands in for a covered one is far, and the pieces around it were not looked at.
  torn = torn || depth.normal.dot(left.normal) < kTogether ||
         std::any_of(normals.begin(), normals.end(),
                     [&](const Vec3& normal) { return normal.dot(left.normal) < kTogether; });
  normals.push_back(left.normal);
}

bool DeepUnion::needed() const {
  return solid_.need_a_way() || (solid_.deepest > 0 && deepest_left_ > kShort * deepest_pair_.depth.depth);
}

bool DeepUnion::needed_in_step(double way, std::size_t num_pairs) const {
  if (solid_.need_a_way()) return true;
  return thin_.need_a_way() && num_pairs <= kFewPairs && way <= kHeld * thin_.deepest;
}

bool DeepUnion::collect(double reach, NearSides& near) {
  if (!near.collect(reach, a_, b_)) return false;
  for (Side* side : {&a_, &b_}) {
    side->boxes.clear();
    for (const PosedShape& piece : side->posed) {
      const detail::Box box = detail::bounding_box(piece);
      side->boxes.push_back({box.low, box.high});
    }
  }
  return true;
}

std::optional<PosedShape> DeepUnion::still_in(std::size_t i, std::size_t j, const Vec3& way, Scratch& scratch) const {
  const Box &box_a = a_.boxes[i], &box_b = b_.boxes[j];
  if ((box_a.low + way - box_b.high).maxCoeff() > 0 || (box_b.low - way - box_a.high).maxCoeff() > 0) return {};
  const PosedShape moved = moved_by(a_.posed[i], way);
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  settings.beyond = 0;
  settings.contact_tolerance = seam_slack(moved, b_.posed[j], pose_rounding_);
  const PenetrationDepth left = penetration_depth(moved, b_.posed[j], scratch, settings);
  if (left.contact != ContactClass::overlapping || left.depth <= settings.contact_tolerance) return {};
  return moved;
}

bool DeepUnion::deepest_pair_leads_out(Scratch& scratch) const {
  const Vec3 way = deepest_pair_.depth.depth * deepest_pair_.depth.normal;
  for (std::size_t i = 0; i < a_.posed.size(); ++i) {
    for (std::size_t j = 0; j < b_.posed.size(); ++j) {
      if (a_.numbers[i] == deepest_pair_.piece_a && b_.numbers[j] == deepest_pair_.piece_b) continue;
      if (still_in(i, j, way, scratch)) return false;
    }
  }
  return true;
}

std::optional<DeepUnion::Exit> DeepUnion::exit_along(const Vec3& n, double limit, Scratch& scratch) const {
  Exit exit;
  exit.along = n;
  exit.length = deepest_pair_.depth.depth;
  const std::size_t count_b = b_.posed.size();
  const std::size_t count = a_.posed.size() * count_b;
  // Pairs are asked in turn, until all of them have been asked at one place.
  int stops = 0;
  for (std::size_t k = 0, free = 0; free < count; k = k + 1 < count ? k + 1 : 0) {
    const std::size_t i = k / count_b;
    const std::size_t j = k % count_b;
    ++free;
    const auto moved = still_in(i, j, exit.length * n, scratch);
    if (!moved) continue;
    const auto onwards = directional_depth(*moved, b_.posed[j], n, scratch);
    if (!onwards || onwards.value().contact != ContactClass::overlapping || ++stops > kMostStops) return std::nullopt;
    exit.length += onwards.value().upper;
    if (exit.length > limit) return std::nullopt;
    exit.a = i;
    exit.b = j;
    exit.facet = onwards.value().normal;
    free = 1;
  }
  return stops > 0 ? std::optional<Exit>(exit) : std::nullopt;
}

std::optional<DeepUnion::Exit> DeepUnion::short_exit(const Vec3& back, const Vec3& last, Scratch& scratch) {
  const double least = deepest_pair_.depth.depth;
  std::optional<Exit> best;
  const auto offer = [&](const Vec3& n) {
    if (best && best->length <= kShortest * least) return;
    const double length = n.norm();
    if (!(length > 0) || !std::isfinite(length)) return;
    auto exit = exit_along(n / length, best ? best->length : kShort * least, scratch);
    if (!exit) return;
    best = exit;
    // The way straight off the facet that parts last may be shorter still.
    if (auto turned = exit_along(exit->facet, exit->length, scratch)) best = turned;
  };
  offer(last);
  std::stable_sort(own_ways_.begin(), own_ways_.end(),
                   [](const OwnWay& x, const OwnWay& y) { return x.first > y.first; });
  const std::size_t count = std::min(own_ways_.size(), kMostOwnWays);
  for (std::size_t i = 0; i < count; ++i) offer(own_ways_[i].second);
  for (std::size_t i = 1; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      offer(own_ways_[i].first * own_ways_[i].second + own_ways_[k].first * own_ways_[k].second);
    }
  }
  offer(back);
  return best;
}

bool DeepUnion::lead_out(const Exit& exit, double threshold, const DeepBuffers& buffers, Way& way) const {
  const PosedShape& a = a_.posed[exit.a];
  const PosedShape& b = b_.posed[exit.b];
  const Vec3 by = exit.length * exit.along;
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  PenetrationDepth there = penetration_depth(moved_by(a, by), b, buffers.scratch, settings);
  there.contact = ContactClass::overlapping;
  there.normal = exit.along;
  there.depth = exit.length;
  there.distance = 0;
  there.witness_a = there.witness_b - by;
  way.points = contact_manifold(a, b, there, threshold, buffers.manifold, DeepestPoint::as_lifted);
  way.piece_a = a_.numbers[exit.a];
  way.piece_b = b_.numbers[exit.b];
  return way.points.count > 0;
}

DeepUnion::Outcome DeepUnion::find_way(const Question& question, const DeepBuffers& buffers, Vec3& last, Way& way) {
  pose_rounding_ = question.pose_rounding;
  if (!collect(kShort * deepest_pair_.depth.depth, question.near)) return Outcome::unsupported;
  if (deepest_pair_leads_out(buffers.scratch)) {
    way.points = contact_manifold(deepest_pair_.a, deepest_pair_.b, deepest_pair_.depth, question.threshold,
                                  buffers.manifold, DeepestPoint::as_lifted);
    way.piece_a = deepest_pair_.piece_a;
    way.piece_b = deepest_pair_.piece_b;
    last = deepest_pair_.depth.normal;
    return Outcome::found;
  }
  const bool few = a_.posed.size() * b_.posed.size() <= kMostPairs;
  if (const auto exit = few ? short_exit(question.back, last, buffers.scratch) : std::nullopt;
      exit && lead_out(*exit, question.threshold, buffers, way)) {
    last = exit->along;
    return Outcome::nearly;
  }
  // A way of length d meets no piece that is farther than d from the other body now.
  for (double reach = 2 * thin_.deepest;;) {
    if (!collect(reach, question.near)) return Outcome::unsupported;
    if (a_.posed.size() * b_.posed.size() > kMostPairs) return Outcome::over_budget;
    UnionExit::Way shortest;
    switch (buffers.exit.find(a_.posed, b_.posed, {kMostFacets, question.pose_rounding}, buffers.scratch, shortest)) {
      case UnionExit::Outcome::over_budget:
        return Outcome::over_budget;
      case UnionExit::Outcome::apart:
        return Outcome::apart;
      case UnionExit::Outcome::found:
        break;
    }
    const double length = shortest.by.norm();
    if (!(length > 0)) return Outcome::apart;
    if (length > reach) {
      reach = 2 * length;
      continue;
    }
    const double margins = a_.posed[shortest.a].shape->margin() + b_.posed[shortest.b].shape->margin();
    last = shortest.by / length;
    Exit exit{last, length + margins, shortest.a, shortest.b, last};
    const bool polytopes = all_polytopes(a_.posed) && all_polytopes(b_.posed);
    // A way between smooth pieces was found for polytopes inside of them.
    constexpr double kAnyLength = std::numeric_limits<double>::infinity();
    if (const auto whole = polytopes ? std::nullopt : exit_along(last, kAnyLength, buffers.scratch)) exit = *whole;
    if (!lead_out(exit, question.threshold, buffers, way)) return Outcome::apart;
    return polytopes ? Outcome::found : Outcome::nearly;
  }
}

}  // namespace pd
