#include "report/pair_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "report/html_text.hpp"

namespace pd::report {

namespace {

constexpr double kPairWidth = 340;
constexpr double kPairHeight = 270;
constexpr double kBorder = 16;
constexpr double kYaw = 0.6;     // radians; the page's script begins there, too
constexpr double kPitch = 0.28;  // radians above the horizon

using Rgb = std::array<double, 3>;
constexpr Rgb kBodyA{0x4C, 0x8D, 0xBF};
constexpr Rgb kBodyB{0xE0, 0xA9, 0x3B};
constexpr std::array<Rgb, 3> kKinds{Rgb{0x5B, 0x9B, 0xC8}, Rgb{0x7D, 0xB8, 0x9C}, Rgb{0xD6, 0xBE, 0x7C}};

/// To the right, upwards, and how near to the eye.
Vec3 turned(const Vec3& p) {
  const double away = std::cos(kYaw) * p.y() - std::sin(kYaw) * p.x();
  return {std::cos(kYaw) * p.x() + std::sin(kYaw) * p.y(), std::cos(kPitch) * p.z() + std::sin(kPitch) * away,
          std::sin(kPitch) * p.z() - std::cos(kPitch) * away};
}

/// Fills the drawing with the bodies.
class Lens {
 public:
  explicit Lens(const PairView& view) {
    Vec3 low = Vec3::Constant(1e308);
    Vec3 high = -low;
    for (const DrawnBody& body : view.bodies) {
      for (const Vec3& p : body.shape.points) {
        low = low.cwiseMin(turned(p));
        high = high.cwiseMax(turned(p));
      }
    }
    const Vec3 size = (high - low).cwiseMax(1e-9);
    zoom_ = std::min((kPairWidth - 2 * kBorder) / size.x(), (kPairHeight - 2 * kBorder) / size.y());
    centre_ = 0.5 * (low + high);
  }
  [[nodiscard]] double zoom() const { return zoom_; }
  /// Screen x, screen y (downwards), and how near to the eye.
  [[nodiscard]] Vec3 operator()(const Vec3& p) const {
    const Vec3 at = turned(p) - centre_;
    return {kPairWidth / 2 + zoom_ * at.x(), kPairHeight / 2 - zoom_ * at.y(), at.z()};
  }

