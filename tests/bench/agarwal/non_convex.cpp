/// @file
/// Non-convex bodies as unions of convex parts ([A], open problem (ii)): the certified bracket against the exact cuts,
/// and its cost against 1 / delta.
#include "scenes/non_convex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/agarwal/agarwal.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/union_of_parts.hpp"

namespace pd::bench {

namespace {

const Claim kCells{"Open problem (ii), cells", "the octree's cells as its bracket closes to (1 + delta)"};
const Claim kBracket{"Open problem (ii), bracket", "lower <= exact depth <= upper <= (1 + delta) lower"};
const Claim kCuts{"Section 4, exact cuts", "uncovered facets near the answer only: cuts and time as the parts grow"};

Compound compound_of(const scenes::PartList& list) {
  std::vector<Compound::Part> parts;
  for (const scenes::PointPart& part : list) {
    parts.push_back({ConvexShape(*ConvexPolytope::from_points(part.points)), part.pose});
  }
  return *Compound::from_parts(std::move(parts));
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
}

}  // namespace pd::bench
