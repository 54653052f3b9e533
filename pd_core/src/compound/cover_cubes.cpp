#include "compound/cover_cubes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "compound/cover_cells.hpp"

namespace pd::detail {

CoverCubes::CoverCubes(PartDifferences& differences)
    : differences_(differences), gathered_(differences.pieces().size(), 0) {
  Cube whole;
  whole.half = differences.extent() > 0 ? rounded_up(differences.extent()) : 1;
  std::vector<std::int32_t> all(differences.pieces().size());
  std::iota(all.begin(), all.end(), 0);
  whole.pieces = std::make_shared<const std::vector<std::int32_t>>(std::move(all));
  cubes_.push_back(std::move(whole));
}

bool CoverCubes::covers(std::size_t own, const RoughPlane& plane, const std::vector<Vec3>& corners,
                        std::vector<std::int32_t>& near) {
  near.clear();
  FacetBox facet{plane, corners[0], corners[0]};
  for (const Vec3& x : corners) {
    facet.low = facet.low.cwiseMin(x);
    facet.high = facet.high.cwiseMax(x);
  }
  if (held(0, facet)) return true;
  gathered_[own] = ++calls_;
  gather(0, facet, near);
  return false;
}

/// False only when the facet has for certain no point in the cube.
bool CoverCubes::passes(const Cube& cube, const FacetBox& facet) const {
  const double reach = cube.half + 0x1p-42 * differences_.extent();
  if ((facet.low - cube.centre).maxCoeff() > reach || (cube.centre - facet.high).maxCoeff() > reach) return false;
  const double height = facet.plane.normal.dot(cube.centre) - facet.plane.offset;
  return !(std::abs(height) > reach * facet.plane.normal.lpNorm<1>() + facet.plane.slack);
}

bool CoverCubes::held(std::size_t cube, const FacetBox& facet) {
  if (!passes(cubes_[cube], facet)) return true;
  if (cubes_[cube].state == Cube::State::unknown) look_at(cube);
  if (cubes_[cube].state != Cube::State::halved) return cubes_[cube].state == Cube::State::held;
  const auto first = static_cast<std::size_t>(cubes_[cube].first_child);
  for (std::size_t child = first; child < first + 8; ++child) {
    if (!held(child, facet)) return false;
  }
  return true;
}

void CoverCubes::gather(std::size_t cube, const FacetBox& facet, std::vector<std::int32_t>& near) {
  if (!passes(cubes_[cube], facet)) return;
  if (cubes_[cube].state == Cube::State::unknown) look_at(cube);
  if (cubes_[cube].state == Cube::State::halved) {
    const auto first = static_cast<std::size_t>(cubes_[cube].first_child);
    for (std::size_t child = first; child < first + 8; ++child) gather(child, facet, near);
    return;
  }
  for (const std::int32_t k : *cubes_[cube].pieces) {
    if (std::exchange(gathered_[static_cast<std::size_t>(k)], calls_) != calls_) near.push_back(k);
  }
}

void CoverCubes::look_at(std::size_t number) {
  Cube& cube = cubes_[number];
  std::vector<std::int32_t> meeting;
  for (const std::int32_t k : *cube.pieces) {
    ++num_tests_;
    const CoverPlace where = cover_place(differences_, static_cast<std::size_t>(k), cube.centre, cube.half);
    if (where == CoverPlace::meets) meeting.push_back(k);
    if (where != CoverPlace::holds) continue;
    cube.state = Cube::State::held;
    cube.pieces = std::make_shared<const std::vector<std::int32_t>>(1, k);
    return;
  }
  cube.state = Cube::State::leaf;
  cube.pieces = std::make_shared<const std::vector<std::int32_t>>(std::move(meeting));
  if (cube.pieces->size() <= kFew || cube.depth == kMaxDepth || cubes_.size() > kMaxCubes) return;
  cube.state = Cube::State::halved;
  cube.first_child = static_cast<std::int32_t>(cubes_.size());
  const Cube parent = cube;  // the list of cubes grows
  cube.pieces = nullptr;
  for (int child = 0; child < 8; ++child) {
    Cube part;
    part.half = parent.half / 2;
    part.depth = parent.depth + 1;
    part.pieces = parent.pieces;
    for (int axis = 0; axis < 3; ++axis) {
      part.centre[axis] = parent.centre[axis] + ((child >> axis & 1) != 0 ? part.half : -part.half);
    }
    cubes_.push_back(std::move(part));
  }
}

}  // namespace pd::detail
