#include "compound/part_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "depth/pair/canonical_order.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/core_radius.hpp"

namespace pd::detail {

namespace {

double outwards(double x, double magnitude) { return x + 8 * 0x1p-52 * magnitude; }

Box whole(const std::vector<Box>& boxes) {
  Box box = boxes.front();
  for (const Box& b : boxes) {
    box.low = box.low.cwiseMin(b.low);
    box.high = box.high.cwiseMax(b.high);
  }
  return box;
}

/// At most the distance of two bodies in these boxes; negative when the boxes overlap, 0 when they touch.
double box_gap(const Box& a, const Box& b) {
  const Vec3 gap = (b.low - a.high).cwiseMax(a.low - b.high);
  const double largest = gap.maxCoeff();
  return largest <= 0 ? largest : gap.cwiseMax(Vec3::Zero()).stableNorm() * (1 - 0x1p-40);
}

/// The parts ordered by content; `order` tells which of the given ones each is, the first of equals first.
std::vector<PosedShape> in_canonical_order(const std::vector<PosedShape>& parts, std::vector<std::int32_t>& order) {
  order.resize(parts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    return compare_bodies(parts[static_cast<std::size_t>(i)], parts[static_cast<std::size_t>(j)]) < 0;
  });
  std::vector<PosedShape> sorted;
  sorted.reserve(parts.size());
  for (const std::int32_t i : order) sorted.push_back(parts[static_cast<std::size_t>(i)]);
  return sorted;
}

}  // namespace

bool UnionPair::exchange_to_canonical_order() {
  int order = a.size() < b.size() ? -1 : static_cast<int>(a.size() > b.size());
  for (std::size_t i = 0; order == 0 && i < a.size(); ++i) order = compare_bodies(a[i], b[i]);
  if (order <= 0) return false;
  std::swap(a, b);
  std::swap(boxes_a, boxes_b);
  std::swap(order_a, order_b);
  return true;
}

Box bounding_box(const PosedShape& part) {
  Vec3 low, high;
  const Vec3& t = part.pose.translation();
  double size = t.cwiseAbs().maxCoeff();
  if (const ConvexPolytope* const body = part.shape->polytope()) {
    low = Vec3::Constant(HUGE_VAL);
    high = -low;
    for (int v = 0; v < body->num_vertices(); ++v) {
      const Vec3 x = part.pose.apply(body->vertex(v));
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    size += 4 * body->radius();
  } else {
    const double radius = detail::core_radius(part.shape->core()) * (1 + 0x1p-40);
    low = t.array() - radius;
    high = t.array() + radius;
    size += radius;
  }
  const double margin = part.shape->margin();
  for (int i = 0; i < 3; ++i) {
    high[i] = outwards(high[i] + margin, size + margin);
    low[i] = -outwards(margin - low[i], size + margin);
  }
  return {low, high};
}

Expected<UnionPair> UnionPair::pose(const PosedCompound& a, const PosedCompound& b) {
  auto parts_a = a.body->posed(a.pose);
  if (!parts_a) return Error{parts_a.error().code, parts_a.error().message, "pose_a"};
  auto parts_b = b.body->posed(b.pose);
  if (!parts_b) return Error{parts_b.error().code, parts_b.error().message, "pose_b"};
  UnionPair pair;
  pair.a = in_canonical_order(*parts_a, pair.order_a);
  pair.b = in_canonical_order(*parts_b, pair.order_b);
  for (const PosedShape& part : pair.a) pair.boxes_a.push_back(bounding_box(part));
  for (const PosedShape& part : pair.b) pair.boxes_b.push_back(bounding_box(part));
  const Box box_a = whole(pair.boxes_a), box_b = whole(pair.boxes_b);
  pair.size = std::max((box_b.high - box_a.low).cwiseAbs().maxCoeff(), (box_a.high - box_b.low).cwiseAbs().maxCoeff());
  const auto polytope = [](const PosedShape& part) { return part.shape->polytope() && part.shape->margin() == 0; };
  pair.polytopes =
      std::all_of(pair.a.begin(), pair.a.end(), polytope) && std::all_of(pair.b.begin(), pair.b.end(), polytope);
  return pair;
}

double UnionPair::box_exit() const {
  const Box box_a = whole(boxes_a), box_b = whole(boxes_b);
  return std::max(0.0, std::min((box_b.high - box_a.low).minCoeff(), (box_a.high - box_b.low).minCoeff()));
}

int UnionPair::scale_exponent() const {
  return size > 0x1p100 || size < 0x1p-100 ? std::ilogb(std::max(size, std::numeric_limits<double>::min())) : 0;
}

PairsResult classify_pairs(const UnionPair& pair, Scratch& scratch, double delta, UnionStatistics& work) {
  struct Candidate {
    double gap;
    std::int32_t a, b;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < pair.a.size(); ++i) {
    for (std::size_t j = 0; j < pair.b.size(); ++j) {
      candidates.push_back(
          {box_gap(pair.boxes_a[i], pair.boxes_b[j]), static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
    // Pairs whose boxes meet are all asked, in their own order; the others by their gap.
    const double gx = std::max(x.gap, 0.0), gy = std::max(y.gap, 0.0);
    return gx != gy ? gx < gy : (x.a != y.a ? x.a < y.a : x.b < y.b);
  });
  PairsResult result;
  Statistics statistics;
  bool first = true;
  for (const Candidate& candidate : candidates) {
    if (!first && (result.contact != ContactClass::separated ? candidate.gap > 0
                                                             : candidate.gap > result.nearest.distance_upper)) {
      break;
    }
    ++work.pairs;
    DepthSettings settings;  // the class is exact in any case
    const PosedShape &a = pair.a[static_cast<std::size_t>(candidate.a)],
                     &b = pair.b[static_cast<std::size_t>(candidate.b)];
    if (!a.shape->polytope() || !b.shape->polytope()) settings.delta = delta;
    const PenetrationDepth answer = penetration_depth(a, b, scratch, settings);
    statistics.support_calls += answer.statistics.support_calls;
    statistics.facets_visited += answer.statistics.facets_visited;
    statistics.exact_signs += answer.statistics.exact_signs;
    const bool better = first || answer.contact > result.contact ||
                        (answer.contact == result.contact &&
                         (answer.contact == ContactClass::overlapping ? answer.lower > result.nearest.lower
                                                                      : answer.distance < result.nearest.distance));
    if (better) {
      result.contact = answer.contact;
      result.nearest = answer;
      result.part_a = candidate.a;
      result.part_b = candidate.b;
    }
    first = false;
  }
  const PosedShape &a = pair.a[static_cast<std::size_t>(result.part_a)],
                   &b = pair.b[static_cast<std::size_t>(result.part_b)];
  DepthSettings settings;
  settings.bracket = Bracket::tightest;
  if (!a.shape->polytope() || !b.shape->polytope()) settings.delta = delta;
  result.nearest = penetration_depth(a, b, scratch, settings);
  result.nearest.statistics = statistics;
  return result;
}

}  // namespace pd::detail
