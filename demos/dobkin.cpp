/// @file
/// `pdepth demo dobkin`: the constructions of [D] as pictures.
#include <array>

#include "dobkin/dobkin_pictures.hpp"
#include "support/demo_registry.hpp"
#include "support/still_pictures.hpp"

namespace pd::demo {

namespace {

constexpr std::array kPictures{
    StillPicture{"hierarchies", hierarchy_picture},
    StillPicture{"descent", descent_picture},
    StillPicture{"polygons", polygons_picture},
};

}  // namespace

int run_dobkin(const DemoOptions& options) { return draw_still_pictures(options, "dobkin", kPictures); }

}  // namespace pd::demo
