#include "shape/support/vertex_arrays.hpp"

#include <cstddef>
#include <cstdint>

#include "numeric/lanes.hpp"
#include "shape/support/scan_lanes.hpp"

namespace pd::detail {

namespace {

struct Best {
  Lanes value;
  Lanes id;  ///< counted in doubles: one kind of register
};

/// The farther of two in every lane; of equal ones the lower id.
PD_INLINE void take_farther(Best& best, const Best& other) {
  const Lanes lower = other.id < best.id ? other.id : best.id;
  best.id = other.value > best.value ? other.id : other.value == best.value ? lower : best.id;
  best.value = other.value > best.value ? other.value : best.value;
}

/// Lane j holds the best of vertices j, j + 4, j + 8, ...
PD_INLINE void farthest_by_lane(Best& best, const VertexArrays& v, const Direction& d) {
  best.id = Lanes{0, 1, 2, 3};
  heights(best.value, v, 0, d);
  Lanes id = best.id;
  for (int i = kLanes; i < v.count; i += kLanes) {
    Lanes next;
    heights(next, v, i, d);
    id += kLanes;
    best.id = next > best.value ? id : best.id;
    best.value = next > best.value ? next : best.value;
  }
}

/// Lane k of `ids`: the winner in direction k.
PD_INLINE void farthest_in_four(Lanes& ids, const VertexArrays& v, const double (&d)[12]) {
  Best best[4];
  for (int k = 0; k < 4; ++k) farthest_by_lane(best[k], v, {d[k], d[4 + k], d[8 + k]});
  transpose(best[0].value, best[1].value, best[2].value, best[3].value);
  transpose(best[0].id, best[1].id, best[2].id, best[3].id);
  take_farther(best[0], best[1]);
  take_farther(best[2], best[3]);
  take_farther(best[0], best[2]);
  // The padding repeats vertex 0, which comes first. Nobody wins where products overflowed.
  const Lanes zero = {0, 0, 0, 0};
  ids = best[0].id < zero + static_cast<double>(v.count) ? best[0].id : zero;
}

/// Four values by their ids.
PD_INLINE void gather(Lanes& to, const double* from, const std::int32_t* ids) {
  to = Lanes{from[ids[0]], from[ids[2]], from[ids[4]], from[ids[6]]};
}

/// Four pairs; `ids` and `out` as in pose_pairs.
PD_INLINE void pose_four(const PosedBodies& bodies, const std::int32_t* ids, double* out) {
  Lanes ax, ay, az, bx, by, bz, id;
  gather(ax, bodies.a.x, ids);
  gather(ay, bodies.a.y, ids);
  gather(az, bodies.a.z, ids);
  gather(bx, bodies.b.x, ids + 1);
  gather(by, bodies.b.y, ids + 1);
  gather(bz, bodies.b.z, ids + 1);
  __builtin_memcpy(&id, ids, sizeof(Lanes));
  const double* const a = bodies.matrix_a;
  const double* const b = bodies.matrix_b;
  Lanes x = ((bx * b[0] + by * b[1] + bz * b[2]) - (ax * a[0] + ay * a[1] + az * a[2])) + bodies.offset[0];
  Lanes y = ((bx * b[3] + by * b[4] + bz * b[5]) - (ax * a[3] + ay * a[4] + az * a[5])) + bodies.offset[1];
  Lanes z = ((bx * b[6] + by * b[7] + bz * b[8]) - (ax * a[6] + ay * a[7] + az * a[8])) + bodies.offset[2];
  transpose(x, y, z, id);
  store(out, x);
  store(out + 4, y);
  store(out + 8, z);
  store(out + 12, id);
}

static_assert(ConvexPolytope::VertexBlock::kVertices == kFloats);

PD_INLINE void heights(Floats& to, const ConvexPolytope::VertexBlock& v, float dx, float dy, float dz) {
  Floats x, y, z;
  load(x, v.x);
  load(y, v.y);
  load(z, v.z);
  to = x * dx + y * dy + z * dz;
}

}  // namespace

PD_CLONES int farthest_vertex(const VertexArrays& vertices, double dx, double dy, double dz) {
  return farthest(vertices, {dx, dy, dz});
}

PD_CLONES VertexPair farthest_vertices(const VertexArrays& a, const VertexArrays& b, double dx, double dy, double dz) {
  const Direction d{dx, dy, dz};
  return {farthest(a, d), farthest(b, d)};
}

PD_CLONES void farthest_in_four_directions(const VertexArrays& a, const VertexArrays& b, const double (&directions)[12],
                                           VertexPair (&pairs)[4]) {
  Lanes of_a, of_b;
  farthest_in_four(of_a, a, directions);
  farthest_in_four(of_b, b, directions);
  for (int k = 0; k < 4; ++k) pairs[k] = {static_cast<int>(of_a[k]), static_cast<int>(of_b[k])};
}

PD_CLONES int farthest_of_blocks(const ConvexPolytope::VertexBlock& first, const ConvexPolytope::VertexBlock* more,
                                 int count, float dx, float dy, float dz) {
  Floats best;
  heights(best, first, dx, dy, dz);
  if (count == 0) {
    const float top = greatest(best);
    return first.id[__builtin_ctz(mask_of_eight(best == Floats{top, top, top, top, top, top, top, top}) | 128U)];
  }
  Ids best_id;
  __builtin_memcpy(&best_id, first.id, sizeof(Ids));
  for (int i = 0; i < count; ++i) {
    Floats next;
    Ids id;
    heights(next, more[i], dx, dy, dz);
    __builtin_memcpy(&id, more[i].id, sizeof(Ids));
    best_id = next > best ? id : best_id;
    best = next > best ? next : best;
  }
  const float top = greatest(best);
  constexpr std::int32_t kNobody = 0x7fffffff;
  const Ids none = {kNobody, kNobody, kNobody, kNobody, kNobody, kNobody, kNobody, kNobody};
  const Ids ids = best == Floats{top, top, top, top, top, top, top, top} ? best_id : none;
  const HalfIds low = __builtin_shufflevector(ids, ids, 0, 1, 2, 3);
  const HalfIds high = __builtin_shufflevector(ids, ids, 4, 5, 6, 7);
  const HalfIds lower = high < low ? high : low;
  const std::int32_t left = lower[1] < lower[0] ? lower[1] : lower[0];
  const std::int32_t right = lower[3] < lower[2] ? lower[3] : lower[2];
  return right < left ? right : left;
}

PD_CLONES void transform_vertices(const VertexArrays& vertices, const double* rotation, double sign, double* x,
                                  double* y, double* z) {
  const double* const r = rotation;
  const Direction rows[3] = {{sign * r[0], sign * r[3], sign * r[6]},
                             {sign * r[1], sign * r[4], sign * r[7]},
                             {sign * r[2], sign * r[5], sign * r[8]}};
  const int padded = (vertices.count + kVertexBlock - 1) / kVertexBlock * kVertexBlock;
  for (int i = 0; i < padded; i += kLanes) {
    Lanes turned;
    heights(turned, vertices, i, rows[0]);
    store(x + i, turned);
    heights(turned, vertices, i, rows[1]);
    store(y + i, turned);
    heights(turned, vertices, i, rows[2]);
    store(z + i, turned);
  }
}

PD_CLONES void pose_pairs(const PosedBodies& bodies, const std::int32_t* ids, int count, double* out) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) pose_four(bodies, ids + 2 * i, out + 4 * i);
  if (i == count) return;
  std::int32_t last_ids[2 * kLanes];
  double last[4 * kLanes];
  for (int k = 0; k < kLanes; ++k) {
    const int from = i + k < count ? i + k : i;
    last_ids[2 * k] = ids[2 * from];
    last_ids[2 * k + 1] = ids[2 * from + 1];
  }
  pose_four(bodies, last_ids, last);
  __builtin_memcpy(out + 4 * i, last, sizeof(double) * 4 * static_cast<std::size_t>(count - i));
}

}  // namespace pd::detail
