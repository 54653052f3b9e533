#include "dimension/composed/flattened_body.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dimension/composed/growing_sum.hpp"
#include "dimension/equal_planes.hpp"
#include "numeric/number_text.hpp"

namespace pd::dimension::detail {

namespace {

/// Finest growth of the parts; rounding in their frames is a thousandth of it.
constexpr double kLeastGrowth = 1e-6;

/// <normal, x> <= inner for all x of a body inside, <= outer for one that holds it.
struct TwoOffsets {
  AnyVector normal;
  double inner;
  double outer;
};

using Facets = std::vector<TwoOffsets>;

Error too_coarse(const Composed& part, double needed) {
  return Error{ErrorCode::bad_value,
               "the bodies are preprocessed at epsilon " + pd::detail::number_text(part->epsilon) +
                   "; an intersection inside needs " + pd::detail::number_text(needed),
               "epsilon"};
}

/// Certified h over a direction, from one that may fall short.
double certified_support(const Composed& body, const AnyVector& direction) {
  QueryCounters unused;
  const double most = body->support(direction, unused).value;
  if (!(body->epsilon > 0)) return most;
  const double least = -body->support(-direction, unused).value;
  return most + body->epsilon / (1 - body->epsilon) * (most - least);
}

/// Adds the facets of a polytope inside `inner`, with the supports of `outer` over them.
std::optional<Error> add_facets(const Composed& inner, const Composed* outer, double growth, Facets& facets) {
  GrowingSum grown(inner);
  const double needed = allowed_error(*inner, grown.ratio(), growth);
  if (inner->epsilon > needed) return too_coarse(inner, needed);
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
    const AnyVector& plane = grown.hull().normal(f);
    const AnyVector normal = grown.frame().pull_back(plane);
    const double length = normal.norm();
    const double middle = plane.dot(grown.frame().translation);
    TwoOffsets facet = {normal / length, (1 - kRoom - middle) / length, (grown.upper(f) - middle) / length};
    if (outer != nullptr) facet.outer = std::max(facet.inner, certified_support(*outer, facet.normal));
    facets.push_back(facet);
  }
  return std::nullopt;
}

/// Facets of all parts of an intersection, of those nested in it, too.
std::optional<Error> collect(const Composed& body, double growth, Facets& facets) {
  if (body->equations == 0) return add_facets(body, nullptr, growth, facets);
  if (body->kind == ComposedKind::intersection) {
    for (const Composed& part : body->parts) {
      if (auto error = collect(part, growth, facets)) return error;
    }
    return std::nullopt;
  }
  const auto inner = without_intersections(body, Side::inner, growth / 4, growth);
  if (!inner) return inner.error();
  const auto outer = without_intersections(body, Side::outer, growth / 4, growth);
  if (!outer) return outer.error();
  return add_facets(*inner, &*outer, growth, facets);
}

Expected<AnyBody> body_of(const Facets& facets, Side side) {
  std::vector<AnyHalfspace> halfspaces;
  for (const TwoOffsets& f : facets) halfspaces.push_back({f.normal, side == Side::inner ? f.inner : f.outer});
  return AnyBody::of(std::move(halfspaces));
}

/// lambda of the file's head; 0 where rounding puts c outside.
double spread(const Facets& facets, const AnyVector& c) {
  double most = 1;
  for (const TwoOffsets& f : facets) {
    const double low = f.inner - f.normal.dot(c);
    if (!(low > 0)) return 0;
    most = std::max(most, (f.outer - f.normal.dot(c)) / low);
  }
  return most;
}

Expected<AnyBody> body_of_intersection(const Composed& body, Side side, double growth) {
  double part_growth = std::min(growth / 2, 0.25);
  while (true) {
    Facets facets;
    if (auto error = collect(body, part_growth, facets)) return *error;
    const Expected<AnyBody> inner = body_of(facets, Side::inner);
    const double lambda = inner ? spread(facets, inner->sandwich.centre) : 0;
    if (lambda >= 1 && lambda <= 1 + growth) return side == Side::inner ? inner : body_of(facets, Side::outer);
    if (lambda == 0) {
      const Expected<AnyBody> outer = body_of(facets, Side::outer);
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
Expected<Composed> flattened(const Composed& body, Side side, double growth, double structure) {
  if (body->equations == 0) return body;
  const ComposedKind kind = body->kind;
  if (kind == ComposedKind::intersection) {
    const Expected<AnyBody> made = body_of_intersection(body, side, growth);
    if (!made) return made.error();
    const auto prepared = PreparedBody::build(*made, structure, Backend::kernel);
    if (!prepared) return prepared.error();
    return leaf_of(*prepared, identity_map(made->dimension()));
  }
  std::vector<Composed> parts;
  for (const Composed& part : body->parts) {
    Expected<Composed> flat = flattened(part, side, growth, structure);
    if (!flat) return flat;
    parts.push_back(*std::move(flat));
  }
  return composed_of(kind, std::move(parts));
}

}  // namespace

Expected<Composed> without_intersections(const Composed& body, Side side, double growth, double later) {
  Expected<Composed> flat = flattened(body, side, growth, later / 4);
  if (!flat) return flat;
  // Hulls ask for finer structures, by the shape of the whole, which is known once it stands.
  const double needed = allowed_error(**flat, GrowingSum(*flat).ratio(), later);
  if ((*flat)->epsilon <= needed) return flat;
  if (body->epsilon > needed) return too_coarse(body, needed);
  return flattened(body, side, growth, needed / 2);
}

}  // namespace pd::dimension::detail
