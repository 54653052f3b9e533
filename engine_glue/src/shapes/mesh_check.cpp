#include "pd/bullet/mesh_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"
#include "shapes/mixed_bits.hpp"

namespace pd {

namespace {

using Corner = std::array<double, 3>;
using Corners = std::array<std::uint64_t, 3>;  ///< of a triangle or, with a 0, of an edge: their numbers

/// The arrays of one part while they are locked.
class LockedPart {
 public:
  LockedPart(const btStridingMeshInterface& mesh, int part) : mesh_(mesh), part_(part) {
    mesh.getLockedReadOnlyVertexIndexBase(&vertices, num_vertices, vertex_type, vertex_stride, &indices, index_stride,
                                          num_triangles, index_type, part);
  }
  ~LockedPart() { mesh_.unLockReadOnlyVertexBase(part_); }
  LockedPart(const LockedPart&) = delete;
  LockedPart& operator=(const LockedPart&) = delete;

  [[nodiscard]] const char* unreadable() const {
    if (num_vertices < 0 || num_triangles < 0 || vertex_stride < 0 || index_stride < 0) {
      return "a count or stride below 0";
    }
    if (num_triangles > 0 && (vertices == nullptr || indices == nullptr)) return "no array of vertices or indices";
    return nullptr;
  }
  [[nodiscard]] bool readable_types() const {
    return (vertex_type == PHY_FLOAT || vertex_type == PHY_DOUBLE) &&
           (index_type == PHY_INTEGER || index_type == PHY_SHORT || index_type == PHY_UCHAR);
  }
  /// The number of a corner's vertex, as Bullet reads it.
  [[nodiscard]] std::int64_t index(int triangle, int corner) const {
    const unsigned char* at = indices + static_cast<std::ptrdiff_t>(triangle) * index_stride;
    if (index_type == PHY_INTEGER) return read<std::uint32_t>(at, corner);
    if (index_type == PHY_SHORT) return read<std::uint16_t>(at, corner);
    return at[corner];
  }
  [[nodiscard]] Corner vertex(std::int64_t i) const {
    const unsigned char* at = vertices + i * vertex_stride;
    Corner corner;
    for (int k = 0; k < 3; ++k) {
      corner[static_cast<std::size_t>(k)] =
          vertex_type == PHY_FLOAT ? static_cast<double>(read<float>(at, k)) : read<double>(at, k);
    }
    return corner;
  }

  const unsigned char* vertices = nullptr;
  const unsigned char* indices = nullptr;
  int num_vertices = 0;
  int num_triangles = 0;
  int vertex_stride = 0;
  int index_stride = 0;
  PHY_ScalarType vertex_type = PHY_FLOAT;
  PHY_ScalarType index_type = PHY_INTEGER;

 private:
  template <class T>
  static T read(const unsigned char* at, int i) {
    T value;
    std::memcpy(&value, at + static_cast<std::size_t>(i) * sizeof(T), sizeof(T));
    return value;
  }

  const btStridingMeshInterface& mesh_;
  int part_;
};

class MeshReader {
 public:
  explicit MeshReader(const btVector3& scaling)
      : scaling_{static_cast<double>(scaling.x()), static_cast<double>(scaling.y()), static_cast<double>(scaling.z())} {
  }

  std::optional<Error> read(const LockedPart& part, const std::string& name) {
    for (int t = 0; t < part.num_triangles; ++t) {
      const auto where = [&] { return name + ".triangles[" + std::to_string(t) + "]"; };
      Corners ids{};
      std::array<Vec3, 3> points;
      for (int k = 0; k < 3; ++k) {
        const std::int64_t index = part.index(t, k);
        if (index >= part.num_vertices) {
          return Error{ErrorCode::out_of_range,
                       "index " + std::to_string(index) + " of " + std::to_string(part.num_vertices) + " vertices",
                       where()};
        }
        Corner corner = part.vertex(index);
        for (std::size_t i = 0; i < 3; ++i) {
          // 0 and -0 are one place.
          corner[i] = corner[i] * scaling_[i] + 0.0;
          if (!std::isfinite(corner[i])) return Error{ErrorCode::non_finite, "a corner that is no number", where()};
          if (std::abs(corner[i]) > kMaxCoordinate) {
            return Error{ErrorCode::out_of_range, "a corner too far out", where()};
          }
          points[static_cast<std::size_t>(k)][static_cast<Eigen::Index>(i)] = corner[i];
        }
        ids[static_cast<std::size_t>(k)] = corners_.try_emplace(corner, corners_.size()).first->second;
      }
      take(ids, points);
    }
    return std::nullopt;
  }

  [[nodiscard]] MeshReport report() {
    for (const auto& [edge, count] : edges_) {
      report_.open_edges += count == 1 ? 1 : 0;
      report_.forked_edges += count > 2 ? 1 : 0;
    }
    return report_;
  }

 private:
  void take(Corners ids, const std::array<Vec3, 3>& points) {
    ++report_.triangles;
    if ((points[1] - points[0]).cross(points[2] - points[0]).isZero(0)) {
      ++report_.without_area;
      return;
    }
    std::sort(ids.begin(), ids.end());
    if (!triangles_.insert(ids).second) {
      ++report_.repeated;
      return;
    }
    ++edges_[{ids[0], ids[1], 0}];
    ++edges_[{ids[1], ids[2], 0}];
    ++edges_[{ids[0], ids[2], 0}];
  }

  Corner scaling_;
  MeshReport report_;
  std::unordered_map<Corner, std::uint64_t, detail::HashOfArray> corners_;
  std::unordered_set<Corners, detail::HashOfArray> triangles_;
  std::unordered_map<Corners, int, detail::HashOfArray> edges_;  // summed over only
};

}  // namespace

Expected<MeshReport> check_mesh(const btStridingMeshInterface& mesh) {
  MeshReader reader(mesh.getScaling());
  for (int i = 0; i < mesh.getNumSubParts(); ++i) {
    const std::string name = "parts[" + std::to_string(i) + "]";
    const LockedPart part(mesh, i);
    if (const char* reason = part.unreadable()) return Error{ErrorCode::bad_value, reason, name};
    if (!part.readable_types()) return Error{ErrorCode::unsupported, "a type that Bullet cannot read", name};
    if (const auto refusal = reader.read(part, name)) return *refusal;
  }
  return reader.report();
}

}  // namespace pd
