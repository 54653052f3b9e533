/// @file
/// `pdepth demo dobkin`: the constructions of [D] as pictures.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "dobkin/dobkin_pictures.hpp"
#include "support/demo_output.hpp"
#include "support/demo_registry.hpp"

namespace pd::demo {

namespace {

struct Picture {
  std::string_view name;
  Expected<render::Image> (*draw)(render::Renderer& renderer, render::Size size);
};
constexpr std::array kPictures{
    Picture{"hierarchies", hierarchy_picture},
    Picture{"descent", descent_picture},
    Picture{"polygons", polygons_picture},
};

}  // namespace

int run_dobkin(const DemoOptions& options) {
  std::filesystem::path folder;
  if (const int code = open_output_folder(options, "dobkin", folder); code != kDemoDone) return code;
  auto created = render::Renderer::create();
  if (!created) return report_failure(created.error());
  render::Renderer renderer = std::move(created).value();
  note_interrupts();
  for (const Picture& picture : kPictures) {
    if (interrupted()) return kDemoInterrupted;
    const auto image = picture.draw(renderer, {options.width, options.height});
    if (!image) return report_failure(image.error());
    const auto written = render::write_png(*image, folder / fmt::format("{}.png", picture.name));
    if (!written) return report_failure(written.error());
    fmt::print("picture   {}\n", written->string());
  }
  return kDemoDone;
}

}  // namespace pd::demo
