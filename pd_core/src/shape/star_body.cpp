#include "pd/shape/star_body.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "numeric/number_text.hpp"
#include "pd/numeric/predicates.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

namespace {

std::optional<Error> refuse_point(const Vec3& x, const std::string& where) {
  if (!x.allFinite()) return Error{ErrorCode::non_finite, "a point needs three finite numbers", where};
  if (x.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return Error{ErrorCode::out_of_range, "coordinates are limited to " + detail::number_text(kMaxCoordinate), where};
  }
  return std::nullopt;
}

/// How often a surface that sees the centre from every face runs round it: the faces that a generic ray leaves through.
int turns_round(std::span<const Vec3> vertices, std::span<const StarBody::Triangle> faces, const Vec3& centre) {
  const auto corner = [&](const StarBody::Triangle& f, std::size_t k) {
    return vertices[static_cast<std::size_t>(f[k])];
  };
  // Points of one face until the ray through one meets no edge.
  for (int attempt = 1;; ++attempt) {
    const StarBody::Triangle& f = faces[0];
    const double s = 1.0 / (2 + attempt), t = 1.0 / (3 + attempt * 0.618);
    const Vec3 aim = corner(f, 0) + s * (corner(f, 1) - corner(f, 0)) + t * (corner(f, 2) - corner(f, 0));
    int count = 0;
    bool generic = true;
    for (const StarBody::Triangle& face : faces) {
      const std::array<int, 3> side{orient3d(centre, corner(face, 0), corner(face, 1), aim),
                                    orient3d(centre, corner(face, 1), corner(face, 2), aim),
                                    orient3d(centre, corner(face, 2), corner(face, 0), aim)};
      const bool inside = side[0] >= 0 && side[1] >= 0 && side[2] >= 0;
      generic = generic && (!inside || (side[0] > 0 && side[1] > 0 && side[2] > 0));
      count += inside ? 1 : 0;
    }
    if (generic && count > 0) return count;
  }
}

/// Three different vertices, and the centre strictly below the plane.
std::optional<Error> refuse_face(const StarBody::Triangle& face, std::span<const Vec3> vertices, const Vec3& centre,
                                 const std::string& where) {
  for (const std::int32_t v : face) {
    if (v < 0 || static_cast<std::size_t>(v) >= vertices.size()) {
      return Error{ErrorCode::bad_faces,
                   std::to_string(v) + " is no vertex; indices run from 0 to " + std::to_string(vertices.size() - 1),
                   where};
    }
  }
  if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
    return Error{ErrorCode::bad_faces, "a face names a vertex twice; three different ones make a triangle", where};
  }
  const auto corner = [&](std::size_t k) { return vertices[static_cast<std::size_t>(face[k])]; };
  if (orient3d(corner(0), corner(1), corner(2), centre) >= 0) {
    return Error{ErrorCode::bad_faces,
                 "the face does not see the centre from inside: its corners must turn counter-clockwise seen from "
                 "outside, and the centre must lie strictly below its plane",
                 where};
  }
  return std::nullopt;
}

}  // namespace

Expected<StarBody> StarBody::from_faces(std::span<const Vec3> vertices, std::span<const Triangle> faces,
                                        const Vec3& centre) {
  using detail::indexed;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (auto refused = refuse_point(vertices[i], indexed("vertices", static_cast<long long>(i)))) {
      return *std::move(refused);
    }
  }
  if (auto refused = refuse_point(centre, "center")) return *std::move(refused);
  if (vertices.size() < 4 || faces.size() < 4) {
    return Error{ErrorCode::too_few_points, "a closed surface has at least four vertices and four faces",
                 vertices.size() < 4 ? "vertices" : "faces"};
  }
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> face_of_edge;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::string where = indexed("faces", static_cast<long long>(f));
    const Triangle& face = faces[f];
    if (auto refused = refuse_face(face, vertices, centre, where)) return *std::move(refused);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!face_of_edge.try_emplace({face[k], face[(k + 1) % 3]}, f).second) {
        return Error{ErrorCode::bad_faces,
                     "the edge from vertex " + std::to_string(face[k]) + " to " + std::to_string(face[(k + 1) % 3]) +
                         " is run in one direction by two faces; neighbours run their edge in opposite directions",
                     where};
      }
    }
  }
  for (const auto& [edge, f] : face_of_edge) {
    if (!face_of_edge.contains({edge.second, edge.first})) {
      return Error{ErrorCode::not_closed,
                   "no face lies across the edge from vertex " + std::to_string(edge.first) + " to " +
                       std::to_string(edge.second) + "; a body's surface is closed",
                   indexed("faces", static_cast<long long>(f))};
    }
  }
  if (const int turns = turns_round(vertices, faces, centre); turns != 1) {
    return Error{ErrorCode::bad_faces,
                 "a ray from the centre leaves through " + std::to_string(turns) +
                     " faces; the surface of a star-shaped body is met once by each",
                 "faces"};
  }
  StarBody body;
  body.vertices_.assign(vertices.begin(), vertices.end());
  body.faces_.assign(faces.begin(), faces.end());
  body.centre_ = centre;
  return body;
}

Compound StarBody::tetrahedra() const {
  std::vector<Compound::Part> parts;
  parts.reserve(faces_.size());
  for (const Triangle& face : faces_) {
    const std::array<Vec3, 4> corners{vertices_[static_cast<std::size_t>(face[0])],
                                      vertices_[static_cast<std::size_t>(face[1])],
                                      vertices_[static_cast<std::size_t>(face[2])], centre_};
    parts.push_back({*ConvexPolytope::from_points(corners), Pose()});
  }
  return *Compound::from_parts(std::move(parts));
}

}  // namespace pd
