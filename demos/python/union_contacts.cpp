/// @file
/// Python asks here for contacts of unions, and of meshes as sheets of triangles.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "pd/union_contact/union_manifold.hpp"
#include "python/pair_query.hpp"

namespace pd::python {

namespace {

/// A mesh as triangles without an inside, which contacts alone take.
struct Sheet {
  PieceBody pieces;
};

std::shared_ptr<Sheet> make_sheet(py::handle vertices, py::handle faces, py::handle margin) {
  const std::vector<Vec3> points = read_points(vertices, "vertices");
  std::vector<std::int32_t> offsets{0}, corners;
  for (const auto& face : read_faces(faces, points.size())) {
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  auto pieces = PieceBody::of_sheet({points, offsets, corners}, *read_array(margin, "margin", {}).data());
  if (!pieces) {
    const Error& error = pieces.error();
    const std::string where = error.where.starts_with("points") ? "vertices" + error.where.substr(6) : error.where;
    refuse(to_string(error.code), error.message, where);
  }
  return std::make_shared<Sheet>(Sheet{std::move(pieces).value()});
}

PieceBody pieces_of(const py::object& shape) {
  if (py::isinstance<Sheet>(shape)) return py::cast<Sheet&>(shape).pieces;
  return PieceBody::of_compound(shape.cast<const Body&>().compound());
}

bool is_finite(const UnionManifold& manifold) {
  return all_finite(manifold.normal) &&
         std::all_of(manifold.patches.begin(), manifold.patches.end(), [](const UnionContactPatch& patch) {
           const auto end = patch.points.begin() + static_cast<std::ptrdiff_t>(patch.count);
           return all_finite(patch.normal) &&
                  std::all_of(patch.points.begin(), end, [](const UnionContactPoint& point) {
                    return all_finite(point.normal) && pd::is_finite(point.contact);
                  });
         });
}

/// Makes the fields that Python shows of a patch.
py::dict fields_of(const UnionContactPatch& patch) {
  const auto count = static_cast<py::ssize_t>(patch.count);
  std::vector<ContactPoint> contacts;
  Array normals({count, py::ssize_t{3}});
  py::array_t<std::int64_t> pieces_a(count), pieces_b(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const UnionContactPoint& point = patch.points[static_cast<std::size_t>(i)];
    contacts.push_back(point.contact);
    for (int k = 0; k < 3; ++k) normals.mutable_at(i, k) = point.normal[k];
    pieces_a.mutable_at(i) = point.piece_a;
    pieces_b.mutable_at(i) = point.piece_b;
  }
  py::dict fields = contact_fields(patch.normal, contacts);
  fields["normals"] = normals;
  fields["piece_a"] = pieces_a;
  fields["piece_b"] = pieces_b;
  return fields;
}

/// Returns the patches, and how many contacts were covered. Without a patch, one without points holds the normal.
py::tuple union_manifold_pair(const py::object& a, const py::object& b, py::handle pose_a, py::handle pose_b,
                              const UnionContactSettings& settings) {
  const PieceBody first = pieces_of(a), second = pieces_of(b);
  const PosedPieces posed_a{&first, read_pose(pose_a, "pose_a")}, posed_b{&second, read_pose(pose_b, "pose_b")};
  const Expected<UnionManifold> found = [&] {
    const Unlocked unlocked;
    UnionManifoldScratch scratch{workspace().scratch, workspace().manifold};
    return union_manifold(posed_a, posed_b, settings, scratch);
  }();
  if (!found) refuse(to_string(found.error().code), found.error().message, found.error().where);
  if (!is_finite(*found)) refuse(past_doubles(""), "pair");
  py::list patches;
  for (const UnionContactPatch& patch : found.value().patches) patches.append(fields_of(patch));
  if (patches.empty()) {
    UnionContactPatch none;
    none.normal = found.value().normal;
    patches.append(fields_of(none));
  }
  return py::make_tuple(patches, found.value().covered);
}

}  // namespace

void bind_union_contacts(py::module_& module) {
  py::class_<Sheet, std::shared_ptr<Sheet>> sheet(module, "Sheet", py::dynamic_attr(), "Triangles without an inside.");
  require_made(sheet);
  sheet.def(py::init(&make_sheet), py::arg("vertices"), py::arg("faces"), py::arg("margin"));
  module.def("union_manifold", [](const py::object& a, const py::object& b, py::handle pose_a, py::handle pose_b,
                                  const py::tuple& how) {
    return union_manifold_pair(a, b, pose_a, pose_b,
                               {.breaking_threshold = how[0].cast<double>(), .one_sided = how[1].cast<bool>()});
  });
}

}  // namespace pd::python
