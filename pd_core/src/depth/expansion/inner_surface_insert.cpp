/// @file
/// Insertion of a point: the faces visible from it go, and a cone over the border of that region, the horizon, takes
/// their place.
///
/// 1. Find the visible faces: on small surfaces by testing all planes at once, on large ones by a flood from a visible
///    face.
/// 2. Collect the horizon: the edges between a face that goes and a face that stays. Each vertex may have one horizon
///    edge that leaves it and one that reaches it, or else the surface would not stay a surface.
/// 3. Make a face for every horizon edge and the point, in slots at the end or in free ones, with their planes.
/// 4. Join each to the face beyond its horizon edge and to its neighbours around the point.
/// 5. Find the nearest face.
///
/// Every loop runs over slots, removed faces or horizon edges, of which there are at most three for a removed face.
#include <algorithm>
#include <bit>
#include <utility>

#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

namespace {

/// Up to this many slots, as many as a word has bits, all planes are tested against a new vertex at once, which costs
/// less than a flood; beyond, faces are no longer added at the end.
constexpr int kFewSlots = 64;

}  // namespace

PD_INLINE int InnerSurface::insert_vertex(int from, int v, double x, double y, double z) {
  // A horizon has at most three edges for every face that goes.
  if (3 * slots_ + kPlaneBlock > room_ || vertices.size() > leaving_.size()) {
    reserve(3 * slots_);
    reaching_.resize(vertices.capacity());
    leaving_.resize(vertices.capacity());
  }
  if (slots_ > kFewSlots) return insert_among_many(from, v) ? nearest_ : -1;
  std::uint64_t removed = planes_below(planes(), slots_, x, y, z) | std::uint64_t{1} << from;
  if (!trace_horizon(removed)) {
    // Several regions of a surface that is not convex are visible: the one around `from` will do.
    removed = connected_visible_region(from, removed);
    if (!trace_horizon(removed)) return -1;
  }
  if (append_mode_ && padded_to_lanes(slots_) + padded_to_lanes(horizon_count_) <= kFewSlots) {
    return fill_with_new_slots(v, removed);
  }
  removed_count_ = 0;
  for (; removed != 0; removed &= removed - 1) removed_[removed_count_++] = std::countr_zero(removed);
  fill_with_free_slots(v);
  return nearest_;
}

int InnerSurface::insert(int from, int v, double x, double y, double z) {
  const int nearest = insert_vertex(from, v, x, y, z);
  if constexpr (kValidate) {
    if (nearest >= 0) validate_after_insertion(*this, false, checked_insertions_);
  }
  return nearest;
}

bool InnerSurface::insert_among_many(int from, int v) {
  flood_visible(from, vertices[v].x);
  const bool closed = trace_horizon();
  for (int i = 0; i < removed_count_; ++i) removed_bits_[removed_[i] >> 6] = 0;
  if (closed) fill_with_free_slots(v);
  return closed;
}

/// The visible faces joined to `from` by visible faces.
std::uint64_t InnerSurface::connected_visible_region(int from, std::uint64_t visible) const {
  std::uint64_t region = 0;
  for (std::uint64_t open = std::uint64_t{1} << from; open != 0;) {
    const int f = std::countr_zero(open);
    region |= std::uint64_t{1} << f;
    for (const std::int32_t adjacent : triangles_[f].adj) open |= std::uint64_t{1} << (adjacent >> 2);
    open &= visible & ~region;
  }
  return region;
}

void InnerSurface::flood_visible(int from, const Vec3& x) {
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
bool InnerSurface::trace_horizon(std::uint64_t removed) {
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
  return link_horizon(count);
}

/// The same for the faces listed and marked as removed.
bool InnerSurface::trace_horizon() {
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
  return link_horizon(count);
}

/// Links the edges by their vertices.
bool InnerSurface::link_horizon(std::int32_t count) {
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
int InnerSurface::fill_with_new_slots(int v, std::uint64_t removed) {
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

void InnerSurface::fill_with_free_slots(int v) {
  const int count = horizon_count_;
  if (append_mode_) list_free_slots();
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
  nearest_ = least_key(keys_.data(), slots_);
}

/// The triangles of a cone over the horizon and their neighbours.
template <class SlotOf>
void InnerSurface::join_fan(int v, SlotOf&& slot_of) {
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

void InnerSurface::list_free_slots() {
  append_mode_ = false;
  free_.clear();
  for (int f = 0; f < slots_; ++f) {
    if (keys_[f] == kRemoved) free_.push_back(f);
  }
}

/// Makes `removed_` the slots of `count` new faces; removed faces beyond those leave free slots.
void InnerSurface::take_slots(int count) {
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
