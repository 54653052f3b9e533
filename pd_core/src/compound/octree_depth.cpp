#include "compound/octree_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "compound/facets_answer.hpp"
#include "compound/part_bounds.hpp"
#include "compound/union_boundary.hpp"
#include "numeric/root_sum.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::detail {

namespace {

/// Pairs up to this many are tried together where none covers a cell alone.
constexpr std::size_t kMaxTriedTogether = 12;
/// Times that the polytopes in and around the parts are refined: the first suffice in most cases, and each takes two
/// exact answers.
constexpr int kMostBounds = 8;
/// After so many, small parts are looked at along all directions, too.
constexpr int kCoarseBounds = 3;
/// A round that leaves more than this share of the bracket open was of little use.
constexpr double kStalled = 0.75;
/// Of exact searches for those: cells looked at and polygons cut, each some microseconds.
constexpr std::int64_t kMostBoundWork = 20'000;
/// Pairs that the octree may ask: each takes 5 to 50 microseconds.
constexpr std::int64_t kMostPairs = 8192;
/// The same for polytopes, which are answered so only where the octree is asked for: exact answers take less.
constexpr std::int64_t kMostPolytopes = std::int64_t{1} << 20;

/// One pair of parts; `piece` is its P_ij among the built differences, -1 when it was not built or is flat.
struct PartPair {
  std::int32_t a;
  std::int32_t b;
  std::ptrdiff_t piece = -1;
};

/// A cube of translations. `pairs` are those whose P_ij may meet it.
struct Cell {
  double key;  ///< no point of the cell is nearer to the origin
  std::int64_t order;
  Vec3 centre;
  double half;
  std::vector<std::int32_t> pairs;
};
struct Later {
  bool operator()(const Cell& x, const Cell& y) const { return x.key != y.key ? x.key > y.key : x.order > y.order; }
};

class Octree {
 public:
  Octree(const UnionPair& pair, Scratch& scratch, const UnionSettings& settings, UnionDepth& out)
      : pair_(pair), scratch_(scratch), settings_(settings), out_(out) {
    for (std::size_t i = 0; i < pair.a.size(); ++i) {
      for (std::size_t j = 0; j < pair.b.size(); ++j) {
        pairs_.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
      }
    }
  }

  void run(const PairsResult& deepest) {
    const double exit = pair_.box_exit();
    build_differences(exit);
    start_from_boxes();
    try_placement(deepest.nearest.translation, all_pairs());
    double known_lower = deepest.nearest.lower;
    if (!pair_.polytopes) known_lower = bound_by_polytopes(known_lower);
    if (upper_ <= (1 + settings_.delta) * known_lower) {
      finish(std::min(known_lower, upper_));
      return;
    }
    const double smallest = settings_.resolution > 0 ? settings_.resolution : 0x1p-20 * pair_.size;

    std::priority_queue<Cell, std::vector<Cell>, Later> queue;
    std::int64_t order = 0;
    const auto wait = [&](const Vec3& centre, double half, std::vector<std::int32_t> pairs) {
      const Vec3 nearest = (centre.cwiseAbs().array() - half).max(0.0).matrix();
      const double key = std::max(known_lower, nearest.norm() * (1 - 0x1p-48));
      const double farthest = (centre.cwiseAbs().array() + half).matrix().norm() * (1 + 0x1p-48);
      if (key < upper_ && farthest > known_lower) queue.push({key, order++, centre, half, std::move(pairs)});
    };
    // No nearer placement lies outside the ball of the first upper bound.
    wait(Vec3::Zero(), exit, all_pairs());
    double unresolved = HUGE_VAL;
    double lower = upper_;
    const std::int64_t most_pairs = out_.work.pairs + (pair_.polytopes ? kMostPolytopes : kMostPairs);
    while (!queue.empty()) {
      lower = std::min({queue.top().key, unresolved, upper_});
      if (upper_ <= (1 + settings_.delta) * lower || unresolved <= queue.top().key) break;
      if (out_.work.pairs >= most_pairs) break;
      Cell cell = queue.top();
      queue.pop();
      lower = upper_;
      ++out_.work.cells;
      if (covered(cell)) continue;
      if (2 * cell.half <= smallest) {
        unresolved = std::min(unresolved, cell.key);
        continue;
      }
      const double quarter = cell.half / 2;
      for (int child = 0; child < 8; ++child) {
        const Vec3 step((child & 1) != 0 ? quarter : -quarter, (child & 2) != 0 ? quarter : -quarter,
                        (child & 4) != 0 ? quarter : -quarter);
        wait(cell.centre + step, quarter, cell.pairs);
      }
    }
    if (queue.empty()) lower = std::min(unresolved, upper_);
    finish(std::max(std::min(lower, upper_), known_lower));
  }

