/// @file
/// Does a mesh bound a solid? Faults by name and place, and how far the mesh is from its convex hull.
///
/// Faces are loops of corners, counter-clockwise seen from outside. A mesh bounds a solid when all of these hold:
///
/// - closed: each edge has two faces;
/// - oriented: the two faces run along their edge in opposite directions;
/// - manifold: no edge has more than two faces, and the faces around a vertex form one ring;
/// - it does not cross itself;
/// - it encloses a positive volume.
///
/// Points with equal coordinates are one vertex, whatever their indices: formats that repeat a vertex for each face
/// keep their neighbourhoods. Topology and crossings are decided exactly, on the stored numbers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

enum class MeshFault : std::uint8_t {
  open_edge,        ///< an edge of one face
  flipped_face,     ///< two faces run along an edge in the same direction: one of them shows its inside
  not_manifold,     ///< an edge of three or more faces, or a vertex in which several sheets meet
  self_crossing,    ///< two faces have a point in common that is no common edge or vertex
  inside_out,       ///< the enclosed volume is negative: all faces show their insides
  not_planar,       ///< the corners of a polygon lie off its plane, by more than kMeshPrecision of the mesh's size
  degenerate_face,  ///< a face whose corners lie on one line; harmless where the mesh is closed
};
inline constexpr std::size_t kMeshFaults = 7;

/// The word of a fault, e.g. "open_edge".
[[nodiscard]] std::string_view to_string(MeshFault fault);

/// Flatness and convexity count up to this share of a mesh's size, its largest extent. Text of six digits rounds
/// coordinates by half as much, single precision by a hundredth.
inline constexpr double kMeshPrecision = 1e-5;

/// One fault and its place. Vertices are indices of the caller's points, faces of the caller's faces; -1: none.
struct MeshFinding {
  MeshFault fault{};
  std::array<std::int32_t, 2> edge = {-1, -1};   ///< its ends; a vertex has only the first
  std::array<std::int32_t, 2> faces = {-1, -1};  ///< two of the faces in question
};

struct SurfaceReport {
  std::int64_t points = 0;    ///< as given
  std::int64_t vertices = 0;  ///< distinct points
  std::int64_t faces = 0;
  std::int64_t shells = 0;        ///< connected parts of the surface; 0 where no face has three different corners
  std::int64_t loose_points = 0;  ///< distinct points that are no corner of the surface, which a convex hull would hold
  double size = 0;                ///< largest extent along an axis
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();

  /// Number of faults of each kind, in the order of the enumeration.
  std::array<std::int64_t, kMeshFaults> counts{};
  /// Some of them: the first of each kind first, no more than kShownFindings of a kind.
  std::vector<MeshFinding> findings;
  /// False: crossings were not searched to the end (`MeshCheckSettings::crossings`, or more pairs of faces than the
  /// budget holds), so that self_crossing may miss some.
  bool crossings_searched = false;

  /// Enclosed volume divided by the cube of `size`, which neither over- nor underflows; 0 unless closed and oriented.
  double relative_volume = 0;
  /// The surface of a convex body, whichever of its sides the faces show: closed, oriented, one shell, and no edge
  /// bends inwards by more than kMeshPrecision of the size.
  bool convex = false;

  [[nodiscard]] std::int64_t count(MeshFault fault) const { return counts[static_cast<std::size_t>(fault)]; }
  [[nodiscard]] bool closed() const { return shells > 0 && count(MeshFault::open_edge) == 0; }
  [[nodiscard]] bool oriented() const { return shells > 0 && count(MeshFault::flipped_face) == 0; }
  [[nodiscard]] bool manifold() const { return shells > 0 && count(MeshFault::not_manifold) == 0; }
  /// False where every face lies on a line or in a point.
  [[nodiscard]] bool has_area() const { return count(MeshFault::degenerate_face) < faces; }
  /// The faces bound a solid, as far as the check went.
  [[nodiscard]] bool solid() const {
    return closed() && oriented() && manifold() && has_area() && count(MeshFault::self_crossing) == 0 &&
           count(MeshFault::inside_out) == 0 && count(MeshFault::not_planar) == 0;
  }
};

inline constexpr std::size_t kShownFindings = 5;

struct MeshCheckSettings {
  bool crossings = true;  ///< search self_crossing, the dearest part
  double extent = 0;      ///< what kMeshPrecision is a share of, for a part of a larger mesh; 0: the mesh's own size
};

/// A mesh as indices over points: face f is corners[offsets[f]] to corners[offsets[f + 1] - 1].
struct MeshView {
  std::span<const Vec3> points;
  std::span<const std::int32_t> offsets;
  std::span<const std::int32_t> corners;
};

/// Checks a mesh. A mesh without faces has a report without faults, which is neither closed nor solid.
///
/// @return Error bad_faces for an index without a point or offsets that do not fit, non_finite and out_of_range for
/// coordinates that no hull can have, too_few_points for none.
///
/// Time O(n log n) for n corners without crossings. Their search visits pairs of faces whose boxes meet, up to 64 n +
/// 10^6 of them.
[[nodiscard]] Expected<SurfaceReport> check_mesh(const MeshView& mesh, const MeshCheckSettings& settings = {});

/// The connected surface of each face, numbered from 0 in the order of their first faces; -1 for a face of fewer than
/// three different points.
///
/// Two faces are connected where an edge is theirs alone, by its points or its stored indices. Solids that touch in an
/// edge or a vertex so have surfaces of their own; `SurfaceReport::shells` counts those as one.
/// @param mesh  one that `check_mesh` accepts. Time O(n log n) for n corners.
[[nodiscard]] std::vector<std::int32_t> connected_surfaces(const MeshView& mesh);

}  // namespace pd
