#include "pd/structure/polyhedral_hierarchy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "numeric/dyadic.hpp"
#include "numeric/floating_point_guard.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd {

/// What was taken out at each step, by the neighbour that remained: `removed[first[v] .. first[v + 1])`, sorted by the
/// step, last step first.
struct PolyhedralHierarchy::Storage {
  HierarchyKind kind = HierarchyKind::inner;
  std::vector<Level> levels;
  struct Removed {
    std::int32_t step;
    std::int32_t vertex;
  };
  ConvexPolytope polytope;
  std::vector<std::int32_t> coarsest;
  std::vector<std::int32_t> first;
  std::vector<Removed> removed;
};

namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::to_dyadic;

using Triangle = std::array<std::int32_t, 3>;

/// The vertices of a polytope.
class VertexSpace {
 public:
  explicit VertexSpace(const ConvexPolytope& polytope) : polytope_(polytope) {}
  [[nodiscard]] int size() const { return polytope_.num_vertices(); }
  /// Side of the plane through i, j, k on which l lies; positive: outside.
  [[nodiscard]] int side(int i, int j, int k, int l) const {
    return orient3d(polytope_.vertex(i), polytope_.vertex(j), polytope_.vertex(k), polytope_.vertex(l));
  }
  /// A hull of fewer points is bounded always.
  [[nodiscard]] static bool faces_centre(int, int, int) { return true; }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> triangles;
    for (int f = 0; f < polytope_.num_facets(); ++f) {
      const auto loop = polytope_.facet_vertices(f);
      for (std::size_t i = 2; i < loop.size(); ++i) triangles.push_back({loop[0], loop[i - 1], loop[i]});
    }
    return triangles;
  }

 private:
  const ConvexPolytope& polytope_;
};

/// The vertices of the polar body about an inner point o: facet f of the polytope as n / <n, c - o> with its normal n
/// and a corner c. Rows (n, <n, c - o>) are that point in homogeneous coordinates.
class FacetSpace {
 public:
  explicit FacetSpace(const ConvexPolytope& polytope) : polytope_(polytope) {
    const auto loop = polytope.facet_vertices(0);
    int apex = 0;
    while (orient3d(polytope.vertex(loop[0]), polytope.vertex(loop[1]), polytope.vertex(loop[2]),
                    polytope.vertex(apex)) == 0) {
      ++apex;
    }
    // o is the mean of four vertices of a tetrahedron; exactly, its fourfold.
    fourfold_ = to_dyadic(polytope.vertex(apex));
    inner_ = polytope.vertex(apex) / 4;
    for (std::size_t i = 0; i < 3; ++i) {
      fourfold_ = fourfold_ + to_dyadic(polytope.vertex(loop[i]));
      inner_ += polytope.vertex(loop[i]) / 4;
    }
    scale_ = std::ldexp(1.0, -std::ilogb(polytope.max_abs_coordinate()));
  }

  [[nodiscard]] int size() const { return polytope_.num_facets(); }

  [[nodiscard]] int side(int i, int j, int k, int l) const {
    const Row a = rounded(i), b = rounded(j), c = rounded(k), d = rounded(l);
    const double value = minors(a, b, c, d);
    // Entries are at most 8 and err by less than 2^-47: 24 products of four.
    if (std::abs(value) > kFilter) return value < 0 ? 1 : -1;
    const ExactRow p = exact(i), q = exact(j), r = exact(k), s = exact(l);
    return -minors(p, q, r, s).sign();
  }

