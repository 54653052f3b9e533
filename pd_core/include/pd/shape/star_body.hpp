/// @file
/// Star-shaped bodies: closed triangulated surfaces of which every point is seen from a centre.
///
/// The body is {c + s (x - c) : x on the surface, 0 <= s <= 1}. It is the union of the tetrahedra over its faces with
/// the apex c, which abut and do not overlap ([A], remark at the end of section 4).
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/compound.hpp"

namespace pd {

/// Immutable.
class StarBody {
 public:
  using Triangle = std::array<std::int32_t, 3>;

  /// The surface is checked exactly, not trusted. Every edge is met by two faces that run it in opposite ways. Every
  /// face has the centre strictly below it (seen from outside its corners turn counter-clockwise). A ray from the
  /// centre leaves through one face only.
  /// @return ErrorCode::non_finite or out_of_range ("vertices[i]", "center"). `too_few_points` for fewer than four
  /// vertices or faces. `bad_faces` ("faces[i]") for an index out of range, a repeated vertex, or a face that does not
  /// see the centre from its inner side. `bad_faces` ("faces") for a surface that runs around the centre more than
  /// once. `not_closed` ("faces[i]").
  static Expected<StarBody> from_faces(std::span<const Vec3> vertices, std::span<const Triangle> faces,
                                       const Vec3& centre);

  [[nodiscard]] const std::vector<Vec3>& vertices() const { return vertices_; }
  [[nodiscard]] const std::vector<Triangle>& faces() const { return faces_; }
  [[nodiscard]] const Vec3& centre() const { return centre_; }

  /// Part i is the tetrahedron over face i. Its polytope's caller ids are 0, 1, 2 for the face's corners in their order
  /// and 3 for the centre.
  [[nodiscard]] Compound tetrahedra() const;

 private:
  StarBody() = default;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> faces_;
  Vec3 centre_ = Vec3::Zero();
};

}  // namespace pd
