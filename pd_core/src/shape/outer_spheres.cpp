#include "shape/outer_spheres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace pd::detail {

namespace {

auto key(const Sphere& s) { return std::tuple(s.centre.x(), s.centre.y(), s.centre.z(), s.radius); }

/// Whether the other spheres reach farther than one in every direction.
class InsideOthers {
 public:
  InsideOthers(const std::vector<Sphere>& spheres, std::size_t which)
      : spheres_(spheres), own_(spheres[which]), sums_left_(kSums) {
    for (const Sphere& s : spheres) {
      slack_ = std::max(slack_, 0x1p-40 * ((s.centre - own_.centre).norm() + s.radius));
    }
  }

  bool holds() {
    for (int face = 0; face < 6; ++face) {
      if (!covered({face, 0, 0, 1})) return false;
    }
    return true;
  }

 private:
  static constexpr std::int64_t kSums = 1 << 18;
  static constexpr double kLeastCell = 0x1p-10;

  /// A square of the cube's surface: the face's axis and sign, the middle along the two other axes, half its side.
  struct Cell {
    int face;
    double u, v, half;
  };

  bool covered(const Cell& cell) {
    Vec3 d;
    const int axis = cell.face / 2;
    d[axis] = cell.face % 2 == 0 ? 1 : -1;
    d[(axis + 1) % 3] = cell.u;
    d[(axis + 2) % 3] = cell.v;
    const double length = d.norm();
    const double off = 1.5 * cell.half;  // more than the half diagonal
    double farthest = -1;
    for (const Sphere& other : spheres_) {
      const Vec3 apart = other.centre - own_.centre;
      const double thicker = other.radius - own_.radius;
      const double ahead = apart.dot(d) + thicker * length;
      farthest = std::max(farthest, ahead - slack_);
      if (ahead - off * (apart.norm() + std::abs(thicker)) > slack_) return true;
    }
    sums_left_ -= static_cast<std::int64_t>(spheres_.size());
    if (!(farthest > 0) || sums_left_ < 0 || cell.half <= kLeastCell) return false;
    const double half = 0.5 * cell.half;
    for (const double u : {cell.u - half, cell.u + half}) {
      for (const double v : {cell.v - half, cell.v + half}) {
        if (!covered({cell.face, u, v, half})) return false;
      }
    }
    return true;
  }

  const std::vector<Sphere>& spheres_;
  const Sphere& own_;
  std::int64_t sums_left_;
  double slack_ = 0;
};

/// Times a power of two, so that squares are ordinary numbers.
std::vector<Sphere> near_size_one(std::vector<Sphere> spheres) {
  double size = 0;
  for (const Sphere& s : spheres) size = std::max({size, s.centre.cwiseAbs().maxCoeff(), s.radius});
  const int exponent = size > 0 ? -std::ilogb(size) : 0;
  for (Sphere& s : spheres) {
    s.centre = s.centre.unaryExpr([&](double x) { return std::ldexp(x, exponent); });
    s.radius = std::ldexp(s.radius, exponent);
  }
  return spheres;
}

}  // namespace

void keep_outer_spheres(std::vector<Sphere>& spheres) {
  for (Sphere& s : spheres) s.centre.array() += 0.0;  // no negative zeros
  std::sort(spheres.begin(), spheres.end(), [](const Sphere& x, const Sphere& y) { return key(x) < key(y); });
  const auto same = [](const Sphere& x, const Sphere& y) { return key(x) == key(y); };
  spheres.erase(std::unique(spheres.begin(), spheres.end(), same), spheres.end());
  // All are asked of all: whatever reaches farthest somewhere is no one's inside, so that none is needed that goes.
  const std::vector<Sphere> near = near_size_one(spheres);
  std::vector<Sphere> outer;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (!InsideOthers(near, i).holds()) outer.push_back(spheres[i]);
  }
  spheres = std::move(outer);
}

}  // namespace pd::detail
