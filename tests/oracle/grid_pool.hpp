/// @file
/// Random bodies on the integer grid, built once, and pairs of them drawn by number: what `grid_pairs` judges.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "oracle/grid_oracle.hpp"
#include "scenes/shape_families.hpp"

namespace pd::oracle::grid {

/// What a body was made as; where its points came out flatter, the kind of what they are.
enum class Kind : std::uint8_t { point, segment, polygon, tetrahedron, box, prism, hull };
inline constexpr int kKinds = 7;
[[nodiscard]] std::string_view to_string(Kind kind);

struct PooledBody {
  Kind kind;
  Body body;
  ConvexShape shape;      ///< of the library, from the points as given
  ConvexShape reordered;  ///< from the same points in another order
};

/// A pair of the pool with its poses, for the oracle and for the library.
struct DrawnPair {
  const PooledBody* a;
  const PooledBody* b;
  PlacedBody placed_a;
  PlacedBody placed_b;
  Pose pose_a;
  Pose pose_b;
};

/// Immutable once it is made: threads share it.
class Pool {
 public:
  /// `size` bodies of 1 to 8 points on cubes of 2 to 9 units; every kind has the same share. Points repeat, and lie
  /// inside, on edges and on facets of the hull. Throws std::runtime_error where the library refuses one.
  Pool(int size, std::uint64_t seed);

  [[nodiscard]] const std::vector<PooledBody>& bodies() const { return bodies_; }

  /// Pair number i of a seed, whatever was drawn before. Each body is turned by one of the 24 axis rotations; their
  /// boxes overlap, touch or are at most a unit apart along each axis, in three pairs of four with middles near each
  /// other. One in 16 is a body with itself, and one in 16 stands far out, up to 2^40 units from the origin.
  [[nodiscard]] DrawnPair draw(std::uint64_t seed, std::int64_t i) const;

 private:
  std::vector<PooledBody> bodies_;
};

/// The pair as a line of the protocol, for `pdepth query`.
[[nodiscard]] std::string protocol_line(const DrawnPair& pair);

}  // namespace pd::oracle::grid
