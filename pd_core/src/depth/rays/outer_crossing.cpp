#include "depth/rays/outer_crossing.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "structure/hierarchy/line_descent.hpp"

namespace pd::detail {

namespace {

enum class Verdict { meets, misses, unknown };

class ExactLine {
 public:
  ExactLine(const ConvexPolytope& polytope, const Vec3& point, const Vec3& direction)
      : polytope_(polytope),
        view_(polytope, point, direction),
        point_(to_dyadic(point)),
        direction_(to_dyadic(direction)),
        scale_(polytope.max_abs_coordinate() + point.cwiseAbs().maxCoeff()),
        length_(direction.cwiseAbs().maxCoeff()) {}

  struct Row {
    Dyadic slope, offset;
    /// The line does not pass this facet's halfspace, or only along its plane.
    [[nodiscard]] bool shuts_out() const { return slope.sign() == 0 && offset.sign() <= 0; }
  };

  [[nodiscard]] Row row(int facet) {
    ++steps_;
    const auto loop = polytope_.facet_vertices(facet);
    const Dyadic3 c = to_dyadic(polytope_.vertex(loop[0]));
    const Dyadic3 n = cross(to_dyadic(polytope_.vertex(loop[1])) - c, to_dyadic(polytope_.vertex(loop[2])) - c);
    return {dot(n, direction_), dot(n, c - point_)};
  }

  /// Whether the time of x is above, at or below that of y. Requires slopes other than 0.
  static int compare(const Row& x, const Row& y) {
    const int sign = (x.offset * y.slope - y.offset * x.slope).sign();
    return x.slope.sign() == y.slope.sign() ? sign : -sign;
  }

  /// The two facets prove that the line has left before it enters, or never passes.
  [[nodiscard]] bool proves_a_miss(int in, int out) {
    const Row leaving = row(out);
    if (leaving.slope.sign() <= 0) return leaving.shuts_out();
    const Row entering = row(in);
    return entering.slope.sign() < 0 && compare(entering, leaving) >= 0;
  }

  /// Goes on from `facet` to a neighbour that the line enters later, until there is none.
  [[nodiscard]] Verdict climb(int& facet) {
    Row here = row(facet);
    if (here.slope.sign() >= 0) return Verdict::unknown;
    for (;;) {
      const int before = facet;
      const Verdict verdict = look_round(facet, here);
      if (facet == before) return verdict;
    }
  }

  /// All facets: by which the line enters, -1 where it misses.
  [[nodiscard]] int scan() {
    int in = -1, out = -1;
    Row enters, leaves;
    for (int f = 0; f < polytope_.num_facets(); ++f) {
      Row r = row(f);
      if (r.shuts_out()) return -1;
      if (r.slope.sign() < 0 && (in < 0 || compare(r, enters) > 0)) {
        in = f;
        enters = std::move(r);
      } else if (r.slope.sign() > 0 && (out < 0 || compare(r, leaves) < 0)) {
        out = f;
        leaves = std::move(r);
      }
    }
    return compare(enters, leaves) < 0 ? in : -1;
  }

  [[nodiscard]] std::int64_t steps() const { return steps_; }

 private:
  /// Normals of a few ulp, four roundings and a quotient are wrong by less than 2e-15 of the lengths involved.
  static constexpr double kFilter = 1e-13;

  /// Judges by the neighbours of `facet`, whose row is `here`; goes to one that is entered later.
  [[nodiscard]] Verdict look_round(int& facet, Row& here) {
    LineView view = view_;
    view.stand_at(facet);
    const double steepness = 1 + 2 * length_ / std::abs(view.slope());
    const double slack = kFilter * steepness * (scale_ + length_ * std::abs(view.time()));
    std::array<int, 2> touching{};
    std::size_t touched = 0;
    const int first = polytope_.facet_half_edge(facet);
    int h = first;
    do {
      const int other = polytope_.half_edge(polytope_.half_edge(h).twin).facet;
      ++steps_;
      if (!(view.room(other) > slack)) {
        Row there = row(other);
        const Verdict verdict = judge(here, there);
        if (verdict == Verdict::misses) return verdict;
        if (verdict == Verdict::unknown) {
          facet = other;
          here = std::move(there);
          return verdict;
        }
        if (there.slope.sign() < 0 && compare(there, here) == 0) touching[touched++ % 2] = h;
      }
      h = polytope_.half_edge(h).next;
    } while (h != first);
    if (touched < 2) return Verdict::meets;
    // Two edges of a facet meet in a vertex only, where other facets may shut the line out.
    const bool in_order = polytope_.half_edge(touching[0]).next == touching[1];
    return passes_corner(here, polytope_.half_edge(touching[in_order ? 1 : 0]).origin);
  }

  /// Of a neighbour at the point of entry of `here`. Unknown: it is entered later.
  static Verdict judge(const Row& here, const Row& there) {
    if (there.slope.sign() == 0) return there.shuts_out() ? Verdict::misses : Verdict::meets;
    const int later = compare(there, here);
    if (there.slope.sign() > 0) return later <= 0 ? Verdict::misses : Verdict::meets;
    return later > 0 ? Verdict::unknown : Verdict::meets;
  }

  [[nodiscard]] Verdict passes_corner(const Row& here, int corner) {
    const int first = polytope_.first_half_edge(corner);
    for (std::size_t k = 0; k < polytope_.neighbours(corner).size(); ++k) {
      const Row there = row(polytope_.half_edge(first + static_cast<int>(k)).facet);
      if (judge(here, there) == Verdict::misses) return Verdict::misses;
    }
    return Verdict::meets;
  }

  const ConvexPolytope& polytope_;
  LineView view_;
  Dyadic3 point_, direction_;
  double scale_, length_;
  std::int64_t steps_ = 0;
};

}  // namespace

OuterCrossing cross_outer_hierarchy(const PolyhedralHierarchy& outer, const Vec3& point, const Vec3& direction) {
  OuterCrossing out;
  ExactLine line(outer.polytope(), point, direction);
  const LineEntry found = enter_outer_hierarchy(outer, point, direction);
  int facet = found.facet;
  Verdict verdict = Verdict::unknown;
  if (facet >= 0 && found.blocker < 0) {
    verdict = line.climb(facet);
  } else if (found.blocker >= 0 && line.proves_a_miss(facet, found.blocker)) {
    verdict = Verdict::misses;
  }
  if (verdict == Verdict::unknown) {
    ++out.repairs;
    facet = line.scan();
    verdict = facet >= 0 ? Verdict::meets : Verdict::misses;
  }
  if (verdict == Verdict::meets) {
    ExactLine::Row row = line.row(facet);
    out.entry = {std::move(row.offset), std::move(row.slope)};
  }
  out.steps = found.evaluations;
  out.certificate = line.steps();
  return out;
}

}  // namespace pd::detail
