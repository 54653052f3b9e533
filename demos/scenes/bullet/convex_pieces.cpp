#include "scenes/bullet/convex_pieces.hpp"

#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "scenes/bullet/bullet_scene.hpp"

namespace pd::scenes {

namespace {

Pose pose_of(const WorldBody& body) {
  return Pose::from_trusted_matrix(body.orientation.toRotationMatrix(), body.position);
}

ConvexPiece piece_of(int body, ConvexShape shape, const Pose& local) {
  Vec3 lower = Vec3::Constant(1e30);
  Vec3 upper = -lower;
  if (const ConvexPolytope* polytope = shape.polytope()) {
    for (int i = 0; i < polytope->num_vertices(); ++i) {
      lower = lower.cwiseMin(polytope->vertex(i));
      upper = upper.cwiseMax(polytope->vertex(i));
    }
  } else {
    lower = upper = Vec3::Zero();
  }
  const Vec3 middle = 0.5 * (lower + upper);
  const double radius =
      shape.polytope() != nullptr ? 0.5 * (upper - lower).norm() + shape.margin() : bounding_radius(shape);
  return {body, std::make_shared<const ConvexShape>(std::move(shape)), local, local.apply(middle), radius};
}

void collect(int index, const WorldBody& body, const Pose& local, std::vector<ConvexPiece>& pieces) {
  if (body.kind == WorldBody::Kind::compound) {
    for (const WorldBody& part : body.parts) {
      collect(index, part, pose_of(part), pieces);
    }
  } else if (!body.triangles.empty()) {
    for (const auto& triangle : body.triangles) {
      std::vector<Vec3> points;
      for (const int corner : triangle) {
        points.push_back(body.points[corner]);
        points.emplace_back(body.points[corner] - Vec3::UnitZ());
      }
      pieces.push_back(piece_of(index, ConvexShape(*ConvexPolytope::from_points(points)), local));
    }
  } else {
    pieces.push_back(piece_of(index, *to_convex_shape(*convex_bullet_shape(body, false, 0)), local));
  }
}

bool jointed(const World& world, int a, int b) {
  return std::any_of(world.joints.begin(), world.joints.end(), [&](const WorldJoint& joint) {
    return (joint.body_a == a && joint.body_b == b) || (joint.body_a == b && joint.body_b == a);
  });
}

}  // namespace

std::vector<ConvexPiece> convex_pieces(const World& world) {
  std::vector<ConvexPiece> pieces;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    collect(static_cast<int>(i), world.bodies[i], Pose(), pieces);
  }
  return pieces;
}

void for_each_near_pair(BulletScene& scene, const std::vector<ConvexPiece>& pieces,
                        const std::function<void(const PosedPiece& a, const PosedPiece& b)>& visit) {
  std::vector<Pose> poses;
  std::vector<Vec3> centres;
  for (const ConvexPiece& piece : pieces) {
    const Pose body = to_pd(scene.body(piece.body).getWorldTransform());
    poses.push_back(piece.posed(body));
    centres.push_back(body.apply(piece.centre));
  }
  const auto is_fixed = [&](std::size_t i) { return scene.plan(pieces[i].body).mass == 0; };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (is_fixed(i)) continue;
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      const double reach = pieces[i].radius + pieces[j].radius;
      if (pieces[i].body == pieces[j].body || (j < i && !is_fixed(j)) ||
          (centres[i] - centres[j]).squaredNorm() > reach * reach ||
          jointed(scene.plan(), pieces[i].body, pieces[j].body)) {
        continue;
      }
      const std::size_t first = std::min(i, j);
      const std::size_t second = std::max(i, j);
      visit({pieces[first], poses[first]}, {pieces[second], poses[second]});
    }
  }
}

}  // namespace pd::scenes
