#include "pd/fcl/signed_distance.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

namespace detail {

namespace {

/// A table of so many geometries is searched for those that are gone.
constexpr std::size_t kKeptShapes = 256;

/// The numbers that a primitive is made of. A convex mesh is immutable and has none.
std::array<double, 9> numbers_of(const fcl::CollisionGeometry<double>& geometry) {
  const auto put = [](auto... values) { return std::array<double, 9>{static_cast<double>(values)...}; };
  switch (geometry.getNodeType()) {
    case fcl::GEOM_BOX: {
      const auto& side = static_cast<const fcl::Box<double>&>(geometry).side;
      return put(side[0], side[1], side[2]);
    }
    case fcl::GEOM_SPHERE:
      return put(static_cast<const fcl::Sphere<double>&>(geometry).radius);
    case fcl::GEOM_CAPSULE:
      return put(static_cast<const fcl::Capsule<double>&>(geometry).radius,
                 static_cast<const fcl::Capsule<double>&>(geometry).lz);
    case fcl::GEOM_CYLINDER:
      return put(static_cast<const fcl::Cylinder<double>&>(geometry).radius,
                 static_cast<const fcl::Cylinder<double>&>(geometry).lz);
    case fcl::GEOM_CONE:
      return put(static_cast<const fcl::Cone<double>&>(geometry).radius,
                 static_cast<const fcl::Cone<double>&>(geometry).lz);
    case fcl::GEOM_ELLIPSOID: {
      const auto& radii = static_cast<const fcl::Ellipsoid<double>&>(geometry).radii;
      return put(radii[0], radii[1], radii[2]);
    }
    case fcl::GEOM_TRIANGLE: {
      const auto& t = static_cast<const fcl::TriangleP<double>&>(geometry);
      return put(t.a[0], t.a[1], t.a[2], t.b[0], t.b[1], t.b[2], t.c[0], t.c[1], t.c[2]);
    }
    default:
      return {};
  }
}

/// True if two geometries have the same bits, so that a NaN equals itself.
bool same_bits(const std::array<double, 9>& a, const std::array<double, 9>& b) {
  using Bits = std::array<std::uint64_t, 9>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

Expected<ConvexShape> hull_of(const std::vector<Vec3>& points) {
  auto hull = ConvexPolytope::from_points(points);
  if (!hull) return hull.error();
  return ConvexShape(*std::move(hull));
}

Expected<ConvexShape> shape_of(const fcl::CollisionGeometry<double>& geometry, const std::array<double, 9>& n) {
  switch (geometry.getNodeType()) {
    case fcl::GEOM_BOX: {
      auto box = ConvexPolytope::box({n[0] / 2, n[1] / 2, n[2] / 2});
      if (!box) return box.error();
      return ConvexShape(*std::move(box));
    }
    case fcl::GEOM_SPHERE:
      return ConvexShape::sphere(n[0]);
    case fcl::GEOM_CAPSULE:
      return ConvexShape::capsule(n[0], n[1] / 2, 2);
    case fcl::GEOM_CYLINDER:
      return ConvexShape::cylinder(n[0], n[1] / 2, 2);
    case fcl::GEOM_CONE:
      return ConvexShape::cone(n[0], n[1] / 2, 2);
    case fcl::GEOM_ELLIPSOID:
      return ConvexShape::ellipsoid({n[0], n[1], n[2]});
    case fcl::GEOM_TRIANGLE:
      return hull_of({{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}});
    case fcl::GEOM_CONVEX: {
      std::vector<Vec3> points;
      for (const auto& vertex : static_cast<const fcl::Convex<double>&>(geometry).getVertices()) {
        points.push_back(vertex);
      }
      return hull_of(points);
    }
    default:
      return Error{ErrorCode::unsupported, "pdepth answers for FCL's convex primitives and fcl::Convex", "geometry"};
  }
}

}  // namespace

class FclPairs {
 public:
  /// Computes the answer for two objects. @return false if FCL has to answer
  bool ask(const fcl::CollisionObject<double>& a, const fcl::CollisionObject<double>& b, double delta) {
    body_a_ = body(a);
    body_b_ = body(b);
    auto pose_a = pose(a), pose_b = pose(b);
    for (const Error* refusal : {error_of(*body_a_), error_of(*body_b_), error_of(pose_a), error_of(pose_b)}) {
      if (refusal == nullptr) continue;
      if (left_++ == 0) reason_ = refusal->where + ": " + refusal->message;
      return false;
    }
    ++answered_;
    a_ = PosedShape{&**body_a_, *pose_a};
    b_ = PosedShape{&**body_b_, *pose_b};
    answer_ = penetration_depth(a_, b_, scratch_, {.bracket = Bracket::certified, .delta = delta});
    return true;
  }
  [[nodiscard]] const PenetrationDepth& answer() const { return answer_; }
  ContactManifold manifold() { return contact_manifold(a_, b_, answer_, 0, manifold_, DeepestPoint::at_depth); }

  std::int64_t answered_ = 0;
  std::int64_t left_ = 0;
  std::string reason_;

 private:
  using Body = std::shared_ptr<const Expected<ConvexShape>>;
  struct Kept {
    std::weak_ptr<const fcl::CollisionGeometry<double>> geometry;  ///< keeps the address from meaning another geometry
    std::array<double, 9> numbers{};
    Body body;
  };

  template <class T>
  static const Error* error_of(const Expected<T>& value) {
    return value ? nullptr : &value.error();
  }

