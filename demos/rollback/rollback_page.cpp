#include <fmt/format.h>

#include "pd/depth/scratch.hpp"
#include "report/html_text.hpp"
#include "report/page.hpp"
#include "report/scene_section.hpp"
#include "rollback/rollback_course.hpp"
#include "support/demo_output.hpp"
#include "support/report_parts.hpp"

namespace pd::demo {

namespace {

std::string impact_table(const Impact& impact) {
  std::vector<std::vector<std::string>> rows{{"method", "first contact", "by then"}};
  for (const Verdict& verdict : impact.verdicts) {
    rows.push_back({report::escaped(verdict.method), verdict.hit ? time_text(verdict.time) : std::string("missed"),
                    verdict.depth > 0 ? length_text(verdict.depth) + " deep" : length_text(-verdict.depth) + " apart"});
  }
  return report::table(rows);
}

}  // namespace

std::string plain_end_figure(const Impact& impact, std::size_t number) {
  Scratch scratch;
  const PosedShape a{impact.moving_a.start.shape, pose_at(impact.moving_a, impact.step)};
  const PosedShape b{impact.moving_b.start.shape, pose_at(impact.moving_b, impact.step)};
  return report::pair_figure(answered_pair(a, b, penetration_depth(a, b, scratch),
                                           fmt::format("Impact {}: where the plain step ends", number),
                                           fmt::format("impact_{}_plain", number)));
}

void add_to_page(const Course& course, const CourseRows& rows, const std::vector<std::string>& figures,
                 const std::string& title, const DemoOptions& options) {
  using Rank = report::Card::Rank;
  report::Page& page = *options.page;
  page.cards.push_back({length_text(course.deepest_plain), "throws: deepest, plain steps", Rank::bad});
  page.cards.push_back({length_text(course.deepest_rollback), "throws: deepest, rollback", Rank::good});
  report::SceneSection section;
  section.name = "rollback";
  section.title = title;
  section.text = "Plain steps beside steps that are taken back to the first contact and advanced to it.";
  section.contenders = {"plain steps", "taken back to first contact"};
  section.times = rows.times;
  section.quantities = {{"penetration at the end of the step", "m", {rows.plain_depths, rows.rollback_depths}},
                        {"kinetic energy", "J", {rows.plain_energies, rows.rollback_energies}}};
  for (std::size_t i = 0; i < rows.times.size(); ++i) {
    section.frames.push_back({page_file(options, fmt::format("frames/rollback_{:04d}.png", i)), i});
  }
  section.shown = section.frames.size() / 2;
  section.more = report::picture(page_file(options, "rollback_strip.png"), title + ": telling moments");
  for (std::size_t k = 0; k < course.impacts.size(); ++k) {
    section.more += fmt::format("<h3>Impact {}</h3>\n", k + 1);
    section.more += report::picture(page_file(options, fmt::format("impact_{}.png", k + 1)),
                                    fmt::format("Impact {}: before, at and after first contact", k + 1));
    section.more += impact_table(course.impacts[k]);
  }
  section.more += report::pairs(figures);
  page.sections.push_back(report::scene_section(section));
}

}  // namespace pd::demo
