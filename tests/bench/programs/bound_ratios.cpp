/// @file
/// `bound_ratios`: how much of its error bound a rounded number needs. For every bound of its table it climbs to input
/// whose true error, in numbers of any length, is the largest share of the bound: a share above 1 would be an error in
/// the proof, a share near 0 a bound that nobody needs. The largest shares found stand beside the bounds in the
/// sources.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "bench/programs/bracket_shares.hpp"
#include "bench/programs/real.hpp"
#include "depth/certificate/facet_plane.hpp"
#include "numeric/dyadic.hpp"
#include "numeric/estimate.hpp"
#include "numeric/length.hpp"
#include "numeric/orientation_filter.hpp"
#include "shape/posed_pair.hpp"

namespace {

using pd::Vec3;
using pd::bench::Numbers;
using pd::bench::Real;
using pd::bench::real;
using pd::detail::Dyadic;
using pd::detail::Dyadic3;
using pd::detail::Estimate;
using pd::detail::FacetOfDifference;
using pd::detail::PairVector;
using pd::detail::PosedPair;

double share(const Real& error, double bound) { return bound > 0 ? static_cast<double>(abs(error) / bound) : 0; }

/// Of a determinant whose last rounding, of at most u |determinant|, leaves its sign alone: what came before, at least.
double share_before_last(const Real& error, double determinant, double bound) {
  const Real before = abs(error) - abs(Real(determinant)) * 0x1p-53;
  return before > 0 ? share(before, bound) : 0;
}

double orient2d_share(const Numbers& x) {
  const auto r = pd::detail::rounded_orient2d({x[0], x[1]}, {x[2], x[3]}, {x[4], x[5]});
  const Real truth = (Real(x[2]) - x[0]) * (Real(x[5]) - x[1]) - (Real(x[3]) - x[1]) * (Real(x[4]) - x[0]);
  return share_before_last(r.determinant - truth, r.determinant, r.error);
}

std::array<Vec3, 4> four_points(const Numbers& x) {
  return {Vec3(x[0], x[1], x[2]), Vec3(x[3], x[4], x[5]), Vec3(x[6], x[7], x[8]), Vec3(x[9], x[10], x[11])};
}
Real true_orient3d(const std::array<Vec3, 4>& p) {
  std::array<std::array<Real, 3>, 3> m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j] = Real(p[i + 1][j]) - p[0][j];
  }
  const auto& [b, c, d] = m;
  return d[0] * (b[1] * c[2] - b[2] * c[1]) + d[1] * (b[2] * c[0] - b[0] * c[2]) + d[2] * (b[0] * c[1] - b[1] * c[0]);
}
double orient3d_share(const Numbers& x) {
  const auto p = four_points(x);
  const auto r = pd::detail::rounded_orient3d(p[0], p[1], p[2], p[3]);
  return share_before_last(r.determinant - true_orient3d(p), r.determinant, r.error());
}
double orient3d_double_double_share(const Numbers& x) {
  const auto p = four_points(x);
  const auto r = pd::detail::rounded_orient3d(p[0], p[1], p[2], p[3]);
  const auto d = pd::detail::double_double_orient3d(p[0], p[1], p[2], p[3]);
  return share(Real(d.hi) + d.lo - true_orient3d(p), r.double_double_error());
}

double estimate_share(const Numbers& x) {
  const auto expression = [&]<class N>() {
    return (N(x[0]) - N(x[1])) * (N(x[2]) + N(x[3]) * N(x[4])) - N(x[0]) * N(x[2]) + N(x[1]) * N(x[2]);
  };
  const Estimate e = expression.operator()<Estimate>();
  return share(e.value - expression.operator()<Real>(), e.error);
}

double length_share(const Numbers& x) {
  const Real truth = sqrt(Real(x[0]) * x[0] + Real(x[1]) * x[1]);
  return share(pd::detail::length(x[0], x[1]) - truth, static_cast<double>(truth) * 0x1p-51);
}

