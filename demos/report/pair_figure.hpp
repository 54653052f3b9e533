/// @file
/// A pair as a figure of a page: both bodies and P = B + (-A), the exact answer and, where there is one, what an engine
/// reported; a drawing (SVG) at once, and turned in space (WebGL) when it is asked for.
///
/// The frame of the figure has the normal upright: A, which moves, leaves upwards.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "report/eye_polytope.hpp"

namespace pd::report {

struct PairFigure {
  /// A way from a point.
  struct Way {
    Vec3 from;
    Vec3 to;
  };

  std::string title;  ///< of the caption
  std::vector<EyePolytope> a;
  std::vector<EyePolytope> b;
  std::vector<EyePolytope> p;      ///< empty: not drawn
  Vec3 normal = Vec3::UnitZ();     ///< exact, unit; A leaves along it
  std::optional<Way> exact;        ///< from witness to witness; empty where the bodies only touch
  double depth = 0;                ///< exact, of overlapping bodies; 0 otherwise
  std::optional<Way> reported;     ///< what the engine said, as a way of A
  std::string exact_words;         ///< with the bracket
  std::string reported_words;      ///< empty: nobody reported
  std::string line;                ///< for `pdepth query`; empty where no query asks for such a pair
  std::string file_name = "pair";  ///< of the line, without its ending
};

/// The `figure` element: well-formed XHTML, with its data inline. Time O(polygons).
[[nodiscard]] std::string pair_figure(const PairFigure& pair);

}  // namespace pd::report
