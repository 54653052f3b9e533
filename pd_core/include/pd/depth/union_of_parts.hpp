/// @file
/// Forwards to its new place, pd/compound/compound_depth.hpp.
#pragma once

#include "pd/compound/compound_depth.hpp"
