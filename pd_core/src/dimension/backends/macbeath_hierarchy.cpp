#include "dimension/backends/macbeath_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "dimension/backends/macbeath_cover.hpp"
#include "pd/dimension/matrix_inverse.hpp"

namespace pd::dimension::detail {

namespace {

struct HierarchyNode {
  ShadowCone shadow;         ///< of the cover scale
  std::int32_t point;        ///< q of the region
  std::int32_t first_child;  ///< among the links
  std::int32_t children;
};

class MacbeathHierarchy final : public WidthStructure {
 public:
  std::vector<HierarchyNode> nodes;
  std::vector<std::int32_t> links;
  std::vector<AnySupport> points;  ///< as given, in K's space
  std::int64_t layers = 0;
  std::int64_t max_out_degree = 0;
  AnyMatrix pull_back;  ///< directions of K's space to directions of the frame

  [[nodiscard]] AnySupport support(const AnyVector& direction, QueryCounters& counters) const override {
    const AnyVector v = pull_back * direction;
    const std::int32_t leaf = descend(v / v.cwiseAbs().maxCoeff(), counters);
    AnySupport r = points[static_cast<std::size_t>(nodes[static_cast<std::size_t>(leaf)].point)];
    r.value = direction.dot(r.point);
    return r;
  }

  /// The node of the last layer built so far that shadows v.
  [[nodiscard]] std::int32_t descend(const AnyVector& v, QueryCounters& counters) const {
    ++counters.queries;
    std::int64_t path = 0;
    std::int32_t at = -1;
    const auto step = [&](auto begin, auto end) {
      // The cells promise a child; what rounding does at a shadow's rim, the least form miss mends within 1e-12.
      std::int32_t best = *begin;
      double least_miss = std::numeric_limits<double>::infinity();
      for (auto i = begin; i != end; ++i) {
        ++path;
        const ShadowCone& shadow = nodes[static_cast<std::size_t>(*i)].shadow;
        if (shadow.contains(v)) {
          best = *i;
          break;
        }
        const double along = dot(shadow.axis.data(), v.data(), v.size());
        if (!(along > 0)) continue;
        const double miss = -quadratic(shadow.form, v.data()) / (along * along);
        if (miss < least_miss) {
          least_miss = miss;
          best = *i;
        }
      }
      at = best;
    };
    step(root_ids.begin(), root_ids.end());
    while (nodes[static_cast<std::size_t>(at)].children > 0) {
      const HierarchyNode& node = nodes[static_cast<std::size_t>(at)];
      const auto first = links.begin() + node.first_child;
      step(first, first + node.children);
    }
    counters.nodes += path;
    counters.dot_products += path * (v.size() + 1);
    counters.deepest = std::max(counters.deepest, path);
    return at;
  }

  [[nodiscard]] StructureSize size() const override {
    StructureSize r;
    r.points = static_cast<std::int64_t>(points.size());
    r.nodes = static_cast<std::int64_t>(nodes.size());
    r.links = static_cast<std::int64_t>(links.size());
    r.max_out_degree = max_out_degree;
    r.depth = layers;
    r.bytes = static_cast<std::int64_t>(nodes.size() * sizeof(HierarchyNode) + links.size() * sizeof(std::int32_t) +
                                        points.size() * sizeof(AnySupport));
    return r;
  }

  std::vector<std::int32_t> root_ids;
};

/// Builds one layer after the other.
class HierarchyBuilder {
 public:
  HierarchyBuilder(PolarBody polar, MacbeathHierarchy& hierarchy, std::int64_t most_work)
      : dimension_(polar.dimension()),
        corners_(std::size_t{1} << (dimension_ - 1)),
        polar_(std::move(polar)),
        hierarchy_(hierarchy),
        work_left_(most_work) {}

