/// @file
/// Brute force over every direction that can be a facet normal of P = B + (-A), decided in exact arithmetic.
///
/// pi = min over unit n of h_P(n), and the minimum is at a facet normal of P: a facet of B, a facet of -A, or the cross
/// product of an edge of each. Any direction gives an upper bound, so that a superset of the candidates does no harm;
/// doubles with an error bound discard all but the nearly least ones, quadruple precision with one of its own all but
/// those that tie to some 2^-100, and these are compared as rationals.
#pragma once

#include <cstdint>
#include <vector>

#include "oracle/exact_pair.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::oracle {

struct Verdict {
  ContactClass contact = ContactClass::separated;
  bool flat_difference = false;
  ExactLength depth;  ///< 0 unless overlapping
  std::vector<IVec>
      normals;  ///< every optimal facet normal of P (outward), any length; empty unless overlapping or touching
  std::vector<Vec3> unit_normals;  ///< the same, unit, rounded
  ExactLength distance;            ///< 0 unless separated; only when asked for
  bool distance_known = false;
  int compared_exactly = 0;  ///< directions whose heights were compared as rationals, not the first one
};

/// Where quadruple precision leaves out directions that are not least before the others are compared as rationals. The
/// verdict is the same: where coordinates are of 512 bits and more, most of the time is saved.
enum class QuadFiltering : std::uint8_t { never, wide_coordinates, always };

struct JudgeSettings {
  bool distance = true;  ///< find the exact distance of separated bodies
  QuadFiltering quad_filtering = QuadFiltering::wide_coordinates;
};

/// Class, depth, all optimal directions, and distance of two posed bodies, exactly.
/// Time O(E_A E_B) sign tests of a few nanoseconds, and the exact comparisons of near ties.
[[nodiscard]] Verdict judge(const ExactPair& pair, const JudgeSettings& settings = {});

/// Whether the interiors are disjoint, with the first candidates to try as a proof.
[[nodiscard]] bool interiors_disjoint(const ExactPair& pair, const std::vector<IVec>& likely_normals);

/// Exact distance by feature pairs; the result is certified by the supports of its direction. Returns false (never a
/// guess) when no feature pair could be certified.
[[nodiscard]] bool exact_distance(const ExactPair& pair, ExactLength& distance);

}  // namespace pd::oracle
