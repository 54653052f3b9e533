/// @file
/// The regular icosahedron inscribed in the unit sphere: where coverings of the sphere by triangles start.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

struct Icosahedron {
  std::array<Vec3, 12> vertices;  ///< vertex 11 - i is the antipode of vertex i
  /// Counter-clockwise from outside. Face 19 - f is antipodal to face f: the first ten cover the sphere up to sign.
  std::array<std::array<std::int32_t, 3>, 20> faces;
};

inline Icosahedron icosahedron() {
  const double golden = (1 + std::sqrt(5.0)) / 2;
  const double scale = 1 / std::sqrt(1 + golden * golden);
  const double s = scale, l = golden * scale;
  Icosahedron body;
  // Cyclic permutations of (0, +-1, golden), then their antipodes in reverse.
  const std::array<Vec3, 6> half{Vec3(0, s, l),  Vec3(0, -s, l), Vec3(s, l, 0),
                                 Vec3(-s, l, 0), Vec3(l, 0, s),  Vec3(-l, 0, s)};
  for (std::size_t i = 0; i < 6; ++i) {
    body.vertices[i] = half[i];
    body.vertices[11 - i] = -half[i];
  }
  // Three vertices are a face where they are neighbours, which the cosine 1 / sqrt(5) tells.
  const auto joined = [&](int i, int j) {
    return body.vertices[static_cast<std::size_t>(i)].dot(body.vertices[static_cast<std::size_t>(j)]) > 0.25;
  };
  std::size_t count = 0;
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!joined(i, j) || !joined(j, k) || !joined(i, k) || i + j + k > 16) continue;
        const Vec3& p = body.vertices[static_cast<std::size_t>(i)];
        const bool outward =
            p.dot(body.vertices[static_cast<std::size_t>(j)].cross(body.vertices[static_cast<std::size_t>(k)])) > 0;
        body.faces[count] = outward ? std::array<std::int32_t, 3>{i, j, k} : std::array<std::int32_t, 3>{i, k, j};
        // The antipodes 11 - v, with the orientation turned back.
        const auto& f = body.faces[count];
        body.faces[19 - count] = {11 - f[0], 11 - f[2], 11 - f[1]};
        ++count;
      }
    }
  }
  return body;
}

}  // namespace pd::detail
