/// @file
/// A closed triangulated surface inside P that grows towards the boundary of P: what an expanding polytope works on.
///
/// Why it proves anything: the surface is closed and oriented by construction (every edge is shared by two triangles
/// that run along it in opposite senses). If every triangle has the origin strictly behind it, each contributes a
/// positive solid angle, so the winding number of the surface around the origin is at least 1, and the same around
/// every point of the ball that no triangle reaches; a point with non-zero winding number lies in the convex hull of
/// the surface. Hence that ball lies in P. Neither convexity nor exact visibility is needed.
/// That is why it stands beside the exact hulls, whose steps cost microseconds: planes and visibility are computed in
/// doubles, four at a time.
///
/// By file: storage (inner_surface.cpp), insertion of a point (inner_surface_insert.cpp), repair of a surface whose
/// points have moved (inner_surface_rebuild.cpp).
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/plane_kernels.hpp"
#include "depth/expansion/search_report.hpp"
#include "depth/expansion/surface_check.hpp"
#include "depth/expansion/tetrahedron.hpp"

namespace pd::detail {

struct SurfaceTriangle {
  std::int32_t v[3];    ///< counter-clockwise from outside
  std::int32_t adj[3];  ///< across the edge v[i] -> v[i + 1]: 4 * triangle + its edge
};

/// The distance of which a key is sign * square.
inline double signed_root(double key) { return key >= 0 ? std::sqrt(key) : -std::sqrt(-key); }

/// The edges of a triangle after and before edge e.
constexpr std::int32_t next_edge(std::int32_t e) { return e == 2 ? 0 : e + 1; }
constexpr std::int32_t last_edge(std::int32_t e) { return e == 0 ? 2 : e - 1; }

class InnerSurface {
 public:
  /// The key of a slot without a face.
  static constexpr double kRemoved = std::numeric_limits<double>::infinity();

  std::vector<DifferenceVertex> vertices;
  SearchWatch watch;  ///< of the expansions on this surface

  [[nodiscard]] const SurfaceTriangle& face(int f) const { return triangles_[f]; }
  /// Cross product of two edges, outward, any length.
  [[nodiscard]] Vec3 normal(int f) const { return {nx_[f], ny_[f], nz_[f]}; }
  /// Lower bound of the face's signed distance from the origin, as sign * square: a monotone stand-in that needs no
  /// root; kRemoved for a free slot. NaN never.
  [[nodiscard]] double key(int f) const { return keys_[f]; }

  void clear();
  /// Takes over faces and their neighbours as they were cached, with planes through the vertices as they are now.
  template <class CachedFaces>
  void restore(const CachedFaces& cached) {
    reserve(static_cast<int>(cached.size()));
    for (const auto& from : cached) {
      SurfaceTriangle& to = triangles_[slots_++];
      for (int i = 0; i < 3; ++i) {
        to.v[i] = from.vertex[i];
        to.adj[i] = from.neighbour[i];
      }
    }
    in_use_ = slots_;
    compute_planes();
  }
  /// The inverse: the faces in use and the vertices that they use, numbered anew.
  template <class CachedVertices, class CachedFaces>
  void save(CachedVertices& cached_vertices, CachedFaces& cached_faces) {
    face_numbers_.resize(static_cast<std::size_t>(slots_));
    vertex_numbers_.assign(vertices.size(), -1);
    std::int16_t next_face = 0;
    std::int16_t next_vertex = 0;
    cached_vertices.clear();
    for (int f = 0; f < slots_; ++f) {
      if (keys_[f] == kRemoved) continue;
      face_numbers_[f] = next_face++;
      for (const std::int32_t v : triangles_[f].v) {
        if (vertex_numbers_[v] >= 0) continue;
        cached_vertices.push_back({vertices[v].a, vertices[v].b});
        vertex_numbers_[v] = next_vertex++;
      }
    }
    cached_faces.resize(next_face);
    auto* to = cached_faces.data();
    for (int f = 0; f < slots_; ++f) {
      if (keys_[f] == kRemoved) continue;
      const SurfaceTriangle& face = triangles_[f];
      for (int i = 0; i < 3; ++i) {
        to->vertex[i] = vertex_numbers_[face.v[i]];
        to->neighbour[i] = renumbered(face.adj[i]);
      }
      ++to;
    }
  }
  /// Four faces on vertices 0..3. False when their volume is not positive for certain (`flat` = 6 volumes' error
  /// bound).
  bool start_tetrahedron(double flat);
  /// Four of the vertices that span a large volume.
  [[nodiscard]] SpreadPoints spread_vertices() const;
  /// Four faces on those; the other vertices are dropped. False when they are flat.
  bool start_from_spread_vertices(double flat);
  /// In place of the faces there are, the hull (up to rounding) of the newest vertex, those of the nearest faces and
  /// four that spread far; the others are dropped. False where they are flat.
  bool rebuild(double flat);
  /// A face visible from x, -1 where there is none.
  [[nodiscard]] int first_face_below(const Vec3& x);
  /// The face with the least key, the first of several.
  [[nodiscard]] int nearest() const { return nearest_; }
  /// Replaces the faces visible from vertex `v`, face `from` among them, by a cone over their border. The surface stays
  /// closed and oriented whatever they are. Returns false and leaves the surface unchanged if every face is visible, or
  /// if the border meets itself in a vertex: rounding, or a surface too far from convex.
  bool insert(int from, int v) {
    const Vec3& x = vertices[v].x;
    return insert(from, v, x.x(), x.y(), x.z()) >= 0;
  }
  /// The same for a vertex whose coordinates are at hand, which shortens the chain of dependent loads: the
  /// next nearest face, or -1.
  int insert(int from, int v, double x, double y, double z);
  /// Number of faces in use.
  [[nodiscard]] int size() const { return in_use_; }
  [[nodiscard]] int slots() const { return slots_; }

