// Sums and hulls with intersections inside, as points and halfspaces, against supports found by brute force.
//
// PD_COMPOSED_CASES=N takes N bodies a dimension of the plane and space instead of 60 and 20.

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <optional>

#include "dimension/body_families.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::test {
namespace {

template <int D>
using Planes = std::vector<Halfspace<D>>;

template <int D>
ComposedBody<D> prepared(const Expected<Body<D>>& body, double epsilon, Backend backend) {
  EXPECT_TRUE(body) << (body ? "" : body.error().message);
  const auto structure = DirectionalWidth<D>::build(*body, epsilon, backend);
  EXPECT_TRUE(structure) << (structure ? "" : structure.error().message);
  return *ComposedBody<D>::of(*structure);
}

/// A cube about `centre` and a few planes more that cut it, turned; squeezed along one axis where `thin` < 1.
template <int D>
Planes<D> cut_cube(BodySource<D>& source, const Vector<D>& centre, double thin) {
  const Matrix<D> turn = source.rotation();
  Planes<D> r;
  for (int i = 0; i < D; ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Vector<D> n = sign * turn.col(i);
      r.push_back({n, n.dot(centre) + (i == 0 ? thin : 1.0)});
    }
  }
  for (int i = 0; i < (D < 4 ? 4 : 2); ++i) {
    const Vector<D> n = source.direction();
    r.push_back({n, n.dot(centre) + source.uniform(0.5, 1.2)});
  }
  return r;
}

/// Every D planes meet in a point; those in all halfspaces are the vertices.
template <int D>
std::vector<Vector<D>> vertices(const Planes<D>& planes) {
  std::vector<Vector<D>> r;
  std::array<std::size_t, D> choice;
  for (std::size_t i = 0; i < D; ++i) choice[i] = i;
  while (true) {
    Matrix<D> normals;
    Vector<D> offsets;
    for (int i = 0; i < D; ++i) {
      normals.row(i) = planes[choice[std::size_t(i)]].normal;
      offsets[i] = planes[choice[std::size_t(i)]].offset;
    }
    if (const auto inverse = inverse_if_regular<D>(normals)) {
      const Vector<D> x = *inverse * offsets;
      bool inside = true;
      for (const Halfspace<D>& h : planes) inside = inside && h.normal.dot(x) <= h.offset + 1e-10;
      if (inside) r.push_back(x);
    }
    int at = D - 1;
    while (at >= 0 && choice[std::size_t(at)] == planes.size() - std::size_t(D - at)) --at;
    if (at < 0) return r;
    ++choice[std::size_t(at)];
    for (int i = at + 1; i < D; ++i) choice[std::size_t(i)] = choice[std::size_t(i - 1)] + 1;
  }
}

template <int D>
double reach(const ApproximateBody<D>& body, const std::optional<Body<D>>& polytope, const Vector<D>& v) {
  return polytope ? polytope->support(v).value : extreme<D>(body.points, v).dot(v);
}

/// Of every representation and side, in random directions. `truth` returns h.
template <int D, class Support>
void check_promises(const ComposedBody<D>& whole, double epsilon, BodySource<D>& source, const Support& truth) {
  for (const auto representation : {Representation::points, Representation::halfspaces}) {
    for (const Side side : {Side::inner, Side::outer}) {
      const auto made = approximate_minkowski_sum<D>(whole, epsilon, representation, side);
      ASSERT_TRUE(made) << made.error().message;
      std::optional<Body<D>> polytope;
      if (representation == Representation::halfspaces) {
        const auto body = Body<D>::from_halfspaces(made->body.halfspaces);
        ASSERT_TRUE(body) << body.error().message;
        polytope = *body;
      }
      for (int turn = 0; turn < 8; ++turn) {
        const Vector<D> v = source.direction();
        const double width = truth(v) + truth(-v);
        const double room = 1e-6 * width + 1e-9;
        const double high = reach<D>(made->body, polytope, v);
        if (side == Side::outer) {
          EXPECT_GE(high, truth(v) - room);
          EXPECT_LE(high, truth(v) + epsilon / 2 * width + room);
        } else {
          EXPECT_LE(high, truth(v) + room);
          EXPECT_GE(high + reach<D>(made->body, polytope, Vector<D>(-v)), (1 - epsilon) * width - room);
        }
      }
    }
  }
}

