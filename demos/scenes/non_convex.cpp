#include "scenes/non_convex.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace pd::scenes {

namespace {

PointPart placed_box(const Vec3& half_extents, const Vec3& centre) {
  return {box(half_extents), *Pose::from_matrix(Mat3::Identity(), centre)};
}

}  // namespace

PartList letter_l() { return {placed_box({2, 0.5, 0.5}, {0, 0, 0}), placed_box({0.5, 1, 0.5}, {-1.5, 1.5, 0})}; }

PartList letter_u(double opening) {
  const double x = opening / 2;
  return {placed_box({x + 1, 0.5, 1}, {0, -1.5, 0}), placed_box({0.5, 1, 1}, {-x - 0.5, 0, 0}),
          placed_box({0.5, 1, 1}, {x + 0.5, 0, 0})};
}

PartList cross() {
  return {placed_box({2, 0.5, 0.5}, {0, 0, 0}), placed_box({0.5, 2, 0.5}, {0, 0, 0}),
          placed_box({0.5, 0.5, 2}, {0, 0, 0})};
}

PartList dumbbell(int n, Random& random) {
  PartList parts;
  for (const double x : {-1.5, 1.5}) {
    parts.push_back({sphere_hull(n, random), random.pose({x, 0, 0})});
  }
  parts.push_back(placed_box({1.5, 0.25, 0.25}, {0, 0, 0}));
  return parts;
}

PartList stack(int layers, double height) {
  PartList parts;
  for (int k = 0; k < layers; ++k) {
    parts.push_back(placed_box({1, 1, height / 2}, {0, 0, height * (k - (layers - 1) / 2.0)}));
  }
  return parts;
}

PartList room(double half, double wall) {
  const double outside = half + wall, middle = half + wall / 2;
  PartList parts;
  for (const double s : {-1.0, 1.0}) {
    parts.push_back(placed_box({wall / 2, outside, outside}, {s * middle, 0, 0}));
    parts.push_back(placed_box({half, wall / 2, outside}, {0, s * middle, 0}));
    parts.push_back(placed_box({half, half, wall / 2}, {0, 0, s * middle}));
  }
  return parts;
}

PartList rubble(int parts, int n, Random& random) {
  PartList list;
  for (int k = 0; k < parts; ++k) {
    const double distance = random.uniform(0, 2);
    const Vec3 place = random.direction() * distance;
    list.push_back({sphere_hull(n, random), random.pose(place)});
  }
  return list;
}

Surface rough_ball(int levels, double roughness, Random& random) {
  // The icosahedron from the golden rectangle.
  const double g = (1 + std::sqrt(5.0)) / 2;
  Surface ball;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) {
      ball.vertices.push_back(Vec3(0, s, t).normalized());
      ball.vertices.push_back(Vec3(s, t, 0).normalized());
      ball.vertices.push_back(Vec3(t, 0, s).normalized());
    }
  }
  const double edge = 2.2 / std::sqrt(1 + g * g);
  const auto joined = [&](std::size_t i, std::size_t j) { return (ball.vertices[i] - ball.vertices[j]).norm() < edge; };
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!joined(i, j) || !joined(j, k) || !joined(i, k)) continue;
        const Vec3 &a = ball.vertices[i], &b = ball.vertices[j], &c = ball.vertices[k];
        const bool outwards = a.dot(b.cross(c)) > 0;
        const auto id = [](std::size_t v) { return static_cast<std::int32_t>(v); };
        ball.faces.push_back(outwards ? std::array{id(i), id(j), id(k)} : std::array{id(i), id(k), id(j)});
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [found, inserted] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(ball.vertices.size()));
      if (inserted) {
        ball.vertices.push_back(
            (ball.vertices[static_cast<std::size_t>(a)] + ball.vertices[static_cast<std::size_t>(b)]).normalized());
      }
      return found->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& f : ball.faces) {
      const std::int32_t ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], ab, ca}, {ab, f[1], bc}, {ca, bc, f[2]}, {ab, bc, ca}});
    }
    ball.faces = std::move(finer);
  }
  for (Vec3& v : ball.vertices) v *= random.uniform(1 - roughness, 1);
  return ball;
}

Surface spiked_star(double height) {
  Surface star;
  star.vertices = box({1, 1, 1});
  for (int axis = 0; axis < 3; ++axis) {
    for (int up = 0; up < 2; ++up) {
      const auto tip = static_cast<std::int32_t>(star.vertices.size());
      star.vertices.push_back(Vec3::Unit(axis) * (up == 1 ? 1 + height : -1 - height));
      // Corners of that face, counter-clockwise from outside.
      const int i = (axis + 1) % 3, j = (axis + 2) % 3;
      std::array<std::int32_t, 4> loop{};
      const std::array<std::array<int, 2>, 4> turns{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto& turn = turns[up == 1 ? k : 3 - k];
        loop[k] = up << axis | turn[0] << i | turn[1] << j;
      }
      for (std::size_t k = 0; k < 4; ++k) star.faces.push_back({loop[k], loop[(k + 1) % 4], tip});
    }
  }
  return star;
}

Surface star_prism(int k, double inner, Random& random) {
  Surface star;
  const int n = 2 * k;
  for (const double z : {-0.5, 0.5}) {
    for (int i = 0; i < n; ++i) {
      const Turn t = turn((i + 0.2 * random.uniform()) / n);
      const double r = i % 2 == 0 ? random.uniform(0.9, 1) : inner;
      star.vertices.push_back({r * t.cosine, r * t.sine, z});
    }
  }
  const std::int32_t bottom = 2 * n, top = bottom + 1;
  star.vertices.push_back({0, 0, -0.5});
  star.vertices.push_back({0, 0, 0.5});
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n;
    star.faces.push_back({i, j, n + i});
    star.faces.push_back({j, n + j, n + i});
    star.faces.push_back({j, i, bottom});
    star.faces.push_back({n + i, n + j, top});
  }
  return star;
}

}  // namespace pd::scenes
