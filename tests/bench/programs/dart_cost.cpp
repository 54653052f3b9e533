/// @file
/// DART's steps with its detectors and with pdepth's, on the same worlds: processor time of a step, points, and how
/// much the bodies still move at the end. With --record every detector is asked about the same states, those of the
/// world that pdepth's contacts drive: processor time of a query, and the answers in records for `pdepth audit`.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/measure/processor_time.hpp"
#include "dart/dart_mesh.hpp"
#include "pd/dart/collision_detector.hpp"
#include "pd/dart/contact_recorder.hpp"

namespace {

using namespace pd;
using namespace dart::dynamics;
using bench::processor_seconds;
using dart::collision::CollisionDetectorPtr;
using dart::simulation::WorldPtr;

/// A body of 1 kg.
void add_body(const WorldPtr& world, const ShapePtr& shape, const Vec3& at, const Mat3& turn) {
  auto skeleton = Skeleton::create("body" + std::to_string(world->getNumSkeletons()));
  auto [joint, body] = skeleton->createJointAndBodyNodePair<FreeJoint>();
  body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(shape);
  body->setInertia(Inertia(1, Vec3::Zero(), shape->computeInertia(1)));
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.linear() = turn;
  place.translation() = at;
  FreeJoint::setTransformOf(joint, place);
  world->addSkeleton(skeleton);
}

/// A box that stands still. DART's own detector knows no planes against boxes.
void add_wall(const WorldPtr& world, const Vec3& sides, const Vec3& at) {
  auto skeleton = Skeleton::create("wall" + std::to_string(world->getNumSkeletons()));
  auto [joint, body] = skeleton->createJointAndBodyNodePair<WeldJoint>();
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation() = at;
  joint->setTransformFromParentBodyNode(place);
  body->createShapeNodeWith<CollisionAspect, DynamicsAspect>(std::make_shared<BoxShape>(sides));
  skeleton->setMobile(false);
  world->addSkeleton(skeleton);
}

Mat3 turned(double angle, const Vec3& axis) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

ShapePtr stone(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < 24; ++i) {
    const Vec3 p = 0.09 * Vec3{normal(random), normal(random), normal(random)}.normalized();
    points.push_back(p.cast<float>().cast<double>());
  }
  return test::dart_mesh(*ConvexPolytope::from_points(points));
}

struct Scene {
  std::string name;
  std::function<void(const WorldPtr&)> build;
  bool for_darts_own = false;  ///< boxes alone
  bool slow = false;           ///< asked for by --world alone
};

using MakeShape = std::function<ShapePtr(int)>;

Scene heap(const std::string& name, bool boxes, const MakeShape& make) {
  return {name,
          [make](const WorldPtr& world) {
            for (const double side : {-0.4, 0.4}) {
              add_wall(world, {0.04, 0.8, 0.6}, {side, 0, 0.3});
              add_wall(world, {0.8, 0.04, 0.6}, {0, side, 0.3});
            }
            for (int i = 0; i < 18; ++i) {
              const Vec3 at(-0.22 + 0.22 * (i % 3), -0.22 + 0.22 * (i / 3 % 3), 0.15 + 0.22 * (i / 9));
              add_body(world, make(i), at, turned(0.3 * i, {1, 0.5 * (i % 3), 0.2}));
            }
          },
          boxes};
}