  /// @param delta  depth of the regions; of leaves, what their points may fall short by
  /// @return false where the budget is spent.
  bool add_layer(double delta, bool leaves) {
    delta_ = delta;
    leaves_ = leaves;
    first_ = static_cast<std::int32_t>(hierarchy_.nodes.size());
    cores_.clear();
    next_neighbours_.clear();
    cells_.assign(faces(), 0);
    for (int face = 0; face < faces(); ++face) {
      face_ = cube_face(dimension_, face);
      sections_.clear();
      std::vector<std::int32_t> near(cores_.size());
      std::iota(near.begin(), near.end(), first_);
      for (const std::int32_t id : near) {
        sections_.emplace_back(hierarchy_.nodes[static_cast<std::size_t>(id)].shadow, face_);
      }
      if (!cover(static_cast<std::size_t>(face), face_, near, cores_.size())) return false;
    }
    link_parents();
    neighbours_ = std::move(next_neighbours_);
    previous_first_ = first_;
    ++hierarchy_.layers;
    return work_left_ > 0;
  }

  [[nodiscard]] std::int64_t work_left() const { return work_left_; }

 private:
  /// Subdivides the cell until every part lies in one cover shadow; regions enter where a middle is in no core shadow.
  /// @param near  nodes of this layer before `seen` that may meet the cell
  bool cover(std::size_t cell, const DirectionBox& box, const std::vector<std::int32_t>& outer, std::size_t seen) {
    work_left_ -= 1 + static_cast<std::int64_t>(outer.size() + cores_.size() - seen);
    if (work_left_ <= 0) return false;
    // Most boxes lie in one shadow and are not split: the lists of those that may meet a box are for its parts alone.
    const AnyVector middle = box.middle();
    const auto holds = [&](std::int32_t id) {
      const ShadowCone& shadow = hierarchy_.nodes[static_cast<std::size_t>(id)].shadow;
      return shadow.contains(middle) && covers(shadow, box);
    };
    for (const std::int32_t id : outer) {
      if (holds(id)) return settle(cell, id);
    }
    for (std::size_t k = seen; k < cores_.size(); ++k) {
      const std::int32_t id = first_ + static_cast<std::int32_t>(k);
      if (holds(id)) return settle(cell, id);
    }
    std::vector<std::int32_t> near;
    const auto consider = [&](std::int32_t id) {
      if (sections_[static_cast<std::size_t>(id - first_)].meets(box)) near.push_back(id);
    };
    for (const std::int32_t id : outer) consider(id);
    for (std::size_t k = seen; k < cores_.size(); ++k) consider(first_ + static_cast<std::int32_t>(k));
    const bool held = std::any_of(near.begin(), near.end(), [&](std::int32_t id) {
      return cores_[static_cast<std::size_t>(id - first_)].contains(middle);
    });
    if (!held) {
      const std::int32_t id = insert(middle);
      near.push_back(id);
      if (covers(hierarchy_.nodes[static_cast<std::size_t>(id)].shadow, box)) return settle(cell, id);
    }
    const std::size_t first_child = cells_.size();
    cells_.resize(first_child + corners_, 0);
    cells_[cell] = static_cast<std::int64_t>(first_child);
    const std::size_t known = cores_.size();
    for (int k = 0; k < box.corners(); ++k) {
      if (!cover(first_child + static_cast<std::size_t>(k), box.child(k), near, known)) return false;
    }
    return true;
  }

  bool settle(std::size_t cell, std::int32_t id) {
    cells_[cell] = -1 - static_cast<std::int64_t>(id);
    return true;
  }

  std::int32_t insert(const AnyVector& v) {
    const auto id = static_cast<std::int32_t>(hierarchy_.nodes.size());
    work_left_ -= static_cast<std::int64_t>(polar_.points().size()) / kPointsAStep;
    const std::vector<std::int32_t>& candidates = parent_list(v);
    // Leaves are flat: their depth hardly matters (from .2 to .5 of epsilon the numbers of nodes differ by a tenth).
    constexpr double kDepth = 0.5;
    const MacbeathRegion region = leaves_ ? polar_.answering_region(v, kDepth * delta_, delta_, candidates)
                                          : polar_.region(v, delta_, candidates);
    hierarchy_.nodes.push_back({region.shadow(leaves_ ? kLeafCoverScale : kCoverScale), region.point, 0, 0});
    cores_.push_back(region.shadow(leaves_ ? kLeafCoreScale : kCoreScale));
    sections_.emplace_back(hierarchy_.nodes.back().shadow, face_);
    if (!leaves_) next_neighbours_.push_back(polar_.neighbours(region, candidates));
    return id;
  }