  Body body(const fcl::CollisionObject<double>& object) {
    const std::shared_ptr<const fcl::CollisionGeometry<double>>& geometry = object.collisionGeometry();
    const std::array<double, 9> numbers = numbers_of(*geometry);
    Kept& kept = kept_[geometry.get()];
    // A pointer that owns nothing says nothing about the life of its geometry: its weak pointer is expired.
    const bool same =
        !kept.geometry.expired() && !kept.geometry.owner_before(geometry) && !geometry.owner_before(kept.geometry);
    if (same && kept.body != nullptr && same_bits(kept.numbers, numbers)) return kept.body;
    Body converted = std::make_shared<const Expected<ConvexShape>>(shape_of(*geometry, numbers));
    kept = {geometry, numbers, converted};
    if (kept_.size() > look_through_) {
      std::erase_if(kept_, [](const auto& entry) { return entry.second.geometry.expired(); });
      look_through_ = 2 * kept_.size() + kKeptShapes;
    }
    return converted;
  }

  static Expected<Pose> pose(const fcl::CollisionObject<double>& object) {
    return Pose::from_matrix(object.getTransform().linear(), object.getTransform().translation());
  }

  static const ConvexShape& some_point() {
    static const ConvexShape point = *ConvexPolytope::from_points(std::array<Vec3, 1>{Vec3::Zero()});
    return point;
  }

  std::unordered_map<const fcl::CollisionGeometry<double>*, Kept> kept_;
  std::size_t look_through_ = kKeptShapes;
  Body body_a_, body_b_;  ///< the last pair's, which no conversion may free
  PosedShape a_{&some_point(), Pose()};
  PosedShape b_{&some_point(), Pose()};
  Scratch scratch_;
  ManifoldScratch manifold_;
  PenetrationDepth answer_;
};

}  // namespace detail

FclQueries::FclQueries() : pairs_(std::make_unique<detail::FclPairs>()) {}
FclQueries::~FclQueries() = default;
FclQueries::FclQueries(FclQueries&&) noexcept = default;
FclQueries& FclQueries::operator=(FclQueries&&) noexcept = default;

namespace {

/// FCL's own contacts, by the rule of `FclQueries::collide`: those that `result` held before do not count.
std::size_t collide_by_fcl(const fcl::CollisionObject<double>& a, const fcl::CollisionObject<double>& b,
                           fcl::CollisionRequest<double> request, fcl::CollisionResult<double>& result) {
  const std::size_t held = result.numContacts();
  if (request.num_max_contacts < std::numeric_limits<std::size_t>::max() - held) request.num_max_contacts += held;
  fcl::collide(&a, &b, request, result);
  return result.numContacts() - held;
}

}  // namespace

double FclQueries::distance(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                            const fcl::DistanceRequest<double>& request, fcl::DistanceResult<double>& result) {
  const double delta = request.rel_err;
  if (!pairs_->ask(*a, *b, delta >= 0 && delta <= 1 ? delta : 0)) return fcl::distance(a, b, request, result);
  const PenetrationDepth& answer = pairs_->answer();
  const auto signed_distance = static_cast<double>(answer.signed_distance());
  constexpr int kNone = fcl::DistanceResult<double>::NONE;
  result.update(signed_distance, a->collisionGeometry().get(), b->collisionGeometry().get(), kNone, kNone,
                answer.witness_a, answer.witness_b);
  return signed_distance;
}

std::size_t FclQueries::collide(const fcl::CollisionObject<double>* a, const fcl::CollisionObject<double>* b,
                                const fcl::CollisionRequest<double>& request, fcl::CollisionResult<double>& result) {
  if (request.num_max_contacts == 0) return fcl::collide(a, b, request, result);
  if (!pairs_->ask(*a, *b, 0)) return collide_by_fcl(*a, *b, request, result);
  const PenetrationDepth& answer = pairs_->answer();
  if (answer.contact == ContactClass::separated) return 0;
  const auto* first = a->collisionGeometry().get();
  const auto* second = b->collisionGeometry().get();
  constexpr int kNone = fcl::Contact<double>::NONE;
  if (!request.enable_contact) {
    result.addContact(fcl::Contact<double>(first, second, kNone, kNone));
    return 1;
  }
  ContactManifold points = pairs_->manifold();
  const auto last = points.points.begin() + points.count;
  if (points.count > 0) {
    std::iter_swap(
        points.points.begin(),
        std::max_element(points.points.begin(), last, [](const auto& p, const auto& q) { return p.depth < q.depth; }));
  }
  // The first contact has the bodies' own depth. If only one is asked for, its points are the witnesses.
  if (points.count == 0 || request.num_max_contacts == 1) {
    points.points[0] = {answer.witness_a, answer.witness_b, answer.depth, 0};
    points.count = 1;
  }
  const Vec3 normal = -answer.normal;
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(points.count), request.num_max_contacts);
  for (std::size_t i = 0; i < count; ++i) {
    const ContactPoint& point = points.points[i];
    const Vec3 middle = point.position_a + (point.position_b - point.position_a) / 2;
    result.addContact(fcl::Contact<double>(first, second, kNone, kNone, middle, normal, std::max(point.depth, 0.0)));
  }
  return count;
}

std::int64_t FclQueries::answered() const { return pairs_->answered_; }
std::int64_t FclQueries::left_to_fcl() const { return pairs_->left_; }
const std::string& FclQueries::first_reason() const { return pairs_->reason_; }

}  // namespace pd
