#include "bench/peers/jolt_pair.hpp"

#include <Jolt/Jolt.h>
// Jolt's own header comes before all its others.
#include <Jolt/Core/Memory.h>
#include <Jolt/Geometry/AABox.h>
#include <Jolt/Geometry/ConvexSupport.h>
#include <Jolt/Geometry/EPAPenetrationDepth.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/CylinderShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <immintrin.h>

#include <cfloat>
#include <cmath>

namespace pd::bench {

namespace {

using JPH::ConvexShape;
using JPH::Mat44;
using JPH::Vec3;
using JPH::Vec4;

constexpr float kTolerance = 1e-5F;

Vec3 to_jolt(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }
std::array<float, 3> from_jolt(const Vec3& v) { return {v.GetX(), v.GetY(), v.GetZ()}; }

/// Vertices side by side. Jolt's hull shape would scan them among other numbers, drop some, and take 256 at most.
struct Hull {
  JPH::Array<Vec3> vertices;
  JPH::PolygonConvexSupport<JPH::Array<Vec3>> support{vertices};

  explicit Hull(const JoltBody& body) {
    for (const auto& v : body.vertices) vertices.push_back(to_jolt(v));
  }
  Hull(const Hull&) = delete;
  Hull& operator=(const Hull&) = delete;
  const auto& core() const { return support; }
  const auto& whole() const { return support; }
  float radius() const { return 0; }
};

/// Our scan over the vertices, eight at a time: coordinates apart, the last group filled up with copies of the first
/// vertex.
class WideHull {
 public:
  explicit WideHull(const JoltBody& body) : points_(body.vertices.begin(), body.vertices.end()) {
    while (points_.size() % 8 != 0) points_.push_back(points_[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      coordinates_[k].resize(points_.size());
      for (std::size_t i = 0; i < points_.size(); ++i) coordinates_[k][i] = points_[i][k];
    }
  }
  Vec3 GetSupport(JPH::Vec3Arg direction) const {
    const __m256 x = _mm256_set1_ps(direction.GetX());
    const __m256 y = _mm256_set1_ps(direction.GetY());
    const __m256 z = _mm256_set1_ps(direction.GetZ());
    __m256 most = _mm256_set1_ps(-FLT_MAX);
    __m256i where = _mm256_setzero_si256();
    __m256i index = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (std::size_t i = 0; i < points_.size(); i += 8) {
      const __m256 height = _mm256_fmadd_ps(x, _mm256_loadu_ps(&coordinates_[0][i]),
                                            _mm256_fmadd_ps(y, _mm256_loadu_ps(&coordinates_[1][i]),
                                                            _mm256_mul_ps(z, _mm256_loadu_ps(&coordinates_[2][i]))));
      const __m256 higher = _mm256_cmp_ps(height, most, _CMP_GT_OQ);
      most = _mm256_max_ps(most, height);
      where = _mm256_blendv_epi8(where, index, _mm256_castps_si256(higher));
      index = _mm256_add_epi32(index, _mm256_set1_epi32(8));
    }
    __m256 best = _mm256_max_ps(most, _mm256_permute2f128_ps(most, most, 1));
    best = _mm256_max_ps(best, _mm256_permute_ps(best, 0x4e));
    best = _mm256_max_ps(best, _mm256_permute_ps(best, 0xb1));
    const int lane = __builtin_ctz(static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(most, best, _CMP_EQ_OQ))));
    alignas(32) std::array<int, 8> indices;
    _mm256_store_si256(reinterpret_cast<__m256i*>(indices.data()), where);
    return to_jolt(points_[static_cast<std::size_t>(indices[static_cast<std::size_t>(lane & 7)])]);
  }
  const auto& core() const { return *this; }
  const auto& whole() const { return *this; }
  float radius() const { return 0; }

 private:
  std::vector<std::array<float, 3>> points_;
  std::array<std::vector<float>, 3> coordinates_;
};

struct Box {
  JPH::AABox box;

  explicit Box(const JoltBody& body) : box(-to_jolt(body.radii), to_jolt(body.radii)) {}
  const auto& core() const { return box; }
  const auto& whole() const { return box; }
  float radius() const { return 0; }
};

/// A support mapping that Jolt calls as those of its own shapes.
template <class Map>
class Mapped final : public ConvexShape::Support {
 public:
  explicit Mapped(Map map) : map_(std::move(map)) {}
  Vec3 GetSupport(JPH::Vec3Arg direction) const override { return map_(direction); }
  float GetConvexRadius() const override { return 0; }

