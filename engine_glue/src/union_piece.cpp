#include "union_piece.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <algorithm>
#include <cmath>

#include "child_tree.hpp"
#include "pd/bullet/scalar.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// Of a direction in a cone of planes: rounding of a product of unit vectors, a few times over.
constexpr double kFeasible = 1e-9;

/// Counts what it takes out of a vector that never shrinks.
struct PieceList {
  std::vector<UnionPiece>& pieces;
  int count = 0;
  UnionPiece& next() {
    if (count == static_cast<int>(pieces.size())) pieces.emplace_back();
    return pieces[static_cast<std::size_t>(count)];
  }
  void keep() { count += pieces[static_cast<std::size_t>(count)].planes.empty() ? 0 : 1; }
};

class TrianglesOf : public btTriangleCallback {
 public:
  TrianglesOf(const btTransform& pose, double margin, const btCollisionObjectWrapper* except, const Beyond* beyond,
              PieceList& list)
      : pose_(pose), margin_(margin), except_(except), beyond_(beyond), list_(list) {}
  void processTriangle(btVector3* corners, int part, int index) override {
    if (except_ != nullptr && except_->m_partId == part && except_->m_index == index) return;
    const std::array points{to_pd(pose_(corners[0])), to_pd(pose_(corners[1])), to_pd(pose_(corners[2]))};
    if (beyond_ != nullptr) {
      const auto height = [&](const Vec3& point) { return beyond_->n.dot(point); };
      if (std::max({height(points[0]), height(points[1]), height(points[2])}) + margin_ <= beyond_->level) return;
    }
    set_triangle(points, margin_, list_.next());
    list_.keep();
  }

 private:
  const btTransform& pose_;
  double margin_;
  const btCollisionObjectWrapper* except_;
  const Beyond* beyond_;
  PieceList& list_;
};

/// What is collected, where.
struct Search {
  btVector3 centre;
  btScalar reach;
  const Beyond* beyond;
  std::uint64_t stamp;
  SolverCore& core;
  PieceList list;
};

void collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
             Search& search);

/// Children of a compound near the centre, but for number `except`.
void collect_children(const btCompoundShape& compound, const btTransform& pose, int except, Search& search) {
  const auto visit = [&](int child) {
    if (child == except) return;
    collect(*compound.getChildShape(child), pose * compound.getChildTransform(child), nullptr, search);
  };
  if (const btDbvt* tree = compound.getDynamicAabbTree()) {
    for_each_leaf(*tree, btDbvtVolume::FromCR(pose.invXform(search.centre), search.reach), visit);
    return;
  }
  for (int i = 0; i < compound.getNumChildShapes(); ++i) visit(i);
}

void collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
             Search& search) {
  if (shape.isCompound()) {
    collect_children(static_cast<const btCompoundShape&>(shape), pose, -1, search);
  } else if (shape.isConcave()) {
    const auto& concave = static_cast<const btConcaveShape&>(shape);
    const btVector3 local = pose.invXform(search.centre);
    const btVector3 extent(search.reach, search.reach, search.reach);
    TrianglesOf triangles(pose, static_cast<double>(concave.getMargin()), except, search.beyond, search.list);
    concave.processAllTriangles(&triangles, local - extent, local + extent);
  } else if (shape.isConvex()) {
    btVector3 lower;
    btVector3 upper;
    shape.getAabb(pose, lower, upper);
    for (int i = 0; i < 3; ++i) {
      if (lower[i] > search.centre[i] + search.reach || upper[i] < search.centre[i] - search.reach) return;
    }
    if (search.beyond != nullptr) {
      const Vec3& n = search.beyond->n;
      const Vec3 far = n.cwiseProduct(to_pd(lower)).cwiseMax(n.cwiseProduct(to_pd(upper)));
      if (far.sum() <= search.beyond->level) return;
    }
    const auto found = search.core.cache.find(static_cast<const btConvexShape&>(shape), search.stamp);
    if (!found->body) return;
    set_solid(found->sharp ? *found->sharp : *found->body, to_pd(pose), search.list.next());
    search.list.keep();
  }
}

/// The largest <n, d> over unit d with <normal, d> <= 0 for all of `active`: the way of n's projection on the cone,
/// which lies in its inside, on one of its sides or on the line of two.
double largest_along(const std::vector<const Plane*>& active, const Vec3& n) {
  double best = 0;
  const auto offer = [&](const Vec3& way) {
    const double length = way.norm();
    if (length <= kFeasible) return;
    const double value = n.dot(way) / length;
    const auto against = [&](const Plane* plane) { return plane->normal.dot(way) > kFeasible * length; };
    if (value > best && std::none_of(active.begin(), active.end(), against)) best = value;
  };
  offer(n);
  for (std::size_t i = 0; i < active.size(); ++i) {
    const Vec3& normal = active[i]->normal;
    offer(n - n.dot(normal) * normal);
    for (std::size_t k = 0; k < i; ++k) {
      const Vec3 line = normal.cross(active[k]->normal);
      offer(line);
      offer(-line);
    }
  }
  return best;
}

}  // namespace

