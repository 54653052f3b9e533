#include "depth/pair/smooth_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/difference/barycentric.hpp"
#include "depth/distance/gjk_double_double.hpp"
#include "depth/expansion/expanding_hull.hpp"
#include "depth/expansion/expanding_polytope.hpp"

namespace pd::detail {

namespace {

constexpr double kDefaultDelta = 1e-6;
constexpr double kAbsolute = 1e-12;  ///< of L: where a bracket, and `touching`, stop

class SmoothQuery {
 public:
  SmoothQuery(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
              PenetrationDepth& out)
      : a_(a),
        b_(b),
        buffers_(buffers),
        out_(out),
        difference_(a, b, buffers.points),
        delta_(settings.delta > 0 ? settings.delta : kDefaultDelta),
        margin_(a.shape->margin() + b.shape->margin()) {}

  void solve() {
    out_.method = Method::expansion;
    const ExpansionResult core = expand();
    switch (core.status) {
      case ExpansionStatus::separated:
        solve_apart(core);
        return;
      case ExpansionStatus::touching:
        if (margin_ > 0) {
          solve_apart(core);
        } else {
          fill_touching(core.normal);
        }
        return;
      default:
        if (core.face >= 0 && core.lower > 0) {
          fill_overlapping(core);
        } else {
          solve_apart(core);
        }
    }
  }

 private:
  ExpansionResult expand() {
    ExpansionGoal goal;
    // With margins the error relative to core depth + margins is smaller still.
    goal.relative = delta_;
    goal.absolute = kAbsolute;
    goal.touching = kAbsolute;
    ExpandingPolytope<SmoothDifference> expansion(difference_, buffers_.surface, buffers_.stack);
    goal.max_loss = 4 * difference_.point_error();
    ExpansionResult best = expansion.run(Vec3::Zero(), goal);
    out_.statistics.support_calls += expansion.support_calls();
    out_.statistics.facets_visited += expansion.facets_visited();
    if (best.face >= 0) {
      const SurfaceTriangle& face = buffers_.surface.face(best.face);
      for (int i = 0; i < 3; ++i) corners_[i] = buffers_.surface.vertices[face.v[i]];
    }
    if (best.status != ExpansionStatus::undecided) return best;
    best = expand_exact_hull(difference_, buffers_.exact_hull, best.normal, goal, out_.statistics.support_calls,
                             buffers_.surface.watch);
    if (best.face >= 0) {
      const ExactHull::Face& face = buffers_.exact_hull.face(best.face);
      for (int i = 0; i < 3; ++i) {
        corners_[i] = buffers_.exact_hull.vertices[static_cast<std::size_t>(face.v[i])];
      }
    }
    return best;
  }

  /// Largest |coordinate| that the search has seen: L from below.
  double size() const {
    double largest = 0;
    for (const DifferenceVertex& v : buffers_.surface.vertices) largest = std::max(largest, v.x.cwiseAbs().maxCoeff());
    return std::max(largest, 0x1p-1000);
  }

  void fill_overlapping(const ExpansionResult& core) {
    out_.contact = ContactClass::overlapping;
    set_depth(core.lower + margin_, core.upper + margin_, core.normal);
    double weights[3];
    project_origin(corners_, core.normal, weights);
    set_witnesses(corners_, weights, 3);
    out_.witness_b = out_.witness_a + out_.translation;
  }

  void set_depth(double lower, double upper, const Vec3& normal) {
    out_.lower = std::max(0.0, lower * (1 - 0x1p-52));
    out_.depth = upper * (1 + 0x1p-52);
    out_.upper = upper * (1 + 0x1p-50);
    out_.normal = normal;
    out_.translation = out_.depth * normal;
  }

  void set_witnesses(const DifferenceVertex* corners, const double* weights, int count) {
    Vec3 a = Vec3::Zero();
    Vec3 b = Vec3::Zero();
    double total = 0;
    for (int i = 0; i < count; ++i) {
      const double w = std::max(0.0, weights[i]);
      a += w * difference_.points(corners[i]).a;
      b += w * difference_.points(corners[i]).b;
      total += w;
    }
    // Points are relative to the translation of A.
    out_.witness_a = a / total + a_.pose.translation() - a_.shape->margin() * out_.normal;
    out_.witness_b = b / total + a_.pose.translation() + b_.shape->margin() * out_.normal;
  }

