/// @file
/// `ConvexPolytope::from_faces`: a surface is accepted exactly when it is the boundary of the convex hull of its
/// vertices.
///
/// Why the checks suffice: every face is a proper convex polygon in one plane, every directed edge is met once by a
/// face on each side, and the rims of the connected coplanar patches are, corner for corner, the facets of the exact
/// hull, each once. A patch is a surface in a plane whose pieces all turn the same way and whose rim runs once round a
/// convex polygon, so it covers that polygon once. Hence the surface is the hull's boundary, and the hull is the
/// answer.
#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "numeric/number_text.hpp"
#include "pd/numeric/predicates.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "shape/hull/disjoint_sets.hpp"
#include "shape/hull/hull_builder.hpp"

namespace pd {
namespace {

using detail::indexed;

std::size_t size(std::int32_t i) { return static_cast<std::size_t>(i); }

Error refuse_face(ErrorCode code, std::int32_t face, std::string message) {
  return {code, std::move(message), indexed("faces", face)};
}

/// Faces over the distinct used points: point p of the surface is `points[p]`, first met by the caller as
/// `caller_ids[p]`.
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::int32_t> caller_ids;
  std::span<const std::int32_t> offsets;
  std::vector<std::int32_t> corners;  ///< points, face by face
  std::vector<std::int32_t> face_of;  ///< of a corner; the edge of a corner runs to the next corner of its face
  std::vector<std::int32_t> twin;     ///< of an edge

  [[nodiscard]] std::int32_t num_faces() const { return static_cast<std::int32_t>(offsets.size()) - 1; }
  [[nodiscard]] std::int32_t next(std::int32_t corner) const {
    return corner + 1 < offsets[size(face_of[size(corner)]) + 1] ? corner + 1 : offsets[size(face_of[size(corner)])];
  }
  [[nodiscard]] const Vec3& point(std::int32_t corner) const { return points[size(corners[size(corner)])]; }
};

std::optional<Error> refuse_lists(std::size_t num_points, std::span<const std::int32_t> offsets,
                                  std::span<const std::int32_t> vertices) {
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != static_cast<std::int32_t>(vertices.size())) {
    return Error{ErrorCode::bad_faces, "face offsets must run from 0 to the number of face vertices", "faces"};
  }
  if (offsets.size() == 1) return Error{ErrorCode::bad_faces, "no faces", "faces"};
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    const auto face = static_cast<std::int32_t>(f);
    // A last offset that is right does not bound those before it.
    if (offsets[f + 1] < offsets[f] || size(offsets[f + 1]) > vertices.size()) {
      return refuse_face(ErrorCode::bad_faces, face, "face offsets must not decrease");
    }
    if (offsets[f + 1] - offsets[f] < 3) {
      return refuse_face(ErrorCode::bad_faces, face,
                         std::to_string(offsets[f + 1] - offsets[f]) + " vertices; a face needs 3 at least");
    }
    for (std::int32_t i = offsets[f]; i < offsets[f + 1]; ++i) {
      const std::int32_t v = vertices[size(i)];
      if (v < 0 || size(v) >= num_points) {
        return refuse_face(ErrorCode::bad_faces, face,
                           "vertex index " + std::to_string(v) + " is outside 0.." + std::to_string(num_points - 1));
      }
    }
  }
  return std::nullopt;
}

