#include "contact/supporting_face.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "contact/sphere_hull_face.hpp"

namespace pd::detail {

namespace {

/// cos 60 degrees: lifting a projected point to a steeper face would magnify rounding and tell little about the
/// contact.
constexpr double kFaceCosine = 0.5;
/// sin 17 degrees.
constexpr double kEdgeSine = 0.3;

int support_vertex(const ConvexPolytope& polytope, const Vec3& direction) {
  int best = 0;
  double best_value = polytope.vertex(0).dot(direction);
  for (int v = 1; v < polytope.num_vertices(); ++v) {
    const double value = polytope.vertex(v).dot(direction);
    if (value > best_value) {
      best_value = value;
      best = v;
    }
  }
  return best;
}

/// The best-facing facet among those seen so far; the lowest index among equals.
struct FacetChoice {
  int facet = -1;
  double cosine = -2;
  void offer(const ConvexPolytope& polytope, int candidate, const Vec3& direction) {
    if (candidate < 0) {
      return;
    }
    const double value = polytope.facet_normal(candidate).dot(direction);
    if (value > cosine || (value == cosine && candidate < facet)) {
      cosine = value;
      facet = candidate;
    }
  }
};

void offer_facets_at(const ConvexPolytope& polytope, int vertex, const Vec3& direction, FacetChoice& choice) {
  const int degree = static_cast<int>(polytope.neighbours(vertex).size());
  for (int k = 0; k < degree; ++k) {
    choice.offer(polytope, polytope.half_edge(polytope.first_half_edge(vertex) + k).facet, direction);
  }
}

/// The neighbour along the edge at `vertex` that is most nearly across `direction`, or -1.
int flattest_edge(const ConvexPolytope& polytope, int vertex, const Vec3& direction) {
  int best = -1;
  double best_sine = kEdgeSine;
  for (const std::int32_t neighbour : polytope.neighbours(vertex)) {
    const Vec3 edge = polytope.vertex(neighbour) - polytope.vertex(vertex);
    const double sine = std::abs(edge.dot(direction)) / edge.norm();
    if (sine < best_sine) {
      best_sine = sine;
      best = neighbour;
    }
  }
  return best;
}

/// Tells whether the feature's numbers are those of a face of this polytope.
bool has_feature(const ConvexPolytope& polytope, const Feature& feature) {
  const auto counts = [](std::int32_t number, int count) { return number >= 0 && number < count; };
  switch (feature.kind) {
    case Feature::Kind::facet:
      return counts(feature.first, polytope.num_facets());
    case Feature::Kind::edge:
      return counts(feature.first, polytope.num_vertices()) && counts(feature.second, polytope.num_vertices());
    case Feature::Kind::vertex:
      return counts(feature.first, polytope.num_vertices());
    case Feature::Kind::none:
      break;
  }
  return false;
}

void polytope_face(const ConvexPolytope& polytope, const Pose& pose, const Vec3& local_direction,
                   const Feature& feature, SupportingFace& face) {
  const auto push = [&](int v) { face.vertices.push_back({pose.apply(polytope.vertex(v)), v}); };
  FacetChoice choice;
  int vertex = -1;
  int edge_end = -1;
  // An answer for contacts leaves open what is nearer than its tolerance: its facet may be one beside the normal.
  const bool beside =
      !has_feature(polytope, feature) || (feature.kind == Feature::Kind::facet &&
                                          !(polytope.facet_normal(feature.first).dot(local_direction) >= kFaceCosine));
  const Feature::Kind kind = beside ? Feature::Kind::none : feature.kind;
  switch (kind) {
    case Feature::Kind::facet:
      choice.facet = feature.first;
      choice.cosine = 1;
      break;
    case Feature::Kind::edge:
      vertex = feature.first;
      edge_end = feature.second;
      offer_facets_at(polytope, vertex, local_direction, choice);
      offer_facets_at(polytope, edge_end, local_direction, choice);
      break;
    case Feature::Kind::vertex:
    case Feature::Kind::none:
      vertex = kind == Feature::Kind::vertex ? feature.first : support_vertex(polytope, local_direction);
      offer_facets_at(polytope, vertex, local_direction, choice);
      break;
  }
  if (choice.facet >= 0 && choice.cosine >= kFaceCosine) {
    const auto loop = polytope.facet_vertices(choice.facet);
    face.vertices.resize(loop.size());
    const Pose placed = pose;  // a copy, which writing vertices cannot change
    for (std::size_t i = 0; i < loop.size(); ++i) {
      face.vertices[i] = {placed.apply(polytope.vertex(loop[i])), loop[i]};
    }
    face.plane_normal = (pose.rotation() * polytope.facet_normal(choice.facet)).normalized();
    return;
  }
  if (edge_end < 0) {
    edge_end = flattest_edge(polytope, vertex, local_direction);
  }
  push(vertex);
  if (edge_end >= 0) {
    push(edge_end);
  }
}

/// A unit vector across the axis: the radial part of `direction`, or any where it has none.
Vec3 radial_direction(const Vec3& direction, int axis) {
  Vec3 radial = direction;
  radial[axis] = 0;
  const double length = radial.norm();
  if (length > 0) {
    return radial / length;
  }
  return Vec3::Unit((axis + 1) % 3);
}

/// The cosines of sixteenths of a turn. A table: libraries differ in the last bit of std::cos.
constexpr std::array<double, kRimPoints> kRimCosines = [] {
  constexpr double kQuarter[] = {1, 0.9238795325112867, 0.7071067811865476, 0.38268343236508977, 0};
  static_assert(kRimPoints == 16);
  std::array<double, kRimPoints> cosines{};
  for (int i = 0; i < kRimPoints; ++i) {
    const int folded = i <= 8 ? i : 16 - i;
    cosines[static_cast<std::size_t>(i)] = folded <= 4 ? kQuarter[folded] : -kQuarter[8 - folded];
  }
  return cosines;
}();

void push_disc(double radius, double height, int axis, const Pose& pose, const Mat3& rotation, SupportingFace& face) {
  constexpr std::size_t kQuarterTurn = kRimPoints / 4;
  face.vertices.resize(kRimPoints);
  Vec3 local;
  local[axis] = height;
  for (std::size_t i = 0; i < kRimPoints; ++i) {
    local[(axis + 1) % 3] = radius * kRimCosines[i];
    local[(axis + 2) % 3] = radius * kRimCosines[(i + 3 * kQuarterTurn) % kRimPoints];
    face.vertices[i] = {rotation * local + pose.translation(), static_cast<std::int32_t>(i)};
  }
  face.plane_normal = rotation * ((height < 0 ? -1.0 : 1.0) * Vec3::Unit(axis));
  face.rim = true;
}

void cylinder_face(const Cylinder& cylinder, const Pose& pose, const Vec3& direction, const Mat3& rotation,
                   SupportingFace& face) {
  const Vec3 axis = Vec3::Unit(cylinder.axis);
  const double along = direction[cylinder.axis];
  if (std::abs(along) >= std::sqrt(0.5)) {
    push_disc(cylinder.radius, along < 0 ? -cylinder.half_height : cylinder.half_height, cylinder.axis, pose, rotation,
              face);
    return;
  }
  const Vec3 side = cylinder.radius * radial_direction(direction, cylinder.axis);
  face.vertices.push_back({rotation * (side - cylinder.half_height * axis) + pose.translation(), kRimPoints});
  face.vertices.push_back({rotation * (side + cylinder.half_height * axis) + pose.translation(), kRimPoints + 1});
}

void cone_face(const Cone& cone, const Pose& pose, const Vec3& direction, const Mat3& rotation, SupportingFace& face) {
  const double along = direction[cone.axis];
  if (along <= -std::sqrt(0.5)) {
    push_disc(cone.radius, -cone.half_height, cone.axis, pose, rotation, face);
    return;
  }
  const Vec3 apex = cone.half_height * Vec3::Unit(cone.axis);
  const Vec3 rim = cone.radius * radial_direction(direction, cone.axis) - apex;
  face.vertices.push_back({rotation * apex + pose.translation(), kRimPoints + 2});
  if (std::abs((rim - apex).dot(direction)) < kEdgeSine * (rim - apex).norm()) {
    face.vertices.push_back({rotation * rim + pose.translation(), kRimPoints + 3});
  } else if ((rim - apex).dot(direction) > 0) {
    face.vertices[0] = {rotation * rim + pose.translation(), kRimPoints + 3};
  }
}

}  // namespace

void supporting_face(const PosedShape& shape, const Vec3& direction, const Feature& feature, SupportingFace& face) {
  face.vertices.clear();
  face.rim = false;
  if (const ConvexPolytope* polytope = shape.shape->polytope()) {
    // R^T d maximises <R x, d> over local x, whether or not R is exactly orthogonal.
    polytope_face(*polytope, shape.pose, shape.pose.rotation().transpose() * direction, feature, face);
    return;
  }
  const Mat3 rotation = shape.pose.nearest_rotation();
  const Vec3 local = rotation.transpose() * direction;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.shape->core())) {
    cylinder_face(*cylinder, shape.pose, local, rotation, face);
  } else if (const auto* cone = std::get_if<Cone>(&shape.shape->core())) {
    cone_face(*cone, shape.pose, local, rotation, face);
  } else if (const auto* spheres = std::get_if<SphereHull>(&shape.shape->core())) {
    sphere_hull_face(*spheres, local, kEdgeSine, kFaceCosine, face);
    for (FaceVertex& vertex : face.vertices) vertex.point = rotation * vertex.point + shape.pose.translation();
    face.plane_normal = rotation * face.plane_normal;
  } else {
    const auto& radii = std::get<Ellipsoid>(shape.shape->core()).radii;
    const Vec3 scaled = radii.cwiseProduct(local);
    face.vertices.push_back({rotation * (radii.cwiseProduct(scaled) / scaled.norm()) + shape.pose.translation(), 0});
  }
}

}  // namespace pd::detail
