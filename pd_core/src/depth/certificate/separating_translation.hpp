/// @file
/// A translation in doubles that separates two bodies exactly as stored and is no longer than the depth rounded up.
#pragma once

#include "depth/certificate/nearest_plane.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

/// A triple t of doubles that reaches the separation, as near to depth * unit and as short as doubles allow.
///
/// @param depth   the length wanted, positive, in double-double: `separation.depth()`, or the exact value with a
///                relative error below RootSum::kApproximationError.
/// @param upper   the depth rounded up.
/// @param margin  of both bodies together.
/// @param bracket  where it is not the tightest, a few candidates are tried and no more.
/// @return `upper`, or the next double where no triple that reaches is no longer than it, very rarely one of the six
///         after that: t is no longer than what is returned, exactly.
/// Deterministic; no allocation where double-double decides. Time: for the tightest bracket two searches of at most
/// 129^2 candidates, each a few operations in double-double; of those that may do (about two, mostly the first) a sign
/// on exact numbers. Else a few such signs.
double shortest_translation(const PosedPair& pair, Separation& separation, const DoubleDouble& depth, double upper,
                            double margin, Bracket bracket, Vec3& translation);

/// L, rounded: the largest |coordinate| of b - a over the posed vertices. Time of twelve supports.
[[nodiscard]] double largest_coordinate(const PosedPair& pair);

}  // namespace pd::detail
