#include "pd/render/scene.hpp"

namespace pd::render {

Box bounds(const Scene& scene) {
  Box box;
  for (const Body& body : scene.bodies) {
    box.include(posed_bounds(*body.mesh, body.pose));
  }
  for (const Solid& solid : scene.solids) {
    box.include(posed_bounds(*solid.mesh, solid.pose));
  }
  for (const Ball& ball : scene.balls) {
    box.include(ball.centre + Vec3::Constant(ball.radius));
    box.include(ball.centre - Vec3::Constant(ball.radius));
  }
  for (const Arrow& arrow : scene.arrows) {
    box.include(arrow.from);
    box.include(arrow.to);
  }
  for (const ContactDisc& disc : scene.discs) {
    box.include(disc.point);
  }
  for (const Polyline& line : scene.lines) {
    for (const Vec3& point : line.points) {
      box.include(point);
    }
  }
  for (const Label& label : scene.labels) {
    box.include(label.at);
  }
  return box;
}

}  // namespace pd::render
