#include "planar/boundary/monotone_pieces.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "numeric/at.hpp"
#include "pd/numeric/predicates.hpp"

namespace pd::detail {

namespace {

/// A region under the sweep from left to right. Its vertices are numbered anew, 0 .. n - 1.
class Region {
 public:
  Region(std::span<const Point2> points, std::span<const std::vector<std::int32_t>> rings) : status_(Below{this}) {
    for (const auto& ring : rings) {
      const auto begin = static_cast<std::int32_t>(id_.size());
      const auto size = static_cast<std::int32_t>(ring.size());
      for (std::int32_t i = 0; i < size; ++i) {
        id_.push_back(ring[at(i)]);
        point_.push_back(points[at(id_.back())]);
        next_.push_back(begin + (i + 1) % size);
        previous_.push_back(begin + (i + size - 1) % size);
      }
    }
    place_.assign(id_.size(), status_.end());
    latest_.assign(id_.size(), -1);
    is_merge_.assign(id_.size(), false);
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(id_.size()); ++v) order_.push_back(v);
    // Corners at one point are passed as if each were moved a little into its own part of the region.
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
      return point(a) != point(b) ? point(a) < point(b) : rank(a) != rank(b) ? rank(a) < rank(b) : a < b;
    });
  }

  void cut(std::vector<std::array<std::int32_t, 3>>& triangles) {
    for (const int v : order_) pass(v);
    link_diagonals();
    for (int v = 0; v < static_cast<int>(id_.size()); ++v) {
      for (std::size_t k = 0; k < ways_[at(v)].size(); ++k) {
        if (!walked_[at(v)][k]) cut_piece(v, k, triangles);
      }
    }
  }

 private:
  [[nodiscard]] const Point2& point(int v) const { return point_[at(v)]; }
  [[nodiscard]] int next(int v) const { return next_[at(v)]; }
  [[nodiscard]] int previous(int v) const { return previous_[at(v)]; }
  [[nodiscard]] int side(int a, int b, int c) const { return orient2d(point(a), point(b), point(c)); }

  /// Into which part of the plane round its point a corner's region reaches: 0 to the left alone or nearly all round,
  /// 2 to the right in the same way, 1 up or down.
  [[nodiscard]] int rank(int v) const {
    const bool in_from_left = point(previous(v)) < point(v);
    if (in_from_left != (point(next(v)) < point(v))) return 1;
    return in_from_left == (side(previous(v), v, next(v)) > 0) ? 0 : 2;
  }

  /// The status holds the edges that run rightwards, by their first vertex: the region lies above each.
  struct Probe {
    int vertex;
  };
  struct Below {
    using is_transparent = void;
    const Region* region;
    bool operator()(int e, int f) const {
      if (e == f) return false;
      if (region->point(e) < region->point(f)) return region->side(e, region->next(e), f) > 0;
      const int side = region->side(f, region->next(f), e);
      return side != 0 ? side < 0 : region->side(f, region->next(f), region->next(e)) < 0;
    }
    bool operator()(int e, Probe p) const { return region->side(e, region->next(e), p.vertex) > 0; }
    bool operator()(Probe p, int e) const { return region->side(e, region->next(e), p.vertex) < 0; }
  };
  using Status = std::set<int, Below>;

  void connect_if_merge(int e, int v) {
    if (is_merge_[at(latest_[at(e)])]) diagonals_.emplace_back(v, latest_[at(e)]);
  }
  void open(int v) {
    place_[at(v)] = status_.insert(v).first;
    latest_[at(v)] = v;
  }
  void close(int e, int v) {
    connect_if_merge(e, v);
    status_.erase(place_[at(e)]);
  }
  [[nodiscard]] int edge_under(int v) const { return *std::prev(status_.lower_bound(Probe{v})); }

  void pass(int v) {
    const bool in_from_left = point(previous(v)) < point(v);
    const bool out_to_left = point(next(v)) < point(v);
    const bool convex = side(previous(v), v, next(v)) > 0;
    if (!in_from_left && !out_to_left) {
      if (!convex) {  // split: connected to what was seen last above the edge below
        const int e = edge_under(v);
        diagonals_.emplace_back(v, latest_[at(e)]);
        latest_[at(e)] = v;
      }
      open(v);
    } else if (in_from_left && out_to_left) {
      close(previous(v), v);
      if (!convex) {
        const int e = edge_under(v);
        connect_if_merge(e, v);
        latest_[at(e)] = v;
        is_merge_[at(v)] = true;
      }
    } else if (in_from_left) {
      close(previous(v), v);
      open(v);
    } else {
      const int e = edge_under(v);
      connect_if_merge(e, v);
      latest_[at(e)] = v;
    }
  }

  void link_diagonals() {
    ways_.resize(id_.size());
    for (int v = 0; v < static_cast<int>(id_.size()); ++v) ways_[at(v)].push_back(next(v));
    for (const auto& [a, b] : diagonals_) {
      ways_[at(a)].push_back(b);
      ways_[at(b)].push_back(a);
    }
    walked_.resize(id_.size());
    for (int v = 0; v < static_cast<int>(id_.size()); ++v) {
      auto& ways = ways_[at(v)];
      // Counter-clockwise from the ring's own next edge: all diagonals lie between it and the edge to the previous
      // vertex.
      std::sort(ways.begin() + 1, ways.end(), [&](int a, int b) { return turns_before(v, a, b); });
      walked_[at(v)].assign(ways.size(), false);
    }
  }

  /// Seen from v, is a met before b when turning counter-clockwise from the edge to the next vertex?
  [[nodiscard]] bool turns_before(int v, int a, int b) const {
    const int base = next(v);
    const int side_a = side(v, base, a), side_b = side(v, base, b);
    const bool late_a = side_a < 0 || (side_a == 0 && opposite(v, base, a));
    const bool late_b = side_b < 0 || (side_b == 0 && opposite(v, base, b));
    if (late_a != late_b) return late_b;
    return side(v, a, b) > 0;
  }
  /// For a on the line through v and base: does it lie on the other side of v?
  [[nodiscard]] bool opposite(int v, int base, int a) const {
    return (point(base) < point(v)) != (point(a) < point(v));
  }

  /// Leaving v by way k and keeping the face on the left: the next way is the one clockwise of the way back.
  void cut_piece(int v, std::size_t k, std::vector<std::array<std::int32_t, 3>>& triangles) {
    std::vector<int> face;
    while (!walked_[at(v)][k]) {
      walked_[at(v)][k] = true;
      face.push_back(v);
      const int w = ways_[at(v)][k];
      const auto& ways = ways_[at(w)];
      // The way back is a diagonal among `ways`, or the ring's edge, which is past all of them.
      const bool by_ring = k == 0;
      k = by_ring ? ways.size() - 1
                  : static_cast<std::size_t>(std::find(ways.begin() + 1, ways.end(), v) - ways.begin()) - 1;
      v = w;
    }
    cut_monotone(face, triangles);
  }

  void emit(int a, int b, int c, std::vector<std::array<std::int32_t, 3>>& triangles) const {
    if (side(a, b, c) < 0) std::swap(b, c);
    triangles.push_back({id_[at(a)], id_[at(b)], id_[at(c)]});
  }

  /// A counter-clockwise face, monotone in the order of the sweep.
  void cut_monotone(const std::vector<int>& face, std::vector<std::array<std::int32_t, 3>>& triangles) const {
    const std::size_t n = face.size();
    if (n == 3) return emit(face[0], face[1], face[2], triangles);
    struct Corner {
      int vertex;
      bool lower;  ///< on the chain from the leftmost corner to the rightmost that has the face on its left
    };
    std::vector<Corner> sorted;
    for (std::size_t i = 0; i < n; ++i) sorted.push_back({face[i], point(face[i]) < point(face[(i + 1) % n])});
    std::sort(sorted.begin(), sorted.end(),
              [&](const Corner& a, const Corner& b) { return point(a.vertex) < point(b.vertex); });
    std::vector<Corner> stack = {sorted[0], sorted[1]};
    for (std::size_t j = 2; j < n; ++j) {
      const Corner corner = sorted[j];
      if (j + 1 == n || corner.lower != stack.back().lower) {
        for (std::size_t i = 0; i + 1 < stack.size(); ++i) {
          emit(corner.vertex, stack[i].vertex, stack[i + 1].vertex, triangles);
        }
        stack = {sorted[j - 1], corner};
        continue;
      }
      while (stack.size() > 1) {
        const int turn = side(stack[stack.size() - 2].vertex, stack.back().vertex, corner.vertex);
        if (corner.lower ? turn <= 0 : turn >= 0) break;
        emit(corner.vertex, stack[stack.size() - 2].vertex, stack.back().vertex, triangles);
        stack.pop_back();
      }
      stack.push_back(corner);
    }
  }

  std::vector<std::int32_t> id_, next_, previous_, order_, latest_;
  std::vector<Point2> point_;
  Status status_;
  std::vector<Status::iterator> place_;
  std::vector<bool> is_merge_;
  std::vector<std::pair<int, int>> diagonals_;
  std::vector<std::vector<int>>
      ways_;  ///< per vertex: the ring's next vertex, then diagonals counter-clockwise from it
  std::vector<std::vector<bool>> walked_;
};

}  // namespace

void triangulate_region(std::span<const Point2> points, std::span<const std::vector<std::int32_t>> rings,
                        std::vector<std::array<std::int32_t, 3>>& triangles) {
  Region(points, rings).cut(triangles);
}

}  // namespace pd::detail
