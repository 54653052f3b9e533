#include "depth/distance/gjk_exact.hpp"

#include <bit>
#include <optional>
#include <span>
#include <utility>

#include "depth/distance/closest_simplex.hpp"

namespace pd::detail {

namespace {

/// Nearest point of the affine hull of up to three points to the origin, where it lies in their relative interior; or
/// the origin itself inside four. point / scale, weights unnormalised with sum `scale` (all positive).
struct Projection {
  Dyadic3 point;
  Dyadic scale;
  std::array<Dyadic, 4> weights;
};

std::optional<Projection> project(const Dyadic3* const* p, int count) {
  Projection r;
  if (count == 1) {
    r.point = *p[0];
    r.scale = Dyadic(1.0);
    r.weights[0] = Dyadic(1.0);
    return r;
  }
  if (count == 2) {
    const Dyadic3 e = *p[1] - *p[0];
    r.scale = dot(e, e);
    r.weights[1] = -dot(*p[0], e);
    r.weights[0] = r.scale - r.weights[1];
  } else if (count == 3) {
    const Dyadic3 n = cross(*p[1] - *p[0], *p[2] - *p[0]);
    r.scale = dot(n, n);
    for (int i = 0; i < 3; ++i) r.weights[i] = dot(n, cross(*p[(i + 1) % 3], *p[(i + 2) % 3]));
  } else {
    r.scale = determinant(*p[1] - *p[0], *p[2] - *p[0], *p[3] - *p[0]);
    r.weights[0] = determinant(*p[1], *p[2], *p[3]);
    r.weights[1] = -determinant(*p[0], *p[2], *p[3]);
    r.weights[2] = determinant(*p[0], *p[1], *p[3]);
    r.weights[3] = -determinant(*p[0], *p[1], *p[2]);
    if (r.scale.sign() < 0) {
      r.scale = -r.scale;
      for (Dyadic& w : r.weights) w = -w;
    }
  }
  if (r.scale.sign() == 0) return std::nullopt;
  for (int i = 0; i < count; ++i) {
    if (r.weights[i].sign() <= 0) return std::nullopt;
    r.point = i == 0 ? *p[0] * r.weights[0] : r.point + *p[i] * r.weights[i];
  }
  return r;
}

/// Up to four vertices of P and one more, without repetition.
class ExactSimplex {
 public:
  explicit ExactSimplex(const PosedPair& pair) : pair_(pair) {}

  void add(const VertexPair& id) {
    for (std::size_t i = 0; i < size_; ++i) {
      if (ids_[i].a == id.a && ids_[i].b == id.b) return;
    }
    ids_[size_] = id;
    const PairVector v = PairVector::point(id.a, id.b);
    points_[size_] = pair_.exact(v);
    rounded_[size_] = pair_.approximate(v);
    ++size_;
  }

  /// A face of the simplex and the point closest to the origin in its relative interior.
  struct Face {
    Projection closest;
    std::array<std::size_t, 4> members{};
    std::size_t count = 0;
  };

  /// The face whose closest point is that of the whole hull: no other point lies before the plane across it.
  /// @param with  points that it has for certain, as bits: a point nearer than all the others together, say.
  [[nodiscard]] Face closest_face(unsigned with) const {
    // An inexact search mostly leaves no vertex too many.
    const unsigned all = (1U << size_) - 1;
    if (with == 0) {
      if (std::optional<Face> face = closest_in(all)) return *std::move(face);
    }
    for (int wanted = 1; wanted <= 4; ++wanted) {
      for (unsigned mask = 1; mask <= all; ++mask) {
        if (std::popcount(mask) != wanted || (mask & with) != with || certainly_elsewhere(mask)) continue;
        if (std::optional<Face> face = closest_in(mask)) return *std::move(face);
      }
    }
    return {};
  }

  [[nodiscard]] unsigned last() const { return 1U << (size_ - 1); }

  void reduce_to(const Face& face) {
    // Members ascend, so that no point is overwritten before it is moved.
    for (std::size_t i = 0; i < face.count; ++i) {
      ids_[i] = ids_[face.members[i]];
      rounded_[i] = rounded_[face.members[i]];
      if (i != face.members[i]) points_[i] = std::move(points_[face.members[i]]);
    }
    size_ = face.count;
  }

  [[nodiscard]] const VertexPair& id(std::size_t i) const { return ids_[i]; }
  [[nodiscard]] const Dyadic3& point(std::size_t i) const { return points_[i]; }