 private:
  [[nodiscard]] std::vector<std::int32_t> all_pairs() const {
    std::vector<std::int32_t> all(pairs_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int32_t>(i);
    return all;
  }

  /// The exact depths of unions of polytopes inside and around the parts are bounds of the depth. They are made more
  /// like the parts where they were nearest, until the bounds meet.
  /// @return the better lower bound; a better placement is taken over.
  double bound_by_polytopes(double known_lower) {
    // Small parts begin with few directions, since those that matter are added below. The depth is guessed from the
    // placement known so far.
    double gap = 4 * settings_.delta * upper_;
    std::vector<PartBounds> of_a, of_b;
    const auto sample = [&] {
      of_a.clear();
      of_b.clear();
      for (const PosedShape& part : pair_.a) of_a.emplace_back(part, gap);
      for (const PosedShape& part : pair_.b) of_b.emplace_back(part, gap);
    };
    sample();
    std::int64_t work = 0;
    double outer_reach = HUGE_VAL;
    const double air = 0x1p-40 * pair_.size;  // corners of the polytopes are rounded
    double last_open = HUGE_VAL;
    std::vector<Vec3> looked;
    const auto look_along = [&](const Vec3& unit) {
      looked.push_back(unit);
      for (PartBounds& part : of_a) part.look_along(-unit);
      for (PartBounds& part : of_b) part.look_along(unit);
    };
    for (int round = 0; round < kMostBounds && work <= kMostBoundWork; ++round) {
      // A placement that is free for the parts is free for what lies in them, and the unions around the parts are no
      // less deep than the parts. They shrink by every direction.
      const std::optional<UnionDepth> inner = depth_between(of_a, of_b, &PartBounds::inner, 0, upper_ + air);
      if (inner) known_lower = std::max(known_lower, inner->lower);
      const std::optional<UnionDepth> outer =
          inner ? depth_between(of_a, of_b, &PartBounds::outer, known_lower, outer_reach) : std::nullopt;
      const bool overlap = inner && outer;
      for (const std::optional<UnionDepth>& bound : {inner, outer}) {
        if (!bound) continue;
        work += bound->work.cells + bound->work.polygons + bound->work.cuts;
        out_.work.cells += bound->work.cells;
        out_.work.facets += bound->work.facets;
        out_.work.polygons += bound->work.polygons;
        out_.work.cuts += bound->work.cuts;
      }
      if (!overlap && gap == 0) return known_lower;
      if (overlap) {
        outer_reach = outer->upper + air;
        accept(outer->translation);
        try_placement(inner->translation, all_pairs());
        if (upper_ <= (1 + settings_.delta) * known_lower) break;
      }
      if (!overlap || round == kCoarseBounds) {
        gap = 0;
        outer_reach = HUGE_VAL;
        sample();
        for (const Vec3& unit : std::exchange(looked, {})) look_along(unit);
        if (!overlap) continue;
      }
      // Refining that has stopped to help is left to the octree.
      const double open = upper_ - known_lower;
      if (round > kCoarseBounds && open > kStalled * last_open) break;
      last_open = open;
      for (const UnionDepth* bound : {&*inner, &*outer}) {
        look_along(bound->normal);
        look_along(bound->translation.normalized());
        // In a notch between several P_ij the facets of all of them hold the answer back.
        for (std::int32_t p = 0; p < static_cast<std::int32_t>(pairs_.size()); ++p) {
          double slack = 0;
          const PenetrationDepth answer = moved_answer(p, bound->translation, slack);
          if (std::abs(answer.signed_distance()) <= 2 * open) look_along(answer.normal);
        }
      }
    }
    if (translation_.norm() > known_lower) slide(all_pairs());
    return known_lower;
  }

  /// Returns the depth of the polytopes in the parts, or of those around them; nothing unless the interiors of both
  /// unions meet.
  /// @param known_lower  the depth is no less
  /// @param reach        a placement at this distance is free
  std::optional<UnionDepth> depth_between(const std::vector<PartBounds>& of_a, const std::vector<PartBounds>& of_b,
                                          std::optional<Compound::Part> (PartBounds::*polytope)() const,
                                          double known_lower, double reach) {
    std::optional<Compound> bodies[2];
    for (const auto& [body, parts] : {std::pair{&bodies[0], &of_a}, std::pair{&bodies[1], &of_b}}) {
      std::vector<Compound::Part> polytopes;
      for (const PartBounds& part : *parts) {
        std::optional<Compound::Part> bound = (part.*polytope)();
        if (!bound) return std::nullopt;
        polytopes.push_back(*std::move(bound));
      }
      body->emplace(*Compound::from_parts(std::move(polytopes)));
    }
    const Expected<UnionPair> pair = UnionPair::pose({&*bodies[0], Pose()}, {&*bodies[1], Pose()});
    if (!pair) return std::nullopt;
    UnionDepth out;
    const PairsResult pairs = classify_pairs(*pair, scratch_, settings_.delta, nullptr, out.work);
    if (pairs.contact != ContactClass::overlapping) return std::nullopt;
    UnionSettings exactly;
    exactly.max_facets = settings_.max_facets;
    FacetsAnswer answer(*pair, exactly, out.work);
    if (answer.solve_overlapping(std::max(known_lower, pairs.nearest.lower), std::min(reach, pair->box_exit()), nullptr,
                                 out)) {
      return std::nullopt;
    }
    return out;
  }

  void build_differences(double reach) {
    if (!pair_.polytopes) return;
    const int exponent = pair_.scale_exponent();
    // Cells reach past the ball by the diagonal of the first cube.
    auto built = PartDifferences::build(pair_.a, pair_.boxes_a, pair_.b, pair_.boxes_b, exponent,
                                        std::ldexp(2 * reach, -exponent), settings_.max_facets);
    if (!built) return;  // then cells are covered by one part or split
    differences_.emplace(*std::move(built));
    boundary_.emplace(*differences_);
    for (std::size_t k = 0; k < differences_->pieces().size(); ++k) {
      const PartDifference& piece = differences_->pieces()[k];
      pairs_[static_cast<std::size_t>(piece.part_a) * pair_.b.size() + static_cast<std::size_t>(piece.part_b)].piece =
          static_cast<std::ptrdiff_t>(k);
      out_.work.facets += static_cast<std::int64_t>(piece.facets.size());
    }
  }

  [[nodiscard]] const PosedShape& part_a(std::int32_t p) const {
    return pair_.a[static_cast<std::size_t>(pairs_[static_cast<std::size_t>(p)].a)];
  }
  [[nodiscard]] const PosedShape& part_b(std::int32_t p) const {
    return pair_.b[static_cast<std::size_t>(pairs_[static_cast<std::size_t>(p)].b)];
  }

  /// The pair's answer after A was moved by t, and a bound of what rounding the move changes.
  PenetrationDepth moved_answer(std::int32_t p, const Vec3& t, double& slack) {
    const PosedShape& a = part_a(p);
    const Vec3 translation = a.pose.translation() + t;
    slack = 2 * kUnitRoundoff * translation.cwiseAbs().sum();
    const Pose pose = a.pose.is_quaternion() ? *Pose::from_quaternion(a.pose.quaternion_wxyz(), translation)
                                             : Pose::from_trusted_matrix(a.pose.rotation(), translation);
    DepthSettings rough;
    rough.bracket = Bracket::certified;
    if (!a.shape->polytope() || !part_b(p).shape->polytope()) rough.delta = 0.01;
    ++out_.work.pairs;
    return penetration_depth({a.shape, pose}, part_b(p), scratch_, rough);
  }

  /// Whether the cell holds no free placement; drops pairs that do not meet it, and tries placements near its centre.
  bool covered(Cell& cell) {
    const double radius = cell.half * (std::sqrt(3.0) * (1 + 0x1p-40));
    std::vector<std::int32_t> meeting;
    double deepest = -1;
    Vec3 way_out = Vec3::Zero();
    for (const std::int32_t p : cell.pairs) {
      double slack = 0;
      const PenetrationDepth answer = moved_answer(p, cell.centre, slack);
      if (answer.contact == ContactClass::overlapping && answer.lower > radius + slack) return true;
      if (answer.contact == ContactClass::separated && answer.distance_lower > radius + slack) continue;
      meeting.push_back(p);
      if (answer.contact == ContactClass::overlapping && answer.lower > deepest) {
        deepest = answer.lower;
        way_out = answer.translation + 8 * slack * answer.normal;
      }
    }
    cell.pairs = std::move(meeting);
    if (deepest < 0) {
      if (cell.pairs.empty()) {
        // Free as a whole: nothing in it is nearer than this.
        const Vec3 least = cell.centre.array() - cell.half, most = cell.centre.array() + cell.half;
        try_placement(least.cwiseMax(Vec3::Zero()) + most.cwiseMin(Vec3::Zero()), cell.pairs);
        return true;
      }
      try_placement(cell.centre, cell.pairs);
    } else {
      if (covered_by_few(cell)) return true;
      const Vec3 candidate = cell.centre + way_out;
      if (candidate.norm() < upper_) try_placement(candidate, all_pairs());
    }
    return false;
  }

  /// Covered by the union of the P_ij that meet it: its centre is inside and no free piece of their boundary meets it.
  bool covered_by_few(const Cell& cell) {
    if (!boundary_ || cell.pairs.size() < 2 || cell.pairs.size() > kMaxTriedTogether) return false;
    std::vector<std::size_t> pieces;
    for (const std::int32_t p : cell.pairs) {
      const std::ptrdiff_t piece = pairs_[static_cast<std::size_t>(p)].piece;
      if (piece >= 0) pieces.push_back(static_cast<std::size_t>(piece));
    }
    const double scale = std::ldexp(1.0, -pair_.scale_exponent());
    const Vec3 low = (cell.centre.array() - cell.half).matrix() * scale;
    const Vec3 high = (cell.centre.array() + cell.half).matrix() * scale;
    return !boundary_->free_piece_near(low, high, pieces);
  }

  /// A placement far enough along an axis is free.
  void start_from_boxes() {
    const double exit = pair_.box_exit() * (1 + 0x1p-40);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        Vec3 t = Vec3::Zero();
        t[axis] = sign * exit;
        if (exit < upper_) try_placement(t, all_pairs());
      }
    }
  }

