#include "stack/row_groups.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cstddef>
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
  int body = 0, row = 0;
  for (Group& group : groups_) {
    group.first_body = body;
    group.first_row = row;
    body += std::exchange(group.num_bodies, 0);
    row += std::exchange(group.num_rows, 0);
  }
  bodies_.resize(static_cast<std::size_t>(body));
  rows_.resize(static_cast<std::size_t>(row));
  for (int i = 0; i < bodies.size(); ++i) {
    if (group_of_[static_cast<std::size_t>(i)] < 0) continue;
    Group& group = groups_[static_cast<std::size_t>(group_of_[static_cast<std::size_t>(i)])];
    bodies_[static_cast<std::size_t>(group.first_body + group.num_bodies++)] = i;
  }
  for (int i = 0; i < rows.size(); ++i) {
    if (group_of_row_[static_cast<std::size_t>(i)] < 0) continue;
    Group& group = groups_[static_cast<std::size_t>(group_of_row_[static_cast<std::size_t>(i)])];
    rows_[static_cast<std::size_t>(group.first_row + group.num_rows++)] = i;
  }
}

std::span<const int> RowGroups::bodies(const Group& group) const {
  return std::span(bodies_).subspan(static_cast<std::size_t>(group.first_body),
                                    static_cast<std::size_t>(group.num_bodies));
}

std::span<const int> RowGroups::rows(const Group& group) const {
  return std::span(rows_).subspan(static_cast<std::size_t>(group.first_row), static_cast<std::size_t>(group.num_rows));
}

void RowGroups::find_neighbours(const SolverRows& rows, const Group& group, int num_bodies) {
  // Rows of one pair stand together, so that most of them are told by the row before.
  const auto visit_pairs = [&](const auto& visit) {
    int last_a = -1, last_b = -1;
    for (const int i : this->rows(group)) {
      const int a = rows[i].m_solverBodyIdA, b = rows[i].m_solverBodyIdB;
      if (a == last_a && b == last_b) continue;
      last_a = a;
      last_b = b;
      visit(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
  };
  neighbour_start_.assign(static_cast<std::size_t>(num_bodies) + 2, 0);
  visit_pairs([this](std::size_t a, std::size_t b) {
    ++neighbour_start_[a + 2];
    ++neighbour_start_[b + 2];
  });
  for (std::size_t i = 2; i < neighbour_start_.size(); ++i) neighbour_start_[i] += neighbour_start_[i - 1];
  neighbours_.resize(static_cast<std::size_t>(neighbour_start_.back()));
  visit_pairs([this](std::size_t a, std::size_t b) {
    neighbours_[static_cast<std::size_t>(neighbour_start_[a + 1]++)] = static_cast<int>(b);
    neighbours_[static_cast<std::size_t>(neighbour_start_[b + 1]++)] = static_cast<int>(a);
  });
}

double RowGroups::sweeps_of_load(const SolverBodies& bodies, const SolverRows& rows, const Group& group) {
  find_neighbours(rows, group, bodies.size());
  const auto visit_neighbours = [this](int body, const auto& visit) {
    const auto at = static_cast<std::size_t>(body);
    for (int i = neighbour_start_[at]; i < neighbour_start_[at + 1]; ++i)
      visit(neighbours_[static_cast<std::size_t>(i)]);
  };
  const auto moves = [this](int body) { return parent_[static_cast<std::size_t>(body)] >= 0; };
  level_.assign(parent_.size(), -1);
  queue_.clear();
  for (const int body : this->bodies(group)) {
    bool is_held = false;
    visit_neighbours(body, [&](int other) { is_held = is_held || !moves(other); });
    if (!is_held) continue;
    level_[static_cast<std::size_t>(body)] = 0;
    queue_.push_back(body);
  }
  level_mass_.clear();
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const int body = queue_[i];
    const auto level = static_cast<std::size_t>(level_[static_cast<std::size_t>(body)]);
    const double inverse_mass = static_cast<double>(bodies[body].m_originalBody->getInvMass());
    if (level == level_mass_.size()) level_mass_.push_back(0);
    level_mass_[level] += inverse_mass > 0 ? 1 / inverse_mass : 0;
    visit_neighbours(body, [&](int other) {
      if (!moves(other) || level_[static_cast<std::size_t>(other)] >= 0) return;
      level_[static_cast<std::size_t>(other)] = static_cast<int>(level) + 1;
      queue_.push_back(other);
    });
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
