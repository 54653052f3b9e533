/// @file
/// What stands behind a BulletPenetrationDepthSolver. It outlives the solver where it was installed: dispatchers keep
/// pointers to its create functions, and Bullet has no way to take them back from a dispatcher that may be gone.
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>

#include "pair/pair_registry.hpp"
#include "pair/thread_buffers.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "pd/contact/halfspace_contact.hpp"
#include "shapes/flat_compound.hpp"
#include "shapes/pair_answer.hpp"
#include "shapes/step_shapes.hpp"

namespace pd::detail {

class SolverInWorld;

/// Selects the btBoxShapes that are taken without their margins. All others are taken as Bullet's GJK sees every shape,
/// as a core and a margin.
struct SharpCorners {
  bool sharp_pair = false;  ///< two of them, as Bullet's own box/box algorithm takes them
  bool sharp_a = false;     ///< A as a part of a compound: rounded, flush boxes would have grooves between them
  bool sharp_b = false;
};
inline constexpr SharpCorners kRoundedBoxes{};
inline constexpr SharpCorners kSharpBoxPair{true, false, false};

/// Closest points however far apart the bodies are.
inline constexpr double kAnyDistance = std::numeric_limits<double>::infinity();

struct PairQuestion {
  const btConvexShape& a;
  const btTransform& pose_a;
  const btConvexShape& b;
  const btTransform& pose_b;
  std::array<std::shared_ptr<CachedShape>, 2>& shapes;  ///< as found earlier: the pair's memory, or the buffers' last
  WarmCertificate* warm = nullptr;                      ///< of this pair, or nullptr
  std::uint64_t stamp = 0;  ///< of this step of this world (`BulletShapeCache::find`), 0: unknown
  SharpCorners corners = kRoundedBoxes;
  double beyond = kAnyDistance;  ///< that the bodies are farther apart than this is all there is to know then
  bool boxes_asked = false;      ///< `box_contacts` had no answer
  bool shapes_current = false;   ///< `shapes` are those of this step
};

/// A body on a plane.
struct GroundQuestion {
  const btConvexShape& body;  ///< taken as Bullet's GJK sees it, core and margin, but for sharp boxes
  const btTransform& pose;
  Halfspace3 ground;                    ///< in the world
  std::uint64_t stamp;                  ///< as of a PairQuestion
  std::shared_ptr<CachedShape>& shape;  ///< the body as found earlier
  double threshold;                     ///< up to which gap points are contacts
  bool sharp_box = false;               ///< a btBoxShape without its margin
};

/// What the core may leave open (`DepthSettings::contact_tolerance`): 1/64 of what a pose in single precision leaves
/// uncertain, whatever the reach of a floor. Coordinates are known to half a unit in the last place, so that surfaces
/// are to 2^-24 of the distance from the world's origin and of the body's size. In double precision that share, 2^-59,
/// is below the rounding of the query's own sums, which comes to some 2^-47.
/// @param smaller_radius  of the smaller of both bodies.
[[nodiscard]] double contact_tolerance(const Vec3& a, const Vec3& b, double smaller_radius);

/// Whether a pose is one that the core takes: finite, and not too far.
[[nodiscard]] bool in_range(const btTransform& pose);

class SolverCore {
 public:
  explicit SolverCore(const BulletSolverSettings& settings);
  ~SolverCore();

  /// What a query came to.
  enum class Outcome { answered, unsupported, refused };

  Outcome answer(const PairQuestion& question, ThreadBuffers& buffers, PairAnswer& answer);

  /// The same and the contact points (as lifted). Two boxes are answered in one pass, without features or a warm start.
  Outcome contacts(const PairQuestion& question, double breaking_threshold, ThreadBuffers& buffers, PairAnswer& answer,
                   ContactManifold& points);

  /// A body on a plane: its distance and its contact points.
  Outcome stand_on(const GroundQuestion& question, ThreadBuffers& buffers, HalfspaceContact& answer);
  /// Brings up to date what a shape was converted to. `known`: as found earlier, or null.
  CachedShape& find(const btConvexShape& shape, std::uint64_t stamp, std::shared_ptr<CachedShape>& known,
                    ThreadBuffers& buffers);

  /// Bullet's call.
  bool calc_pen_depth(btSimplexSolverInterface& simplex, const btConvexShape* a, const btConvexShape* b,
                      const btTransform& pose_a, const btTransform& pose_b, btVector3& v, btVector3& witness_a,
                      btVector3& witness_b, btIDebugDraw* draw);

  /// The solver for shapes without exact form.
  [[nodiscard]] btConvexPenetrationDepthSolver& fallback() { return settings.fallback ? *settings.fallback : epa_; }

  /// A number that no step of any world had before.
  [[nodiscard]] std::uint64_t next_stamp() { return 1 + stamps_.fetch_add(1, std::memory_order_relaxed); }

  /// Steps of one world that begin at one state, of which all but the last are taken back (RollbackStepper), have one
  /// number; 0: a step like any other. The first of them is the longest.
  void begin_trials() { trials_.store(next_stamp(), std::memory_order_relaxed); }
  void end_trials() { trials_.store(0, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t trials() const { return trials_.load(std::memory_order_relaxed); }

  /// Solvers may serve any number of worlds one after another, whose end Bullet tells nobody: they share this many
  /// places. Worlds that step at the same time should not share one.
  static constexpr std::size_t kWorlds = 256;
  /// The world at a place, or nullptr.
  SolverInWorld* world_at(std::size_t place);
  /// Keeps it as long as the core lives. @return the one that is there, which another thread may have added first
  SolverInWorld& add_world(std::size_t place, std::unique_ptr<SolverInWorld> world);
  [[nodiscard]] bool installed() const { return installed_; }

  /// The solver is gone: from now on Bullet's EPA answers.
  void close();
  [[nodiscard]] bool closed() const { return closed_.load(std::memory_order_relaxed); }

  BulletSolverSettings settings;
  BulletShapeCache cache;
  FlatCompounds flat_compounds;
  ThreadBufferPool buffers;
  PairRegistry pairs;

 private:
  /// Finds the bodies and places them.
  Outcome place(const PairQuestion& question, ThreadBuffers& buffers, PairAnswer& answer);
  /// The depth of placed bodies.
  void measure(const PairQuestion& question, ThreadBuffers& buffers, PairAnswer& answer);
  void warn(const btConvexShape& shape, const Error& refusal);

  btGjkEpaPenetrationDepthSolver epa_;
  std::atomic<std::uint64_t> stamps_{0};
  std::atomic<std::uint64_t> trials_{0};
  std::atomic<std::uint64_t> warned_{0};  ///< a bit for each Bullet type
  std::atomic<bool> closed_{false};
  std::mutex mutex_;
  std::array<std::unique_ptr<SolverInWorld>, kWorlds> worlds_;
  bool installed_ = false;
};

}  // namespace pd::detail