  /// Whether the polar facet through three of its vertices has the centre strictly behind it: only then do the planes
  /// bound the body there.
  [[nodiscard]] bool faces_centre(int i, int j, int k) const {
    return determinant(exact(i).normal, exact(j).normal, exact(k).normal).sign() > 0;
  }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> triangles;
    for (int v = 0; v < polytope_.num_vertices(); ++v) {
      const int first = polytope_.first_half_edge(v);
      const int degree = static_cast<int>(polytope_.neighbours(v).size());
      const auto facet = [&](int k) { return polytope_.half_edge(first + k).facet; };
      for (int k = 2; k < degree; ++k) triangles.push_back({facet(0), facet(k - 1), facet(k)});
    }
    return triangles;
  }

 private:
  struct Row {
    Vec3 normal;
    double offset;
  };
  struct ExactRow {
    Dyadic3 normal;
    Dyadic offset;
  };
  static constexpr double kFilter = 1e-8;

  [[nodiscard]] Row rounded(int f) const {
    const Vec3& n = polytope_.facet_normal(f);
    return {n, n.dot(scale_ * (polytope_.vertex(polytope_.facet_vertices(f)[0]) - inner_))};
  }
  [[nodiscard]] ExactRow exact(int f) const {
    const auto loop = polytope_.facet_vertices(f);
    const Dyadic3 c = to_dyadic(polytope_.vertex(loop[0]));
    const Dyadic3 n = cross(to_dyadic(polytope_.vertex(loop[1])) - c, to_dyadic(polytope_.vertex(loop[2])) - c);
    const Dyadic offset = dot(n, c).scaled(2) - dot(n, fourfold_);
    return {{n.x.scaled(2), n.y.scaled(2), n.z.scaled(2)}, offset};
  }

  /// The 4 x 4 determinant of four rows, by its last column.
  template <class AnyRow>
  static decltype(AnyRow::offset) minors(const AnyRow& a, const AnyRow& b, const AnyRow& c, const AnyRow& d) {
    return d.offset * triple(a, b, c) - c.offset * triple(a, b, d) + b.offset * triple(a, c, d) -
           a.offset * triple(b, c, d);
  }
  static double triple(const Row& a, const Row& b, const Row& c) { return a.normal.dot(b.normal.cross(c.normal)); }
  static Dyadic triple(const ExactRow& a, const ExactRow& b, const ExactRow& c) {
    return determinant(a.normal, b.normal, c.normal);
  }

  const ConvexPolytope& polytope_;
  Dyadic3 fourfold_;
  Vec3 inner_;
  double scale_ = 1;
};

/// A triangulated convex surface that loses vertices.
template <class Space>
class Coarsening {
 public:
  struct Step {
    std::vector<std::int32_t> removed;
    std::int32_t max_degree = 0;
  };

  explicit Coarsening(const Space& space) : space_(space), rings_(static_cast<std::size_t>(space.size())) {
    set_rings(space.triangles());
    alive_.assign(rings_.size(), 1);
    blocked_.assign(rings_.size(), 0);
    for (int v = 0; v < space.size(); ++v) present_.push_back(v);
    count_ = space.size();
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool alive(int v) const { return alive_[static_cast<std::size_t>(v)] != 0; }
  [[nodiscard]] const std::vector<std::int32_t>& ring(int v) const { return rings_[static_cast<std::size_t>(v)]; }

  /// Facets with coplanar triangles united.
  [[nodiscard]] int count_facets() const {
    int edges = 0;
    for (const std::int32_t v : present_) {
      const auto& r = ring(v);
      for (std::size_t i = 0; i < r.size(); ++i) {
        // The edge v r[i] with its two triangles' other corners.
        if (v < r[i] && space_.side(v, r[i], r[(i + 1) % r.size()], r[(i + r.size() - 1) % r.size()]) != 0) ++edges;
      }
    }
    return edges + 2 - count_;  // Euler
  }

  /// Takes out an independent set of vertices of degree up to kMaxDegree, small degrees first; an empty one at the end.
  /// `visit(v, ring)` sees each before it goes.
  template <class Visit>
  Step step(Visit&& visit) {
    Step step;
    std::vector<char>& blocked = blocked_;
    for (const std::int32_t v : present_) blocked[static_cast<std::size_t>(v)] = 0;
    for (int degree = 3; degree <= PolyhedralHierarchy::kMaxDegree; ++degree) {
      for (const std::int32_t v : present_) {
        if (!alive(v) || blocked[static_cast<std::size_t>(v)] != 0 || static_cast<int>(ring(v).size()) != degree) {
          continue;
        }
        if (count_ <= 4 || !fill_hole(v)) continue;
        visit(v, ring(v));
        for (const std::int32_t w : ring(v)) blocked[static_cast<std::size_t>(w)] = 1;
        remove(v);
        step.removed.push_back(v);
        step.max_degree = std::max(step.max_degree, degree);
      }
    }
    std::erase_if(present_, [&](std::int32_t v) { return !alive(v); });
    return step;
  }

 private:
  void set_rings(const std::vector<Triangle>& triangles) {
    // Of each vertex the pairs (next, after next) of its triangles, linked to a cycle.
    std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> links(rings_.size());
    for (const Triangle& t : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        links[static_cast<std::size_t>(t[i])].push_back({t[(i + 1) % 3], t[(i + 2) % 3]});
      }
    }
    for (std::size_t v = 0; v < rings_.size(); ++v) {
      auto& link = links[v];
      std::sort(link.begin(), link.end());
      std::int32_t at = link.front().first;
      do {
        rings_[v].push_back(at);
        at = std::lower_bound(link.begin(), link.end(), std::pair{at, std::int32_t{0}})->second;
      } while (at != link.front().first);
    }
  }

