#include "solid/direction_sector.hpp"

#include <algorithm>
#include <utility>

namespace pd::detail {

Vec3 rounded_unit(const Dyadic3& vector) {
  return Vec3(vector.x.to_double(), vector.y.to_double(), vector.z.to_double()).stableNormalized();
}

DirectionSector::DirectionSector(const std::array<Dyadic3, 3>& normals) {
  for (const Dyadic3& normal : normals) walls_.push_back({normal, {}, {}});
  set_rays();
}

std::vector<DirectionSector> DirectionSector::octants() {
  // Planes of bodies seldom pass within rounding of these, so that they cut no sliver off.
  const std::array<Dyadic3, 3> planes = {to_dyadic(Vec3(61, 13, -7)), to_dyadic(Vec3(-11, 67, 17)),
                                         to_dyadic(Vec3(5, -19, 71))};
  std::vector<DirectionSector> all;
  for (int k = 0; k < 8; ++k) {
    const auto wall = [&](int i) { return planes[static_cast<std::size_t>(i)] * Dyadic(k >> i & 1 ? -1.0 : 1.0); };
    // An odd number of reflections turns the order of the walls.
    const bool odd = ((k ^ k >> 1 ^ k >> 2) & 1) != 0;
    all.push_back(DirectionSector({wall(0), wall(odd ? 2 : 1), wall(odd ? 1 : 2)}));
  }
  return all;
}

void DirectionSector::set_rays() {
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    Wall& wall = walls_[i];
    wall.ray = cross(wall.normal, walls_[(i + 1) % walls_.size()].normal);
    wall.unit = rounded_unit(wall.ray);
  }
}

std::vector<int> DirectionSector::sides_of_rays(const Dyadic3& normal) const {
  const Vec3 unit = rounded_unit(normal);
  std::vector<int> sides;
  for (const Wall& wall : walls_) {
    const double value = unit.dot(wall.unit);
    const bool is_sure = std::abs(value) > 0x1p-40;
    sides.push_back(is_sure ? (value > 0 ? 1 : -1) : dot(normal, wall.ray).sign());
  }
  return sides;
}

bool DirectionSector::is_crossed_by(const Dyadic3& normal) const {
  const std::vector<int> sides = sides_of_rays(normal);
  const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
  return *least < 0 && *most > 0;
}

bool DirectionSector::cut(const Dyadic3& normal) {
  const std::vector<int> sides = sides_of_rays(normal);
  const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
  if (*most <= 0) {
    walls_.clear();
    return false;
  }
  if (*least >= 0) return true;
  // A wall stays if one of its two rays is kept; the new wall follows the last one that stays.
  std::vector<Wall> kept;
  const std::size_t count = walls_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const int before = sides[(i + count - 1) % count], after = sides[i];
    if (before <= 0 && after <= 0) continue;
    kept.push_back(walls_[i]);
    if (before > 0 && after <= 0) kept.push_back({normal, {}, {}});
  }
  walls_ = std::move(kept);
  set_rays();
  return true;
}

bool DirectionSector::holds(const Dyadic3& direction) const {
  return std::all_of(walls_.begin(), walls_.end(),
                     [&](const Wall& wall) { return dot(wall.normal, direction).sign() > 0; });
}

Vec3 DirectionSector::middle() const {
  Vec3 sum = Vec3::Zero();
  for (const Wall& wall : walls_) sum += wall.unit;
  return sum;
}

}  // namespace pd::detail
