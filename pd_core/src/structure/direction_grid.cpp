#include "pd/structure/direction_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "structure/icosahedron.hpp"

namespace pd {

namespace {

constexpr double kPi = 3.14159265358979323846;
/// Whatever a caller allows: numbers of rows and of steps stay in the range of int.
constexpr std::int64_t kMostDirections = std::int64_t{1} << 30;
constexpr double kRounding = 1e-14;  ///< of cosines computed from unit vectors, with room

/// sin and cos by Taylor's series: the libraries' own differ between machines.
double sine(double x) {
  double term = x, sum = x;
  for (int k = 1; k <= 20; ++k) sum += term *= -x * x / (2 * k * (2 * k + 1));
  return sum;
}
double cosine(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k <= 20; ++k) sum += term *= -x * x / ((2 * k - 1) * 2 * k);
  return sum;
}

/// sqrt(2 delta)'s exact counterpart, arccos(1 / (1 + delta)), rounded down a little: 2 arcsin(sqrt(c / 2)) with c = 1
/// - 1 / (1 + delta), by Newton's method on our own sine.
double covering_radius(double delta) {
  const double half = std::sqrt(delta / (2 * (1 + delta)));
  double x = half;
  for (int i = 0; i < 60; ++i) x -= (sine(x) - half) / cosine(x);
  return 2 * x * (1 - 1e-12);
}

// ---- geodesic -------------------------------------------------------------------------------------------------------

/// The subdivision of a face: corner weights sin(w i / f), so that the triangles' sizes differ little.
class Subdivision {
 public:
  explicit Subdivision(int frequency) : frequency_(frequency) {
    // The icosahedron's edge subtends arccos(1 / sqrt 5) = arctan 2.
    constexpr double kEdge = 1.10714871779409050302;
    for (int i = 0; i <= frequency; ++i) weights_.push_back(sine(kEdge * i / frequency));
  }

  [[nodiscard]] int frequency() const { return frequency_; }
  [[nodiscard]] Vec3 point(const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) const {
    const auto weight = [&](int k) { return weights_[static_cast<std::size_t>(k)]; };
    return (weight(i) * a + weight(j) * b + weight(frequency_ - i - j) * c).normalized();
  }

  /// The least distance of a triangle's plane from the origin; all faces are alike.
  [[nodiscard]] double inradius() const {
    const detail::Icosahedron body = detail::icosahedron();
    const Vec3& a = body.vertices[static_cast<std::size_t>(body.faces[0][0])];
    const Vec3& b = body.vertices[static_cast<std::size_t>(body.faces[0][1])];
    const Vec3& c = body.vertices[static_cast<std::size_t>(body.faces[0][2])];
    const auto at = [&](int i, int j) { return point(a, b, c, i, j); };
    const auto distance = [](const Vec3& p, const Vec3& q, const Vec3& r) {
      const Vec3 n = (q - p).cross(r - p);
      return std::abs(n.dot(p)) / n.norm();
    };
    double least = 1;
    for (int i = 0; i < frequency_; ++i) {
      for (int j = 0; i + j < frequency_; ++j) {
        least = std::min(least, distance(at(i, j), at(i + 1, j), at(i, j + 1)));
        if (i + j + 1 < frequency_) least = std::min(least, distance(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)));
      }
    }
    return least - kRounding;
  }

  [[nodiscard]] std::vector<Vec3> points(std::size_t faces) const {
    const detail::Icosahedron body = detail::icosahedron();
    const auto vertex = [&](std::int32_t v) { return body.vertices[static_cast<std::size_t>(v)]; };
    std::vector<Vec3> points;
    std::array<bool, 12> seen_vertices{};
    std::map<std::pair<std::int32_t, std::int32_t>, bool> seen_edges;
    for (std::size_t f = 0; f < faces; ++f) {
      const auto& face = body.faces[f];
      for (std::size_t k = 0; k < 3; ++k) {
        if (!std::exchange(seen_vertices[static_cast<std::size_t>(face[k])], true)) points.push_back(vertex(face[k]));
        const auto [from, to] = std::minmax(face[k], face[(k + 1) % 3]);
        if (std::exchange(seen_edges[{from, to}], true)) continue;
        for (int i = 1; i < frequency_; ++i) {
          points.push_back(point(vertex(from), vertex(to), Vec3::Zero(), i, frequency_ - i));
        }
      }
      for (int i = 1; i < frequency_; ++i) {
        for (int j = 1; i + j < frequency_; ++j) {
          points.push_back(point(vertex(face[0]), vertex(face[1]), vertex(face[2]), i, j));
        }
      }
    }
    return points;
  }

