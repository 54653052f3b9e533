#include "stack/row_groups.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace pd::detail {
namespace {

/// Bodies at rest have the speed that one step of their weight gives them, at most. A row moves where its bodies are
/// faster than that against each other by this factor.
constexpr btScalar kCalm = 2;

btScalar speed_of(const btSolverBody& body, const btVector3& normal, const btVector3& turn) {
  return body.m_linearVelocity.dot(normal) + body.m_angularVelocity.dot(turn);
}

bool is_moving(const btSolverConstraint& row, const SolverBodies& bodies) {
  const btSolverBody& a = bodies[row.m_solverBodyIdA];
  const btSolverBody& b = bodies[row.m_solverBodyIdB];
  const btScalar speed = speed_of(a, row.m_contactNormal1, row.m_relpos1CrossNormal) +
                         speed_of(b, row.m_contactNormal2, row.m_relpos2CrossNormal);
  const btScalar weight = std::max(a.m_externalForceImpulse.length2(), b.m_externalForceImpulse.length2());
  return speed * speed > kCalm * kCalm * weight;
}

}  // namespace

int RowGroups::root(int body) {
  int at = body;
  while (parent_[static_cast<std::size_t>(at)] != at) {
    int& parent = parent_[static_cast<std::size_t>(at)];
    parent = parent_[static_cast<std::size_t>(parent)];
    at = parent;
  }
  return at;
}

void RowGroups::find(const SolverBodies& bodies, const SolverRows& rows) {
  parent_.clear();
  for (int i = 0; i < bodies.size(); ++i) parent_.push_back(can_move(bodies[i]) ? i : -1);
  const auto moves = [this](int body) { return parent_[static_cast<std::size_t>(body)] >= 0; };
  for (int i = 0; i < rows.size(); ++i) {
    const int a = rows[i].m_solverBodyIdA, b = rows[i].m_solverBodyIdB;
    if (!moves(a) || !moves(b)) continue;
    const int root_a = root(a), root_b = root(b);
    parent_[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
  }
  groups_.clear();
  group_of_.assign(parent_.size(), -1);
  for (int i = 0; i < bodies.size(); ++i) {
    if (!moves(i)) continue;
    const auto first = static_cast<std::size_t>(root(i));  // at most i
    if (group_of_[first] < 0) {
      group_of_[first] = static_cast<int>(groups_.size());
      groups_.emplace_back();
    }
    group_of_[static_cast<std::size_t>(i)] = group_of_[first];
    ++groups_[static_cast<std::size_t>(group_of_[first])].num_bodies;
  }
  group_of_row_.clear();
  for (int i = 0; i < rows.size(); ++i) {
    const btSolverConstraint& row = rows[i];
    const bool a = moves(row.m_solverBodyIdA), b = moves(row.m_solverBodyIdB);
    const int group = a || b ? group_of_[static_cast<std::size_t>(a ? row.m_solverBodyIdA : row.m_solverBodyIdB)] : -1;
    group_of_row_.push_back(group);
    if (group < 0) continue;
    Group& facts = groups_[static_cast<std::size_t>(group)];
    ++facts.num_rows;
    facts.joint_rows += i < rows.first_contact() ? 1 : 0;
    facts.moving_rows += i >= rows.first_contact() && is_moving(row, bodies) ? 1 : 0;
  }
  const auto gather = [this](const std::vector<int>& group_of, int Group::*first, int Group::*count,
                             std::vector<int>& members) {
    int before = 0;
    for (Group& group : groups_) {
      group.*first = before;
      before += std::exchange(group.*count, 0);
    }
    members.resize(static_cast<std::size_t>(before));
    for (std::size_t i = 0; i < group_of.size(); ++i) {
      if (group_of[i] < 0) continue;
      Group& group = groups_[static_cast<std::size_t>(group_of[i])];
      members[static_cast<std::size_t>(group.*first + (group.*count)++)] = static_cast<int>(i);
    }
  };
  gather(group_of_, &Group::first_body, &Group::num_bodies, bodies_);
  gather(group_of_row_, &Group::first_row, &Group::num_rows, rows_);
}

std::span<const int> RowGroups::bodies(const Group& group) const {
  return std::span(bodies_).subspan(static_cast<std::size_t>(group.first_body),
                                    static_cast<std::size_t>(group.num_bodies));
}

std::span<const int> RowGroups::rows(const Group& group) const {
  return std::span(rows_).subspan(static_cast<std::size_t>(group.first_row), static_cast<std::size_t>(group.num_rows));
}

double RowGroups::sweeps_of_load(const SolverBodies& bodies, const SolverRows& rows, const Group& group) {
  constexpr int kNotHeld = std::numeric_limits<int>::max();
  level_.assign(parent_.size(), -1);
  for (const int body : this->bodies(group)) level_[static_cast<std::size_t>(body)] = kNotHeld;
  // Neighbours differ by at most one level. Rows come pair by pair, mostly from the ground up or down to it, so that
  // two turns find nearly all levels.
  const std::span<const int> all = this->rows(group);
  const auto end = std::lower_bound(all.begin(), all.end(), rows.first_friction()) - all.begin();
  for (bool has_changed = true, is_back = false; has_changed; is_back = !is_back) {
    has_changed = false;
    for (std::ptrdiff_t k = 0; k < end; ++k) {
      const btSolverConstraint& row = rows[all[static_cast<std::size_t>(is_back ? end - 1 - k : k)]];
      int& a = level_[static_cast<std::size_t>(row.m_solverBodyIdA)];
      int& b = level_[static_cast<std::size_t>(row.m_solverBodyIdB)];
      int &lower = a < b ? a : b, &upper = a < b ? b : a;
      if (upper - 1 <= lower) continue;
      upper = lower + 1;
      has_changed = true;
    }
  }
  level_mass_.clear();
  for (const int body : this->bodies(group)) {
    const int level = level_[static_cast<std::size_t>(body)];
    const double inverse_mass = static_cast<double>(bodies[body].m_originalBody->getInvMass());
    if (level == kNotHeld) continue;
    level_mass_.resize(std::max(level_mass_.size(), static_cast<std::size_t>(level) + 1));
    level_mass_[static_cast<std::size_t>(level)] += inverse_mass > 0 ? 1 / inverse_mass : 0;
  }
  double load = 0, most = 0;
  for (std::size_t level = level_mass_.size(); level-- > 0;) {
    load += level_mass_[level];
    if (level_mass_[level] > 0) most = std::max(most, load / level_mass_[level]);
  }
  constexpr double kOfTower = 0.405;  // 4 / pi^2
  return kOfTower * most * static_cast<double>(level_mass_.size());
}

}  // namespace pd::detail
