/// @file
/// A body that stands over the insides of flat parts of a mesh: floors, walls and slopes of many triangles, each asked
/// once, as a plane.
///
/// The triangles of a plane are one surface, whatever the edges between them. If the points at which the body meets the
/// plane all lie over triangles of it, they are the contacts of that surface. No triangle has another: a contact that
/// leads off one over an edge to the next is covered by that (covered_contact.hpp), and nothing covers a triangle's own
/// side. For a part of a union, the points inside of other parts that lead on into the plane do not count. A part that
/// is in by more than a quarter leaves to the side where the union is.
///
/// If a point lies over an edge of the mesh, a hole or a triangle of another plane, the triangles are asked one by one.
/// They are, too, if the body is so far in that another way out may be shorter.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pd/contact/halfspace_contact.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

/// A share of a body's thickness. Deeper in a sheet than this, its shortest way out is back to where most of it is,
/// over edges or not, and no longer the triangle's own side.
inline constexpr double kShallow = 0.25;

/// A convex body, or a part of a union, as its host holds it.
class StandingBody {
 public:
  virtual ~StandingBody() = default;
  /// The body's contact with a half-space. @return false if the host has no answer
  virtual bool stand_on(const Halfspace3& ground, HalfspaceContact& contact) = 0;
  /// Returns the body that `stand_on` was answered for.
  [[nodiscard]] virtual PosedShape posed() const = 0;
  /// Drops the points that `pd::drop_covered` drops, if the body is a piece of a union.
  virtual void drop_covered(ContactManifold& points) = 0;

  /// True if the host remembers from which side the body came to triangles.
  [[nodiscard]] virtual bool remembers_sides() const { return false; }
  /// Returns the remembered side of a triangle, unit and in the mesh's frame; zero if it is not known.
  [[nodiscard]] virtual Vec3 side_of(std::size_t /*triangle*/, const Vec3& /*normal*/) const { return Vec3::Zero(); }
  /// Returns the body's middle in the last step, in the mesh's frame.
  [[nodiscard]] virtual Vec3 middle_before() const { return Vec3::Zero(); }
  /// Takes note that the body is on this side of a triangle: unit, in the mesh's frame.
  virtual void keep_side(std::size_t /*triangle*/, const Vec3& /*side*/) {}
};

/// All triangles of a mesh that the body may reach. Lengths are in the unit of the input.
struct GroundTriangles {
  std::span<const std::array<Vec3, 3>> corners;  ///< in the mesh's frame; each triangle has an area
  const Pose& mesh;
  double margin = 0;
  double corner_rounding = 0;  ///< share of the largest coordinate by which corners of a plane may be off it
  double pose_rounding = 0;    ///< as of `seam_slack`
  bool one_sided = false;      ///< the mesh has fronts only, where corners run counter-clockwise
};

/// The place of the body in the world.
struct GroundPlace {
  Vec3 origin;           ///< of the body
  Vec3 origin_of_whole;  ///< of the union that it is a part of
  bool is_part = false;
};

/// The planes under a body. An object reuses its buffers from step to step, and no answer depends on earlier ones.
class FlatGround {
 public:
  /// A floor and two walls are the most that is answered.
  static constexpr int kMostPlanes = 3;

  /// Finds the body's contacts with the planes of the triangles.
  /// @return false if the triangles are to be asked one by one
  /// Time O(k) in k triangles. For each plane it takes a support each way and a face of the body.
  bool find(StandingBody& body, const GroundPlace& place, const GroundTriangles& ground);

  /// Calls `visit(point, triangle)` for each contact that was found, as a manifold of one point. Requires: `find`
  /// returned true.
  template <class Visit>
  void for_each_point(const Visit& visit) const {
    for (const Plane& plane : planes_) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(plane.points.count); ++k) {
        ContactManifold point = plane.points;
        point.points[0] = plane.points.points[k];
        point.count = 1;
        visit(point, plane.triangles[k]);
      }
    }
  }

 private:
  struct Plane {
    std::size_t seed = 0;  ///< the largest of its triangles, which gives the plane
    ContactManifold points;
    std::array<std::size_t, 4> triangles{};  ///< under them
    Vec3 front = Vec3::Zero();               ///< where the body is, unit and in the mesh's frame
  };

  /// Gives every triangle the number of its plane. @return false if there are more than `kMostPlanes`
  bool sort_by_plane(const GroundTriangles& ground);
  /// Asks the body about one plane. @return false if the plane's triangles have to be asked
  bool ask(StandingBody& body, const GroundPlace& place, const GroundTriangles& ground, int number);
  /// Returns the side of the plane that the body came from, unit and in the mesh's frame; zero if it is not known.
  [[nodiscard]] Vec3 known_front(const StandingBody& body, std::size_t num_triangles, int number) const;
  /// True if a place, in the mesh's frame, lies over a triangle of the plane.
  [[nodiscard]] bool lies_over(const Vec3& place, const GroundTriangles& ground, int number, double slack) const;
  /// Returns false if the body lies behind the plane as a whole where it is deepest: the plane goes on beyond its
  /// triangles.
  [[nodiscard]] bool comes_through(const PosedShape& body, const HalfspaceContact& found, const GroundTriangles& ground,
                                   int number) const;
  /// Finds the triangles under the plane's points. @return false if a point lies over none
  bool find_under(const PosedShape& body, const Vec3& normal, const GroundTriangles& ground, int number);

  std::vector<Vec3> across_;   ///< twice the area along the normal
  std::vector<int> plane_of_;  ///< a number of each triangle's plane
  std::vector<Plane> planes_;
  double farthest_ = 0;  ///< largest coordinate of a corner
};

}  // namespace pd
