#include "pd/bullet/mesh_check.hpp"

#include <cstring>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "pd/bullet/scalar.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

namespace {

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
  [[nodiscard]] Vec3 vertex(std::int64_t i) const {
    const unsigned char* at = vertices + i * vertex_stride;
    const auto number = [&](int k) {
      return vertex_type == PHY_FLOAT ? static_cast<double>(read<float>(at, k)) : read<double>(at, k);
    };
    return {number(0), number(1), number(2)};
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

/// Appends the corners of a part's triangles, three of each.
std::optional<Error> read(const LockedPart& part, const Vec3& scaling, const std::string& name,
                          std::vector<Vec3>& corners) {
  for (int t = 0; t < part.num_triangles; ++t) {
    const auto where = [&] { return name + ".triangles[" + std::to_string(t) + "]"; };
    for (int k = 0; k < 3; ++k) {
      const std::int64_t index = part.index(t, k);
      if (index >= part.num_vertices) {
        return Error{ErrorCode::out_of_range,
                     "index " + std::to_string(index) + " of " + std::to_string(part.num_vertices) + " vertices",
                     where()};
      }
      const Vec3& corner = corners.emplace_back(part.vertex(index).cwiseProduct(scaling));
      if (!corner.allFinite()) return Error{ErrorCode::non_finite, "a corner that is no number", where()};
      if (corner.cwiseAbs().maxCoeff() > kMaxCoordinate) {
        return Error{ErrorCode::out_of_range, "a corner too far out", where()};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

Expected<SurfaceReport> check_mesh(const btStridingMeshInterface& mesh) {
  std::vector<Vec3> points;
  for (int i = 0; i < mesh.getNumSubParts(); ++i) {
    const std::string name = "parts[" + std::to_string(i) + "]";
    const LockedPart part(mesh, i);
    if (const char* reason = part.unreadable()) return Error{ErrorCode::bad_value, reason, name};
    if (!part.readable_types()) return Error{ErrorCode::unsupported, "a type that Bullet cannot read", name};
    if (const auto refusal = read(part, to_pd(mesh.getScaling()), name, points)) return *refusal;
  }
  std::vector<std::int32_t> corners(points.size()), offsets;
  std::iota(corners.begin(), corners.end(), 0);
  for (std::size_t i = 0; i <= points.size(); i += 3) offsets.push_back(static_cast<std::int32_t>(i));
  return check_mesh({points, offsets, corners}, {.crossings = false});
}

}  // namespace pd
