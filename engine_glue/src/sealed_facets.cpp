#include "sealed_facets.hpp"

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "solver_core.hpp"

namespace pd::detail {

namespace {

/// Compounds that a thread remembers.
constexpr std::size_t kMostCompounds = 256;

const ConvexShape* taken_of(const CachedShape& shape) { return shape.sharp ? shape.sharp.get() : shape.body.get(); }

}  // namespace

bool SealedFacets::sealed(const btCompoundShape& compound, int child, std::size_t facet, SolverCore& core) {
  if (compounds_.size() >= kMostCompounds && !compounds_.contains(&compound)) compounds_.clear();
  Known& known = compounds_[&compound];
  if (stamp_ == 0 ? known.pair != pair_ : known.stamp != stamp_) compare(compound, core, known);
  const auto place = static_cast<std::size_t>(child);
  std::vector<Seal>& facets = known.children[place].facets;
  if (facet >= facets.size()) return false;
  if (facets[facet] == Seal::unknown) facets[facet] = find_seal(known, place, facet) ? Seal::sealed : Seal::open;
  return facets[facet] == Seal::sealed;
}

void SealedFacets::compare(const btCompoundShape& compound, SolverCore& core, Known& known) const {
  known.stamp = stamp_;
  known.pair = pair_;
  const int count = compound.getNumChildShapes();
  bool same = known.children.size() == static_cast<std::size_t>(count);
  known.children.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Child& child = known.children[static_cast<std::size_t>(i)];
    const btCollisionShape& source = *compound.getChildShape(i);
    std::shared_ptr<CachedShape> shape;
    if (source.isConvex()) shape = core.cache.find(static_cast<const btConvexShape&>(source), stamp_);
    if (same && child.source == &source && child.shape == shape && child.place == compound.getChildTransform(i))
      continue;
    same = false;
    child.source = &source;
    child.place = compound.getChildTransform(i);
    child.shape = std::move(shape);
    child.piece.planes.clear();
    if (!child.shape || !child.shape->body) continue;
    set_solid(*taken_of(*child.shape), to_pd(child.place), child.piece);
    btVector3 lower, upper;
    source.getAabb(child.place, lower, upper);
    child.lower = to_pd(lower);
    child.upper = to_pd(upper);
  }
  if (same) return;
  for (Child& child : known.children) child.facets.assign(child.piece.planes.size(), Seal::unknown);
}

bool SealedFacets::find_seal(const Known& known, std::size_t number, std::size_t facet) {
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
      const double reach = 2 * slack;
      if ((other.lower - level).maxCoeff() > reach || (level - other.upper).maxCoeff() > reach) return false;
      return covered_sine(other.piece, level, n, slack, kBeyondDoubt, active_) > kDecided;
    });
  };
  return std::any_of(known.children.begin(), known.children.end(), covers);
}

}  // namespace pd::detail