 private:
  Map map_;
};

template <class Map>
std::unique_ptr<ConvexShape::Support> mapped(Map map) {
  return std::make_unique<Mapped<Map>>(std::move(map));
}

/// Shapes of Jolt's own without a convex radius but that of spheres and capsules; cones and ellipsoids by formulas.
class Any {
 public:
  explicit Any(const JoltBody& body) {
    using Kind = JoltBody::Kind;
    if (body.kind == Kind::sphere) shape_ = new JPH::SphereShape(body.radius);
    if (body.kind == Kind::capsule) shape_ = new JPH::CapsuleShape(body.half_height, body.radius);
    if (body.kind == Kind::cylinder) shape_ = new JPH::CylinderShape(body.half_height, body.radius, 0.0F);
    if (body.kind == Kind::box) shape_ = new JPH::BoxShape(to_jolt(body.radii), 0.0F);
    if (shape_ != nullptr) {
      const Vec3 one = Vec3::sOne();
      core_ = shape_->GetSupportFunction(ConvexShape::ESupportMode::ExcludeConvexRadius, buffers_[0], one);
      whole_ = shape_->GetSupportFunction(ConvexShape::ESupportMode::IncludeConvexRadius, buffers_[1], one);
      return;
    }
    if (body.kind == Kind::ellipsoid) {
      own_ = mapped([radii = to_jolt(body.radii)](JPH::Vec3Arg d) {
        const Vec3 scaled = radii * d;
        const float length = scaled.Length();
        return length > 0 ? radii * scaled / length : Vec3(radii.GetX(), 0, 0);
      });
    } else if (body.kind == Kind::cone) {
      own_ = mapped([radius = body.radius, half = body.half_height](JPH::Vec3Arg d) {
        const float across = std::sqrt(d.GetX() * d.GetX() + d.GetZ() * d.GetZ());
        if (2 * half * d.GetY() > radius * across) return Vec3(0, half, 0);
        const float scale = across > 0 ? radius / across : 0;
        return Vec3(scale * d.GetX(), -half, scale * d.GetZ());
      });
    } else {
      hull_ = std::make_unique<Hull>(body);
      own_ = mapped([&support = hull_->support](JPH::Vec3Arg d) { return support.GetSupport(d); });
    }
    core_ = whole_ = own_.get();
  }
  Any(const Any&) = delete;
  Any& operator=(const Any&) = delete;
  const auto& core() const { return *core_; }
  const auto& whole() const { return *whole_; }
  float radius() const { return core_->GetConvexRadius(); }

 private:
  JPH::Ref<ConvexShape> shape_;
  ConvexShape::SupportBuffer buffers_[2];
  std::unique_ptr<Hull> hull_;
  std::unique_ptr<ConvexShape::Support> own_;
  const ConvexShape::Support* core_ = nullptr;
  const ConvexShape::Support* whole_ = nullptr;
};

/// The steps of Jolt's convex against convex, in A's frame.
template <class A, class B>
class Pair final : public JoltPair {
 public:
  Pair(const JoltBody& a, const JoltBody& b) : a_(a), b_(b) {}

  void stand(const std::array<float, 9>& c, const std::array<float, 3>& t) override {
    b_in_a_ = Mat44(Vec4(c[0], c[1], c[2], 0), Vec4(c[3], c[4], c[5], 0), Vec4(c[6], c[7], c[8], 0),
                    Vec4(t[0], t[1], t[2], 1));
  }
  JoltAnswer depth() override {
    using Status = JPH::EPAPenetrationDepth::EStatus;
    Vec3 axis = first_axis();
    Vec3 on_a = Vec3::sZero();
    Vec3 on_b = Vec3::sZero();
    JPH::EPAPenetrationDepth solver;
    const JPH::TransformedConvexObject core_b(b_in_a_, b_.core());
    const Status status =
        solver.GetPenetrationDepthStepGJK(a_.core(), a_.radius(), core_b, b_.radius(), kTolerance, axis, on_a, on_b);
    if (status == Status::NotColliding) return {};
    if (status == Status::Indeterminate) {
      const JPH::TransformedConvexObject whole_b(b_in_a_, b_.whole());
      if (!solver.GetPenetrationDepthStepEPA(a_.whole(), whole_b, kTolerance, axis, on_a, on_b)) return {};
    }
    return {true, false, from_jolt(on_a), from_jolt(on_b), {}};
  }
  JoltAnswer distance(float limit, bool warm) override {
    if (!warm || axis_.IsNearZero()) axis_ = first_axis();
    Vec3 on_a = Vec3::sZero();
    Vec3 on_b = Vec3::sZero();
    JPH::GJKClosestPoint solver;
    const JPH::TransformedConvexObject core_b(b_in_a_, b_.core());
    const float squared = solver.GetClosestPoints(a_.core(), core_b, kTolerance, limit * limit, axis_, on_a, on_b);
    return {squared == 0, squared == FLT_MAX, from_jolt(on_a), from_jolt(on_b), from_jolt(axis_)};
  }

 private:
  [[nodiscard]] Vec3 first_axis() const {
    const Vec3 between = b_in_a_.GetTranslation();
    return between.IsNearZero() ? Vec3::sAxisX() : between;
  }

  A a_;
  B b_;
  Mat44 b_in_a_ = Mat44::sIdentity();
  Vec3 axis_ = Vec3::sZero();
};

}  // namespace

std::string jolt_version() {
  return std::to_string(JPH_VERSION_MAJOR) + "." + std::to_string(JPH_VERSION_MINOR) + "." +
         std::to_string(JPH_VERSION_PATCH);
}

std::unique_ptr<JoltPair> make_jolt_pair(const JoltBody& a, const JoltBody& b, bool wide) {
  static const bool allocator = [] {
    JPH::RegisterDefaultAllocator();
    return true;
  }();
  static_cast<void>(allocator);
  using Kind = JoltBody::Kind;
  if (wide && a.kind == Kind::hull && b.kind == Kind::hull) return std::make_unique<Pair<WideHull, WideHull>>(a, b);
  if (a.kind == Kind::hull && b.kind == Kind::hull) return std::make_unique<Pair<Hull, Hull>>(a, b);
  if (a.kind == Kind::box && b.kind == Kind::box) return std::make_unique<Pair<Box, Box>>(a, b);
  return std::make_unique<Pair<Any, Any>>(a, b);
}

}  // namespace pd::bench
