#include "compound/cover_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "compound/union_memory.hpp"

namespace pd::detail {

namespace {

constexpr int kDualSteps = 4;

/// Of the cube's points the distance of the nearest to the origin.
double distance(const CoverCell& cell) { return (cell.centre.cwiseAbs().array() - cell.half).max(0.0).matrix().norm(); }

}  // namespace

double rounded_up(double length) {
  const int exponent = std::ilogb(length) - 7;
  return std::ldexp(std::ceil(std::ldexp(length, -exponent)), exponent);
}

/// |x|^2 is least over {x in cube : <n, x> = d} where its Lagrange dual, the least of |x|^2 + 2 l (d - <n, x>) over the
/// cube, is greatest. The dual bounds it from below for every l, so that no iteration has to converge.
double distance_within(const RoughPlane& plane, const CoverCell& cell, double extent) {
  const double slack = plane.slack + 0x1p-48 * extent;
  const double plain = std::max(std::abs(plane.offset) - slack, cell.key);
  const Eigen::Array3d low = cell.centre.array() - cell.half, high = cell.centre.array() + cell.half;
  const Eigen::Array3d normal = plane.normal.array();
  double multiplier = plane.offset, best = 0;
  for (int step = 0; step < kDualSteps; ++step) {
    const Eigen::Array3d x = (multiplier * normal).max(low).min(high);
    const double missing = plane.offset - (normal * x).sum();
    const double dual = (x * x).sum() + 2 * multiplier * missing - 2 * std::abs(multiplier) * slack -
                        0x1p-46 * (extent + std::abs(multiplier)) * (extent + std::abs(multiplier));
    best = std::max(best, dual);
    // Newton's step: <n, x> grows with l along the coordinates that no side of the cube holds.
    const double slope = ((x > low && x < high).select(normal * normal, 0.0)).sum();
    if (!(slope > 0)) break;
    multiplier += missing / slope;
  }
  return std::max(plain, std::sqrt(best) * (1 - 0x1p-50));
}

CoverPlace cover_place(PartDifferences& differences, std::size_t k, const Vec3& centre, double half) {
  const PartDifference& known = differences.pieces()[k];
  const Eigen::Array3d low = centre.array() - half, high = centre.array() + half;
  const double rounding = 0x1p-48 * differences.extent();
  if ((known.low.array() - high).maxCoeff() > rounding || (low - known.high.array()).maxCoeff() > rounding) {
    return CoverPlace::apart;
  }
  // Only a P_k whose box holds the cube can hold it; others are not worth making before the cube is small beside them.
  const bool box_holds = (known.low.array() <= low).all() && (known.high.array() >= high).all();
  if (!box_holds && known.made == PartDifference::Made::nothing && 4 * half > (known.high - known.low).minCoeff()) {
    return CoverPlace::meets;
  }
  const PartDifference& piece = differences.roughly(k);
  if (piece.flat) return CoverPlace::apart;
  CoverPlace result = CoverPlace::holds;
  for (const RoughPlane& plane : piece.planes) {
    const double height = plane.normal.dot(centre) - plane.offset;
    const double reach = half * plane.normal.lpNorm<1>() + rounding;
    if (height - reach > plane.slack) return CoverPlace::apart;
    if (!(height + reach < -plane.slack)) result = CoverPlace::meets;
  }
  return result;
}

CoverCells::CoverCells(PartDifferences& differences, double reach, double known_lower, UnionMemory* memory)
    : differences_(differences), known_lower_(known_lower), memory_(memory) {
  std::vector<std::int32_t> all(differences.pieces().size());
  std::iota(all.begin(), all.end(), 0);
  CoverCell whole;
  if (memory_ != nullptr) {
    whole.half = memory_->begin(differences, reach);
    whole.known = memory_->first();
  } else {
    whole.half = rounded_up(reach);
  }
  whole.pieces = std::make_shared<const std::vector<std::int32_t>>(std::move(all));
  add(std::move(whole));
}

void CoverCells::add(CoverCell cell) {
  cell.key = std::max(known_lower_, distance(cell) * (1 - 0x1p-48));
  const double farthest = (cell.centre.cwiseAbs().array() + cell.half).matrix().norm();
  if (cell.key > upper_ || farthest * (1 + 0x1p-48) < known_lower_) return;
  queue_.push(cell.key, std::move(cell));
}

bool CoverCells::covered(const CoverCell& cell) {
  const std::int32_t last = memory_ != nullptr ? memory_->holder(cell.known) : -1;
  if (last >= 0 && place(cell, static_cast<std::size_t>(last)) == CoverPlace::holds) {
    memory_->held(cell.record, differences_.pieces()[static_cast<std::size_t>(last)]);
    return true;
  }
  const auto holds = [&](std::int32_t k) {
    if (memory_ != nullptr) memory_->held(cell.record, differences_.pieces()[static_cast<std::size_t>(k)]);
    return true;
  };
  for (std::size_t i = 0; i < recent_.size(); ++i) {
    const std::int32_t k = recent_[i];
    if (place(cell, static_cast<std::size_t>(k)) != CoverPlace::holds) continue;
    std::rotate(recent_.begin(), recent_.begin() + static_cast<std::ptrdiff_t>(i),
                recent_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    return holds(k);
  }
  meeting_.clear();
  for (const std::int32_t k : *cell.pieces) {
    const CoverPlace where = place(cell, static_cast<std::size_t>(k));
    if (where == CoverPlace::meets) meeting_.push_back(k);
    if (where != CoverPlace::holds) continue;
    if (recent_.size() == kRecent) recent_.pop_back();
    recent_.insert(recent_.begin(), k);
    return holds(k);
  }
  return false;
}

void CoverCells::find_meeting(const CoverCell& cell) {
  const double rounding = 0x1p-48 * differences_.extent();
  const Eigen::Array3d low = cell.centre.array() - cell.half, high = cell.centre.array() + cell.half;
  meeting_.clear();
  for (const std::int32_t k : *cell.pieces) {
    const PartDifference& piece = differences_.pieces()[static_cast<std::size_t>(k)];
    if ((piece.low.array() - high).maxCoeff() <= rounding && (low - piece.high.array()).maxCoeff() <= rounding) {
      meeting_.push_back(k);
    }
  }
}

void CoverCells::halve(const CoverCell& cell) {
  const std::int32_t first = memory_ != nullptr ? memory_->halve(cell.record) : 0;
  for (int child = 0; child < 8; ++child) {
    CoverCell part = cell;
    part.half = cell.half / 2;
    ++part.depth;
    if (memory_ != nullptr) {
      part.known = memory_->child(cell.known, child);
      part.record = first + child;
    }
    for (int axis = 0; axis < 3; ++axis) part.centre[axis] += (child >> axis & 1) != 0 ? part.half : -part.half;
    add(std::move(part));
  }
}

std::optional<CoverCell> CoverCells::next(double upper) {
  upper_ = std::min(upper_, upper);
  while (!queue_.empty() && queue_.least_key() <= upper_ && !differences_.limit_exceeded()) {
    CoverCell cell = queue_.pop();
    ++num_cells_;
    const bool halved_last = memory_ != nullptr && memory_->halved(cell.known);
    if (halved_last) {
      find_meeting(cell);
    } else if (covered(cell)) {
      continue;
    }
    if (meeting_.empty()) {
      // Free as a whole, its nearest point too.
      upper_ = std::min(upper_, distance(cell) * (1 + 0x1p-48));
      continue;
    }
    // Halving has stopped to tell P_k apart: walls on which they abut run through the cube, at any size.
    const bool stuck =
        !halved_last && cell.depth > 0 && meeting_.size() == cell.pieces->size() && meeting_.size() <= kMany;
    cell.pieces = std::make_shared<const std::vector<std::int32_t>>(meeting_);
    const std::size_t few = num_cells_ > kCellsOfWalls ? kFewAtWalls : kFew;
    if (meeting_.size() <= few || stuck || cell.depth == kMaxDepth || num_cells_ > kMaxCells) return cell;
    halve(cell);
  }
  return std::nullopt;
}

}  // namespace pd::detail
