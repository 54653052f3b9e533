/// @file
/// Depth along a given direction: the least t >= 0 for which A moved by t d/|d| is separated from B.
///
/// With the origin inside P = B + (-A) this is where the ray from the origin along d leaves P ([A] section 3, Delta(u);
/// [D] for translations); 0 when the bodies do not overlap.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <array>
#include <cstdint>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd {

class Scratch;

enum class DirectionalMethod : std::uint8_t {
  portal,     ///< a triangle of vertices of P across the ray, pushed outwards: about 1.3 supports per doubling of n
              ///< (measured)
  hierarchy,  ///< the inner hierarchies of both bodies descended together, O(log n log m) ([D] Theorem 5.6); polytopes
  overlay,    ///< every facet of P; polytopes
};

/// The inner hierarchies of two bodies, built once for many rays.
struct DirectionalHierarchies {
  const PolyhedralHierarchy* a;
  const PolyhedralHierarchy* b;
};

/// The memory that a query by portal leaves for the next one of the same two polytopes, in a direction or pose near
/// its own:
/// triangles of vertices of P that the line crossed. Nothing in it is trusted: a warm answer is the cold one bit for
/// bit, with any content here.
struct DirectionalCertificate {
  static constexpr std::int32_t kMostTriangles = 25;
  std::int32_t triangles = 0;  ///< one behind the origin, then from wide to narrow those before it
  std::array<std::array<std::int32_t, 6>, kMostTriangles> vertices{};  ///< of A and B in turn
};

/// Counts of a descent of two hierarchies; zero for other methods.
struct DescentCounts {
  std::int64_t steps = 0;        ///< vertices evaluated and signs asked for, O(log n log m)
  std::int64_t certificate = 0;  ///< edges at the final vertices that were checked: their degrees
  std::int64_t caps = 0;         ///< vertices of either body that came in beyond a plane, with their neighbours
  std::int64_t repairs = 0;      ///< vertices that rounding hid from the descent, and the final check found
};

struct DirectionalDepth {
  ContactClass contact = ContactClass::separated;
  double depth = 0;
  double lower = 0;  ///< lower <= exact <= upper; neighbouring doubles (or equal) for polytopes without margins
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< of the facet of P that the ray leaves through (overlapping only)
  Feature feature_a;
  Feature feature_b;
  Statistics statistics;
  DescentCounts descent;
};

/// Directional depth of two posed bodies.
///
/// Polytopes: exact on the stored numbers and poses; every choice is made by the exact sign of a determinant, and the
/// crossing point is rounded from a rational. Smooth bodies and bodies with margins: a certified bracket from doubles,
/// at most 1e-9 wide relative to the depth in all that was measured where the bodies overlap by much more than
/// rounding.
///
/// @param direction  any finite length but zero. Time: O(log) supports as measured, without a budget.
/// @param hierarchies  for DirectionalMethod::hierarchy: those of the two bodies' polytopes, or nullptr (they are built
/// for this ray, in linear time).
/// @param certificate  where a portal starts and what it leaves, or nullptr; for DirectionalMethod::portal and solids.
/// @return ErrorCode::zero_direction or non_finite ("direction"); unsupported for another method than portal when a
/// shape is smooth or has a margin; not_full_dimensional for hierarchies of flat bodies. Of `hierarchies`, bad_value
/// for a null pointer or the hierarchy of another body, unsupported for an outer one ("hierarchies.a" or ".b").
///
/// By portal the class of solids comes out of the same search, wherever the line crosses P away from its edges.
/// By hierarchy the class comes out of two descents, along the ray and against it, where the bodies overlap; the exact
/// classification of touching and separated bodies is that of `penetration_depth`. Departures from [D]:
/// src/depth/rays/hierarchy_descent.hpp.
[[nodiscard]] Expected<DirectionalDepth> directional_depth(const PosedShape& a, const PosedShape& b,
                                                           const Vec3& direction, Scratch& scratch,
                                                           DirectionalMethod method = DirectionalMethod::portal,
                                                           const DirectionalHierarchies* hierarchies = nullptr,
                                                           DirectionalCertificate* certificate = nullptr);

}  // namespace pd
