/// @file
/// Solids whose answers are known another way: cells of a grid as a mesh and as a union of boxes, and stars.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "pd/shape/compound.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/shape/star_body.hpp"

namespace pd::test {

struct Mesh {
  std::vector<Vec3> points;
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> corners;

  void add(std::initializer_list<std::int32_t> loop) {
    corners.insert(corners.end(), loop);
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  [[nodiscard]] MeshView view() const { return {points, offsets, corners}; }
};

using Cells = std::set<std::array<int, 3>>;

/// The surface of a set of unit cells, as squares.
inline Mesh mesh_of(const Cells& cells) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::int32_t> ids;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, fresh] = ids.try_emplace(at, static_cast<std::int32_t>(mesh.points.size()));
    if (fresh) mesh.points.emplace_back(at[0], at[1], at[2]);
    return found->second;
  };
  for (const auto& cell : cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        auto beyond = cell;
        beyond[axis] += side == 0 ? -1 : 1;
        if (cells.count(beyond) != 0) continue;
        std::array<std::int32_t, 4> loop{};
        for (std::size_t k = 0; k < 4; ++k) {
          auto at = cell;
          at[axis] += side;
          at[(axis + 1) % 3] += k == 1 || k == 2;
          at[(axis + 2) % 3] += k == 2 || k == 3;
          loop[side == 1 ? k : 3 - k] = vertex(at);
        }
        mesh.add({loop[0], loop[1], loop[2], loop[3]});
      }
    }
  }
  return mesh;
}

/// The union of boxes that the cells are.
inline Compound boxes_of(const Cells& cells) {
  std::vector<Compound::Part> parts;
  for (const auto& cell : cells) {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k) corners.emplace_back(cell[0] + (k & 1), cell[1] + (k >> 1 & 1), cell[2] + (k >> 2));
    parts.push_back({*ConvexPolytope::from_points(corners), Pose()});
  }
  return *Compound::from_parts(std::move(parts));
}

/// A set of `count` cells in which each has a neighbour, and whose surface is manifold.
inline Cells random_cells(std::mt19937_64& random, int count, const std::array<int, 3>& start = {0, 0, 0}) {
  for (;;) {
    Cells cells{start};
    while (static_cast<int>(cells.size()) < count) {
      auto at = *std::next(cells.begin(), static_cast<std::ptrdiff_t>(random() % cells.size()));
      at[random() % 3] += random() % 2 == 0 ? -1 : 1;
      cells.insert(at);
    }
    if (MeshSolid::from_faces(mesh_of(cells).view())) return cells;
  }
}

inline MeshSolid solid_of(const Mesh& mesh) {
  Expected<MeshSolid> solid = MeshSolid::from_faces(mesh.view());
  if (!solid) throw std::runtime_error(solid.error().message);
  return *std::move(solid);
}

/// The cells as a mesh in which each is divided `fine` times along each axis.
inline MeshSolid fine_solid(const Cells& cells, int fine) {
  Cells out;
  for (const auto& [x, y, z] : cells) {
    for (int i = 0; i < fine * fine * fine; ++i) {
      out.insert({fine * x + i % fine, fine * y + i / fine % fine, fine * z + i / fine / fine});
    }
  }
  Mesh mesh = mesh_of(out);
  for (Vec3& p : mesh.points) p /= fine;
  return solid_of(mesh);
}

/// An octahedron, its faces divided `times` times into four, whose corners stand at random distances from the centre.
inline StarBody random_star(std::mt19937_64& random, int times, const Vec3& centre) {
  std::vector<Vec3> points = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
                              -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  std::vector<StarBody::Triangle> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                           {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t p, std::int32_t q) {
      const auto [found, fresh] = middles.try_emplace(std::minmax(p, q), static_cast<std::int32_t>(points.size()));
      if (fresh)
        points.push_back((points[static_cast<std::size_t>(p)] + points[static_cast<std::size_t>(q)]).normalized());
      return found->second;
    };
    std::vector<StarBody::Triangle> finer;
    for (const auto& f : faces) {
      const std::int32_t u = middle(f[0], f[1]), v = middle(f[1], f[2]), w = middle(f[2], f[0]);
      for (const auto& t : {StarBody::Triangle{f[0], u, w}, {u, f[1], v}, {w, v, f[2]}, {u, v, w}}) finer.push_back(t);
    }
    faces = std::move(finer);
  }
  std::uniform_real_distribution<double> radius(0.4, 1.2);
  for (Vec3& p : points) p = centre + radius(random) * p;
  return *StarBody::from_faces(points, faces, centre);
}

inline Mesh mesh_of(const StarBody& star) {
  Mesh mesh;
  mesh.points = star.vertices();
  for (const auto& f : star.faces()) mesh.add({f[0], f[1], f[2]});
  return mesh;
}

}  // namespace pd::test
