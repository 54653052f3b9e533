#include "shape/farthest_vertex.hpp"

// Only plain loops here: an inline function of a library, compiled for a wider instruction set, could be the copy that
// the linker keeps for everybody.
#if defined(__x86_64__) && defined(__linux__) && !defined(PD_ISA_BASELINE)
#define PD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define PD_CLONES
#endif

namespace pd::detail {

PD_CLONES int farthest_vertex(const double* x, const double* y, const double* z, int n, double dx, double dy,
                              double dz) {
  constexpr int kLanes = 8;
  double best[kLanes];
  double block_of[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    best[k] = x[k] * dx + y[k] * dy + z[k] * dz;
    block_of[k] = 0;
  }
  for (int i = kLanes; i < n; i += kLanes) {
    const double block = i;
    for (int k = 0; k < kLanes; ++k) {
      const double value = x[i + k] * dx + y[i + k] * dy + z[i + k] * dz;
      block_of[k] = value > best[k] ? block : block_of[k];
      best[k] = value > best[k] ? value : best[k];
    }
  }
  // Two short loops: one that keeps both the value and its index takes more instructions.
  double greatest = best[0];
  for (int k = 1; k < kLanes; ++k) greatest = best[k] > greatest ? best[k] : greatest;
  int winner = 0x7fffffff;
  for (int k = 0; k < kLanes; ++k) {
    const int id = static_cast<int>(block_of[k]) + k;
    winner = best[k] == greatest && id < winner ? id : winner;
  }
  return winner < n ? winner : 0;  // the padding repeats vertex 0
}

}  // namespace pd::detail
