#include "pd/contact/manifold.hpp"

#include <algorithm>
#include <cmath>

#include "contact/supporting_face.hpp"

namespace pd {

namespace {

using Vec2 = Eigen::Vector2d;

/// Segments within 3 degrees of each other are taken as lying along each other.
constexpr double kParallelSine = 0.05;
/// Two pairs closer than this times the size of the intersection are one.
constexpr double kMergeRatio = 1e-6;

/// A corner of the clipped polygon and the edge that leaves it: an edge of A's loop (`edge_of_b` false) or of B's.
struct ClipVertex {
  Vec2 point;
  std::int64_t id;
  std::int32_t edge;
  bool edge_of_b;
};

enum class IdKind : std::int64_t { vertex_a = 0, vertex_b = 1, crossing = 2, witness = 3 };

std::int64_t make_id(IdKind kind, std::int64_t a, std::int64_t b) {
  constexpr std::int64_t kMask = (std::int64_t{1} << 25) - 1;
  return (static_cast<std::int64_t>(kind) << 50) | ((a & kMask) << 25) | (b & kMask);
}

}  // namespace

namespace detail {

struct ManifoldBuffers {
  SupportingFace face_a;
  SupportingFace face_b;
  std::vector<ClipVertex> polygon;
  std::vector<ClipVertex> window;
  std::vector<ClipVertex> clipped;
  std::vector<ContactPoint> points;
  std::vector<Vec2> flat;  ///< the points across the normal
};

}  // namespace detail

namespace {

/// A right-handed frame (u, w, n) about an origin near the contact.
struct ContactFrame {
  Vec3 u, w, n, origin;

