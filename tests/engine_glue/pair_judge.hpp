/// @file
/// The judge of the promise that steps which end at first contact make, pair by pair: how near to each other, or how
/// deep in each other, all bodies are that can collide, before and after every step. It shares nothing with the
/// stepper's search nor with Bullet's manifolds: shapes are converted anew, poses of children are composed in doubles,
/// and every pair is asked for its certified signed distance.
///
/// A pair's signed distance is the least over its children. Convex shapes and compounds of them are judged.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <vector>

#include "pd/bullet/rollback.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::test {

/// A certified interval that holds a pair's signed distance, in the world's unit.
struct SignedDistance {
  double lower = 0;
  double upper = 0;
};

/// How a pair came into the step that was judged.
enum class PairStart {
  apart,       ///< farther apart than pairs in contact
  met,         ///< the same, but deep afterwards and in contact when a later part of the step began
  in_contact,  ///< as near as pairs in contact are, or deeper
};
inline constexpr int kNumPairStarts = 3;

/// A pair after a step.
struct JudgedPair {
  const btCollisionObject* a = nullptr;
  const btCollisionObject* b = nullptr;
  PairStart start = PairStart::apart;
  double before = 0;    ///< signed distance, at the most
  double after = 0;     ///< at the most: below 0 the pair is that deep, certified
  double rounding = 0;  ///< max(1e-6 of the smaller body's diameter, 4 units in the last place of its coordinates)
  /// How deep it may be: `rounding` where it was apart, and two slops more than it was where it was in contact or met.
  double allowed = 0;
  bool run_in = false;  ///< the step reported a part of the least length, or that its cuts were used up

  [[nodiscard]] double depth() const { return after < 0 ? -after : 0; }
  [[nodiscard]] bool broken() const { return depth() > allowed; }
};

/// A pair that passed through each other on the way: deeper than at either end of a part of a step.
struct Passage {
  const btCollisionObject* a = nullptr;
  const btCollisionObject* b = nullptr;
  double depth = 0;      ///< on the way
  bool bounded = false;  ///< in a step that reported that its cuts were used up
};

class PairJudge {
 public:
  /// The world's bodies and shapes are those of the first step. Takes the world's tick callback, which notes where
  /// bodies are after each part of a step.
  PairJudge(btDiscreteDynamicsWorld& world, const RollbackSettings& settings);
  ~PairJudge();
  PairJudge(const PairJudge&) = delete;
  PairJudge& operator=(const PairJudge&) = delete;

  /// After a step: all pairs that can collide. Until the next call.
  const std::vector<JudgedPair>& judge(const RollbackReport& report);
  /// Those that passed through each other in parts of the last step.
  [[nodiscard]] const std::vector<Passage>& passages() const { return passages_; }

 private:
  struct Child {
    ConvexShape shape;
    Pose local;
  };
  struct Body {
    const btCollisionObject* object;
    std::vector<Child> children;
    double radius;  ///< of all children about the body's origin
  };
  struct Pair {
    std::size_t a;
    std::size_t b;
    SignedDistance distance;
  };

  void add_children(const btCollisionShape& shape, const Pose& local, Body& body);
  /// Nothing above `beyond` is told apart any further.
  SignedDistance measure(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, double beyond);
  SignedDistance present(const Pair& pair);
  /// Whether the pair was in contact when a part of the step, but the first, began.
  bool met_on_the_way(const Pair& pair);
  [[nodiscard]] double rounding(const Pair& pair) const;
  [[nodiscard]] std::vector<Pose> present_poses() const;
  /// Looks for pairs that passed through each other in a part of a step.
  void look_through(const std::vector<Pose>& start, const std::vector<Pose>& end, bool bounded);

  btDiscreteDynamicsWorld& world_;
  RollbackSettings settings_;
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  std::vector<JudgedPair> judged_;
  std::vector<Passage> passages_;
  std::vector<std::vector<Pose>> ends_;  ///< of bodies: where the last step ended, and each part since
  Scratch scratch_;
};

}  // namespace pd::test
