/// @file
/// Where the page of a bench goes.
#pragma once

#include <string>

namespace pd::bench {

/// Where a page goes and how it is made again.
struct ReportTarget {
  std::string folder;   ///< empty: no page is asked for
  std::string command;  ///< the whole command line, the seed included
  std::string seed;     ///< empty where nothing is drawn
};

}  // namespace pd::bench
