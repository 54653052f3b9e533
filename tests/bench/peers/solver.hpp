/// @file
/// What every solver of the bench is to the stopwatch and to the judge: ours, and each peer in a file of its own
/// (`peers/`). Convention of all answers: A moves, B stays, in the frame that both share.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pd/shape/convex_shape.hpp"
#include "scenes/shape_families.hpp"

namespace pd::bench {

/// The numbers that a solver works on: it is judged on the ones it received, not on those it never saw.
enum class Precision : std::uint8_t { binary32, binary64 };

/// Two bodies as every solver gets them: the vertices of their hulls, each in its own frame, once.
struct Bodies {
  ConvexShape a;
  ConvexShape b;
};

struct Answer {
  bool overlapping = false;  ///< false: the solver saw no overlap, or gave up
  double depth = 0;
  Vec3 translation = Vec3::Zero();  ///< of A; out of B, or onto B where they are apart
  double distance = 0;              ///< of bodies apart; infinity: farther than the limit, and no more was asked
};

/// A solver at work on one pair of bodies; `run` is what is timed.
class Attempt {
 public:
  virtual ~Attempt() = default;
  /// Sets where the bodies stand from the next run on, in the solver's own types.
  virtual void stand(const Pose& a, const Pose& b) = 0;
  /// Those that answer "apart by more than this?" heed it; 0 asks whether the bodies are apart at all.
  virtual void limit(double) {}
  virtual void run() = 0;
  [[nodiscard]] virtual Answer answer() const = 0;
  /// Support points asked for in the last run; NaN where the solver does not tell.
  [[nodiscard]] virtual double supports() const { return std::numeric_limits<double>::quiet_NaN(); }
  /// The last run was answered from the memory of the pair.
  [[nodiscard]] virtual bool warm() const { return false; }
};

class Solver {
 public:
  virtual ~Solver() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual Precision precision() const = 0;
  /// False: it has no such shape, or not of so many vertices, and is not run.
  [[nodiscard]] virtual bool takes(const Bodies&) const { return true; }
  /// Refers to `bodies`.
  [[nodiscard]] virtual std::unique_ptr<Attempt> prepare(const Bodies& bodies) = 0;
};

using Solvers = std::vector<std::unique_ptr<Solver>>;

inline constexpr std::string_view kOurs = "pdepth-auto";
inline constexpr std::string_view kBulletEpa = "bullet-epa";
inline constexpr std::string_view kBulletGjk = "bullet-gjk";
inline constexpr std::string_view kFclDistance = "fcl-distance";
inline constexpr std::string_view kOde = "ode";
inline constexpr std::string_view kOdeByPdepth = "ode-pdepth";  ///< through `pd::install_ode`
inline constexpr std::string_view kMujoco = "mujoco";
inline constexpr std::string_view kMujocoByPdepth = "mujoco-pdepth";  ///< through `pd::install_mujoco`

/// Vertices of the hull in its canonical order.
[[nodiscard]] scenes::Points vertices_of(const ConvexShape& shape);
/// Of a box round the origin of its frame, along its axes; nothing where the shape is no such box.
[[nodiscard]] std::optional<Vec3> half_extents_of(const ConvexShape& shape);
/// Between the two ends of a capsule's core.
[[nodiscard]] double length_of(const ConvexShape& shape);

/// pdepth-auto (the automatic method with Bracket::certified, as a physics engine uses it), and with `every_engine`
/// pdepth-tightest (Bracket::tightest), pdepth-expansion, pdepth-overlay,
/// pdepth-decomposition.
/// `remembering`: pdepth-auto keeps a warm certificate for each pair, and pdepth-cold stands beside it.
void add_ours(Solvers& solvers, bool every_engine, bool remembering);

/// Bullet's EPA and Minkowski sampling in the precision that this program was built for, libccd's EPA and MPR, FCL's
/// signed distance and contact query, Jolt's and MuJoCo's expanding polytopes and box3d's separating axis test: those
/// that were there when the bench was built. Boxes are told to the last three as boxes.
void add_peers(Solvers& solvers);

/// Bodies apart: "how far" (pdepth-distance) and "by more than the limit?" (pdepth-beyond), each with and without the
/// memory of the pair.
void add_ours_apart(Solvers& solvers);
/// Bullet's pair detector, FCL's distance by both of its solvers, libccd's GJK, which says only whether they meet, and
/// the GJK of Jolt, MuJoCo and box3d, with and without a limit or the memory of the pair where they have these.
void add_peers_apart(Solvers& solvers);

/// Curved bodies that overlap: pdepth-auto (Bracket::certified, delta 1e-6), and pdepth-warm with the memory of the
/// pair.
void add_ours_curved(Solvers& solvers);
/// Bullet's EPA, its pair detector with that EPA, FCL's signed distance and contact query, and libccd's EPA and MPR,
///
/// and Jolt's, MuJoCo's and box3d's solvers, each on its own primitive shapes.
void add_peers_curved(Solvers& solvers);

/// One line for each package: its version, or that it is missing.
[[nodiscard]] std::vector<std::string> peer_notes();

/// The peers of one package; each is defined where its package was found.
void add_bullet(Solvers& solvers);
void add_ccd(Solvers& solvers);
void add_bullet_apart(Solvers& solvers);
void add_ccd_apart(Solvers& solvers);
void add_fcl_apart(Solvers& solvers);
void add_bullet_curved(Solvers& solvers);
void add_fcl(Solvers& solvers);
void add_jolt(Solvers& solvers);
void add_jolt_apart(Solvers& solvers);
void add_mujoco(Solvers& solvers);
void add_mujoco_apart(Solvers& solvers);
void add_box3d(Solvers& solvers);
void add_box3d_apart(Solvers& solvers);
/// Bodies of these three must be solids around the origin of their frames.
void add_ode(Solvers& solvers);
void add_mujoco_library(Solvers& solvers);
/// Each detector that DART's factory knows, with pdepth's.
void add_dart(Solvers& solvers);
[[nodiscard]] std::string bullet_note();
[[nodiscard]] std::string fcl_note();
[[nodiscard]] std::string jolt_note();
[[nodiscard]] std::string mujoco_note();
[[nodiscard]] std::string box3d_note();

}  // namespace pd::bench
