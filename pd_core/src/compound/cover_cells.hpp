/// @file
/// Where the boundary of the union of the P_k can be nearest to the origin: cubes of translations, the nearest first,
/// halved until one P_k holds a cube, none meets it, or few do.
///
/// Doubles with bounds decide (`RoughPlane`), one way only: a cube that is passed over holds no boundary point for
/// certain. Cubes come in the order of their distance, and none beyond the bound known so far, so that of two bodies
/// deep inside each other only the P_k near the answer are ever cut exactly.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "compound/nearest_first.hpp"
#include "compound/part_differences.hpp"

namespace pd::detail {

class UnionMemory;

/// A cube of translations (inside lengths), and the P_k that may meet it.
struct CoverCell {
  double key = 0;  ///< no point of the cube is nearer to the origin
  int depth = 0;
  std::int32_t known = -1;  ///< the same cube of the last frame's search; -1: there was none
  std::int32_t record = 0;  ///< it in this one's
  Vec3 centre = Vec3::Zero();
  double half = 0;
  std::shared_ptr<const std::vector<std::int32_t>> pieces;
};

/// Half the side of a first cube: few digits, so that corners of cubes are exact and neighbours share their faces.
[[nodiscard]] double rounded_up(double length);

/// At most the distance from the origin to what lies of a facet's plane in a cube, rounding included.
/// @param extent  of the differences.
[[nodiscard]] double distance_within(const RoughPlane& plane, const CoverCell& cell, double extent);

/// A cube of translations lies in the interior of a P_k or apart from it, for certain, or else is in doubt (`meets`).
enum class CoverPlace : std::uint8_t { holds, meets, apart };
/// Makes the P_k unless its box tells enough.
[[nodiscard]] CoverPlace cover_place(PartDifferences& differences, std::size_t k, const Vec3& centre, double half);

class CoverCells {
 public:
  /// Refers to the differences, and makes those it needs. The first cube holds the ball of radius `reach` about the
  /// origin.
  /// @param known_lower  no boundary point is nearer.
  /// @param memory       nullptr, or what the last frame's search left: cubes that it halved are halved at once, and of
  ///                     those that one P_k held, that one is asked first.
  CoverCells(PartDifferences& differences, double reach, double known_lower, UnionMemory* memory);

  /// The nearest cube left that may hold a boundary point no farther than `upper`, down to cubes of few P_k, cubes
  /// that halving does not help, or 2^-kMaxDepth of the first; nothing when there is none. Every boundary point that is
  /// nearer than every point of the cubes handed out so far and than `upper` is still to come.
  std::optional<CoverCell> next(double upper);

  [[nodiscard]] std::int64_t num_cells() const { return num_cells_; }

 private:
  static constexpr int kMaxDepth = 8;
  /// Cubes that more P_k meet are halved first.
  static constexpr std::size_t kFew = 4;
  /// After so many cubes the P_k abut, as the parts of a solid do, and halving follows their walls. Holding this many
  /// P_k against each other is cheaper then.
  static constexpr std::int64_t kCellsOfWalls = 1000;
  static constexpr std::size_t kFewAtWalls = 32;
  /// More than these are worth another halving, even if the last one told none apart.
  static constexpr std::size_t kMany = 48;
  /// Beyond it cubes are handed out as they come: what is left to find then takes exact cuts, not more cubes.
  static constexpr std::int64_t kMaxCells = 200'000;
  static constexpr std::size_t kRecent = 16;

  /// Whether a P_k holds the cube; else the P_k that may meet it are left in `meeting_`.
  bool covered(const CoverCell& cell);
  /// The same for a cube that the last search halved, by boxes alone: it was not held.
  void find_meeting(const CoverCell& cell);
  void halve(const CoverCell& cell);
  CoverPlace place(const CoverCell& cell, std::size_t k) {
    return cover_place(differences_, k, cell.centre, cell.half);
  }
  void add(CoverCell cell);

  PartDifferences& differences_;
  double known_lower_;
  UnionMemory* memory_;
  double upper_ = HUGE_VAL;  ///< a placement at this distance is free
  NearestFirst<CoverCell> queue_;
  std::vector<std::int32_t> recent_;
  std::vector<std::int32_t> meeting_;
  std::int64_t num_cells_ = 0;
};

}  // namespace pd::detail
