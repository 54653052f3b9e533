/// @file
/// The table of demos.
#include "support/demo_registry.hpp"

#include <array>

namespace pd::demo {

namespace {

constexpr std::array kDemos{
    Demo{"stacking", "towers and piles where the solver matters: solver against solver from the same start",
         run_stacking},
    Demo{"rollback", "bodies thrown fast at each other, taken back to the exact time of first contact", run_rollback},
    Demo{"difference", "one pair with its Minkowski difference: why the depth is what it is", run_difference},
    Demo{"agarwal", "the constructions of Agarwal et al. 2000: normal diagrams, grids, searches, width", run_agarwal},
    Demo{"dobkin", "the constructions of Dobkin et al. 1993: hierarchies, a descent, polygons with holes", run_dobkin},
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
