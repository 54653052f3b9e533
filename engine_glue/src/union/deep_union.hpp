/// @file
/// Two unions of convex pieces that are deep in each other: out the shortest way of the whole, not torn between pieces.
///
/// A piece that is far inside another union has no answer of its own that holds for the whole: its nearest exits lead
/// into other pieces, and pairs of pieces push against each other. There the shortest way out of the whole
/// (union_exit.hpp) answers, within a budget.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pair/solver_core.hpp"
#include "pd/contact/manifold.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/compound_children.hpp"

namespace pd::detail {

struct ThreadBuffers;
struct UnionQuestion;

class DeepUnion {
 public:
  void clear();
  /// Takes note of what two children, of these numbers, said about each other, and of what the rule of
  /// covered_contact.hpp left of it. The answer's shapes are used until `clear`.
  void add(const PairAnswer& answer, int child_a, int child_b, const ContactManifold& left);
  /// Whether children are in each other by a quarter of the smaller one's radius or more, and either nothing of what
  /// they say is left, or what is left leads more than 45 degrees apart or aside of what two of them said.
  [[nodiscard]] bool needed() const { return deepest_ > 0 && (normals_.empty() || torn_); }

  struct Way {
    ContactManifold points;  ///< of the two children that touch last, along the way out
    Child a;                 ///< those children
    Child b;
  };
  enum class Outcome {
    found,        ///< the shortest way
    nearly,       ///< one that is at most half as long again
    apart,        ///< only margins meet
    over_budget,  ///< more pairs of children within reach, or facets of their differences, than one answer may take
    unsupported   ///< a child within reach has no exact form, or one is smooth and no short way was found
  };
  /// The shortest way out of b's cores for a's, all children that it could meet included, or one that is little longer
  /// (`nearly`); rounded children go on by their margins. Time as said in union_exit.hpp for the children within reach.
  /// @param last  unit, along which the pair was led out in the last step, or zero; set to the way found
  Outcome find_way(const UnionQuestion& question, SolverCore& core, ThreadBuffers& buffers, Vec3& last, Way& way);

 private:
  struct Side {
    std::vector<Child> children;
    std::vector<PosedShape> posed;
    std::vector<std::shared_ptr<CachedShape>> held;  ///< as long as they are posed
    bool polytopes = true;                           ///< none of them is smooth
  };
  /// @return whether all children within `reach` of the other body have an exact form
  static bool collect(const btCollisionObjectWrapper& body, const btCollisionObjectWrapper& other, double reach,
                      const UnionQuestion& question, SolverCore& core, Side& side);

  /// Whether A moved along the deepest pair's way out is free of B: then the unions' depth is that pair's, since the
  /// union of the differences P_ij holds each of them. Requires: all children within that reach are collected.
  [[nodiscard]] bool deepest_pair_leads_out(ThreadBuffers& buffers) const;

  using OwnWay = std::pair<double, Vec3>;
  /// A straight way for A out of B, not to the nearest place for certain.
  struct Exit {
    Vec3 along = Vec3::UnitX();  ///< unit
    double length = 0;
    std::size_t a = 0;  ///< the children that part last
    std::size_t b = 0;
    Vec3 facet = Vec3::UnitX();  ///< the normal by which they part
  };
  /// Out along `n` (unit), where that is no longer than `limit`. Requires: all children within that reach are
  /// collected.
  [[nodiscard]] std::optional<Exit> exit_along(const Vec3& n, double limit, ThreadBuffers& buffers) const;
  /// A way that is at most half as long again as the deepest pair's own, which none is shorter than: the last step's,
  /// the ways of the deepest children and of two of them together, and back the way that A came are tried, each
  /// turned straight off what parts last. Much cheaper than the shortest, and the same from step to step.
  [[nodiscard]] std::optional<Exit> short_exit(const UnionQuestion& question, const Vec3& last, ThreadBuffers& buffers);
  /// The contact that leads out. @return false where it has no points
  bool lead_out(const Exit& exit, const UnionQuestion& question, ThreadBuffers& buffers, Way& way) const;

  double deepest_ = 0;       ///< of the children that are deep
  PairAnswer deepest_pair_;  ///< of all children
  int child_a_ = -1;         ///< of that pair
  int child_b_ = -1;
  std::vector<Vec3> normals_;     ///< of their contacts that are left
  std::vector<OwnWay> own_ways_;  ///< of children in each other: how deep, along which normal
  bool torn_ = false;
  Side a_;
  Side b_;
};

}  // namespace pd::detail
