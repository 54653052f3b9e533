#include "pd/bullet/penetration_depth_solver.hpp"

#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "pair/solver_core.hpp"
#include "pd/bullet/pair_answer.hpp"
#include "world/installation.hpp"

namespace pd {

namespace {

/// Keeps what dispatchers may still point to until the program ends. Reachable, so that leak checkers know it.
void keep_for_ever(std::unique_ptr<detail::SolverCore> core) {
  static std::mutex mutex;
  static auto* kept = new std::vector<std::unique_ptr<detail::SolverCore>>;
  const std::lock_guard lock(mutex);
  kept->push_back(std::move(core));
}

using Total = BulletSolverStatistics;
using Own = detail::SolverCounters;
constexpr std::pair<std::int64_t Total::*, detail::Counter Own::*> kCounted[] = {
    {&Total::calls, &Own::calls},
    {&Total::overlapping, &Own::overlapping},
    {&Total::touching, &Own::touching},
    {&Total::separated, &Own::separated},
    {&Total::warm, &Own::warm},
    {&Total::unsupported, &Own::unsupported},
    {&Total::fallback, &Own::fallback},
    {&Total::refused_poses, &Own::refused_poses},
    {&Total::support_calls, &Own::support_calls},
    {&Total::nanoseconds, &Own::nanoseconds},
    {&Total::exact_signs, &Own::exact_signs},
    {&Total::wider_brackets, &Own::wider},
    {&Total::covered_contacts, &Own::covered},
    {&Total::skipped_triangles, &Own::skipped_triangles},
    {&Total::deep_unions, &Own::deep_unions},
    {&Total::deep_unions_nearly, &Own::deep_unions_nearly},
    {&Total::deep_unions_left, &Own::deep_unions_left}};

}  // namespace

void BulletSolverSettings::print_warning(const char* line, void* /*user*/) { std::fprintf(stderr, "%s\n", line); }

BulletPenetrationDepthSolver::BulletPenetrationDepthSolver(const BulletSolverSettings& settings)
    : core_(new detail::SolverCore(settings)) {}

BulletPenetrationDepthSolver::~BulletPenetrationDepthSolver() {
  std::unique_ptr<detail::SolverCore> core(core_);
  if (core->installed()) {
    core->close();
    keep_for_ever(std::move(core));
  }
}

const BulletSolverSettings& BulletPenetrationDepthSolver::settings() const { return core_->settings; }
BulletShapeCache& BulletPenetrationDepthSolver::cache() { return core_->cache; }
detail::PairRegistry& BulletPenetrationDepthSolver::pairs() { return core_->pairs; }

std::optional<BulletPairAnswer> BulletPenetrationDepthSolver::query(const btConvexShape& a,
                                                                    const btTransform& transform_a,
                                                                    const btConvexShape& b,
                                                                    const btTransform& transform_b,
                                                                    WarmCertificate* warm) {
  auto buffers = core_->buffers.lease();
  detail::PairAnswer found;
  const detail::PairQuestion question{.a = a,
                                      .pose_a = transform_a,
                                      .b = b,
                                      .pose_b = transform_b,
                                      .shapes = buffers->recent,
                                      .warm = warm,
                                      .corners = detail::kSharpBoxPair};
  if (core_->answer(question, *buffers, found) != detail::SolverCore::Outcome::answered) {
    return std::nullopt;
  }
  // Shared with the entries, so that the bodies live as long as the answer.
  return BulletPairAnswer{found.depth, std::shared_ptr<const ConvexShape>(buffers->recent[0], found.a.shape),
                          std::shared_ptr<const ConvexShape>(buffers->recent[1], found.b.shape), found.a.pose,
                          found.b.pose};
}

ContactManifold BulletPenetrationDepthSolver::manifold(const BulletPairAnswer& answer, double breaking_threshold) {
  auto buffers = core_->buffers.lease();
  return contact_manifold({answer.shape_a.get(), answer.pose_a}, {answer.shape_b.get(), answer.pose_b}, answer.depth,
                          breaking_threshold, buffers->manifold, DeepestPoint::at_depth);
}

bool BulletPenetrationDepthSolver::calcPenDepth(btSimplexSolverInterface& simplex_solver, const btConvexShape* a,
                                                const btConvexShape* b, const btTransform& transform_a,
                                                const btTransform& transform_b, btVector3& v, btVector3& witness_a,
                                                btVector3& witness_b, btIDebugDraw* debug_draw) {
  return core_->calc_pen_depth(simplex_solver, a, b, transform_a, transform_b, v, witness_a, witness_b, debug_draw);
}

BulletSolverStatistics BulletPenetrationDepthSolver::statistics() const {
  BulletSolverStatistics result;
  core_->buffers.for_each([&](detail::ThreadBuffers& buffers) {
    for (const auto& [total, counter] : kCounted) result.*total += (buffers.counters.*counter).read();
  });
  return result;
}

void BulletPenetrationDepthSolver::reset_statistics() {
  core_->buffers.for_each([](detail::ThreadBuffers& buffers) {
    for (const auto& [total, counter] : kCounted) (buffers.counters.*counter).reset();
  });
}

}  // namespace pd
