/// @file
/// A body on triangles from which the mesh goes on nearly flat, or rises: the points that a query and the rule for
/// covered contacts (covered_contact.hpp) would come to, without either.
///
/// A body whose facets are far apart in direction meets such a triangle with the facet that faces it, or its outline.
/// Where the two are nearest decides what the shortest way off the triangle is: a corner of the facet, the triangle's
/// normal; a corner of the triangle, the facet's; the crossing of two edges, across both. The last two are covered, and
/// turned to the triangle's normal, where the mesh goes on against them beyond that corner or edge, as it mostly does;
/// so most of what bodies meet on fine meshes needs no more than the facet cut to the triangle. A sphere meets any
/// triangle in the point nearest to its centre, which is another triangle's where the mesh goes on against it there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "shapes/triangles_around.hpp"
#include "union/shared_edges.hpp"

namespace pd::detail {

/// Of one body or child on one mesh. Keeps its memory, and nothing that an answer could depend on.
class GentleGround {
 public:
  /// Tells which triangles are around the bodies that are asked about next.
  void know(std::span<const MeshTriangle> around) { edges_.begin(around); }

  /// @param body  what it is taken as, in the world
  /// @param reach  in the mesh's frame
  /// @param one_sided  the mesh has fronts only, where corners run counter-clockwise: who is behind one is not answered
  /// @return whether it is a body that may be asked: a solid polytope of few corners, or a sphere. Time O(v + f).
  bool begin(const PosedShape& body, const BodyReach& reach, const Pose& mesh, double mesh_margin, double threshold,
             bool one_sided);

  /// Asks a triangle. Time O(v + f), and O(k) in the corners of the body's facet.
  /// @param place  its number among the triangles around
  /// @return false: it has to be asked as one by itself
  bool ask(const MeshTriangle& triangle, std::size_t place);

  /// What was found last: up to four points at a time, all along one normal.
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
  /// Whether the mesh falls away beyond none of the edges that the body may reach by more than is gentle.
  [[nodiscard]] bool is_gentle(const MeshTriangle& triangle, std::size_t place, double side);
  /// The facet that faces against n, -1 where another one may meet what faces nearly as n.
  [[nodiscard]] int facet_against(const Vec3& n) const;
  /// What is left of the facet over the triangle, seen along n.
  void cut_facet(const IndexList& loop, const Placed& triangle, const Vec3& n);
  [[nodiscard]] std::span<const Corner> polygon() const { return std::span(polygons_[from_]).first(size_); }
  /// Cuts it to where `outward` leads down from `corner`, an end of the triangle's edge number `edge`.
  void cut(const Vec3& outward, const Vec3& corner, std::int32_t edge);
  /// Which way contacts push where the facet is nearest to the triangle; none where that hangs on more than is known.
  [[nodiscard]] std::optional<Vec3> way_at(const Corner& nearest, const IndexList& loop, int facet,
                                           const MeshTriangle& triangle, const Placed& placed, std::size_t place);
  /// The same of a sphere, which one point of the triangle is nearest to, however the mesh goes on.
  bool ask_sphere(const MeshTriangle& triangle, const Placed& placed, std::size_t place);
  void add_points(const Placed& triangle, const Vec3& n);

  SharedEdges edges_;
  const ConvexPolytope* polytope_ = nullptr;
  bool sphere_ = false;
  const BodyReach* reach_ = nullptr;
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

}  // namespace pd::detail