int cases(int usual) {
  const char* const asked = std::getenv("PD_COMPOSED_CASES");
  return asked == nullptr ? usual : std::atoi(asked);
}

/// (A and B) + C and hull of (A and B) and C; A and B overlap by much or by little.
template <int D>
void check_intersections(Backend backend, double epsilon, int count, unsigned seed) {
  BodySource<D> source(seed);
  int checked = 0;
  for (int k = 0; checked < count && k < 4 * count; ++k) {
    SCOPED_TRACE(testing::Message() << "D = " << D << ", body " << k);
    const bool hull = k % 3 == 2;
    const double thin = k % 4 == 3 ? 0.1 : 1;
    Planes<D> both = cut_cube<D>(source, Vector<D>::Zero(), thin);
    const Planes<D> second = cut_cube<D>(source, source.uniform(0, D < 4 ? 1.2 : 0.4) * source.direction(), 1);
    const double share = epsilon / (hull ? 2000 : 400);
    const auto a = prepared<D>(Body<D>::from_halfspaces(both), share, backend);
    const auto b = prepared<D>(Body<D>::from_halfspaces(second), share, backend);
    both.insert(both.end(), second.begin(), second.end());
    const std::vector<Vector<D>> shared = vertices<D>(both);
    // Those too thin for a quick test are for the tests of refusals.
    double least = std::numeric_limits<double>::infinity();
    for (const Halfspace<D>& h : both) least = std::min(least, shared.empty() ? 0.0 : extent<D>(shared, h.normal));
    if (!(least > 0.05)) continue;
    ++checked;
    const std::vector<Vector<D>> third = source.points(k % 2 == 0 ? Family::simplex : Family::cube, 0);
    const auto c = prepared<D>(Body<D>::from_points(third), share, backend);
    const auto meet = *ComposedBody<D>::intersection_of({a, b});
    const auto whole = hull ? *ComposedBody<D>::hull_of({c, meet}) : *ComposedBody<D>::sum_of({meet, c});
    check_promises<D>(whole, epsilon, source, [&](const Vector<D>& v) {
      const double h = extreme<D>(shared, v).dot(v);
      const double other = extreme<D>(third, v).dot(v);
      return hull ? std::max(h, other) : h + other;
    });
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_EQ(checked, count);
}

TEST(IntersectionsInSums, KeepTheirPromises) {
  check_intersections<2>(Backend::kernel, 0.02, cases(60), 21);
  check_intersections<2>(Backend::exact, 0.1, cases(20), 22);
  check_intersections<3>(Backend::kernel, 0.1, cases(20), 23);
  check_intersections<4>(Backend::kernel, 0.4, 3, 24);
  check_intersections<5>(Backend::kernel, 0.8, 2, 25);
}

/// Sums and intersections of boxes with common axes are such boxes: the corners of any tree of them are known.
template <int D>
struct Box {
  ComposedBody<D> body;
  Vector<D> low;
  Vector<D> high;
};

template <int D>
Box<D> random_tree(BodySource<D>& source, const Matrix<D>& axes, int deep) {
  if (deep == 0) {
    Vector<D> middle, half;
    for (int i = 0; i < D; ++i) {
      middle[i] = source.uniform(-0.3, 0.3);
      half[i] = source.uniform(0.5, 1.5);
    }
    std::vector<Vector<D>> corners;
    for (int k = 0; k < (1 << D); ++k) {
      Vector<D> p = middle;
      for (int i = 0; i < D; ++i) p[i] += ((k >> i) & 1) != 0 ? half[i] : -half[i];
      corners.push_back(axes * p);
    }
    return {prepared<D>(Body<D>::from_points(corners), 1e-5, Backend::kernel), middle - half, middle + half};
  }
  std::vector<Box<D>> parts;
  const int count = 2 + int(source.uniform(0, 1.999)) * (deep == 1 ? 1 : 0);
  for (int i = 0; i < count; ++i) parts.push_back(random_tree<D>(source, axes, deep - 1));
  const bool meet = source.uniform(0, 1) < 0.5;
  std::vector<ComposedBody<D>> bodies = {parts[0].body};
  Vector<D> low = parts[0].low, high = parts[0].high;
  for (int i = 1; i < count; ++i) {
    const Box<D>& part = parts[std::size_t(i)];
    bodies.push_back(part.body);
    low = meet ? Vector<D>(low.cwiseMax(part.low)) : Vector<D>(low + part.low);
    high = meet ? Vector<D>(high.cwiseMin(part.high)) : Vector<D>(high + part.high);
  }
  return {meet ? *ComposedBody<D>::intersection_of(bodies) : *ComposedBody<D>::sum_of(bodies), low, high};
}

template <int D>
void check_trees(double epsilon, int count, unsigned seed) {
  BodySource<D> source(seed);
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE(testing::Message() << "D = " << D << ", tree " << k);
    Matrix<D> axes = source.rotation();
    for (int i = 0; i < D; ++i) axes.col(i) *= source.uniform(0.2, 2);
    const Box<D> tree = random_tree<D>(source, axes, 1 + k % 3);
    if (!((tree.high - tree.low).minCoeff() > 0.05)) continue;
    check_promises<D>(tree.body, epsilon, source, [&](const Vector<D>& v) {
      double h = 0;
      for (int i = 0; i < D; ++i) h += std::max(axes.col(i).dot(v) * tree.low[i], axes.col(i).dot(v) * tree.high[i]);
      return h;
    });
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(IntersectionsInSums, TreesOfBoxes) {
  check_trees<2>(0.05, cases(60), 31);
  check_trees<3>(0.05, cases(40), 32);
  check_trees<4>(0.2, 6, 33);
}

TEST(IntersectionsInSums, ThinIntersectionsAreRelativeToThemselves) {
  // Two squares that share a strip of one thousandth: h of the strip within 1 % of the strip.
  const auto square = [](double x) {
    const std::vector<Vector<2>> corners = {{x, 0}, {x + 1, 0}, {x + 1, 1}, {x, 1}};
    return prepared<2>(Body<2>::from_points(corners), 1e-7, Backend::kernel);
  };
  const auto strip = *ComposedBody<2>::intersection_of({square(0), square(0.999)});
  const auto made = approximate_minkowski_sum<2>(strip, 0.01, Representation::points);
  ASSERT_TRUE(made) << made.error().message;
  double low = 2, high = 0;
  for (const Vector<2>& p : made->body.points) {
    low = std::min(low, p[0]);
    high = std::max(high, p[0]);
  }
  EXPECT_LE(low, 0.999 + 1e-9);
  EXPECT_GE(low, 0.999 - 0.5e-5 - 1e-9);
  EXPECT_GE(high, 1 - 1e-9);
  EXPECT_LE(high, 1 + 0.5e-5 + 1e-9);
}

TEST(IntersectionsInSums, RefusesByName) {
  const auto square = [](double x, double epsilon) {
    const std::vector<Vector<2>> corners = {{x, 0}, {x + 1, 0}, {x + 1, 1}, {x, 1}};
    return prepared<2>(Body<2>::from_points(corners), epsilon, Backend::kernel);
  };
  const auto refusal = [&](double x, double structure, double epsilon) {
    const auto both = *ComposedBody<2>::intersection_of({square(0, structure), square(x, structure)});
    const auto whole = *ComposedBody<2>::sum_of({both, square(0, structure)});
    const auto made = approximate_minkowski_sum<2>(whole, epsilon, Representation::points);
    EXPECT_FALSE(made);
    return made ? Error{ErrorCode::unsupported, "", ""} : made.error();
  };
  EXPECT_EQ(refusal(1.5, 1e-6, 0.1).code, ErrorCode::bad_value);
  EXPECT_EQ(refusal(1.5, 1e-6, 0.1).where, "");
  EXPECT_EQ(refusal(0.5, 0.1, 0.1).where, "epsilon");
  EXPECT_EQ(refusal(0.5, 1e-7, 2e-6).where, "epsilon");
  EXPECT_EQ(refusal(1, 1e-7, 0.1).code, ErrorCode::not_full_dimensional);
}

}  // namespace
}  // namespace pd::dimension::test
