/// @file
/// `pdepth demo agarwal`: the constructions of [A] as pictures.
#include <array>

#include "agarwal/agarwal_pictures.hpp"
#include "support/demo_registry.hpp"
#include "support/still_pictures.hpp"

namespace pd::demo {

namespace {

constexpr std::array kPictures{
    StillPicture{"normal_diagrams", normal_diagrams_picture}, StillPicture{"direction_grid", direction_grid_picture},
    StillPicture{"shallow_search", shallow_search_picture},   StillPicture{"width", width_picture},
    StillPicture{"non_convex", non_convex_picture},
};

}  // namespace

int run_agarwal(const DemoOptions& options) { return draw_still_pictures(options, "agarwal", kPictures); }

}  // namespace pd::demo
