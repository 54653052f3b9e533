/// @file
/// What the contact algorithm remembers of a pair between steps, reachable by the pair's manifold so that snapshots can
/// save it: a replay is bit for bit only if the warm start is the same.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btVector3.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "pair/flight_memory.hpp"
#include "pair/impulse_trend.hpp"
#include "pair/sheet_memory.hpp"
#include "pair/standing_still.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/union_contact/parted_pieces.hpp"
#include "shapes/cached_shape.hpp"

class btPersistentManifold;

namespace pd::detail {

/// Which feature pair made a manifold point: the point is recognised by its exact local position.
struct RememberedPoint {
  btVector3 local_a;
  std::int64_t feature_id;
  ImpulseTrend impulse;
};

/// Of two pieces in a pair with a compound or mesh: two children, or a body and a triangle.
struct PieceMemory {
  std::uint64_t pieces = 0;  ///< both children's numbers, or the triangle's
  bool met = false;          ///< the last step was within reach of contacts
  PartedPieces parted;       ///< of two children
  WarmCertificate warm;
  std::array<std::shared_ptr<CachedShape>, 2> shapes;
};

/// A heavy body that a light one carries (world/heavy_loads.hpp).
struct HeavyLoad {
  bool carried = false;  ///< the sweeps alone do not find the load
  bool known = false;    ///< the heavy body's motion at the end of the last step
  btVector3 velocity = btVector3(0, 0, 0), turn = btVector3(0, 0, 0), centre = btVector3(0, 0, 0);

  void begin(const btRigidBody& heavy) {
    known = true;
    velocity = heavy.getLinearVelocity();
    turn = heavy.getAngularVelocity();
    centre = heavy.getCenterOfMassPosition();
  }
};

class ManifoldOwner;

/// Holds what the search for the points of a pair with a mesh or compound remembers.
struct UnionPairMemory {
  std::vector<PieceMemory> pieces;  ///< sorted by number
  /// The shapes of both bodies' children as they were when last met, at the child's number + 1.
  std::array<std::vector<std::shared_ptr<CachedShape>>, 2> children;
  StandingStill standing;         ///< of a body on a mesh
  SheetMemory sheet;              ///< the same
  int union_pause = 0;            ///< steps for which the whole unions are not asked again (deep_union.hpp)
  int union_refusals = 0;         ///< in a row
  Vec3 union_way = Vec3::Zero();  ///< along which the unions were led out in the last step, zero: they were not

  /// The shape of one child (-1: the body itself) of body 0 or 1; null where it was never met.
  [[nodiscard]] std::shared_ptr<CachedShape>& shape_of_child(std::size_t body, int child) {
    const auto place = static_cast<std::size_t>(child + 1);
    if (place >= children[body].size()) children[body].resize(place + 1);
    return children[body][place];
  }
};

struct PairMemory : UnionPairMemory {
  int patch = -1;  ///< the manifold's number among those of a pair with a mesh or compound; -1: of a single pair
  ManifoldOwner* owner = nullptr;  ///< of a manifold with a number
  WarmCertificate warm;
  /// Held so that the certificate's shapes stay where they are, and so that a pair looks nothing up that has not
  /// changed.
  std::array<std::shared_ptr<CachedShape>, 2> shapes;
  std::array<RememberedPoint, 4> points;
  int num_points = 0;
  btScalar seconds = 0;  ///< of the step that the points' impulses belong to
  HeavyLoad load;
  FlightMemory flight;  ///< of two boxes

  /// Nothing that an answer could depend on: shapes that are held spare look-ups only.
  [[nodiscard]] bool is_blank() const {
    return patch < 0 && num_points == 0 && pieces.empty() && standing.empty() && sheet.empty() && union_refusals == 0 &&
           !load.known && !flight.known() && warm.memory_bytes() == sizeof(warm);
  }
};

/// Whoever made manifolds beyond the first of a pair, and can do without them.
class ManifoldOwner {
 public:
  virtual ~ManifoldOwner() = default;
  /// Releases the pair's manifolds from this number (> 0) on.
  virtual void release_from(int patch) = 0;
};

/// Memories by manifold. Algorithms come and go on the dispatcher's threads.
class PairRegistry {
 public:
  void add(const btPersistentManifold* manifold, PairMemory* memory) {
    const std::lock_guard lock(mutex_);
    memories_[manifold] = memory;
  }
  void remove(const btPersistentManifold* manifold) {
    const std::lock_guard lock(mutex_);
    memories_.erase(manifold);
  }
  [[nodiscard]] PairMemory* find(const btPersistentManifold* manifold) {
    const std::lock_guard lock(mutex_);
    return found(manifold);
  }
  /// Calls `visit(i, memory)` for each of `count` manifolds, nullptr where it has none; all under one lock.
  template <class Visit>
  void visit_all(const btPersistentManifold* const* manifolds, int count, Visit&& visit) const {
    const std::lock_guard lock(mutex_);
    for (int i = 0; i < count; ++i) visit(i, found(manifolds[i]));
  }

 private:
  [[nodiscard]] PairMemory* found(const btPersistentManifold* manifold) const {
    const auto at = memories_.find(manifold);
    return at == memories_.end() ? nullptr : at->second;
  }

  mutable std::mutex mutex_;
  std::unordered_map<const btPersistentManifold*, PairMemory*> memories_;  // looked up only, never iterated
};

}  // namespace pd::detail