 private:
  int frequency_;
  std::vector<double> weights_;
};

Error too_many(double delta, double needed, std::int64_t limit) {
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "delta = %g needs about %g", delta, needed);
  return {ErrorCode::limit_exceeded,
          std::string(numbers) + " directions, more than the " + std::to_string(limit) +
              " allowed; a larger delta needs 1 / delta of them",
          "delta"};
}

[[gnu::cold]] Expected<DirectionGrid> geodesic_grid(double delta, GridExtent extent, std::int64_t limit) {
  // f^2 delta lies between 0.26 (the limit) and 0.31 (f = 1).
  const double faces = extent == GridExtent::sphere ? 20 : 10;
  const double start = std::max(1.0, std::floor(std::sqrt(0.25 / delta)));
  const double needed = faces / 2 * start * start;
  if (!(needed <= static_cast<double>(limit))) return too_many(delta, needed, limit);
  int frequency = static_cast<int>(start);
  for (;; ++frequency) {
    const Subdivision subdivision(frequency);
    const double inradius = subdivision.inradius();
    if (inradius * (1 + delta) < 1) continue;
    DirectionGrid grid{subdivision.points(static_cast<std::size_t>(faces)), inradius};
    if (static_cast<std::int64_t>(grid.directions.size()) > limit) return too_many(delta, needed, limit);
    return grid;
  }
}

// ---- latitude and longitude -----------------------------------------------------------------------------------------

Expected<DirectionGrid> latitude_longitude_grid(double delta, GridExtent extent, std::int64_t limit) {
  // A cell measures pi / k in latitude and 2 pi / k in longitude: half its diagonal is sqrt(5) pi / (2 k).
  const double radius = covering_radius(delta);
  const double exact = std::ceil(std::sqrt(5.0) * kPi / (2 * radius));
  if (!(exact * exact <= 2 * static_cast<double>(limit))) return too_many(delta, exact * exact, limit);
  const int k = static_cast<int>(exact);
  const int rows = extent == GridExtent::sphere ? k : (k + 1) / 2;
  DirectionGrid grid;
  grid.cosine = cosine(std::sqrt(5.0) * kPi / (2 * k)) - kRounding;
  for (int i = 0; i <= rows; ++i) {
    const double latitude = kPi * i / k;
    const bool pole = i == 0 || i == k;
    const double across = pole ? 0 : sine(latitude);
    const double up = i == 0 ? 1 : i == k ? -1 : cosine(latitude);
    for (int j = 0; j < (pole ? 1 : k); ++j) {
      const double longitude = 2 * kPi * j / k - kPi;
      grid.directions.emplace_back(across * cosine(longitude), across * sine(longitude), up);
    }
  }
  if (static_cast<std::int64_t>(grid.directions.size()) > limit) return too_many(delta, exact * exact, limit);
  return grid;
}

}  // namespace

Expected<DirectionGrid> direction_grid(GridKind kind, double delta, GridExtent extent, std::int64_t max_directions) {
  if (!(delta > 0 && delta <= 1)) return Error{ErrorCode::bad_value, "delta must lie in (0, 1]", "delta"};
  const detail::FloatingPointGuard guard;
  const std::int64_t limit = std::min(max_directions, kMostDirections);
  return kind == GridKind::geodesic ? geodesic_grid(delta, extent, limit)
                                    : latitude_longitude_grid(delta, extent, limit);
}

}  // namespace pd
