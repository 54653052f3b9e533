/// @file
/// Accessors of a glTF 2 file, and the buffers in which their numbers stand.
///
/// [GLTF] Khronos Group, "glTF 2.0 Specification", section 3.6 (buffers, views, accessors).
///
/// Every count is held against the bytes that are there before memory is made for it. A buffer is the binary chunk of a
/// GLB, a data URI, or a regular file in the folder of the glTF: bytes of any other place are not its vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "protocol/line/field_reader.hpp"

namespace pd::query {

/// Numbers of an accessor. Refers to the buffers that it was read from.
class GltfValues {
 public:
  [[nodiscard]] std::int64_t size() const { return count_; }
  /// Component `k` of element `i`; normalised integers as fractions. Requires indices within the accessor.
  [[nodiscard]] double at(std::int64_t i, int k) const;
  [[nodiscard]] Vec3 point(std::int64_t i) const { return {at(i, 0), at(i, 1), at(i, 2)}; }

 private:
  friend class GltfBuffers;

  std::string_view bytes_;  ///< from the first element on; empty where all values are 0
  std::int64_t count_ = 0;
  std::int64_t stride_ = 0;
  int component_type_ = 0;
  int components_ = 0;
  bool normalized_ = false;
  std::vector<std::int64_t> replaced_;  ///< elements that stand in `replacements_` instead, increasing
  std::string_view replacements_;
};

/// All accessors of a file. Refers to `root` and to the bytes of a GLB's chunk, which must outlive it.
class GltfBuffers {
 public:
  struct Source {
    std::string path;                       ///< of the glTF, beside which its buffers stand
    std::optional<std::string_view> chunk;  ///< binary chunk of a GLB
    std::uintmax_t max_bytes = 0;           ///< of all buffers together
    std::int64_t max_replaced = 0;          ///< elements of all sparse accessors, each counted when it is read
  };

  GltfBuffers(const Node& root, Source source);
  GltfBuffers(const GltfBuffers&) = delete;
  GltfBuffers& operator=(const GltfBuffers&) = delete;

  /// @param type  "VEC3" or "SCALAR", which the accessor must have
  /// @throws Refusal with the place in the JSON
  [[nodiscard]] GltfValues values(std::int64_t accessor, std::string_view type);

 private:
  /// The bytes that an accessor, or a part of a sparse one, takes out of its view.
  struct Wanted {
    std::int64_t count = 0;
    std::int64_t element_bytes = 0;
  };

  [[nodiscard]] std::string_view buffer(std::int64_t index);
  /// Bytes from the first element on, and the distance of two elements. `user` has "bufferView" and "byteOffset".
  [[nodiscard]] std::string_view view_bytes(const Node& user, const Wanted& wanted, std::int64_t& stride);
  void read_sparse(const Node& sparse, GltfValues& values);

  std::optional<Node> accessors_;
  std::optional<Node> views_;
  std::optional<Node> buffers_;
  Source source_;
  std::vector<std::optional<std::string>> loaded_;
};

/// An element of a list of the file's root, by its index. @throws Refusal where there is none.
[[nodiscard]] Node gltf_element(const std::optional<Node>& list, std::string_view name, std::int64_t index);
/// A whole number from 0, or `otherwise` where the member is missing.
[[nodiscard]] std::int64_t gltf_integer(const Node& object, std::string_view key, std::int64_t otherwise);

}  // namespace pd::query
