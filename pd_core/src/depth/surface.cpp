#include "depth/surface.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace pd::detail {

namespace {

/// Up to this many slots the nearest face is found by a scan, which costs less than keeping a heap.
constexpr int kHeapFrom = 448;
/// Up to this many slots all planes are tested against a new vertex at once, which costs less than a flood.
constexpr int kFloodFrom = 64;
/// Room for an ordinary query, made at once, so that the first one does not grow it piece by piece.
constexpr int kFirstRoom = 192;

constexpr std::int32_t next_edge(std::int32_t e) { return e == 2 ? 0 : e + 1; }

constexpr auto kLater = [](const auto& x, const auto& y) {
  return x.key > y.key || (x.key == y.key && x.face > y.face);
};

}  // namespace

void Surface::clear() {
  if (triangles_.empty()) {
    reserve_faces(kFirstRoom);
    reserve_horizon(kFirstRoom);
    vertices.reserve(kFirstRoom);
    free_.reserve(kFirstRoom / 2);
    removed_.reserve(kFirstRoom / 2);
    face_numbers_.reserve(kFirstRoom);
    vertex_numbers_.reserve(kFirstRoom);
  }
  std::fill_n(keys_.begin(), slots_, kRemoved);
  std::fill_n(levels_.begin(), slots_, kRemoved);
  vertices.clear();
  free_.clear();
  heap_.clear();
  heap_active_ = false;
  slots_ = 0;
  in_use_ = 0;
}

void Surface::reserve_faces(int more) {
  const std::size_t wanted = static_cast<std::size_t>(slots_ + more);
  if (wanted + kPlaneBlock <= triangles_.size()) return;
  const std::size_t room = padded_to_block(static_cast<int>(2 * wanted) + kPlaneBlock);
  triangles_.resize(room);
  for (auto* values : {&nx_, &ny_, &nz_}) values->resize(room, 0);
  levels_.resize(room, kRemoved);
  keys_.resize(room, kRemoved);
  stamps_.resize(room, 0);
  removed_bits_.resize(room / 64 + 1, 0);
}

void Surface::reserve_horizon(std::size_t edges) {
  const std::size_t wanted = edges + kPlaneBlock;
  if (wanted <= from_.size()) return;
  for (auto* ids : {&from_, &to_, &outside_, &new_slots_}) ids->resize(2 * wanted);
  new_keys_.resize(2 * wanted);
}

void Surface::compute_planes() {
  reserve_horizon(static_cast<std::size_t>(slots_));
  // The horizon's lists are free: they serve for the corners.
  for (int f = 0; f < slots_; ++f) {
    from_[f] = triangles_[f].v[0];
    to_[f] = triangles_[f].v[1];
    outside_[f] = triangles_[f].v[2];
    new_slots_[f] = f;
  }
  const int padded = padded_to_block(slots_);
  for (int f = slots_; f < padded; ++f) from_[f] = to_[f] = outside_[f] = 0;
  triangle_planes(vertices.data()->x.data(), {from_.data(), to_.data(), outside_.data()}, 0, slots_, new_slots_.data(),
                  planes(), new_keys_.data());
  nearest_ = least_key(keys_.data(), slots_);
}

void Surface::push_heap(int f) {
  heap_.push_back({keys_[f], f, stamps_[f]});
  std::push_heap(heap_.begin(), heap_.end(), kLater);
}

