#include "scenes/worlds.hpp"

#include "scenes/world_parts.hpp"

namespace pd::scenes {

namespace {

WorldBody floor_below(double extent) {
  WorldBody body;
  body.points = box_points(Vec3(extent, extent, 0.25 * extent));
  body.position = Vec3(0, 0, -0.25 * extent);
  body.drawn = false;
  return body;
}

WorldBody box_hull(const Vec3& half, const Vec3& at, int colour) {
  WorldBody body;
  body.points = box_points(half);
  body.half_extents = half;
  body.mass = kDensity * 8 * half.prod();
  body.position = at;
  body.colour = colour;
  return body;
}

WorldBody coloured(WorldBody body, int colour) {
  body.colour = colour;
  return body;
}

}  // namespace

std::vector<Vec3> box_points(const Vec3& half_extents) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back((i & 1 ? 1 : -1) * half_extents.x(), (i & 2 ? 1 : -1) * half_extents.y(),
                        (i & 4 ? 1 : -1) * half_extents.z());
  }
  return points;
}

World small_towers(std::uint64_t seed) {
  World world;
  world.name = "towers";
  world.title = "Towers of 2 cm bodies, margin 0";
  world.should_stand = true;
  world.steps = 720;
  Stream random(seed);
  world.bodies.push_back(floor_below(1));
  const double h = 0.01;
  for (int i = 0; i < 10; ++i) {
    WorldBody body = box_hull(Vec3(h, h, h), Vec3(-0.03, 0, h + 2 * h * i) + 4e-4 * random.level_vector(), 0);
    body.orientation = Eigen::AngleAxisd(0.15 * random.next(), Vec3::UnitZ());
    world.bodies.push_back(body);
  }
  for (int i = 0; i < 8; ++i) {
    WorldBody body = cylinder(h, h, Vec3(0.03, 0, h + 2 * h * i) + 4e-4 * random.level_vector());
    body.orientation = Eigen::AngleAxisd(M_PI * random.next(), Vec3::UnitZ());
    world.bodies.push_back(body);
  }
  world.view_lower = Vec3(-0.08, -0.05, 0);
  world.view_upper = Vec3(0.08, 0.05, 0.205);
  return world;
}

World centimetre_tower(std::uint64_t seed) {
  World world;
  world.name = "tower";
  world.title = "Twenty boxes of 1 cm, 60 steps a second, both by StackSolver";
  world.should_stand = true;
  world.solved_at_once = true;
  world.solver_iterations = 10;
  world.steps_per_second = 60;
  world.steps = 300;
  Stream random(seed);
  world.bodies.push_back(floor_below(1));
  const double h = 0.005;
  for (int i = 0; i < 20; ++i) {
    WorldBody body = box_hull(Vec3(h, h, h), Vec3(0, 0, h + 2 * h * i) + 2e-4 * random.level_vector(), i % 3);
    body.orientation = Eigen::AngleAxisd(0.15 * random.next(), Vec3::UnitZ());
    world.bodies.push_back(body);
  }
  world.view_lower = Vec3(-0.09, -0.05, 0);
  world.view_upper = Vec3(0.09, 0.05, 0.21);
  return world;
}

World deep_pile(std::uint64_t seed) {
  World world;
  world.name = "pile";
  world.title = "A pile of 1 to 2 cm bodies that start inside each other, margin 0";
  world.steps = 720;
  Stream random(seed + 17);
  world.bodies.push_back(floor_below(1));
  const double r = 0.008;
  int made = 0;
  for (int layer = 0; layer < 4; ++layer) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column, ++made) {
        const Vec3 at =
            Vec3(1.45 * r * (column - 1), 1.45 * r * (row - 1), r + 1.45 * r * layer) + 0.2 * r * random.vector();
        WorldBody body = made % 3 == 0   ? box_hull(r * (Vec3::Constant(0.9) + 0.25 * random.vector()), at, 0)
                         : made % 3 == 1 ? cylinder(0.9 * r, 0.9 * r, at)
                                         : stone(random, r, 18, at);
        body.orientation = random.orientation();
        world.bodies.push_back(body);
      }
    }
  }
  world.view_lower = Vec3(-0.062, -0.06, 0);
  world.view_upper = Vec3(0.062, 0.06, 0.055);
  return world;
}

