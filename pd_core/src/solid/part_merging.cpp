#include "solid/part_merging.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shape/mesh/triangle_tree.hpp"

namespace pd::detail {

double volume_of(const ConvexPolytope& polytope) {
  double sum = 0;
  const Vec3 centre = polytope.centre();
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const auto loop = polytope.facet_vertices(f);
    const auto seen = [&](std::size_t k) -> Vec3 { return polytope.vertex(loop[k]) - centre; };
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) sum += seen(0).dot(seen(k).cross(seen(k + 1))) / 6;
  }
  return sum;
}

namespace {

/// Two parts and their common hull.
struct MergingPair {
  double added;  ///< volume of the hull beyond that of the two parts, in that of the hull
  std::size_t i, j;
  ConvexPolytope hull;

  static bool after(const MergingPair& a, const MergingPair& b) {
    return a.added != b.added ? a.added > b.added : std::pair(a.i, a.j) > std::pair(b.i, b.j);
  }
};

bool equal(const ConvexPolytope& a, const ConvexPolytope& b) {
  if (a.num_vertices() != b.num_vertices()) return false;
  for (int v = 0; v < a.num_vertices(); ++v) {
    if (a.vertex(v) != b.vertex(v)) return false;
  }
  return true;
}

class Merger {
 public:
  Merger(std::vector<SolidPart> parts, const MergingRules& rules) : parts_(std::move(parts)), rules_(rules) {
    for (const SolidPart& part : parts_) note(part.polytope);
  }

  std::vector<SolidPart> run() {
    for (std::size_t j = 0; j < parts_.size() && rules_.goes_on(); ++j) add_pairs_before(j);
    while (!open_.empty() && rules_.goes_on()) {
      std::pop_heap(open_.begin(), open_.end(), MergingPair::after);
      MergingPair best = std::move(open_.back());
      open_.pop_back();
      if (gone_[best.i] != 0 || gone_[best.j] != 0) continue;
      const std::optional<double> error = rules_.error_of(best.hull);
      if (!error) continue;
      gone_[best.i] = gone_[best.j] = 1;
      note(best.hull);
      parts_.push_back({std::move(best.hull), *error, false});
      add_pairs_before(parts_.size() - 1);
    }
    std::vector<SolidPart> kept;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (gone_[i] == 0) kept.push_back(std::move(parts_[i]));
    }
    return kept;
  }

 private:
  /// Notes volume and box of a part that is about to be the last one.
  void note(const ConvexPolytope& body) {
    volumes_.push_back(volume_of(body));
    gone_.push_back(0);
    TriangleBox box{body.vertex(0), body.vertex(0)};
    for (int v = 1; v < body.num_vertices(); ++v) {
      box.low = box.low.cwiseMin(body.vertex(v));
      box.high = box.high.cwiseMax(body.vertex(v));
    }
    boxes_.push_back(box);
  }

  void add_pairs_before(std::size_t j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (gone_[i] != 0 || gone_[j] != 0) continue;
      const TriangleBox &a = boxes_[i], &b = boxes_[j];
      if ((a.low - b.high).cwiseMax(b.low - a.high).maxCoeff() <= rules_.gap) add_pair(i, j);
    }
  }

  void add_pair(std::size_t i, std::size_t j) {
    std::vector<Vec3> points;
    for (const std::size_t part : {i, j}) {
      const ConvexPolytope& body = parts_[part].polytope;
      for (int v = 0; v < body.num_vertices(); ++v) points.push_back(body.vertex(v));
    }
    rules_.spend(static_cast<std::int64_t>(points.size()));
    auto hull = ConvexPolytope::from_points(points);
    if (!hull || hull->affine_dimension() < 3) return;
    for (const auto& [held, holds] : {std::pair(i, j), std::pair(j, i)}) {
      if (gone_[holds] == 0 && equal(*hull, parts_[holds].polytope)) {
        gone_[held] = 1;
        return;
      }
    }
    const double volume = volume_of(*hull);
    open_.push_back({(volume - volumes_[i] - volumes_[j]) / volume, i, j, *std::move(hull)});
    std::push_heap(open_.begin(), open_.end(), MergingPair::after);
  }

  std::vector<SolidPart> parts_;
  const MergingRules& rules_;
  std::vector<double> volumes_;
  std::vector<TriangleBox> boxes_;
  std::vector<char> gone_;
  std::vector<MergingPair> open_;  ///< a heap
};

}  // namespace

std::vector<SolidPart> merged(std::vector<SolidPart> parts, const MergingRules& rules) {
  return Merger(std::move(parts), rules).run();
}

}  // namespace pd::detail
