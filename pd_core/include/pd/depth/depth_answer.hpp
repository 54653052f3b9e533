/// @file
/// The words of a depth query: what may be asked for (DepthSettings) and what is answered (PenetrationDepth).
///
/// Every engine answers with the same type, so that engines are compared by running them. A moves, B stays.
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "pd/numeric/vector.hpp"
#include "pd/shape/feature.hpp"

namespace pd {

enum class ContactClass : std::uint8_t {
  separated,    ///< the origin lies outside P
  touching,     ///< on its boundary (or P is flat and holds it)
  overlapping,  ///< in its interior
};

enum class Method : std::uint8_t {
  automatic,      ///< exact for (rounded) polytopes, (1 + delta) for smooth bodies
  expansion,      ///< signed certified best-first expansion (polytopes, rounded, smooth)
  overlay,        ///< overlay of the two normal diagrams (polytopes, rounded); of two boxes, their fifteen axes
  decomposition,  ///< [A] section 2
  shallow,        ///< [A] Shallow-Penetration
  grid,           ///< [A] Approx-Separation
};

/// The protocol's words: "separated", "expansion", ...
[[nodiscard]] std::string_view to_string(ContactClass contact);
[[nodiscard]] std::string_view to_string(Method method);

/// How tight the bracket of an exact answer is made.
enum class Bracket : std::uint8_t {
  certified,  ///< upper - lower <= 2e-14 S, from doubles with error bounds: the hot path's choice
  tightest,   ///< lower and upper are the exact depth rounded down and up
  /// An answer that a physics engine can use, at a bounded cost. It is no finer than the numbers of the engine's
  /// poses deserve (`DepthSettings::contact_tolerance`), and never needs numbers of unbounded length. Let s be the
  /// signed distance: the distance of A and B, or minus their depth. Doubles, where they cancel double-double, show s
  /// in an interval no wider than max(2e-14 S, contact_tolerance); for curved bodies max(1e-12 L, contact_tolerance),
  /// or delta times s as ever.
  /// - separated: [distance_lower, distance_upper], above 0;
  /// - overlapping: [-upper, -lower], below 0;
  /// - touching: [-upper, distance_upper], which holds 0; depth, distance, lower and distance_lower are 0.
  /// The plane across `normal` proves the lower end, a point of P or a ball inside P the upper one. Moving A by
  /// upper * normal leaves no more overlap than rounding. Normal, witnesses and features are those of an answer within
  /// the bracket. `bracket_reached` is false where the interval is certified but wider than promised. If it holds 0 and
  /// lies mostly below, the class is then overlapping with lower = 0. Holds for Method::automatic and expansion, where
  /// |b - a| stays in [2^-100, 2^100] or a power of two brings it there exactly; others take it for `certified`.
  contact,
};

struct DepthSettings {
  Method method = Method::automatic;
  Bracket bracket = Bracket::tightest;
  /// Relative error (upper <= (1 + delta) lower) where the answer is approximate; in (0, 1]. For polytopes, 0 = exact.
  double delta = 0;
  /// Seed of the random order in which the decomposition tries blocks of edges. Times depend on it, answers do not.
  std::uint64_t seed = 0;
  /// For Bracket::contact, an interval of this width is narrow enough, in the unit of the input, >= 0. An engine whose
  /// poses are single precision knows them to 2^-24 max(|t_A|, |t_B|).
  double contact_tolerance = 0;
  /// Bodies farther apart than this (>= 0, in the unit of the input) need not be told apart any further. The answer
  /// may then be `separated` with distance_lower > beyond, certified by the plane across `normal`, and with a wide
  /// distance_upper. Witnesses are then points of the bodies, but not the closest ones. This is the question of a
  /// broadphase's hit; anything nearer is answered as usual. Infinity: closest points at any distance.
  double beyond = std::numeric_limits<double>::infinity();
};

struct Statistics {
  std::int64_t support_calls = 0;   ///< supports of P (one on each body)
  std::int64_t facets_visited = 0;  ///< facets of P (or of polytopes inside it) whose plane was evaluated
  std::int64_t exact_signs = 0;     ///< decisions that the floating-point filter left to exact arithmetic
  // The search for the closest lines ([A] Theorem 2.4), whose work is their sum.
  std::int64_t pair_evaluations = 0;  ///< pairs of edges whose lines' distance was taken
  std::int64_t block_bounds = 0;      ///< blocks of pairs of edges that were bounded together
  std::int64_t lines_scanned = 0;     ///< edges passed over for those bounds
};

/// A depth with its own proof. Lengths are in the unit of the input; vectors and points in the frame that A and B
/// share. L below is the largest |coordinate| of b - a over the posed vertices. S is the size of the numbers that
/// polytopes are given in. It adds up the distances of A's and of B's farthest vertex from the origins of their frames,
/// both margins, and |t_B - t_A|.
struct PenetrationDepth {
  ContactClass contact = ContactClass::separated;
  Method method = Method::automatic;  ///< the engine that answered
  bool warm = false;                  ///< the certificate of an earlier frame held
  /// False: rounding, or a budget of operations, ended the search with a bracket that is certified but wider than
  /// asked.
  bool bracket_reached = true;

  double depth = 0;  ///< |translation| up to rounding; 0 unless overlapping
  double lower = 0;  ///< certified: lower <= pi(A, B) <= upper
  double upper = 0;

  double distance = 0;  ///< 0 unless separated
  double distance_lower = 0;
  double distance_upper = 0;

  Vec3 translation = Vec3::Zero();  ///< separates A from B exactly as stored: outside int P; |translation| <= upper
  Vec3 normal = Vec3::UnitX();      ///< unit; translation / depth, or (witness_a - witness_b) / distance, or a way out
  Vec3 witness_a = Vec3::Zero();    ///< point of A; translation = witness_b - witness_a up to 8 ulp of L
  Vec3 witness_b = Vec3::Zero();

  Feature feature_a;  ///< the features of the cores whose difference holds the nearest boundary point
  Feature feature_b;

  Statistics statistics;

  /// distance, or minus depth where the bodies overlap.
  [[nodiscard]] double signed_distance() const { return contact == ContactClass::separated ? distance : -depth; }
};

/// Counts of [A] section 3.2, Shallow-Penetration.
struct ShallowCounts {
  std::int64_t directions = 0;  ///< rays: O(1 / delta)
  std::int64_t seeds = 0;       ///< different facets hit by the short rays
  std::int64_t visited = 0;     ///< facets of P (pieces of one plane count singly) visited: at most K_delta
  std::int64_t steps = 0;       ///< edges of P crossed or found to lie outside the ball
  std::int64_t degrees = 0;     ///< arcs tried in those steps: the degrees of the visited cells
  double radius = 0;            ///< of the ball
};

}  // namespace pd
