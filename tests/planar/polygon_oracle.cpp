#include "planar/polygon_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace oracle {

namespace {

constexpr double kZero = 1e-9;
constexpr double kNear = 1e-7;  // of a placement to the places that stand for its surroundings

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1]}; }
Vec plus(const Vec& a, const Vec& b, double s = 1) { return {a[0] + s * b[0], a[1] + s * b[1]}; }
double cross(const Vec& a, const Vec& b) { return a[0] * b[1] - a[1] * b[0]; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1]; }
double norm(const Vec& a) { return std::sqrt(dot(a, a)); }

double area(const std::vector<Vec>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) sum += cross(ring[i], ring[(i + 1) % ring.size()]);
  return sum;
}

}  // namespace

PolygonOracle::PolygonOracle(const Rings& p, const Rings& q) {
  for (const auto& [rings, edges] : {std::pair{&p, &p_}, std::pair{&q, &q_}}) {
    for (std::size_t r = 0; r < rings->size(); ++r) {
      std::vector<Vec> ring = (*rings)[r];
      if ((area(ring) > 0) != (r == 0)) std::reverse(ring.begin(), ring.end());
      for (std::size_t i = 0; i < ring.size(); ++i) edges->push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
  }
  std::vector<double> angles;
  for (const auto* edges : {&p_, &q_}) {
    for (const Segment& e : *edges) {
      const Vec d = minus(e.b, e.a);
      angles.push_back(std::atan2(d[1], d[0]));
      angles.push_back(std::atan2(-d[1], -d[0]));
    }
  }
  std::sort(angles.begin(), angles.end());
  angles.erase(std::unique(angles.begin(), angles.end(), [](double a, double b) { return b - a < kZero; }),
               angles.end());
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double next = i + 1 < angles.size() ? angles[i + 1] : angles[0] + 2 * M_PI;
    if (next - angles[i] < kZero) continue;
    const double middle = 0.5 * (angles[i] + next);
    directions_.push_back({std::cos(middle), std::sin(middle)});
  }
  for (const Segment& e : p_) {
    for (const Segment& f : q_) {
      contacts_.push_back({minus(e.a, f.a), minus(e.b, f.a)});  // Q's vertex on P's edge
      contacts_.push_back({minus(e.a, f.a), minus(e.a, f.b)});  // P's vertex on Q's edge
    }
  }
}

namespace {

struct Side {
  bool inside, on;
  Vec along;  ///< direction of the edge it lies on
};

template <class Segments>
Side locate(const Segments& edges, const Vec& shift, const Vec& x) {
  bool inside = false;
  for (const auto& e : edges) {
    const Vec a = plus(e.a, shift), b = plus(e.b, shift), d = minus(b, a);
    const double s = dot(minus(x, a), d) / dot(d, d);
    if (std::abs(cross(d, minus(x, a))) / norm(d) < kNear * 1e-2 && s > -kZero && s < 1 + kZero) {
      return {false, true, d};
    }
    if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
  }
  return {inside, false, {}};
}

}  // namespace

// Every edge is split where the other polygon's edges cross or end on it. If the interiors meet, the middle of some
// piece lies inside the other polygon, or on an edge of it with the interiors on one side.
bool PolygonOracle::overlap(const Vec& y) const {
  for (const bool first : {true, false}) {
    const auto& mine = first ? p_ : q_;
    const auto& other = first ? q_ : p_;
    const Vec my_shift = first ? Vec{0, 0} : y, other_shift = first ? y : Vec{0, 0};
    for (const Segment& e : mine) {
      const Vec a = plus(e.a, my_shift), d = minus(e.b, e.a);
      std::vector<double> cuts = {0, 1};
      for (const Segment& f : other) {
        const Vec c = plus(f.a, other_shift), g = minus(f.b, f.a);
        const double w = cross(d, g);
        if (std::abs(w) > kZero) {
          const double s = cross(minus(c, a), g) / w, t = cross(minus(c, a), d) / w;
          if (s > 0 && s < 1 && t > -kZero && t < 1 + kZero) cuts.push_back(s);
        } else {
          for (const Vec& end : {c, plus(c, g)}) {
            const double s = dot(minus(end, a), d) / dot(d, d);
            if (s > 0 && s < 1) cuts.push_back(s);
          }
        }
      }
      std::sort(cuts.begin(), cuts.end());
      for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i + 1] - cuts[i] < kZero) continue;
        const Side side = locate(other, other_shift, plus(a, d, 0.5 * (cuts[i] + cuts[i + 1])));
        if (side.inside || (side.on && std::abs(cross(side.along, d)) < kZero && dot(side.along, d) > 0)) return true;
      }
    }
  }
  return false;
}

