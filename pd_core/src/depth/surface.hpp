/// @file
/// A closed triangulated surface round the origin that grows towards the boundary of P: the working set of best-first
/// expansion.
///
/// Why it proves anything: the surface is closed and oriented by construction (every edge is shared by two triangles
/// that run along it in opposite senses). If every triangle has the origin strictly behind it, each contributes a
/// positive solid angle, so the winding number of the surface round the origin is at least 1, and the same round every
/// point of the ball that no triangle reaches; a point with non-zero winding number lies in the convex hull of the
/// surface. Hence that ball lies in P. Neither convexity nor exact visibility is needed.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "depth/polytope_difference.hpp"

namespace pd::detail {

struct SurfaceFace {
  Vec3 normal;          ///< cross product of two edges, outward, any length
  double level;         ///< max over the three vertices of <x, normal>: what a visible point must exceed
  std::int32_t v[3];    ///< counter-clockwise from outside
  std::int32_t adj[3];  ///< across the edge v[i] -> v[i + 1]: 4 * face + its edge
};

/// Signed squared distance of a face's plane, a monotone stand-in for the distance that needs no root.
inline constexpr double kRemoved = std::numeric_limits<double>::infinity();

class Surface {
 public:
  std::vector<DifferenceVertex> vertices;
  std::vector<SurfaceFace> faces;  ///< the first slots() are in use or free, the rest is room
  /// Lower bound of the face's distance from the origin, as sign * square; kRemoved for a free slot. NaN never.
  std::vector<double> keys;

  void clear();
  /// Takes over faces and their neighbours as they were cached; planes come with `refresh`.
  template <class CachedFaces>
  void restore(const CachedFaces& cached) {
    reserve_faces(static_cast<int>(cached.size()));
    for (const auto& from : cached) {
      const int f = new_face();
      for (int i = 0; i < 3; ++i) {
        faces[f].v[i] = from.vertex[i];
        faces[f].adj[i] = from.neighbour[i];
      }
      keys[f] = 0;
    }
  }
  /// The inverse: the faces in use and the vertices that they use, numbered anew.
  template <class CachedVertices, class CachedFaces>
  void save(CachedVertices& cached_vertices, CachedFaces& cached_faces) {
    face_numbers_.assign(static_cast<std::size_t>(slots_), -1);
    vertex_numbers_.assign(vertices.size(), -1);
    std::int16_t next_face = 0;
    std::int16_t next_vertex = 0;
    for (int f = 0; f < slots_; ++f) {
      if (keys[f] == kRemoved) continue;
      face_numbers_[f] = next_face++;
      for (const std::int32_t v : faces[f].v) {
        if (vertex_numbers_[v] >= 0) continue;
        vertex_numbers_[v] = next_vertex++;
        cached_vertices.push_back({vertices[v].a, vertices[v].b});
      }
    }
    for (int f = 0; f < slots_; ++f) {
      if (keys[f] == kRemoved) continue;
      const SurfaceFace& face = faces[f];
      cached_faces.push_back({{vertex_numbers_[face.v[0]], vertex_numbers_[face.v[1]], vertex_numbers_[face.v[2]]},
                              {renumbered(face.adj[0]), renumbered(face.adj[1]), renumbered(face.adj[2])}});
    }
  }
  /// Four faces on vertices 0..3. False when their volume is not positive for certain (`flat` = 6 volumes' error
  /// bound).
  bool start_tetrahedron(double flat);
  /// Recomputes every plane and key from the vertices (after they moved).
  void refresh();
  /// The face with the least key.
  [[nodiscard]] int nearest();
  /// Replaces the faces that see vertex `v`, flooding from face `from`, by a fan. False (and unchanged but for marks)
  /// when what is seen from v is no disc: rounding, or a surface that has become too crooked.
  bool insert(int from, int v);
  /// Number of faces in use.
  [[nodiscard]] int size() const { return in_use_; }
  [[nodiscard]] int slots() const { return slots_; }

 private:
  [[nodiscard]] std::int16_t renumbered(std::int32_t adjacent) const {
    return static_cast<std::int16_t>(4 * face_numbers_[adjacent >> 2] + (adjacent & 3));
  }
  void set_plane(int f);
  /// Room for so many faces beyond those in use: `new_face` takes it for granted.
  void reserve_faces(int more);
  int new_face();

  struct Horizon {
    std::int32_t outside;   ///< 4 * face + edge of the face that stays
    std::int32_t from, to;  ///< the edge as the removed side runs along it
  };
  struct HeapEntry {
    double key;
    std::int32_t face;
    std::uint32_t stamp;
  };
  void push_heap(int f);

  std::vector<std::uint32_t> stamps_;  ///< counts the lives of a slot
  std::vector<std::int32_t> free_;
  std::vector<Horizon> horizon_;
  std::vector<std::int32_t> horizon_from_;  ///< by vertex: the horizon edge that leaves it
  std::vector<std::int32_t> removed_;
  std::vector<HeapEntry> heap_;
  std::vector<std::int16_t> face_numbers_;
  std::vector<std::int16_t> vertex_numbers_;
  bool heap_active_ = false;
  int slots_ = 0;
  int in_use_ = 0;
};

}  // namespace pd::detail
