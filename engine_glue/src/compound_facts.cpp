#include "compound_facts.hpp"

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// Compounds that a thread remembers.
constexpr std::size_t kMostKnownCompounds = 256;

/// Of a child's diagonal: what comes so near counts as its neighbour.
constexpr btScalar kNeighbourhood = 0x1p-6F;

const ConvexShape* taken_of(const CachedShape& shape) { return shape.sharp ? shape.sharp.get() : shape.body.get(); }

}  // namespace

CompoundFacts::Known& CompoundFacts::known_of(const btCompoundShape& compound, SolverCore& core) {
  if (recent_ != nullptr && recent_pair_ == pair_ && recent_of_ == &compound) return *recent_;
  if (compounds_.size() >= kMostKnownCompounds && !compounds_.contains(&compound)) compounds_.clear();
  Known& known = compounds_[&compound];
  if (stamp_ == 0 ? known.pair != pair_ : known.stamp != stamp_) compare(compound, core, known);
  recent_ = &known;
  recent_of_ = &compound;
  recent_pair_ = pair_;
  return known;
}

bool CompoundFacts::sealed(const btCompoundShape& compound, int child, std::size_t facet, SolverCore& core) {
  Known& known = known_of(compound, core);
  const auto place = static_cast<std::size_t>(child);
  std::vector<Seal>& facets = known.children[place].facets;
  if (facet >= facets.size()) return false;
  if (facets[facet] == Seal::unknown) facets[facet] = find_seal(known, place, facet) ? Seal::sealed : Seal::open;
  return facets[facet] == Seal::sealed;
}

const std::vector<int>* CompoundFacts::neighbours(const btCompoundShape& compound, int number, double reach,
                                                  SolverCore& core) {
  std::vector<Child>& children = known_of(compound, core).children;
  Child& own = children[static_cast<std::size_t>(number)];
  if (own.reach < 0) {
    const btScalar within = kNeighbourhood * (own.upper - own.lower).length();
    const btVector3 extra(within, within, within);
    own.reach = 0.5 * static_cast<double>(within);
    own.neighbours.clear();
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (&children[i] == &own) continue;
      if (TestAabbAgainstAabb2(own.lower - extra, own.upper + extra, children[i].lower, children[i].upper)) {
        own.neighbours.push_back(static_cast<int>(i));
      }
    }
  }
  return reach <= own.reach ? &own.neighbours : nullptr;
}

void CompoundFacts::compare(const btCompoundShape& compound, SolverCore& core, Known& known) const {
  known.stamp = stamp_;
  known.pair = pair_;
  const int count = compound.getNumChildShapes();
  bool same = known.children.size() == static_cast<std::size_t>(count);
  known.children.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Child& child = known.children[static_cast<std::size_t>(i)];
    const btCollisionShape& source = *compound.getChildShape(i);
    const CachedShape* const before = child.shape.get();
    if (source.isConvex()) {
      core.refresh(static_cast<const btConvexShape&>(source), stamp_, child.shape);
    } else {
      child.shape.reset();
    }
    const bool kept = child.source == &source && child.shape.get() == before && before != nullptr &&
                      child.place == compound.getChildTransform(i);
    if (kept) continue;
    same = false;
    child.source = &source;
    child.place = compound.getChildTransform(i);
    child.piece.planes.clear();
    source.getAabb(child.place, child.lower, child.upper);
    if (child.shape && child.shape->body) set_solid(*taken_of(*child.shape), to_pd(child.place), child.piece);
  }
  if (same) return;
  for (Child& child : known.children) {
    child.facets.assign(child.piece.planes.size(), Seal::unknown);
    child.reach = -1;
  }
}

bool CompoundFacts::find_seal(const Known& known, std::size_t number, std::size_t facet) {
  const Child& own = known.children[number];
  const ConvexShape& shape = *taken_of(*own.shape);
  const PosedShape posed{&shape, to_pd(own.place)};
  const Vec3& n = own.piece.planes[facet].normal;
  const double slack = 0.5 * seam_slack(posed, posed);
  corners_.clear();
  for (const auto v : shape.polytope()->facet_vertices(static_cast<int>(facet))) {
    corners_.push_back(posed.pose.apply(shape.polytope()->vertex(v)));
  }
  const auto covers = [&](const Child& other) {
    if (&other == &own || other.piece.planes.empty()) return false;
    const double up = own.piece.margin - other.piece.margin;
    return std::all_of(corners_.begin(), corners_.end(), [&](const Vec3& corner) {
      const Vec3 level = corner + up * n;
      return covered_sine(other.piece, level, n, slack, kBeyondDoubt, active_) > kDecided;
    });
  };
  const btVector3 extra(static_cast<btScalar>(4 * slack), static_cast<btScalar>(4 * slack),
                        static_cast<btScalar>(4 * slack));
  return std::any_of(known.children.begin(), known.children.end(), [&](const Child& other) {
    return TestAabbAgainstAabb2(own.lower - extra, own.upper + extra, other.lower, other.upper) && covers(other);
  });
}

}  // namespace pd::detail