/// Equal points become one, the lowest of their ids; unused points are left out.
Surface identify_points(std::span<const Vec3> points, std::span<const std::int32_t> offsets,
                        std::span<const std::int32_t> vertices) {
  Surface s;
  s.offsets = offsets;
  std::vector<std::int32_t> used(vertices.begin(), vertices.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::stable_sort(used.begin(), used.end(), [&](std::int32_t i, std::int32_t j) {
    const Vec3& p = points[size(i)];
    const Vec3& q = points[size(j)];
    return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
  });
  std::vector<std::int32_t> place(points.size(), -1);
  for (const std::int32_t i : used) {
    if (s.points.empty() || s.points.back() != points[size(i)]) {
      s.points.push_back(points[size(i)]);
      s.caller_ids.push_back(i);
    }
    place[size(i)] = static_cast<std::int32_t>(s.points.size()) - 1;
  }
  s.corners.reserve(vertices.size());
  for (const std::int32_t v : vertices) s.corners.push_back(place[size(v)]);
  s.face_of.resize(vertices.size());
  for (std::int32_t f = 0; f < s.num_faces(); ++f) {
    std::fill(s.face_of.begin() + offsets[size(f)], s.face_of.begin() + offsets[size(f) + 1], f);
  }
  return s;
}

std::optional<Error> refuse_repeated_vertices(const Surface& s) {
  std::vector<std::int32_t> last_face(s.points.size(), -1);
  for (std::size_t c = 0; c < s.corners.size(); ++c) {
    std::int32_t& last = last_face[size(s.corners[c])];
    if (last == s.face_of[c]) {
      return refuse_face(ErrorCode::bad_faces, s.face_of[c],
                         "the vertex " + std::to_string(s.caller_ids[size(s.corners[c])]) +
                             " (or one at the same place) occurs twice; a face meets each vertex once");
    }
    last = s.face_of[c];
  }
  return std::nullopt;
}

/// Fills `twin`: each directed edge once, and its reverse once.
std::optional<Error> pair_edges(Surface& s) {
  const auto low = [&](std::int32_t c) { return std::min(s.corners[size(c)], s.corners[size(s.next(c))]); };
  const auto high = [&](std::int32_t c) { return std::max(s.corners[size(c)], s.corners[size(s.next(c))]); };
  const auto forward = [&](std::int32_t c) { return s.corners[size(c)] == low(c); };
  std::vector<std::int32_t> order(s.corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t i, std::int32_t j) {
    if (low(i) != low(j)) return low(i) < low(j);
    if (high(i) != high(j)) return high(i) < high(j);
    return i < j;
  });
  s.twin.assign(s.corners.size(), -1);
  const auto edge_text = [&](std::int32_t c) {
    return "the edge from vertex " + std::to_string(s.caller_ids[size(s.corners[size(c)])]) + " to " +
           std::to_string(s.caller_ids[size(s.corners[size(s.next(c))])]);
  };
  std::optional<Error> open;  // told only when no edge is met twice in one direction: a flipped face does both
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && low(order[end]) == low(order[i]) && high(order[end]) == high(order[i])) ++end;
    for (std::size_t j = i + 1; j < end; ++j) {
      for (std::size_t k = i; k < j; ++k) {
        if (forward(order[j]) == forward(order[k])) {
          return refuse_face(ErrorCode::bad_faces, s.face_of[size(order[j])],
                             edge_text(order[j]) + " is run in the same direction by " +
                                 indexed("faces", s.face_of[size(order[k])]) +
                                 "; neighbours must be oriented alike, counter-clockwise from outside");
        }
      }
    }
    if (end - i == 1) {
      if (!open) {
        open = refuse_face(ErrorCode::not_closed, s.face_of[size(order[i])],
                           edge_text(order[i]) + " has a face on one side only");
      }
    } else {
      s.twin[size(order[i])] = order[i + 1];
      s.twin[size(order[i + 1])] = order[i];
    }
    i = end;
  }
  return open;
}

/// The first corners of a face that are not collinear, or an empty list.
std::vector<std::int32_t> plane_corners(const Surface& s, std::int32_t face) {
  const std::int32_t begin = s.offsets[size(face)];
  const std::int32_t end = s.offsets[size(face) + 1];
  for (std::int32_t c = begin + 2; c < end; ++c) {
    if (!collinear(s.point(begin), s.point(begin + 1), s.point(c))) return {begin, begin + 1, c};
  }
  return {};
}

