/// @file
/// A body's pieces are stored in its own frame with a hierarchy of their boxes; in a query the body stands in a pose.
#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pd/union_contact/piece_body.hpp"
#include "pd/union_contact/piece_surroundings.hpp"
#include "shape/mesh/triangle_tree.hpp"

namespace pd::detail {

/// The pieces are either the parts of a compound or triangles.
struct PieceStore {
  std::optional<Compound> compound;
  std::vector<std::array<Vec3, 3>> triangles;  ///< with an area
  std::vector<int> numbers;                    ///< of the faces that the triangles are of
  double margin = 0;                           ///< of the triangles
  std::vector<TriangleBox> boxes;              ///< of the pieces, margins included
  TriangleTree tree;
};

/// Returns the body times 2^exponent.
[[nodiscard]] PieceBody scaled(const PieceBody& body, int exponent);

/// A body of pieces in one query. Shapes of triangles and pieces as planes are made when they are first asked for.
class StandingPieces {
 public:
  /// @return out_of_range ("pose") as `Compound::posed`
  static Expected<StandingPieces> stand(const PosedPieces& posed);

  [[nodiscard]] bool is_sheet() const { return !store_->compound; }
  [[nodiscard]] int size() const { return static_cast<int>(store_->boxes.size()); }
  /// Returns the caller's number of a piece.
  [[nodiscard]] int number(int piece) const {
    return is_sheet() ? store_->numbers[static_cast<std::size_t>(piece)] : piece;
  }
  /// Return a box in the world that holds the piece, and one that holds all pieces.
  [[nodiscard]] TriangleBox box(int piece) const;
  [[nodiscard]] TriangleBox whole_box() const;
  /// Finds the pieces whose boxes meet a box in the world, and perhaps a few more, in the order of their numbers.
  void meeting(const TriangleBox& world, std::vector<int>& pieces) const;

  /// Returns null if the piece is a triangle that rounding leaves without an area.
  [[nodiscard]] const ConvexShape* shape(int piece);
  /// Requires: the piece has a shape.
  [[nodiscard]] PosedShape posed(int piece) {
    return is_sheet() ? PosedShape{shape(piece), pose_} : parts_[static_cast<std::size_t>(piece)];
  }
  /// Returns the piece as planes in the world; there are none if it is curved.
  [[nodiscard]] const UnionPiece& planes(int piece);
  /// Returns the side of a triangle from which its corners run counter-clockwise, unit and in the world; zero if its
  /// area vanishes in doubles.
  [[nodiscard]] Vec3 front(int piece) const;

 private:
  StandingPieces(const PosedPieces& posed, std::vector<PosedShape> parts)
      : store_(&posed.body->store()), pose_(posed.pose), parts_(std::move(parts)) {}
  [[nodiscard]] TriangleBox in_world(const TriangleBox& local) const;

  const PieceStore* store_;
  Pose pose_;
  std::vector<PosedShape> parts_;
  std::unordered_map<int, std::optional<ConvexShape>> shapes_;
  std::unordered_map<int, UnionPiece> planes_;
};

/// The rule for covered contacts asks about one piece of a standing body through this class.
class PieceAmong final : public PieceSurroundings {
 public:
  PieceAmong(StandingPieces& all, int piece) : all_(all), piece_(piece) {}
  const UnionFrame& frame() override { return world_; }
  const UnionPiece* own() override { return &all_.planes(piece_); }
  void find(const NearPoint& near, const Beyond* beyond, std::vector<const UnionPiece*>& found) override;

 private:
  StandingPieces& all_;
  int piece_;
  UnionFrame world_;
  std::vector<int> near_;
};

}  // namespace pd::detail
