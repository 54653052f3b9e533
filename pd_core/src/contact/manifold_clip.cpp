#include "contact/manifold_clip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pd::detail {

namespace {

/// Two edges within 3 degrees of each other make contact along both. Their crossing would be a poor contact point: it
/// slides along the edges by up to 1 / 0.05 = 20 times what the bodies move.
constexpr double kParallelSine = 0.05;

std::int64_t corner_id(IdKind kind, std::int32_t vertex) {
  return kind == IdKind::vertex_a ? make_id(kind, vertex, 0) : make_id(kind, 0, vertex);
}

/// Loop of a face across n, counter-clockwise about n; a segment is a loop of two.
void load_polygon(const SupportingFace& face, const ContactFrame& frame, IdKind kind,
                  std::vector<ClipVertex>& polygon) {
  const std::size_t size = face.vertices.size();
  polygon.resize(size);
  const Vec3 u = frame.u, w = frame.w, origin = frame.origin;
  for (std::size_t i = 0; i < size; ++i) {
    const FaceVertex& vertex = face.vertices[i];
    const Vec3 x = vertex.point - origin;
    polygon[i] = {{x.dot(u), x.dot(w)}, corner_id(kind, vertex.id), vertex.id, false};
  }
  double twice_area = 0;
  const ClipVertex* last = &polygon[0];
  for (std::size_t i = 1; i < size; ++i) {
    twice_area += cross(last->point, polygon[i].point);
    last = &polygon[i];
  }
  twice_area += cross(last->point, polygon[0].point);
  if (twice_area < 0) {
    std::reverse(polygon.begin(), polygon.end());
  }
}

/// On which side of the line from `from` to `to` each corner lies, > 0 to the left. @return whether none is outside.
bool find_sides(const std::vector<ClipVertex>& polygon, const Vec2& from, const Vec2& to, std::vector<double>& sides) {
  const Vec2 along = to - from;
  const std::size_t size = polygon.size();
  sides.resize(size);
  bool all = true;
  for (std::size_t i = 0; i < size; ++i) {
    sides[i] = cross(along, polygon[i].point - from);
    all &= sides[i] >= 0;
  }
  return all;
}

/// A circle across n that a disc's rim lies in.
struct Circle {
  Vec2 centre = Vec2::Zero();
  double radius = 0;

  Circle() = default;
  Circle(const SupportingFace& disc, const ContactFrame& frame) {
    const Vec3 &start = disc.vertices[0].point, &across = disc.vertices[kRimPoints / 2].point;
    centre = frame.flatten(0.5 * (start + across));
    radius = (1 + 0x1p-20) * 0.5 * (start - across).norm();
  }
  [[nodiscard]] bool is_left_of(const Vec2& from, const Vec2& to) const {
    const Vec2 along = to - from;
    return cross(along, centre - from) >= radius * along.norm();
  }
};

/// Sutherland-Hodgman: `polygon` cut to the left of the line from `from` to `to`, which is edge `edge` of the other
/// loop, whose corners have ids of kind `window`.
void clip(ClipBuffers& buffers, const Vec2& from, const Vec2& to, std::int32_t edge, IdKind window) {
  std::vector<ClipVertex>& polygon = buffers.polygon;
  std::vector<ClipVertex>& out = buffers.clipped;
  if (find_sides(polygon, from, to, buffers.sides)) return;
  buffers.whole_rim = false;
  out.clear();
  const std::size_t size = polygon.size();
  for (std::size_t i = 0; i < size; ++i) {
    const ClipVertex& here = polygon[i];
    const std::size_t after = i + 1 < size ? i + 1 : 0;
    const double side_here = buffers.sides[i], side_next = buffers.sides[after];
    if (side_here >= 0) {
      out.push_back(here);
    }
    if ((side_here > 0 && side_next < 0) || (side_here < 0 && side_next > 0)) {
      const double s = side_here / (side_here - side_next);
      // Two edges of the window meet where the later one starts.
      const std::int64_t id = here.edge_of_b ? corner_id(window, side_here > 0 ? edge : here.edge)
                                             : make_id(IdKind::crossing, here.edge, edge);
      ClipVertex crossing{here.point + s * (polygon[after].point - here.point), id, here.edge, here.edge_of_b};
      if (side_here > 0) {
        crossing.edge = edge;
        crossing.edge_of_b = true;
      }
      out.push_back(crossing);
    } else if (side_here == 0 && side_next < 0 && !out.empty()) {
      out.back().edge = edge;
      out.back().edge_of_b = true;
    }
  }
  polygon.swap(out);
}

/// The interval that two nearly parallel segments share, as a loop of two; empty where they cross or miss.
void overlap_of_segments(const SupportingFace& a, const SupportingFace& b, const ContactFrame& frame, double most_aside,
                         std::vector<ClipVertex>& polygon) {
  polygon.clear();
  const Vec2 a0 = frame.flatten(a.vertices[0].point);
  const Vec2 b0 = frame.flatten(b.vertices[0].point);
  const Vec2 da = frame.flatten(a.vertices[1].point) - a0;
  const Vec2 db = frame.flatten(b.vertices[1].point) - b0;
  if (std::abs(cross(da, db)) > kParallelSine * da.norm() * db.norm()) {
    return;
  }
  const double scale = da.squaredNorm();
  if (scale == 0) {
    return;
  }
  double s0 = (b0 - a0).dot(da) / scale;
  double s1 = (b0 + db - a0).dot(da) / scale;
  std::int32_t id0 = b.vertices[0].id;
  std::int32_t id1 = b.vertices[1].id;
  if (s0 > s1) {
    std::swap(s0, s1);
    std::swap(id0, id1);
  }
  if (s0 > 1 || s1 < 0) {
    return;
  }
  const double length_b = db.norm();
  const auto aside = [&](double s) { return std::abs(cross(a0 + std::clamp(s, 0.0, 1.0) * da - b0, db)); };
  if (std::max(aside(s0), aside(s1)) > most_aside * (da.norm() + length_b) * length_b) return;
  const auto push = [&](double s, std::int64_t id) { polygon.push_back({a0 + s * da, id, 0, false}); };
  push(std::max(s0, 0.0), s0 > 0 ? make_id(IdKind::vertex_b, 0, id0) : make_id(IdKind::vertex_a, a.vertices[0].id, 0));
  push(std::min(s1, 1.0), s1 < 1 ? make_id(IdKind::vertex_b, 0, id1) : make_id(IdKind::vertex_a, a.vertices[1].id, 0));
}

}  // namespace

