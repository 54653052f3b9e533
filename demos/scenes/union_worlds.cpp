#include "scenes/union_worlds.hpp"

#include <algorithm>
#include <cmath>

#include "scenes/world_parts.hpp"

namespace pd::scenes {

WorldBody torus(int pieces, double ring, double tube, const Vec3& at) {
  constexpr int kCorners = 8;
  WorldBody body;
  body.kind = WorldBody::Kind::compound;
  const auto corner = [&](int piece, int k) {
    const double around = 2 * M_PI * (piece % pieces) / pieces, across = 2 * M_PI * (k + 0.5) / kCorners;
    const double radius = ring + tube * std::cos(across);
    return Vec3(radius * std::cos(around), radius * std::sin(around), tube * std::sin(across));
  };
  for (int piece = 0; piece < pieces; ++piece) {
    WorldBody part;
    for (int k = 0; k < kCorners; ++k) {
      for (const int end : {piece, piece + 1}) {
        part.position += corner(end, k) / (2 * kCorners);
        part.points.push_back(corner(end, k));
      }
    }
    for (Vec3& point : part.points) point -= part.position;
    body.parts.push_back(part);
  }
  body.mass = 700 * 2 * M_PI * ring * M_PI * tube * tube;
  body.position = at;
  return body;
}

ContactScene torus_on_peg(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "torus-peg";
  scene.title = "A torus in sixteen pieces slides down a peg";
  scene.goal = ContactGoal::rest;
  scene.seconds = 6;
  scene.quick_seconds = 3;
  scene.size = 1;
  scene.world.friction = 0.2;
  scene.world.bodies.push_back(ground_box(10));
  WorldBody peg = cylinder(0.28, 2, Vec3(0, 0, 2));
  peg.mass = 0;
  scene.world.bodies.push_back(peg);
  WorldBody body = torus(16, 0.5, 0.15, Vec3(0.02, 0, 3.5));
  body.orientation = Eigen::AngleAxisd(0.1, Vec3::UnitY());
  scene.world.bodies.push_back(body);
  perturb(scene, perturbation);
  return scene;
}

ContactScene torus_pour(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "torus-pour";
  scene.title = "Fifty tori in twelve pieces each fall into a heap";
  scene.goal = ContactGoal::rest;
  scene.seconds = 8;
  scene.quick_seconds = 3;
  scene.size = 0.8;
  scene.world.bodies.push_back(ground_box(20));
  Stream random(31);
  for (int i = 0; i < 50; ++i) {
    const int place = i % 4;
    WorldBody body = torus(12, 0.3, 0.1,
                           Vec3(place % 2 - 0.5, place / 2 - 0.5, 0.9 + 0.95 * (i / 4)) + 0.05 * random.level_vector());
    body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

WorldBody open_bowl(int pieces, double radius, const Vec3& at) {
  // Of the wall, from the bottom's edge to the rim: radius and height outside, and inside.
  constexpr double kWall[3][4] = {{0.5, 0, 0.5, 0.1}, {0.85, 0.25, 0.75, 0.3}, {1, 0.65, 0.9, 0.65}};
  const auto corner = [&](int piece, double r, double z) {
    const double around = 2 * M_PI * (piece % pieces) / pieces;
    return Vec3(radius * r * std::cos(around), radius * r * std::sin(around), radius * z);
  };
  WorldBody body;
  body.kind = WorldBody::Kind::compound;
  const auto add = [&](std::vector<Vec3> points) {
    WorldBody part;
    for (const Vec3& point : points) part.position += point / static_cast<double>(points.size());
    for (Vec3& point : points) point -= part.position;
    part.points = std::move(points);
    body.parts.push_back(std::move(part));
  };
  std::vector<Vec3> disc;
  for (int piece = 0; piece < pieces; ++piece) {
    for (const double z : {0.0, 0.1}) disc.push_back(corner(piece, 0.5, z));
  }
  add(std::move(disc));
  for (int ring = 0; ring < 2; ++ring) {
    for (int piece = 0; piece < pieces; ++piece) {
      std::vector<Vec3> wedge;
      for (const int end : {piece, piece + 1}) {
        for (const auto& level : {kWall[ring], kWall[ring + 1]}) {
          wedge.push_back(corner(end, level[0], level[1]));
          wedge.push_back(corner(end, level[2], level[3]));
        }
      }
      add(std::move(wedge));
    }
  }
  body.mass = 700 * 2 * M_PI * radius * radius * 0.09 * radius;
  body.position = at;
  return body;
}

ContactScene bowl_pour(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "bowls-pour";
  scene.title = "Twenty bowls in 25 pieces each fall into a heap";
  scene.goal = ContactGoal::rest;
  scene.seconds = 8;
  scene.quick_seconds = 3;
  scene.size = 1;
  scene.world.bodies.push_back(ground_box(20));
  Stream random(37);
  for (int i = 0; i < 20; ++i) {
    const int place = i % 4;
    WorldBody body = open_bowl(
        12, 0.5, Vec3(1.2 * (place % 2) - 0.6 + 0.05 * random.next(), 1.2 * (place / 2) - 0.6, 0.8 + 0.9 * (i / 4)));
    // Every other one falls upright.
    if (i % 2 == 0) body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

ContactScene gear_pair(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "gears";
  scene.title = "A gear that was spun turns another";
  scene.goal = ContactGoal::bounce;
  scene.seconds = 4;
  scene.quick_seconds = 2;
  scene.size = 1;
  scene.world = two_gears(0);
  perturb(scene, perturbation);
  return scene;
}

WorldBody gear(int teeth, double pitch, double half_width, const Vec3& at) {
  const double root = pitch - 0.075;
  const double tip = pitch + 0.06;
  WorldBody body;
  body.kind = WorldBody::Kind::compound;
  const auto at_angle = [&](double radius, double angle, double y) {
    return Vec3(radius * std::cos(angle), y, radius * std::sin(angle));
  };
  WorldBody hub;
  for (int i = 0; i < 2 * teeth; ++i) {
    for (const double y : {-half_width, half_width}) {
      hub.points.push_back(at_angle(root / std::cos(M_PI / (2 * teeth)), M_PI * (i + 0.5) / teeth, y));
    }
  }
  body.parts.push_back(hub);
  for (int i = 0; i < teeth; ++i) {
    const double middle = 2 * M_PI * i / teeth;
    WorldBody tooth;
    tooth.position = at_angle(0.5 * (root + tip), middle, 0);
    for (const double y : {-half_width, half_width}) {
      for (const double side : {-1.0, 1.0}) {
        // Two thirds of the pitch wide in the hub, a third at the tip.
        tooth.points.push_back(at_angle(root - 0.02, middle + side * 0.32 * 2 * M_PI / teeth, y) - tooth.position);
        tooth.points.push_back(at_angle(tip, middle + side * 0.14 * 2 * M_PI / teeth, y) - tooth.position);
      }
    }
    body.parts.push_back(tooth);
  }
  body.mass = 700 * M_PI * pitch * pitch * 2 * half_width;
  body.position = at;
  return body;
}

World slide_over_mesh(std::uint64_t /*seed*/) {
  World world = slide(SlideOver::mesh, 0).world;
  world.name = "slide";
  world.title = "A box slides over a flat mesh without friction, 3 m/s";
  world.steps = 180;
  world.steps_per_second = 60;
  world.should_glide = true;
  world.studio_floor = -0.05;
  world.bodies[0].colour = 6;
  // A lane is enough to look at.
  std::erase_if(world.bodies[0].triangles, [&](const std::array<int, 3>& triangle) {
    return std::any_of(triangle.begin(), triangle.end(), [&](int corner) {
      const Vec3& point = world.bodies[0].points[static_cast<std::size_t>(corner)];
      return std::abs(point.y()) > 2.5 || point.x() > 4.5;
    });
  });
  world.view_lower = Vec3(-9.4, -1.2, 0);
  world.view_upper = Vec3(0.6, 1.2, 1);
  world.view_azimuth = -80;
  world.view_elevation = 22;
  return world;
}

World two_gears(std::uint64_t /*seed*/) {
  constexpr double kPitch[] = {0.5, 0.75};
  constexpr int kTeeth[] = {12, 18};
  World world;
  world.name = "gears";
  world.title = "The large gear was spun at 6 rad/s and turns the small one";
  world.friction = 0.1;
  world.steps = 480;
  world.bodies.push_back(ground_box(6));
  world.bodies[0].drawn = false;
  double x = -0.6;
  for (int i = 0; i < 2; ++i) {
    const Vec3 at(x, 0, 1);
    WorldBody axle = box(Vec3(0.05, 0.3, 0.05), at);
    axle.mass = 0;
    axle.colour = 6;
    WorldBody wheel = gear(kTeeth[i], kPitch[i], 0.12, at);
    wheel.colour = i;
    // A tooth of the first looks along x; the second has a gap there.
    if (i == 1) {
      wheel.angular_velocity = Vec3(0, 6, 0);
      wheel.orientation = Eigen::AngleAxisd(M_PI / kTeeth[1], Vec3::UnitY());
    }
    const int first = static_cast<int>(world.bodies.size());
    world.bodies.push_back(axle);
    world.bodies.push_back(wheel);
    for (const double y : {-0.3, 0.3}) world.joints.push_back({first, first + 1, at + Vec3(0, y, 0)});
    x += kPitch[0] + kPitch[1] + 0.015;
  }
  world.view_lower = Vec3(-1.3, -0.3, 0);
  world.view_upper = Vec3(1.6, 0.3, 1.9);
  world.view_azimuth = -80;
  world.view_elevation = 12;
  return world;
}

World torus_and_peg(std::uint64_t /*seed*/) {
  World world = torus_on_peg(0).world;
  world.name = "peg";
  world.title = "A torus of sixteen convex pieces slides down a peg";
  world.steps = 240;
  world.steps_per_second = 60;
  world.bodies[0].drawn = false;
  world.bodies[1].colour = 6;
  world.view_lower = Vec3(-1.1, -0.9, 0);
  world.view_upper = Vec3(1.1, 0.9, 4.2);
  return world;
}

ContactScene thin_plates(std::uint64_t perturbation) {
  ContactScene scene;
  scene.name = "thin-plates";
  scene.title = "Plates of 2 x 2 x 0.03 m that fall onto a mesh";
  scene.goal = ContactGoal::rest;
  scene.seconds = 4;
  scene.quick_seconds = 2;
  scene.size = 1;
  scene.world.bodies.push_back(flat_mesh(20, 80, false));
  Stream random(11);
  for (int i = 0; i < 16; ++i) {
    WorldBody plate = box(Vec3(1, 1, 0.015), Vec3(8.0 * (i % 4 - 1.5), 8.0 * (i / 4 - 1.5), 0));
    plate.kind = WorldBody::Kind::hull;
    plate.points = box_points(plate.half_extents);
    plate.orientation = random.orientation();
    double lowest = 0;
    for (const Vec3& corner : plate.points) lowest = std::min(lowest, (plate.orientation * corner).z());
    plate.position.z() = 0.05 - lowest;
    scene.world.bodies.push_back(plate);
  }
  perturb(scene, perturbation);
  return scene;
}

}  // namespace pd::scenes