  /// The faces in use, numbered without gaps in the order of their slots, and all vertices.
  void snapshot(SurfaceSnapshot& out) const;
  /// The first invariant that is broken (surface_check.hpp), or nothing. Convexity is not promised.
  [[nodiscard]] std::optional<SurfaceFault> validate() const;

 private:
  [[nodiscard]] std::int16_t renumbered(std::int32_t adjacent) const {
    return static_cast<std::int16_t>(4 * face_numbers_[adjacent >> 2] + (adjacent & 3));
  }
  [[nodiscard]] PlaneArrays planes() { return {nx_.data(), ny_.data(), nz_.data(), levels_.data(), keys_.data()}; }
  /// Planes of all slots, none of them free.
  void compute_planes();
  /// Room for so many slots, and for a horizon of as many edges.
  void reserve(int count) {
    if (count + kPlaneBlock > room_) make_room(count);
  }
  [[gnu::cold, gnu::noinline]] void make_room(int count);

  void clear_faces();

  // insert, step by step
  int insert_vertex(int from, int v, double x, double y, double z);
  bool insert_among_many(int from, int v);
  [[nodiscard]] std::uint64_t connected_visible_region(int from, std::uint64_t visible) const;
  void flood_visible(int from, const Vec3& x);
  bool trace_horizon(std::uint64_t removed);
  bool trace_horizon();
  bool link_horizon(std::int32_t count);
  int fill_with_new_slots(int v, std::uint64_t removed);
  void fill_with_free_slots(int v);
  void take_slots(int count);
  void list_free_slots();
  template <class SlotOf>
  void join_fan(int v, SlotOf&& slot_of);
  [[nodiscard]] bool is_removed(int f) const { return (removed_bits_[f >> 6] >> (f & 63) & 1) != 0; }
  void mark_removed(int f) { removed_bits_[f >> 6] |= std::uint64_t{1} << (f & 63); }

  // The first slots_ entries are in use or free; the rest is room. Free slots and room hold infinite keys and levels,
  // so that no loop over whole blocks need ask.
  // In append mode every vertex adds a block of slots at the end, whose planes are written as they are computed, and
  // there is no list of free slots yet; later faces take free slots.
  std::vector<SurfaceTriangle> triangles_;
  std::vector<double> nx_, ny_, nz_, levels_, keys_;
  std::vector<std::int32_t> free_;
  int room_ = 0;  ///< slots that the arrays hold
  int slots_ = 0;
  int in_use_ = 0;
  bool append_mode_ = true;

  std::vector<std::uint64_t> removed_bits_;  ///< by slot; all zero between calls
  std::vector<std::int32_t> removed_;        ///< faces that go, then the slots of those that come
  int removed_count_ = 0;
  // The horizon: edges as the removed side runs along them, and beyond each 4 * face + edge of the face that stays.
  std::vector<std::int32_t> from_, to_, outside_;
  int horizon_count_ = 0;
  std::vector<std::int32_t> leaving_, reaching_;  ///< by vertex: the horizon edge that leaves it, that reaches it
  std::vector<double> fan_nx_, fan_ny_, fan_nz_, fan_levels_, fan_keys_;

  int nearest_ = 0;
  int checked_insertions_ = 0;  ///< see validate_after_insertion

  struct NearVertex {
    double key;  ///< of the nearest face that uses it
    std::int32_t vertex;
  };
  std::vector<NearVertex> nearness_;
  std::vector<DifferenceVertex> kept_;

  std::vector<std::int16_t> face_numbers_;
  std::vector<std::int16_t> vertex_numbers_;
};

}  // namespace pd::detail
