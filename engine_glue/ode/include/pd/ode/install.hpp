/// @file
/// Exact contacts in ODE: one call replaces the colliders of convex geoms and planes, another puts ODE's own back.
///
///   dInitODE2(0);
///   if (const auto installed = pd::install_ode(); !installed) std::puts(installed.error().message.c_str());
///   dSpaceCollide(space, nullptr, &near_callback);  // which calls dCollide, as before
///   pd::uninstall_ode();
///
/// Spheres, boxes, capsules, cylinders and convex geoms are answered against each other and against planes. Rays,
/// triangle meshes and height fields stay ODE's. Contacts mean what ODE means by them: the normal points into the first
/// geom, `depth` is the distance to move it along the normal, `pos` lies midway between the two surfaces. Positions and
/// normals are in the frame of the world, lengths in the unit of the geoms.
///
/// A contact depends on the two geoms alone. Equal geoms give the same bits on any thread and after any history, unless
/// `remember_pairs` is set.
///
/// The time of a pair is that of `penetration_depth` and `contact_manifold`, and O(n) more to compare the n points of a
/// convex geom with those that were converted.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <string>

#include "pd/numeric/expected.hpp"

namespace pd {

struct OdeOptions {
  /// For cylinders: the relative error of the depth, in (0, 1]; 0 stands for 1e-6. All other depths are exact up to
  /// rounding.
  double delta = 0;
  /// Each thread keeps the last answer of each pair and begins with it. Convex geoms of many points are answered
  /// faster; the last bits then depend on what the thread was asked before.
  bool remember_pairs = false;
  /// Says which pairs pdepth answers; null: all. Every thread that is inside `dCollide` may call it.
  bool (*takes_pair)(dGeomID first, dGeomID second, void* user) = nullptr;
  /// Gets one line when a pair is left to ODE for the first time for a reason; null: silence.
  void (*warning)(const char* line, void* user) = &print_warning;
  void* user = nullptr;  ///< is handed to `takes_pair` and `warning`

  /// Writes the line to the standard error stream.
  static void print_warning(const char* line, void* user);
};

/// The reason why a pair got ODE's own contact.
enum class OdeRefusal : std::uint8_t {
  pose,    ///< a pose is NaN, infinite or no rotation
  size,    ///< a size is not positive and finite, or a plane has no normal
  convex,  ///< the points of a convex geom were not named (`ode_convex`), are not its own or are not finite
};
inline constexpr int kOdeRefusals = 3;

/// Counts of all threads since `install_ode`.
struct OdeReport {
  std::int64_t answered = 0;                      ///< pairs
  std::int64_t contact_points = 0;                ///< written for them
  std::int64_t conversions = 0;                   ///< geoms made into shapes
  std::array<std::int64_t, kOdeRefusals> left{};  ///< pairs left to ODE, by OdeRefusal
  std::array<std::string, kOdeRefusals> first{};  ///< the first pair of each: its geom and the error
};

/// Replaces the colliders of convex geoms and planes. Called again, it changes the options and starts the report
/// afresh. Requires that ODE is initialised and that no thread is inside it, because the table belongs to the whole
/// process.
///
/// ODE does not tell which function stands in its table. Each pair of classes is therefore asked about two small geoms,
/// whose user data is null. Where the answer is not that of ODE's own function, somebody else's override stands there
/// and stays.
///
/// @return the number of pairs of classes that pdepth answers, of 20, or ErrorCode::bad_value ("delta") or unsupported
/// ("ode": the library is of the other precision than the headers)
Expected<int> install_ode(const OdeOptions& options = {});

/// Puts ODE's own colliders back, where pdepth's stood. Requires that no thread is inside ODE. Does nothing if nothing
/// is installed.
void uninstall_ode();

/// The counts so far, of all threads. May be called at any time, by any thread. Time O(threads).
[[nodiscard]] OdeReport ode_report();

/// Tells pdepth the points of a convex geom, which ODE cannot give back: those that `dCreateConvex` or `dGeomSetConvex`
/// got, in the frame of the geom. pdepth copies them. Their hull is the body. Pairs of a convex geom whose points were
/// not told, or whose box is not that of the points, are left to ODE.
/// @param points  `count` points of three numbers
/// May be called at any time, by any thread.
void ode_convex(dGeomID geom, const dReal* points, unsigned int count);

/// Forgets the points of a geom, before it is destroyed. Does nothing if none were told.
void forget_ode_convex(dGeomID geom);

}  // namespace pd
