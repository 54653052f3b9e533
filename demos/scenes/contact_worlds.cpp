#include "scenes/contact_worlds.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/dropped_worlds.hpp"
#include "scenes/union_worlds.hpp"
#include "scenes/world_parts.hpp"

namespace pd::scenes {

namespace {

ContactScene wall(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "wall";
  scene.title = "A wall of 95 bricks";
  scene.seconds = 15;
  scene.quick_seconds = 2;
  scene.size = 0.4;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(10));
  const Vec3 half(0.4, 0.2, 0.2);
  for (int row = 0; row < 10; ++row) {
    const int count = row % 2 == 0 ? 10 : 9;
    for (int i = 0; i < count; ++i) {
      const double x = 2 * half.x() * (i - 0.5 * (count - 1));
      scene.world.bodies.push_back(box(half, Vec3(x, 0, half.z() * (2 * row + 1))));
    }
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene mass_ratio(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "mass-ratio";
  scene.title = "A box a hundred times as heavy on four light ones";
  scene.seconds = 20;
  scene.quick_seconds = 5;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(10));
  for (int i = 0; i < 5; ++i) {
    WorldBody body = box(Vec3::Constant(0.5), Vec3(0, 0, 0.5 + i));
    body.mass = i == 4 ? 100 : 1;
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene spinning_coin(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "coin";
  scene.title = "A coin that spins flat on a floor, without friction";
  scene.goal = ContactGoal::keep;
  scene.seconds = 10;
  scene.quick_seconds = 3;
  scene.quick = true;
  scene.world.friction = 0;
  scene.world.bodies.push_back(ground_box(10));
  WorldBody coin = cylinder(0.5, 0.05, Vec3(0, 0, 0.05));
  coin.angular_velocity = Vec3(0, 0, 10);
  scene.world.bodies.push_back(coin);
  perturb(scene, perturbation);
  return scene;
}

ContactScene bounces(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "bounces";
  scene.title = "Balls, boxes and stones that fall on a floor, restitution 0.8";
  scene.rates = {60, 240, 500};
  scene.goal = ContactGoal::bounce;
  scene.seconds = 10;
  scene.quick_seconds = 3;
  scene.quick = true;
  scene.world.restitution = 0.9;  // Bullet multiplies the two bodies' numbers: .81
  scene.world.bodies.push_back(ground_box(20));
  Stream random(7);
  for (int i = 0; i < 9; ++i) {
    const Vec3 at(4.0 * (i % 3 - 1), 4.0 * (i / 3 - 1), 2 + 0.2 * i);
    WorldBody body = i % 3 == 0   ? sphere(0.5, at)
                     : i % 3 == 1 ? box(Vec3(0.4, 0.5, 0.6), at)
                                  : stone(random, 0.5, 24, at);
    body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene one_place(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "one-place";
  scene.title = "Twenty boxes that start at one place, inside each other";
  scene.goal = ContactGoal::rest;
  scene.seconds = 6;
  scene.quick_seconds = 3;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(40));
  for (int i = 0; i < 20; ++i) {
    scene.world.bodies.push_back(box(Vec3::Constant(0.5), Vec3(0, 0, 0.5)));
  }
  perturb(scene, perturbation);
  return scene;
}

/// A flat rectangular ring of four boxes, long along x.
WorldBody link(const Vec3& at, bool turned) {
  WorldBody ring;
  ring.kind = WorldBody::Kind::compound;
  const double length = 0.3;  // half, outside
  const double width = 0.16;
  const double bar = 0.035;  // half thickness
  for (const double side : {-1.0, 1.0}) {
    ring.parts.push_back(box(Vec3(length, bar, bar), Vec3(0, side * (width - bar), 0)));
    ring.parts.push_back(box(Vec3(bar, width - 2 * bar, bar), Vec3(side * (length - bar), 0, 0)));
  }
  ring.mass = 1;
  ring.position = at;
  if (turned) {
    ring.orientation = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX());
  }
  return ring;
}

ContactScene chains(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "chains";
  scene.title = "Three chains of 24 interlocked rings between fixed rings";
  scene.goal = ContactGoal::rest;
  scene.seconds = 10;
  scene.quick_seconds = 1;
  scene.size = 0.3;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(20));
  const double pitch = 0.44;  // the inner length is .53, two bars are .14: links start .05 loose
  for (int chain = 0; chain < 3; ++chain) {
    for (int i = 0; i < 26; ++i) {
      WorldBody ring = link(Vec3(pitch * (i - 12.5), 1.5 * (chain - 1), 6), i % 2 == 1);
      if (i == 0 || i == 25) {
        ring.mass = 0;
      }
      scene.world.bodies.push_back(ring);
    }
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene compounds(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "compounds";
  scene.title = "Forty L and T compounds fall into a heap";
  scene.goal = ContactGoal::rest;
  scene.seconds = 10;
  scene.quick_seconds = 3;
  scene.size = 0.5;
  scene.world.bodies.push_back(ground_box(20));
  Stream random(11);
  for (int i = 0; i < 40; ++i) {
    WorldBody body;
    body.kind = WorldBody::Kind::compound;
    const bool tee = i % 2 == 1;
    body.parts.push_back(box(Vec3(0.5, 0.12, 0.12), Vec3(0, 0, 0)));
    body.parts.push_back(box(Vec3(0.12, 0.12, 0.3), Vec3(tee ? 0.0 : 0.38, 0, 0.42)));
    body.mass = 20;
    body.position = Vec3(0, 0, 1 + 1.8 * i) + 0.4 * random.level_vector();
    body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene ragdolls(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "ragdolls";
  scene.title = "Ten dolls of six capsules fall onto each other";
  scene.goal = ContactGoal::rest;
  scene.seconds = 10;
  scene.quick_seconds = 3;
  scene.size = 0.3;
  scene.world.bodies.push_back(ground_box(20));
  for (int doll = 0; doll < 10; ++doll) {
    const Vec3 at(0.3 * (doll % 3 - 1), 0.2 * (doll % 2), 1.5 + 1.6 * doll);
    const int trunk = static_cast<int>(scene.world.bodies.size());
    scene.world.bodies.push_back(capsule(0.15, 0.25, at, 30));
    const struct {
      Vec3 centre;
      Vec3 joint;
      double radius;
      double half;
    } limbs[] = {{Vec3(0, 0, 0.56), Vec3(0, 0, 0.42), 0.12, 0.02},
                 {Vec3(0.3, 0, 0), Vec3(0.24, 0, 0.25), 0.06, 0.18},
                 {Vec3(-0.3, 0, 0), Vec3(-0.24, 0, 0.25), 0.06, 0.18},
                 {Vec3(0.12, 0, -0.75), Vec3(0.1, 0, -0.45), 0.08, 0.2},
                 {Vec3(-0.12, 0, -0.75), Vec3(-0.1, 0, -0.45), 0.08, 0.2}};
    for (const auto& limb : limbs) {
      scene.world.joints.push_back({trunk, static_cast<int>(scene.world.bodies.size()), at + limb.joint});
      scene.world.bodies.push_back(capsule(limb.radius, limb.half, at + limb.centre, 5));
    }
  }
  perturb(scene, perturbation);
  return scene;
}

}  // namespace

const std::vector<ContactSceneMaker>& contact_scenes() {
  static const std::vector<ContactSceneMaker> makers{
      {"tower-1m", [](std::uint64_t p) { return tower(20, 0.5, p); }},
      {"tower-10cm", [](std::uint64_t p) { return tower(20, 0.05, p); }},
      {"tower-1cm", [](std::uint64_t p) { return tower(20, 0.005, p); }},
      {"tower-1mm", [](std::uint64_t p) { return tower(20, 0.0005, p); }},
      {"pyramid", [](std::uint64_t p) { return pyramid(20, p); }},
      {"wall", wall},
      {"cards", [](std::uint64_t p) { return card_house(4, p); }},
      {"slope", [](std::uint64_t p) { return slope(0.4, 0.8, false, p); }},
      {"mesh-slope", [](std::uint64_t p) { return slope(0.4, 0.8, true, p); }},
      {"bowl", [](std::uint64_t p) { return pour(300, false, p); }},
      {"heightfield", [](std::uint64_t p) { return pour(300, true, p); }},
      {"bowl-2000", [](std::uint64_t p) { return pour(2000, false, p); }},
      {"chains", chains},
      {"ragdolls", ragdolls},
      {"compounds", compounds},
      {"torus-peg", torus_on_peg},
      {"torus-pour", torus_pour},
      {"bowls-pour", bowl_pour},
      {"gears", gear_pair},
      {"thin-plates", thin_plates},
      {"mass-ratio", mass_ratio},
      {"rolling", rolling_cylinder},
      {"coin", spinning_coin},
      {"slide-compound", [](std::uint64_t p) { return slide(SlideOver::compound, p); }},
      {"slide-mesh", [](std::uint64_t p) { return slide(SlideOver::mesh, p); }},
      {"slide-heightfield", [](std::uint64_t p) { return slide(SlideOver::heightfield, p); }},
      {"slide-t-junctions", [](std::uint64_t p) { return slide(SlideOver::t_junctions, p); }},
      {"slide-decomposition", [](std::uint64_t p) { return slide(SlideOver::decomposition, p); }},
      {"bounces", bounces},
      {"rebound-50", [](std::uint64_t p) { return rebound(0.5, p); }},
      {"rebound-80", [](std::uint64_t p) { return rebound(0.8, p); }},
      {"rebound-100", [](std::uint64_t p) { return rebound(1, p); }},
      {"heavy-slab", heavy_slab},
      {"dropped-column", dropped_column},
      {"one-place", one_place},
  };
  return makers;
}

ContactScene contact_scene(const std::string& name, std::uint64_t perturbation) {
  const auto& all = contact_scenes();
  return std::find_if(all.begin(), all.end(), [&](const auto& m) { return m.name == name; })->make(perturbation);
}

ContactScene tower(int count, double half, std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = half >= 0.5 ? "tower-1m" : half >= 0.05 ? "tower-10cm" : half >= 0.005 ? "tower-1cm" : "tower-1mm";
  scene.title = "A tower of " + std::to_string(count) + " boxes";
  scene.seconds = 60;
  scene.quick_seconds = 5;
  scene.size = 2 * half;
  // g dt^2 below 3 % of a body.
  if (half < 0.002) scene.rates = {960};
  scene.quick = half >= 0.5;
  scene.world.bodies.push_back(ground_box(20 * half));
  for (int i = 0; i < count; ++i) {
    scene.world.bodies.push_back(box(Vec3::Constant(half), Vec3(0, 0, half * (2 * i + 1))));
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene pyramid(int rows, std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "pyramid";
  scene.title = "A pyramid of " + std::to_string(rows * (rows + 1) / 2) + " boxes";
  scene.seconds = 15;
  scene.quick_seconds = 2;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(40));
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < rows - row; ++i) {
      scene.world.bodies.push_back(box(Vec3::Constant(0.5), Vec3(1.05 * (i - 0.5 * (rows - row - 1)), 0, 0.5 + row)));
    }
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene card_house(int pairs, std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "cards";
  scene.title = "A house of cards";
  scene.seconds = 10;
  scene.quick_seconds = 3;
  scene.size = 0.88;
  scene.quick = true;
  scene.world.friction = 0.9;
  scene.world.bodies.push_back(ground_box(10));
  const Vec3 half(0.006, 0.32, 0.44);
  // Leaning by 30 degrees, the feet of neighbouring pairs and the ends of lying cards just do not meet.
  const double angle = M_PI / 6;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double reach = half.x() * c + half.z() * s;   // of a leaning card to each side
  const double height = half.z() * c + half.x() * s;  // half of it
  const double pitch = 4 * reach + 0.002;
  double floor = 0;
  for (int level = 0; level < pairs; ++level) {
    const int count = pairs - level;
    for (int i = 0; i < count; ++i) {
      const double x = pitch * (i - 0.5 * (count - 1));
      for (const double side : {-1.0, 1.0}) {
        WorldBody card = box(half, Vec3(x + side * reach, 0, floor + height));
        card.mass = 0.2;
        card.orientation = Eigen::AngleAxisd(-side * angle, Vec3::UnitY());
        scene.world.bodies.push_back(card);
      }
    }
    for (int i = 0; i + 1 < count; ++i) {
      WorldBody card = box(half, Vec3(pitch * (i - 0.5 * (count - 2)), 0, floor + 2 * height + half.x()));
      card.mass = 0.2;
      card.orientation = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitY());
      scene.world.bodies.push_back(card);
    }
    floor += 2 * height + 2 * half.x();
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene slope(double radians, double friction, bool mesh, std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = mesh ? "mesh-slope" : "slope";
  scene.title = "A box on a slope of " + std::to_string(radians).substr(0, 4) + " rad, held by friction";
  scene.seconds = 600;
  scene.quick_seconds = 60;
  scene.quick = true;
  scene.world.friction = friction;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(radians, Vec3::UnitY()));  // down along +x
  WorldBody ground = mesh ? flat_mesh(20, 2, false) : ground_box(20);
  ground.orientation = turn;
  ground.position = turn * ground.position;
  scene.world.bodies.push_back(ground);
  WorldBody body = box(Vec3::Constant(0.5), turn * Vec3(-5, 0.3, 0.5));
  body.orientation = turn;
  scene.world.bodies.push_back(body);
  perturb(scene, perturbation);
  return scene;
}

ContactScene rolling_cylinder(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "rolling";
  scene.title = "A wheel that rolls at 3 m/s";
  scene.goal = ContactGoal::keep;
  scene.seconds = 10;
  scene.quick_seconds = 5;
  scene.wanted_speed = 3;
  scene.quick = true;
  scene.world.bodies.push_back(ground_box(60));
  WorldBody wheel = cylinder(0.5, 0.4, Vec3(-20, 0, 0.5));
  wheel.orientation = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX());
  wheel.linear_velocity = Vec3(3, 0, 0);
  wheel.angular_velocity = Vec3(0, 6, 0);
  scene.world.bodies.push_back(wheel);
  perturb(scene, perturbation);
  return scene;
}

namespace {

WorldBody flush_boxes() {
  WorldBody floor;
  floor.kind = WorldBody::Kind::compound;
  for (int i = -12; i <= 12; ++i) {
    floor.parts.push_back(box(Vec3(0.5, 2, 0.5), Vec3(i, 0, -0.5)));
  }
  return floor;
}

/// Rows along x of cells of different lengths.
WorldBody floor_of_t_junctions() {
  WorldBody floor;
  floor.kind = WorldBody::Kind::mesh;
  const int cells[] = {17, 40, 23, 31};
  for (int row = 0; row < 4; ++row) {
    for (int i = 0; i <= cells[row]; ++i) {
      const int corner = static_cast<int>(floor.points.size());
      const double x = 24.0 * i / cells[row] - 12;
      floor.points.emplace_back(x, row - 2, 0);
      floor.points.emplace_back(x, row - 1, 0);
      if (i < cells[row]) {
        floor.triangles.push_back({corner, corner + 2, corner + 3});
        floor.triangles.push_back({corner, corner + 3, corner + 1});
      }
    }
  }
  return floor;
}

WorldBody oblique_slab() {
  WorldBody floor;
  floor.kind = WorldBody::Kind::compound;
  const auto seam = [](int i, double y) { return i - 12.5 + 0.15 * y * (i % 2 == 0 ? 1 : -1); };
  for (int i = 0; i < 25; ++i) {
    WorldBody part;
    const double off = 0.5e-7 * ((i * 7) % 5 - 2);
    part.position = Vec3(i - 12, 0, -0.5);
    for (const double z : {-0.5, 0.5 + off}) {
      for (const double y : {-2.0, 2.0}) {
        part.points.emplace_back(seam(i, y) - off - part.position.x(), y, z);
        part.points.emplace_back(seam(i + 1, y) + off - part.position.x(), y, z);
      }
    }
    floor.parts.push_back(part);
  }
  return floor;
}

}  // namespace

ContactScene slide(SlideOver ground, std::uint64_t perturbation) {
  static constexpr struct {
    const char* name;
    const char* over;
  } kGrounds[] = {{"slide-compound", "flush boxes of a compound"},
                  {"slide-mesh", "a flat mesh"},
                  {"slide-heightfield", "a flat heightfield"},
                  {"slide-t-junctions", "a flat mesh with corners inside edges"},
                  {"slide-decomposition", "hulls with oblique seams"}};
  ContactScene scene;
  scene.name = kGrounds[static_cast<int>(ground)].name;
  scene.title = std::string("A box slides over ") + kGrounds[static_cast<int>(ground)].over;
  scene.goal = ContactGoal::keep;
  scene.seconds = 6;
  scene.quick_seconds = 3;
  scene.wanted_speed = 3;
  scene.quick = true;
  scene.world.friction = 0;
  WorldBody floor = ground == SlideOver::compound        ? flush_boxes()
                    : ground == SlideOver::t_junctions   ? floor_of_t_junctions()
                    : ground == SlideOver::decomposition ? oblique_slab()
                                                         : flat_mesh(12, 24, ground == SlideOver::heightfield);
  floor.mass = 0;
  scene.world.bodies.push_back(floor);
  WorldBody body = box(Vec3::Constant(0.4), Vec3(-9, 0.13, 0.4));
  body.linear_velocity = Vec3(3, 0, 0);
  scene.world.bodies.push_back(body);
  perturb(scene, perturbation);
  return scene;
}

ContactScene pour(int count, bool heightfield, std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = heightfield ? "heightfield" : count > 300 ? "bowl-2000" : "bowl";
  scene.title =
      std::to_string(count) + (heightfield ? " bodies poured onto a heightfield" : " bodies poured into a bowl");
  scene.goal = ContactGoal::rest;
  scene.seconds = count > 300 ? 20 : 12;
  scene.quick_seconds = 3;
  scene.size = 0.5;
  const double extent = 6 * std::cbrt(count / 300.0);
  // A paraboloid, steep enough at the rim to keep what falls in; the heightfield has a wave on it.
  const auto height = [&](double x, double y) {
    return 0.13 / (extent / 6) * (x * x + y * y) + (heightfield ? 0.25 * std::sin(2 * x) * std::cos(2 * y) : 0);
  };
  scene.world.bodies.push_back(graph_mesh(extent, 32, height, heightfield));
  Stream random(23);
  for (int i = 0; i < count; ++i) {
    const int place = i % 16;
    const Vec3 at =
        Vec3(0.95 * (place % 4 - 1.5), 0.95 * (place / 4 - 1.5), 3 + 0.9 * (i / 16)) + 0.05 * random.level_vector();
    WorldBody body = i % 5 == 0   ? box(Vec3(0.25, 0.3, 0.2), at)
                     : i % 5 == 1 ? cylinder(0.25, 0.25, at)
                     : i % 5 == 2 ? capsule(0.16, 0.2, at, 60)
                                  : stone(random, 0.28, i % 5 == 3 ? 16 : 32, at);
    body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

}  // namespace pd::scenes
