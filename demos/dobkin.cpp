/// @file
/// `pdepth demo dobkin`: the constructions of [D] as pictures.
#include <array>

#include "dobkin/dobkin_pictures.hpp"
#include "support/demo_registry.hpp"
#include "support/still_pictures.hpp"

namespace pd::demo {

namespace {

constexpr std::array kDobkinPictures{
    StillPicture{"hierarchies", "The hierarchies of two polytopes, level by level", hierarchy_picture},
    StillPicture{"descent", "One descent through them along a direction", descent_picture},
    StillPicture{"polygons", "A polygon with holes, a convex one stuck in it, and all places where they overlap",
                 polygons_picture},
};

}  // namespace

int run_dobkin(const DemoOptions& options) {
  return draw_still_pictures(options, "dobkin", "The constructions of Dobkin et al.", kDobkinPictures);
}

}  // namespace pd::demo
