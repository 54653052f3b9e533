/// @file
/// The whole boundary, facet by facet: `UnionBoundary::visit_all`.
#include <algorithm>
#include <cmath>
#include <utility>

#include "compound/buried_faces.hpp"
#include "compound/cover_cells.hpp"
#include "compound/cover_cubes.hpp"
#include "compound/union_boundary.hpp"

namespace pd::detail {

namespace {

/// False is certain.
bool boxes_meet(const Box& x, const Box& y, double slack) {
  return (x.low - y.high).maxCoeff() <= slack && (y.low - x.high).maxCoeff() <= slack;
}

/// Tells whether a flat polygon lies in the interior of a P_k or apart from it, for certain.
/// @param box    of the corners
/// @param error  of a coordinate of a corner
CoverPlace place(const PartDifference& piece, const std::vector<Vec3>& corners, const Box& box, double error) {
  const Vec3 middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
  CoverPlace result = piece.flat ? CoverPlace::apart : CoverPlace::holds;
  for (const RoughPlane& plane : piece.planes) {
    const double slack = plane.slack + 2 * error;
    // Of most planes the box is on one side.
    const double height = plane.normal.dot(middle) - plane.offset, reach = plane.normal.cwiseAbs().dot(half);
    if (height - reach > slack) return CoverPlace::apart;
    if (height + reach < -slack) continue;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Vec3& x : corners) {
      const double of_corner = plane.normal.dot(x) - plane.offset;
      low = std::min(low, of_corner);
      high = std::max(high, of_corner);
    }
    if (low > slack) return CoverPlace::apart;
    if (!(high < -slack)) result = CoverPlace::meets;
  }
  return result;
}

}  // namespace

bool UnionBoundary::narrow(const std::vector<Vec3>& corners, double error, std::vector<std::int32_t>& near) {
  Box box{corners[0], corners[0]};
  for (const Vec3& x : corners) {
    box.low = box.low.cwiseMin(x);
    box.high = box.high.cwiseMax(x);
  }
  counts_.tests += static_cast<std::int64_t>(near.size());
  std::size_t kept = 0;
  for (const std::int32_t which : near) {
    const auto k = static_cast<std::size_t>(which);
    if (!boxes_meet(box, boxes_[k], error)) continue;
    const CoverPlace where = place(differences_.roughly(k), corners, box, error);
    if (where == CoverPlace::holds) return false;
    if (where == CoverPlace::meets) near[kept++] = which;
  }
  near.resize(kept);
  return true;
}

bool UnionBoundary::visit_all(const Visitor& visitor, std::int64_t max_work) {
  CoverCubes cubes(differences_);
  const BuriedFaces buried_a(differences_.parts_a()), buried_b(differences_.parts_b());
  std::vector<OpenCell> open;
  std::vector<Vec3> corners;
  std::vector<std::int32_t> near;
  const double rounding = 0x1p-42 * differences_.extent();
  for (std::size_t own_piece = 0; own_piece < boxes_.size(); ++own_piece) {
    const std::size_t num_facets = differences_.roughly(own_piece).planes.size();
    for (std::size_t f = 0; f < num_facets; ++f) {
      if (differences_.limit_exceeded() || counts_.work() > max_work) return false;
      // Most facets lie deep inside: they need no exact polygon.
      const PartDifference& piece = differences_.pieces()[own_piece];
      const MinkowskiDifference::Facet& made_of = piece.built->facets[f];
      if (buried_a.holds(piece.part_a, made_of.on_a) || buried_b.holds(piece.part_b, made_of.on_b)) {
        ++counts_.passed;
        continue;
      }
      rough_corners(own_piece, f, corners);
      const std::int64_t tests = cubes.num_tests();
      const bool covered = cubes.covers(own_piece, differences_.pieces()[own_piece].planes[f], corners, near);
      counts_.tests += cubes.num_tests() - tests;
      if (covered || !narrow(corners, rounding, near)) {
        ++counts_.passed;
        continue;
      }
      open.push_back({{{own_piece, f, differences_.polygon(own_piece, f), Vec3::Zero()}, own(own_piece)}, near});
      while (!open.empty()) {
        OpenCell cell = std::move(open.back());
        open.pop_back();
        ++counts_.polygons;
        if (counts_.work() > max_work) return false;
        const PlanePolygon& polygon = cell.cell.where.polygon;
        if (!narrow(polygon.corners, 2 * polygon.error + 0x1p-44 * differences_.extent(), cell.near)) continue;
        if (split_one(cell, open)) continue;
        if (!visitor(cell.cell.where)) return false;
      }
    }
  }
  return !differences_.limit_exceeded();
}

bool UnionBoundary::split_one(OpenCell& open_cell, std::vector<OpenCell>& open) {
  Cell& cell = open_cell.cell;
  const PlanePolygon& polygon = cell.where.polygon;
  const auto split_by = [&](std::size_t k) {
    mark(cell.clipped, k);
    std::erase(open_cell.near, static_cast<std::int32_t>(k));
    if (!subtract(polygon, cell.where.piece, k, true)) return false;
    for (PlanePolygon& part : rest_) {
      open.push_back(
          {{{cell.where.piece, cell.where.facet, std::move(part), Vec3::Zero()}, cell.clipped}, open_cell.near});
    }
    return true;
  };
  // The one that holds the middle best covers most of it.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : polygon.corners) middle += x;
  middle /= static_cast<double>(polygon.corners.size());
  for (std::ptrdiff_t k = covering(middle, cell.clipped, 0, open_cell.near); k >= 0;
       k = covering(middle, cell.clipped, 0, open_cell.near)) {
    if (split_by(static_cast<std::size_t>(k))) return true;
  }
  while (!open_cell.near.empty()) {
    if (split_by(static_cast<std::size_t>(open_cell.near.front()))) return true;
  }
  return false;
}

}  // namespace pd::detail
