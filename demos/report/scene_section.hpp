/// @file
/// A scene of a page: pictures, charts and figures of some contenders over time, moved together by one cursor.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pd::report {

/// What was measured of every contender at every time.
struct Quantity {
  std::string name;
  std::string unit;                         ///< "m", "J", "s" get prefixes; "" for counts
  std::vector<std::vector<double>> values;  ///< [contender][time], finite
};

struct SceneSection {
  /// A picture of all contenders, at `times[at]`.
  struct Frame {
    std::string file;  ///< relative to the page
    std::size_t at;
  };

  std::string name;  ///< of links within the page: letters, digits and dashes
  std::string title;
  std::string text;  ///< a sentence
  std::vector<std::string> contenders;
  std::vector<double> times;  ///< increasing
  std::string time_unit = "s";
  std::vector<Quantity> quantities;
  std::vector<Frame> frames;  ///< empty: the cursor goes from time to time, without pictures
  std::size_t shown = 0;      ///< frame (or time) that stands there first, and on paper
  std::string more;           ///< XHTML that follows, e.g. of `pair_figure`
};

/// The `section` element: well-formed XHTML. Lines are drawn here (SVG); without its script the page still shows them,
/// and the figures of one moment. Requires at least one time and one contender. Time O(sum of values).
[[nodiscard]] std::string scene_section(const SceneSection& scene);

}  // namespace pd::report
