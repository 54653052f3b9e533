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
  if (faces.empty()) {
    // Room for an ordinary query at once, so that the first one does not grow it piece by piece.
    reserve_faces(2 * kHeapFrom);
    vertices.reserve(2 * kHeapFrom);
    free_.reserve(kHeapFrom);
    removed_.reserve(kHeapFrom);
    horizon_.reserve(kHeapFrom);
    horizon_from_.resize(vertices.capacity());
    face_numbers_.reserve(2 * kHeapFrom);
    vertex_numbers_.reserve(2 * kHeapFrom);
  }
  vertices.clear();
  free_.clear();
  heap_.clear();
  heap_active_ = false;
  slots_ = 0;
  in_use_ = 0;
}

void Surface::reserve_faces(int more) {
  const std::size_t wanted = static_cast<std::size_t>(slots_ + more);
  if (wanted <= faces.size()) return;
  const std::size_t room = std::max(static_cast<std::size_t>(kHeapFrom), 2 * wanted);
  faces.resize(room);
  keys.resize(room);
  stamps_.resize(room, 0);
}

int Surface::new_face() {
  ++in_use_;
  if (free_.empty()) return slots_++;
  const int f = free_.back();
  free_.pop_back();
  return f;
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
  reserve_faces(4);
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
  removed_.clear();
  if (horizon_from_.size() < vertices.capacity()) horizon_from_.resize(vertices.capacity());

  // Flood over the faces that x lies above; what they share with the others is the horizon, each edge found by its
  // origin.
  keys[from] = kRemoved;
  removed_.push_back(from);
  for (std::size_t i = 0; i < removed_.size(); ++i) {
    const SurfaceFace& face = faces[removed_[i]];
    for (std::int32_t e = 0; e < 3; ++e) {
      const std::int32_t g = face.adj[e] >> 2;
      if (keys[g] == kRemoved) continue;
      if (x.dot(faces[g].normal) > faces[g].level) {
        keys[g] = kRemoved;
        removed_.push_back(g);
      } else {
        horizon_from_[face.v[e]] = static_cast<std::int32_t>(horizon_.size());
        horizon_.push_back({face.adj[e], face.v[e], face.v[next_edge(e)]});
      }
    }
  }
  for (const std::int32_t f : removed_) ++stamps_[f];
  free_.insert(free_.end(), removed_.begin(), removed_.end());
  in_use_ -= static_cast<int>(removed_.size());

  // Round the hole, edge by edge. A hole that is no disc ends in fewer steps than there are edges, or in an edge that
  // does not continue the last one.
  const std::size_t count = horizon_.size();
  if (count < 3) return false;  // everything is seen from v
  reserve_faces(static_cast<int>(count));
  std::int32_t first = -1;
  std::int32_t previous = -1;
  std::int32_t at = horizon_[0].from;
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t slot = horizon_from_[at];
    if (static_cast<std::size_t>(slot) >= count || horizon_[slot].from != at || (k > 0 && slot == 0)) return false;
    const Horizon& edge = horizon_[slot];
    at = edge.to;
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
  if (at != horizon_[0].from) return false;
  faces[first].adj[2] = 4 * previous + 1;
  faces[previous].adj[1] = 4 * first + 2;
  return true;
}

}  // namespace pd::detail
