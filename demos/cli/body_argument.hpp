/// @file
/// A body as a word of the command line: a mesh's file, `-` for a mesh on standard input, or a primitive.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pd/shape/mesh_solid.hpp"
#include "protocol/body_reader.hpp"
#include "protocol/shape_reader.hpp"

namespace pd::cli {

/// The help's list of the words that name a body.
inline constexpr const char* kBodyWords =
    R"(A body is a mesh's file (OBJ, STL, PLY, OFF, glTF, XYZ or PCD), - for an OBJ, STL, PLY, OFF or PCD on standard input,
or a primitive about the origin:
  box:X,Y,Z        half extents
  sphere:R         radius
  ellipsoid:X,Y,Z  radii
  capsule:R,H      radius and half the height, along z; a capsule's height is that of its segment
  cylinder:R,H     cone:R,H)";

struct BodyArgument {
  std::string word;
  double margin = 0;                        ///< radius of a ball that sweeps the body
  query::MeshAs as = query::MeshAs::found;  ///< of meshes
};

/// True unless the word is a primitive.
[[nodiscard]] bool names_mesh(const std::string& word);

/// Reads a mesh's file of at most so many points. @throws query::Refusal that begins with the file's name
[[nodiscard]] query::MeshPoints read_mesh_argument(const std::string& file, std::int64_t most_points);

/// The solid of a mesh that is closed and not convex; null for other bodies. @throws query::Refusal that names the
/// fault of a mesh with holes, or one that crosses itself
[[nodiscard]] std::shared_ptr<const MeshSolid> read_solid_argument(const std::string& word);

/// Reads the body. @throws query::Refusal that begins with the word
[[nodiscard]] query::NamedShape read_body_argument(const BodyArgument& argument);

/// The body as a union: a mesh's groups, or one convex shape. @throws query::Refusal that begins with the word
[[nodiscard]] query::NamedBody read_parts_argument(const BodyArgument& argument);

}  // namespace pd::cli
