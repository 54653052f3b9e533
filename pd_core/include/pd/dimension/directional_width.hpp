/// @file
/// Approximate directional width queries ([M] Lemma 5): one interface, three structures behind it.
///
/// width_v(K) = h_K(v) + h_K(-v) over |v|. A query for a direction v returns points p, q of K with
/// width_v({p, q}) >= (1 - epsilon) width_v(K). Each end, <v, p>, is therefore at most epsilon width_v(K) |v| short of
/// h_K(v) and never beyond it.
///
/// | backend | structure | query |
/// |---|---|---|
/// | exact | the points outside a coarse kernel, in the cones over its facets; halfspaces: linear program | measured |
/// | kernel | an epsilon-kernel, the graph of its hull, and a table of directions to start climbing from | measured |
/// | macbeath | the hierarchy of Macbeath regions of [M] | O(log^2 (1 / epsilon)) |
///
/// Budget: the hierarchy of Macbeath regions is built within 12 million operations, about a second. If it takes
/// more, as for 300 points on a sphere of R^5 at epsilon 0.01, the points of a kernel are scanned instead: epsilon
/// holds, and a query takes a product a point. The kernel's hull has at most n points; 1,000 on a sphere of R^5 take
/// 27,000 facets.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>

#include "pd/dimension/body.hpp"

namespace pd::dimension {

enum class Backend { exact, kernel, macbeath };

/// Work of queries; the caller owns the counters.
struct QueryCounters {
  std::int64_t queries = 0;       ///< support queries
  std::int64_t nodes = 0;         ///< nodes of the structure visited (vertices climbed, cells, Macbeath regions)
  std::int64_t dot_products = 0;  ///< of D numbers
  std::int64_t deepest = 0;       ///< longest path of one query
};

/// The size of a structure.
struct StructureSize {
  std::int64_t points = 0;  ///< points (of K) or halfspaces stored
  std::int64_t nodes = 0;   ///< vertices, cells, regions
  std::int64_t links = 0;   ///< edges between nodes, directed
  std::int64_t max_out_degree = 0;
  std::int64_t depth = 0;  ///< layers
  std::int64_t bytes = 0;
};

template <int D>
struct DirectionalWidthAnswer {
  double width;          ///< <v, most.point - least.point> / |v|
  SupportPoint<D> most;  ///< p: <v, p> >= h_K(v) - epsilon width_v(K) |v|
  SupportPoint<D> least;
};

/// The only question that the algorithms of this module ask of a body: an extreme point, in the sense above, for any
/// nonzero direction.
template <class Oracle, int D>
concept SupportOracle = requires(const Oracle& oracle, const Vector<D>& direction, QueryCounters& counters) {
  { oracle.support(direction, counters) } -> std::same_as<SupportPoint<D>>;
};

namespace detail {

class WidthStructure;

}  // namespace detail

/// A preprocessed body: the augmented data structure of [M] Lemma 10 (the structure of Lemma 5 and the sandwich that
/// fattens sums). Immutable, cheap to copy, safe to query from several threads.
template <int D>
class DirectionalWidth {
 public:
  /// @param epsilon in (0, 1); the exact backend ignores it beyond this check.
  /// @return ErrorCode::bad_value ("epsilon").
  static Expected<DirectionalWidth> build(const Body<D>& body, double epsilon, Backend backend = Backend::kernel);

  /// A point of K, extreme up to epsilon. Directions have any length but zero.
  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const;

  /// Directions of any length but zero, the longest and the shortest, too: their `value`s over- and underflow.
  [[nodiscard]] DirectionalWidthAnswer<D> width(const Vector<D>& direction, QueryCounters& counters) const;

  [[nodiscard]] double epsilon() const { return epsilon_; }
  [[nodiscard]] Backend backend() const { return backend_; }
  [[nodiscard]] const Sandwich<D>& sandwich() const { return sandwich_; }
  [[nodiscard]] StructureSize size() const;
  /// For the sources of this module.
  [[nodiscard]] const std::shared_ptr<const detail::WidthStructure>& structure() const { return structure_; }

 private:
  DirectionalWidth() = default;

  std::shared_ptr<const detail::WidthStructure> structure_;
  Sandwich<D> sandwich_;
  double epsilon_ = 0;
  Backend backend_ = Backend::kernel;
};

/// A preprocessed body under an affine map, queried without being rebuilt ([M] section 1.1).
template <int D>
struct MappedWidth {
  const DirectionalWidth<D>* body;
  AffineMap<D> map;

  [[nodiscard]] SupportPoint<D> support(const Vector<D>& direction, QueryCounters& counters) const {
    SupportPoint<D> r = body->support(map.pull_back(direction), counters);
    r.point = map.apply(r.point);
    r.value = direction.dot(r.point);
    return r;
  }
};

}  // namespace pd::dimension
