/// @file
/// `pdepth demo agarwal`: the constructions of [A] as pictures.
#include <array>

#include "agarwal/agarwal_pictures.hpp"
#include "support/demo_registry.hpp"
#include "support/still_pictures.hpp"

namespace pd::demo {

namespace {

constexpr std::array kAgarwalPictures{
    StillPicture{"normal_diagrams",
                 "The normal diagrams of -A and B on one sphere; their crossings are the edge-edge facets of P, "
                 "coloured by the families of the decomposition",
                 normal_diagrams_picture},
    StillPicture{"direction_grid", "The grid of directions and its rays through P", direction_grid_picture},
    StillPicture{"shallow_search", "The facets of P that a shallow search visits", shallow_search_picture},
    StillPicture{"width", "Width as the depth of a body in itself", width_picture},
    StillPicture{"non_convex", "A body that is not convex, as a union of convex parts", non_convex_picture},
};

}  // namespace

int run_agarwal(const DemoOptions& options) {
  return draw_still_pictures(options, "agarwal", "The constructions of Agarwal et al.", kAgarwalPictures);
}

}  // namespace pd::demo
