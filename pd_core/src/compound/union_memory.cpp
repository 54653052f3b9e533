#include "compound/union_memory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compound/cover_cells.hpp"

namespace pd::detail {

namespace {

/// A first cube so much wider than needed is worth another.
constexpr double kTooWide = 4;
/// Cubes are never joined again: a tree that has grown by half is left for a new one.
constexpr double kTooMany = 1.5;

std::vector<std::size_t> inverse(const std::vector<std::int32_t>& order) {
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = i;
  return place;
}

}  // namespace

UnionMemory::UnionMemory(WarmUnionState& state, const UnionPair& pair, bool exchanged)
    : state_(state),
      pair_(pair),
      exchanged_(exchanged),
      place_a_(inverse(pair.order_a)),
      place_b_(inverse(pair.order_b)) {
  const std::size_t parts_a = exchanged ? pair.b.size() : pair.a.size(),
                    parts_b = pair.a.size() + pair.b.size() - parts_a;
  if (state.parts_a == parts_a && state.parts_b == parts_b && state.scale_exponent == pair.scale_exponent()) return;
  state = WarmUnionState();
  state.parts_a = parts_a;
  state.parts_b = parts_b;
  state.scale_exponent = pair.scale_exponent();
}

std::optional<UnionMemory::Parts> UnionMemory::telling_pair() const {
  if (state_.pair_a < 0) return std::nullopt;
  const auto a = static_cast<std::size_t>(exchanged_ ? state_.pair_b : state_.pair_a);
  const auto b = static_cast<std::size_t>(exchanged_ ? state_.pair_a : state_.pair_b);
  return Parts{place_a_[a], place_b_[b]};
}

std::optional<Vec3> UnionMemory::way() const {
  if (state_.way.isZero()) return std::nullopt;
  return exchanged_ ? Vec3(-state_.way) : state_.way;
}

void UnionMemory::keep(std::int32_t part_a, std::int32_t part_b, const Vec3& way) {
  pair_.name_parts(part_a, part_b);
  state_.pair_a = exchanged_ ? part_b : part_a;
  state_.pair_b = exchanged_ ? part_a : part_b;
  state_.way = exchanged_ ? Vec3(-way) : way;
  if (!searched_) return;
  std::swap(state_.tree, state_.next);
  state_.exchanged = exchanged_;
  const std::size_t nodes = state_.tree.nodes.size();
  state_.least_nodes = state_.least_nodes == 0 ? nodes : std::min(state_.least_nodes, nodes);
  if (static_cast<double>(nodes) <= kTooMany * static_cast<double>(state_.least_nodes)) return;
  state_.tree.nodes.clear();
  state_.least_nodes = 0;
}

double UnionMemory::begin(const PartDifferences& differences, double least) {
  CoverTree& tree = state_.tree;
  if (!(tree.half >= least && tree.half <= kTooWide * least)) {
    tree.nodes.clear();
    state_.least_nodes = 0;
    tree.half = rounded_up(least);
  }
  state_.next.half = tree.half;
  state_.next.nodes.assign(1, CoverNode());
  pieces_.assign(pair_.a.size() * pair_.b.size(), -1);
  for (std::size_t k = 0; k < differences.pieces().size(); ++k) {
    const PartDifference& piece = differences.pieces()[k];
    pieces_[static_cast<std::size_t>(piece.part_a) * pair_.b.size() + static_cast<std::size_t>(piece.part_b)] =
        static_cast<std::int32_t>(k);
  }
  searched_ = true;
  return tree.half;
}

std::int32_t UnionMemory::child(std::int32_t node, int which) const {
  if (!halved(node)) return -1;
  return at(node).children + (state_.exchanged != exchanged_ ? 7 - which : which);
}

std::int32_t UnionMemory::holder(std::int32_t node) const {
  if (node < 0 || at(node).part_a < 0) return -1;
  const auto a = static_cast<std::size_t>(exchanged_ ? at(node).part_b : at(node).part_a);
  const auto b = static_cast<std::size_t>(exchanged_ ? at(node).part_a : at(node).part_b);
  return pieces_[place_a_[a] * pair_.b.size() + place_b_[b]];
}

std::int32_t UnionMemory::halve(std::int32_t record) {
  std::vector<CoverNode>& nodes = state_.next.nodes;
  const auto first = static_cast<std::int32_t>(nodes.size());
  nodes.resize(nodes.size() + 8);
  nodes[static_cast<std::size_t>(record)].children = first;
  return first;
}

void UnionMemory::held(std::int32_t record, const PartDifference& piece) {
  std::int32_t part_a = piece.part_a, part_b = piece.part_b;
  pair_.name_parts(part_a, part_b);
  if (exchanged_) std::swap(part_a, part_b);
  CoverNode& node = state_.next.nodes[static_cast<std::size_t>(record)];
  node.part_a = part_a;
  node.part_b = part_b;
}

}  // namespace pd::detail
