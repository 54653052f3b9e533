/// @file
/// The promises of [M]'s Lemmas 6, 13 and 16 and Theorems 2 and 3 on random and adversarial bodies, judged by scans of
/// the input. (Lemma 5: sizes.cpp. Theorem 1: intersection.cpp.) One broken promise is a wrong answer.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "bench/arya/arya.hpp"
#include "bench/arya/clouds.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/width.hpp"
#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/approximate_intersection.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"
#include "pd/dimension/approximate_width.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::bench {

namespace {

using dimension::ApproximateBody;
using dimension::Backend;
using dimension::Body;
using dimension::ComposedBody;
using dimension::DirectionalWidth;
using dimension::Representation;
using dimension::Side;
using dimension::Vector;

const Claim kEllipsoid{"Lemma 6, promise", "every point in the outer ellipsoid, whose ratio is at most d (1 + eta)"};
const Claim kMembership{"Lemma 13, promise", "yes for points of the body, no for points outside the grown one"};
const Claim kApproximation{"Lemma 16, promise", "inside or outside as asked, within epsilon, in both representations"};
const Claim kSum{"Theorem 2, promise", "inside or outside as asked, within epsilon, in both representations"};
const Claim kWidth{"Theorem 3, promise", "lower <= width <= upper <= (1 + epsilon) lower"};

constexpr std::array kFamilies = {Cloud::sphere, Cloud::ball,    Cloud::box, Cloud::needle,
                                  Cloud::slab,   Cloud::simplex, Cloud::cube};

struct Extent {
  double least, most;
  [[nodiscard]] double width() const { return most - least; }
};

template <int D>
Extent extent(std::span<const Vector<D>> points, const Vector<D>& v) {
  Extent r{INFINITY, -INFINITY};
  for (const Vector<D>& p : points) {
    r.least = std::min(r.least, p.dot(v));
    r.most = std::max(r.most, p.dot(v));
  }
  return r;
}

/// Roundings of the scans, and of a program over halfspaces, in units of the width; of the coordinates themselves.
double room(const Extent& e) { return 1e-7 * e.width() + 1e-14 * std::max(std::abs(e.least), std::abs(e.most)); }

/// Directions random as seen from outside and from where the body is fat, in turn.
template <int D>
Vector<D> tried(const Body<D>& body, int k, std::mt19937_64& random) {
  const Vector<D> v = direction<D>(random);
  if (k % 2 == 0) return v;
  const Vector<D> fat = body.sandwich().fattening().linear.transpose() * v;
  return fat / fat.norm();
}

template <int D>
class Judge {
 public:
  Judge(const AryaSettings& settings, int bodies)
      : random_(settings.seed + 100 + D), bodies_(bodies), backend_(settings.backend.value_or(Backend::kernel)) {
    for (int k = 0; k < 2 * static_cast<int>(kFamilies.size()); ++k) others_.push_back(prepare(body(k), least() / 4));
  }

  void run(ClaimTable& table) {
    for (int k = 0; k < bodies_; ++k) {
      const double epsilon = this->epsilon();
      const Prepared a = prepare(body(k), epsilon / 4);
      const Representation representation = k % 4 < 2 ? Representation::points : Representation::halfspaces;
      const Side side = k % 2 == 0 ? Side::outer : Side::inner;
      // Neither of these two asks a structure.
      if (backend_ == Backend::kernel) {
        ellipsoid(a.body);
        approximation(a.body, representation, side);
      }
      membership(a, epsilon);
      sum(a, others_[random_() % others_.size()], epsilon, representation, side);
      width(a.body);
    }
    const std::string name = fmt::format("{}, seven families, d = {}", to_string(backend_), D);
    const std::string range = fmt::format("{} bodies", bodies_);
    for (const auto& [claim, wrong] :
         {std::pair{&kEllipsoid, ellipsoids_}, std::pair{&kMembership, memberships_},
          std::pair{&kApproximation, approximations_}, std::pair{&kSum, sums_}, std::pair{&kWidth, widths_}}) {
      if (backend_ != Backend::kernel && (claim == &kEllipsoid || claim == &kApproximation)) continue;
      table.add_value(*claim, name, std::string(kWrongAnswers), range, static_cast<double>(wrong), 0);
    }
    table.add_value(kSum, name, "refused", range, static_cast<double>(refused_), 0);
  }