  /// The triangles that close the hole of v, as diagonals of its ring; false where the rest would be flat or unbounded.
  bool fill_hole(int v) {
    const auto& r = ring(v);
    const int d = static_cast<int>(r.size());
    diagonals_.clear();
    // Only the apex of a pyramid is joined to all others, and leaves a polygon behind.
    if (d == count_ - 1) {
      bool flat = true;
      for (int i = 3; i < d; ++i) flat = flat && space_.side(r[0], r[1], r[2], r[static_cast<std::size_t>(i)]) == 0;
      if (flat) return false;
    }
    return fill(r, 0, d - 1);
  }

  /// Fills the polygon of ring vertices i..j over the edge that joins its ends: the triangle on that edge is the one
  /// with no other corner above it.
  bool fill(const std::vector<std::int32_t>& r, int i, int j) {
    if (j - i < 2) return true;
    const auto at = [&](int k) { return r[static_cast<std::size_t>(k)]; };
    int apex = i + 1;
    for (int k = i + 2; k < j; ++k) {
      if (space_.side(at(i), at(apex), at(j), at(k)) > 0) apex = k;
    }
    if (!space_.faces_centre(at(i), at(apex), at(j))) return false;
    if (apex - i > 1) diagonals_.push_back({i, apex});
    if (j - apex > 1) diagonals_.push_back({apex, j});
    return fill(r, i, apex) && fill(r, apex, j);
  }

  void remove(int v) {
    const std::vector<std::int32_t>& r = ring(v);
    const int d = static_cast<int>(r.size());
    for (int i = 0; i < d; ++i) {
      // In the ring of r[i] stand r[i + 1], v, r[i - 1]: v gives way to the diagonals from r[i], in the order of r.
      others_.clear();
      for (const auto& [from, to] : diagonals_) {
        if (from == i) others_.push_back(to);
        if (to == i) others_.push_back(from + d);
      }
      std::sort(others_.begin(), others_.end());
      auto& target = rings_[static_cast<std::size_t>(r[static_cast<std::size_t>(i)])];
      auto place = target.erase(std::find(target.begin(), target.end(), v));
      for (std::size_t k = others_.size(); k-- > 0;) {
        place = target.insert(place, r[static_cast<std::size_t>(others_[k] % d)]);
      }
    }
    alive_[static_cast<std::size_t>(v)] = 0;
    --count_;
  }

  const Space& space_;
  std::vector<std::vector<std::int32_t>> rings_;
  std::vector<int> others_;  ///< buffer of `remove`
  std::vector<char> alive_;
  std::vector<char> blocked_;
  std::vector<std::int32_t> present_;  ///< alive at the beginning of a step, ascending
  std::vector<std::pair<int, int>> diagonals_;
  int count_ = 0;
};

