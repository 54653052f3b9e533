#include "pd/planar/direction_set.hpp"

#include <cassert>
#include <cmath>
#include <string>

#include "planar/difference_state.hpp"
#include "planar/direction_slabs.hpp"
#include "planar/polygon_answer.hpp"

namespace pd {

using detail::BoundaryPoint;
using detail::DirectionSlabs;
using detail::MonotoneBoundary;
using detail::MonotonePiece;
using detail::Place;

struct DirectionSet::State {
  std::shared_ptr<const PolygonDifference::State> difference;
  std::vector<Point2> directions;
  std::vector<DirectionSlabs> slabs;
};

namespace {

/// One placement in the trapezoids of one direction.
class SlabQuery {
 public:
  SlabQuery(const DirectionSlabs& slabs, const Point2& y, std::int64_t& probes)
      : slabs_(slabs), y_(y), probes_(probes), column_(slabs.column(y, probes)) {}

  /// The class; where touching, the place; where overlapping, where the ray along d leaves R first.
  PlanarContact run(std::optional<BoundaryPoint>& found) {
    const auto closed = slabs_.neighbours(y_, column_, true, probes_);
    if (const auto touched = touch(closed)) {
      found = touched;
      return PlanarContact::touching;
    }
    // Now y lies on no piece but, perhaps, inside the chord of an arc, which lies inside R.
    if (!closed.on) {
      const PlanarContact contact =
          contact_beside(column_.on_event ? slabs_.neighbours(y_, column_, false, probes_) : closed, found);
      if (contact != PlanarContact::overlapping || found) return contact;
    }
    found = exit_from(closed.ahead);
    return PlanarContact::overlapping;
  }

 private:
  [[nodiscard]] BoundaryPoint on_edge(const MonotonePiece& piece, int edge) const {
    return {piece.stretch, edge, {Place::Kind::point, detail::BoundaryQuery::point(y_), {}}};
  }
  [[nodiscard]] BoundaryPoint crossing(const MonotonePiece& piece, int edge) const {
    return {piece.stretch, edge, {Place::Kind::line, detail::BoundaryQuery::point(y_), {{0, 0}, d()}}};
  }
  [[nodiscard]] const Point2& d() const { return slabs_.boundary().direction(); }
  [[nodiscard]] MonotoneBoundary::OnArc on_arc(const MonotonePiece& piece) {
    for (int edges = piece.last - piece.first + 1; edges > 0; edges /= 2) ++probes_;
    return slabs_.boundary().arc_at(piece, y_);
  }

  /// Where y lies on an edge or at an end of an arc. (On an arc's other points: contact_beside.)
  std::optional<BoundaryPoint> touch(const DirectionSlabs::Neighbours& closed) {
    if (closed.on) {
      const MonotonePiece& piece = slabs_.piece(closed.ahead);
      if (!piece.arc() || slabs_.starts_at(closed.ahead, column_)) return on_edge(piece, piece.first);
      if (slabs_.ends_at(closed.ahead, column_)) return on_edge(piece, piece.last);
    }
    const std::int32_t edge = slabs_.along_at(y_, column_, probes_);
    if (edge < 0) return std::nullopt;
    const MonotonePiece& piece = slabs_.boundary().along()[static_cast<std::size_t>(edge)];
    return on_edge(piece, piece.first);
  }

  /// The class by the pieces just beyond y's column, none of which holds y. In an ear: with the place where the ray
  /// leaves through the ear's arc, if it does.
  PlanarContact contact_beside(const DirectionSlabs::Neighbours& open, std::optional<BoundaryPoint>& found) {
    const auto on = [&](const MonotonePiece& piece, int edge) {
      found = on_edge(piece, edge);
      return PlanarContact::touching;
    };
    if (open.behind >= 0) {
      const MonotonePiece& piece = slabs_.piece(open.behind);
      if (piece.arc() && !piece.increasing) {  // its ear lies ahead of its chord
        const auto arc = on_arc(piece);
        if (arc.past == 0) return on(piece, arc.edge);
        if (arc.past < 0) {
          found = crossing(piece, arc.edge);
          return PlanarContact::overlapping;
        }
      }
    }
    if (open.ahead < 0) return PlanarContact::separated;
    const MonotonePiece& piece = slabs_.piece(open.ahead);
    if (!piece.increasing) return PlanarContact::overlapping;
    if (!piece.arc()) return PlanarContact::separated;
    const auto arc = on_arc(piece);  // its ear lies behind its chord
    if (arc.past == 0) return on(piece, arc.edge);
    return arc.past > 0 ? PlanarContact::overlapping : PlanarContact::separated;
  }

