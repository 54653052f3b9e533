#include "depth/expansion/inner_surface.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace pd::detail {

namespace {

/// Up to this many slots the nearest face is found by a scan, which costs less than keeping a heap.
constexpr int kHeapFrom = 448;
/// Up to this many slots, as many as a word has bits, all planes are tested against a new vertex at once, which costs
/// less than a flood; beyond, faces are no longer added at the end.
constexpr int kFewSlots = 64;
/// A rebuilt surface takes four vertices to enclose the rest and this many of those that matter most. Measured on
/// coherent frames: with 6 more supports are asked for, with 24 inserting them costs more than asking.
constexpr std::size_t kRebuiltVertices = 10;
/// Room for an ordinary query, made at once, so that the first one does not grow it piece by piece.
constexpr int kFirstRoom = 192;

constexpr auto kLater = [](const auto& x, const auto& y) {
  return x.key > y.key || (x.key == y.key && x.face > y.face);
};

}  // namespace

void Surface::clear() {
  if (triangles_.empty()) {
    reserve(kFirstRoom);
    vertices.reserve(kFirstRoom);
    free_.reserve(kFirstRoom / 2);
    kept_.reserve(kFirstRoom);
    nearness_.reserve(kFirstRoom);
    open_edges_.reserve(4 * kFirstRoom);
    face_numbers_.reserve(kFirstRoom);
    vertex_numbers_.reserve(kFirstRoom);
  }
  clear_faces();
  vertices.clear();
}

void Surface::clear_faces() {
  std::fill_n(keys_.begin(), slots_, kRemoved);
  std::fill_n(levels_.begin(), slots_, kRemoved);
  free_.clear();
  heap_.clear();
  heap_active_ = false;
  slots_ = 0;
  in_use_ = 0;
  young_ = true;
}

void Surface::reserve(int count) {
  if (count + kPlaneBlock <= room_) return;
  room_ = padded_to_block(2 * count + kPlaneBlock);
  const auto room = static_cast<std::size_t>(room_);
  triangles_.resize(room);
  for (auto* values : {&nx_, &ny_, &nz_}) values->resize(room, 0);
  levels_.resize(room, kRemoved);
  keys_.resize(room, kRemoved);
  stamps_.resize(room, 0);
  removed_bits_.resize(room / 64 + 1, 0);
  for (auto* ids : {&from_, &to_, &outside_, &removed_}) ids->resize(room);
  for (auto* values : {&fan_nx_, &fan_ny_, &fan_nz_, &fan_levels_, &fan_keys_}) values->resize(room);
}

void Surface::compute_planes() {
  // The horizon's lists are free: they serve for the corners.
  for (int f = 0; f < slots_; ++f) {
    from_[f] = triangles_[f].v[0];
    to_[f] = triangles_[f].v[1];
    outside_[f] = triangles_[f].v[2];
  }
  const int padded = padded_to_block(slots_);
  for (int f = slots_; f < padded; ++f) from_[f] = to_[f] = outside_[f] = 0;
  triangle_planes(vertices.data()->x.data(), {from_.data(), to_.data(), outside_.data()}, 0, slots_, planes());
  std::fill(keys_.begin() + slots_, keys_.begin() + padded, kRemoved);
  std::fill(levels_.begin() + slots_, levels_.begin() + padded, kRemoved);
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
  reserve(4);
  std::copy(kFaces, kFaces + 4, triangles_.begin());
  slots_ = in_use_ = 4;
  static constexpr std::int32_t kCorners[3][kPlaneLanes] = {{0, 0, 1, 2}, {1, 3, 3, 3}, {2, 1, 2, 0}};
  triangle_planes(vertices.data()->x.data(), {kCorners[0], kCorners[1], kCorners[2]}, 0, 4, planes());
  nearest_ = least_key(keys_.data(), 4);
  return true;
}