std::array<int, 2> PolygonOracle::sectors(const Vec& y) const {
  int overlapping = 0;
  for (const Vec& d : directions_) overlapping += overlap(plus(y, d, kNear)) ? 1 : 0;
  return {overlapping, static_cast<int>(directions_.size())};
}

bool PolygonOracle::interior(const Vec& y) const {
  return std::all_of(directions_.begin(), directions_.end(), [&](const Vec& d) { return overlap(plus(y, d, kNear)); });
}

std::string PolygonOracle::contact(const Vec& y) const {
  const auto [overlapping, all] = sectors(y);
  return overlapping == all ? "overlapping" : (overlapping == 0 ? "separated" : "touching");
}

std::vector<Vec> PolygonOracle::places(const Vec& y) const {
  std::vector<Vec> places;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Segment& e = contacts_[i];
    const Vec d = minus(e.b, e.a);
    places.push_back(e.a);
    places.push_back(e.b);
    const double s = dot(minus(y, e.a), d) / dot(d, d);
    if (s > 0 && s < 1) places.push_back(plus(e.a, d, s));
    for (std::size_t j = 0; j < i; ++j) {
      const Segment& f = contacts_[j];
      const Vec g = minus(f.b, f.a);
      const double w = cross(d, g);
      if (std::abs(w) < kZero) continue;
      const double a = cross(minus(f.a, e.a), g) / w, b = cross(minus(f.a, e.a), d) / w;
      if (a > -kZero && a < 1 + kZero && b > -kZero && b < 1 + kZero) places.push_back(plus(e.a, d, a));
    }
  }
  return places;
}

std::vector<Vec> PolygonOracle::seats() const {
  std::vector<Vec> places = this->places({0, 0});
  std::sort(places.begin(), places.end());
  std::vector<Vec> found;
  for (const Vec& x : places) {
    const auto near = [&](const Vec& y) { return norm(minus(x, y)) < kZero; };
    if (std::any_of(found.begin(), found.end(), near)) continue;
    if (!overlap(x) && interior(x)) found.push_back(x);
  }
  return found;
}

double PolygonOracle::depth(const Vec& y) const {
  std::vector<Vec> places = this->places(y);
  std::sort(places.begin(), places.end(),
            [&](const Vec& a, const Vec& b) { return norm(minus(a, y)) < norm(minus(b, y)); });
  for (const Vec& x : places) {
    if (!interior(x)) return norm(minus(x, y));
  }
  return 0;
}

std::vector<double> PolygonOracle::critical(const Vec& y, const Vec& d) const {
  std::vector<double> times = {0};
  const auto add = [&](double t) {
    if (t > 0) times.push_back(t);
  };
  for (const Segment& e : contacts_) {
    const Vec g = minus(e.b, e.a);
    const double w = cross(d, g);
    if (std::abs(w) > kZero) {
      const double s = cross(minus(e.a, y), d) / w;
      if (s > -kZero && s < 1 + kZero) add(cross(minus(e.a, y), g) / w);
    } else if (std::abs(cross(minus(e.a, y), d)) < kZero) {
      for (const Vec& end : {e.a, e.b}) add(dot(minus(end, y), d) / dot(d, d));
    }
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < kZero; }), times.end());
  return times;
}

double PolygonOracle::depth_along(const Vec& y, const Vec& d) const {
  const std::vector<double> times = critical(y, d);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!interior(plus(y, d, times[i]))) return times[i] * norm(d);
    if (i + 1 < times.size() && !interior(plus(y, d, 0.5 * (times[i] + times[i + 1])))) return times[i] * norm(d);
  }
  return times.back() * norm(d);
}

double PolygonOracle::straight_exit(const Vec& y, const Vec& d) const {
  const std::vector<double> times = critical(y, d);
  for (std::size_t i = times.size() - 1; i > 0; --i) {
    if (interior(plus(y, d, 0.5 * (times[i] + times[i - 1])))) return times[i] * norm(d);
  }
  return 0;
}

double PolygonOracle::straight_escape(const Vec& y) const {
  double least = std::numeric_limits<double>::infinity();
  std::vector<Vec> places = this->places(y);
  std::sort(places.begin(), places.end());
  places.erase(
      std::unique(places.begin(), places.end(), [](const Vec& a, const Vec& b) { return norm(minus(a, b)) < kZero; }),
      places.end());
  for (const Vec& x : places) {
    const Vec d = minus(x, y);
    if (norm(d) > kZero && contact(x) == "touching") least = std::min(least, straight_exit(y, d));
  }
  // A place on the boundary may be left square to a contact through it.
  if (contact(y) == "touching") {
    for (const Segment& e : contacts_) {
      const Vec d = minus(e.b, e.a);
      least = std::min({least, straight_exit(y, {d[1], -d[0]}), straight_exit(y, {-d[1], d[0]})});
    }
  }
  return least;
}

}  // namespace oracle
