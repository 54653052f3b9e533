/// @file
/// The files of the folder page/, which the build puts into the program.
#pragma once

#include <string_view>

namespace pd::report {

extern const std::string_view kPageCss;
extern const std::string_view kPageJs;
extern const std::string_view kTableJs;
extern const std::string_view kPairJs;
extern const std::string_view kThreeJs;       ///< three.js, under the licence that follows
extern const std::string_view kThreeLicense;  ///< goes wherever its code goes: the page, and `pdepth --licenses`

}  // namespace pd::report
