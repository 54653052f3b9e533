/// @file
/// Penetration depth for Bullet: exact, certified, and safe to share between the threads of a dispatcher.
///
/// What a client of Bullet includes parses as C++14: this header, install.hpp, rollback.hpp, snapshot.hpp,
/// stack_solver.hpp, solver_settings.hpp and contact_recorder.hpp. `query` and its answer need C++17 and C++20.
///
/// Bullet's convention is met here and nowhere else. pd_core's `normal` is the direction in which A leaves B, and so is
/// Bullet's `normalOnBInWorld`; Bullet's distance is minus the depth.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btConvexPenetrationDepthSolver.h>

#include <cstddef>
#include <cstdint>
#if __cplusplus >= 201703L
#include <optional>
#endif

class btCollisionAlgorithm;
class btCollisionObject;

namespace pd {

class BulletShapeCache;
class WarmCertificate;
struct BulletPairAnswer;
struct ContactManifold;

namespace detail {
class PairRegistry;
class SolverCore;
}  // namespace detail

struct BulletSolverSettings {
  /// 0: exact for polyhedral, sphere, capsule and swept shapes, 1e-6 relative for cylinders and cones. Else the
  /// relative error (1 + delta) for all, in (0, 1].
  double delta = 0;
  /// Asked for shapes that have no exact form (`to_convex_shape` refuses them as unsupported); must outlive the solver
  /// and be safe on the dispatcher's threads. nullptr: Bullet's own EPA. Either way such pairs are counted.
  btConvexPenetrationDepthSolver* fallback = nullptr;
  /// Told once for each Bullet type without exact form, in one line, from the thread that met it first. nullptr:
  /// silence.
  void (*warning)(const char* line, void* user) = print_warning;
  /// Which pairs of objects the contact algorithm takes, asked when a pair gets its algorithm; the others get the
  /// algorithm of the dispatcher's own configuration. nullptr: all. Pairs that have an algorithm keep it until they
  /// part, or until `install` is called again.
  bool (*takes_pair)(const btCollisionObject& a, const btCollisionObject& b, void* user) = nullptr;
  /// Handed to both.
  void* user = nullptr;
  /// True: the contact algorithm takes the triangles of a mesh or heightfield and the children of a compound as one
  /// body, and drops contacts with edges and faces inside of it (install.hpp). False: each piece is alone.
  bool unions_as_one = true;
  /// By default a mesh or heightfield is a sheet with two sides, and each pair remembers the side that its body came
  /// from: also a thin body nearly always stays there. This setting is for bodies that come from nowhere, since they
  /// start inside of a solid or a host puts them there. With unions_as_one: a mesh or heightfield is the surface of a
  /// solid, and not a sheet. A triangle's front is where its corners run counter-clockwise (of a heightfield, up). A
  /// body in front, or across an edge, meets it as ever; one that stands through it, however far, leaves by the front;
  /// one that is behind it without touching it meets nothing. Contact tests, sweeps and the search of a RollbackStepper
  /// take meshes as sheets all the same.
  bool one_sided_meshes = false;
  /// Entries of the shape cache.
  std::size_t cache_capacity = 4096;