  struct WayOut {
    Vec3 normal;
    double upper;
  };

  /// The least h(n) over the axes of both bodies: cores thinner than rounding leave the expansion without a facet, and
  /// what is that thin is thin along an axis of its own.
  WayOut thinnest_axis() const {
    WayOut best{Vec3::UnitX(), std::numeric_limits<double>::infinity()};
    for (const PosedShape* body : {&a_, &b_}) {
      const Mat3 rotation = body->pose.nearest_rotation();
      for (int axis = 0; axis < 6; ++axis) {
        const Vec3 n = axis < 3 ? Vec3(rotation.col(axis)) : Vec3(-rotation.col(axis - 3));
        const double h = difference_.support(n, nullptr).x.dot(n) + difference_.support_error();
        if (h < best.upper) best = {n, std::max(0.0, h)};
      }
    }
    return best;
  }

  void fill_touching(const Vec3& normal) {
    out_.contact = ContactClass::touching;
    out_.normal = normal;
    const DifferenceVertex s = difference_.support(normal, nullptr);
    const double one = 1;
    set_witnesses(&s, &one, 1);
    out_.witness_b = out_.witness_a;
  }

  /// The cores are apart, or so close that only their distance (within kAbsolute of zero) is known.
  void solve_apart(const ExpansionResult& core) {
    const DifferenceVertex first = difference_.support(core.normal, nullptr);
    const double relative = margin_ > 0 ? 0.0 : delta_;
    NearestResult nearest = nearest_point(difference_, {&first, 1}, relative, 0.25 * kAbsolute, buffers_.stack,
                                          out_.statistics.support_calls);
    Vec3 proven = nearest.normal;
    if (!nearest.certified) {
      const SmoothNearest near =
          smooth_nearest(difference_, first, relative, 0.25 * kAbsolute, out_.statistics.support_calls);
      nearest = near.nearest;
      proven = near.normal;
    }
    const double touching = kAbsolute * std::max(size(), nearest.point.cwiseAbs().maxCoeff());
    const bool directed = nearest.lower > 0;
    const Vec3 normal = directed ? proven : core.normal;
    const double round = 4 * 0x1p-53 * (nearest.upper + margin_);
    const double distance_lower = std::max(0.0, nearest.lower) - margin_ - round;
    const double distance_upper = nearest.upper - margin_ + round;
    if (distance_upper <= touching && distance_lower >= -touching) {
      fill_touching(normal);
      return;
    }
    if (distance_lower > 0 || distance_upper > touching) {
      out_.contact = ContactClass::separated;
      out_.normal = normal;
      set_witnesses(nearest.simplex, nearest.weights, nearest.count);
      out_.distance_lower = std::max(0.0, distance_lower);
      out_.distance_upper = distance_upper;
      out_.distance = std::clamp((out_.witness_a - out_.witness_b).norm(), out_.distance_lower, out_.distance_upper);
      return;
    }
    out_.contact = ContactClass::overlapping;
    // The cores' signed distance is at most h(normal), certified by the expansion where they are not apart.
    WayOut out{normal, directed ? -nearest.lower : std::max(0.0, core.upper)};
    if (!std::isfinite(out.upper)) out = thinnest_axis();
    set_depth(margin_ - nearest.upper, margin_ + out.upper, out.normal);
    set_witnesses(nearest.simplex, nearest.weights, nearest.count);
    out_.witness_b = out_.witness_a + out_.translation;
  }

  const PosedShape& a_;
  const PosedShape& b_;
  ScratchBuffers& buffers_;
  PenetrationDepth& out_;
  SmoothDifference difference_;
  double delta_;
  double margin_;
  DifferenceVertex corners_[3];  ///< of the nearest face
};

}  // namespace

void smooth_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                  PenetrationDepth& out) {
  SmoothQuery(a, b, settings, buffers, out).solve();
}

}  // namespace pd::detail
