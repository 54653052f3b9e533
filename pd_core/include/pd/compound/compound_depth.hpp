/// @file
/// Penetration depth of non-convex bodies given as unions of convex parts ([A], open problem (ii); design for
/// star-shaped bodies and compounds alike).
///
/// With A the union of A_i and B that of B_j, P = B + (-A) is the union of the convex P_ij = B_j + (-A_i). The
/// placements t of A that are not free are int P, the interior of the union of the P_ij that have an interior. Where
/// two P_ij abut, the common wall belongs to int P, so a slot of zero width is no way out (regularised complement). The
/// depth is the distance from the origin to the boundary of int P; 0 when the origin lies outside or on it. Leaving a
/// body through a hole or into a cavity counts: the depth is the shortest move to a place where the interiors are
/// disjoint.
///
/// Polytopes without margins are answered exactly: facets of the P_ij are cut by the other P_ij in exact arithmetic,
/// the nearest first, until one is left uncovered. The explicit construction of [A] section 4 takes all of them,
/// O(m^3 n^3) cuts and pieces. Here cubes of translations that one P_ij holds are passed over, nearest first, and
/// only facets that cross the rest are made exactly. Swept and curved parts are answered by polytopes inside and
/// around them, whose exact depths are bounds. Where those do not meet, an octree over translations follows. The answer
/// is certified to (1 + delta), or to the bracket that a budget leaves; `bracket_reached` is false then.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/compound.hpp"

namespace pd {

class Scratch;
class WarmUnion;

enum class UnionMethod : std::uint8_t {
  automatic,  ///< facets where every part is a polytope without a margin, else octree
  facets,     ///< exact
  octree,     ///< certified bracket, any convex parts
};

struct UnionSettings {
  UnionMethod method = UnionMethod::automatic;
  /// The bracket of the octree closes to upper <= (1 + delta) lower; in (0, 1].
  double delta = 1e-2;
  /// Cells of the octree with sides below this length are not split further: there the bracket stays as it is
  /// (`closed` tells). 0: 2^-20 of the size of P.
  double resolution = 0;
  /// Facets of P_ij that may be built; more are refused.
  std::int64_t max_facets = std::int64_t{1} << 20;
};

/// Work done, for measuring.
struct UnionStatistics {
  std::int64_t pairs = 0;     ///< P_ij that were asked
  std::int64_t facets = 0;    ///< facets of P_ij built
  std::int64_t polygons = 0;  ///< uncovered candidates looked at
  std::int64_t cuts = 0;      ///< polygons cut by a P_ij
  std::int64_t cells = 0;     ///< cubes of translations looked at, by the octree or by the search of facets
};

/// The answer of `penetration_depth`, and which parts give it.
struct UnionDepth : PenetrationDepth {
  std::int32_t part_a = 0;  ///< the part that feature_a belongs to
  std::int32_t part_b = 0;
  bool exact = false;  ///< class and depth are those of the stored numbers; upper - lower is rounding
  bool closed = true;  ///< upper <= (1 + delta) lower was reached; `bracket_reached` says the same
  UnionStatistics work;
};

/// Depth of two unions of convex parts, or their distance when apart (the least over the pairs of parts).
///
/// Classes are exact for polytopes without margins; with margins and curved parts they are those of the pairs, and a
/// placement that only touches pairs is `touching`. The stored translation lies outside int P, which is verified
/// exactly on polytopes. |translation| <= upper.
/// Deterministic. @return ErrorCode::out_of_range for poses that compose past the range; limit_exceeded beyond
/// `max_facets`; bad_value ("delta", "resolution"); unsupported when `facets` is asked for other than polytopes.
/// Time: one convex query for each pair whose boxes meet, then as said above; measured in tests/bench. Budget for swept
/// and curved parts: eight pairs of unions of polytopes, with some 20,000 cells and cuts, then 8,192 convex queries.
/// @param warm  the memory of this pair, or nullptr. Class and lower (distance and its bracket) are as without it, bit
///              for bit; upper and depth up to their last bits (1e-15 of them); where several exits or pairs of parts
///              are equally near, translation, normal, witnesses, parts and features may be those of another. `work`
///              and `statistics` count what was done. Answers by the octree do not use it.
[[nodiscard]] Expected<UnionDepth> penetration_depth(const PosedCompound& a, const PosedCompound& b, Scratch& scratch,
                                                     const UnionSettings& settings = {}, WarmUnion* warm = nullptr);

struct UnionDirectionalDepth {
  ContactClass contact = ContactClass::separated;
  double depth = 0;
  double lower = 0;  ///< lower <= exact <= upper; neighbouring doubles (or equal)
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< of the facet through which the ray leaves (overlapping only)
  std::int32_t part_a = 0;
  std::int32_t part_b = 0;
  Feature feature_a;
  Feature feature_b;
  UnionStatistics work;
};

/// The least t >= 0 for which A moved by t d/|d| is free of B: the first uncovered t along the ray (non-convex sigma_d,
/// [D]). Exact on polytopes without margins. Budget: `max_facets`.
/// @return as `penetration_depth`; zero_direction or non_finite ("direction"); unsupported for other shapes.
[[nodiscard]] Expected<UnionDirectionalDepth> directional_depth(const PosedCompound& a, const PosedCompound& b,
                                                                const Vec3& direction, Scratch& scratch,
                                                                const UnionSettings& settings = {});

/// The place of a point in P, as the class of the bodies after A was moved by it. Exact on polytopes without margins.
/// @return ErrorCode::non_finite or out_of_range ("point"). Budget: 2^20 facets of P_ij, then limit_exceeded.
[[nodiscard]] Expected<ContactClass> point_in_difference(const PosedCompound& a, const PosedCompound& b,
                                                         const Vec3& point, Scratch& scratch);

}  // namespace pd
