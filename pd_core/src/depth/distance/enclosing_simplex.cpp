#include "depth/distance/enclosing_simplex.hpp"

#include "depth/distance/closest_of_few.hpp"
#include "depth/distance/nearest_of_few.hpp"
#include "depth/distance/simplex_lanes.hpp"

namespace pd::detail {

namespace {

/// More supports than slender bodies were seen to need.
constexpr int kMostAround = 32;

EnclosingSimplex among_few(const PolytopeDifference& difference, std::span<const DifferenceVertex, 4> start,
                           std::int64_t& support_calls) {
  VertexPair first[4];
  for (std::size_t i = 0; i < 4; ++i) first[i] = {start[i].a, start[i].b};
  const double error = support_plane_error(difference);
  const NearestOfFew found =
      nearest_of_few(posed_few(difference), first, 4, {kSearchGap * difference.reach(), error, 0});
  support_calls += found.supports;
  EnclosingSimplex out;
  out.count = found.count;
  for (int i = 0; i < found.count; ++i) out.simplex[i] = difference.vertex(found.simplex[i].a, found.simplex[i].b);
  if (found.status == NearestOfFew::Status::enclosed) out.status = EnclosingSimplex::Status::encloses;
  if (found.status != NearestOfFew::Status::beyond) return out;
  out.status = EnclosingSimplex::Status::apart;
  out.normal = {found.direction[0], found.direction[1], found.direction[2]};
  out.upper = error - found.height;
  out.separating = difference.vertex(found.support.a, found.support.b);
  return out;
}

LanePoint lane_point(const DifferenceVertex& v) { return {v.x.x(), v.x.y(), v.x.z(), v.a, v.b}; }

EnclosingSimplex among_many(const PolytopeDifference& difference, std::span<const DifferenceVertex, 4> start,
                            std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  const double error = support_plane_error(difference);
  EnclosingSimplex out;
  NearestLaneFace face{};
  const auto put_corners = [&] {
    out.count = face.count;
    for (int i = 0; i < face.count; ++i) {
      const LanePoint& p = face.corners[i];
      out.simplex[i] = {{p.x, p.y, p.z}, p.a, p.b};
    }
  };
  // Of flat vertices only rounding can say that they enclose anything.
  for (const DifferenceVertex& v : start) {
    if (!add_to_face(face, lane_point(v))) return out;
  }
  for (int step = 0; step < kMostAround && face.length > 4 * error; ++step) {
    const Vec3 toward(face.toward.x, face.toward.y, face.toward.z);
    DifferenceVertex s = difference.search_support_along(toward);
    ++support_calls;
    if (s.x.dot(toward) < 0) {
      s = difference.certified_support(toward, s, stack);
      const double upper = s.x.dot(toward) + error;
      if (upper < 0) {
        put_corners();
        out.status = EnclosingSimplex::Status::apart;
        out.normal = toward;
        out.upper = upper;
        out.separating = s;
        return out;
      }
    }
    for (int i = 0; i < face.count; ++i) {
      if (face.corners[i].a == s.a && face.corners[i].b == s.b) return out;
    }
    const double length = face.length;
    if (!add_to_face(face, lane_point(s))) {
      put_corners();
      out.simplex[out.count++] = s;
      out.status = EnclosingSimplex::Status::encloses;
      return out;
    }
    if (!(face.length < length)) return out;
  }
  return out;
}

}  // namespace

EnclosingSimplex enclosing_simplex(const PolytopeDifference& difference, std::span<const DifferenceVertex, 4> start,
                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  return difference.climbs() ? among_many(difference, start, stack, support_calls)
                             : among_few(difference, start, support_calls);
}

}  // namespace pd::detail
