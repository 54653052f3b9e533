#include "pieces/near_pieces.hpp"

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "pd/bullet/scalar.hpp"
#include "shapes/child_tree.hpp"
#include "shapes/each_triangle.hpp"

namespace pd::detail {

/// What is collected, where.
struct NearPieces::Search {
  btVector3 centre;
  btScalar reach;
  const Beyond* beyond;
  const StepShapes& shapes;
  std::vector<const UnionPiece*>& found;
};

UnionPiece& NearPieces::next_made() {
  if (num_made_ == made_.size()) made_.emplace_back();
  return made_[num_made_];
}

void NearPieces::begin_pair(std::uint64_t stamp) {
  frames_[0].body = frames_[1].body = nullptr;
  around_ = nullptr;
  facts_.begin_pair(stamp);
}

void NearPieces::know(const TrianglesAround& around, const btCollisionObjectWrapper& mesh) {
  around_ = &around;
  around_pose_ = to_pd(mesh.getWorldTransform());
  around_margin_ = static_cast<double>(mesh.getCollisionShape()->getMargin());
  known_made_.assign(around.triangles().size(), false);
  if (known_.size() < known_made_.size()) known_.resize(known_made_.size());
}

const UnionFrame& NearPieces::frame_of(const btCollisionObjectWrapper& piece, BulletShapeCache& cache,
                                       const UnionPiece*& kept) {
  kept = nullptr;
  const btCollisionObjectWrapper* parent = piece.m_parent;
  if (parent == nullptr || parent->m_parent != nullptr || !parent->getCollisionShape()->isCompound()) return world_;
  const auto& compound = static_cast<const btCompoundShape&>(*parent->getCollisionShape());
  if (compound.getChildShape(piece.m_index) != piece.getCollisionShape()) return world_;
  const UnionPiece& child = facts_.piece_of({compound, piece.m_index}, cache);
  if (child.planes.empty()) return world_;
  kept = &child;
  const btCollisionObject* const body = parent->getCollisionObject();
  if (frames_[0].body != body) {
    std::swap(frames_[0], frames_[1]);
    if (frames_[0].body != body) {
      frames_[0].body = body;
      frames_[0].frame = {false, to_pd(parent->getWorldTransform().getBasis()),
                          to_pd(parent->getWorldTransform().getOrigin())};
    }
  }
  return frames_[0].frame;
}

const UnionPiece* NearPieces::known_triangle_of(const btCollisionObjectWrapper& piece) {
  const btCollisionObjectWrapper* parent = piece.m_parent;
  const bool of_mesh = parent != nullptr && parent->m_parent == nullptr && parent->getCollisionShape()->isConcave();
  if (!of_mesh || around_ == nullptr || !around_->are_of(*parent->getCollisionShape())) return nullptr;
  const auto& shape = static_cast<const btTriangleShape&>(*piece.getCollisionShape());
  const std::size_t i = around_->find(piece.m_partId, piece.m_index, shape.m_vertices1);
  return i < around_->triangles().size() ? &known_triangle(i) : nullptr;
}

void NearPieces::collect_children(const btCompoundShape& compound, const btTransform& pose, int except,
                                  Search& search) {
  for_each_child_meeting(compound, btDbvtVolume::FromCR(pose.invXform(search.centre), search.reach), [&](int i) {
    if (i != except) collect(*compound.getChildShape(i), pose * compound.getChildTransform(i), nullptr, search);
  });
}

void NearPieces::collect_in_frame(const ChildOf& except, const NearPoint& near, Search& search) {
  const btCompoundShape& compound = except.compound;
  BulletShapeCache& cache = search.shapes.cache;
  const auto add = [&](int i) {
    const btCollisionShape& shape = *compound.getChildShape(i);
    if (!shape.isConvex()) {
      collect(shape, compound.getChildTransform(i), nullptr, search);
      return;
    }
    const UnionPiece& piece = facts_.piece_of({compound, i}, cache);
    if (!piece.planes.empty()) search.found.push_back(&piece);
  };
  // As the search has them, in Bullet's scalar.
  const NearPoint rounded{to_pd(search.centre), static_cast<double>(search.reach), 4 * near.slack};
  if (search.beyond != nullptr && facts_.rising_near(except, rounded, *search.beyond, cache, near_)) {
    for (const int i : near_) add(i);
    return;
  }
  const auto visit = [&](int i) {
    if (i == except.number) return;
    const UnionPiece& piece = facts_.piece_of({compound, i}, cache);
    const auto parts = [&](const PiecePlane& plane) { return plane.height(rounded.point) > rounded.reach; };
    if (std::none_of(piece.planes.begin(), piece.planes.end(), parts)) add(i);
  };
  if (const auto* neighbours = facts_.neighbours(except, rounded.slack, cache)) {
    for (const int i : *neighbours) visit(i);
  } else {
    for_each_child_meeting(compound, btDbvtVolume::FromCR(search.centre, search.reach), visit);
  }
}

bool NearPieces::within(const btVector3& lower, const btVector3& upper, const Search& search) {
  for (int i = 0; i < 3; ++i) {
    if (lower[i] > search.centre[i] + search.reach || upper[i] < search.centre[i] - search.reach) return false;
  }
  if (search.beyond == nullptr) return true;
  const Vec3& n = search.beyond->n;
  const Vec3 far = n.cwiseProduct(to_pd(lower)).cwiseMax(n.cwiseProduct(to_pd(upper)));
  return far.sum() > search.beyond->level;
}

void NearPieces::collect_known(const btCollisionObjectWrapper& except, Search& search, const btVector3& lower,
                               const btVector3& upper) {
  const std::span<const MeshTriangle> triangles = around_->triangles();
  Vec3 n = Vec3::Zero();
  double level = -1;
  if (const Beyond* beyond = search.beyond) {
    n = around_pose_.rotation().transpose() * beyond->n;
    level = beyond->level - beyond->n.dot(around_pose_.translation());
  }
  around_->for_each_in(lower, upper, [&](std::size_t i) {
    const MeshTriangle& triangle = triangles[i];
    const std::array<Vec3, 3>& corners = around_->corners()[i];
    if (triangle.part == except.m_partId && triangle.index == except.m_index) return;
    if (std::max({n.dot(corners[0]), n.dot(corners[1]), n.dot(corners[2])}) + around_margin_ <= level) return;
    const UnionPiece& piece = known_triangle(i);
    if (!piece.planes.empty()) search.found.push_back(&piece);
  });
}

UnionPiece& NearPieces::known_triangle(std::size_t i) {
  if (!known_made_[i]) {
    known_made_[i] = true;
    const std::array<Vec3, 3>& corners = around_->corners()[i];
    set_triangle({around_pose_.apply(corners[0]), around_pose_.apply(corners[1]), around_pose_.apply(corners[2])},
                 around_margin_, known_[i]);
  }
  return known_[i];
}

void NearPieces::collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
                         Search& search) {
  if (shape.isCompound()) {
    collect_children(static_cast<const btCompoundShape&>(shape), pose, -1, search);
  } else if (shape.isConcave()) {
    const auto& concave = static_cast<const btConcaveShape&>(shape);
    const btVector3 local = pose.invXform(search.centre);
    // Surfaces lie flush, not cores, where the margins of two meshes differ.
    const btScalar reach = search.reach + (except != nullptr ? 0 : concave.getMargin());
    const btVector3 extent(reach, reach, reach);
    const bool known = except != nullptr && except->m_parent->m_parent == nullptr && around_ != nullptr &&
                       around_->cover(concave, local - extent, local + extent);
    if (known) {
      collect_known(*except, search, local - extent, local + extent);
      return;
    }
    const auto margin = static_cast<double>(concave.getMargin());
    for_each_triangle(concave, local - extent, local + extent, [&](const btVector3* corners, int part, int index) {
      if (except != nullptr && except->m_partId == part && except->m_index == index) return;
      const std::array points{to_pd(pose(corners[0])), to_pd(pose(corners[1])), to_pd(pose(corners[2]))};
      if (const Beyond* beyond = search.beyond) {
        const auto height = [&](const Vec3& point) { return beyond->n.dot(point); };
        if (std::max({height(points[0]), height(points[1]), height(points[2])}) + margin <= beyond->level) return;
      }
      UnionPiece& piece = next_made();
      set_triangle(points, margin, piece);
      if (piece.planes.empty()) return;
      search.found.push_back(&piece);
      ++num_made_;
    });
  } else if (shape.isConvex()) {
    btVector3 lower, upper;
    shape.getAabb(pose, lower, upper);
    if (!within(lower, upper, search)) return;
    const auto found = search.shapes.find(static_cast<const btConvexShape&>(shape));
    if (!found || !found->body) return;
    UnionPiece& piece = next_made();
    set_solid(found->sharp ? *found->sharp : *found->body, to_pd(pose), piece);
    if (piece.planes.empty()) return;
    search.found.push_back(&piece);
    ++num_made_;
  }
}

void NearPieces::find(const PieceInFrame& piece, const NearPoint& near, const Beyond* beyond, const StepShapes& shapes,
                      std::vector<const UnionPiece*>& found) {
  found.clear();
  Search search{to_bullet(near.point), static_cast<btScalar>(near.reach), beyond, shapes, found};
  if (!piece.frame.is_world) {
    const auto& compound = static_cast<const btCompoundShape&>(*piece.wrapper.m_parent->getCollisionShape());
    collect_in_frame({compound, piece.wrapper.m_index}, near, search);
    return;
  }
  for (const btCollisionObjectWrapper* child = &piece.wrapper; child->m_parent != nullptr; child = child->m_parent) {
    const btCollisionObjectWrapper& parent = *child->m_parent;
    const btCollisionShape& shape = *parent.getCollisionShape();
    if (shape.isConcave()) {
      collect(shape, parent.getWorldTransform(), child, search);
      search.reach += shape.getMargin();  // siblings may have none
    } else if (shape.isCompound()) {
      collect_children(static_cast<const btCompoundShape&>(shape), parent.getWorldTransform(), child->m_index, search);
    }
  }
}

}  // namespace pd::detail
