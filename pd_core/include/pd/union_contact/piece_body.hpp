/// @file
/// A body for contacts consists of many pieces: the convex parts of a compound, or the triangles of a mesh as a sheet.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"
#include "pd/shape/mesh_check.hpp"

namespace pd {

class PieceBody;

namespace detail {
struct PieceStore;
PieceBody scaled(const PieceBody& body, int exponent);
}  // namespace detail

/// Immutable once made and cheap to copy: copies share one hierarchy of boxes.
class PieceBody {
 public:
  /// Makes a body of the parts, by their numbers. A convex body is a compound of one part. Time O(v + k log k) in k
  /// parts of v vertices.
  static PieceBody of_compound(Compound compound);

  /// Makes a body of the faces of a mesh, each grown by `margin`, by their numbers. A face of more than three corners
  /// is the triangles that it is cut into. The mesh need be neither closed nor manifold: a sheet has no inside. Faces
  /// without an area are no pieces. Time O(k log k) in k corners of convex faces.
  /// @return ErrorCode::too_few_points ("faces") if no face has an area; bad_faces ("faces[i]") for an index that is no
  /// point's and for a face that crosses itself; non_finite or out_of_range ("points[i]", "margin"); bad_value
  /// ("margin") if it is negative.
  static Expected<PieceBody> of_sheet(const MeshView& mesh, double margin = 0);

  /// True if the pieces are triangles without an inside.
  [[nodiscard]] bool is_sheet() const;
  /// Returns the number of parts, or of triangles with an area.
  [[nodiscard]] std::int64_t num_pieces() const;
  /// Returns the pieces themselves, for the library's own sources.
  [[nodiscard]] const detail::PieceStore& store() const { return *store_; }

 private:
  friend PieceBody detail::scaled(const PieceBody& body, int exponent);
  explicit PieceBody(std::shared_ptr<const detail::PieceStore> store) : store_(std::move(store)) {}
  std::shared_ptr<const detail::PieceStore> store_;
};

/// A body of pieces and its pose in the common frame. It refers to the body, which must outlive the query.
struct PosedPieces {
  const PieceBody* body;
  Pose pose;
};

}  // namespace pd