std::vector<Scene> scenes() {
  return {{"stack of 5 boxes",
           [](const WorldPtr& world) {
             for (int i = 0; i < 5; ++i) {
               add_body(world, std::make_shared<BoxShape>(Vec3(0.2, 0.2, 0.2)), {0, 0, 0.1 + 0.2 * i},
                        turned(0.12 * i, Vec3::UnitZ()));
             }
           },
           true},
          {"stack of 3 cylinders",
           [](const WorldPtr& world) {
             for (int i = 0; i < 3; ++i) {
               add_body(world, std::make_shared<CylinderShape>(0.1, 0.2), {0, 0, 0.1 + 0.2 * i}, Mat3::Identity());
             }
           }},
          heap("heap of 18 boxes", true, [](int) { return std::make_shared<BoxShape>(Vec3(0.16, 0.14, 0.12)); }),
          heap("heap of 18 meshes of 24", false, [](int i) { return stone(static_cast<unsigned>(i % 6)); }),
          // DART's other detectors know no capsules.
          heap("heap of 18 round bodies", false,
               [](int i) -> ShapePtr {
                 if (i % 2 == 0) return std::make_shared<CylinderShape>(0.07, 0.12);
                 return std::make_shared<SphereShape>(0.08);
               }),
          {"row of 1,000 boxes along y",
           [](const WorldPtr& world) {
             for (int i = 0; i < 1000; ++i) {
               add_body(world, std::make_shared<BoxShape>(Vec3(0.003, 0.003, 0.003)), {0, 0.0039 * (i - 500), 0.0015},
                        Mat3::Identity());
             }
           },
           true, true}};
}

struct Contender {
  std::string name;
  std::string file;  ///< the end of its record's name
  std::function<CollisionDetectorPtr()> create;
};

/// The detectors that are here. DART's worlds begin with FCL's, which turns primitives into meshes.
std::vector<Contender> contenders() {
  register_dart_detector();
  using dart::collision::FCLCollisionDetector;
  std::vector<Contender> found{{"FCL, as DART sets it", "fcl", [] { return FCLCollisionDetector::create(); }},
                               {"FCL with primitives", "fcl_primitives", [] {
                                  auto detector = FCLCollisionDetector::create();
                                  detector->setPrimitiveShapeType(FCLCollisionDetector::PRIMITIVE);
                                  detector->setContactPointComputationMethod(FCLCollisionDetector::FCL);
                                  return detector;
                                }}};
  auto* factory = dart::collision::CollisionDetector::getFactory();
  for (const char* name : {"bullet", "ode", "dart", "pdepth"}) {
    if (factory->canCreate(name)) found.push_back({name, name, [factory, name] { return factory->create(name); }});
  }
  return found;
}

WorldPtr world_of(const Scene& scene, const CollisionDetectorPtr& detector) {
  auto world = dart::simulation::World::create();
  world->setGravity(Vec3(0, 0, -9.81));
  world->setTimeStep(0.002);
  world->getConstraintSolver()->setCollisionDetector(detector);
  add_wall(world, {4, 4, 0.5}, {0, 0, -0.25});
  scene.build(world);
  return world;
}

struct Run {
  double microseconds = 0;  ///< of a step
  double points = 0;        ///< of a step, in the mean
  double speed = 0;         ///< the fastest body at the end
  double highest = 0;       ///< the height of the highest body at the end
};

Run run(const Scene& scene, const CollisionDetectorPtr& detector, int steps) {
  const WorldPtr world = world_of(scene, detector);
  Run result;
  for (int step = 0; step < steps; ++step) {
    const double start = processor_seconds();
    world->step();
    result.microseconds += 1e6 * (processor_seconds() - start) / steps;
    result.points += static_cast<double>(world->getLastCollisionResult().getNumContacts()) / steps;
  }
  result.highest = -HUGE_VAL;
  for (std::size_t i = 0; i < world->getNumSkeletons(); ++i) {
    const auto* body = world->getSkeleton(i)->getBodyNode(0);
    if (!world->getSkeleton(i)->isMobile()) continue;
    result.speed = std::max(result.speed, body->getLinearVelocity().norm());
    result.highest = std::max(result.highest, body->getTransform().translation().z());
  }
  return result;
}

/// False for DART's own detector where there is more than boxes.
bool knows(const Contender& contender, const Scene& scene) { return scene.for_darts_own || contender.name != "dart"; }

