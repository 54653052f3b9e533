#include "compound/part_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "compound/union_memory.hpp"
#include "depth/pair/canonical_order.hpp"
#include "numeric/length.hpp"
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
  return largest <= 0 ? largest : length(Vec3(gap.cwiseMax(Vec3::Zero()))) * (1 - 0x1p-40);
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

namespace {

struct Candidate {
  double gap;
  std::int32_t a, b;
};

/// All pairs of parts: those whose boxes meet in their own order, the others by their gap.
std::vector<Candidate> pairs_by_gap(const UnionPair& pair) {
  std::vector<Candidate> candidates;
  candidates.reserve(pair.a.size() * pair.b.size());
  for (std::size_t i = 0; i < pair.a.size(); ++i) {
    for (std::size_t j = 0; j < pair.b.size(); ++j) {
      candidates.push_back(
          {box_gap(pair.boxes_a[i], pair.boxes_b[j]), static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
    const double gx = std::max(x.gap, 0.0), gy = std::max(y.gap, 0.0);
    return gx != gy ? gx < gy : (x.a != y.a ? x.a < y.a : x.b < y.b);
  });
  return candidates;
}

/// Asks pairs one by one and keeps the one that tells most.
class PairsSearch {
 public:
  PairsSearch(const UnionPair& pair, Scratch& scratch, double delta, UnionStatistics& work)
      : pair_(pair), scratch_(scratch), delta_(delta), work_(work) {}

  [[nodiscard]] const PairsResult& result() const { return result_; }

  /// Whether a pair whose boxes are so far apart cannot say more.
  [[nodiscard]] bool settled(double gap) const {
    return asked_ && (result_.contact != ContactClass::separated ? gap > 0 : gap > result_.nearest.distance_upper);
  }

  void ask(std::int32_t i, std::int32_t j) {
    ++work_.pairs;
    DepthSettings settings = settings_of(i, j);  // the class is exact in any case
    if (asked_ && result_.contact == ContactClass::separated) settings.beyond = result_.nearest.distance_upper;
    const PenetrationDepth answer = depth_of(i, j, settings);
    statistics_.support_calls += answer.statistics.support_calls;
    statistics_.facets_visited += answer.statistics.facets_visited;
    statistics_.exact_signs += answer.statistics.exact_signs;
    const bool better = !asked_ || answer.contact > result_.contact ||
                        (answer.contact == result_.contact &&
                         (answer.contact == ContactClass::overlapping ? answer.lower > result_.nearest.lower
                                                                      : answer.distance < result_.nearest.distance));
    asked_ = true;
    if (!better) return;
    result_.contact = answer.contact;
    result_.nearest = answer;
    result_.part_a = i;
    result_.part_b = j;
  }

  PairsResult finish() {
    DepthSettings settings = settings_of(result_.part_a, result_.part_b);
    settings.bracket = Bracket::tightest;
    result_.nearest = depth_of(result_.part_a, result_.part_b, settings);
    result_.nearest.statistics = statistics_;
    return std::move(result_);
  }

 private:
  [[nodiscard]] DepthSettings settings_of(std::int32_t i, std::int32_t j) const {
    DepthSettings settings;
    const bool polytopes = pair_.a[static_cast<std::size_t>(i)].shape->polytope() != nullptr &&
                           pair_.b[static_cast<std::size_t>(j)].shape->polytope() != nullptr;
    if (!polytopes) settings.delta = delta_;
    return settings;
  }
  [[nodiscard]] PenetrationDepth depth_of(std::int32_t i, std::int32_t j, const DepthSettings& settings) {
    return penetration_depth(pair_.a[static_cast<std::size_t>(i)], pair_.b[static_cast<std::size_t>(j)], scratch_,
                             settings);
  }

  const UnionPair& pair_;
  Scratch& scratch_;
  double delta_;
  UnionStatistics& work_;
  PairsResult result_;
  Statistics statistics_;
  bool asked_ = false;
};

/// Whether A moved by `way` is free of B, by a gap that no rounding closes.
bool frees(const UnionPair& pair, const Vec3& way, Scratch& scratch) {
  DepthSettings settings;
  settings.bracket = Bracket::certified;
  settings.beyond = 0x1p-44 * (pair.size + way.norm());
  for (std::size_t i = 0; i < pair.a.size(); ++i) {
    const Box moved{pair.boxes_a[i].low + way, pair.boxes_a[i].high + way};
    const PosedShape a{pair.a[i].shape,
                       Pose::from_trusted_matrix(pair.a[i].pose.rotation(), pair.a[i].pose.translation() + way)};
    for (std::size_t j = 0; j < pair.b.size(); ++j) {
      if (box_gap(moved, pair.boxes_b[j]) > settings.beyond) continue;
      if (!(penetration_depth(a, pair.b[j], scratch, settings).distance_lower > settings.beyond)) return false;
    }
  }
  return true;
}

}  // namespace

PairsResult classify_pairs(const UnionPair& pair, Scratch& scratch, double delta, const UnionMemory* memory,
                           UnionStatistics& work) {
  PairsSearch search(pair, scratch, delta, work);
  const auto told = memory != nullptr ? memory->telling_pair() : std::nullopt;
  const auto told_a = told ? static_cast<std::int32_t>(told->a) : -1;
  const auto told_b = told ? static_cast<std::int32_t>(told->b) : -1;
  if (told) search.ask(told_a, told_b);
  if (!(told && search.result().contact == ContactClass::overlapping && pair.polytopes)) {
    for (const Candidate& candidate : pairs_by_gap(pair)) {
      if (search.settled(candidate.gap)) break;
      if (candidate.a != told_a || candidate.b != told_b) search.ask(candidate.a, candidate.b);
    }
  }
  PairsResult result = search.finish();
  result.remembered = told && result.part_a == told_a && result.part_b == told_b;
  return result;
}

double free_reach(const UnionPair& pair, const UnionMemory& memory, Scratch& scratch) {
  const double box_exit = pair.box_exit();
  const std::optional<Vec3> last = memory.way();
  if (!last) return box_exit;
  // The bodies have moved a little since: a little farther may be free.
  for (const double longer : {0x1p-6, 0x1p-3}) {
    const Vec3 way = *last * (1 + longer);
    const double length = way.norm() * (1 + 0x1p-40);
    if (!(length < box_exit)) break;
    if (frees(pair, way, scratch)) return length;
  }
  return box_exit;
}

}  // namespace pd::detail
