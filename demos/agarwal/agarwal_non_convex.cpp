/// @file
/// A block in a channel: the depth of the union of the channel's parts beside that of its convex hull.
#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "agarwal/agarwal_pictures.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/render/composition.hpp"
#include "scenes/non_convex.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr render::ViewAngle kAngle{.azimuth_degrees = -68, .elevation_degrees = 26};
constexpr render::Insets kInsets{.left = 0.08, .right = 0.08, .top = 0.08, .bottom = 0.08};

/// Of the same answer's type for unions and for convex bodies.
Expected<render::Image> draw(render::Scene scene, const PenetrationDepth& answer, render::Renderer& renderer,
                             render::Size size) {
  const render::Box box = render::bounds(scene);
  scene.arrows.push_back(
      {.from = answer.witness_a, .to = answer.witness_b, .label = fmt::format("{:.4g}\nexact", answer.depth)});
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;
  scene.focus = box;
  return renderer.draw(scene, render::frame_box(box, size, kAngle, kInsets), size);
}

}  // namespace

Expected<render::Image> non_convex_picture(render::Renderer& renderer, render::Size size) {
  // The channel opens upwards; the block has sunk into one of its walls.
  const ConvexShape block = ConvexPolytope::from_points(scenes::box({0.5, 0.8, 0.7})).value();
  const Pose pose_a =
      Pose::from_quaternion({0.98, 0.1, 0.14, std::sqrt(1 - 0.98 * 0.98 - 0.1 * 0.1 - 0.14 * 0.14)}, {0.32, 0.1, 0.45})
          .value();
  std::vector<Compound::Part> parts;
  scenes::Points all;
  for (const scenes::PointPart& part : scenes::letter_u(1.5)) {
    parts.push_back({ConvexPolytope::from_points(part.points).value(), part.pose});
    for (const Vec3& p : part.points) all.push_back(part.pose.apply(p));
  }
  const auto channel = Compound::from_parts(parts);
  if (!channel) return channel.error();
  const ConvexShape hull = ConvexPolytope::from_points(all).value();
  const Compound block_body(block);
  Mat3 upright;  // the letter opens towards y
  upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const Pose pose_b = Pose::from_matrix(upright, Vec3::Zero()).value();
  Scratch scratch;
  const auto answer = penetration_depth({&block_body, pose_a}, {&*channel, pose_b}, scratch);
  if (!answer) return answer.error();
  const PenetrationDepth of_hull = penetration_depth({&block, pose_a}, {&hull, pose_b}, scratch);

  render::Scene left, right;
  for (render::Scene* scene : {&left, &right}) {
    scene->bodies.push_back(
        {.mesh = render::shape_mesh(block), .pose = pose_a, .colour = palette::kBodyA, .opacity = 0.8f});
  }
  const auto placed = channel->posed(pose_b);
  if (!placed) return placed.error();
  for (const PosedShape& part : *placed) {
    left.bodies.push_back(
        {.mesh = render::shape_mesh(*part.shape), .pose = part.pose, .colour = palette::kBodyB, .opacity = 0.6f});
  }
  right.bodies.push_back(
      {.mesh = render::shape_mesh(hull), .pose = pose_b, .colour = palette::kBodyB, .opacity = 0.5f});
  const render::Size panel = render::panel_size(size, 2);
  auto drawn_left = draw(std::move(left), *answer, renderer, panel);
  if (!drawn_left) return drawn_left.error();
  auto drawn_right = draw(std::move(right), of_hull, renderer, panel);
  if (!drawn_right) return drawn_right.error();
  std::vector<render::Panel> panels;
  panels.push_back(
      {std::move(drawn_left).value(), fmt::format("The channel as a union of {} parts", channel->parts().size())});
  panels.push_back({std::move(drawn_right).value(), "Its convex hull"});
  return render::side_by_side(
      panels, fmt::format("A block in a channel: {:.3g} deep, not {:.3g}", answer->depth, of_hull.depth),
      "The depth of a non-convex body is that of the union of its parts: the hull fills what is free", size);
}

}  // namespace pd::demo
