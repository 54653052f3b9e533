#include "pd/bullet/penetration_depth_solver.hpp"

#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <atomic>
#include <chrono>

#include "contact_algorithm.hpp"
#include "pair_registry.hpp"
#include "pd/bullet/scalar.hpp"
#include "thread_buffers.hpp"

namespace pd {

struct BulletPenetrationDepthSolver::Counters {
  std::atomic<std::int64_t> calls{0};
  std::atomic<std::int64_t> overlapping{0};
  std::atomic<std::int64_t> touching{0};
  std::atomic<std::int64_t> separated{0};
  std::atomic<std::int64_t> warm{0};
  std::atomic<std::int64_t> unsupported{0};
  std::atomic<std::int64_t> fallback{0};
  std::atomic<std::int64_t> refused_poses{0};
  std::atomic<std::int64_t> support_calls{0};
  std::atomic<std::int64_t> nanoseconds{0};

  static void add(std::atomic<std::int64_t>& counter, std::int64_t n = 1) {
    counter.fetch_add(n, std::memory_order_relaxed);
  }
};

struct BulletPenetrationDepthSolver::CreateFuncs {
  explicit CreateFuncs(BulletPenetrationDepthSolver& solver) : one_shot(solver), persistent(&solver) {}
  detail::ContactAlgorithm::CreateFunc one_shot;
  btConvexConvexAlgorithm::CreateFunc persistent;
};

BulletPenetrationDepthSolver::BulletPenetrationDepthSolver(const BulletSolverSettings& settings)
    : settings_(settings),
      cache_(settings.cache_capacity),
      counters_(std::make_unique<Counters>()),
      buffers_(std::make_unique<detail::ThreadBufferPool>()),
      pairs_(std::make_unique<detail::PairRegistry>()),
      create_funcs_(std::make_unique<CreateFuncs>(*this)) {}

BulletPenetrationDepthSolver::~BulletPenetrationDepthSolver() = default;

std::optional<BulletPairAnswer> BulletPenetrationDepthSolver::query(const btConvexShape& a,
                                                                    const btTransform& transform_a,
                                                                    const btConvexShape& b,
                                                                    const btTransform& transform_b,
                                                                    WarmCertificate* warm) {
  Counters::add(counters_->calls);
  BulletPairAnswer answer;
  answer.shape_a = cache_.find_or_convert(a);
  answer.shape_b = cache_.find_or_convert(b);
  if (!answer.shape_a || !answer.shape_b) {
    Counters::add(counters_->unsupported);
    return std::nullopt;
  }
  const auto in_range = [](const btTransform& transform) {
    return is_finite(transform) && to_pd(transform.getOrigin()).cwiseAbs().maxCoeff() <= kMaxCoordinate;
  };
  if (!in_range(transform_a) || !in_range(transform_b)) {
    Counters::add(counters_->refused_poses);
    return std::nullopt;
  }
  answer.pose_a = to_pd(transform_a);
  answer.pose_b = to_pd(transform_b);
  const auto start = std::chrono::steady_clock::now();
  {
    auto buffers = buffers_->lease();
    DepthSettings settings;
    settings.delta = settings_.delta;
    settings.bracket = Bracket::certified;  // Bullet rounds to its own scalar anyway
    answer.depth = penetration_depth({answer.shape_a.get(), answer.pose_a}, {answer.shape_b.get(), answer.pose_b},
                                     buffers->scratch, settings, warm);
  }
  const auto spent = std::chrono::steady_clock::now() - start;
  Counters::add(counters_->nanoseconds, std::chrono::duration_cast<std::chrono::nanoseconds>(spent).count());
  Counters::add(counters_->support_calls, answer.depth.statistics.support_calls);
  switch (answer.depth.contact) {
    case ContactClass::overlapping:
      Counters::add(counters_->overlapping);
      break;
    case ContactClass::touching:
      Counters::add(counters_->touching);
      break;
    case ContactClass::separated:
      Counters::add(counters_->separated);
      break;
  }
  if (answer.depth.warm) {
    Counters::add(counters_->warm);
  }
  return answer;
}

ContactManifold BulletPenetrationDepthSolver::manifold(const BulletPairAnswer& answer, double breaking_threshold) {
  auto buffers = buffers_->lease();
  return contact_manifold({answer.shape_a.get(), answer.pose_a}, {answer.shape_b.get(), answer.pose_b}, answer.depth,
                          breaking_threshold, buffers->manifold);
}

bool BulletPenetrationDepthSolver::calcPenDepth(btSimplexSolverInterface& simplex_solver, const btConvexShape* a,
                                                const btConvexShape* b, const btTransform& transform_a,
                                                const btTransform& transform_b, btVector3& v, btVector3& witness_a,
                                                btVector3& witness_b, btIDebugDraw* debug_draw) {
  const auto answer = query(*a, transform_a, *b, transform_b);
  if (!answer) {
    return answer_by_fallback(simplex_solver, a, b, transform_a, transform_b, v, witness_a, witness_b, debug_draw);
  }
  const PenetrationDepth& depth = answer->depth;
  v = to_bullet(depth.normal);
  if (depth.contact != ContactClass::separated) {
    witness_a = to_bullet(depth.witness_a);
    witness_b = to_bullet(depth.witness_b);
    return true;
  }
  // From the surfaces back to Bullet's cores: A's surface faces -normal, B's faces +normal.
  witness_a = to_bullet(depth.witness_a + static_cast<double>(a->getMarginNonVirtual()) * depth.normal);
  witness_b = to_bullet(depth.witness_b - static_cast<double>(b->getMarginNonVirtual()) * depth.normal);
  return false;
}

bool BulletPenetrationDepthSolver::answer_by_fallback(btSimplexSolverInterface& simplex_solver, const btConvexShape* a,
                                                      const btConvexShape* b, const btTransform& transform_a,
                                                      const btTransform& transform_b, btVector3& v,
                                                      btVector3& witness_a, btVector3& witness_b,
                                                      btIDebugDraw* debug_draw) {
  v.setZero();
  if (settings_.fallback == nullptr || !is_finite(transform_a) || !is_finite(transform_b)) {
    return false;
  }
  Counters::add(counters_->fallback);
  return settings_.fallback->calcPenDepth(simplex_solver, a, b, transform_a, transform_b, v, witness_a, witness_b,
                                          debug_draw);
}

BulletSolverStatistics BulletPenetrationDepthSolver::statistics() const {
  const auto read = [](const std::atomic<std::int64_t>& counter) { return counter.load(std::memory_order_relaxed); };
  BulletSolverStatistics result;
  result.calls = read(counters_->calls);
  result.overlapping = read(counters_->overlapping);
  result.touching = read(counters_->touching);
  result.separated = read(counters_->separated);
  result.warm = read(counters_->warm);
  result.unsupported = read(counters_->unsupported);
  result.fallback = read(counters_->fallback);
  result.refused_poses = read(counters_->refused_poses);
  result.support_calls = read(counters_->support_calls);
  result.nanoseconds = read(counters_->nanoseconds);
  return result;
}

void BulletPenetrationDepthSolver::reset_statistics() {
  for (auto* counter : {&counters_->calls, &counters_->overlapping, &counters_->touching, &counters_->separated,
                        &counters_->warm, &counters_->unsupported, &counters_->fallback, &counters_->refused_poses,
                        &counters_->support_calls, &counters_->nanoseconds}) {
    counter->store(0, std::memory_order_relaxed);
  }
}

btCollisionAlgorithmCreateFunc* BulletPenetrationDepthSolver::one_shot_create_func() {
  return &create_funcs_->one_shot;
}

btCollisionAlgorithmCreateFunc* BulletPenetrationDepthSolver::persistent_create_func() {
  return &create_funcs_->persistent;
}

}  // namespace pd
