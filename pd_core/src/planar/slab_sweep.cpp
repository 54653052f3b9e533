#include "planar/slab_sweep.hpp"

#include <cassert>

#include "numeric/at.hpp"

namespace pd::detail {

SlabSweep::SlabSweep(DirectionSlabs& slabs)
    : slabs_(slabs), starting_(slabs.event_.size()), ending_(slabs.event_.size()), ahead_(slabs.extent_.size()) {
  for (std::size_t i = 0; i < slabs.extent_.size(); ++i) {
    starting_[at(slabs.extent_[i].low)].push_back(static_cast<std::int32_t>(i));
    ending_[at(slabs.extent_[i].high)].push_back(static_cast<std::int32_t>(i));
  }
}

void SlabSweep::run() {
  sweep_once();
  number_pieces();
  keep_states();
}

DirectionSlabs::End SlabSweep::low_end(std::int32_t piece, bool high) const {
  const bool end = slabs_.piece(piece).increasing == high;
  return {slabs_.boundary_.end_of<Estimate>(slabs_.piece(piece), end), piece, end};
}

/// By the later of their first ends against the other's line; where it lies on that, by the earlier of their last ends.
/// Pieces that only share a point there: the one that ends in it is behind the one that starts in it.
int SlabSweep::compare(std::int32_t a, std::int32_t b) const {
  const auto &ea = slabs_.extent_[at(a)], &eb = slabs_.extent_[at(b)];
  int order = ea.low >= eb.low ? slabs_.past(low_end(a, false), b) : -slabs_.past(low_end(b, false), a);
  if (order == 0 && ea.low != eb.high && eb.low != ea.high) {
    order = ea.high <= eb.high ? slabs_.past(low_end(a, true), b) : -slabs_.past(low_end(b, true), a);
  }
  if (order != 0) return order;
  if (ea.high == eb.low || eb.high == ea.low) return ea.high == eb.low ? -1 : 1;
  return a < b ? -1 : 1;
}

/// Neighbours, on every event and between events.
void SlabSweep::sweep_once() {
  std::set<std::int32_t, Behind> status(Behind{this});
  std::vector<std::set<std::int32_t, Behind>::iterator> place(slabs_.extent_.size());
  for (std::size_t event = 0; event < slabs_.event_.size(); ++event) {
    for (const std::int32_t piece : starting_[event]) {
      const auto here = status.insert(piece).first;
      assert(*here == piece);
      place[at(piece)] = here;
      if (here != status.begin()) ahead_[at(*std::prev(here))].push_back(piece);
      if (std::next(here) != status.end()) ahead_[at(piece)].push_back(*std::next(here));
    }
    for (const std::int32_t piece : ending_[event]) {
      const auto after = status.erase(place[at(piece)]);
      if (after != status.end() && after != status.begin()) ahead_[at(*std::prev(after))].push_back(*after);
    }
  }
}

/// "Behind" has no cycles among segments that do not cross: numbered as they come free.
void SlabSweep::number_pieces() {
  const auto count = static_cast<std::int32_t>(ahead_.size());
  std::vector<std::int32_t> behind(ahead_.size(), 0), free;
  for (const auto& list : ahead_) {
    for (const std::int32_t piece : list) ++behind[at(piece)];
  }
  for (std::int32_t i = count - 1; i >= 0; --i) {
    if (behind[at(i)] == 0) free.push_back(i);
  }
  slabs_.number_.assign(ahead_.size(), -1);
  while (!free.empty()) {
    const std::int32_t piece = free.back();
    free.pop_back();
    slabs_.number_[at(piece)] = static_cast<std::int32_t>(slabs_.piece_numbered_.size());
    slabs_.piece_numbered_.push_back(piece);
    for (const std::int32_t next : ahead_[at(piece)]) {
      if (--behind[at(next)] == 0) free.push_back(next);
    }
  }
  assert(static_cast<std::int32_t>(slabs_.piece_numbered_.size()) == count);
}

void SlabSweep::keep_states() {
  while (slabs_.width_ < static_cast<std::int32_t>(slabs_.number_.size())) slabs_.width_ *= 2;
  std::int32_t root = -1;
  for (std::size_t event = 0; event < slabs_.event_.size(); ++event) {
    for (const std::int32_t piece : starting_[event]) root = slabs_.with(root, slabs_.number_[at(piece)], true);
    const std::int32_t on_event = root;
    for (const std::int32_t piece : ending_[event]) root = slabs_.with(root, slabs_.number_[at(piece)], false);
    slabs_.root_.push_back({on_event, root});
  }
}

}  // namespace pd::detail
