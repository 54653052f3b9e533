/// @file
/// Shapes as Python holds them: a convex body or a union of convex parts, immutable and shared.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pd/shape/compound.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/feature.hpp"
#include "python/arrays.hpp"

namespace pd::python {

/// Immutable once made, so that threads share it without the interpreter's lock.
struct Body {
  std::variant<ConvexShape, Compound> value;

  /// The convex body, or nullptr for a union.
  [[nodiscard]] const ConvexShape* convex() const { return std::get_if<ConvexShape>(&value); }
  /// A convex body as a union of one part.
  [[nodiscard]] Compound compound() const;
};

using BodyRef = std::shared_ptr<Body>;

/// The vertices of a feature by the caller's numbers (rows of the array that the shape was made from); empty for none.
/// @param part  of a union; 0 for a convex body.
[[nodiscard]] std::vector<int> feature_ids(const Body& body, int part, const Feature& feature);

/// An array [n, 3]. @throws Refused as `read_array`
[[nodiscard]] std::vector<Vec3> read_points(py::handle value, std::string_view argument);
/// A list of lists of indices below `num_points`. @throws Refused bad_faces for another number
[[nodiscard]] std::vector<std::vector<std::int32_t>> read_faces(py::handle value, std::size_t num_points);

/// Declares `Shape`, the base of Python's shapes.
void bind_shapes(py::module_& module);

}  // namespace pd::python
