#include <stdexcept>

#include "oracle/corpus.hpp"

namespace pd::oracle {

ConvexShape make_shape(const ShapeText& s) {
  const auto checked = [](auto made) {
    if (!made) throw std::runtime_error("shape refused: " + made.error().message);
    return ConvexShape(*made);
  };
  if (s.type == "box") return checked(ConvexPolytope::box(s.sizes));
  if (s.type == "convex") return checked(ConvexPolytope::from_points(s.points));
  if (s.type == "sphere") return checked(ConvexShape::sphere(s.margin));
  if (s.type == "capsule") return checked(ConvexShape::capsule(s.sizes.x(), s.sizes.y(), s.axis));
  if (s.type == "cylinder") return checked(ConvexShape::cylinder(s.sizes.x(), s.sizes.y(), s.axis));
  if (s.type == "cone") return checked(ConvexShape::cone(s.sizes.x(), s.sizes.y(), s.axis));
  if (s.type == "ellipsoid") return checked(ConvexShape::ellipsoid(s.sizes));
  throw std::runtime_error("unknown shape type " + s.type);
}

}  // namespace pd::oracle
