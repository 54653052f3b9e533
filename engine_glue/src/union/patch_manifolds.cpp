#include "union/patch_manifolds.hpp"

#include <array>
#include <optional>

#include "pair/solver_core.hpp"
#include "pair/step_reach.hpp"
#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

FreshPoints fresh_points(const Patch& patch) {
  FreshPoints fresh;
  fresh.count = patch.count;
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.count); ++k) {
    set_fresh_point(to_bullet(patch.points[k].normal), patch.points[k].contact, fresh.points[k]);
    fresh.points[k].piece = patch.points[k].piece;
  }
  return fresh;
}

}  // namespace

PatchManifolds::~PatchManifolds() {
  for (const auto& kept : manifolds_) {
    core_.pairs.remove(kept->manifold);
    dispatcher_.releaseManifold(kept->manifold);
  }
}

void PatchManifolds::release_from(int patch) {
  while (static_cast<int>(manifolds_.size()) > patch) {
    core_.pairs.remove(manifolds_.back()->manifold);
    dispatcher_.releaseManifold(manifolds_.back()->manifold);
    manifolds_.pop_back();
  }
}

PatchManifolds::Kept& PatchManifolds::at(std::size_t i, const btCollisionObject& a, const btCollisionObject& b) {
  while (i >= manifolds_.size()) {
    manifolds_.push_back(std::make_unique<Kept>());
    manifolds_.back()->manifold = dispatcher_.getNewManifold(&a, &b);
    manifolds_.back()->memory.patch = static_cast<int>(manifolds_.size()) - 1;
    manifolds_.back()->memory.owner = this;
    core_.pairs.add(manifolds_.back()->manifold, &manifolds_.back()->memory);
  }
  return *manifolds_[i];
}

void PatchManifolds::clear() {
  for (const auto& kept : manifolds_) {
    if (kept->manifold->getNumContacts() > 0) kept->manifold->clearManifold();
  }
}

void PatchManifolds::append_to(btManifoldArray& manifolds) const {
  for (const auto& kept : manifolds_) manifolds.push_back(kept->manifold);
}

std::span<const LastPatch> PatchManifolds::last_patches(std::array<int, kMost>& of, LastPatches& patches) const {
  std::size_t count = 0;
  for (std::size_t m = 0; m < manifolds_.size(); ++m) {
    const btPersistentManifold& manifold = *manifolds_[m]->manifold;
    if (manifold.getNumContacts() == 0) continue;
    LastPatch& last = patches[count];
    last.normal.setZero();
    last.count = manifold.getNumContacts();
    const btTransform& pose_b = manifold.getBody1()->getWorldTransform();
    for (int k = 0; k < last.count; ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      last.places[static_cast<std::size_t>(k)] = to_pd(pose_b(point.m_localPointB));
      last.normal += to_pd(point.m_normalWorldOnB);
    }
    last.normal.normalize();
    of[count++] = static_cast<int>(m);
  }
  return {patches.data(), count};
}

void PatchManifolds::replace(Patches& patches, const StepTime& seconds, btManifoldResult& result,
                             PointSurroundings& pieces) {
  btPersistentManifold& first = *manifolds_[0]->manifold;
  if (patches.empty()) {
    clear();
    return;
  }
  const btCollisionObject& a = *first.getBody0();
  const btCollisionObject& b = *first.getBody1();
  std::array<int, kMost> of{};
  LastPatches last;
  patches.choose(kMost, static_cast<double>(first.getContactBreakingThreshold()), last_patches(of, last));
  std::array<int, kMost> heirs{};
  heirs.fill(-1);
  for (int i = 0; i < patches.size(); ++i) {
    if (patches[i].last >= 0) heirs[static_cast<std::size_t>(of[static_cast<std::size_t>(patches[i].last)])] = i;
  }
  // New patches go where the first ones are free.
  std::size_t free = 0;
  for (int i = 0; i < patches.size(); ++i) {
    if (patches[i].last >= 0) continue;
    while (heirs[free] >= 0) ++free;
    heirs[free] = i;
  }
  std::optional<StepReach> reach;
  if (is_link(a) || is_link(b)) reach.emplace(a, b, result, first.getContactBreakingThreshold(), seconds);
  for (std::size_t m = 0; m < static_cast<std::size_t>(kMost); ++m) {
    if (heirs[m] < 0) {
      if (m < manifolds_.size()) manifolds_[m]->manifold->clearManifold();
      continue;
    }
    Kept& kept = at(m, a, b);
    FreshPoints fresh = fresh_points(patches[heirs[m]]);
    if (reach) reach->leave_out_idle_of_links(fresh);
    result.setPersistentManifold(kept.manifold);
    replace_points({*kept.manifold, kept.memory, fresh, seconds, result, &pieces});
  }
  result.setPersistentManifold(&first);
}

}  // namespace pd::detail