bool Surface::start_tetrahedron(double flat) {
  const Vec3& p = vertices[0].x;
  const double volume = (vertices[1].x - p).cross(vertices[2].x - p).dot(vertices[3].x - p);
  if (!(std::abs(volume) > flat)) return false;
  // Face 0 1 2 must have vertex 3 behind it.
  if (volume > 0) std::swap(vertices[1], vertices[2]);
  // 4 * face + edge: edge 0 1 of face 0 is edge 1 0 (the last) of face 1, and so on.
  static constexpr SurfaceTriangle kFaces[4] = {{{0, 1, 2}, {4 * 1 + 2, 4 * 2 + 2, 4 * 3 + 2}},
                                                {{0, 3, 1}, {4 * 3 + 1, 4 * 2 + 0, 4 * 0 + 0}},
                                                {{1, 3, 2}, {4 * 1 + 1, 4 * 3 + 0, 4 * 0 + 1}},
                                                {{2, 3, 0}, {4 * 2 + 1, 4 * 1 + 0, 4 * 0 + 2}}};
  reserve_faces(4);
  std::copy(kFaces, kFaces + 4, triangles_.begin());
  slots_ = in_use_ = 4;
  compute_planes();
  return true;
}

void Surface::start_heap() {
  heap_active_ = true;
  heap_.clear();
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] != kRemoved) heap_.push_back({keys_[f], f, stamps_[f]});
  }
  std::make_heap(heap_.begin(), heap_.end(), kLater);
}

void Surface::find_nearest_by_heap() {
  while (heap_.front().stamp != stamps_[heap_.front().face]) {
    std::pop_heap(heap_.begin(), heap_.end(), kLater);
    heap_.pop_back();
  }
  nearest_ = heap_.front().face;
}

bool Surface::insert(int from, int v) {
  const Vec3 x = vertices[v].x;
  find_visible(from, x);
  bool closed = trace_horizon();
  if (!closed && slots_ <= kFloodFrom) {
    // Several patches of a crooked surface see x: the one round `from` will do.
    keep_component(from);
    closed = trace_horizon();
  }
  unmark_removed();
  if (closed) fill_hole(v);
  return closed;
}

void Surface::find_visible(int from, const Vec3& x) {
  removed_.clear();
  if (slots_ > kFloodFrom) {
    flood_visible(from, x);
    return;
  }
  std::uint64_t visible = planes_below(planes(), slots_, x.x(), x.y(), x.z()) | std::uint64_t{1} << from;
  removed_bits_[0] = visible;
  for (; visible != 0; visible &= visible - 1) removed_.push_back(std::countr_zero(visible));
}

void Surface::flood_visible(int from, const Vec3& x) {
  mark_removed(from);
  removed_.push_back(from);
  for (std::size_t i = 0; i < removed_.size(); ++i) {
    const SurfaceTriangle& face = triangles_[removed_[i]];
    for (const std::int32_t adjacent : face.adj) {
      const std::int32_t g = adjacent >> 2;
      if (is_removed(g) || !(x.dot(normal(g)) > levels_[g])) continue;
      mark_removed(g);
      removed_.push_back(g);
    }
  }
}

void Surface::keep_component(int from) {
  const std::uint64_t visible = removed_bits_[0];
  removed_bits_[0] = 0;
  removed_.clear();
  mark_removed(from);
  removed_.push_back(from);
  for (std::size_t i = 0; i < removed_.size(); ++i) {
    for (const std::int32_t adjacent : triangles_[removed_[i]].adj) {
      const std::int32_t g = adjacent >> 2;
      if (is_removed(g) || (visible >> g & 1) == 0) continue;
      mark_removed(g);
      removed_.push_back(g);
    }
  }
}