 private:
  /// Whether a weight of the face's closest point is certainly negative, as doubles tell.
  [[nodiscard]] bool certainly_elsewhere(unsigned mask) const {
    Vec3 p[4];
    int count = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      if ((mask >> i & 1U) != 0) p[count++] = rounded_[i];
    }
    // Points err by 8u of the pair's size and are no larger. A weight is a sum of products of as many of them and of
    // their differences; its error is below 2^-40 of that power of the size.
    const double size = pair_.vector_error() * 0x1p50;
    if (count == 2) {
      const Vec3 e = p[1] - p[0];
      const double least = -0x1p-36 * size * size;
      return p[1].dot(e) < least || -p[0].dot(e) < least;
    }
    if (count != 3) return false;
    const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]);
    const double least = -0x1p-36 * size * size * size * size;
    for (int i = 0; i < 3; ++i) {
      if (n.dot(p[(i + 1) % 3].cross(p[(i + 2) % 3])) < least) return true;
    }
    return false;
  }

  [[nodiscard]] std::optional<Face> closest_in(unsigned mask) const {
    Face face;
    const Dyadic3* chosen[4] = {};
    for (std::size_t i = 0; i < size_; ++i) {
      if ((mask >> i & 1U) == 0) continue;
      face.members[face.count] = i;
      chosen[face.count++] = &points_[i];
    }
    std::optional<Projection> projection = project(chosen, static_cast<int>(face.count));
    if (!projection) return std::nullopt;
    for (std::size_t i = 0; i < size_; ++i) {
      if ((mask >> i & 1U) == 0 && dot(projection->point, points_[i] - *chosen[0]).sign() < 0) return std::nullopt;
    }
    face.closest = *std::move(projection);
    return face;
  }

  const PosedPair& pair_;
  std::array<VertexPair, 5> ids_{};
  std::array<Dyadic3, 5> points_;
  std::array<Vec3, 5> rounded_;  ///< scaled
  std::size_t size_ = 0;
};

/// The simplex that the search ended with and where the closest point lies in it.
ExactClosestPoint result_of(const ExactSimplex& simplex, const ExactSimplex::Face& face) {
  ExactClosestPoint result;
  result.count = static_cast<int>(face.count);
  // Ratios of big numbers: both are brought to the same exponent before rounding.
  const Dyadic& scale = face.closest.scale;
  const int shift = scale.exponent() + static_cast<int>(msb(scale.mantissa()));
  for (std::size_t i = 0; i < face.count; ++i) {
    result.simplex[i] = simplex.id(face.members[i]);
    result.weights[i] = face.closest.weights[i].scaled(-shift).to_double() / scale.scaled(-shift).to_double();
  }
  return result;
}

}  // namespace

ExactClosestPoint exact_closest_point(const PosedPair& pair, const VertexPair* start, int count) {
  const ClosestSimplex begin = closest_simplex(pair, std::span(start, static_cast<std::size_t>(count)));
  ExactSimplex simplex(pair);
  for (int i = 0; i < begin.count; ++i) simplex.add(begin.vertices[static_cast<std::size_t>(i)]);
  // The distance falls strictly at each step among finitely many simplices, so this ends.
  for (unsigned with = 0;; with = simplex.last()) {
    // 1. The closest point of the simplex, and the face that holds it: the last vertex among it, which lies before the
    // plane through the closest point so far.
    const ExactSimplex::Face face = simplex.closest_face(with);
    const Dyadic3& y = face.closest.point;
    if (y.x.sign() == 0 && y.y.sign() == 0 && y.z.sign() == 0) return result_of(simplex, face);

    // 2. A vertex of P farthest towards the origin.
    const ExactDirection toward(Dyadic3{-y.x, -y.y, -y.z});
    const VertexPair next{support_face_a(pair, toward).front(), support_face_b(pair, toward).front()};
    const Dyadic3 candidate = pair.exact(PairVector::point(next.a, next.b));

    // 3. None beyond the plane through the closest point: P lies behind it.
    if (dot(y, candidate - simplex.point(face.members[0])).sign() >= 0) {
      ExactClosestPoint result = result_of(simplex, face);
      result.apart = true;
      result.point = y;
      result.scale = face.closest.scale * pair.homogeneous_factor();
      return result;
    }
    simplex.reduce_to(face);
    simplex.add(next);
  }
}

}  // namespace pd::detail