/// Two boxes in two poses by quaternions: half extents, quaternions, translations, 20 numbers in all.
template <class Ask>
double of_boxes(const Numbers& x, const Ask& ask) {
  const auto body = [&](int first) {
    return pd::ConvexPolytope::box(Vec3(x[first], x[first + 1], x[first + 2]).cwiseAbs());
  };
  const auto pose = [&](int first) {
    const Eigen::Vector4d q = Eigen::Vector4d(x[first], x[first + 1], x[first + 2], x[first + 3]).normalized();
    return pd::Pose::from_quaternion({q[0], q[1], q[2], q[3]}, {x[first + 4], x[first + 5], x[first + 6]});
  };
  const auto a = body(0), b = body(3);
  const auto pose_a = pose(6), pose_b = pose(13);
  if (!a || !b || !pose_a || !pose_b) return 0;
  return ask(PosedPair(*a, *pose_a, *b, *pose_b));
}
/// Largest error of a coordinate over all corners of the difference.
template <class Approximate>
double largest_error(const PosedPair& pair, double bound, const Approximate& approximate) {
  const Real unit = ldexp(Real(1) / real(pair.homogeneous_factor()), -pair.scale_exponent());
  double largest = 0;
  for (int k = 0; k < 64; ++k) {
    const PairVector v = PairVector::point(k / 8, k % 8);
    const Dyadic3 exact = pair.exact(v);
    const std::array<Real, 3> rounded = approximate(v);
    largest =
        std::max({largest, share(rounded[0] - real(exact.x) * unit, bound),
                  share(rounded[1] - real(exact.y) * unit, bound), share(rounded[2] - real(exact.z) * unit, bound)});
  }
  return largest;
}
double vector_share(const Numbers& x) {
  return of_boxes(x, [](const PosedPair& pair) {
    return largest_error(pair, pair.vector_error(), [&](const PairVector& v) -> std::array<Real, 3> {
      const Vec3 p = pair.approximate(v);
      return {p.x(), p.y(), p.z()};
    });
  });
}
double vector_double_double_share(const Numbers& x) {
  return of_boxes(x, [](const PosedPair& pair) {
    return largest_error(pair, pair.vector_error_dd(), [&](const PairVector& v) -> std::array<Real, 3> {
      const auto p = pair.approximate_dd(v);
      return {Real(p.x.hi) + p.x.lo, Real(p.y.hi) + p.y.lo, Real(p.z.hi) + p.z.lo};
    });
  });
}

/// Planes through an edge of each box.
template <class Share>
double largest_of_planes(const PosedPair& pair, const Share& plane_share) {
  double largest = 0;
  for (int k = 0; k < 49; ++k) {
    const auto facet = FacetOfDifference::from_edges(0, 1 + k / 7, 0, 1 + k % 7);
    const pd::detail::FacetPlane plane = pd::detail::measure_facet(pair, facet);
    if (!plane.known()) continue;
    const Dyadic3 normal = cross(pair.exact(facet.u), pair.exact(facet.v));
    const Real length = sqrt(real(dot(normal, normal)));
    largest = std::max(largest, plane_share(facet, plane, normal, length));
  }
  return largest;
}
double plane_distance_share(const Numbers& x) {
  return of_boxes(x, [](const PosedPair& pair) {
    const Real unit = ldexp(Real(1) / real(pair.homogeneous_factor()), -pair.scale_exponent());
    return largest_of_planes(pair,
                             [&](const auto& facet, const auto& plane, const Dyadic3& normal, const Real& length) {
                               const Real truth = real(dot(pair.exact(facet.point()), normal)) / length * unit;
                               return share(Real(plane.distance.hi) + plane.distance.lo - truth, plane.distance_error);
                             });
  });
}
double plane_unit_share(const Numbers& x) {
  return of_boxes(x, [](const PosedPair& pair) {
    return largest_of_planes(pair, [&](const auto&, const auto& plane, const Dyadic3& normal, const Real& length) {
      const auto of = [&](const pd::detail::DoubleDouble& rounded, const Dyadic& exact) {
        return share(Real(rounded.hi) + rounded.lo - real(exact) / length, plane.unit_error);
      };
      return std::max({of(plane.unit.x, normal.x), of(plane.unit.y, normal.y), of(plane.unit.z, normal.z)});
    });
  });
}