bool Surface::find_spread_vertices(double flat, std::int32_t (&ids)[4]) const {
  const std::vector<DifferenceVertex>& v = vertices;
  std::fill_n(ids, 4, 0);
  if (v.size() < 4) return false;
  const auto find = [&](auto&& measure) {
    std::int32_t best = 0;
    double most = 0;
    for (std::int32_t i = 1; i < static_cast<std::int32_t>(v.size()); ++i) {
      const double value = measure(v[i].x);
      if (value > most) {
        most = value;
        best = i;
      }
    }
    return best;
  };
  const Vec3& from = v[0].x;
  ids[0] = 0;
  ids[1] = find([&](const Vec3& x) { return (x - from).squaredNorm(); });
  const Vec3 along = v[ids[1]].x - from;
  ids[2] = find([&](const Vec3& x) { return (x - from).cross(along).squaredNorm(); });
  const Vec3 normal = along.cross(v[ids[2]].x - from);
  ids[3] = find([&](const Vec3& x) { return std::abs((x - from).dot(normal)); });
  return std::abs((v[ids[3]].x - from).dot(normal)) > flat;
}

bool Surface::start_from_spread_vertices(double flat) {
  std::int32_t ids[4];
  if (!find_spread_vertices(flat, ids)) return false;
  kept_.clear();
  for (const std::int32_t i : ids) kept_.push_back(vertices[i]);
  std::swap(vertices, kept_);
  return start_tetrahedron(flat);
}

bool Surface::rebuild(double flat) {
  std::int32_t ids[4];
  if (!find_spread_vertices(flat, ids)) return false;
  // What lies on the nearest faces decides, and the newest vertex, wherever it is.
  const std::size_t count = vertices.size();
  nearness_.assign(count, {kRemoved, 0});
  for (std::size_t i = 0; i < count; ++i) nearness_[i].vertex = static_cast<std::int32_t>(i);
  for (int f = 0; f < slots_; ++f) {
    for (const std::int32_t v : triangles_[f].v) nearness_[v].key = std::min(nearness_[v].key, keys_[f]);
  }
  nearness_.back().key = std::numeric_limits<double>::lowest();
  for (const std::int32_t i : ids) nearness_[i].key = kRemoved;
  const std::size_t near = std::min(count, kRebuiltVertices);
  std::partial_sort(nearness_.begin(), nearness_.begin() + static_cast<std::ptrdiff_t>(near), nearness_.end(),
                    [](const NearVertex& x, const NearVertex& y) {
                      return x.key < y.key || (x.key == y.key && x.vertex < y.vertex);
                    });
  kept_.clear();
  for (const std::int32_t i : ids) kept_.push_back(vertices[i]);
  for (std::size_t i = 0; i < near && nearness_[i].key < kRemoved; ++i) kept_.push_back(vertices[nearness_[i].vertex]);
  std::swap(vertices, kept_);
  clear_faces();
  if (!start_tetrahedron(flat)) return false;
  for (int v = 4; v < static_cast<int>(vertices.size()); ++v) {
    const int f = first_face_below(vertices[v].x);
    // Where rounding forbids it, the vertex is left inside.
    if (f >= 0) (void)insert(f, v);
  }
  return true;
}