 private:
  struct Prepared {
    Body<D> body;
    DirectionalWidth<D> structure;
  };
  Prepared prepare(const Body<D>& body, double epsilon) {
    return {body, *DirectionalWidth<D>::build(body, epsilon, backend_)};
  }
  Body<D> body(int k) {
    const Cloud kind = kFamilies[static_cast<std::size_t>(k) % kFamilies.size()];
    return *Body<D>::from_points(cloud<D>(kind, 12 + (1 << D) + random_() % 40, random_));
  }
  /// Coarse where fine ones take seconds: in four and five dimensions, and of Macbeath regions already in three.
  [[nodiscard]] double least() const {
    if (backend_ == Backend::macbeath) return D == 2 ? 0.05 : D == 3 ? 0.4 : D == 4 ? 0.7 : 0.9;
    return D == 2 ? 1e-3 : D == 3 ? 3e-2 : D == 4 ? 0.2 : 0.4;
  }
  double epsilon() {
    const double most = std::max(0.8, least() + 0.05);
    return least() * std::pow(most / least(), std::abs(uniform(random_)));
  }

  void ellipsoid(const Body<D>& a) {
    const double eta = std::pow(10.0, -3 * std::abs(uniform(random_)));
    const auto e = dimension::enclosing_ellipsoid<D>(a.points(), eta);
    bool good = e && e->sandwich.ratio <= D * (1 + eta) * (1 + 1e-9);
    if (good) {
      const auto fat = e->sandwich.fattening();
      for (const Vector<D>& p : a.points()) {
        const double reach = (fat.linear * (p - e->sandwich.centre)).norm();
        good = good && reach <= e->sandwich.ratio * (1 + 1e-6);
      }
      // The inner ellipsoid's supports lie within the body's.
      for (int k = 0; k < 6; ++k) {
        const Vector<D> v = tried<D>(a, k, random_);
        const Extent whole = extent<D>(a.points(), v);
        const double inner = (e->sandwich.axes.transpose() * v).norm();
        good = good && e->sandwich.centre.dot(v) + inner <= whole.most + room(whole);
      }
    }
    ellipsoids_ += good ? 0 : 1;
  }

  void membership(const Prepared& prepared, double epsilon) {
    const Body<D>& a = prepared.body;
    const auto whole = *ComposedBody<D>::of(prepared.structure);
    // A mixture of points, drawn nearly to one of them; and a point just beyond the slab of the grown body.
    const Vector<D>& tip = a.points()[random_() % a.points().size()];
    const Vector<D>& other = a.points()[random_() % a.points().size()];
    const Vector<D> inside = tip + std::pow(10.0, -9 * std::abs(uniform(random_))) * (other - tip);
    const auto yes = dimension::approximate_membership<D>(whole, inside, epsilon);
    const Vector<D> v = tried<D>(a, static_cast<int>(random_() % 2), random_);
    const Extent e = extent<D>(a.points(), v);
    const Vector<D> outside = inside + (e.most - inside.dot(v) + 0.5001 * epsilon * e.width() + room(e)) * v;
    const auto no = dimension::approximate_membership<D>(whole, outside, epsilon);
    memberships_ += yes && yes->intersect && no && !no->intersect ? 0 : 1;
  }