struct Bound {
  const char* name;
  const char* where;
  int numbers;
  double (*share)(const Numbers&);
  int cost;  ///< evaluations of the cheapest bound that one of this takes
};
constexpr Bound kBounds[] = {
    {"orient2d", "kBound2d", 6, orient2d_share, 1},
    {"orient3d", "kBound3d", 12, orient3d_share, 2},
    {"orient3d in double-double", "kBoundDoubleDouble", 12, orient3d_double_double_share, 2},
    {"estimates of an expression", "estimate::kRounding", 5, estimate_share, 1},
    {"length", "2^-51", 2, length_share, 1},
    {"points of P", "PosedPair::vector_error", 20, vector_share, 50},
    {"points of P in double-double", "PosedPair::vector_error_dd", 20, vector_double_double_share, 100},
    {"distance of a facet's plane", "FacetPlane::distance_error", 20, plane_distance_share, 100},
    {"normal of a facet's plane", "FacetPlane::unit_error", 20, plane_unit_share, 100},
    {"depth of two boxes", "gauss_boxes: box_rounding", 20, pd::bench::box_depth_share, 50},
    {"contact of two boxes", "gauss_boxes: box_rounding", 20, pd::bench::box_contact_share, 50},
    {"distance of two segments", "kPointError", 26, pd::bench::segments_share, 20},
    {"a segment before a box's face", "kBoxPointError", 23, pd::bench::slender_over_face_share, 20},
    {"height over a hull's triangle", "quickhull: kHeightError", 15, pd::bench::hull_height_share, 4},
};

/// Climbs from random input, and anew where nothing near is higher.
class Climb {
 public:
  Climb(const Bound& bound, std::uint64_t seed) : bound_(bound), bits_(seed) {}

  double run(std::int64_t evaluations) {
    double best = 0;
    for (std::int64_t done = 0; done < evaluations;) {
      Numbers at = start();
      double height = bound_.share(at);
      ++done;
      for (int failed = 0; failed < 40 * bound_.numbers && done < evaluations; ++done) {
        Numbers next = at;
        for (int k = 1 + static_cast<int>(bits_() % 2); k > 0; --k) move(next[bits_() % next.size()]);
        const double other = bound_.share(next);
        failed = other > height ? 0 : failed + 1;
        if (other >= height) {
          at = std::move(next);
          height = other;
        }
      }
      best = std::max(best, height);
    }
    return best;
  }

 private:
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double number() {
    const int exponent = static_cast<int>(bits_() % 7) - 3;
    const double size = std::ldexp(uniform() + 1, exponent);
    return bits_() % 2 ? size : -size;
  }
  Numbers start() {
    Numbers x(static_cast<std::size_t>(bound_.numbers));
    for (double& value : x) value = number();
    return x;
  }
  void move(double& x) {
    switch (bits_() % 5) {
      case 0:
        x = number();
        break;
      case 1:
        x = -x;
        break;
      case 2:
        x = std::ldexp(x, static_cast<int>(bits_() % 3) - 1);
        break;
      case 3: {
        const int halvings = static_cast<int>(bits_() % 50);
        x *= 1 + std::ldexp(uniform() - 0.5, -halvings);
        break;
      }
      default:
        for (int k = 1 + static_cast<int>(bits_() % 4); k > 0; --k) x = std::nextafter(x, bits_() % 2 ? 1e300 : -1e300);
    }
  }

  const Bound& bound_;
  std::mt19937_64 bits_;
};

}  // namespace

int main(int argc, char** argv) {
  std::int64_t evaluations = 1'000'000;
  std::uint64_t seed = 1;
  std::string only;
  CLI::App app{"Climbs to the largest share that a rounding error has in its bound."};
  app.add_option("--evaluations", evaluations, "of the cheapest bound; of others as many as take as long")
      ->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--only", only, "the bound of this name");
  CLI11_PARSE(app, argc, argv);
  std::printf("| what | bound | largest error / bound | evaluations |\n|---|---|---|---|\n");
  bool holds = true;
  for (const Bound& bound : kBounds) {
    if (!only.empty() && only != bound.name) continue;
    const std::int64_t count = std::max<std::int64_t>(evaluations / bound.cost, 1);
    const double largest = Climb(bound, seed).run(count);
    holds = holds && largest <= 1;
    std::printf("| %s | %s | %.3f | %lld |\n", bound.name, bound.where, largest, static_cast<long long>(count));
    std::fflush(stdout);
  }
  return holds ? 0 : 1;
}
