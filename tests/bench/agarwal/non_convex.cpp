/// @file
/// Non-convex bodies as unions of convex parts ([A], open problem (ii)): the certified bracket against the exact cuts,
/// and its cost against 1 / delta.
#include "scenes/non_convex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "bench/agarwal/near_facets.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/compound/compound_difference.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/star_body.hpp"

namespace pd::bench {

namespace {

const Claim kCells{"Open problem (ii), cells", "the octree's cells as its bracket closes to (1 + delta)"};
const Claim kBracket{"Open problem (ii), bracket", "lower <= exact depth <= upper <= (1 + delta) lower"};
const Claim kCuts{"Section 4, exact cuts", "uncovered facets near the answer only: cuts and time as the parts grow"};
const Claim kStars{"Remark after section 4, star-shaped",
                   "the boundary of P in O(m^2 n^2 alpha(mn)) time: exponents in mn at most 2"};

Compound compound_of(const scenes::PartList& list) {
  std::vector<Compound::Part> parts;
  for (const scenes::PointPart& part : list) {
    parts.push_back({ConvexShape(*ConvexPolytope::from_points(part.points)), part.pose});
  }
  return *Compound::from_parts(std::move(parts));
}

/// The least distance of the origin from the polygons of a built boundary.
double distance_to_boundary(const UnionDifference& built) {
  double least = HUGE_VAL;
  std::vector<Vec3> corners;
  for (const UnionDifference::Facet& facet : built.facets) {
    corners.clear();
    for (std::int32_t i = 0; i < facet.count; ++i) {
      const std::int32_t corner = built.corners[static_cast<std::size_t>(facet.first + i)];
      corners.push_back(built.vertices[static_cast<std::size_t>(corner)]);
    }
    least = std::min(least, squared_distance_from_origin(corners));
  }
  return std::sqrt(least);
}

/// Star prisms of k spikes, m = n = 8 k faces: the whole boundary, and the lazy search beside it.
void measure_stars(const AgarwalSettings& settings, ClaimTable& table) {
  Growth facets{"star prisms", "boundary facets", "mn"};
  Growth built_time{"star prisms", "time to build P, ns", "mn"};
  Growth search_time{"star prisms", "time to search, ns", "mn"};
  scenes::Random random(settings.seed);
  const auto star = [&](int k) {
    const scenes::Surface surface = scenes::star_prism(k, 0.5, random);
    return StarBody::from_faces(surface.vertices, surface.faces, surface.centre)->tetrahedra();
  };
  Scratch scratch;
  int wrong = 0;
  for (int k = 2; k <= (settings.quick ? 4 : 8); ++k) {
    const Compound a = star(k), b = star(k);
    const Pose pose = random.pose({0.5, 0.1, 0.2});
    const double mn = 64.0 * k * k;
    Expected<UnionDifference> built = Error{};
    Expected<UnionDepth> answer = Error{};
    const std::function<void()> build = [&] { built = minkowski_difference({&a, pose}, {&b, Pose()}); };
    const std::function<void()> search = [&] { answer = penetration_depth({&a, pose}, {&b, Pose()}, scratch); };
    built_time.add(mn, least_times_ns({&build, 1}, 1, false)[0]);
    search_time.add(mn, least_times_ns({&search, 1}, 1, false)[0]);
    if (!built || !answer) continue;
    facets.add(mn, static_cast<double>(built->facets.size()));
    const bool same = std::abs(distance_to_boundary(*built) - answer->depth) <= 1e-9;
    wrong += answer->contact == ContactClass::overlapping && same ? 0 : 1;
  }
  table.add_growth(kStars, std::move(facets), 2);
  table.add_growth(kStars, std::move(built_time), 2);
  table.add_growth(kStars, std::move(search_time), 2);
  table.add_value(kStars, "star prisms", std::string(kWrongAnswers), "all mn", wrong, 0);
}

struct Body {
  std::string name;
  Compound body;
};

}  // namespace

void measure_non_convex(const AgarwalSettings& settings, ClaimTable& table) {
  scenes::Random random(settings.seed * 0x9E3779B97F4A7C15ULL + 41);
  const std::vector<Body> bodies = {{"letter L", compound_of(scenes::letter_l())},
                                    {"letter U", compound_of(scenes::letter_u(1.25))},
                                    {"cross", compound_of(scenes::cross())},
                                    {"dumbbell", compound_of(scenes::dumbbell(12, random))},
                                    {"rubble", compound_of(scenes::rubble(4, 8, random))}};
  const Compound block = compound_of({{scenes::box({0.6, 0.5, 0.7}), Pose()}});
  const Pose pose = *Pose::from_quaternion({0.8, 0.36, 0.0, 0.48}, Vec3(0.2, 0.15, 0.1));
  Scratch scratch;
  const std::vector<double> deltas =
      settings.quick ? std::vector<double>{0.3, 0.1, 0.03} : std::vector<double>{0.5, 0.3, 0.1, 0.03, 0.01, 0.003};
  for (const Body& body : bodies) {
    const auto exact = penetration_depth({&body.body, pose}, {&block, Pose()}, scratch);
    if (!exact || exact->contact != ContactClass::overlapping) continue;
    Growth cells{body.name, "cells", "1 / delta"};
    Growth time{body.name, "time, ns", "1 / delta"};
    int wrong = 0, open = 0;
    for (const double delta : deltas) {
      Expected<UnionDepth> answer = *exact;
      const std::function<void()> query = [&] {
        answer = penetration_depth({&body.body, pose}, {&block, Pose()}, scratch,
                                   {.method = UnionMethod::octree, .delta = delta});
      };
      time.add(1 / delta, least_times_ns({&query, 1}, 1, false)[0]);
      if (!answer) continue;
      cells.add(1 / delta, static_cast<double>(answer->work.cells));
      wrong += answer->lower <= exact->upper && exact->lower <= answer->upper ? 0 : 1;
      open += answer->closed ? 0 : 1;
      if (time.y.back() > (settings.quick ? 2e9 : 2e10)) break;
    }
    table.add_growth(kCells, std::move(cells));
    table.add_growth(kCells, std::move(time));
    table.add_value(kBracket, body.name, std::string(kWrongAnswers), "all deltas", wrong, 0);
    table.add_value(kBracket, body.name, "brackets that did not close", "all deltas", open, 0);
  }
  Growth cuts{"rubble against rubble", "cuts", "parts"};
  Growth time{"rubble against rubble", "time, ns", "parts"};
  for (const int parts : doublings(2, settings.quick ? 8 : 16)) {
    const Compound a = compound_of(scenes::rubble(parts, 10, random));
    const Compound b = compound_of(scenes::rubble(parts, 10, random));
    Expected<UnionDepth> answer = Error{};
    const std::function<void()> query = [&] { answer = penetration_depth({&a, pose}, {&b, Pose()}, scratch); };
    time.add(parts, least_times_ns({&query, 1}, 1, false)[0]);
    if (answer) cuts.add(parts, static_cast<double>(answer->work.cuts));
  }
  table.add_growth(kCuts, std::move(cuts));
  table.add_growth(kCuts, std::move(time));
  measure_stars(settings, table);
}

}  // namespace pd::bench
