/// @file
/// The module `pdepth._picture`: bodies and their answer, drawn off screen by our renderer.
#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include "difference.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/render/camera.hpp"
#include "pd/render/renderer.hpp"
#include "protocol/body_reader.hpp"
#include "protocol/line/json_text.hpp"
#include "protocol/pair_reader.hpp"
#include "python/arrays.hpp"
#include "support/refusal.hpp"

namespace pd::python {

namespace {

namespace palette = render::palette;

constexpr render::Insets kInsets{.left = 0.08, .right = 0.08, .top = 0.1, .bottom = 0.1};

/// A camera squares lengths of the scene.
constexpr double kLeastSize = 1e-100, kLargestSize = 1e100;

using Bytes = py::array_t<std::uint8_t>;

/// The value, or why the renderer refused.
template <class T>
T drawn(Expected<T> result) {
  if (!result) refuse(to_string(result.error().code), result.error().message, "picture");
  return std::move(result).value();
}

/// [height, width, 3].
Bytes rgb_of(const render::Image& image) {
  Bytes array({static_cast<py::ssize_t>(image.height()), static_cast<py::ssize_t>(image.width()), py::ssize_t{3}});
  std::uint8_t* out = array.mutable_data();
  const auto bytes = image.bytes();
  for (std::size_t pixel = 0; 4 * pixel < bytes.size(); ++pixel) {
    for (std::size_t k = 0; k < 3; ++k) *out++ = bytes[4 * pixel + k];
  }
  return array;
}

void add_body(const Compound& body, const Pose& pose, render::Colour colour, float opacity, render::Scene& scene) {
  for (const PosedShape& part : value_of(body.posed(pose), "pose")) {
    scene.bodies.push_back(
        {.mesh = render::shape_mesh(*part.shape), .pose = part.pose, .colour = colour, .opacity = opacity});
  }
}

void add_answer(const PenetrationDepth& answer, render::Scene& scene) {
  if (answer.contact == ContactClass::overlapping) {
    scene.arrows.push_back(
        {.from = answer.witness_a,
         .to = answer.witness_b,
         .label = fmt::format("{:.4g}\nin [{:.4g}, {:.4g}]", answer.depth, answer.lower, answer.upper)});
  } else if (answer.contact == ContactClass::separated) {
    scene.lines.push_back(
        {.points = {answer.witness_a, answer.witness_b}, .colour = palette::kDepth, .width_pixels = 4});
    scene.labels.push_back(
        {.at = 0.5 * (answer.witness_a + answer.witness_b), .text = fmt::format("{:.4g} apart", answer.distance)});
  } else {
    scene.discs.push_back({.point = answer.witness_a, .normal = answer.normal, .colour = palette::kDepth});
  }
}

/// One body alone, or two with what parts them.
render::Image draw_scene(const query::Node& line, render::Size size, render::ViewAngle angle) {
  const query::Limits limits;
  const query::NamedBody a = query::read_body(line.at("a"), limits);
  const Pose pose_a = query::read_optional_pose(line, "pose_a");
  render::Scene scene;
  if (const auto second = line.find("b")) {
    const query::NamedBody b = query::read_body(*second, limits);
    const Pose pose_b = query::read_optional_pose(line, "pose_b");
    add_body(a.compound, pose_a, palette::kBodyA, 0.55f, scene);
    add_body(b.compound, pose_b, palette::kBodyB, 0.55f, scene);
    Scratch scratch;
    add_answer(value_of(penetration_depth({&a.compound, pose_a}, {&b.compound, pose_b}, scratch), "pair"), scene);
  } else {
    add_body(a.compound, pose_a, palette::kBodyA, 1, scene);
  }
  const render::Box box = render::bounds(scene);
  if (const double extent = (box.upper - box.lower).cwiseAbs().maxCoeff();
      !(extent >= kLeastSize && extent <= kLargestSize)) {
    refuse("out_of_range", "a picture shows bodies of a size from 1e-100 to 1e100", "picture");
  }
  scene.ground.height = box.lower.z();
  scene.ground.scale_bar = false;
  scene.focus = box;
  render::Renderer renderer = drawn(render::Renderer::create());
  return drawn(renderer.draw(scene, render::frame_box(box, size, angle, kInsets), size));
}

/// The pair and its Minkowski difference.
render::Image draw_difference(const query::Node& line, render::Size size, double turn_degrees) {
  const query::Pair pair = query::read_pair(line, {});
  if (pair.a.shape.polytope() == nullptr || pair.b.shape.polytope() == nullptr || pair.a.shape.margin() != 0 ||
      pair.b.shape.margin() != 0) {
    refuse("unsupported", "the difference is drawn of two polytopes without margins", "difference");
  }
  Scratch scratch;
  const PenetrationDepth answer = penetration_depth(pair.posed_a(), pair.posed_b(), scratch);
  render::Renderer renderer = drawn(render::Renderer::create());
  const demo::NamedPair named{&pair.a.shape, &pair.b.shape, pair.pose_a, pair.pose_b, "A", "B"};
  return drawn(demo::difference_picture(named, answer, renderer, size, turn_degrees));
}

Bytes picture(const std::string& text, int width, int height, double azimuth, double elevation, bool difference) {
  if (width < 16 || width > 8192 || height < 16 || height > 8192) {
    refuse("bad_value", "width and height must lie in [16, 8192]", "size");
  }
  render::Image image;
  try {
    const Unlocked unlocked;
    const query::ParsedLine parsed = query::parse_line(text);
    if (parsed.refusal) throw *parsed.refusal;
    const query::Node line(parsed.object);
    image = difference ? draw_difference(line, {width, height}, azimuth - render::ViewAngle().azimuth_degrees)
                       : draw_scene(line, {width, height}, {azimuth, elevation});
  } catch (const query::Refusal& refusal) {
    refuse(refusal.code, refusal.message, refusal.where);
  }
  return rgb_of(image);
}

py::bytes png(const Bytes& rgb, const std::string& path) {
  render::Image image({static_cast<int>(rgb.shape(1)), static_cast<int>(rgb.shape(0))});
  for (py::ssize_t y = 0; y < rgb.shape(0); ++y) {
    for (py::ssize_t x = 0; x < rgb.shape(1); ++x) {
      for (int k = 0; k < 3; ++k) image.pixel(static_cast<int>(x), static_cast<int>(y))[k] = rgb.at(y, x, k);
    }
  }
  (void)drawn(render::write_png(image, path));
  return {};
}

}  // namespace

}  // namespace pd::python

namespace py = pybind11;

PYBIND11_MODULE(_picture, module) {
  module.doc() = "The compiled part of pdepth that draws; use the package pdepth.";
  pd::python::use_refused(py::module_::import("pdepth._core").attr("Refused"));
  module.def("picture", &pd::python::picture);
  module.def("write_png", &pd::python::png);
}