/// 1 or -1 for a convex polygon that turns counter- or clockwise in the projection, 0 for anything else. Collinear
/// corners are allowed.
int convex_turn(const Surface& s, std::int32_t face, int axis) {
  const auto seen = [&](std::int32_t c) {
    const Vec3& p = s.point(c);
    return std::array<double, 2>{p[(axis + 1) % 3], p[(axis + 2) % 3]};
  };
  // All turns agree, and the direction of the edges crosses the lexicographic order twice: one full turn, not more.
  int turn = 0;
  int crossings = 0;
  for (std::int32_t c = s.offsets[size(face)]; c < s.offsets[size(face) + 1]; ++c) {
    const auto p = seen(c);
    const auto q = seen(s.next(c));
    const auto r = seen(s.next(s.next(c)));
    const int here = orient2d(p, q, r);
    if (here * turn < 0) return 0;
    if (here != 0) turn = here;
    if ((p < q) != (q < r)) ++crossings;
  }
  return crossings == 2 ? turn : 0;
}

/// Checks each face by itself; returns for each the corners that span its plane, oriented as the face.
std::optional<Error> check_faces(const Surface& s, std::vector<std::int32_t>& spans) {
  for (std::int32_t f = 0; f < s.num_faces(); ++f) {
    const std::vector<std::int32_t> span = plane_corners(s, f);
    if (span.empty()) return refuse_face(ErrorCode::bad_faces, f, "all vertices of the face lie on one line");
    const Vec3& a = s.point(span[0]);
    const Vec3& b = s.point(span[1]);
    const Vec3& c = s.point(span[2]);
    for (std::int32_t k = s.offsets[size(f)]; k < s.offsets[size(f) + 1]; ++k) {
      if (!coplanar(a, b, c, s.point(k))) {
        return refuse_face(ErrorCode::not_convex, f,
                           "vertex " + std::to_string(s.caller_ids[size(s.corners[size(k)])]) +
                               " is not in the plane of the face; split the face into triangles, or give points only");
      }
    }
    int axis = 2;
    const auto turn_of_span = [&] {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      return orient2d({a[u], a[v]}, {b[u], b[v]}, {c[u], c[v]});
    };
    while (turn_of_span() == 0) --axis;
    const int turn = convex_turn(s, f, axis);
    if (turn == 0) return refuse_face(ErrorCode::not_convex, f, "the face is not a convex polygon");
    spans.insert(spans.end(), span.begin(), span.end());
    if (turn != turn_of_span()) std::swap(spans[spans.size() - 1], spans[spans.size() - 2]);
  }
  return std::nullopt;
}

/// A face with vertices of the hull on both sides is a dent; one with all of them above is inside out.
std::optional<Error> check_sides(const Surface& s, const std::vector<std::int32_t>& spans, const ConvexPolytope& hull) {
  for (std::int32_t f = 0; f < s.num_faces(); ++f) {
    const auto side = [&](int v) {
      const std::int32_t* span = spans.data() + 3 * size(f);
      return orient3d(s.point(span[0]), s.point(span[1]), s.point(span[2]), hull.vertex(v));
    };
    int v = 0;
    while (side(v) == 0) ++v;
    if (side(v) < 0) continue;
    bool inside_out = true;
    for (int w = v; w < hull.num_vertices() && inside_out; ++w) inside_out = side(w) >= 0;
    if (inside_out) {
      return refuse_face(ErrorCode::bad_faces, f,
                         "the body lies in front of the face: vertices must be counter-clockwise from outside");
    }
    return refuse_face(ErrorCode::not_convex, f,
                       "vertex " + std::to_string(hull.caller_id(v)) + " lies in front of the face");
  }
  return std::nullopt;
}

