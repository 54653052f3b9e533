#include "support/search_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pd/depth/minkowski_difference.hpp"
#include "support/difference_mesh.hpp"

namespace pd::demo {

namespace {

namespace palette = render::palette;

constexpr std::int64_t kMostSearchFacets = 100'000;
constexpr render::Insets kSearchInsets{.left = 0.05, .right = 0.05, .top = 0.06, .bottom = 0.06};

/// Those of a step's faces that `wanted` names, and no other points.
template <class Wanted>
render::MeshRef faces_mesh(const SearchStep& step, Wanted&& wanted) {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::map<std::int32_t, std::int32_t> number;
  for (std::size_t f = 0; f < step.faces.size(); ++f) {
    if (!wanted(static_cast<int>(f))) continue;
    triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t v = step.faces[f][i];
      const auto [found, added] = number.emplace(v, static_cast<std::int32_t>(points.size()));
      if (added) points.push_back(step.vertices[static_cast<std::size_t>(v)]);
      triangles.back()[i] = found->second;
    }
  }
  return render::triangle_mesh(points, triangles, 1);
}

/// From the side that a normal points to, a little off it, so that the face and what lies beyond both read.
render::ViewAngle facing(const Vec3& normal) {
  constexpr double kInDegrees = 180 / std::numbers::pi;
  const double height = std::asin(std::clamp(normal.z(), -1.0, 1.0)) * kInDegrees;
  return {std::atan2(normal.y(), normal.x()) * kInDegrees + 35, std::clamp(height + 12, -50.0, 50.0)};
}

}  // namespace

SearchPictures::SearchPictures(const query::SearchFile& search, render::Size size) : search_(search), size_(size) {
  const query::Pair& pair = search.pair;
  const auto difference = minkowski_difference(*pair.a.shape.polytope(), pair.pose_a, *pair.b.shape.polytope(),
                                               pair.pose_b, kMostSearchFacets);
  if (difference && !difference->facets.empty()) {
    difference_ = difference_mesh(
        *difference, [](std::size_t) { return true; }, [](std::size_t) { return palette::kInkFaint; });
    box_.include(difference_->bounds);
  }
  for (const SearchStep& step : search.steps) {
    for (const Vec3& x : step.vertices) box_.include(x);
    box_.include(step.support);
  }
  box_.include(Vec3::Zero());
}

Expected<render::Image> SearchPictures::draw(std::size_t index, render::Renderer& renderer) const {
  const SearchStep& step = search_.steps[index];
  render::Scene scene;
  if (difference_) {
    scene.solids.push_back(
        {.mesh = difference_, .colour = palette::kInkFaint, .opacity = 0.16f, .hidden_opacity = 0.16f});
  }
  scene.solids.push_back({.mesh = faces_mesh(step, [&](int f) { return f != step.nearest; }),
                          .colour = palette::kBodyA,
                          .opacity = 0.55f,
                          .hidden_opacity = 0.55f});
  scene.solids.push_back({.mesh = faces_mesh(step, [&](int f) { return f == step.nearest; }),
                          .colour = palette::kNearestFacet,
                          .opacity = 0.9f,
                          .hidden_opacity = 0.8f});
  const double dot = 0.012 * box_.diagonal();
  scene.balls.push_back({.centre = Vec3::Zero(), .radius = dot, .colour = palette::kContact});
  // From the face to its support, along the normal.
  const double gap = step.support.dot(step.normal) - step.distances[static_cast<std::size_t>(step.nearest)];
  scene.lines.push_back(
      {.points = {step.support - gap * step.normal, step.support}, .colour = palette::kDepth, .width_pixels = 4});
  scene.balls.push_back({.centre = step.support, .radius = 1.4 * dot, .colour = palette::kDepth});
  scene.ground.visible = false;
  scene.focus = box_;
  return renderer.draw(scene, render::frame_box(box_, size_, facing(search_.steps.back().normal), kSearchInsets),
                       size_);
}

std::string SearchPictures::heading(std::size_t index) const {
  const SearchStep& step = search_.steps[index];
  // Every support bounds the depth, though a search certifies such a bound only where it may be the last.
  double upper = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i <= index; ++i) {
    upper = std::min(upper, search_.steps[i].support.dot(search_.steps[i].normal));
  }
  return fmt::format("step {}{}, {} faces: {:.4g} to {:.4g}", step.number,
                     step.arithmetic == "double" ? "" : fmt::format(" ({})", step.arithmetic), step.faces.size(),
                     step.lower, upper);
}

std::vector<std::size_t> steps_to_show(std::size_t count) {
  constexpr std::size_t kShown = 6;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min(count, kShown); ++i) {
    if (count <= kShown) {
      out.push_back(i);
      continue;
    }
    const double share = static_cast<double>(i) / (kShown - 1);
    const auto step = static_cast<std::size_t>(std::lround(share * share * static_cast<double>(count - 1)));
    out.push_back(out.empty() ? step : std::max(step, out.back() + 1));
  }
  return out;
}

}  // namespace pd::demo
