#include "protocol/composed_body.hpp"

#include <optional>
#include <string>
#include <vector>

namespace pd::query {

namespace {

using dimension::ComposedBody;
using dimension::DirectionalWidth;

constexpr int kDeepest = 8;
constexpr std::string_view kCompositions[] = {"sum_of", "hull_of", "intersection_of"};

/// The list of a composed body, and which it is; nothing for a body of points or halfspaces.
struct Composition {
  int kind;
  Node parts;
};

std::optional<Composition> find_composition(const Node& body) {
  require_object(body);
  for (int kind = 0; kind < 3; ++kind) {
    const auto parts = body.find(kCompositions[kind]);
    if (!parts) continue;
    allow_only(body, {kCompositions[kind]});
    require_array(*parts, "a list of bodies");
    if (parts->size() == 0) parts->refuse("bad_value", "an empty list of bodies; at least one is needed");
    return Composition{kind, *parts};
  }
  return std::nullopt;
}

}  // namespace

void write_reached(double epsilon, JsonWriter& answer) { answer.bracket_unreached().key("epsilon").number(epsilon); }

bool is_composed(const Node& body) { return find_composition(body).has_value(); }

int composed_dimension(const Node& body, const Limits& limits, int nesting) {
  if (nesting > kDeepest) body.refuse("limit_exceeded", "bodies nest at most 8 deep");
  const auto composition = find_composition(body);
  if (!composition) return read_dimension(body, limits);
  const Node first = composition->parts.element(0);
  return composed_dimension(first, limits, nesting + 1);
}

template <int D>
ComposedBody<D> read_composed(const Node& body, const Limits& limits, const Preparation& preparation, int nesting) {
  if (nesting > kDeepest) body.refuse("limit_exceeded", "bodies nest at most 8 deep");
  const auto composition = find_composition(body);
  if (!composition) {
    if (read_dimension(body, limits) != D) {
      body.refuse("bad_value", "bodies of one query live in one dimension, here " + std::to_string(D));
    }
    const auto structure =
        DirectionalWidth<D>::build(read_dimension_body<D>(body, limits), preparation.epsilon, preparation.backend);
    if (!structure) body.refuse(structure.error());
    Expected<ComposedBody<D>> leaf = ComposedBody<D>::of(*structure);
    if (!leaf) body.refuse(leaf.error());
    return *std::move(leaf);
  }
  std::vector<ComposedBody<D>> parts;
  for (std::size_t i = 0; i < composition->parts.size(); ++i) {
    parts.push_back(read_composed<D>(composition->parts.element(i), limits, preparation, nesting + 1));
  }
  Expected<ComposedBody<D>> made = composition->kind == 0   ? ComposedBody<D>::sum_of(std::move(parts))
                                   : composition->kind == 1 ? ComposedBody<D>::hull_of(std::move(parts))
                                                            : ComposedBody<D>::intersection_of(std::move(parts));
  if (!made) body.refuse(made.error());
  return *std::move(made);
}

#define PD_INSTANTIATE(D) \
  template ComposedBody<D> read_composed<D>(const Node&, const Limits&, const Preparation&, int);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::query
