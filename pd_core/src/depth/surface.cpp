#include "depth/surface.hpp"

#include <algorithm>
#include <utility>

namespace pd::detail {

namespace {

/// Up to this many slots the nearest face is found by a scan, which costs less than keeping a heap.
constexpr std::size_t kHeapFrom = 96;

constexpr auto kLater = [](const auto& x, const auto& y) {
  return x.key > y.key || (x.key == y.key && x.face > y.face);
};

}  // namespace

void Surface::clear() {
  vertices.clear();
  faces.clear();
  keys.clear();
  stamps_.clear();
  free_.clear();
  marked_.clear();
  heap_.clear();
  heap_active_ = false;
  in_use_ = 0;
}

int Surface::new_face() {
  ++in_use_;
  if (!free_.empty()) {
    const int f = free_.back();
    free_.pop_back();
    return f;
  }
  faces.emplace_back();
  keys.push_back(kRemoved);
  stamps_.push_back(0);
  marked_.push_back(0);
  return static_cast<int>(faces.size()) - 1;
}

void Surface::set_plane(int f) {
  SurfaceFace& face = faces[f];
  const Vec3& p = vertices[face.v[0]].x;
  const Vec3& q = vertices[face.v[1]].x;
  const Vec3& r = vertices[face.v[2]].x;
  face.normal = (q - p).cross(r - p);
  const double a = p.dot(face.normal);
  const double b = q.dot(face.normal);
  const double c = r.dot(face.normal);
  // For any normal whatsoever the triangle lies beyond the least of the three levels: a sliver's bad normal cannot lie.
  const double least = std::min({a, b, c});
  face.level = std::max({a, b, c});
  const double squared = face.normal.squaredNorm();
  keys[f] = squared > 0 ? least * std::abs(least) / squared : -std::numeric_limits<double>::max();
  if (heap_active_) push_heap(f);
}

void Surface::push_heap(int f) {
  heap_.push_back({keys[f], f, stamps_[f]});
  std::push_heap(heap_.begin(), heap_.end(), kLater);
}

bool Surface::start_tetrahedron(double flat) {
  const Vec3& p = vertices[0].x;
  const double volume = (vertices[1].x - p).cross(vertices[2].x - p).dot(vertices[3].x - p);
  if (!(std::abs(volume) > flat)) return false;
  // Face 0 1 2 must have vertex 3 behind it.
  if (volume > 0) std::swap(vertices[1], vertices[2]);
  static constexpr std::int32_t kFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  static constexpr std::int32_t kAdjacent[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
  for (int f = 0; f < 4; ++f) {
    const int slot = new_face();
    for (int i = 0; i < 3; ++i) {
      faces[slot].v[i] = kFaces[f][i];
      faces[slot].adj[i] = kAdjacent[f][i];
    }
    set_plane(slot);
  }
  return true;
}

void Surface::refresh() {
  heap_active_ = false;
  heap_.clear();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (keys[f] != kRemoved) set_plane(static_cast<int>(f));
  }
}

int Surface::nearest() {
  if (!heap_active_ && faces.size() <= kHeapFrom) {
    int best = 0;
    for (std::size_t f = 1; f < keys.size(); ++f) {
      if (keys[f] < keys[best]) best = static_cast<int>(f);
    }
    return best;
  }
  if (!heap_active_) {
    heap_active_ = true;
    heap_.clear();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      if (keys[f] != kRemoved) heap_.push_back({keys[f], static_cast<std::int32_t>(f), stamps_[f]});
    }
    std::make_heap(heap_.begin(), heap_.end(), kLater);
  }
  while (heap_.front().stamp != stamps_[heap_.front().face]) {
    std::pop_heap(heap_.begin(), heap_.end(), kLater);
    heap_.pop_back();
  }
  return heap_.front().face;
}

bool Surface::insert(int from, int v) {
  const Vec3 x = vertices[v].x;
  horizon_.clear();
  visits_.clear();
  removed_.clear();

  // Depth-first flood over the faces that x lies above; edges to the others come out in their order round the hole.
  marked_[from] = 1;
  removed_.push_back(from);
  visits_.push_back({from, 0, 3});
  while (!visits_.empty()) {
    Visit& visit = visits_.back();
    if (visit.left == 0) {
      visits_.pop_back();
      continue;
    }
    const std::int32_t f = visit.face;
    const std::int32_t e = visit.edge;
    visit.edge = e == 2 ? 0 : e + 1;
    --visit.left;
    const std::int32_t g = faces[f].adj[e];
    if (marked_[g]) continue;
    const std::int32_t entered = faces[g].adj[0] == f && faces[g].v[1] == faces[f].v[e]   ? 0
                                 : faces[g].adj[1] == f && faces[g].v[2] == faces[f].v[e] ? 1
                                                                                          : 2;
    if (x.dot(faces[g].normal) > faces[g].level) {
      marked_[g] = 1;
      removed_.push_back(g);
      visits_.push_back({g, entered == 2 ? 0 : entered + 1, 2});
    } else {
      horizon_.push_back({g, entered, faces[f].v[e], faces[f].v[e == 2 ? 0 : e + 1]});
    }
  }
  for (const std::int32_t f : removed_) marked_[f] = 0;

  const std::size_t count = horizon_.size();
  if (count < 3) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (horizon_[i].to != horizon_[i + 1 == count ? 0 : i + 1].from) return false;
  }

  for (const std::int32_t f : removed_) {
    keys[f] = kRemoved;
    ++stamps_[f];
    free_.push_back(f);
    --in_use_;
  }
  std::int32_t first = -1;
  std::int32_t previous = -1;
  for (const Horizon& edge : horizon_) {
    const int f = new_face();
    SurfaceFace& face = faces[f];
    face.v[0] = edge.from;
    face.v[1] = edge.to;
    face.v[2] = v;
    face.adj[0] = edge.face;
    face.adj[2] = previous;
    faces[edge.face].adj[edge.edge] = f;
    if (previous >= 0) {
      faces[previous].adj[1] = f;
    } else {
      first = f;
    }
    previous = f;
    set_plane(f);
  }
  faces[first].adj[2] = previous;
  faces[previous].adj[1] = first;
  return true;
}

}  // namespace pd::detail