void set_triangle(const std::array<Vec3, 3>& corners, double margin, UnionPiece& piece) {
  piece.planes.clear();
  piece.margin = margin;
  piece.flat = true;
  const Vec3 across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double twice_area = across.norm();
  // Also refuses what is not a number.
  if (!(twice_area > 0) || !std::isfinite(twice_area)) return;
  const Vec3 normal = across / twice_area;
  piece.planes.push_back({normal, normal.dot(corners[0])});
  piece.planes.push_back({-normal, -normal.dot(corners[0])});
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 outward = (corners[(i + 1) % 3] - corners[i]).cross(normal).normalized();
    piece.planes.push_back({outward, outward.dot(corners[i])});
  }
}

void set_solid(const ConvexShape& shape, const Pose& pose, UnionPiece& piece) {
  piece.planes.clear();
  piece.margin = shape.margin();
  piece.flat = false;
  const ConvexPolytope* polytope = shape.polytope();
  if (polytope == nullptr || polytope->affine_dimension() != 3) return;
  for (int f = 0; f < polytope->num_facets(); ++f) {
    const Vec3 normal = (pose.rotation() * polytope->facet_normal(f)).normalized();
    piece.planes.push_back({normal, normal.dot(pose.apply(polytope->vertex(polytope->facet_vertices(f)[0])))});
  }
}

void set_piece(const PosedShape& body, UnionPiece& piece) {
  const ConvexPolytope* polytope = body.shape->polytope();
  if (polytope != nullptr && polytope->affine_dimension() == 2 && polytope->num_vertices() == 3) {
    set_triangle({body.pose.apply(polytope->vertex(0)), body.pose.apply(polytope->vertex(1)),
                  body.pose.apply(polytope->vertex(2))},
                 body.shape->margin(), piece);
  } else {
    set_solid(*body.shape, body.pose, piece);
  }
}

void clip_to_piece(const UnionPiece& piece, double slack, std::vector<Vec3>& points, std::vector<Vec3>& spare) {
  for (const Plane& plane : piece.planes) {
    const std::size_t count = points.size();
    spare.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& here = points[i];
      const Vec3& next = points[(i + 1) % count];
      const double height = plane.height(here) - slack;
      const double next_height = plane.height(next) - slack;
      if (height <= 0) spare.push_back(here);
      // A segment has one edge, not two.
      if ((height < 0 && next_height > 0) || (height > 0 && next_height < 0)) {
        if (count != 2 || i == 0) spare.push_back(here + height / (height - next_height) * (next - here));
      }
    }
    points.swap(spare);
  }
}

double covered_sine(const UnionPiece& piece, const Vec3& point, const Vec3& n, double slack,
                    std::vector<const Plane*>& active) {
  active.clear();
  for (const Plane& plane : piece.planes) {
    const double height = plane.height(point);
    if (height > slack) return -1;
    if (height >= -slack) active.push_back(&plane);
  }
  return largest_along(active, n);
}

bool is_part(const btCollisionObjectWrapper& wrapper) {
  const btCollisionObjectWrapper* parent = wrapper.m_parent;
  if (parent == nullptr || !parent->getCollisionShape()->isCompound()) return false;
  return static_cast<const btCompoundShape*>(parent->getCollisionShape())->getNumChildShapes() > 1 || is_part(*parent);
}

bool is_piece(const btCollisionObjectWrapper& wrapper) {
  const btCollisionObjectWrapper* parent = wrapper.m_parent;
  return parent != nullptr && (parent->getCollisionShape()->isConcave() || is_part(wrapper));
}

int pieces_near(const btCollisionObjectWrapper& piece, const Vec3& point, double reach, const Beyond* beyond,
                std::uint64_t stamp, SolverCore& core, std::vector<UnionPiece>& pieces) {
  Search search{to_bullet(point), static_cast<btScalar>(reach), beyond, stamp, core, {pieces}};
  for (const btCollisionObjectWrapper* child = &piece; child->m_parent != nullptr; child = child->m_parent) {
    const btCollisionShape& shape = *child->m_parent->getCollisionShape();
    if (shape.isConcave()) {
      collect(shape, child->m_parent->getWorldTransform(), child, search);
    } else if (shape.isCompound()) {
      collect_children(static_cast<const btCompoundShape&>(shape), child->m_parent->getWorldTransform(), child->m_index,
                       search);
    }
  }
  return search.list.count;
}

}  // namespace pd::detail
