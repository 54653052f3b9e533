#include "audit/recorded_shape.hpp"

#include <limits>
#include <utility>

#include "audit/body_extent.hpp"
#include "protocol/body_reader.hpp"

namespace pd::audit {

namespace {

Halfspace3 read_halfspace(const query::Node& node) {
  query::allow_only(node, {"type", "normal", "offset"});
  const query::Node normal_node = node.at("normal");
  const Vec3 normal = query::read_vector(normal_node);
  // Lengths that square to something ordinary.
  const double length = normal.stableNorm();
  if (length == 0) normal_node.refuse("zero_direction", "a plane's normal needs a length other than zero");
  if (!(length > 0x1p-400 && length < 0x1p400)) {
    normal_node.refuse("out_of_range", "a plane's normal must be between 2^-400 and 2^400 long");
  }
  return {normal, query::read_number(node.at("offset"))};
}

}  // namespace

RecordedShape read_recorded_shape(const query::Node& node, const query::Limits& limits) {
  query::require_object(node);
  RecordedShape shape;
  shape.kind = query::read_string(node.at("type"));
  if (shape.kind == "plane") {
    shape.halfspace = read_halfspace(node);
    shape.extent = std::numeric_limits<double>::infinity();
    return shape;
  }
  shape.is_union = shape.kind == "compound" || shape.kind == "star";
  shape.body = std::move(query::read_body(node, limits).compound);
  const Box box = bounding_box(*shape.body, Pose());
  shape.extent = (box.high - box.low).maxCoeff();
  return shape;
}

}  // namespace pd::audit
