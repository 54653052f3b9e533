/// @file
/// The steps of a recorded search: the expanding polytope inside P, its nearest face and the support beyond it.
#pragma once

#include "pd/numeric/expected.hpp"
#include "pd/render/renderer.hpp"
#include "protocol/search_file.hpp"

namespace pd::demo {

/// P and what every frame shares, made once.
class SearchPictures {
 public:
  /// P is left out where it is flat or has more than 100,000 facets.
  SearchPictures(const query::SearchFile& search, render::Size size);

  /// One step: P seen through, the polytope in it (blue), its nearest face (orange), the support of P in that face's
  /// normal (red, with the line to it from the face), and the origin (black).
  [[nodiscard]] Expected<render::Image> draw(std::size_t step, render::Renderer& renderer) const;
  /// "step 3, 10 faces: 0.12 to 0.34": the bounds of the depth that the supports so far show.
  [[nodiscard]] std::string heading(std::size_t step) const;

 private:
  const query::SearchFile& search_;
  render::Size size_;
  render::MeshRef difference_;
  render::Box box_;
};

/// At most six steps of `count`, first and last among them, denser at the start, where most happens.
[[nodiscard]] std::vector<std::size_t> steps_to_show(std::size_t count);

}  // namespace pd::demo
