#include "scenes/union_worlds.hpp"

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
    WorldBody body = torus(
        12, 0.3, 0.1,
        Vec3(place % 2 - 0.5 + 0.05 * random.next(), place / 2 - 0.5 + 0.05 * random.next(), 0.9 + 0.95 * (i / 4)));
    body.orientation = random.orientation();
    scene.world.bodies.push_back(body);
  }
  perturb(scene, perturbation);
  return scene;
}

}  // namespace pd::scenes
