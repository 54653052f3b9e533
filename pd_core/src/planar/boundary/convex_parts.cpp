#include "planar/boundary/convex_parts.hpp"

#include <algorithm>
#include <utility>

#include "numeric/at.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

class Joiner {
 public:
  Joiner(const Triangulation& triangulation, const std::vector<Point2>& points)
      : triangulation_(triangulation), points_(points) {}

  [[nodiscard]] std::vector<std::vector<std::int32_t>> run() {
    const auto n = static_cast<std::size_t>(triangulation_.num_inside);
    for (std::size_t t = 0; t < n; ++t) {
      const auto& vertex = triangulation_.triangles[t].vertex;
      parts_.emplace_back(vertex.begin(), vertex.end());
      part_of_.push_back(static_cast<std::int32_t>(t));
    }
    for (std::size_t t = 0; t < n; ++t) {
      const Triangle& triangle = triangulation_.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t u = triangle.neighbour[k];
        if (u <= static_cast<std::int32_t>(t) || u >= triangulation_.num_inside) continue;
        if (is_flat(triangle) || is_flat(triangulation_.triangles[at(u)])) continue;
        join_over(root(static_cast<std::int32_t>(t)), root(u), triangle.vertex[k]);
      }
    }
    std::erase_if(parts_, [](const std::vector<std::int32_t>& part) { return part.empty(); });
    return std::move(parts_);
  }

 private:
  [[nodiscard]] int turn(std::int32_t a, std::int32_t b, std::int32_t c) const {
    return orient2d(points_[at(a)], points_[at(b)], points_[at(c)]);
  }
  [[nodiscard]] bool is_flat(const Triangle& t) const { return turn(t.vertex[0], t.vertex[1], t.vertex[2]) == 0; }

  std::int32_t root(std::int32_t t) {
    while (part_of_[at(t)] != t) t = part_of_[at(t)] = part_of_[at(part_of_[at(t)])];
    return t;
  }

  /// Joins two parts over the edge of the first one that starts at vertex a, unless an end becomes reflex.
  void join_over(std::int32_t first, std::int32_t second, std::int32_t a) {
    auto &one = parts_[at(first)], &other = parts_[at(second)];
    std::rotate(one.begin(), std::find(one.begin(), one.end(), a) + 1, one.end());  // b ... a
    const std::int32_t b = one.front();
    std::rotate(other.begin(), std::find(other.begin(), other.end(), b) + 1, other.end());  // a ... b
    if (turn(one[one.size() - 2], a, other[1]) < 0 || turn(other[other.size() - 2], b, one[1]) < 0) return;
    one.insert(one.end(), other.begin() + 1, other.end() - 1);
    other.clear();
    part_of_[at(second)] = first;
  }

  const Triangulation& triangulation_;
  const std::vector<Point2>& points_;
  std::vector<std::vector<std::int32_t>> parts_;  ///< by their first triangle; empty where joined to another one
  std::vector<std::int32_t> part_of_;             ///< union-find over triangles
};

}  // namespace

std::vector<ConvexPart> triangles_inside(const Triangulation& triangulation, const std::vector<Point2>& points) {
  std::vector<ConvexPart> parts;
  parts.reserve(at(triangulation.num_inside));
  for (std::int32_t t = 0; t < triangulation.num_inside; ++t) {
    const auto& vertex = triangulation.triangles[at(t)].vertex;
    parts.emplace_back(points, std::vector<std::int32_t>(vertex.begin(), vertex.end()));
  }
  return parts;
}

std::vector<ConvexPart> convex_parts(const Triangulation& triangulation, const std::vector<Point2>& points) {
  std::vector<ConvexPart> parts;
  for (auto& corners : Joiner(triangulation, points).run()) parts.emplace_back(points, std::move(corners));
  return parts;
}

}  // namespace pd::detail
