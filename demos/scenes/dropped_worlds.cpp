#include "scenes/dropped_worlds.hpp"

#include <cmath>

#include "scenes/world_parts.hpp"

namespace pd::scenes {

ContactScene rebound(double restitution, std::uint64_t perturbation) {
  const int percent = static_cast<int>(std::lround(100 * restitution));
  ContactScene scene{.name = "rebound-" + std::to_string(percent),
                     .title = "Bodies that fall 2 m on a floor, restitution " + std::to_string(percent) + " %",
                     .goal = ContactGoal::rebound,
                     .seconds = 2,
                     .quick_seconds = 2,
                     .drop = 2,
                     .kept_height = restitution * restitution,
                     .rates = {60, 240, 500},
                     .quick = true};
  // Bullet multiplies the two bodies' numbers.
  scene.world.restitution = std::sqrt(restitution);
  scene.world.bodies.push_back(ground_box(20));
  for (int i = 0; i < 9; ++i) {
    const double x = 4.0 * (i % 3 - 1), y = 4.0 * (i / 3 - 1);
    const double half = 0.3 + 0.05 * i;
    const Vec3 at(x, y, scene.drop + half);
    scene.world.bodies.push_back(i % 3 == 0   ? sphere(half, at)
                                 : i % 3 == 1 ? box(Vec3(0.4, 0.5, half), at)
                                              : cylinder(0.5, half, at));
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene heavy_slab(std::uint64_t perturbation) {
  ContactScene scene{.name = "heavy-slab",
                     .title = "A slab of nine boxes on one of a two-hundredth of its weight",
                     .goal = ContactGoal::stand,
                     .seconds = 10,
                     .quick_seconds = 3,
                     .quick = true};
  scene.world.bodies.push_back(ground_box(20));
  for (const double z : {0.5, 1.5}) {
    WorldBody slab;
    slab.kind = WorldBody::Kind::compound;
    slab.mass = z < 1 ? 9 : 1800;
    slab.position = Vec3(0, 0, z);
    for (int i = 0; i < 9; ++i) slab.parts.push_back(box(Vec3::Constant(0.5), Vec3(i % 3 - 1, i / 3 - 1, 0)));
    scene.world.bodies.push_back(slab);
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene dropped_column(std::uint64_t perturbation) {
  ContactScene scene{.name = "dropped-column",
                     .title = "Ten boxes that fall 19 m as a column",
                     .goal = ContactGoal::land,
                     .seconds = 15,
                     .quick_seconds = 6,
                     .size = 2,
                     .quick = true};
  scene.world.bodies.push_back(ground_box(50));
  Stream random(5);
  for (int i = 0; i < 10; ++i) {
    const Vec3 aside(1e-4 * random.next(), 1e-4 * random.next(), 0);
    scene.world.bodies.push_back(box(Vec3::Constant(1), Vec3(0, 0, 20 + 2 * i) + aside));
  }
  perturb(scene, perturbation);
  return scene;
}

}  // namespace pd::scenes
