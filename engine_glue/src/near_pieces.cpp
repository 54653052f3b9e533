#include "near_pieces.hpp"

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

#include <algorithm>
#include <array>

#include "child_tree.hpp"
#include "pd/bullet/scalar.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// Of so few children each is compared; of more, Bullet's tree is asked.
constexpr int kFewChildren = 32;

bool meets(const btDbvtVolume& volume, const btVector3& lower, const btVector3& upper) {
  for (int i = 0; i < 3; ++i) {
    if (volume.Mins()[i] > upper[i] || volume.Maxs()[i] < lower[i]) return false;
  }
  return true;
}

/// Calls `visit(number)` for the children whose boxes come near a point of the compound's frame.
template <class Visit>
void for_each_child_near(const btCompoundShape& compound, const btVector3& centre, btScalar reach, const Visit& visit) {
  const btDbvt* tree = compound.getDynamicAabbTree();
  const int count = compound.getNumChildShapes();
  if (tree != nullptr && count > kFewChildren) {
    for_each_leaf(*tree, btDbvtVolume::FromCR(centre, reach), visit);
    return;
  }
  const btVector3 extent(reach, reach, reach);
  // Bullet offers no children to a reader of a constant compound.
  const btCompoundShapeChild* children = const_cast<btCompoundShape&>(compound).getChildList();
  for (int i = 0; i < count; ++i) {
    if (tree == nullptr || meets(children[i].m_node->volume, centre - extent, centre + extent)) visit(i);
  }
}

}  // namespace

/// What is collected, where.
struct NearPieces::Search {
  btVector3 centre;
  btScalar reach;
  const Beyond* beyond;
  std::uint64_t stamp;
  SolverCore& core;
};

class NearPieces::TrianglesOf : public btTriangleCallback {
 public:
  TrianglesOf(const btTransform& pose, double margin, const btCollisionObjectWrapper* except, const Beyond* beyond,
              NearPieces& list)
      : pose_(pose), margin_(margin), except_(except), beyond_(beyond), list_(list) {}
  void processTriangle(btVector3* corners, int part, int index) override {
    if (except_ != nullptr && except_->m_partId == part && except_->m_index == index) return;
    const std::array points{to_pd(pose_(corners[0])), to_pd(pose_(corners[1])), to_pd(pose_(corners[2]))};
    if (beyond_ != nullptr) {
      const auto height = [&](const Vec3& point) { return beyond_->n.dot(point); };
      if (std::max({height(points[0]), height(points[1]), height(points[2])}) + margin_ <= beyond_->level) return;
    }
    UnionPiece& piece = list_.next_made().piece;
    set_triangle(points, margin_, piece);
    if (piece.planes.empty()) return;
    list_.found_.push_back(&piece);
    ++list_.num_made_;
  }

 private:
  const btTransform& pose_;
  double margin_;
  const btCollisionObjectWrapper* except_;
  const Beyond* beyond_;
  NearPieces& list_;
};

NearPieces::Child& NearPieces::next_made() {
  if (num_made_ == made_.size()) made_.emplace_back();
  return made_[num_made_];
}

std::vector<NearPieces::Child>& NearPieces::children_of(const btCollisionObject& body, int count) {
  for (std::size_t i = 0; i < num_compounds_; ++i) {
    if (compounds_[i].body == &body) return compounds_[i].children;
  }
  if (num_compounds_ == compounds_.size()) compounds_.emplace_back();
  PosedCompound& compound = compounds_[num_compounds_++];
  compound.body = &body;
  if (compound.children.size() < static_cast<std::size_t>(count)) {
    compound.children.resize(static_cast<std::size_t>(count));
  }
  return compound.children;
}

void NearPieces::collect_children(const btCompoundShape& compound, const btTransform& pose, int except,
                                  const btCollisionObject* body, Search& search) {
  std::vector<Child>* known = body != nullptr ? &children_of(*body, compound.getNumChildShapes()) : nullptr;
  for_each_child_near(compound, pose.invXform(search.centre), search.reach, [&](int i) {
    if (i == except) return;
    const btCollisionShape& shape = *compound.getChildShape(i);
    if (known == nullptr || !shape.isConvex()) {
      collect(shape, pose * compound.getChildTransform(i), nullptr, search);
      return;
    }
    Child& child = (*known)[static_cast<std::size_t>(i)];
    if (child.posed != pair_) {
      child.posed = pair_;
      child.pose = pose * compound.getChildTransform(i);
      shape.getAabb(child.pose, child.lower, child.upper);
    }
    collect_convex(static_cast<const btConvexShape&>(shape), child, search);
  });
}

void NearPieces::collect_convex(const btConvexShape& shape, Child& child, Search& search) {
  for (int i = 0; i < 3; ++i) {
    if (child.lower[i] > search.centre[i] + search.reach || child.upper[i] < search.centre[i] - search.reach) return;
  }
  if (search.beyond != nullptr) {
    const Vec3& n = search.beyond->n;
    const Vec3 far = n.cwiseProduct(to_pd(child.lower)).cwiseMax(n.cwiseProduct(to_pd(child.upper)));
    if (far.sum() <= search.beyond->level) return;
  }
  if (child.made != pair_) {
    child.made = pair_;
    child.piece.planes.clear();
    const auto shapes = search.core.cache.find(shape, search.stamp);
    if (shapes->body) set_solid(shapes->sharp ? *shapes->sharp : *shapes->body, to_pd(child.pose), child.piece);
  }
  if (!child.piece.planes.empty()) found_.push_back(&child.piece);
}

void NearPieces::collect(const btCollisionShape& shape, const btTransform& pose, const btCollisionObjectWrapper* except,
                         Search& search) {
  if (shape.isCompound()) {
    collect_children(static_cast<const btCompoundShape&>(shape), pose, -1, nullptr, search);
  } else if (shape.isConcave()) {
    const auto& concave = static_cast<const btConcaveShape&>(shape);
    const btVector3 local = pose.invXform(search.centre);
    const btVector3 extent(search.reach, search.reach, search.reach);
    TrianglesOf triangles(pose, static_cast<double>(concave.getMargin()), except, search.beyond, *this);
    concave.processAllTriangles(&triangles, local - extent, local + extent);
  } else if (shape.isConvex()) {
    Child& child = next_made();
    child.pose = pose;
    child.made = 0;
    shape.getAabb(pose, child.lower, child.upper);
    const std::size_t before = found_.size();
    collect_convex(static_cast<const btConvexShape&>(shape), child, search);
    num_made_ += found_.size() - before;
  }
}

int NearPieces::find(const btCollisionObjectWrapper& piece, const Vec3& point, double reach, const Beyond* beyond,
                     std::uint64_t stamp, SolverCore& core) {
  Search search{to_bullet(point), static_cast<btScalar>(reach), beyond, stamp, core};
  found_.clear();
  num_made_ = 0;
  for (const btCollisionObjectWrapper* child = &piece; child->m_parent != nullptr; child = child->m_parent) {
    const btCollisionObjectWrapper& parent = *child->m_parent;
    const btCollisionShape& shape = *parent.getCollisionShape();
    if (shape.isConcave()) {
      collect(shape, parent.getWorldTransform(), child, search);
    } else if (shape.isCompound()) {
      collect_children(static_cast<const btCompoundShape&>(shape), parent.getWorldTransform(), child->m_index,
                       parent.m_parent == nullptr ? parent.getCollisionObject() : nullptr, search);
    }
  }
  return static_cast<int>(found_.size());
}

}  // namespace pd::detail
