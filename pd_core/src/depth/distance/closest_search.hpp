/// @file
/// The search for the point of P nearest to the origin: Gilbert, Johnson, Keerthi, "A fast procedure for computing the
/// distance between complex objects in three-dimensional space", 1988. One loop for three arithmetics: lanes of doubles
/// (gjk.hpp), double-double (gjk_double_double.hpp) and exact numbers (gjk_exact.hpp).
///
/// A search offers
/// - `has_reached(simplex)`: the nearest point of the simplex is known; is that enough?
/// - `support(simplex)`: a vertex of P next to the origin, seen from that point.
/// - `goes_on(simplex, s)`: does s lie before the plane across that point, and is the bracket too wide still?
/// A simplex offers `add(s)`: keeps the face nearest to the origin, and says whether that came nearer.
///
/// Why it ends: each step comes strictly nearer, and the simplices of a polytope are finitely many. A search over
/// smooth bodies counts its steps.
#pragma once

namespace pd::detail {

template <class Search, class Simplex>
void search_closest_point(Search&& search, Simplex& simplex) {
  while (!search.has_reached(simplex)) {
    auto s = search.support(simplex);
    if (!search.goes_on(simplex, s) || !simplex.add(s)) return;
  }
}

}  // namespace pd::detail
