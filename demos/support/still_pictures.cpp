#include "support/still_pictures.hpp"

#include <fmt/format.h>

#include <utility>

#include "report/page.hpp"
#include "support/demo_output.hpp"
#include "support/printable.hpp"
#include "support/report_parts.hpp"

namespace pd::demo {

int draw_still_pictures(const DemoOptions& options, std::string_view demo, std::string_view title,
                        std::span<const StillPicture> pictures) {
  std::filesystem::path folder;
  if (const int code = open_output_folder(options, demo, folder); code != kDemoDone) return code;
  auto created = render::Renderer::create();
  if (!created) return report_failure(created.error());
  render::Renderer renderer = std::move(created).value();
  note_interrupts();
  if (options.page != nullptr) options.page->sections.push_back(fmt::format("<h2 id=\"{0}\">{1}</h2>\n", demo, title));
  for (const StillPicture& picture : pictures) {
    if (interrupted()) return kDemoInterrupted;
    const auto image = picture.draw(renderer, {options.width, options.height});
    if (!image) return report_failure(image.error());
    const auto written = render::write_png(*image, folder / fmt::format("{}.png", picture.name));
    if (!written) return report_failure(written.error());
    fmt::print("picture   {}\n", printable(written->string()));
    if (options.page != nullptr) {
      options.page->sections.push_back(
          report::picture(page_file(options, fmt::format("{}.png", picture.name)), std::string(picture.caption)));
    }
  }
  return kDemoDone;
}

}  // namespace pd::demo