/// The edges between faces that go and faces that stay. False when there are none, or two that leave one vertex.
bool Surface::trace_horizon() {
  reserve_horizon(3 * removed_.size());
  if (leaving_.size() <= vertices.capacity()) {
    leaving_.resize(vertices.capacity() + 1);
    reaching_.resize(vertices.capacity() + 1);
  }
  // Local names for the arrays: the compiler cannot know that writing one does not move another.
  std::int32_t* const from = from_.data();
  std::int32_t* const to = to_.data();
  std::int32_t* const beyond = outside_.data();
  const SurfaceTriangle* const triangles = triangles_.data();
  const std::uint64_t* const removed_bits = removed_bits_.data();
  std::int32_t* const leaving = leaving_.data();
  std::int32_t* const reaching = reaching_.data();
  const std::int32_t bin = static_cast<std::int32_t>(leaving_.size()) - 1;
  std::int32_t count = 0;
  for (const std::int32_t f : removed_) {
    const SurfaceTriangle& face = triangles[f];
    for (std::int32_t e = 0; e < 3; ++e) {
      // Written in any case and counted where it stays: no branch to guess.
      const std::int32_t outside = face.adj[e];
      const std::int32_t g = outside >> 2;
      const std::int32_t p = face.v[e];
      const std::int32_t q = face.v[next_edge(e)];
      const bool stays = (removed_bits[g >> 6] >> (g & 63) & 1) == 0;
      from[count] = p;
      to[count] = q;
      beyond[count] = outside;
      leaving[stays ? p : bin] = count;
      reaching[stays ? q : bin] = count;
      count += stays;
    }
  }
  bool simple = count > 0;
  for (std::int32_t i = 0; i < count; ++i) {
    simple &= (leaving[from[i]] == i) & (reaching[to[i]] == i) & (from[leaving[to[i]]] == to[i]);
  }
  horizon_count_ = count;
  return simple;
}

void Surface::fill_hole(int v) {
  const int count = horizon_count_;
  for (const std::int32_t f : removed_) keys_[f] = levels_[f] = kRemoved;
  // Before the new keys: vector loads would wait for scalar stores that have just been made.
  const int nearest_old = heap_active_ ? 0 : least_key(keys_.data(), slots_);
  const double key_old = keys_[nearest_old];
  take_slots(count);
  std::int32_t* const from = from_.data();
  std::int32_t* const to = to_.data();
  const std::int32_t* const beyond = outside_.data();
  const std::int32_t* const slots = new_slots_.data();
  const int padded = padded_to_block(count);
  for (int i = count; i < padded; ++i) {
    from[i] = from[0];
    to[i] = to[0];
  }
  triangle_planes(vertices.data()->x.data(), {from, to, nullptr}, v, count, slots, planes(), new_keys_.data());
  SurfaceTriangle* const triangles = triangles_.data();
  const std::int32_t* const leaving = leaving_.data();
  const std::int32_t* const reaching = reaching_.data();
  for (int i = 0; i < count; ++i) {
    const std::int32_t f = slots[i];
    triangles[f] = {{from[i], to[i], v}, {beyond[i], 4 * slots[leaving[to[i]]] + 2, 4 * slots[reaching[from[i]]] + 1}};
    triangles[beyond[i] >> 2].adj[beyond[i] & 3] = 4 * f;
  }
  if (!heap_active_ && slots_ > kHeapFrom) {
    start_heap();
  } else if (heap_active_) {
    for (int i = 0; i < count; ++i) push_heap(slots[i]);
  }
  if (heap_active_) {
    find_nearest_by_heap();
    return;
  }
  // Padding repeats the first new face, so the lowest index is a real one.
  const int least_new = least_key(new_keys_.data(), count);
  const double key_new = new_keys_[least_new];
  const bool old = (key_old < key_new) | ((key_old == key_new) & (nearest_old < slots[least_new]));
  nearest_ = old ? nearest_old : slots[least_new];
}

/// Slots for `count` new faces: those of the removed faces come first.
void Surface::take_slots(int count) {
  reserve_faces(count);
  const int removed = static_cast<int>(removed_.size());
  const int reused = std::min(count, removed);
  for (int i = 0; i < reused; ++i) new_slots_[i] = removed_[i];
  for (int i = reused; i < count; ++i) {
    if (free_.empty()) {
      new_slots_[i] = slots_++;
    } else {
      new_slots_[i] = free_.back();
      free_.pop_back();
    }
  }
  for (int i = reused; i < removed; ++i) free_.push_back(removed_[i]);
  if (heap_active_) {
    for (const std::int32_t f : removed_) ++stamps_[f];
  }
  in_use_ += count - removed;
}

void Surface::unmark_removed() {
  for (const std::int32_t f : removed_) removed_bits_[f >> 6] = 0;
}

}  // namespace pd::detail