/// A face that sees x, -1 when there is none.
int Surface::first_face_below(const Vec3& x) {
  for (int from = 0; from < slots_; from += 64) {
    const PlaneArrays block{nx_.data() + from, ny_.data() + from, nz_.data() + from, levels_.data() + from,
                            keys_.data() + from};
    const std::uint64_t below = planes_below(block, std::min(64, slots_ - from), x.x(), x.y(), x.z());
    if (below != 0) return from + std::countr_zero(below);
  }
  return -1;
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

int Surface::insert(int from, int v, double x, double y, double z) {
  // A horizon has at most three edges for every face that goes.
  if (3 * slots_ + kPlaneBlock > room_ || vertices.size() > leaving_.size()) {
    reserve(3 * slots_);
    leaving_.resize(vertices.capacity());
    reaching_.resize(vertices.capacity());
  }
  if (slots_ > kFewSlots) return insert_among_many(from, v) ? nearest_ : -1;
  std::uint64_t removed = planes_below(planes(), slots_, x, y, z) | std::uint64_t{1} << from;
  if (!trace_horizon(removed)) {
    // Several patches of a crooked surface see x: the one round `from` will do.
    removed = patch_round(from, removed);
    if (!trace_horizon(removed)) return -1;
  }
  if (young_ && padded_to_lanes(slots_) + padded_to_lanes(horizon_count_) <= kFewSlots) {
    return fill_with_new_slots(v, removed);
  }
  removed_count_ = 0;
  for (; removed != 0; removed &= removed - 1) removed_[removed_count_++] = std::countr_zero(removed);
  fill_with_free_slots(v);
  return nearest_;
}

bool Surface::insert_among_many(int from, int v) {
  flood_visible(from, vertices[v].x);
  const bool closed = trace_horizon();
  for (int i = 0; i < removed_count_; ++i) removed_bits_[removed_[i] >> 6] = 0;
  if (closed) fill_with_free_slots(v);
  return closed;
}

/// The faces that are seen and joined to `from` by faces that are seen.
std::uint64_t Surface::patch_round(int from, std::uint64_t seen) const {
  std::uint64_t patch = 0;
  for (std::uint64_t open = std::uint64_t{1} << from; open != 0;) {
    const int f = std::countr_zero(open);
    patch |= std::uint64_t{1} << f;
    for (const std::int32_t adjacent : triangles_[f].adj) open |= std::uint64_t{1} << (adjacent >> 2);
    open &= seen & ~patch;
  }
  return patch;
}

void Surface::flood_visible(int from, const Vec3& x) {
  mark_removed(from);
  removed_[0] = from;
  removed_count_ = 1;
  for (int i = 0; i < removed_count_; ++i) {
    for (const std::int32_t adjacent : triangles_[removed_[i]].adj) {
      const std::int32_t g = adjacent >> 2;
      if (is_removed(g) || !(x.dot(normal(g)) > levels_[g])) continue;
      mark_removed(g);
      removed_[removed_count_++] = g;
    }
  }
}

/// The edges between faces that go and faces that stay. False when there are none, or two that leave one vertex.
bool Surface::trace_horizon(std::uint64_t removed) {
  // Local names for the arrays: the compiler cannot know that writing one does not move another.
  std::int32_t* const from = from_.data();
  std::int32_t* const to = to_.data();
  std::int32_t* const beyond = outside_.data();
  const SurfaceTriangle* const triangles = triangles_.data();
  std::int32_t count = 0;
  for (std::uint64_t faces = removed; faces != 0; faces &= faces - 1) {
    const SurfaceTriangle& face = triangles[std::countr_zero(faces)];
    for (std::int32_t e = 0; e < 3; ++e) {
      // Written in any case and counted where it stays: no branch to guess.
      from[count] = face.v[e];
      to[count] = face.v[next_edge(e)];
      beyond[count] = face.adj[e];
      count += static_cast<std::int32_t>(~removed >> (face.adj[e] >> 2) & 1);
    }
  }
  return close_horizon(count);
}

/// The same for the faces listed and marked as removed.
bool Surface::trace_horizon() {
  std::int32_t count = 0;
  for (int i = 0; i < removed_count_; ++i) {
    const SurfaceTriangle& face = triangles_[removed_[i]];
    for (std::int32_t e = 0; e < 3; ++e) {
      from_[count] = face.v[e];
      to_[count] = face.v[next_edge(e)];
      outside_[count] = face.adj[e];
      count += is_removed(face.adj[e] >> 2) ? 0 : 1;
    }
  }
  return close_horizon(count);
}

/// Links the edges by their vertices.
bool Surface::close_horizon(std::int32_t count) {
  const std::int32_t* const from = from_.data();
  const std::int32_t* const to = to_.data();
  std::int32_t* const leaving = leaving_.data();
  std::int32_t* const reaching = reaching_.data();
  for (std::int32_t i = 0; i < count; ++i) {
    leaving[from[i]] = i;
    reaching[to[i]] = i;
  }
  bool simple = count > 0;
  for (std::int32_t i = 0; i < count; ++i) {
    simple &= (leaving[from[i]] == i) & (reaching[to[i]] == i);
  }
  horizon_count_ = count;
  return simple;
}

/// Returns the nearest face.
int Surface::fill_with_new_slots(int v, std::uint64_t removed) {
  const int count = horizon_count_;
  const int first = padded_to_lanes(slots_);
  int gone = 0;
  for (std::uint64_t faces = removed; faces != 0; faces &= faces - 1) {
    const int f = std::countr_zero(faces);
    keys_[f] = levels_[f] = kRemoved;
    ++gone;
  }
  std::fill_n(from_.begin() + count, kPlaneLanes, from_[0]);
  std::fill_n(to_.begin() + count, kPlaneLanes, to_[0]);
  const int nearest =
      add_fan(vertices.data()->x.data(), {from_.data(), to_.data(), nullptr}, v, count, planes(), first);
  slots_ = first + count;
  in_use_ += count - gone;
  nearest_ = nearest;
  join_fan(v, [first](std::int32_t i) { return first + i; });
  return nearest;
}

void Surface::fill_with_free_slots(int v) {
  const int count = horizon_count_;
  if (young_) list_free_slots();
  take_slots(count);
  std::fill_n(from_.begin() + count, kPlaneLanes, from_[0]);
  std::fill_n(to_.begin() + count, kPlaneLanes, to_[0]);
  const PlaneArrays fan{fan_nx_.data(), fan_ny_.data(), fan_nz_.data(), fan_levels_.data(), fan_keys_.data()};
  triangle_planes(vertices.data()->x.data(), {from_.data(), to_.data(), nullptr}, v, count, fan);
  const PlaneArrays plane = planes();
  const std::int32_t* const slots = removed_.data();
  for (int i = 0; i < count; ++i) {
    const std::int32_t f = slots[i];
    plane.nx[f] = fan.nx[i];
    plane.ny[f] = fan.ny[i];
    plane.nz[f] = fan.nz[i];
    plane.level[f] = fan.level[i];
    plane.key[f] = fan.key[i];
  }
  join_fan(v, [slots](std::int32_t i) { return slots[i]; });
  if (slots_ <= kHeapFrom && !heap_active_) {
    nearest_ = least_key(keys_.data(), slots_);
    return;
  }
  if (heap_active_) {
    for (int i = 0; i < count; ++i) push_heap(slots[i]);
  } else {
    start_heap();
  }
  find_nearest_by_heap();
}

/// The triangles of a cone over the horizon and their neighbours.
template <class SlotOf>
void Surface::join_fan(int v, SlotOf&& slot_of) {
  const std::int32_t* const from = from_.data();
  const std::int32_t* const to = to_.data();
  const std::int32_t* const beyond = outside_.data();
  const std::int32_t* const leaving = leaving_.data();
  const std::int32_t* const reaching = reaching_.data();
  SurfaceTriangle* const triangles = triangles_.data();
  for (std::int32_t i = 0; i < horizon_count_; ++i) {
    const std::int32_t f = slot_of(i);
    triangles[f] = {{from[i], to[i], v},
                    {beyond[i], 4 * slot_of(leaving[to[i]]) + 2, 4 * slot_of(reaching[from[i]]) + 1}};
    triangles[beyond[i] >> 2].adj[beyond[i] & 3] = 4 * f;
  }
}

void Surface::list_free_slots() {
  young_ = false;
  free_.clear();
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] == kRemoved) free_.push_back(f);
  }
}

/// Makes `removed_` the slots of `count` new faces; removed faces beyond those leave free slots.
void Surface::take_slots(int count) {
  if (heap_active_) {
    for (int i = 0; i < removed_count_; ++i) ++stamps_[removed_[i]];
  }
  in_use_ += count - removed_count_;
  for (int i = removed_count_; i < count; ++i) {
    if (free_.empty()) {
      removed_[i] = slots_++;
    } else {
      removed_[i] = free_.back();
      free_.pop_back();
    }
  }
  for (int i = count; i < removed_count_; ++i) {
    const std::int32_t f = removed_[i];
    keys_[f] = levels_[f] = kRemoved;
    free_.push_back(f);
  }
}

}  // namespace pd::detail
