#include "pieces/compound_facts.hpp"

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "shapes/child_tree.hpp"

namespace pd::detail {

namespace {

/// Compounds that a thread remembers.
constexpr std::size_t kMostKnownCompounds = 256;

/// Of a child's diagonal: what comes so near counts as its neighbour.
constexpr btScalar kNeighbourhood = 0x1p-6F;

/// How near another child's box comes to one with these corners, to be its neighbour.
btScalar reach_of(const btVector3& lower, const btVector3& upper) { return kNeighbourhood * (upper - lower).length(); }

/// True if a child may come within reach of a point of another one's core.
bool comes_near(const UnionPiece& own, const UnionPiece& other, const NearPoint& near) {
  // Surfaces lie flush, not cores, where margins differ.
  const double far = near.reach + std::abs(own.margin - other.margin);
  return std::none_of(other.planes.begin(), other.planes.end(),
                      [&](const PiecePlane& plane) { return plane.height(near.point) > far; });
}

const ConvexShape* taken_of(const CachedShape& shape) { return shape.sharp ? shape.sharp.get() : shape.body.get(); }

}  // namespace

double CompoundFacts::Child::known_within() const { return 0.5 * static_cast<double>(reach_of(lower, upper)); }

CompoundFacts::Known& CompoundFacts::known_of(const btCompoundShape& compound) {
  const auto is_recent = [&] { return recent_[0].of == &compound && recent_[0].visit == visit_; };
  if (!is_recent()) {
    std::swap(recent_[0], recent_[1]);
    if (!is_recent()) {
      if (compounds_.size() >= kMostKnownCompounds && !compounds_.contains(&compound)) {
        compounds_.clear();
        recent_ = {};
      }
      recent_[0] = {&compounds_[&compound], &compound, visit_};
    }
  }
  Known& known = *recent_[0].known;
  const auto count = static_cast<std::size_t>(compound.getNumChildShapes());
  if (known.children.size() != count) {
    known.children.resize(count);
    ++known.change;
  }
  return known;
}

CompoundFacts::Child& CompoundFacts::compared(const ChildOf& of, Known& known, BulletShapeCache& cache) const {
  const auto& [compound, number] = of;
  Child& child = known.children[static_cast<std::size_t>(number)];
  if (child.compared == visit_) return child;
  child.compared = visit_;
  const btCollisionShape& source = *compound.getChildShape(number);
  const CachedShape* const before = child.shape.get();
  if (source.isConvex()) {
    StepShapes{cache, stamp_}.refresh(static_cast<const btConvexShape&>(source), child.shape);
  } else {
    child.shape.reset();
  }
  const bool kept = child.source == &source && child.shape.get() == before && before != nullptr &&
                    child.place == compound.getChildTransform(number);
  if (kept) return child;
  ++known.change;
  child.source = &source;
  child.place = compound.getChildTransform(number);
  child.piece.planes.clear();
  source.getAabb(child.place, child.lower, child.upper);
  child.corners.clear();
  if (!child.shape || !child.shape->body) return child;
  const ConvexShape& shape = *taken_of(*child.shape);
  const Pose place = to_pd(child.place);
  set_solid(shape, place, child.piece);
  if (child.piece.planes.empty()) return child;
  for (int v = 0; v < shape.polytope()->num_vertices(); ++v) {
    child.corners.push_back(place.apply(shape.polytope()->vertex(v)));
  }
  return child;
}

void CompoundFacts::find_neighbours(const ChildOf& of, Known& known, BulletShapeCache& cache) const {
  const auto& [compound, number] = of;
  Child& own = known.children[static_cast<std::size_t>(number)];
  std::vector<int>& neighbours = own.neighbours;
  const btScalar within = reach_of(own.lower, own.upper);
  const btVector3 extra(within, within, within);
  neighbours.clear();
  for_each_child_meeting(compound, btDbvtVolume::FromMM(own.lower - extra, own.upper + extra), [&](int i) {
    if (i == of.number) return;
    const Child& other = compared({of.compound, i}, known, cache);
    if (TestAabbAgainstAabb2(own.lower - extra, own.upper + extra, other.lower, other.upper)) neighbours.push_back(i);
  });
  // The tree's order depends on its history.
  std::sort(neighbours.begin(), neighbours.end());
}

CompoundFacts::Child& CompoundFacts::surrounded(const ChildOf& of, Known& known, BulletShapeCache& cache) {
  Child& child = known.children[static_cast<std::size_t>(of.number)];
  if (child.surrounded == visit_ && child.facts == known.change) return child;
  compared(of, known, cache);
  if (child.surrounded != visit_ && child.facts == known.change) {
    for (const int i : child.neighbours) compared({of.compound, i}, known, cache);
  }
  child.surrounded = visit_;
  if (child.facts != known.change) {
    find_neighbours(of, known, cache);
    child.facts = known.change;
    child.facets.assign(child.piece.planes.size(), FacetCover::unknown);
  }
  return child;
}

FacetCover CompoundFacts::cover_of(const ChildOf& of, std::size_t facet, double slack, BulletShapeCache& cache) {
  Known& known = known_of(of.compound);
  Child& child = surrounded(of, known, cache);
  if (facet >= child.facets.size() || slack > child.known_within()) {
    return FacetCover::some;
  }
  FacetCover& cover = child.facets[facet];
  if (cover == FacetCover::unknown) cover = find_cover(of, known, facet, cache);
  return cover;
}

const std::vector<int>* CompoundFacts::neighbours(const ChildOf& of, double reach, BulletShapeCache& cache) {
  const Child& own = surrounded(of, known_of(of.compound), cache);
  return reach <= own.known_within() ? &own.neighbours : nullptr;
}

bool CompoundFacts::may_hold(const ChildOf& of, const NearPoint& near, BulletShapeCache& cache) {
  Known& known = known_of(of.compound);
  const Child& own = surrounded(of, known, cache);
  if (near.slack > own.known_within()) return true;
  return std::any_of(own.neighbours.begin(), own.neighbours.end(), [&](int i) {
    const Child& other = known.children[static_cast<std::size_t>(i)];
    if (other.piece.planes.empty()) return !other.source->isConvex();
    return comes_near(own.piece, other.piece, near);
  });
}

bool CompoundFacts::rising_near(const ChildOf& of, const NearPoint& near, const Beyond& beyond, BulletShapeCache& cache,
                                std::vector<int>& rising) {
  Known& known = known_of(of.compound);
  const Child& own = surrounded(of, known, cache);
  if (near.slack > own.known_within()) return false;
  rising.clear();
  for (const int i : own.neighbours) {
    const Child& other = known.children[static_cast<std::size_t>(i)];
    if (other.piece.planes.empty()) {
      if (!other.source->isConvex()) rising.push_back(i);
      continue;
    }
    const double level_of_core = beyond.level - other.piece.margin;
    const auto rises = [&](const Vec3& corner) { return beyond.n.dot(corner) > level_of_core; };
    if (std::none_of(other.corners.begin(), other.corners.end(), rises)) continue;
    if (comes_near(own.piece, other.piece, near)) rising.push_back(i);
  }
  return true;
}

FacetCover CompoundFacts::find_cover(const ChildOf& of, Known& known, std::size_t facet, BulletShapeCache& cache) {
  const Child& own = known.children[static_cast<std::size_t>(of.number)];
  const ConvexShape& shape = *taken_of(*own.shape);
  const PosedShape posed{&shape, to_pd(own.place)};
  const Vec3& n = own.piece.planes[facet].normal;
  const double slack = 0.5 * seam_slack(posed, posed);
  const auto corners = shape.polytope()->facet_vertices(static_cast<int>(facet));
  // Surfaces lie flush, not cores, where margins differ.
  const auto lifted = [&](auto corner, const UnionPiece& other) {
    return Vec3(own.corners[static_cast<std::size_t>(corner)] + (own.piece.margin - other.margin) * n);
  };
  const auto covers = [&](const Child& other) {
    return !other.piece.planes.empty() && std::all_of(corners.begin(), corners.end(), [&](auto corner) {
      return covered_sine(other.piece, lifted(corner, other.piece), n, slack, kBeyondDoubt, active_) > kDecided;
    });
  };
  // It does not rise beyond the facet, or all of the facet is on the outer side of one of its planes, and most of it
  // farther than any contact's slack.
  const double wide = static_cast<double>(reach_of(own.lower, own.upper));
  const double level = own.piece.planes[facet].offset + own.piece.margin + slack;
  const auto leaves_free = [&](const Child& other) {
    if (other.piece.planes.empty()) return other.source->isConvex();
    const auto rises = [&](const Vec3& corner) { return n.dot(corner) + other.piece.margin > level; };
    if (std::none_of(other.corners.begin(), other.corners.end(), rises)) return true;
    return std::any_of(other.piece.planes.begin(), other.piece.planes.end(), [&](const PiecePlane& plane) {
      double least = wide, most = 0;
      for (const auto corner : corners) {
        const double height = plane.height(lifted(corner, other.piece));
        least = std::min(least, height);
        most = std::max(most, height);
      }
      return least >= -slack && most >= wide;
    });
  };
  bool free = true;
  for (const int i : own.neighbours) {
    const Child& other = compared({of.compound, i}, known, cache);
    if (covers(other)) return FacetCover::all;
    free = free && leaves_free(other);
  }
  return free ? FacetCover::none : FacetCover::some;
}

void look_at(const btCollisionObjectWrapper& body, std::span<const Child> children, CompoundFacts& facts,
             BulletShapeCache& cache) {
  if (!body.getCollisionShape()->isCompound()) return;
  const auto& compound = static_cast<const btCompoundShape&>(*body.getCollisionShape());
  for (const Child& child : children) facts.look_at({compound, child.index}, cache);
}

}  // namespace pd::detail
