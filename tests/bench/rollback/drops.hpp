/// @file
/// A ball of restitution 1 dropped from 1 m: `rollback_law --drop`.
#pragma once

namespace pd::bench {

/// Prints how high it comes back after 10 s, and between what bounds its energy stays: plain, with rollback, and with
/// exact flight.
void report_drops();

}  // namespace pd::bench