FaceHeight::FaceHeight(const SupportingFace& face, const ContactFrame& frame)
    : corners_(face.vertices.size()),
      start_(frame.flatten(face.vertices[0].point)),
      height_(frame.height(face.vertices[0].point)),
      along_(Vec2::Zero()),
      scale_(0) {
  if (corners_ == 2) {
    along_ = frame.flatten(face.vertices[1].point) - start_;
    scale_ = along_.squaredNorm();
    end_ = frame.height(face.vertices[1].point);
  } else if (corners_ > 2) {
    along_ = {face.plane_normal.dot(frame.u), face.plane_normal.dot(frame.w)};
    scale_ = face.plane_normal.dot(frame.n);
  }
}

void intersect_faces(const SupportingFace& a, const SupportingFace& b, const ContactFrame& frame, double most_aside,
                     ClipBuffers& buffers) {
  buffers.polygon.clear();
  buffers.whole_rim = false;
  if (a.vertices.size() < 2 || b.vertices.size() < 2) {
    return;  // a single point on one side: the witnesses are the contact
  }
  if (a.vertices.size() == 2 && b.vertices.size() == 2) {
    overlap_of_segments(a, b, frame, most_aside, buffers.polygon);
    return;
  }
  // A segment is cut by the polygon, never the other way around: a loop of two has no inside. Else the face of more
  // corners is cut, by fewer edges: a disc on a floor mostly lies inside of all four.
  const bool cut_b = b.vertices.size() == 2 || (a.vertices.size() > 2 && b.vertices.size() > a.vertices.size());
  const auto& subject = cut_b ? b : a;
  const auto& window = cut_b ? a : b;
  const IdKind of_window = cut_b ? IdKind::vertex_a : IdKind::vertex_b;
  load_polygon(window, frame, of_window, buffers.window);
  const std::vector<ClipVertex>& edges = buffers.window;
  load_polygon(subject, frame, cut_b ? IdKind::vertex_b : IdKind::vertex_a, buffers.polygon);
  buffers.whole_rim = subject.rim;
  const Circle circle = subject.rim ? Circle(subject, frame) : Circle();
  for (std::size_t i = 0; i < edges.size() && !buffers.polygon.empty(); ++i) {
    const Vec2 &from = edges[i].point, &to = edges[i + 1 < edges.size() ? i + 1 : 0].point;
    // Nothing of a disc that lies inside is cut.
    if (buffers.whole_rim && circle.is_left_of(from, to)) continue;
    clip(buffers, from, to, edges[i].edge, of_window);
  }
}

}  // namespace pd::detail
