#include "scenes/dropped_worlds.hpp"

#include <array>
#include <cmath>

#include "pd/solid/convex_decomposition.hpp"
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
    const Vec3 aside = 1e-4 * random.level_vector();
    scene.world.bodies.push_back(box(Vec3::Constant(1), Vec3(0, 0, 20 + 2 * i) + aside));
  }
  perturb(scene, perturbation);
  return scene;
}

namespace {

constexpr double kGearError = 0.01;

/// The surface of a spur gear about the z axis with a bore, closed and counter-clockwise from outside.
struct GearSurface {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
};

GearSurface gear_surface(int teeth, double pitch, double half_width) {
  // Four corners a tooth, each with one of the bore beside it: two at the root, two at the tip.
  constexpr double kAngles[] = {-0.32, -0.14, 0.14, 0.32};
  const double root = 0.86 * pitch, tip = 1.14 * pitch, bore = 0.4 * pitch;
  GearSurface gear;
  const int n = 4 * teeth;
  for (const double z : {-half_width, half_width}) {
    for (int i = 0; i < n; ++i) {
      const int k = i % 4;
      const double angle = 2 * M_PI * (i / 4 + kAngles[k]) / teeth;
      const Vec3 out(std::cos(angle), std::sin(angle), 0);
      gear.points.push_back((k == 0 || k == 3 ? root : tip) * out + z * Vec3::UnitZ());
      gear.points.push_back(bore * out + z * Vec3::UnitZ());
    }
  }
  const auto at = [&](int side, int i, int inner) { return 2 * (side * n + i % n) + inner; };
  const auto add_quad = [&](int a, int b, int c, int d) {
    gear.triangles.push_back({a, b, c});
    gear.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    add_quad(at(1, i, 0), at(1, i + 1, 0), at(1, i + 1, 1), at(1, i, 1));  // above
    add_quad(at(0, i, 1), at(0, i + 1, 1), at(0, i + 1, 0), at(0, i, 0));  // below
    add_quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));  // around
    add_quad(at(1, i, 1), at(1, i + 1, 1), at(0, i + 1, 1), at(0, i, 1));  // in the bore
  }
  return gear;
}

/// The gear as a compound of its convex parts, with its surface for pictures.
WorldBody decomposed_gear() {
  const GearSurface gear = gear_surface(10, 0.32, 0.07);
  std::vector<std::int32_t> offsets{0}, corners;
  for (const auto& triangle : gear.triangles) {
    corners.insert(corners.end(), triangle.begin(), triangle.end());
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  const MeshSolid solid = MeshSolid::from_faces({gear.points, offsets, corners}).value();
  const SolidDecomposition found = decompose(solid, {.error = kGearError}).value();
  WorldBody body;
  body.kind = WorldBody::Kind::compound;
  body.points = gear.points;
  body.triangles = gear.triangles;
  body.mass = 700 * found.solid_volume;
  for (const Compound::Part& each : found.parts.parts()) {
    const ConvexPolytope& polytope = *each.shape.polytope();
    WorldBody part;
    part.position = polytope.centre();
    for (int v = 0; v < polytope.num_vertices(); ++v) part.points.push_back(polytope.vertex(v) - part.position);
    body.parts.push_back(std::move(part));
  }
  return body;
}

}  // namespace

World pour_of_gears(std::uint64_t /*seed*/) {
  World world;
  const WorldBody gear = decomposed_gear();
  world.name = "decomposed";
  world.title = "Fifty gears of " + std::to_string(gear.parts.size()) + " convex parts each, certified within 1 cm";
  world.steps = 480;
  world.bodies.push_back(ground_box(20));
  world.bodies[0].drawn = false;
  Stream random(31);
  for (int i = 0; i < 50; ++i) {
    // No two gears overlap at the start: their diameter is 0.73.
    const int place = i % 9;
    WorldBody body = gear;
    body.position =
        Vec3(0.78 * (place % 3 - 1), 0.78 * (place / 3 - 1), 0.5 + 0.78 * (i / 9)) + 0.02 * random.level_vector();
    body.orientation = random.orientation();
    body.colour = i % 3;
    // Every second gear shows its parts.
    if (i % 2 == 1) {
      body.parts_coloured = true;
      body.triangles.clear();
      body.points.clear();
    }
    world.bodies.push_back(std::move(body));
  }
  world.view_lower = Vec3(-1.7, -1.7, 0);
  world.view_upper = Vec3(1.7, 1.7, 3.4);
  return world;
}

}  // namespace pd::scenes
