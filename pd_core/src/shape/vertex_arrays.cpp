#include "shape/vertex_arrays.hpp"

#include <cstddef>
#include <cstdint>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

/// Four lanes; on narrower machines the compiler takes two registers for one.
typedef double Lanes __attribute__((vector_size(32)));
constexpr int kLanes = 4;
static_assert(2 * kLanes == kVertexBlock);

PD_INLINE void load(Lanes& to, const double* from) { __builtin_memcpy(&to, from, sizeof(Lanes)); }
PD_INLINE void store(double* to, const Lanes& from) { __builtin_memcpy(to, &from, sizeof(Lanes)); }

struct Direction {
  double x, y, z;
};

PD_INLINE void heights(Lanes& to, const VertexArrays& v, int i, const Direction& d) {
  Lanes x, y, z;
  load(x, v.x + i);
  load(y, v.y + i);
  load(z, v.z + i);
  to = x * d.x + y * d.y + z * d.z;
}

PD_INLINE int farthest(const VertexArrays& v, const Direction& d) {
  // Two rows of lanes, so that comparisons do not wait for each other. Ids are counted in doubles: one kind of
  // register.
  const Lanes row = {0, 1, 2, 3};
  Lanes best, other, best_id = row, other_id = row + kLanes, id = other_id;
  heights(best, v, 0, d);
  heights(other, v, kLanes, d);
  for (int i = kVertexBlock; i < v.count; i += kVertexBlock) {
    Lanes next, after;
    heights(next, v, i, d);
    heights(after, v, i + kLanes, d);
    id += kLanes;
    best_id = next > best ? id : best_id;
    best = next > best ? next : best;
    id += kLanes;
    other_id = after > other ? id : other_id;
    other = after > other ? after : other;
  }
  const Lanes most = other > best ? other : best;
  const double low = most[1] > most[0] ? most[1] : most[0];
  const double high = most[3] > most[2] ? most[3] : most[2];
  const double top = high > low ? high : low;
  const Lanes zero = {0, 0, 0, 0};
  const Lanes tops = zero + top;
  const Lanes none = zero + 0x1p40;
  const Lanes from_best = best == tops ? best_id : none;
  const Lanes from_other = other == tops ? other_id : none;
  const Lanes ids = from_other < from_best ? from_other : from_best;
  const double first = ids[1] < ids[0] ? ids[1] : ids[0];
  const double second = ids[3] < ids[2] ? ids[3] : ids[2];
  const double winner = second < first ? second : first;
  // The padding repeats vertex 0, which comes first. Nobody wins where products overflowed.
  return winner < v.count ? static_cast<int>(winner) : 0;
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
  const Lanes x = ((bx * b[0] + by * b[1] + bz * b[2]) - (ax * a[0] + ay * a[1] + az * a[2])) + bodies.offset[0];
  const Lanes y = ((bx * b[3] + by * b[4] + bz * b[5]) - (ax * a[3] + ay * a[4] + az * a[5])) + bodies.offset[1];
  const Lanes z = ((bx * b[6] + by * b[7] + bz * b[8]) - (ax * a[6] + ay * a[7] + az * a[8])) + bodies.offset[2];
  const Lanes xy_even = __builtin_shufflevector(x, y, 0, 4, 2, 6);
  const Lanes xy_odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  const Lanes zi_even = __builtin_shufflevector(z, id, 0, 4, 2, 6);
  const Lanes zi_odd = __builtin_shufflevector(z, id, 1, 5, 3, 7);
  store(out, __builtin_shufflevector(xy_even, zi_even, 0, 1, 4, 5));
  store(out + 4, __builtin_shufflevector(xy_odd, zi_odd, 0, 1, 4, 5));
  store(out + 8, __builtin_shufflevector(xy_even, zi_even, 2, 3, 6, 7));
  store(out + 12, __builtin_shufflevector(xy_odd, zi_odd, 2, 3, 6, 7));
}

typedef float Floats __attribute__((vector_size(32)));
typedef float HalfFloats __attribute__((vector_size(16)));
typedef std::int32_t Ids __attribute__((vector_size(32)));
typedef std::int32_t HalfIds __attribute__((vector_size(16)));
constexpr int kFloats = 8;
static_assert(ConvexPolytope::kPadding == 2 * kFloats);

PD_INLINE void heights(Floats& to, const SampleArrays& v, int i, float dx, float dy, float dz) {
  Floats x, y, z;
  __builtin_memcpy(&x, v.x + i, sizeof(Floats));
  __builtin_memcpy(&y, v.y + i, sizeof(Floats));
  __builtin_memcpy(&z, v.z + i, sizeof(Floats));
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

PD_CLONES int farthest_in_single_precision(const SampleArrays& sample, float dx, float dy, float dz) {
  Floats best, other;
  heights(best, sample, 0, dx, dy, dz);
  heights(other, sample, kFloats, dx, dy, dz);
  const Ids row = {0, 1, 2, 3, 4, 5, 6, 7};
  Ids best_id = row, other_id = row + kFloats, id = other_id;
  for (int i = 2 * kFloats; i < sample.count; i += 2 * kFloats) {
    Floats next, after;
    heights(next, sample, i, dx, dy, dz);
    heights(after, sample, i + kFloats, dx, dy, dz);
    id += kFloats;
    best_id = next > best ? id : best_id;
    best = next > best ? next : best;
    id += kFloats;
    other_id = after > other ? id : other_id;
    other = after > other ? after : other;
  }
  const Floats most = other > best ? other : best;
  const HalfFloats low = __builtin_shufflevector(most, most, 0, 1, 2, 3);
  const HalfFloats high = __builtin_shufflevector(most, most, 4, 5, 6, 7);
  const HalfFloats top = high > low ? high : low;
  const float left = top[1] > top[0] ? top[1] : top[0];
  const float right = top[3] > top[2] ? top[3] : top[2];
  const float greatest = right > left ? right : left;
  const Floats tops = {greatest, greatest, greatest, greatest, greatest, greatest, greatest, greatest};
  constexpr std::int32_t kNobody = 0x7fffffff;
  const Ids none = {kNobody, kNobody, kNobody, kNobody, kNobody, kNobody, kNobody, kNobody};
  const Ids from_best = best == tops ? best_id : none;
  const Ids from_other = other == tops ? other_id : none;
  const Ids ids = from_other < from_best ? from_other : from_best;
  const HalfIds low_ids = __builtin_shufflevector(ids, ids, 0, 1, 2, 3);
  const HalfIds high_ids = __builtin_shufflevector(ids, ids, 4, 5, 6, 7);
  const HalfIds least = high_ids < low_ids ? high_ids : low_ids;
  const std::int32_t left_id = least[1] < least[0] ? least[1] : least[0];
  const std::int32_t right_id = least[3] < least[2] ? least[3] : least[2];
  const std::int32_t winner = right_id < left_id ? right_id : left_id;
  return winner < sample.count ? winner : 0;
}

PD_CLONES void turn_vertices(const VertexArrays& vertices, const double (&matrix)[9], double* x, double* y, double* z) {
  const int padded = (vertices.count + kVertexBlock - 1) / kVertexBlock * kVertexBlock;
  for (int i = 0; i < padded; i += kLanes) {
    Lanes turned;
    heights(turned, vertices, i, {matrix[0], matrix[1], matrix[2]});
    store(x + i, turned);
    heights(turned, vertices, i, {matrix[3], matrix[4], matrix[5]});
    store(y + i, turned);
    heights(turned, vertices, i, {matrix[6], matrix[7], matrix[8]});
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
