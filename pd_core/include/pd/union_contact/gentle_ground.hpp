/// @file
/// A body on triangles from which the mesh goes on nearly flat, or rises: the points that a query and the rule for
/// covered contacts (covered_contact.hpp) would come to, without either.
///
/// A body whose facets are far apart in direction meets such a triangle with the facet that faces it, or its outline.
/// The place where the two are nearest decides which way off the triangle is the shortest. For a corner of the facet it
/// is the triangle's normal, for a corner of the triangle the facet's, and for a crossing of two edges the direction
/// across both. A contact of the last two kinds is covered where the mesh goes on against it beyond that corner or
/// edge, and is turned to the triangle's normal then. So most of what bodies meet on fine meshes needs no more than the
/// facet cut to the triangle. A sphere meets any triangle in the point nearest to its centre, which is another
/// triangle's where the mesh goes on against it there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/pose.hpp"
#include "pd/union_contact/shared_edges.hpp"

namespace pd {

/// Bodies on one mesh, one after another. An object reuses its buffers, and no answer depends on earlier ones.
class GentleGround {
 public:
  using Triangle = std::array<Vec3, 3>;

  /// Tells which triangles, in the mesh's frame, are around the bodies that are asked about next. They are to stay
  /// where they are.
  void know(std::span<const Triangle> around) {
    around_ = around;
    edges_.begin(around);
  }

  /// The mesh as the next body is asked about it.
  struct Ground {
    const Pose& mesh;
    double margin = 0;          ///< the mesh's
    const Vec3 &lower, &upper;  ///< of a box around the body, in the mesh's frame: all triangles that meet it are known
    bool one_sided = false;     ///< the mesh has fronts only, where corners run counter-clockwise
  };
  /// @param body  what it is taken as, in the world
  /// @param threshold  up to which gap points are contacts
  /// @return whether it is a body that may be asked: a solid polytope of few corners, or a sphere. Time O(v + f).
  bool begin(const PosedShape& body, const Ground& ground, double threshold);

  /// Asks a triangle. Time O(v + f), and O(k) in the corners of the body's facet.
  /// @param place  its number among the triangles around
  /// @return false: it has to be asked by itself, as one that a body stands behind must be if the mesh has fronts only
  bool ask(std::size_t place);

  /// Returns the contacts that were found last, up to four points at a time, each four along one normal.
  [[nodiscard]] std::span<const ContactManifold> manifolds() const { return manifolds_; }

 private:
  enum class Kind : std::uint8_t { corner_of_facet, corner_of_triangle, crossing };
  /// A corner of what is left of the facet, and the edge that leaves it.
  struct Corner {
    Vec3 point;
    Kind kind;
    bool on_triangle;          ///< the edge is the triangle's
    std::int32_t of_facet;     ///< of a corner or crossing: which, or which edge
    std::int32_t of_triangle;  ///< likewise
    std::int32_t edge;         ///< of the facet, or the triangle
  };
  /// Bodies of more are mostly round.
  static constexpr int kMostVertices = 32;
  static constexpr std::size_t kMostCorners = kMostVertices + 3;
  using Polygon = std::array<Corner, kMostCorners>;
  /// A triangle in the world.
  struct Placed {
    Vec3 corners[3];
    double side;      ///< 1: the body is where the corners run counter-clockwise, -1: on the other side
    Vec3 normal;      ///< on that side
    double level;     ///< of its plane along the normal, both margins in it
    double distance;  ///< of the body from there
  };
  /// True if the mesh falls away by no more than is gentle beyond each edge that the body may reach.
  [[nodiscard]] bool is_gentle(std::size_t place, double side);
  /// The facet that faces against n, -1 where another one may meet what faces nearly as n.
  [[nodiscard]] int facet_against(const Vec3& n) const;
  /// Cuts the facet to what lies over the triangle, seen along n.
  void cut_facet(const IndexList& loop, const Placed& triangle, const Vec3& n);
  [[nodiscard]] std::span<const Corner> polygon() const { return std::span(polygons_[from_]).first(size_); }
  /// Cuts it to where `outward` leads down from `corner`, an end of the triangle's edge number `edge`.
  void cut(const Vec3& outward, const Vec3& corner, std::int32_t edge);
  /// Which way contacts push where the facet is nearest to the triangle; none where that hangs on more than is known.
  [[nodiscard]] std::optional<Vec3> way_at(const Corner& nearest, const IndexList& loop, int facet,
                                           const Placed& placed, std::size_t place);
  /// Asks a sphere, which one point of the triangle is nearest to, however the mesh goes on.
  bool ask_sphere(const Placed& placed, std::size_t place);
  void add_points(const Placed& triangle, const Vec3& n);

  SharedEdges edges_;
  PosedShape body_{};
  const ConvexPolytope* polytope_ = nullptr;
  bool sphere_ = false;
  std::span<const Triangle> around_;
  Vec3 lower_ = Vec3::Zero(), upper_ = Vec3::Zero();
  Pose mesh_;
  Vec3 origin_ = Vec3::Zero();  ///< of the body
  double margin_ = 0;           ///< the body's
  double mesh_margin_ = 0;
  double threshold_ = 0;
  bool one_sided_ = false;
  std::vector<Vec3> vertices_;  ///< of its core, in the world
  std::vector<Vec3> normals_;   ///< of its facets
  std::array<Polygon, 2> polygons_;
  std::size_t from_ = 0;  ///< which of them is what is left of the facet
  std::size_t size_ = 0;  ///< in corners
  std::vector<ContactManifold> manifolds_;
};

}  // namespace pd
