/// @file
/// Records the contacts of a Bullet world for `pdepth audit`: one object, in any world, with any solver.
///
///   pd::ContactRecorder recorder(world, "contacts.jsonl");
///
/// From then on every pair that the dispatcher looks at is written with the poses that the narrow phase used, before
/// the step moves anything: the format is that of `pd/record/pd_record.h`. Without a recorder nothing is different, and
/// nothing costs anything.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

#include <cstdint>

namespace pd {

namespace detail {
class RecordedWorld;
}

struct ContactRecorderSettings {
  /// Steps between recorded ones, plus one: 10 records every tenth step, from the first on. >= 1.
  int every = 1;
};

/// Records while it lives. Bullet's near callback is ours meanwhile; the one that was there before is called first, and
/// is put back at the end (unless somebody has set another one since).
///
/// A line is written for
/// - every pair of convex bodies, and of a convex body and a `btStaticPlaneShape`, whose boxes meet and which Bullet
///   does not skip (asleep, filtered): `null` where the manifold is empty;
/// - every triangle of a mesh or heightfield, and every child of a compound (also of two), that has a contact point.
///   What has none is not written: Bullet keeps four points of all triangles.
/// Reported is the deepest point of the manifold (of that triangle or child), with its normal; all its points follow.
/// A is the manifold's first body.
///
/// Shapes are what Bullet's narrow phase means by them (`shape_conversion.hpp`); boxes are sharp where Bullet takes
/// them so. That is against planes (boxes of the plane and scaled ones, too), against boxes under Bullet's own
/// box/box algorithm or ours, and as children of compounds under ours (`BulletSolverSettings::unions_as_one`). A child
/// or triangle is judged as if it were alone, although our contacts are those of the whole. A sphere meets a triangle
/// under Bullet's own algorithm for these without the mesh's margin. The trial steps of a `RollbackStepper` are steps,
/// too, and are recorded.
///
/// Not written, but counted as `unsupported`: shapes without exact form, compounds in compounds, meshes in compounds,
/// soft bodies, GImpact meshes, pairs that Bullet's algorithms for the plane answer where a host registers them.
/// Dispatchers of several threads are served, one at a time.
class ContactRecorder {
 public:
  /// Creates the file. @param world  must outlive the recorder; so must its dispatcher, a btCollisionDispatcher with no
  /// recorder yet (else nothing is recorded, and `good` is false).
  ContactRecorder(btCollisionWorld& world, const char* path, const ContactRecorderSettings& settings = {});
  ~ContactRecorder();
  ContactRecorder(const ContactRecorder&) = delete;
  ContactRecorder& operator=(const ContactRecorder&) = delete;

  /// Ends the recording and closes the file; false where something could not be written. May be called once more.
  bool close();

  /// False where the world cannot be recorded or the file cannot be written.
  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;     ///< lines written
  [[nodiscard]] std::int64_t unsupported() const;  ///< pairs that could not be

 private:
  detail::RecordedWorld* world_;  ///< owned; <memory> would double what a host parses
};

}  // namespace pd