 private:
  double zoom_ = 1;
  Vec3 centre_ = Vec3::Zero();
};

/// How near to the eye a direction leads.
double towards_eye(const Vec3& direction) { return turned(direction).z(); }

std::string shaded(const Rgb& colour, const Vec3& normal) {
  const double light = 0.82 + 0.18 * normal.dot(Vec3(-0.3, -0.5, 0.81));
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(light * colour[0]), static_cast<int>(light * colour[1]),
                     static_cast<int>(light * colour[2]));
}

Rgb colour_of(const DrawnBody& body, std::size_t polygon) {
  if (body.role == BodyRole::a) return kBodyA;
  if (body.role == BodyRole::b) return kBodyB;
  return body.shape.kinds.empty() ? kKinds[0] : kKinds[static_cast<std::size_t>(body.shape.kinds[polygon])];
}

struct Facet {
  double nearness;
  std::string text;
};

/// The facets that face the eye, those farther away first.
std::vector<Facet> facets_of(const PairView& view, const Lens& seen) {
  std::vector<Facet> facets;
  for (const DrawnBody& body : view.bodies) {
    for (std::size_t f = 0; f < body.shape.polygons.size(); ++f) {
      if (towards_eye(body.shape.normals[f]) <= 0) continue;
      Facet facet{0, "<polygon points=\""};
      for (const std::int32_t v : body.shape.polygons[f]) {
        const Vec3 at = seen(body.shape.points[static_cast<std::size_t>(v)]);
        facet.nearness += at.z() / static_cast<double>(body.shape.polygons[f].size());
        fmt::format_to(std::back_inserter(facet.text), "{:.1f},{:.1f} ", at.x(), at.y());
      }
      const std::string fill = shaded(colour_of(body, f), body.shape.normals[f]);
      fmt::format_to(std::back_inserter(facet.text), "\" fill=\"{0}\" stroke=\"{0}\"/>\n", fill);
      facets.push_back(std::move(facet));
    }
  }
  std::stable_sort(facets.begin(), facets.end(),
                   [](const Facet& x, const Facet& y) { return x.nearness < y.nearness; });
  return facets;
}

/// Edges, those behind fainter.
void draw_edges(const EyePolytope& shape, const Lens& seen, std::string& text) {
  std::set<std::pair<std::int32_t, std::int32_t>> in_front;
  for (std::size_t f = 0; f < shape.polygons.size(); ++f) {
    if (towards_eye(shape.normals[f]) <= 0) continue;
    const auto& loop = shape.polygons[f];
    for (std::size_t i = 0; i < loop.size(); ++i) in_front.insert(std::minmax(loop[i], loop[(i + 1) % loop.size()]));
  }
  for (const auto& [from, to] : shape.edges) {
    const Vec3 a = seen(shape.points[static_cast<std::size_t>(from)]);
    const Vec3 b = seen(shape.points[static_cast<std::size_t>(to)]);
    const bool front = shape.polygons.empty() || in_front.contains(std::minmax(from, to));
    fmt::format_to(std::back_inserter(text),
                   "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                   front ? "edge" : "edge behind", a.x(), a.y(), b.x(), b.y());
  }
}

void draw_way(const DrawnWay& way, const Lens& seen, std::string& text) {
  const Vec3 a = seen(way.from);
  const Vec3 b = seen(way.to);
  const double length = std::hypot(b.x() - a.x(), b.y() - a.y());
  const char* kind = way.reported ? "reported" : "exact";
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "<circle class=\"way {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\"/>\n", kind, a.x(), a.y());
  if (length < 1) return;
  const double x = (b.x() - a.x()) / length;
  const double y = (b.y() - a.y()) / length;
  const double head = std::min(9.0, length);
  fmt::format_to(out, "<line class=\"way {}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, a.x(),
                 a.y(), b.x() - 0.7 * head * x, b.y() - 0.7 * head * y);
  fmt::format_to(out, "<polygon class=\"head {}\" points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\"/>\n", kind,
                 b.x(), b.y(), b.x() - head * x - 0.5 * head * y, b.y() - head * y + 0.5 * head * x,
                 b.x() - head * x + 0.5 * head * y, b.y() - head * y - 0.5 * head * x);
}

void write_vector(const Vec3& v, std::string& text) {
  fmt::format_to(std::back_inserter(text), "[{:.5g},{:.5g},{:.5g}]", v.x(), v.y(), v.z());
}

void write_body(const DrawnBody& body, std::string& text) {
  constexpr std::array kRoles{"a", "b", "difference"};
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{{\"role\":\"{}\",\"points\":[", kRoles[static_cast<std::size_t>(body.role)]);
  for (std::size_t i = 0; i < body.shape.points.size(); ++i) {
    if (i > 0) text += ",";
    write_vector(body.shape.points[i], text);
  }
  fmt::format_to(out, "],\"polygons\":[");
  for (std::size_t f = 0; f < body.shape.polygons.size(); ++f) {
    fmt::format_to(out, "{}[{}]", f > 0 ? "," : "", fmt::join(body.shape.polygons[f], ","));
  }
  fmt::format_to(out, "],\"kinds\":[{}],\"edges\":[", fmt::join(body.shape.kinds, ","));
  for (std::size_t e = 0; e < body.shape.edges.size(); ++e) {
    fmt::format_to(out, "{}[{}]", e > 0 ? "," : "", fmt::join(body.shape.edges[e], ","));
  }
  text += "]}";
}

}  // namespace

std::string drawing_of(const PairView& view, std::string_view label) {
  std::string text = fmt::format("<svg class=\"drawing\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                                 kPairWidth, kPairHeight, escaped(label));
  const Lens seen(view);
  for (const DrawnBody& body : view.bodies) draw_edges(body.shape, seen, text);
  text += "<g class=\"facets\">\n";
  for (const Facet& facet : facets_of(view, seen)) text += facet.text;
  text += "</g>\n";
  for (const DrawnBody& body : view.bodies) draw_edges(body.shape, seen, text);
  if (view.ball) {
    const Vec3 centre = seen(view.ball->centre);
    fmt::format_to(std::back_inserter(text), "<circle class=\"ball\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n",
                   centre.x(), centre.y(), seen.zoom() * view.ball->radius);
    fmt::format_to(std::back_inserter(text), "<text x=\"{:.1f}\" y=\"{:.1f}\">O</text>\n", centre.x() + 7,
                   centre.y() + 4);
  }
  for (const DrawnWay& way : view.ways) draw_way(way, seen, text);
  return text + "</svg>\n";
}

std::string json_of(const std::vector<PairView>& views) {
  std::string text = "[";
  for (std::size_t i = 0; i < views.size(); ++i) {
    text += i > 0 ? ",{\"bodies\":[" : "{\"bodies\":[";
    for (std::size_t k = 0; k < views[i].bodies.size(); ++k) {
      if (k > 0) text += ",";
      write_body(views[i].bodies[k], text);
    }
    text += "],\"ways\":[";
    for (std::size_t k = 0; k < views[i].ways.size(); ++k) {
      const DrawnWay& way = views[i].ways[k];
      text += k > 0 ? ",{\"from\":" : "{\"from\":";
      write_vector(way.from, text);
      text += ",\"to\":";
      write_vector(way.to, text);
      text += way.reported ? ",\"reported\":true}" : ",\"reported\":false}";
    }
    text += "]";
    if (views[i].ball) {
      text += ",\"ball\":{\"centre\":";
      write_vector(views[i].ball->centre, text);
      fmt::format_to(std::back_inserter(text), ",\"radius\":{:.5g}}}", views[i].ball->radius);
    }
    text += "}";
  }
  return text + "]";
}

}  // namespace pd::report
