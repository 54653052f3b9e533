/// @file
/// Convex parts of meshes as arrays of their vertices, for `pdepth.Compound.from_mesh`.
#pragma once

#include "mesh/mesh_file.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "pd/solid/convex_decomposition.hpp"
#include "python/arrays.hpp"

namespace pd::python {

/// The parts of a mesh: the groups of a file, each convex or a solid whose convex parts are exact; or, if an error is
/// given, convex parts of the whole solid within that error.
///
/// @param mesh   a path, or a tuple of vertices [n, 3] and faces as lists of rows
/// @param error  None, or a length
/// @param side   "outer" or "inner"; read with an error only
/// @return a list of arrays [n, 3], and the certified error (None without one)
/// @throws Refused with the fault of the mesh; limit_exceeded if the error is not reached
py::tuple mesh_parts(py::handle mesh, py::handle error, const std::string& side, bool turn_faces);

/// The mesh of a path, or of a tuple of vertices [n, 3] and faces as lists of rows.
/// @throws Refused at mesh.faces[i] or mesh.vertices[i], query::Refusal for a file
query::MeshPoints read_mesh(py::handle mesh);

/// Convex parts within settings.error, which becomes the error that was reached. Requires that the interpreter's lock
/// is released; hears Ctrl-C. @throws query::Refusal, limit_exceeded if the error is not reached
Compound decomposed(const MeshSolid& solid, DecompositionSettings& settings);

}  // namespace pd::python