  const std::vector<std::int32_t>& parent_list(const AnyVector& v) {
    if (hierarchy_.layers == 0) {
      if (all_.empty()) {
        all_.resize(polar_.points().size());
        std::iota(all_.begin(), all_.end(), 0);
      }
      return all_;
    }
    QueryCounters unused;
    return neighbours_[static_cast<std::size_t>(hierarchy_.descend(v, unused) - previous_first_)];
  }

  /// Links every node of the layer above to the nodes whose cells may meet its shadow.
  void link_parents() {
    if (hierarchy_.layers == 0) {
      hierarchy_.root_ids.resize(hierarchy_.nodes.size());
      std::iota(hierarchy_.root_ids.begin(), hierarchy_.root_ids.end(), 0);
      return;
    }
    mark_.assign(hierarchy_.nodes.size() - static_cast<std::size_t>(first_), -1);
    list_nodes();
    mark_.assign(mark_.size(), -1);
    for (std::int32_t parent = previous_first_; parent < first_; ++parent) {
      HierarchyNode& node = hierarchy_.nodes[static_cast<std::size_t>(parent)];
      node.first_child = static_cast<std::int32_t>(hierarchy_.links.size());
      for (int face = 0; face < faces() && work_left_ > 0; ++face) {
        const DirectionBox box = cube_face(dimension_, face);
        collect(static_cast<std::size_t>(face), box, ShadowSection(node.shadow, box), parent, false);
      }
      node.children = static_cast<std::int32_t>(hierarchy_.links.size()) - node.first_child;
      hierarchy_.max_out_degree = std::max<std::int64_t>(hierarchy_.max_out_degree, node.children);
    }
  }

  /// The nodes below every split cell that has few, in the order in which a walk through its parts meets them.
  void list_nodes() {
    listed_.clear();
    lists_.assign((cells_.size() - static_cast<std::size_t>(faces())) / corners_, {});
    // Parts are younger than what they are parts of.
    for (std::size_t cell = cells_.size(); cell-- > 0;) {
      if (cells_[cell] < 0) continue;
      const auto parts = static_cast<std::size_t>(cells_[cell]);
      NodeList& list = list_of(parts);
      list.first = listed_.size();
      const auto stamp = static_cast<std::int64_t>(cell);
      const auto take = [&](std::int32_t id) {
        std::int64_t& seen = mark_[static_cast<std::size_t>(id - first_)];
        if (seen == stamp) return;
        seen = stamp;
        listed_.push_back(id);
      };
      list.known = true;
      for (std::size_t k = 0; k < corners_ && list.known; ++k) {
        const std::int64_t content = cells_[parts + k];
        if (content < 0) {
          take(static_cast<std::int32_t>(-1 - content));
          continue;
        }
        const NodeList& part = list_of(static_cast<std::size_t>(content));
        list.known = part.known;
        for (std::size_t i = 0; i < part.count; ++i) take(listed_[part.first + i]);
      }
      list.known = list.known && listed_.size() - list.first <= kMostListed;
      if (!list.known) listed_.resize(list.first);
      list.count = listed_.size() - list.first;
    }
  }

