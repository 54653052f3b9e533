#include "pipeline/overlay_geometry.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pd::render::detail {
namespace {

using Eigen::Vector3f;

constexpr int kSides = 28;

std::array<float, 4> tint_of(Colour colour, float opacity = 1) { return {colour.r, colour.g, colour.b, opacity}; }

/// Turned surfaces about the line from one point to another.
class Turner {
 public:
  Turner(std::vector<OverlayVertex>& out, const Vector3f& from, const Vector3f& direction, std::array<float, 4> tint)
      : out_(out), from_(from), along_(direction), tint_(tint) {
    const Vector3f across = std::abs(along_.z()) < 0.9f ? Vector3f::UnitZ() : Vector3f::UnitX();
    u_ = along_.cross(across).normalized();
    v_ = along_.cross(u_);
  }

  /// A band from (radius r0 at height h0) to (r1 at h1), outside to the right of the profile's way.
  void band(float r0, float h0, float r1, float h1) {
    const float length = std::max(std::hypot(r1 - r0, h1 - h0), 1e-20f);
    const float normal_radius = (h1 - h0) / length;
    const float normal_height = (r0 - r1) / length;
    for (int side = 0; side < kSides; ++side) {
      const Vector3f a = ray(side);
      const Vector3f b = ray(side + 1);
      const Vector3f na = normal_radius * a + normal_height * along_;
      const Vector3f nb = normal_radius * b + normal_height * along_;
      const Vector3f a0 = from_ + r0 * a + h0 * along_;
      const Vector3f b0 = from_ + r0 * b + h0 * along_;
      const Vector3f a1 = from_ + r1 * a + h1 * along_;
      const Vector3f b1 = from_ + r1 * b + h1 * along_;
      for (const auto& [place, normal] : {std::pair{a0, na}, {b0, nb}, {a1, na}, {b0, nb}, {b1, nb}, {a1, na}}) {
        out_.push_back({{place.x(), place.y(), place.z()}, {normal.x(), normal.y(), normal.z()}, tint_});
      }
    }
  }

 private:
  [[nodiscard]] Vector3f ray(int side) const {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(side % kSides) / kSides;
    return std::cos(angle) * u_ + std::sin(angle) * v_;
  }

  std::vector<OverlayVertex>& out_;
  Vector3f from_;
  Vector3f along_;
  std::array<float, 4> tint_;
  Vector3f u_;
  Vector3f v_;
};

/// Drawing units of a line one unit wide at a place.
float line_unit(const FrameSetup& frame, const Vector3f& place) {
  const float distance = std::max(frame.axes.row(2).dot(place - frame.eye), 1e-3f);
  return 2 * frame.tangents.y() * distance / 720.0f;
}

void add_arrow(OverlayGeometry& geometry, const Arrow& arrow, const FrameSetup& frame) {
  const Vector3f from = to_drawing(frame, arrow.from);
  const Vector3f to = to_drawing(frame, arrow.to);
  const float length = (to - from).norm();
  if (length <= 0) {
    return;
  }
  const Vector3f direction = (to - from) / length;
  const float unit = line_unit(frame, 0.5f * (from + to));
  const float thickness = static_cast<float>(arrow.thickness_pixels) * unit;
  const float head = std::min(3.1f * thickness, 0.62f * length);
  const float head_radius = head * 0.40f;
  const float shaft = std::min(0.5f * thickness, 0.44f * head_radius);
  const auto draw = [&](std::vector<OverlayVertex>& out, float grow, std::array<float, 4> tint) {
    Turner turner(out, from, direction, tint);
    const float neck = length - head - grow;
    turner.band(0, -grow, shaft + grow, -grow);
    turner.band(shaft + grow, -grow, shaft + grow, neck);
    turner.band(shaft + grow, neck, head_radius + 1.3f * grow, neck);
    turner.band(head_radius + 1.3f * grow, neck, 0, length + 1.6f * grow);
  };
  draw(geometry.halo, std::min(1.7f * unit, 0.5f * thickness), tint_of(palette::kPaper, 0.9f));
  draw(geometry.ink, 0, tint_of(arrow.colour));
}

void add_disc(OverlayGeometry& geometry, const ContactDisc& disc, const FrameSetup& frame) {
  const Vector3f point = to_drawing(frame, disc.point);
  const Vector3f normal = disc.normal.normalized().cast<float>();
  const float unit = line_unit(frame, point);
  const float radius = disc.radius > 0 ? static_cast<float>(disc.radius * frame.scale) : 4.5f * unit;
  const float half = 0.6f * unit;
  const float stem = 3.4f * radius;
  const auto draw = [&](std::vector<OverlayVertex>& out, float grow, std::array<float, 4> tint) {
    Turner turner(out, point, normal, tint);
    const float outer = radius + grow;
    const float lift = half + 0.5f * grow;
    turner.band(0, -lift, outer, -lift);
    turner.band(outer, -lift, outer, lift);
    turner.band(outer, lift, 0, lift);
    if (disc.stem) {
      const float width = 0.16f * radius + grow;
      turner.band(width, lift, width, stem + grow);
      turner.band(width, stem + grow, 0, stem + grow);
    }
  };
  draw(geometry.halo, std::min(1.4f * unit, 0.3f * radius), tint_of(palette::kPaper, 0.85f));
  draw(geometry.ink, 0, tint_of(disc.colour));
}

void add_line(OverlayGeometry& geometry, const Polyline& line, const FrameSetup& frame) {
  for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
    const Vector3f from = to_drawing(frame, line.points[i]);
    const Vector3f to = to_drawing(frame, line.points[i + 1]);
    const float length = (to - from).norm();
    if (length > 0) {
      const float half_width = 0.5f * static_cast<float>(line.width_pixels);
      Turner turner(geometry.ink, from, (to - from) / length, tint_of(line.colour, line.opacity));
      turner.band(half_width * line_unit(frame, from), 0, half_width * line_unit(frame, to), length);
    }
  }
}

}  // namespace

OverlayGeometry overlay_geometry(const Scene& scene, const FrameSetup& frame) {
  OverlayGeometry geometry;
  for (const Polyline& line : scene.lines) {
    add_line(geometry, line, frame);
  }
  for (const ContactDisc& disc : scene.discs) {
    add_disc(geometry, disc, frame);
  }
  for (const Arrow& arrow : scene.arrows) {
    add_arrow(geometry, arrow, frame);
  }
  return geometry;
}

}  // namespace pd::render::detail