World fast_throws(std::uint64_t seed) {
  World world;
  world.name = "throws";
  world.title = "Thrown at each other at 20 to 40 m/s";
  world.steps = 18;
  world.steps_per_second = 60;
  world.restitution = 0.35;
  world.gravity = Vec3(0, 0, -9.81);
  Stream random(seed + 5);
  world.bodies.push_back(floor_below(12));

  WorldBody wall = box_hull(Vec3(0.03, 0.9, 0.75), Vec3(1.6, 0, 0.75), 6);
  wall.mass = 0;
  world.bodies.push_back(wall);

  // A long crystal turning end over end at the wall; a stone and a box that meet in front of it.
  WorldBody crystal = coloured(stone(random, 0.16, 26, Vec3(-1.5, 0.42, 0.95)), 0);
  for (Vec3& point : crystal.points) {
    point.x() *= 2.2;
  }
  crystal.linear_velocity = Vec3(32, -1.0, 1.5);
  crystal.angular_velocity = Vec3(3, 14, 4);
  world.bodies.push_back(crystal);

  WorldBody left = box_hull(Vec3(0.15, 0.15, 0.15), Vec3(-1.7, -0.4, 0.55), 1);
  left.orientation = random.orientation();
  left.linear_velocity = Vec3(24, 0, 2);
  left.angular_velocity = Vec3(9, -6, 11);
  world.bodies.push_back(left);

  WorldBody right = stone(random, 0.2, 40, Vec3(1.25, -0.33, 0.6));
  right.linear_velocity = Vec3(-22, 0, 1.5);
  right.angular_velocity = Vec3(-5, 8, 3);
  world.bodies.push_back(right);

  world.view_lower = Vec3(-1.9, -0.75, 0);
  world.view_upper = Vec3(1.75, 0.75, 1.3);
  world.view_azimuth = -102;
  world.view_elevation = 14;
  return world;
}

World rods_at_a_foil(std::uint64_t seed) {
  World world;
  world.name = "foil";
  world.title = "Rods at 25 to 35 m/s against a wall of 1 mm";
  world.steps = 12;
  world.steps_per_second = 60;
  world.restitution = 0.2;
  Stream random(seed + 9);
  world.bodies.push_back(floor_below(12));
  WorldBody wall = box_hull(Vec3(0.0005, 1, 0.8), Vec3(1, 0, 0.8), 6);
  wall.mass = 0;
  world.bodies.push_back(wall);
  for (int i = 0; i < 3; ++i) {
    // Across its way, along it, and turning from one to the other.
    WorldBody rod = box_hull(Vec3(0.02, 0.02, 0.3), Vec3(-1.3 - 0.07 * i, 0.55 * (i - 1), 0.75 + 0.2 * i), i);
    rod.orientation = Eigen::AngleAxisd(0.5 * M_PI * i + 0.1 * random.next(), Vec3::UnitY());
    rod.linear_velocity = Vec3(30, 0, 1) + random.level_vector().cwiseProduct(Vec3(5, 0.3, 0));
    const double spin_z = 2 * random.next();
    rod.angular_velocity = Vec3(2 * random.next(), i == 1 ? 0.5 : 16, spin_z);
    world.bodies.push_back(rod);
  }
  world.view_lower = Vec3(-1.7, -0.9, 0);
  world.view_upper = Vec3(1.6, 0.9, 1.6);
  world.view_azimuth = -102;
  world.view_elevation = 14;
  return world;
}

}  // namespace pd::scenes
