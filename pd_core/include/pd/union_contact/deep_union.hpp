/// @file
/// If two unions of convex pieces are deep in each other, they are led out by a short way of the whole, and are not
/// torn between pieces.
///
/// A piece that is far inside another union has no answer of its own that holds for the whole: its nearest exits lead
/// into other pieces, and pairs of pieces push against each other. There the shortest way out of the whole
/// (union_exit.hpp) answers, within a budget.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/union_contact/union_exit.hpp"

namespace pd {

/// Pieces of one union in the common frame.
struct NearSide {
  std::vector<PosedShape> posed;
  std::vector<int> numbers;  ///< of the pieces, as the host counts them
};

/// The pieces of two unions that come near each other. A host implements it on its own trees.
class NearSides {
 public:
  virtual ~NearSides() = default;

  /// Sets `a` and `b` to the pieces that come within `reach` of the other body. They stay valid until the next call.
  /// @return false if a piece within reach has no exact form, or if no piece of a or of b is within reach
  virtual bool collect(double reach, NearSide& a, NearSide& b) = 0;
};

/// An answer about two pieces, with the numbers that the host gave them.
struct PiecesAnswer {
  PenetrationDepth depth;
  PosedShape a{};
  PosedShape b{};
  int piece_a = -1;
  int piece_b = -1;
};

/// Memory of one thread.
struct DeepBuffers {
  Scratch& scratch;
  ManifoldScratch& manifold;
  UnionExit& exit;
};

/// The answers about the pairs of pieces of two unions, and the way out of the whole if they ask for one. Lengths are
/// in the unit of the input; poses, normals and ways in the common frame.
class DeepUnion {
 public:
  /// Forgets the answers of the last step.
  void clear();
  /// Takes note of what two pieces said about each other, and of what the rule of covered_contact.hpp left of it. The
  /// answer's shapes are used until `clear`.
  void add(const PiecesAnswer& answer, const ContactManifold& left);
  /// Tells whether the way out of the whole is to be asked for. Pieces are in each other by a quarter of the smaller
  /// one's radius or more. Either no contact of theirs is left, or those that are left lead more than 45 degrees apart
  /// from each other or from the pieces' own answers. One that is deeper than a way out may be (`nearly`) is a reason,
  /// too.
  [[nodiscard]] bool needed() const;
  /// Asks the same in a step. If few pieces are near and the bodies hardly move, a thin piece also counts as deep, from
  /// two fifths of its extent along its own way out.
  /// @param way        length by which the bodies come closer in the step
  /// @param num_pairs  number of pairs of pieces that are near
  [[nodiscard]] bool needed_in_step(double way, std::size_t num_pairs) const;

  struct Way {
    ContactManifold points;  ///< of the two pieces that touch last, along the way out
    int piece_a = -1;        ///< those pieces
    int piece_b = -1;
  };
  enum class Outcome {
    found,        ///< the shortest way
    nearly,       ///< a way that is at most half as long again or, if a piece is smooth, about the shortest
    apart,        ///< only margins meet
    over_budget,  ///< more pairs of pieces within reach, or facets of their differences, than one answer may take
    unsupported   ///< a piece within reach has no exact form
  };
  struct Question {
    NearSides& near;
    double threshold;      ///< >= 0: a pair of points with a wider gap is no contact
    double pose_rounding;  ///< as of `seam_slack`
    Vec3 back;             ///< back the way that A came: the velocity of B less that of A, or zero
  };
  /// Finds the shortest way out of the cores of B for those of A, all pieces that it could meet included, or one that
  /// is little longer (`nearly`). Rounded pieces go on by their margins. Requires: an answer of overlapping pieces was
  /// added. Time: O(p) queries of depth for p pairs of pieces within reach, and then as said in union_exit.hpp.
  /// @param last  unit, along which the pair was led out in the last step, or zero; set to the direction found
  /// @param way   set if the outcome is `found` or `nearly`
  Outcome find_way(const Question& question, const DeepBuffers& buffers, Vec3& last, Way& way);

 private:
  struct Box {
    Vec3 low;
    Vec3 high;
  };
  struct Side : NearSide {
    std::vector<Box> boxes;
  };
  /// Collects the pieces and their boxes. @return what `NearSides::collect` returns
  bool collect(double reach, NearSides& near);

  /// Tells whether A moved along the deepest pair's way out is free of B: then the unions' depth is that pair's, since
  /// the union of the differences P_ij holds each of them. Requires: all pieces within that reach are collected.
  [[nodiscard]] bool deepest_pair_leads_out(Scratch& scratch) const;
  /// Returns A's piece number i moved by `way`; empty if the box of B's piece number j is apart from it or what is left
  /// of their depth is rounding.
  [[nodiscard]] std::optional<PosedShape> still_in(std::size_t i, std::size_t j, const Vec3& way,
                                                   Scratch& scratch) const;

  /// The pairs of pieces that are deep, by their answers.
  struct DeepPairs {
    double deepest = 0;
    std::vector<Vec3> normals;  ///< of their contacts that are left
    bool torn = false;
    void clear() {
      deepest = 0;
      normals.clear();
      torn = false;
    }
    void add(const PenetrationDepth& depth, const ContactManifold& left);
    [[nodiscard]] bool need_a_way() const { return deepest > 0 && (normals.empty() || torn); }
  };

  using OwnWay = std::pair<double, Vec3>;
  /// A straight way for A out of B need not lead to the nearest place.
  struct Exit {
    Vec3 along = Vec3::UnitX();  ///< unit
    double length = 0;
    std::size_t a = 0;  ///< the pieces that part last
    std::size_t b = 0;
    Vec3 facet = Vec3::UnitX();  ///< the normal by which they part
  };
  /// Leads out along `n` (unit), if that is no longer than `limit`. Requires: all pieces within that reach are
  /// collected.
  [[nodiscard]] std::optional<Exit> exit_along(const Vec3& n, double limit, Scratch& scratch) const;
  /// Finds a way that is at most half as long again as the deepest pair's own. No way is shorter than that. The way of
  /// the last step is tried, the ways of the deepest pieces and of two of them together, and back the way that A came.
  /// Each is turned straight off the facet that parts last. This is much cheaper than the shortest way, and its answer
  /// is the same from step to step.
  [[nodiscard]] std::optional<Exit> short_exit(const Vec3& back, const Vec3& last, Scratch& scratch);
  /// Sets the contact that leads out. @return false if it has no points
  bool lead_out(const Exit& exit, double threshold, const DeepBuffers& buffers, Way& way) const;

  PiecesAnswer deepest_pair_;     ///< of all pieces
  double deepest_left_ = 0;       ///< depth of the deepest contact that is left
  std::vector<OwnWay> own_ways_;  ///< of pieces in each other: how deep, along which normal
  DeepPairs solid_;               ///< deep by their radius
  DeepPairs thin_;                ///< those, and others deep by their extent
  double pose_rounding_ = 0;
  Side a_;
  Side b_;
};

}  // namespace pd
