#include "depth/facets/closest_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/arc_crossing.hpp"

namespace pd::detail {

namespace {

/// Largest product of the sizes of two nodes that is tried pair by pair.
constexpr std::int64_t kLeafPairs = 16;

/// Blocks in random order: so many are made before the order is drawn.
constexpr std::size_t kRandomBlocks = 64;

/// |t0| at most this much below 1, so that the tangent's slope stays below 2^12.
constexpr double kParallel = 0x1p-24;

class DualTree {
 public:
  DualTree(const OverlayWalk& walk, double unit, ClosestLinesBuffers& buffers, PlaneSearch& search,
           ClosestLinesCounts& counts)
      : walk_(walk),
        buffers_(buffers),
        a_(buffers.a),
        b_(buffers.b),
        search_(search),
        counts_(counts),
        unit_(unit),
        rounding_(0x1p-46 * std::max(1.0, a_.largest() * b_.largest())) {}

  void run(std::uint64_t seed) {
    std::vector<Block>& stack = buffers_.stack;
    stack.assign(1, {0, 0});
    // Breadth first at the beginning, then block by block in random order.
    std::size_t done = 0;
    while (done < stack.size() && stack.size() - done < kRandomBlocks) {
      const Block block = stack[done++];
      handle(block);
    }
    stack.erase(stack.begin(), stack.begin() + static_cast<std::ptrdiff_t>(done));
    for (std::size_t i = stack.size(); i > 1; --i) std::swap(stack[i - 1], stack[draw(seed) % i]);
    while (!stack.empty()) {
      const Block block = stack.back();
      stack.pop_back();
      handle(block);
    }
  }

 private:
  using Block = ClosestLinesBuffers::Block;

