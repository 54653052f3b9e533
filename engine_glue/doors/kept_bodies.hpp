/// @file
/// Bodies made from the numbers of an engine's shapes, each converted once and compared in every call: a host may
/// change a shape in place, or destroy it and get another one at the same address.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pd/contact/time_of_impact.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

enum class BodyKind : std::uint8_t { sphere, box, capsule, cylinder, cone, ellipsoid, hull };

/// The numbers from which a body is made. Equal numbers make equal bodies.
struct BodyNumbers {
  BodyKind kind = BodyKind::sphere;
  /// A sphere's radius, a box's half extents, an ellipsoid's radii; of a capsule, cylinder or cone along z the radius
  /// and half the height. Of a hull the first is a stamp, which changes when the points do.
  std::array<double, 3> size{};
  std::span<const double> points = {};  ///< of a hull, three numbers each
};

/// Sizes of bodies and coordinates of poses up to which the core answers half-spaces.
inline constexpr double kLeastBody = 1e-100;
inline constexpr double kLargestBody = 1e100;

inline Expected<ConvexShape> body_of_any_size(const BodyNumbers& numbers) {
  const auto [x, y, z] = numbers.size;
  switch (numbers.kind) {
    case BodyKind::sphere:
      return ConvexShape::sphere(x);
    case BodyKind::capsule:
      return ConvexShape::capsule(x, y, 2);
    case BodyKind::cylinder:
      return ConvexShape::cylinder(x, y, 2);
    case BodyKind::cone:
      return ConvexShape::cone(x, y, 2);
    case BodyKind::ellipsoid:
      return ConvexShape::ellipsoid({x, y, z});
    case BodyKind::box:
    case BodyKind::hull:
      break;
  }
  std::vector<Vec3> points;
  for (std::size_t i = 0; i + 2 < numbers.points.size(); i += 3) {
    points.emplace_back(numbers.points[i], numbers.points[i + 1], numbers.points[i + 2]);
  }
  auto polytope = numbers.kind == BodyKind::box ? ConvexPolytope::box({x, y, z}) : ConvexPolytope::from_points(points);
  if (!polytope) return polytope.error();
  return ConvexShape(*std::move(polytope));
}

/// The body, or an error that says which number is none. Time O(n log n) in the points of a hull.
inline Expected<ConvexShape> make_body(const BodyNumbers& numbers) {
  auto body = body_of_any_size(numbers);
  if (!body) return body;
  const double radius = bounding_radius(*body);
  if (!(radius >= kLeastBody && radius <= kLargestBody)) {
    return Error{ErrorCode::out_of_range, "a body's size lies between 1e-100 and 1e100", "size"};
  }
  return body;
}

/// The pose of a shape; an error if it is NaN, infinite, farther away than 1e100 or no rotation.
inline Expected<Pose> checked_pose(const Mat3& rotation, const Vec3& translation) {
  if (translation.cwiseAbs().maxCoeff() > kLargestBody) {
    return Error{ErrorCode::out_of_range, "a coordinate is larger than 1e100", "translation"};
  }
  return Pose::from_matrix(rotation, translation);
}

/// The bodies of one thread.
class KeptBodies {
 public:
  struct Body {
    BodyKind kind;
    std::array<double, 3> size;
    std::vector<double> points;
    Expected<ConvexShape> shape;
    double radius;  ///< about the origin of the frame
  };

  /// Makes room for the bodies of a pair. Forgets all bodies if there are many, so that those of destroyed shapes go.
  void begin_pair() {
    if (bodies_.size() > kMostBodies) bodies_.clear();
  }

  /// The body of a shape, or a refusal in it. Valid until the next `begin_pair`.
  /// @param key  tells shapes apart that live at the same time
  const Body& find(const void* key, const BodyNumbers& numbers) {
    const auto found = bodies_.find(key);
    if (found != bodies_.end() && same(found->second, numbers)) return found->second;
    ++conversions_;
    auto shape = make_body(numbers);
    const double radius = shape ? bounding_radius(*shape) : 0;
    Body body{numbers.kind, numbers.size, {numbers.points.begin(), numbers.points.end()}, std::move(shape), radius};
    return bodies_.insert_or_assign(key, std::move(body)).first->second;
  }

  [[nodiscard]] std::int64_t conversions() const { return conversions_; }

 private:
  static constexpr std::size_t kMostBodies = 20000;

  /// Compares bits, so that a NaN equals itself and is not converted again in every step.
  static bool same(const Body& body, const BodyNumbers& numbers) {
    using Bits = std::array<std::uint64_t, 3>;
    if (body.kind != numbers.kind || std::bit_cast<Bits>(body.size) != std::bit_cast<Bits>(numbers.size)) return false;
    return std::equal(
        body.points.begin(), body.points.end(), numbers.points.begin(), numbers.points.end(),
        [](double p, double q) { return std::bit_cast<std::uint64_t>(p) == std::bit_cast<std::uint64_t>(q); });
  }

  std::unordered_map<const void*, Body> bodies_;
  std::int64_t conversions_ = 0;
};

}  // namespace pd::detail
