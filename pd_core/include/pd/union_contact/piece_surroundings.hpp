/// @file
/// The pieces of a union around one of them: what the rule for covered contacts (covered_contact.hpp) asks of a mesh,
/// heightfield or compound. A host implements it on its own trees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pd/union_contact/union_piece.hpp"

namespace pd {

/// Around a point of a piece's core, in the frame of its union.
struct NearPoint {
  Vec3 point;
  double reach;
  double slack;  ///< within which pieces are neighbours, as the reach of `neighbours`
};

/// The half-space of what covers against n: what does not reach into it has no way that leads on along n.
struct Beyond {
  Vec3 n;  ///< unit, outward
  double level;
};

/// The share of a piece's facet that other pieces of its union cover.
enum class FacetCover : std::uint8_t {
  unknown,  ///< nobody asked yet
  some,     ///< perhaps a part, or it is not known
  none,     ///< no more than lines: every contact that pushes off from it holds
  all       ///< beyond doubt, and one of them all of it
};

/// The frame in which the pieces of a union are looked at. A compound that is a whole body has its own frame, in which
/// its children stand still from step to step; all others have the world's.
struct UnionFrame {
  bool is_world = true;
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  [[nodiscard]] Vec3 place(const Vec3& point) const {
    return is_world ? point : Vec3(rotation.transpose() * (point - translation));
  }
  [[nodiscard]] Vec3 turn(const Vec3& direction) const {
    return is_world ? direction : Vec3(rotation.transpose() * direction);
  }
  [[nodiscard]] Vec3 turn_back(const Vec3& direction) const {
    return is_world ? direction : Vec3(rotation * direction);
  }
};

class PieceSurroundings {
 public:
  virtual ~PieceSurroundings() = default;

  /// The frame in which the union is looked at. Everything below lies in it.
  [[nodiscard]] virtual const UnionFrame& frame() = 0;

  /// The piece itself where the host keeps it as planes, or nullptr.
  [[nodiscard]] virtual const UnionPiece* own() = 0;

  /// Sets `found` to the other pieces that come within reach of a point of this one. Curved pieces are left out, since
  /// contacts inside of them do not arise from seams. Pieces stay valid until the next call.
  /// @param beyond  null, or: pieces whose surface does not come beyond it may be left out
  virtual void find(const NearPoint& near, const Beyond* beyond, std::vector<const UnionPiece*>& found) = 0;

  /// Tells whether another piece may come within reach of the point. True costs a search.
  [[nodiscard]] virtual bool may_hold(const NearPoint& /*near*/) { return true; }

  /// How much the other pieces cover of all of the piece's facet, and so of every part of it.
  [[nodiscard]] virtual FacetCover cover_of(std::size_t /*facet*/, double /*slack*/) { return FacetCover::some; }
};

}  // namespace pd
