#include "depth/surface.hpp"

#include <algorithm>
#include <utility>

namespace pd::detail {

namespace {

/// Up to this many slots the nearest face is found by a scan, which costs less than keeping a heap.
constexpr int kHeapFrom = 96;

constexpr std::int32_t next_edge(std::int32_t e) { return e == 2 ? 0 : e + 1; }

constexpr auto kLater = [](const auto& x, const auto& y) {
  return x.key > y.key || (x.key == y.key && x.face > y.face);
};

}  // namespace

void Surface::clear() {
  vertices.clear();
  free_.clear();
  heap_.clear();
  heap_active_ = false;
  slots_ = 0;
  in_use_ = 0;
}

int Surface::new_face() {
  ++in_use_;
  if (!free_.empty()) {
    const int f = free_.back();
    free_.pop_back();
    return f;
  }
  if (static_cast<std::size_t>(slots_) == faces.size()) {
    const std::size_t room = std::max<std::size_t>(static_cast<std::size_t>(kHeapFrom), 2 * faces.size());
    faces.resize(room);
    keys.resize(room);
    stamps_.resize(room, 0);
    marked_.resize(room, 0);
  }
  return slots_++;
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
  // 4 * face + edge: edge 0 1 of face 0 is edge 1 0 (the last) of face 1, and so on.
  static constexpr std::int32_t kAdjacent[4][3] = {{4 * 1 + 2, 4 * 2 + 2, 4 * 3 + 2},
                                                   {4 * 3 + 1, 4 * 2 + 0, 4 * 0 + 0},
                                                   {4 * 1 + 1, 4 * 3 + 0, 4 * 0 + 1},
                                                   {4 * 2 + 1, 4 * 1 + 0, 4 * 0 + 2}};
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
  for (int f = 0; f < slots_; ++f) {
    if (keys[f] != kRemoved) set_plane(f);
  }
}

int Surface::nearest() {
  if (!heap_active_ && slots_ <= kHeapFrom) {
    int best = 0;
    double least = keys[0];
    for (int f = 1; f < slots_; ++f) {
      const bool nearer = keys[f] < least;
      least = nearer ? keys[f] : least;
      best = nearer ? f : best;
    }
    return best;
  }
  if (!heap_active_) {
    heap_active_ = true;
    heap_.clear();
    for (int f = 0; f < slots_; ++f) {
      if (keys[f] != kRemoved) heap_.push_back({keys[f], f, stamps_[f]});
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
    const SurfaceFace& face = faces[visit.face];
    const std::int32_t e = visit.edge;
    visit.edge = next_edge(e);
    --visit.left;
    const std::int32_t g = face.adj[e] >> 2;
    if (marked_[g]) continue;
    if (x.dot(faces[g].normal) > faces[g].level) {
      marked_[g] = 1;
      removed_.push_back(g);
      visits_.push_back({g, next_edge(face.adj[e] & 3), 2});
    } else {
      horizon_.push_back({face.adj[e], face.v[e], face.v[next_edge(e)]});
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
    face.adj[0] = edge.outside;
    faces[edge.outside >> 2].adj[edge.outside & 3] = 4 * f;
    if (previous >= 0) {
      face.adj[2] = 4 * previous + 1;
      faces[previous].adj[1] = 4 * f + 2;
    } else {
      first = f;
    }
    previous = f;
    set_plane(f);
  }
  faces[first].adj[2] = 4 * previous + 1;
  faces[previous].adj[1] = 4 * first + 2;
  return true;
}

}  // namespace pd::detail
