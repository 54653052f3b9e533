#include "mesh/mesh_groups.hpp"

#include <cstddef>
#include <cstdint>
#include <map>

namespace pd::query {

namespace {

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

}  // namespace

std::vector<MeshGroup> groups_of(const MeshPoints& mesh) {
  const MeshFaces& faces = mesh.faces;
  std::vector<Filling> filling;
  std::map<std::int32_t, std::size_t> place;
  for (std::int64_t f = 0; f < faces.size(); ++f) {
    const auto face = static_cast<std::size_t>(f);
    const std::int32_t group = faces.groups.empty() ? 0 : faces.groups[face];
    const auto [at, fresh] = place.try_emplace(group, filling.size());
    if (fresh) {
      const std::string number = "part " + std::to_string(filling.size());
      const std::string name = faces.groups.empty() ? "" : faces.group_names[static_cast<std::size_t>(group)];
      filling.push_back({{name.empty() ? number : number + " (\"" + name + "\")", {}}, {}});
    }
    Filling& own = filling[at->second];
    for (std::int32_t k = faces.offsets[face]; k < faces.offsets[face + 1]; ++k) {
      own.group.mesh.faces.corners.push_back(number_in(own, mesh, faces.corners[static_cast<std::size_t>(k)]));
    }
    own.group.mesh.faces.offsets.push_back(static_cast<std::int32_t>(own.group.mesh.faces.corners.size()));
    if (!faces.lines.empty()) own.group.mesh.faces.lines.push_back(faces.lines[face]);
  }
  std::vector<MeshGroup> groups;
  for (Filling& each : filling) groups.push_back(std::move(each.group));
  return groups;
}

}  // namespace pd::query