/// Runs the steps; `visit(step, v, ring)` sees what goes.
template <class Space, class Visit>
std::vector<PolyhedralHierarchy::Level> coarsen(Coarsening<Space>& surface, bool polar, Visit&& visit) {
  std::vector<PolyhedralHierarchy::Level> levels;
  for (std::int32_t step = 0;; ++step) {
    PolyhedralHierarchy::Level level;
    level.vertices = surface.count();
    level.facets = surface.count_facets();
    if (polar) std::swap(level.vertices, level.facets);
    const auto taken = surface.step([&](int v, const std::vector<std::int32_t>& ring) { visit(step, v, ring); });
    level.max_degree = taken.max_degree;
    levels.push_back(level);
    if (taken.removed.empty()) return levels;
  }
}

}  // namespace

Expected<PolyhedralHierarchy> PolyhedralHierarchy::build(const ConvexPolytope& polytope, HierarchyKind kind) {
  const detail::FloatingPointGuard guard;
  if (polytope.affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional, "hierarchies are those of solids; this body is flat", ""};
  }
  Storage data{kind, {}, polytope, {}, {}, {}};
  if (kind == HierarchyKind::outer) {
    const FacetSpace space(polytope);
    Coarsening<FacetSpace> surface(space);
    data.levels = coarsen(surface, true, [](std::int32_t, int, const std::vector<std::int32_t>&) {});
    return PolyhedralHierarchy(std::make_shared<const Storage>(std::move(data)));
  }
  const VertexSpace space(polytope);
  Coarsening<VertexSpace> surface(space);
  struct Entry {
    std::int32_t neighbour;
    Storage::Removed removed;
  };
  std::vector<Entry> entries;
  data.levels = coarsen(surface, false, [&](std::int32_t step, int v, const std::vector<std::int32_t>& ring) {
    for (const std::int32_t w : ring) entries.push_back({w, {step, v}});
  });
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    if (surface.alive(v)) data.coarsest.push_back(v);
  }
  data.first.assign(static_cast<std::size_t>(polytope.num_vertices()) + 1, 0);
  for (const Entry& e : entries) ++data.first[static_cast<std::size_t>(e.neighbour) + 1];
  for (std::size_t v = 1; v < data.first.size(); ++v) data.first[v] += data.first[v - 1];
  data.removed.resize(entries.size());
  std::vector<std::int32_t> place(data.first.begin(), data.first.end() - 1);
  for (std::size_t i = entries.size(); i-- > 0;) {
    const Entry& e = entries[i];
    data.removed[static_cast<std::size_t>(place[static_cast<std::size_t>(e.neighbour)]++)] = e.removed;
  }
  return PolyhedralHierarchy(std::make_shared<const Storage>(std::move(data)));
}

HierarchyKind PolyhedralHierarchy::kind() const { return data_->kind; }
std::span<const PolyhedralHierarchy::Level> PolyhedralHierarchy::levels() const { return data_->levels; }

int PolyhedralHierarchy::support(const Vec3& direction, std::int64_t* dot_products) const {
  const ConvexPolytope& p = data_->polytope;
  std::int64_t products = 0;
  const auto value = [&](int v) {
    ++products;
    return p.vertex(v).dot(direction);
  };
  int best = data_->coarsest[0];
  double best_value = value(best);
  for (std::size_t i = 1; i < data_->coarsest.size(); ++i) {
    const double other = value(data_->coarsest[i]);
    if (other > best_value) {
      best = data_->coarsest[i];
      best_value = other;
    }
  }
  // Steps run backwards; a vertex taken out at one step has lost its own neighbours in earlier steps only.
  std::int32_t step = static_cast<std::int32_t>(data_->levels.size());
  for (bool descended = true; descended;) {
    descended = false;
    const std::int32_t end = data_->first[static_cast<std::size_t>(best) + 1];
    for (std::int32_t i = data_->first[static_cast<std::size_t>(best)]; i < end; ++i) {
      const Storage::Removed& removed = data_->removed[static_cast<std::size_t>(i)];
      if (removed.step >= step) continue;
      const double other = value(removed.vertex);
      if (other <= best_value) continue;
      best = removed.vertex;
      best_value = other;
      step = removed.step;
      descended = true;
      break;
    }
  }
  if (dot_products != nullptr) *dot_products += products;
  return best;
}

}  // namespace pd