  /// Whether K' is on its side of K, and within epsilon, where K is the sum of the parts.
  bool holds(const ApproximateBody<D>& made, std::span<const Body<D>* const> parts, double epsilon, Side side) {
    const auto whole = [&](const Vector<D>& v) {
      Extent sum{0, 0};
      for (const Body<D>* part : parts) {
        const Extent e = extent<D>(part->points(), v);
        sum = {sum.least + e.least, sum.most + e.most};
      }
      return sum;
    };
    std::optional<Body<D>> polytope;
    if (made.representation == Representation::halfspaces) {
      const auto built = Body<D>::from_halfspaces(made.halfspaces);
      if (!built) return false;
      polytope = *built;
      // Outer: every plane is beyond the sum, to rounding.
      for (const auto& h : made.halfspaces) {
        const Extent e = whole(h.normal);
        if (side == Side::outer && e.most > h.offset + room(e)) return false;
      }
    }
    const auto reach = [&](const Vector<D>& v) {
      return polytope ? polytope->support(v).value : extent<D>(made.points, v).most;
    };
    for (int k = 0; k < 6; ++k) {
      const Vector<D> v = tried<D>(*parts[0], k, random_);
      const Extent e = whole(v);
      const double high = reach(v);
      if (side == Side::outer) {
        if (high < e.most - room(e) || high > e.most + epsilon / 2 * e.width() + room(e)) return false;
      } else if (high > e.most + room(e) || high + reach(-v) < (1 - epsilon) * e.width() - room(e)) {
        return false;
      }
    }
    return true;
  }

  void approximation(const Body<D>& a, Representation representation, Side side) {
    const double epsilon = this->epsilon();
    const auto made = dimension::approximate_body<D>(a, epsilon, representation, side);
    const std::array<const Body<D>*, 1> parts = {&a};
    approximations_ += made && holds(*made, parts, epsilon, side) ? 0 : 1;
  }

  void sum(const Prepared& a, const Prepared& b, double epsilon, Representation representation, Side side) {
    const auto whole = *ComposedBody<D>::sum_of({*ComposedBody<D>::of(a.structure), *ComposedBody<D>::of(b.structure)});
    const auto made = dimension::approximate_minkowski_sum<D>(whole, epsilon, representation, side);
    if (!made) {
      ++refused_;
      return;
    }
    const std::array<const Body<D>*, 2> parts = {&a.body, &b.body};
    sums_ += holds(made->body, parts, epsilon, side) ? 0 : 1;
  }

  void width(const Body<D>& a) {
    const double epsilon = this->epsilon();
    const auto found = dimension::approximate_width<D>(a, epsilon, backend_);
    bool good = found && found->lower <= found->upper && found->upper <= (1 + epsilon) * found->lower;
    if (good) {
      const Extent own = extent<D>(a.points(), found->direction);
      good = std::abs(own.width() - found->upper) <= room(own);
      for (int k = 0; k < 20; ++k) {
        const Extent e = extent<D>(a.points(), tried<D>(a, k, random_));
        good = good && e.width() + room(e) >= found->lower;
      }
      if constexpr (D == 3) good = good && exact_agrees(a, *found);
    }
    widths_ += good ? 0 : 1;
  }

  /// The exact width, from the facets and edges of the hull.
  bool exact_agrees(const Body<3>& a, const dimension::ApproximateWidth<3>& found) {
    const auto hull = ConvexPolytope::from_points(std::vector<Vec3>(a.points().begin(), a.points().end()));
    if (!hull) return false;
    const ConvexShape shape(*hull);
    const Width exact = pd::width({&shape, {}}, scratch_);
    const Extent e = extent<3>(a.points(), found.direction);
    return found.lower <= exact.upper + room(e) && exact.lower <= found.upper + room(e);
  }

  std::mt19937_64 random_;
  int bodies_;
  Backend backend_;
  std::vector<Prepared> others_;  ///< as fine as any epsilon asks: the sums' second bodies
  Scratch scratch_;
  std::int64_t ellipsoids_ = 0, memberships_ = 0, approximations_ = 0, sums_ = 0, widths_ = 0, refused_ = 0;
};

}  // namespace

void measure_arya_theorems(const AryaSettings& settings, ClaimTable& table) {
  const int many = settings.pairs > 0 ? settings.pairs : settings.full ? 100'000 : 500;
  const int few = settings.full ? std::max(300, settings.pairs / 100) : 6;
  Judge<2>(settings, many).run(table);
  Judge<3>(settings, many).run(table);
  if (settings.backend == Backend::exact) return;  // of two and three dimensions
  Judge<4>(settings, few).run(table);
  Judge<5>(settings, few).run(table);
}

}  // namespace pd::bench
