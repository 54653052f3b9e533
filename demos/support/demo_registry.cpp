/// @file
/// The table of demos.
#include "support/demo_registry.hpp"

#include <array>

namespace pd::demo {

namespace {

constexpr std::array kDemos{
    Demo{"stacking", "bodies at rest, in heaps and on the move: solver against solver from the same start", true,
         run_stacking},
    Demo{"rollback", "bodies thrown fast at each other, taken back to the exact time of first contact", true,
         run_rollback},
    Demo{"difference", "one pair with its Minkowski difference: why the depth is what it is", false, run_difference},
    Demo{"agarwal", "the constructions of Agarwal et al. 2000: normal diagrams, grids, searches, width", false,
         run_agarwal},
    Demo{"dobkin", "the constructions of Dobkin et al. 1993: hierarchies, a descent, polygons with holes", false,
         run_dobkin},
};

}  // namespace

std::span<const Demo> demos() { return kDemos; }

const Demo* find_demo(std::string_view name) {
  for (const Demo& demo : kDemos) {
    if (demo.name == name) {
      return &demo;
    }
  }
  return nullptr;
}

}  // namespace pd::demo
