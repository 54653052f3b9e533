#include "depth/distance/gjk_exact.hpp"

#include <optional>

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

}  // namespace

ExactNearest exact_nearest(const PosedPair& pair, const VertexPair* start, int count) {
  std::array<VertexPair, 5> ids{};
  std::array<Dyadic3, 5> points;
  int size = 0;
  const auto add = [&](VertexPair id) {
    for (int i = 0; i < size; ++i) {
      if (ids[i].a == id.a && ids[i].b == id.b) return;
    }
    ids[size] = id;
    points[size] = pair.exact(PairVector::point(id.a, id.b));
    ++size;
  };
  for (int i = 0; i < count; ++i) add(start[i]);

  for (;;) {
    // The nearest point of the at most five points' hull is that of a face of one to four of them, in its relative
    // interior, which no other point undercuts.
    Projection best;
    std::array<int, 4> chosen{};
    int chosen_count = 0;
    for (int subset_size = 1; subset_size <= 4 && chosen_count == 0; ++subset_size) {
      for (unsigned mask = 1; mask < (1u << size) && chosen_count == 0; ++mask) {
        if (__builtin_popcount(mask) != subset_size) continue;
        const Dyadic3* subset[4] = {};
        std::array<int, 4> members{};
        int k = 0;
        for (int i = 0; i < size; ++i) {
          if (mask >> i & 1u) {
            members[k] = i;
            subset[k++] = &points[i];
          }
        }
        const std::optional<Projection> projection = project(subset, k);
        if (!projection) continue;
        bool optimal = true;
        for (int i = 0; i < size && optimal; ++i) {
          optimal = (mask >> i & 1u) || dot(projection->point, points[i] - *subset[0]).sign() >= 0;
        }
        if (optimal) {
          best = *projection;
          chosen = members;
          chosen_count = k;
        }
      }
    }

    ExactNearest result;
    result.count = chosen_count;
    for (int i = 0; i < chosen_count; ++i) {
      result.simplex[i] = ids[chosen[i]];
      // Ratios of big numbers: bring both to the same exponent before rounding.
      const int shift = best.scale.exponent() + static_cast<int>(msb(best.scale.mantissa()));
      result.weights[i] = best.weights[i].scaled(-shift).to_double() / best.scale.scaled(-shift).to_double();
    }
    const bool zero = best.point.x.sign() == 0 && best.point.y.sign() == 0 && best.point.z.sign() == 0;
    if (zero) return result;

    const ExactDirection away(Dyadic3{-best.point.x, -best.point.y, -best.point.z});
    const SupportFace on_a = support_face_a(pair, away);
    const SupportFace on_b = support_face_b(pair, away);
    const VertexPair next{on_a.front(), on_b.front()};
    const Dyadic3 candidate = pair.exact(PairVector::point(next.a, next.b));
    if (dot(best.point, candidate - points[chosen[0]]).sign() >= 0) {
      result.apart = true;
      result.point = best.point;
      result.scale = best.scale * pair.homogeneous_factor();
      return result;
    }
    std::array<VertexPair, 4> kept_ids{};
    std::array<Dyadic3, 4> kept_points;
    for (int i = 0; i < chosen_count; ++i) {
      kept_ids[i] = ids[chosen[i]];
      kept_points[i] = points[chosen[i]];
    }
    size = 0;
    for (int i = 0; i < chosen_count; ++i) {
      ids[size] = kept_ids[i];
      points[size++] = kept_points[i];
    }
    add(next);
  }
}

}  // namespace pd::detail
