#include "mesh/mesh_groups.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <utility>

#include "pd/shape/mesh_check.hpp"

namespace pd::query {

namespace {

/// The fewest faces of a surface that bounds a part: a tetrahedron's.
constexpr std::int64_t kFewestFaces = 4;

/// A group that is being filled, and the new number of each point.
struct Filling {
  MeshGroup group;
  std::map<std::int32_t, std::int32_t> numbers;
};

std::int32_t number_in(Filling& filling, const MeshPoints& mesh, std::int32_t point) {
  MeshPoints& own = filling.group.mesh;
  const auto [place, fresh] = filling.numbers.try_emplace(point, static_cast<std::int32_t>(own.points.size()));
  if (fresh) {
    const auto at = static_cast<std::size_t>(point);
    own.points.push_back(mesh.points[at]);
    own.ids.push_back(mesh.ids.empty() ? point : mesh.ids[at]);
  }
  return place->second;
}

/// One mesh for each number of `part_of_face`, in the order of their first faces; faces of number -1 are left out.
/// @param name  of a part, by its place in the result and its number
template <class Name>
std::vector<MeshGroup> split(const MeshPoints& mesh, std::span<const std::int32_t> part_of_face, const Name& name) {
  const MeshFaces& faces = mesh.faces;
  std::vector<Filling> filling;
  std::map<std::int32_t, std::size_t> place;
  for (std::size_t face = 0; face < part_of_face.size(); ++face) {
    const std::int32_t part = part_of_face[face];
    if (part < 0) continue;
    const auto [at, fresh] = place.try_emplace(part, filling.size());
    if (fresh) filling.push_back({{name(filling.size(), part), {}}, {}});
    Filling& own = filling[at->second];
    for (std::int32_t k = faces.offsets[face]; k < faces.offsets[face + 1]; ++k) {
      own.group.mesh.faces.corners.push_back(number_in(own, mesh, faces.corners[static_cast<std::size_t>(k)]));
    }
    own.group.mesh.faces.offsets.push_back(static_cast<std::int32_t>(own.group.mesh.faces.corners.size()));
    if (!faces.lines.empty()) own.group.mesh.faces.lines.push_back(faces.lines[face]);
  }
  std::vector<MeshGroup> parts;
  for (Filling& each : filling) parts.push_back(std::move(each.group));
  return parts;
}

}  // namespace

std::vector<MeshGroup> groups_of(const MeshPoints& mesh) {
  const MeshFaces& faces = mesh.faces;
  const std::vector<std::int32_t> one(static_cast<std::size_t>(faces.groups.empty() ? faces.size() : 0));
  return split(mesh, faces.groups.empty() ? one : faces.groups, [&](std::size_t place, std::int32_t group) {
    const std::string number = "part " + std::to_string(place);
    const std::string name = faces.groups.empty() ? "" : faces.group_names[static_cast<std::size_t>(group)];
    return name.empty() ? number : number + " (\"" + name + "\")";
  });
}

std::vector<MeshGroup> surfaces_of(const MeshGroup& group) {
  const MeshFaces& faces = group.mesh.faces;
  const std::vector<std::int32_t> surfaces = connected_surfaces({group.mesh.points, faces.offsets, faces.corners});
  return split(group.mesh, surfaces,
               [&](std::size_t place, std::int32_t) { return group.name + ", surface " + std::to_string(place); });
}

bool has_parts(const MeshPoints& mesh) {
  const std::vector<std::int32_t>& groups = mesh.faces.groups;
  if (std::adjacent_find(groups.begin(), groups.end(), std::not_equal_to<>()) != groups.end()) return true;
  std::map<std::int32_t, std::int64_t> faces_of;
  for (const std::int32_t surface : connected_surfaces({mesh.points, mesh.faces.offsets, mesh.faces.corners})) {
    if (surface >= 0) ++faces_of[surface];
  }
  return faces_of.size() > 1 && std::all_of(faces_of.begin(), faces_of.end(),
                                            [](const auto& counted) { return counted.second >= kFewestFaces; });
}

}  // namespace pd::query
