/// @file
/// What steps that end at first contact cost: `rollback_law --cost`.
#pragma once

namespace pd::bench {

/// Prints processor time a step of a pile of 64 boxes at rest, and of 50 balls at 30 m/s in a room: plain, and with
/// rollback.
void report_costs();

}  // namespace pd::bench
