#include "pd/structure/polyhedral_hierarchy.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "structure/hierarchy/coarsening.hpp"
#include "structure/hierarchy/plane_descent.hpp"

namespace pd {

struct PolyhedralHierarchy::Storage {
  HierarchyKind kind = HierarchyKind::inner;
  ConvexPolytope polytope;
  std::vector<Level> levels;
  std::vector<std::int32_t> coarsest;
  std::vector<std::int32_t> last_level;  ///< by element
  std::vector<std::int32_t> star_first;  ///< by element, one more at the end
  std::vector<Star> stars;
  std::vector<std::array<std::int32_t, 3>> faces;
  std::vector<std::int32_t> creators;
};

namespace {

struct Record {
  std::vector<std::int32_t> order;  ///< elements as their stars were written
  std::vector<std::int32_t> sizes;
  std::vector<PolyhedralHierarchy::Star> stars;
};

}  // namespace

/// Runs the steps and keeps every star as it is when its element goes.
template <class Space>
void PolyhedralHierarchy::coarsen(const Space& space, Storage& data) {
  detail::Coarsening<Space> surface(space);
  Record record;
  const auto write = [&](int v, const std::vector<Star>& ring) {
    record.order.push_back(v);
    record.sizes.push_back(static_cast<std::int32_t>(ring.size()));
    record.stars.insert(record.stars.end(), ring.begin(), ring.end());
  };
  data.last_level.assign(static_cast<std::size_t>(space.size()), 0);
  for (std::int32_t step = 0;; ++step) {
    Level level;
    level.vertices = surface.count();
    level.facets = surface.count_facets();
    if (data.kind == HierarchyKind::outer) std::swap(level.vertices, level.facets);
    const auto taken = surface.step([&](int v, const std::vector<Star>& ring) {
      write(v, ring);
      data.last_level[static_cast<std::size_t>(v)] = step;
    });
    level.max_degree = taken.max_degree;
    data.levels.push_back(level);
    if (taken.removed == 0) break;
  }
  for (int v = 0; v < space.size(); ++v) {
    if (!surface.alive(v)) continue;
    data.coarsest.push_back(v);
    data.last_level[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(data.levels.size()) - 1;
    write(v, surface.ring(v));
  }
  // By element.
  data.star_first.assign(static_cast<std::size_t>(space.size()) + 1, 0);
  for (std::size_t i = 0; i < record.order.size(); ++i) {
    data.star_first[static_cast<std::size_t>(record.order[i]) + 1] = record.sizes[i];
  }
  for (std::size_t v = 1; v < data.star_first.size(); ++v) data.star_first[v] += data.star_first[v - 1];
  data.stars.resize(record.stars.size());
  auto from = record.stars.begin();
  for (std::size_t i = 0; i < record.order.size(); ++i) {
    const auto to = data.stars.begin() + data.star_first[static_cast<std::size_t>(record.order[i])];
    std::copy(from, from + record.sizes[i], to);
    from += record.sizes[i];
  }
  data.faces = std::move(surface.faces());
  data.creators = std::move(surface.creators());
  data.faces.shrink_to_fit();
  data.creators.shrink_to_fit();
}

Expected<PolyhedralHierarchy> PolyhedralHierarchy::build(const ConvexPolytope& polytope, HierarchyKind kind) {
  const detail::FloatingPointGuard guard;
  if (polytope.affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional, "hierarchies are those of solids; this body is flat", ""};
  }
  Storage data{kind, polytope, {}, {}, {}, {}, {}, {}, {}};
  if (kind == HierarchyKind::outer) {
    coarsen(detail::FacetSpace(polytope), data);
  } else {
    coarsen(detail::VertexSpace(polytope), data);
  }
  return PolyhedralHierarchy(std::make_shared<const Storage>(std::move(data)));
}

HierarchyKind PolyhedralHierarchy::kind() const { return data_->kind; }
const ConvexPolytope& PolyhedralHierarchy::polytope() const { return data_->polytope; }
std::span<const PolyhedralHierarchy::Level> PolyhedralHierarchy::levels() const { return data_->levels; }
int PolyhedralHierarchy::last_level(int element) const { return data_->last_level[static_cast<std::size_t>(element)]; }
std::span<const PolyhedralHierarchy::Star> PolyhedralHierarchy::star(int element) const {
  const std::int32_t first = data_->star_first[static_cast<std::size_t>(element)];
  const std::int32_t end = data_->star_first[static_cast<std::size_t>(element) + 1];
  return std::span(data_->stars).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(end - first));
}
std::span<const std::int32_t> PolyhedralHierarchy::coarsest() const { return data_->coarsest; }
int PolyhedralHierarchy::num_faces() const { return static_cast<int>(data_->faces.size()); }
const std::array<std::int32_t, 3>& PolyhedralHierarchy::face(int f) const {
  return data_->faces[static_cast<std::size_t>(f)];
}
int PolyhedralHierarchy::creator(int f) const { return data_->creators[static_cast<std::size_t>(f)]; }

std::size_t PolyhedralHierarchy::memory_bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof(Storage) + bytes(data_->levels) + bytes(data_->coarsest) + bytes(data_->last_level) +
         bytes(data_->star_first) + bytes(data_->stars) + bytes(data_->faces) + bytes(data_->creators);
}

int PolyhedralHierarchy::support(const Vec3& direction, std::int64_t* dot_products, int level) const {
  detail::PlaneDescent descent(*this, direction);
  while (descent.next(level)) {
  }
  if (dot_products != nullptr) *dot_products += descent.evaluations();
  return descent.vertex();
}

}  // namespace pd
