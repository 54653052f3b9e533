/// @file
/// One query about two posed polytopes, and the ways in which it may be answered.
#pragma once

#include <limits>
#include <span>

#include "depth/distance/gjk_exact.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/facets/near_facets.hpp"
#include "depth/pair/polytope_depth.hpp"

namespace pd::detail {

/// Width of the bracket that doubles are asked for, in units of L: `Bracket::certified` less the last roundings.
inline constexpr double kCertifiedWidth = 1.8e-14;

class PolytopeQuery {
 public:
  PolytopeQuery(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers, WarmCertificate* warm,
                PenetrationDepth& out)
      : pair_(pair),
        settings_(settings),
        buffers_(buffers),
        warm_(warm),
        out_(out),
        difference_(*pair.a, *pair.pose_a, *pair.b, *pair.pose_b) {}

  void solve();

 private:
  // The order of methods: polytope_depth.cpp
  [[nodiscard]] ExpansionGoal goal() const;
  [[nodiscard]] bool bound_is_of_face(const ExpansionResult& result) const;
  bool solve_boxes();
  ExpansionResult expand();

  // The memory of the pair: polytope_warm_start.cpp
  bool solve_from_memory();
  bool solve_apart_from_memory();
  void remember_apart(std::span<const VertexPair> simplex);
  bool supported(const DifferenceVertex (&corners)[3], const Vec3& normal, double distance, double largest,
                 ExpansionResult& result) const;
  bool hold(ExpansionResult& result);
  [[nodiscard]] bool is_memory_of_this_pair() const;
  void own_memory();
  bool restore();
  void remember(const ExpansionResult& result);
  /// Sizes outside this range are left to the exact engines, which rescale.
  [[nodiscard]] bool within_range() const { return difference_.reach() > 0x1p-100 && difference_.reach() < 0x1p100; }

  // Answers from doubles: polytope_double.cpp
  void set_depth(double lower, double upper, const Vec3& normal);
  void fill_overlapping(const ExpansionResult& result);
  void fill_overlapping(const DifferenceVertex (&corners)[3], const double (&weights)[3]);
  bool fill_separated(const ExpansionResult& result);
  bool fill_separated(std::span<const DifferenceVertex> start);
  bool solve_among_ties(const ExpansionResult& result);
  void fill_tied(const TiedFacets& found);
  void corners_of(int f, DifferenceVertex (&corners)[3]) const;
  void face_below_origin(int f, const Vec3& normal, DifferenceVertex (&corners)[3], double (&weights)[3]) const;
  void fill_witnesses(const DifferenceVertex* corners, const double* weights, int count);
  void pair_features();

  // Exact answers: polytope_exact.cpp
  void solve_exactly(const ExpansionResult& result);
  bool solve_by_proof(const ExpansionResult& result);
  void solve_overlapping_exactly(const ExpansionResult& result);
  void finish_from(const PosedPair& posed, const VertexPair* seed, int count, const ExactNearest* nearest);
  void solve_by_overlay(double upper = std::numeric_limits<double>::infinity());
  bool prove_tied(const TiedFacets& found);
  void solve_by_decomposition(ExpansionResult result);
  void finish_nearest(const PosedPair& posed, const OverlayDepth& found);
  void tighten_upper(ExpansionResult& result);
  [[nodiscard]] VertexPair any_vertex(const ExpansionResult& result) const;
  void count_stages(const PosedPair& posed);

  const PolytopePair& pair_;
  const DepthSettings& settings_;
  ScratchBuffers& buffers_;
  WarmCertificate* warm_;
  PenetrationDepth& out_;
  PolytopeDifference difference_;
  Bracket bracket_ = Bracket::tightest;
  VertexPair start_[4];
  int start_count_ = 0;
  bool doubles_suffice_ = false;  ///< neither the tightest bracket nor another method is asked for
  bool memory_held_ = false;      ///< the surface is the one remembered, as it was
};

}  // namespace pd::detail