  /// SplitMix64.
  static std::uint64_t draw(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  void handle(const Block& block) {
    const LineTree::Node& x = b_.node(block.b);
    const LineTree::Node& y = a_.node(block.a);
    if (x.slabs.apart_from(y.slabs) || in_one_facet(x.facets, y.facets)) return;
    if (x.size() * y.size() <= kLeafPairs || (x.is_leaf() && y.is_leaf())) {
      try_pairs(x, y);
      return;
    }
    ++counts_.block_bounds;
    if (too_far(x, y)) return;
    if (y.is_leaf() || (!x.is_leaf() && x.size() >= y.size())) {
      const int left = b_.children(block.b);
      buffers_.stack.push_back({left, block.a});
      buffers_.stack.push_back({left + 1, block.a});
    } else {
      const int left = a_.children(block.a);
      buffers_.stack.push_back({block.b, left});
      buffers_.stack.push_back({block.b, left + 1});
    }
  }

  /// r, a little enlarged, in the trees' lengths.
  [[nodiscard]] double radius() const { return search_.upper() / unit_ * (1 + 8 * kUnitRoundoff); }

  static double cosine(const Line6& b, const Line6& a) { return b[0] * a[3] + b[1] * a[4] + b[2] * a[5]; }

  void try_pairs(const LineTree::Node& x, const LineTree::Node& y) {
    counts_.pair_evaluations += x.size() * y.size();
    double r = radius();
    for (std::int32_t i = x.first; i < x.last; ++i) {
      const Line6& u = b_.line(i);
      for (std::int32_t j = y.first; j < y.last; ++j) {
        const Line6& v = a_.line(j);
        const double least = std::abs(dot(u, v)) - rounding_;
        const double t = cosine(u, v);
        const double most = r * r * (std::max(0.0, 1 - t * t) + 4 * rounding_);
        if (least > 0 && least * least > most * (1 + 8 * kUnitRoundoff)) continue;
        if (b_.slabs(i).apart_from(a_.slabs(j)) || in_one_facet(b_.facets(i), a_.facets(j))) continue;
        const Range distance = measure(i, j);
        if (distance.lower > r) continue;
        const std::optional<OverlayPiece> piece = edge_crossing(walk_, a_.half_edge(j), b_.half_edge(i));
        if (!piece) continue;
        if (distance.lower > 0) {
          search_.offer(*piece, distance.lower * unit_ * (1 - 2 * kUnitRoundoff),
                        distance.upper * unit_ * (1 + 2 * kUnitRoundoff));
        } else {
          search_.consume(std::span<const OverlayPiece>(&*piece, 1));
        }
        r = radius();
      }
    }
  }

  struct Range {
    double lower;
    double upper;
  };
  /// Bounds of the distance |<w, n>| of two lines, w = p - p' and n = d x d' / |d x d'|: where n errs by an angle of at
  /// most phi it errs by |w_tangential| phi + |<w, n>| phi^2 / 2, which is little for a plane about a point near its
  /// foot.
  [[nodiscard]] Range measure(std::int32_t i, std::int32_t j) const {
    const Line6& u = b_.line(i);
    const Line6& v = a_.line(j);
    const Vec3 n = Vec3(u[0], u[1], u[2]).cross(Vec3(v[3], v[4], v[5]));
    const double sine = n.norm();
    // A coordinate of n errs by 2 sqrt(2) kDirectionError and the rounding of two products of at most 1.
    const double phi = (8 * LineTree::kDirectionError + 16 * kUnitRoundoff) / sine;
    if (!(phi < 0.1)) return {0, std::numeric_limits<double>::infinity()};
    const Vec3 w = b_.point(i) - a_.point(j);
    const double distance = std::abs(w.dot(n)) / sine;
    const double tangential = w.cross(n).norm() / sine;
    const double error = 1.01 * phi * (tangential + phi * distance) + 2 * LineTree::kPointError + 16 * kUnitRoundoff;
    return {distance - error, distance + error};
  }

  /// The bilinear form s N + kappa t.
  struct Form {
    double s;
    double kappa;
    /// As a functional on lines of B, one of A given.
    [[nodiscard]] Line6 on_b(const Line6& a) const {
      return {s * a[0] + kappa * a[3], s * a[1] + kappa * a[4], s * a[2] + kappa * a[5], s * a[3], s * a[4], s * a[5]};
    }
    /// As a functional on lines of A, one of B given.
    [[nodiscard]] Line6 on_a(const Line6& b) const {
      return {s * b[0], s * b[1], s * b[2], s * b[3] + kappa * b[0], s * b[4] + kappa * b[1], s * b[5] + kappa * b[2]};
    }
  };

  /// |z - <z, v> v| for a unit v (or zero).
  static double beyond(const Line6& z, const Line6& v) {
    const double along = dot(z, v);
    return std::sqrt(std::max(0.0, dot(z, z) - along * along)) + 0x1p-26 * std::abs(along);
  }

  /// Whether no line of x and line of y can be as close as the least distance so far.
  bool too_far(const LineTree::Node& x, const LineTree::Node& y) {
    const double r = radius();
    if (!(r < 4)) return false;
    const double n = dot(x.centre, y.centre);
    const double t = std::clamp(cosine(x.centre, y.centre), -1 + kParallel, 1 - kParallel);
    const double d = std::sqrt((1 - t) * (1 + t));
    const Form form{n < 0 ? -1.0 : 1.0, r * t / d};
    const Line6 on_b = form.on_b(y.centre);
    const Line6 on_a = form.on_a(x.centre);
    const double error = (1 + std::abs(form.kappa)) * rounding_;
    const double middle = dot(x.centre, on_b) - r * (d + t * t / d) - error;
    if (!(middle > 0)) return false;

    // Terms beyond both chords, with the residuals of A's lines or of B's on the left out of the scan.
    const Line6 chord_on_a = form.on_a(x.chord);
    const Line6 chord_on_b = form.on_b(y.chord);
    const double norm = 1 + std::abs(form.kappa);
    const double reach_x = std::max(-x.low, x.high);
    const double reach_y = std::max(-y.low, y.high);
    const double rest_y = (reach_x * beyond(chord_on_a, y.chord) + x.residual * norm) * y.residual;
    const double rest_x = (reach_y * beyond(chord_on_b, x.chord) + y.residual * norm) * x.residual;
    const double rest = std::min(rest_x, rest_y);
    const double left = middle - rest;
    if (!(left > 0)) return false;

    // Cheap bounds from chords alone, either way.
    const double along_x = dot(on_b, x.chord), along_y = dot(on_a, y.chord);
    const double least_x = std::min(along_x * x.low, along_x * x.high);
    const double least_y = std::min(along_y * y.low, along_y * y.high);
    const double side_x = x.residual * beyond(on_b, x.chord), side_y = y.residual * beyond(on_a, y.chord);
    const double twist = std::abs(dot(chord_on_a, y.chord)) * reach_x * reach_y +
                         reach_x * beyond(chord_on_a, y.chord) * y.residual +
                         reach_y * beyond(chord_on_b, x.chord) * x.residual + x.residual * y.residual * norm;
    if (middle + least_x + least_y - side_x - side_y - twist > 0) return true;
    if (left + least_x + side_x + least_y + side_y <= 0) return false;

    return rest_y <= rest_x ? scan(b_, x, on_b, chord_on_b, a_, y, on_a, left)
                            : scan(a_, y, on_a, chord_on_a, b_, x, on_b, left);
  }

  /// Whether left + min over lines e of x and e' of y of <e, f> + <e', h> + b' <e, g> > 0, the lines taken from their
  /// centres, b' = <e', chord of y>.
  bool scan(const LineTree& tree_x, const LineTree::Node& x, const Line6& f, const Line6& g, const LineTree& tree_y,
            const LineTree::Node& y, const Line6& h, double left) {
    counts_.lines_scanned += (x.last - x.first) + (y.last - y.first);
    const auto count = static_cast<std::size_t>(x.last - x.first);
    if (buffers_.values.size() < count) {
      buffers_.values.resize(count);
      buffers_.slopes.resize(count);
    }
    double* const values = buffers_.values.data();
    double* const slopes = buffers_.slopes.data();
    const double f0 = dot(x.centre, f), g0 = dot(x.centre, g);
    double flattest = std::numeric_limits<double>::infinity();
    double steepest = -flattest;
    const Line6* line = &tree_x.line(x.first);
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = dot(line[i], f) - f0;
      const double slope = dot(line[i], g) - g0;
      slopes[i] = slope;
      flattest = std::min(flattest, slope);
      steepest = std::max(steepest, slope);
    }
    const double h0 = dot(y.centre, h), b0 = dot(y.centre, y.chord);
    double at_flattest = std::numeric_limits<double>::infinity();
    double at_steepest = at_flattest;
    for (std::int32_t j = y.first; j < y.last; ++j) {
      const Line6& other = tree_y.line(j);
      const double value = dot(other, h) - h0;
      const double along = dot(other, y.chord) - b0;
      at_flattest = std::min(at_flattest, value + flattest * along);
      at_steepest = std::min(at_steepest, value + steepest * along);
    }
    const double range = steepest - flattest;
    const double inverse = range > 0 ? 1 / range : 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (slopes[i] - flattest) * inverse;
      least = std::min(least, values[i] + (at_flattest + share * (at_steepest - at_flattest)));
    }
    return left + least > 0;
  }

  const OverlayWalk& walk_;
  ClosestLinesBuffers& buffers_;
  LineTree& a_;
  LineTree& b_;
  PlaneSearch& search_;
  ClosestLinesCounts& counts_;
  double unit_;
  double rounding_;  ///< of a product of two lines, for itself and for the errors of both (some 60u of their lengths)
};

}  // namespace

void offer_closest_lines(const OverlayWalk& walk, double unit, std::uint64_t seed, ClosestLinesBuffers& buffers,
                         PlaneSearch& search, ClosestLinesCounts& counts) {
  if (buffers.a.empty() || buffers.b.empty()) return;
  DualTree(walk, unit, buffers, search, counts).run(seed);
}

}  // namespace pd::detail
