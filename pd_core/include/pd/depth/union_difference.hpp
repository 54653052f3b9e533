/// @file
/// Forwards to its new place, pd/compound/compound_difference.hpp.
#pragma once

#include "pd/compound/compound_difference.hpp"
