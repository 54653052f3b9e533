#include "planar/boundary/covered_intervals.hpp"

#include <algorithm>

namespace pd::detail {

int CoveredIntervals::compare(const Position& a, const Position& b) const {
  if (a.edge != b.edge) return a.edge < b.edge ? -1 : 1;
  if (a.at.kind == Place::Kind::start && b.at.kind == Place::Kind::start) return 0;
  return compare_places(boundary_.edge(candidate_, a.edge), a.at, b.at);
}

void CoveredIntervals::add(const Interval& interval) {
  // Those that end before the new one begins stay before it, those that begin after its end behind it; the rest melt
  // in.
  std::size_t first = 0;
  while (first < intervals_.size() && compare(intervals_[first].to, interval.from) < 0) ++first;
  std::size_t last = first;
  Interval merged = interval;
  while (last < intervals_.size() && compare(intervals_[last].from, interval.to) <= 0) {
    if (compare(intervals_[last].from, merged.from) < 0) merged.from = intervals_[last].from;
    if (compare(intervals_[last].to, merged.to) > 0) merged.to = intervals_[last].to;
    ++last;
  }
  if (first == last) {
    intervals_.insert(intervals_.begin() + static_cast<std::ptrdiff_t>(first), merged);
  } else {
    intervals_[first] = merged;
    intervals_.erase(intervals_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                     intervals_.begin() + static_cast<std::ptrdiff_t>(last));
  }
}

bool CoveredIntervals::whole() const {
  if (intervals_.size() != 1) return false;
  const Interval& only = intervals_.front();
  return only.from.edge == 0 && only.from.at.kind == Place::Kind::start && only.to.edge == candidate_.count;
}

std::vector<CoveredIntervals::Interval> CoveredIntervals::rest_of(const Interval& interval) const {
  std::vector<Interval> parts;
  Position from = interval.from;
  for (const Interval& covered : intervals_) {
    if (compare(covered.to, from) <= 0) continue;
    if (compare(covered.from, interval.to) >= 0) break;
    if (compare(from, covered.from) < 0) parts.push_back({from, covered.from});
    from = covered.to;
  }
  if (compare(from, interval.to) < 0) parts.push_back({from, interval.to});
  return parts;
}

std::vector<CoveredIntervals::Interval> CoveredIntervals::rest() const {
  return rest_of({{0, {}}, {candidate_.count, {}}});
}

}  // namespace pd::detail
