/// @file
/// The rows that Bullet has set up for one call of its solver, and the groups of bodies that they connect.
///
/// Bullet hands several small islands to its solver in one call. Bodies of two groups share no row, so that each group
/// is solved, or left to Bullet's sweeps, for itself.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <span>
#include <utility>
#include <vector>

namespace pd::detail {

/// Joints, contacts and friction of one call, numbered through in this order.
struct SolverRows {
  btConstraintArray& joints;
  btConstraintArray& contacts;
  btConstraintArray& friction;

  [[nodiscard]] int first_contact() const { return joints.size(); }
  [[nodiscard]] int first_friction() const { return joints.size() + contacts.size(); }
  [[nodiscard]] int size() const { return first_friction() + friction.size(); }
  [[nodiscard]] btSolverConstraint& operator[](int row) const {
    if (row < first_contact()) return joints[row];
    return row < first_friction() ? contacts[row - first_contact()] : friction[row - first_friction()];
  }
};

using SolverBodies = btAlignedObjectArray<btSolverBody>;

[[nodiscard]] inline bool can_move(const btSolverBody& body) {
  return body.m_originalBody != nullptr && !body.m_originalBody->isStaticOrKinematicObject();
}

class RowGroups {
 public:
  struct Group {
    int first_body = 0, num_bodies = 0;
    int first_row = 0, num_rows = 0;
    int joint_rows = 0;
    int moving_rows = 0;  ///< rows of contacts and friction that `is_moving`
  };

  /// Bodies that can move and rows that push one. Time: O(bodies + rows), but for the inverse of Ackermann's function.
  void find(const SolverBodies& bodies, const SolverRows& rows);

  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
  /// Solver bodies of a group, ascending.
  [[nodiscard]] std::span<const int> bodies(const Group& group) const;
  /// Rows of a group, ascending.
  [[nodiscard]] std::span<const int> rows(const Group& group) const;

  /// About how many sweeps mend all but 1/e of the slowest error of the group; 0 where nothing holds it. A sweep
  /// carries a load from one body to the next. A tower of n equal bodies takes 4 (n / pi)^2 of them. Here one n is the
  /// number of levels, a body's level being the number of bodies between it and what holds the group. The other n is
  /// the largest load of a level over its own mass.
  [[nodiscard]] double sweeps_of_load(const SolverBodies& bodies, const SolverRows& rows, const Group& group);

 private:
  [[nodiscard]] int root(int body);

  std::vector<Group> groups_;
  std::vector<int> parent_;    ///< of each solver body; -1: cannot move
  std::vector<int> group_of_;  ///< of each solver body
  std::vector<int> group_of_row_;
  std::vector<int> bodies_, rows_;  ///< group by group
  // These hold the group whose load was asked for last:
  std::vector<int> level_;  ///< of each solver body; -1: cannot move
  std::vector<double> level_mass_;
};

}  // namespace pd::detail
