/// @file
/// A body that stands over the insides of flat parts of a mesh: floors, walls and slopes of many triangles, each asked
/// once, as a plane.
///
/// The triangles of a plane are one surface, whatever the edges between them. Where the points at which the body meets
/// the plane all lie over triangles of it, they are the contacts of that surface: no triangle has another (a contact
/// that leads off one over an edge to the next is covered by that, covered_contact.hpp), and what a triangle's own side
/// says nothing covers. Of a child of a compound, the points inside of other children that lead on into the plane do
/// not count, and a child that is in by more than a quarter leaves to the side where the compound is. Where one lies
/// over an edge of the mesh, a hole or a triangle of another plane, or the body is so far in that another way out may
/// be shorter, the triangles are asked one by one.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pd/contact/halfspace_contact.hpp"
#include "shapes/met_triangle.hpp"

namespace pd {

class Patches;

namespace detail {

class SheetSides;
class SolverCore;
struct CachedShape;
struct ThreadBuffers;
struct UnionQuestion;

/// Keeps its memory from step to step, and nothing that an answer could depend on.
class FlatGround {
 public:
  /// Floor and two walls.
  static constexpr int kMostPlanes = 3;

  /// A convex body or child, and what it was converted to in an earlier step, or null.
  struct Body {
    const btCollisionObjectWrapper& wrapper;
    std::shared_ptr<CachedShape>& known;
    SheetSides* sides;  ///< null: the mesh has fronts of its own
  };

  /// Adds the contacts of a body with `triangles`, all that it may reach of mesh question.b, to `patches`.
  /// @param body  question.a, or a child of it
  /// @param first  number of the first triangle, for `patches`
  /// @return false: nothing was added, the triangles are to be asked one by one
  /// Time O(k) in the triangles, and a support each way and a face of the body a plane.
  bool find(const Body& body, const UnionQuestion& question, std::span<const MetTriangle> triangles, std::size_t first,
            SolverCore& core, ThreadBuffers& buffers, Patches& patches);

 private:
  struct Plane {
    std::size_t seed;  ///< the largest of its triangles, which gives the plane
    ContactManifold points;
    std::array<int, 4> triangles;  ///< under them
    Vec3 front;                    ///< where the body is, unit and in the mesh's frame
  };

  /// @return false where there are more planes than may be
  bool sort_by_plane(std::span<const MetTriangle> triangles);
  /// @return false where the plane's triangles have to be asked
  bool ask(const Body& body, const UnionQuestion& question, std::span<const MetTriangle> triangles, SolverCore& core,
           ThreadBuffers& buffers, Plane& plane, int number);
  /// The side of the plane that the body came from, unit and in the mesh's frame; zero: not known.
  [[nodiscard]] Vec3 known_front(const Body& body, std::span<const MetTriangle> triangles, const Plane& plane,
                                 int number) const;

  std::vector<Vec3> across_;   ///< twice the area along the normal
  std::vector<int> plane_of_;  ///< a number of each triangle's plane
  std::vector<Plane> planes_;
  double farthest_ = 0;  ///< largest coordinate of a corner
};

}  // namespace detail

}  // namespace pd