  /// The first point of the boundary ahead of y, which lies in R, from that piece of the closed column on. At most one
  /// chord is passed: that of the ear in which y lies, or its own.
  std::optional<BoundaryPoint> exit_from(std::int32_t ahead) {
    for (; ahead >= 0; ahead = slabs_.next(ahead, column_)) {
      const MonotonePiece& piece = slabs_.piece(ahead);
      if (slabs_.starts_at(ahead, column_)) return end_of(piece, false);
      if (slabs_.ends_at(ahead, column_)) return end_of(piece, true);
      if (!piece.arc()) return crossing(piece, piece.first);
      if (!piece.increasing) return crossing(piece, on_arc(piece).edge);
    }
    assert(false);
    return std::nullopt;
  }
  [[nodiscard]] BoundaryPoint end_of(const MonotonePiece& piece, bool end) const {
    const int edge = end ? piece.last : piece.first;
    const detail::EdgePart part = slabs_.boundary().part(piece, edge);
    return {piece.stretch, edge, end ? part.to : part.from};
  }

  const DirectionSlabs& slabs_;
  Point2 y_;
  std::int64_t& probes_;
  DirectionSlabs::Column column_;
};

}  // namespace

Expected<DirectionSet> DirectionSet::of(const PolygonDifference& difference, std::span<const Point2> directions) {
  auto state = std::make_shared<State>();
  state->difference = difference.state_;
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const Point2& d = directions[k];
    const std::string where = "directions[" + std::to_string(k) + "]";
    if (auto refused = detail::refused_direction(d, where)) return *std::move(refused);
    state->directions.push_back(d);
    state->slabs.emplace_back(MonotoneBoundary(state->difference->boundary, state->difference->turned(d)));
  }
  DirectionSet r;
  r.state_ = std::move(state);
  return r;
}

int DirectionSet::num_directions() const { return static_cast<int>(state_->directions.size()); }

const Point2& DirectionSet::direction(int k) const { return state_->directions[static_cast<std::size_t>(k)]; }

PolygonDepth DirectionSet::depth(const Point2& placement, int k, std::int64_t* probes) const {
  const PolygonDifference::State& s = *state_->difference;
  const DirectionSlabs& slabs = state_->slabs[static_cast<std::size_t>(k)];
  const Point2 y = s.turned(placement);
  std::int64_t count = 0;
  std::optional<BoundaryPoint> found;
  PolygonDepth answer;
  answer.contact = SlabQuery(slabs, y, count).run(found);
  if (probes != nullptr) *probes = count;
  if (!found) return answer;
  if (answer.contact == PlanarContact::touching) {
    detail::fill_touching(answer, s.query.span_of(*found), s.swapped);
  } else {
    const detail::Span ray{detail::BoundaryQuery::point(y), {{0, 0}, slabs.boundary().direction()}, {}};
    detail::fill_hit(answer, ray, direction(k), s.query.span_of(*found), found->at, s.swapped);
  }
  answer.feature = detail::feature_of(s.boundary, s.p, s.q, *found, s.swapped);
  return answer;
}

DirectionSet::Statistics DirectionSet::statistics() const {
  Statistics r{0, 0, 0};
  for (const DirectionSlabs& slabs : state_->slabs) {
    r.pieces += static_cast<std::int64_t>(slabs.boundary().pieces().size() + slabs.boundary().along().size());
    r.events += slabs.num_events();
    r.memory_bytes += static_cast<std::int64_t>(slabs.memory_bytes());
  }
  return r;
}

}  // namespace pd