/// A detector that is asked about a world that others drive.
class Witness {
 public:
  Witness(const Contender& contender, const WorldPtr& world, const std::string& path)
      : name_(contender.name), group_(contender.create()->createCollisionGroup()), recorder_(path.c_str()) {
    for (std::size_t i = 0; i < world->getNumSkeletons(); ++i) group_->addShapeFramesOf(world->getSkeleton(i).get());
  }
  void ask(const dart::collision::CollisionOption& option) {
    dart::collision::CollisionResult result;
    const double start = processor_seconds();
    group_->collide(option, &result);
    seconds_ += processor_seconds() - start;
    points_ += static_cast<double>(result.getNumContacts());
    ++queries_;
  }
  void record(const dart::collision::CollisionOption& option, double seconds) {
    recorder_.write(*group_, option, seconds);
  }
  void print(const std::string& world) const {
    std::printf("| %s | %s | %.0f | %.1f |\n", world.c_str(), name_.c_str(), 1e6 * seconds_ / queries_,
                points_ / queries_);
  }
  bool close() { return recorder_.close(); }

 private:
  std::string name_;
  std::unique_ptr<dart::collision::CollisionGroup> group_;
  DartRecorder recorder_;
  double seconds_ = 0, points_ = 0;
  int queries_ = 0;
};

/// Asks all detectors about every state of a world that pdepth's contacts drive, and records every tenth.
bool ask_about_same_states(const Scene& scene, const std::vector<Contender>& asked, int steps,
                           const std::string& start_of_path) {
  const WorldPtr world = world_of(scene, DartDetector::create());
  std::vector<std::unique_ptr<Witness>> witnesses;
  for (const Contender& contender : asked) {
    if (!knows(contender, scene)) continue;
    witnesses.push_back(std::make_unique<Witness>(contender, world, start_of_path + contender.file + ".jsonl"));
  }
  auto option = world->getConstraintSolver()->getCollisionOption();
  option.maxNumContacts = 100'000;  // all
  for (int step = 0; step < steps; ++step) {
    world->step();
    for (const auto& witness : witnesses) {
      witness->ask(option);
      if (step % 10 == 9) witness->record(option, world->getTime());
    }
  }
  bool good = true;
  for (const auto& witness : witnesses) {
    witness->print(scene.name);
    good = witness->close() && good;
  }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("DART's steps with its detectors and with pdepth's");
  int steps = 400, only = -1;
  std::string folder;
  app.add_option("--steps", steps, "steps of 2 ms")->check(CLI::PositiveNumber);
  app.add_option("--world", only, "only this world, by its number from 0");
  app.add_option("--record", folder, "folder for records, world by detector; times of queries in place of steps");
  CLI11_PARSE(app, argc, argv);
  const auto asked = contenders();
  int number = 0;
  std::printf("DART, %d steps; microseconds of processor time\n", steps);
  if (!folder.empty()) {
    std::printf("| world | contacts of | query | points |\n");
    std::printf("|---|---|---:|---:|\n");
  } else {
    std::printf("| world | contacts of | step | points | fastest at the end | highest body |\n");
    std::printf("|---|---|---:|---:|---:|---:|\n");
  }
  for (const Scene& scene : scenes()) {
    const int world = number++;
    if (only >= 0 ? only != world : scene.slow) continue;
    if (!folder.empty()) {
      const std::string path = folder + "/world" + std::to_string(world) + "_";
      if (!ask_about_same_states(scene, asked, steps, path)) {
        std::fprintf(stderr, "%s*.jsonl are incomplete\n", path.c_str());
        return 1;
      }
      continue;
    }
    for (const Contender& contender : asked) {
      if (!knows(contender, scene)) continue;
      const Run found = run(scene, contender.create(), steps);
      std::printf("| %s | %s | %.0f | %.1f | %.1e | %.3f |\n", scene.name.c_str(), contender.name.c_str(),
                  found.microseconds, found.points, found.speed, found.highest);
      std::fflush(stdout);
    }
  }
}
