#include "planar/boundary/sum_boundary.hpp"

#include "numeric/at.hpp"
#include "planar/boundary/boundary_builder.hpp"

namespace pd::detail {

SumBoundary::SumBoundary(const Polygon& p, const Polygon& q, bool implicit, std::int64_t max_comparisons,
                         bool with_seats) {
  if (p.is_point()) return;  // so is q: R has no area
  BoundaryBuilder builder(*this, p, q, with_seats);
  if (implicit) {
    builder.build_implicit();
  } else {
    builder.build_explicit(max_comparisons);
  }
}

Box2 SumBoundary::box(const Candidate& c, int begin, int end) const {
  Box2 box;
  const auto add = [&](const SumPoint& x) { box.add(Point2{x.p[0] - x.q[0], x.p[1] - x.q[1]}); };
  if (end - begin == 1) {
    const Span e = edge(c, begin);
    add(e.s);
    add(e.z);
    return box.widened();
  }
  const ConvexSum::Parts parts = sum(c).parts(sum_edge(c, begin));
  const Box2 q = sum(c).chain().box(parts.b, end - begin);
  const Point2& p = sum(c).corner(parts.a);
  box.add(Point2{p[0] - q.high[0], p[1] - q.high[1]});
  box.add(Point2{p[0] - q.low[0], p[1] - q.low[1]});
  return box.widened();
}

EdgePart SumBoundary::place(const SeatPlace& m) const {
  const Candidate& c = candidates_[at(m.candidate)];
  if (m.at.edge == c.count) return {edge(c, c.count - 1), {Place::Kind::end, {}, {}}, {}};
  return {edge(c, m.at.edge), m.at.at, {}};
}

EdgePart SumBoundary::part(const Stretch& s, int e) const {
  EdgePart r{edge(candidate(s), e), {}, {Place::Kind::end, {}, {}}};
  if (e == s.from.edge) r.from = s.from.at;
  if (e == s.to.edge) r.to = s.to.at;
  return r;
}

SumBoundary::Contact SumBoundary::contact(const Stretch& s, int e) const {
  const Candidate& c = candidate(s);
  const ConvexSum::Parts parts = sum(c).parts(sum_edge(c, e));
  const auto& vertices = chain_vertices_[static_cast<std::size_t>(c.sum) % chains_.size()];
  const std::size_t b = static_cast<std::size_t>(parts.b);
  return {sum(c).corners()[at(parts.a)], vertices[b], parts.of_triangle, parts.of_chain};
}

std::size_t SumBoundary::memory_bytes() const {
  std::size_t bytes = (p_points_.capacity() + q_points_.capacity()) * sizeof(Point2) +
                      sums_.capacity() * sizeof(ConvexSum) + candidates_.capacity() * sizeof(Candidate) +
                      (stretches_.capacity() + slots_.capacity()) * sizeof(Stretch);
  for (const auto& chain : chains_) bytes += static_cast<std::size_t>(chain->size() + 1) * sizeof(Point2);
  for (const ConvexSum& sum : sums_) bytes += sum.memory_bytes();
  for (const ConvexPart& part : parts_) bytes += sizeof(ConvexPart) + at(part.size()) * sizeof(std::int32_t);
  for (const auto& list : chain_vertices_) bytes += list.capacity() * sizeof(std::int32_t);
  return bytes;
}

}  // namespace pd::detail