  /// Writes the line to stderr.
  static void print_warning(const char* line, void* user);
};

/// Counts of a solver since it began.
struct BulletSolverStatistics {
  std::int64_t calls = 0;        ///< pairs asked for, by Bullet's detector or by the contact algorithm
  std::int64_t overlapping = 0;  ///< answers by class
  std::int64_t touching = 0;
  std::int64_t separated = 0;
  std::int64_t warm = 0;           ///< answers that the certificate of an earlier frame gave; two boxes need none
  std::int64_t unsupported = 0;    ///< pairs with a shape that has no exact form
  std::int64_t fallback = 0;       ///< of those, the ones that the fallback solver answered
  std::int64_t refused_poses = 0;  ///< pairs with a transform that is not finite or out of range
  std::int64_t support_calls = 0;  ///< supports of the Minkowski difference, over all answers
  /// Spent in pairs, from the look-up of their shapes to their answer, over all threads; from a sample of one pair
  /// in 16.
  std::int64_t nanoseconds = 0;
  /// Decisions left to exact arithmetic: 0 for bodies of ordinary size (`Bracket::contact`).
  std::int64_t exact_signs = 0;
  /// Answers whose certified interval is wider than the poses deserve, since a search met its budget of operations.
  std::int64_t wider_brackets = 0;
  /// Contacts of one piece of a mesh or compound that were dropped or changed, since other pieces cover them.
  std::int64_t covered_contacts = 0;
  /// Triangles of meshes that were left out of contacts: corners that are no numbers, or no area. Counted each time.
  std::int64_t skipped_triangles = 0;
  /// Pairs of bodies with compounds, deep in each other, that were answered as whole unions.
  std::int64_t deep_unions = 0;
  /// Deep pairs that were left to their pieces, because the whole would take more than its budget of pairs or facets,
  /// or lately did.
  std::int64_t deep_unions_left = 0;
  /// Those among `deep_unions` that were led out by a way that is at most half as long again as the shortest. The
  /// others took the shortest way.
  std::int64_t deep_unions_nearly = 0;
};

/// Drop-in for Bullet's EPA and Minkowski solvers. Re-entrant: each thread inside a call has buffers and counters of
/// its own, the shape cache is shared. May be destroyed before the worlds that it is installed in: their pairs are then
/// answered by Bullet's own EPA (a few hundred bytes stay behind for them until the program ends).
class BulletPenetrationDepthSolver final : public btConvexPenetrationDepthSolver {
 public:
  explicit BulletPenetrationDepthSolver(const BulletSolverSettings& settings = {});
  ~BulletPenetrationDepthSolver() override;
  BulletPenetrationDepthSolver(const BulletPenetrationDepthSolver&) = delete;
  BulletPenetrationDepthSolver& operator=(const BulletPenetrationDepthSolver&) = delete;

  /// Bullet's call, in its detector's frame and unit. Margins are part of the bodies.
  /// - overlapping or touching: true; wA and wB the deepest points of A and B with wB - wA = depth * normal; v the unit
  ///   normal, which Bullet takes where the two points coincide.
  /// - separated: false; wA and wB the nearest points of the cores (Bullet adds the margins itself), v the unit normal
  ///   in world axes.
  /// - no answer (a shape that is no body, such as a hull without points, or a transform that is not finite): false and
  ///   v = 0, which Bullet reads as "nothing found".
  bool calcPenDepth(btSimplexSolverInterface& simplex_solver, const btConvexShape* a, const btConvexShape* b,
                    const btTransform& transform_a, const btTransform& transform_b, btVector3& v, btVector3& witness_a,
                    btVector3& witness_b, btIDebugDraw* debug_draw) override;

#if __cplusplus >= 201703L
  /// The full answer for two posed Bullet shapes as the contact algorithm sees them (two btBoxShapes sharp, see
  /// install.hpp), in the frame of the transforms. Empty where a shape has no exact form or a transform is not finite.
  /// `warm`: the memory of this pair, or nullptr.
  [[nodiscard]] std::optional<BulletPairAnswer> query(const btConvexShape& a, const btTransform& transform_a,
                                                      const btConvexShape& b, const btTransform& transform_b,
                                                      WarmCertificate* warm = nullptr);
#endif

  /// Contact points for an answer of `query` (`contact_manifold`).
  [[nodiscard]] ContactManifold manifold(const BulletPairAnswer& answer, double breaking_threshold);

  [[nodiscard]] const BulletSolverSettings& settings() const;
  [[nodiscard]] BulletShapeCache& cache();

  /// A consistent reading only while no thread is inside a call.
  [[nodiscard]] BulletSolverStatistics statistics() const;
  void reset_statistics();

  /// For the contact algorithm and for snapshots.
  [[nodiscard]] detail::PairRegistry& pairs();
  [[nodiscard]] detail::SolverCore& core() { return *core_; }

 private:
  detail::SolverCore* core_;  ///< owned
};

}  // namespace pd