  /// Takes t as the answer so far when it is free and nearer, then slides it towards the origin until it touches.
  void try_placement(const Vec3& t, const std::vector<std::int32_t>& pairs) {
    if (!(t.norm() < upper_) || !is_free(t, pairs)) return;
    accept(t);
    slide(all_pairs());
  }

  /// The best placement, towards the origin as far as it is free.
  void slide(const std::vector<std::int32_t>& all) {
    Vec3 x = translation_;
    for (int step = 0; step < 64; ++step) {
      double gap = HUGE_VAL;
      for (const std::int32_t p : all) {
        double slack = 0;
        const PenetrationDepth answer = moved_answer(p, x, slack);
        gap = std::min(gap, answer.contact == ContactClass::separated ? answer.distance_lower - 4 * slack : 0.0);
      }
      const double length = x.norm();
      if (!(gap > 0x1p-44 * pair_.size)) break;
      // No P_ij is nearer than the gap: the way there is free.
      x *= std::max(0.0, 1 - gap / length);
      if (!(x.norm() < length) || !is_free(x, all)) break;
      accept(x);
    }
  }

  void accept(const Vec3& t) {
    const double length = length_rounded_up(t);
    if (length < upper_) {
      upper_ = length;
      translation_ = t;
    }
  }

  /// Outside every P_ij, or on the boundary of one alone: exact for polytopes.
  bool is_free(const Vec3& t, const std::vector<std::int32_t>& pairs) {
    int touched = 0;
    for (const std::int32_t p : pairs) {
      const auto where = point_in_difference(part_a(p), part_b(p), t, scratch_);
      if (!where || *where == ContactClass::overlapping) return false;
      if (*where == ContactClass::touching && ++touched > 1) return false;
    }
    return true;
  }