  /// @param inside  the box lies in the parent's shadow, and so do its parts: nothing is left to ask
  void collect(std::size_t cell, const DirectionBox& box, const ShadowSection& shadow, std::int32_t parent,
               bool inside) {
    if (--work_left_ <= 0) return;
    const std::int64_t content = cells_[cell];
    const auto seen = [&](std::int32_t id) { return mark_[static_cast<std::size_t>(id - first_)] == parent; };
    const auto link = [&](std::int32_t id) {
      if (seen(id)) return;
      mark_[static_cast<std::size_t>(id - first_)] = parent;
      hierarchy_.links.push_back(id);
    };
    if (content < 0) {
      const auto id = static_cast<std::int32_t>(-1 - content);
      if (!seen(id) && (inside || shadow.meets(box))) link(id);
      return;
    }
    const NodeList& list = list_of(static_cast<std::size_t>(content));
    const auto first = listed_.begin() + static_cast<std::ptrdiff_t>(list.first);
    const auto last = first + static_cast<std::ptrdiff_t>(list.count);
    if (list.known && std::all_of(first, last, seen)) return;
    if (!inside) {
      if (!shadow.meets(box)) return;
      const ShadowCone& cone = hierarchy_.nodes[static_cast<std::size_t>(parent)].shadow;
      inside = cone.contains(box.middle()) && covers(cone, box);
    }
    if (inside && list.known) {
      std::for_each(first, last, link);
      return;
    }
    for (int k = 0; k < box.corners(); ++k) {
      collect(static_cast<std::size_t>(content) + static_cast<std::size_t>(k), box.child(k), shadow, parent, inside);
    }
  }

  static constexpr std::int64_t kPointsAStep = 8;
  /// What a walk saves where all nodes below a cell are linked already, longer lists hardly save more often.
  static constexpr std::size_t kMostListed = 64;

  struct NodeList {
    std::size_t first, count;  ///< in `listed_`
    bool known;                ///< not longer than `kMostListed`
  };
  NodeList& list_of(std::size_t parts) { return lists_[(parts - static_cast<std::size_t>(faces())) / corners_]; }

  [[nodiscard]] int faces() const { return 2 * dimension_; }

  int dimension_;
  std::size_t corners_;  ///< of a box
  PolarBody polar_;
  MacbeathHierarchy& hierarchy_;
  std::int64_t work_left_;
  double delta_ = 0;
  bool leaves_ = false;
  std::int32_t first_ = 0;
  std::int32_t previous_first_ = 0;
  std::vector<ShadowCone> cores_;        ///< of the layer's nodes
  DirectionBox face_{};                  ///< that is being covered
  std::vector<ShadowSection> sections_;  ///< of the layer's cover shadows with it
  std::vector<std::int64_t> cells_;      ///< the first of its 2^(d-1) parts, or -1 - node
  std::vector<NodeList> lists_;          ///< per split cell
  std::vector<std::int32_t> listed_;
  std::vector<std::int64_t> mark_;  ///< per node of the layer: the last cell, or parent, that took it
  std::vector<std::vector<std::int32_t>> neighbours_, next_neighbours_;  ///< per node of the layers above and now
  std::vector<std::int32_t> all_;
};

}  // namespace

std::unique_ptr<WidthStructure> build_macbeath_hierarchy(const std::vector<AnySupport>& points, const AnyMap& frame,
                                                         double epsilon, std::int64_t most_work) {
  auto hierarchy = std::make_unique<MacbeathHierarchy>();
  hierarchy->points = points;
  hierarchy->pull_back = inverse_of<kAnyDimension>(frame.linear).transpose();
  std::vector<AnyVector> fat;
  for (const AnySupport& p : points) fat.push_back(frame.apply(p.point));
  HierarchyBuilder builder(PolarBody(std::move(fat)), *hierarchy, most_work);
  constexpr double kFirst = 0.5;
  // Doubled from the leaves' upwards: a last layer that hardly differs from the one above would cost as much as it. The
  // first one is left out where the second is near it.
  constexpr double kNear = 0.7;
  int doublings = 0;
  while (std::ldexp(epsilon, doublings + 1) <= kFirst) ++doublings;
  const bool first = std::ldexp(epsilon, doublings) < kNear * kFirst;
  for (int i = first ? doublings + 1 : doublings; i >= 0; --i) {
    const double delta = i == 0 ? epsilon : std::min(kFirst, std::ldexp(epsilon, i));
    if (!builder.add_layer(delta, i == 0)) return nullptr;
  }
  return hierarchy;
}

}  // namespace pd::dimension::detail