/// Compares the rims of the coplanar patches with the facets of the hull.
std::optional<Error> check_patches(const Surface& s, const std::vector<std::int32_t>& spans,
                                   const ConvexPolytope& hull) {
  detail::DisjointSets patches(size(s.num_faces()));
  const auto edges = static_cast<std::int32_t>(s.corners.size());
  std::vector<bool> rim(s.corners.size());
  for (std::int32_t e = 0; e < edges; ++e) {
    const std::int32_t f = s.face_of[size(e)];
    const std::int32_t g = s.face_of[size(s.twin[size(e)])];
    const std::int32_t* span = spans.data() + 3 * size(f);
    bool flat = true;
    for (int k = 0; k < 3 && flat; ++k) {
      flat = coplanar(s.point(span[0]), s.point(span[1]), s.point(span[2]), s.point(spans[3 * size(g) + size(k)]));
    }
    rim[size(e)] = !flat;
    if (flat) patches.unite(f, g);
  }
  // Both lists are in lexicographic order, and every vertex of the hull is a point of the surface.
  std::vector<std::int32_t> hull_vertex(s.points.size(), -1);
  for (std::size_t p = 0, v = 0; v < size(hull.num_vertices()); ++p) {
    if (s.points[p] == hull.vertex(static_cast<int>(v))) hull_vertex[p] = static_cast<std::int32_t>(v++);
  }

  std::vector<bool> met(size(hull.num_facets()), false);
  std::vector<bool> walked(s.corners.size(), false);
  int num_patches = 0;
  for (std::int32_t f = 0; f < s.num_faces(); ++f) num_patches += patches.find(f) == f ? 1 : 0;
  std::vector<std::int32_t> loop;
  int num_rims = 0;
  for (std::int32_t first = 0; first < edges; ++first) {
    if (!rim[size(first)] || walked[size(first)]) continue;
    ++num_rims;
    loop.clear();
    std::int32_t e = first;
    do {
      walked[size(e)] = true;
      const std::int32_t v = hull_vertex[size(s.corners[size(e)])];
      if (v >= 0) loop.push_back(v);
      e = s.next(e);
      while (!rim[size(e)]) e = s.next(s.twin[size(e)]);
    } while (e != first);
    const std::int32_t face = s.face_of[size(first)];
    const Error differs =
        refuse_face(ErrorCode::not_convex, face, "the face is no part of a facet of the convex hull of the vertices");
    if (loop.size() < 3) return differs;
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    int facet = -1;
    for (int h = hull.first_half_edge(loop[0]);
         h < hull.first_half_edge(loop[0]) + static_cast<int>(hull.neighbours(loop[0]).size()); ++h) {
      if (hull.target(h) == loop[1]) facet = hull.half_edge(h).facet;
    }
    if (facet < 0 || met[size(facet)]) return differs;
    const auto expected = hull.facet_vertices(facet);
    if (!std::equal(loop.begin(), loop.end(), expected.begin(), expected.end())) return differs;
    met[size(facet)] = true;
  }
  if (num_rims != hull.num_facets() || num_patches != hull.num_facets()) {
    return Error{ErrorCode::not_convex, "the faces are not the boundary of the convex hull of the vertices", "faces"};
  }
  return std::nullopt;
}

}  // namespace

Expected<ConvexPolytope> ConvexPolytope::from_faces(std::span<const Vec3> points,
                                                    std::span<const std::int32_t> face_offsets,
                                                    std::span<const std::int32_t> face_vertices) {
  if (auto refused = detail::refuse_points(points)) return *std::move(refused);
  if (auto refused = refuse_lists(points.size(), face_offsets, face_vertices)) return *std::move(refused);
  Surface surface = identify_points(points, face_offsets, face_vertices);
  if (auto refused = refuse_repeated_vertices(surface)) return *std::move(refused);
  if (auto refused = pair_edges(surface)) return *std::move(refused);

  ConvexPolytope hull = detail::build_hull(surface.points, surface.caller_ids);
  if (hull.affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional,
                 "the vertices span " + std::to_string(hull.affine_dimension()) +
                     " dimensions; a surface with faces encloses a volume (give points only for a flat body)",
                 "faces"};
  }
  std::vector<std::int32_t> spans;
  spans.reserve(3 * face_offsets.size());
  if (auto refused = check_faces(surface, spans)) return *std::move(refused);
  if (auto refused = check_sides(surface, spans, hull)) return *std::move(refused);
  if (auto refused = check_patches(surface, spans, hull)) return *std::move(refused);
  return hull;
}

}  // namespace pd