  ContactFrame(const Vec3& normal, const Vec3& centre) : n(normal), origin(centre) {
    int smallest = 0;
    n.cwiseAbs().minCoeff(&smallest);
    u = n.cross(Vec3::Unit(smallest)).normalized();
    w = n.cross(u);
  }
  [[nodiscard]] Vec2 flatten(const Vec3& x) const { return {(x - origin).dot(u), (x - origin).dot(w)}; }
  [[nodiscard]] double height(const Vec3& x) const { return (x - origin).dot(n); }
};

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Height along n, above `p` in the plane across n, of a face: of its plane, or of its segment at the nearest
/// parameter.
double face_height(const detail::SupportingFace& face, const ContactFrame& frame, const Vec2& p) {
  const Vec3& first = face.vertices[0].point;
  if (face.vertices.size() == 1) {
    return frame.height(first);
  }
  if (face.vertices.size() == 2) {
    const Vec2 start = frame.flatten(first);
    const Vec2 along = frame.flatten(face.vertices[1].point) - start;
    const double length_squared = along.squaredNorm();
    const double s = length_squared > 0 ? std::clamp((p - start).dot(along) / length_squared, 0.0, 1.0) : 0.0;
    return (1 - s) * frame.height(first) + s * frame.height(face.vertices[1].point);
  }
  const Vec2 offset = p - frame.flatten(first);
  const double slope = offset.x() * face.plane_normal.dot(frame.u) + offset.y() * face.plane_normal.dot(frame.w);
  return frame.height(first) - slope / face.plane_normal.dot(frame.n);
}

/// Loop of a face across n, counter-clockwise about n; a segment is a loop of two.
void load_polygon(const detail::SupportingFace& face, const ContactFrame& frame, IdKind kind,
                  std::vector<ClipVertex>& polygon) {
  polygon.clear();
  double twice_area = 0;
  const std::size_t size = face.vertices.size();
  for (std::size_t i = 0; i < size; ++i) {
    const auto& vertex = face.vertices[i];
    const std::int64_t id = kind == IdKind::vertex_a ? make_id(kind, vertex.id, 0) : make_id(kind, 0, vertex.id);
    polygon.push_back({frame.flatten(vertex.point), id, vertex.id, false});
  }
  for (std::size_t i = 0; i < size; ++i) {
    twice_area += cross(polygon[i].point, polygon[(i + 1) % size].point);
  }
  if (twice_area < 0) {
    std::reverse(polygon.begin(), polygon.end());
  }
}

/// Sutherland-Hodgman: `polygon` cut to the left of the line from `from` to `to`, which is edge `edge` of the other
/// loop.
void clip(std::vector<ClipVertex>& polygon, std::vector<ClipVertex>& out, const Vec2& from, const Vec2& to,
          std::int32_t edge, std::int64_t corner_id) {
  out.clear();
  const Vec2 along = to - from;
  const std::size_t size = polygon.size();
  for (std::size_t i = 0; i < size; ++i) {
    const ClipVertex& here = polygon[i];
    const ClipVertex& next = polygon[(i + 1) % size];
    const double side_here = cross(along, here.point - from);
    const double side_next = cross(along, next.point - from);
    if (side_here >= 0) {
      out.push_back(here);
    }
    if ((side_here > 0 && side_next < 0) || (side_here < 0 && side_next > 0)) {
      const double s = side_here / (side_here - side_next);
      const std::int64_t id = here.edge_of_b ? corner_id : make_id(IdKind::crossing, here.edge, edge);
      ClipVertex crossing{here.point + s * (next.point - here.point), id, here.edge, here.edge_of_b};
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
void overlap_of_segments(const detail::SupportingFace& a, const detail::SupportingFace& b, const ContactFrame& frame,
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
  const auto push = [&](double s, std::int64_t id) { polygon.push_back({a0 + s * da, id, 0, false}); };
  push(std::max(s0, 0.0), s0 > 0 ? make_id(IdKind::vertex_b, 0, id0) : make_id(IdKind::vertex_a, a.vertices[0].id, 0));
  push(std::min(s1, 1.0), s1 < 1 ? make_id(IdKind::vertex_b, 0, id1) : make_id(IdKind::vertex_a, a.vertices[1].id, 0));
}

void intersect_faces(detail::ManifoldBuffers& buffers, const ContactFrame& frame) {
  const auto& a = buffers.face_a;
  const auto& b = buffers.face_b;
  buffers.polygon.clear();
  if (a.vertices.size() < 2 || b.vertices.size() < 2) {
    return;  // a single point on one side: the witnesses are the contact
  }
  if (a.vertices.size() == 2 && b.vertices.size() == 2) {
    overlap_of_segments(a, b, frame, buffers.polygon);
    return;
  }
  // A segment is cut by the polygon, never the other way round: a loop of two has no inside.
  const bool cut_b = b.vertices.size() == 2;
  const auto& subject = cut_b ? b : a;
  const auto& window = cut_b ? a : b;
  load_polygon(window, frame, cut_b ? IdKind::vertex_a : IdKind::vertex_b, buffers.window);
  const std::vector<ClipVertex>& edges = buffers.window;
  load_polygon(subject, frame, cut_b ? IdKind::vertex_b : IdKind::vertex_a, buffers.polygon);
  for (std::size_t i = 0; i < edges.size() && !buffers.polygon.empty(); ++i) {
    clip(buffers.polygon, buffers.clipped, edges[i].point, edges[(i + 1) % edges.size()].point, edges[i].edge,
         edges[i].id);
  }
}

/// Keeps four of the points: `first`, the farthest from it, and the two that span most area to either side.
void reduce_to_four(std::vector<ContactPoint>& points, std::vector<Vec2>& flat, std::size_t first) {
  const auto move_to = [&](std::size_t slot, std::size_t from) {
    std::swap(points[slot], points[from]);
    std::swap(flat[slot], flat[from]);
  };
  const auto best_after = [&](std::size_t slot, auto&& value) {
    std::size_t best = slot;
    double best_value = value(flat[slot]);
    for (std::size_t i = slot + 1; i < flat.size(); ++i) {
      const double candidate = value(flat[i]);
      if (candidate > best_value) {
        best_value = candidate;
        best = i;
      }
    }
    move_to(slot, best);
  };
  move_to(0, first);
  best_after(1, [&](const Vec2& p) { return (p - flat[0]).squaredNorm(); });
  const Vec2 base = flat[1] - flat[0];
  best_after(2, [&](const Vec2& p) { return std::abs(cross(base, p - flat[0])); });
  // What a fourth point adds to the triangle: its distance beyond the edge that it sees, times that edge.
  const double turn = cross(base, flat[2] - flat[0]) < 0 ? -1 : 1;
  const auto beyond = [&](const Vec2& from, const Vec2& to, const Vec2& p) {
    return -turn * cross(to - from, p - from);
  };
  const std::array<Vec2, 3> triangle{flat[0], flat[1], flat[2]};
  best_after(3, [&](const Vec2& p) {
    return std::max({beyond(triangle[0], triangle[1], p), beyond(triangle[1], triangle[2], p),
                     beyond(triangle[2], triangle[0], p)});
  });
  points.resize(4);
  flat.resize(4);
}

}  // namespace

ManifoldScratch::ManifoldScratch() : buffers_(std::make_unique<detail::ManifoldBuffers>()) {}
ManifoldScratch::~ManifoldScratch() = default;
ManifoldScratch::ManifoldScratch(ManifoldScratch&&) noexcept = default;
ManifoldScratch& ManifoldScratch::operator=(ManifoldScratch&&) noexcept = default;

ContactManifold contact_manifold(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                                 double breaking_threshold, ManifoldScratch& scratch) {
  ContactManifold manifold;
  manifold.normal = answer.normal;
  const double signed_depth = answer.contact == ContactClass::separated ? -answer.distance : answer.depth;
  if (signed_depth < -breaking_threshold) {
    return manifold;
  }
  auto& buffers = scratch.buffers();
  const Vec3& n = answer.normal;
  const ContactFrame frame(n, 0.5 * (answer.witness_a + answer.witness_b));
  detail::supporting_face(a, -n, answer.feature_a, buffers.face_a);
  detail::supporting_face(b, n, answer.feature_b, buffers.face_b);
  intersect_faces(buffers, frame);

  const double margin_a = a.shape->margin();
  const double margin_b = b.shape->margin();
  auto& points = buffers.points;
  auto& flat = buffers.flat;
  points.clear();
  flat.clear();
  double size = 0;
  for (const ClipVertex& vertex : buffers.polygon) {
    size = std::max(size, vertex.point.cwiseAbs().maxCoeff());
  }
  double deepest = -breaking_threshold;
  for (const ClipVertex& vertex : buffers.polygon) {
    const double height_a = face_height(buffers.face_a, frame, vertex.point) - margin_a;
    const double height_b = face_height(buffers.face_b, frame, vertex.point) + margin_b;
    // Along n no pair is deeper than the bodies are; what the lifted heights say beyond that is rounding.
    const double depth = std::min(height_b - height_a, signed_depth);
    const bool repeated = std::any_of(flat.begin(), flat.end(), [&](const Vec2& p) {
      return (p - vertex.point).cwiseAbs().maxCoeff() <= kMergeRatio * size;
    });
    if (depth < -breaking_threshold || repeated) {
      continue;
    }
    const Vec3 on_b = frame.origin + vertex.point.x() * frame.u + vertex.point.y() * frame.w + height_b * n;
    points.push_back({on_b - depth * n, on_b, depth, vertex.id});
    flat.push_back(vertex.point);
    deepest = std::max(deepest, depth);
  }
  // The witnesses join when the faces' corners miss them by more than the noise that a resting contact shows.
  const double noise = std::max(1e-3 * breaking_threshold, kMergeRatio * size);
  std::size_t first = 0;
  if (points.empty() || deepest < signed_depth - noise) {
    const Vec3 on_b = answer.witness_b;
    first = points.size();
    points.push_back({on_b - signed_depth * n, on_b, signed_depth, make_id(IdKind::witness, 0, 0)});
    flat.push_back(frame.flatten(on_b));
  } else {
    // Among points as deep as the deepest, one that stays the same while the noise changes.
    double best = -HUGE_VAL;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].depth >= deepest - noise && flat[i].x() + 0.618 * flat[i].y() > best) {
        best = flat[i].x() + 0.618 * flat[i].y();
        first = i;
      }
    }
  }
  if (points.size() > 4) {
    reduce_to_four(points, flat, first);
  }
  manifold.count = static_cast<int>(points.size());
  std::copy(points.begin(), points.end(), manifold.points.begin());
  return manifold;
}

}  // namespace pd