  void finish(double lower) {
    out_.contact = ContactClass::overlapping;
    out_.lower = lower;
    out_.upper = upper_;
    out_.depth = upper_;
    out_.translation = translation_;
    out_.normal = translation_.normalized();
    out_.distance = out_.distance_lower = out_.distance_upper = 0;
    out_.closed = upper_ <= (1 + settings_.delta) * lower;
    out_.bracket_reached = out_.closed;
    // The pair that holds A back there gives witnesses and features.
    double least = HUGE_VAL;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      double slack = 0;
      const PenetrationDepth answer = moved_answer(static_cast<std::int32_t>(p), translation_, slack);
      const double gap = answer.contact == ContactClass::separated ? answer.distance : 0;
      if (gap >= least) continue;
      least = gap;
      out_.part_a = pairs_[p].a;
      out_.part_b = pairs_[p].b;
      out_.witness_a = answer.witness_a - translation_;
      out_.witness_b = answer.witness_a;
      out_.feature_a = answer.feature_a;
      out_.feature_b = answer.feature_b;
    }
    if (boundary_) {
      out_.work.polygons = boundary_->counts().polygons;
      out_.work.cuts = boundary_->counts().cuts;
    }
  }

  const UnionPair& pair_;
  Scratch& scratch_;
  const UnionSettings& settings_;
  UnionDepth& out_;
  std::vector<PartPair> pairs_;
  std::optional<PartDifferences> differences_;
  std::optional<UnionBoundary> boundary_;
  double upper_ = HUGE_VAL;
  Vec3 translation_ = Vec3::Zero();
};

}  // namespace

Expected<UnionDepth> solve_by_octree(const UnionPair& pair, Scratch& scratch, const UnionSettings& settings) {
  UnionDepth out;
  const PairsResult pairs = classify_pairs(pair, scratch, std::min(settings.delta, 1e-6), nullptr, out.work);
  static_cast<PenetrationDepth&>(out) = pairs.nearest;
  out.part_a = pairs.part_a;
  out.part_b = pairs.part_b;
  if (pair.a.size() == 1 && pair.b.size() == 1) return out;  // one convex pair: its own answer
  ContactClass contact = pairs.contact;
  if (contact == ContactClass::touching && pair.polytopes) {
    std::optional<FacetsAnswer::Where> where;
    const Expected<ContactClass> exact = FacetsAnswer(pair, settings, out.work).class_of_touching(where);
    if (!exact) return exact.error();
    contact = *exact;
  }
  if (contact != ContactClass::overlapping) return out;
  Octree(pair, scratch, settings, out).run(pairs);
  return out;
}

}  // namespace pd::detail
