#include "pd/depth/minkowski_difference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "numeric/floating_point_guard.hpp"
#include "structure/overlay/face_sum.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd {

namespace {

using detail::DifferencePoint;
using detail::FacetOfDifference;
using detail::PairVector;
using detail::PosedPair;

DifferenceFacetKind kind_of(const detail::FacePair& faces) {
  using Kind = Feature::Kind;
  if (faces.on_a.kind == Kind::facet) {
    if (faces.on_b.kind == Kind::facet) return DifferenceFacetKind::facet_facet;
    return faces.on_b.kind == Kind::edge ? DifferenceFacetKind::facet_edge : DifferenceFacetKind::facet_vertex;
  }
  if (faces.on_b.kind == Kind::facet) {
    return faces.on_a.kind == Kind::edge ? DifferenceFacetKind::edge_facet : DifferenceFacetKind::vertex_facet;
  }
  return DifferenceFacetKind::edge_edge;
}

Vec3 position(const PosedPair& pair, const DifferencePoint& p) {
  const detail::Vec3DD x = pair.approximate_dd(PairVector::point(p.a, p.b));
  const auto unscaled = [&](const detail::DoubleDouble& c) {
    return std::ldexp(detail::to_double(c), pair.scale_exponent());
  };
  return {unscaled(x.x), unscaled(x.y), unscaled(x.z)};
}

Vec3 unit_normal(const PosedPair& pair, const FacetOfDifference& facet) {
  const detail::Vec3DD n = detail::cross(pair.approximate_dd(facet.u), pair.approximate_dd(facet.v));
  const Vec3 rounded(detail::to_double(n.x), detail::to_double(n.y), detail::to_double(n.z));
  // Scaled first: the square of a slender body's normal may underflow.
  return (rounded / rounded.cwiseAbs().maxCoeff()).normalized();
}

std::uint64_t key_of(const DifferencePoint& p) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.a)) << 32 | static_cast<std::uint32_t>(p.b);
}

/// The corners of a flat P: a loop, two ends or one point.
void flat_corners(const PosedPair& pair, const detail::FlatDifference& flat, std::vector<DifferencePoint>& loop) {
  if (flat.affine_dimension == 2) {
    detail::sum_loop(pair, flat.faces, detail::InPlane(pair, flat.u, flat.v), loop);
    return;
  }
  loop.assign(1, DifferencePoint{0, 0});
  if (flat.affine_dimension == 0) return;
  loop.push_back({0, 0});
  for (int a = 0; a < pair.a().num_vertices(); ++a) {
    for (int b = 0; b < pair.b().num_vertices(); ++b) {
      const auto along = [&](const DifferencePoint& from) {
        return pair.sign_dot(PairVector::difference(from.a, from.b, a, b), flat.u);
      };
      if (along(loop[0]) < 0) loop[0] = {a, b};
      if (along(loop[1]) > 0) loop[1] = {a, b};
    }
  }
}

}  // namespace

std::string_view to_string(DifferenceFacetKind kind) {
  switch (kind) {
    case DifferenceFacetKind::facet_vertex:
      return "facet-vertex";
    case DifferenceFacetKind::vertex_facet:
      return "vertex-facet";
    case DifferenceFacetKind::edge_edge:
      return "edge-edge";
    case DifferenceFacetKind::facet_edge:
      return "facet-edge";
    case DifferenceFacetKind::edge_facet:
      return "edge-facet";
    case DifferenceFacetKind::facet_facet:
      return "facet-facet";
  }
  return "";
}

Expected<MinkowskiDifference> minkowski_difference(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                                   const Pose& pose_b, std::int64_t max_facets) {
  const detail::FloatingPointGuard guard;
  const PosedPair pair(a, pose_a, b, pose_b);
  MinkowskiDifference result;
  std::vector<DifferencePoint> loop;
  if (const auto flat = detail::flat_difference(pair)) {
    result.affine_dimension = flat->affine_dimension;
    flat_corners(pair, *flat, loop);
    for (const DifferencePoint& p : loop) result.vertices.push_back({position(pair, p), p.a, p.b});
    return result;
  }

  std::vector<DifferencePoint> corners;
  detail::OverlayBuffers buffers;
  detail::OverlayWalk walk(pair, buffers);
  std::int64_t met = 0;
  const bool complete = walk.run([&](std::span<const detail::OverlayPiece> pieces) {
    met += static_cast<std::int64_t>(pieces.size());
    if (met > max_facets) return false;
    for (const detail::OverlayPiece& piece : pieces) {
      const auto faces = detail::whole_facet(walk, piece);
      if (!faces) continue;
      const FacetOfDifference facet = detail::facet_of(pair, piece);
      const DifferenceFacetKind kind = kind_of(*faces);
      if (kind == DifferenceFacetKind::edge_edge) {
        // From (a0, b0) along -(a1 - a0), then along b1 - b0: counter-clockwise about (b1 - b0) x (a1 - a0).
        const std::int32_t a0 = facet.a, b0 = facet.b, a1 = a.target(piece.a), b1 = b.target(piece.b);
        loop.assign({{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}});
      } else {
        detail::sum_loop(pair, *faces, detail::InPlane(pair, facet.u, facet.v), loop);
      }
      result.facets.push_back({kind, faces->on_a, faces->on_b, unit_normal(pair, facet),
                               static_cast<std::int32_t>(corners.size()), static_cast<std::int32_t>(loop.size())});
      corners.insert(corners.end(), loop.begin(), loop.end());
    }
    return true;
  });
  if (!complete) {
    return Error{ErrorCode::limit_exceeded,
                 "the Minkowski difference has more than " + std::to_string(max_facets) +
                     " facets; depth queries answer without building it",
                 "max_facets"};
  }

  // A vertex of P is the difference of one pair of vertices only, so that equal pairs and equal points are the same.
  std::vector<std::uint64_t> keys(corners.size());
  std::transform(corners.begin(), corners.end(), keys.begin(), key_of);
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  result.vertices.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    const DifferencePoint p{static_cast<std::int32_t>(key >> 32), static_cast<std::int32_t>(key & 0xffffffffu)};
    result.vertices.push_back({position(pair, p), p.a, p.b});
  }
  result.corners.reserve(corners.size());
  for (const DifferencePoint& p : corners) {
    const auto at = std::lower_bound(keys.begin(), keys.end(), key_of(p));
    result.corners.push_back(static_cast<std::int32_t>(at - keys.begin()));
  }
  return result;
}

}  // namespace pd
