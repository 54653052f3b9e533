#include "dimension/composed/flattened_body.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dimension/composed/growing_sum.hpp"
#include "dimension/equal_planes.hpp"

namespace pd::dimension::detail {

namespace {

/// Finest growth of the parts; rounding in their frames is a thousandth of it.
constexpr double kLeastGrowth = 1e-6;

/// <normal, x> <= inner for all x of a body inside, <= outer for one that holds it.
template <int D>
struct TwoOffsets {
  Vector<D> normal;
  double inner;
  double outer;
};

template <int D>
using Facets = std::vector<TwoOffsets<D>>;

template <int D>
Error too_coarse(const ComposedBody<D>& part, double needed) {
  return Error{ErrorCode::bad_value,
               "the bodies are preprocessed at epsilon " + std::to_string(part.epsilon()) +
                   "; an intersection inside needs " + std::to_string(needed),
               "epsilon"};
}

/// Certified h over a direction, from one that may fall short.
template <int D>
double certified_support(const ComposedBody<D>& body, const Vector<D>& direction) {
  QueryCounters unused;
  const double most = body.support(direction, unused).value;
  if (!(body.epsilon() > 0)) return most;
  const double least = -body.support(-direction, unused).value;
  return most + body.epsilon() / (1 - body.epsilon()) * (most - least);
}

/// Adds the facets of a polytope inside `inner`, with the supports of `outer` over them.
template <int D>
std::optional<Error> add_facets(const ComposedBody<D>& inner, const ComposedBody<D>* outer, double growth,
                                Facets<D>& facets) {
  GrowingSum<D> grown(inner);
  const double needed = allowed_error(inner, grown.ratio(), growth);
  if (inner.epsilon() > needed) return too_coarse(inner, needed);
  switch (grown.grow(1 + growth)) {
    case Growth::spent:
      return Error{ErrorCode::limit_exceeded,
                   "an intersection inside is so thin beside its parts that they take more than a million facets", ""};
    case Growth::rounding:
      return Error{ErrorCode::out_of_range, "the bodies are too slender for this epsilon in double precision",
                   "epsilon"};
    case Growth::reached:
      break;
  }
  const std::vector<std::int32_t> same = merge_equal_planes(grown.hull());
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(same.size()); ++f) {
    if (same[static_cast<std::size_t>(f)] != f) continue;
    const Vector<D>& plane = grown.hull().facets()[static_cast<std::size_t>(f)].normal;
    const Vector<D> normal = grown.frame().pull_back(plane);
    const double length = normal.norm();
    const double middle = plane.dot(grown.frame().translation);
    TwoOffsets<D> facet = {normal / length, (1 - kRoom - middle) / length, (grown.upper(f) - middle) / length};
    if (outer != nullptr) facet.outer = std::max(facet.inner, certified_support<D>(*outer, facet.normal));
    facets.push_back(facet);
  }
  return std::nullopt;
}

/// Facets of all parts of an intersection, of those nested in it, too.
template <int D>
std::optional<Error> collect(const ComposedBody<D>& body, double growth, Facets<D>& facets) {
  if (body.equations() == 0) return add_facets<D>(body, nullptr, growth, facets);
  if (body.node().kind == ComposedKind::intersection) {
    for (const ComposedBody<D>& part : body.node().parts) {
      if (auto error = collect(part, growth, facets)) return error;
    }
    return std::nullopt;
  }
  const auto inner = without_intersections<D>(body, Side::inner, growth / 4, growth);
  if (!inner) return inner.error();
  const auto outer = without_intersections<D>(body, Side::outer, growth / 4, growth);
  if (!outer) return outer.error();
  return add_facets<D>(*inner, &*outer, growth, facets);
}

template <int D>
Expected<Body<D>> body_of(const Facets<D>& facets, Side side) {
  std::vector<Halfspace<D>> halfspaces;
  for (const TwoOffsets<D>& f : facets) halfspaces.push_back({f.normal, side == Side::inner ? f.inner : f.outer});
  return Body<D>::from_halfspaces(std::move(halfspaces));
}

/// lambda of the file's head; 0 where rounding puts c outside.
template <int D>
double spread(const Facets<D>& facets, const Vector<D>& c) {
  double most = 1;
  for (const TwoOffsets<D>& f : facets) {
    const double low = f.inner - f.normal.dot(c);
    if (!(low > 0)) return 0;
    most = std::max(most, (f.outer - f.normal.dot(c)) / low);
  }
  return most;
}

template <int D>
Expected<Body<D>> body_of_intersection(const ComposedBody<D>& body, Side side, double growth) {
  double part_growth = std::min(growth / 2, 0.25);
  while (true) {
    Facets<D> facets;
    if (auto error = collect(body, part_growth, facets)) return *error;
    const Expected<Body<D>> inner = body_of<D>(facets, Side::inner);
    const double lambda = inner ? spread<D>(facets, inner->sandwich().centre) : 0;
    if (lambda >= 1 && lambda <= 1 + growth) return side == Side::inner ? inner : body_of<D>(facets, Side::outer);
    if (lambda == 0) {
      const Expected<Body<D>> outer = body_of<D>(facets, Side::outer);
      if (!outer && outer.error().code == ErrorCode::bad_value) {
        return Error{ErrorCode::bad_value, "an intersection inside is empty: its bodies have no common point", ""};
      }
    }
    if (part_growth <= kLeastGrowth) {
      return Error{ErrorCode::not_full_dimensional,
                   "an intersection inside has no interior that double precision could tell beside its parts", ""};
    }
    // The spread falls with the growth, and no faster.
    const double wanted = lambda == 0 ? part_growth / 8 : part_growth * growth / (lambda - 1) / 2;
    part_growth = std::max({kLeastGrowth, part_growth / 64, wanted});
  }
}

/// Structures for the intersections at `structure`, the rest as it is.
template <int D>
Expected<ComposedBody<D>> flattened(const ComposedBody<D>& body, Side side, double growth, double structure) {
  if (body.equations() == 0) return body;
  const ComposedKind kind = body.node().kind;
  if (kind == ComposedKind::intersection) {
    const Expected<Body<D>> made = body_of_intersection<D>(body, side, growth);
    if (!made) return made.error();
    const auto prepared = DirectionalWidth<D>::build(*made, structure, Backend::kernel);
    if (!prepared) return prepared.error();
    return ComposedBody<D>::of(*prepared);
  }
  std::vector<ComposedBody<D>> parts;
  for (const ComposedBody<D>& part : body.node().parts) {
    Expected<ComposedBody<D>> flat = flattened(part, side, growth, structure);
    if (!flat) return flat;
    parts.push_back(*std::move(flat));
  }
  return kind == ComposedKind::sum ? ComposedBody<D>::sum_of(std::move(parts))
                                   : ComposedBody<D>::hull_of(std::move(parts));
}

}  // namespace

template <int D>
Expected<ComposedBody<D>> without_intersections(const ComposedBody<D>& body, Side side, double growth, double later) {
  Expected<ComposedBody<D>> flat = flattened<D>(body, side, growth, later / 4);
  if (!flat) return flat;
  // Hulls ask for finer structures, by the shape of the whole, which is known once it stands.
  const double needed = allowed_error(*flat, GrowingSum<D>(*flat).ratio(), later);
  if (flat->epsilon() <= needed) return flat;
  if (body.epsilon() > needed) return too_coarse(body, needed);
  return flattened<D>(body, side, growth, needed / 2);
}

#define PD_INSTANTIATE(D) \
  template Expected<ComposedBody<D>> without_intersections<D>(const ComposedBody<D>&, Side, double, double);
PD_INSTANTIATE(2)
PD_INSTANTIATE(3)
PD_INSTANTIATE(4)
PD_INSTANTIATE(5)
#undef PD_INSTANTIATE

}  // namespace pd::dimension::detail
