/// @file
/// `pdepth demo difference [A B]`: one pair with its Minkowski difference; two meshes, or a pair of its own.
#include "difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "pd/render/composition.hpp"
#include "pd/render/video.hpp"
#include "protocol/pair_reader.hpp"
#include "report/page.hpp"
#include "scenes/shape_families.hpp"
#include "support/complain.hpp"
#include "support/demo_output.hpp"
#include "support/demo_registry.hpp"
#include "support/printable.hpp"
#include "support/report_parts.hpp"
#include "support/search_picture.hpp"

namespace pd::demo {

namespace {

/// Two bodies and their names, owned.
struct Bodies {
  query::NamedShape a;
  query::NamedShape b;
  Pose pose_a;
  Pose pose_b;
  std::string name_a;
  std::string name_b;

  [[nodiscard]] NamedPair pair() const { return {&a.shape, &b.shape, pose_a, pose_b, name_a, name_b}; }
};

/// A regular prism that has sunk, tilted, into a block: every kind of facet is there, few enough to be told apart.
Bodies own_pair() {
  const auto polytope = [](const scenes::Points& points) { return ConvexPolytope::from_points(points).value(); };
  const Pose pose_a = Pose::from_quaternion({0.8, 0.48, 0.36, 0.0}, {0.35, -0.25, 1.02}).value();
  return {{polytope(scenes::prism(12)), {}},
          {polytope(scenes::box({1.3, 0.9, 0.6})), {}},
          pose_a,
          Pose(),
          "a hexagonal prism",
          "a block"};
}

Bodies read_pair(const std::vector<std::string>& files) {
  const query::Limits limits;
  Bodies bodies = {query::load_mesh_shape(files[0], limits),
                   query::load_mesh_shape(files[1], limits),
                   Pose(),
                   Pose(),
                   files[0],
                   files[1]};
  for (const auto& [shape, file] : {std::pair{&bodies.a, &files[0]}, std::pair{&bodies.b, &files[1]}}) {
    if (shape->hull_note) fmt::print(stderr, "{}: {}\n", printable(*file), in_words(*shape->hull_note));
  }
  return bodies;
}

/// The answer beside the picture, as `pdepth query` gives it.
std::string figures_of(const Bodies& bodies, const PenetrationDepth& answer, std::int64_t nanoseconds) {
  std::string text;
  query::JsonWriter writer(text);
  writer.begin_object();
  writer.key("a").string(bodies.name_a);
  writer.key("b").string(bodies.name_b);
  query::write_depth_answer(answer, bodies.a, bodies.b, nanoseconds, writer);
  query::write_hull_note("a", bodies.a, writer);
  query::write_hull_note("b", bodies.b, writer);
  writer.end_object();
  return text + "\n";
}

/// A slow swing of the view to both sides, so that the shape of P reads.
int write_film(const Bodies& bodies, const PenetrationDepth& answer, render::Size size, int frames,
               const std::filesystem::path& file) {
  constexpr double kSwingDegrees = 24;
  auto renderer = render::Renderer::create();
  if (!renderer) return report_failure(renderer.error());
  render::Renderer drawing = std::move(renderer).value();
  auto opened = render::VideoWriter::open(file, size);
  if (!opened) return report_failure(opened.error());
  render::VideoWriter film = std::move(opened).value();
  note_interrupts();
  Progress progress("film", frames);
  for (int i = 0; i < frames && !interrupted(); ++i) {
    const double turn = kSwingDegrees * scenes::turn(static_cast<double>(i) / frames).sine;
    const auto frame = difference_picture(bodies.pair(), answer, drawing, size, turn);
    if (!frame) return report_failure(frame.error());
    if (const auto added = film.add(*frame); !added) return report_failure(added.error());
    progress.show(i + 1);
  }
  if (const auto closed = film.finish(); !closed) return report_failure(closed.error());
  return interrupted() ? kDemoInterrupted : kDemoDone;
}

void add_to_page(const Bodies& bodies, const PenetrationDepth& answer, const DemoOptions& options) {
  const std::string title = fmt::format("{} and {}", bodies.name_a, bodies.name_b);
  const auto figure =
      answered_pair({&bodies.a.shape, bodies.pose_a}, {&bodies.b.shape, bodies.pose_b}, answer, title, "difference");
  options.page->cards.push_back({fmt::format("{:.6g}", answer.depth), "depth of the pair below", {}});
  options.page->sections.push_back("<section id=\"difference\"><h2>A pair and its Minkowski difference</h2>\n" +
                                   report::picture(page_file(options, "difference.png"), title) +
                                   report::pairs({report::pair_figure(figure)}) + "</section>\n");
}

int answer_and_draw(const Bodies& bodies, const DemoOptions& options, const std::filesystem::path& folder) {
  const std::filesystem::path picture = folder / "difference.png";
  const std::filesystem::path figures = folder / "difference.json";
  const std::filesystem::path film = folder / "difference.mp4";
  Scratch scratch;
  const query::Stopwatch watch;
  const PenetrationDepth answer =
      penetration_depth({&bodies.a.shape, bodies.pose_a}, {&bodies.b.shape, bodies.pose_b}, scratch);
  if (!write_whole_file(figures, figures_of(bodies, answer, watch.nanoseconds()))) {
    return report_failure({ErrorCode::bad_value, figures.string() + " cannot be written", ""});
  }
  const render::Size size{options.width, options.height};
  if (const int code = write_difference_picture(bodies.pair(), answer, picture, size); code != kDemoDone) return code;
  fmt::print("{} and {}: {}\n", printable(bodies.name_a), printable(bodies.name_b), to_string(answer.contact));
  fmt::print("depth     {} in [{}, {}]\n", answer.depth, answer.lower, answer.upper);
  fmt::print("distance  {} in [{}, {}]\n", answer.distance, answer.distance_lower, answer.distance_upper);
  fmt::print("picture   {}\nfigures   {}\n", printable(picture.string()), printable(figures.string()));
  if (options.page != nullptr) add_to_page(bodies, answer, options);
  if (!options.video) return kDemoDone;
  constexpr int kFrames = 120;
  const int code = write_film(bodies, answer, size, options.steps > 0 ? options.steps : kFrames, film);
  if (code != kDemoFailed) fmt::print("film      {}\n", printable(film.string()));
  return code;
}

/// Every step of the search, a second each for few of them.
int write_search_film(const query::SearchFile& search, const SearchPictures& pictures, render::Renderer& renderer,
                      render::Size size, const std::filesystem::path& file) {
  auto opened = render::VideoWriter::open(file, size);
  if (!opened) return report_failure(opened.error());
  render::VideoWriter film = std::move(opened).value();
  note_interrupts();
  const int total = static_cast<int>(search.steps.size());
  const int repeats = std::clamp(600 / total, 2, 30);
  Progress progress("film", total);
  for (int i = 0; i < total && !interrupted(); ++i) {
    const auto step = static_cast<std::size_t>(i);
    auto drawn = pictures.draw(step, renderer);
    if (!drawn) return report_failure(drawn.error());
    const render::Panel panel[] = {{std::move(drawn).value(), pictures.heading(step)}};
    const render::Image frame = render::side_by_side(panel, "", "", size);
    for (int k = 0; k < repeats; ++k) {
      if (const auto added = film.add(frame); !added) return report_failure(added.error());
    }
    progress.show(i + 1);
  }
  if (const auto closed = film.finish(); !closed) return report_failure(closed.error());
  fmt::print("film      {}\n", printable(file.string()));
  return interrupted() ? kDemoInterrupted : kDemoDone;
}

/// The steps of a recorded search as a strip of frames.
int draw_search(const query::SearchFile& search, const DemoOptions& options, const std::filesystem::path& folder) {
  if (search.steps.empty()) {
    complain("{} holds no steps: no polytope was expanded for that pair", options.trace);
    return kDemoBadUsage;
  }
  auto created = render::Renderer::create();
  if (!created) return report_failure(created.error());
  render::Renderer renderer = std::move(created).value();
  // Three frames to a row: narrower than the film.
  const SearchPictures pictures(search, {std::min(options.width, options.height * 4 / 3), options.height});
  std::vector<render::Panel> frames;
  for (const std::size_t step : steps_to_show(search.steps.size())) {
    auto drawn = pictures.draw(step, renderer);
    if (!drawn) return report_failure(drawn.error());
    frames.push_back({std::move(drawn).value(), pictures.heading(step)});
  }
  const SearchEnd* const last = search.ends.empty() ? nullptr : &search.ends.back();
  const std::string title = last == nullptr
                                ? fmt::format("A search of {} steps", search.steps.size())
                                : fmt::format("A search of {} steps: {}", search.steps.size(), last->outcome);
  const std::filesystem::path picture = folder / "search_strip.png";
  if (const auto written = render::write_png(render::film_strip(frames, title), picture); !written) {
    return report_failure(written.error());
  }
  fmt::print("{} steps\n", search.steps.size());
  for (const SearchEnd& end : search.ends) {
    fmt::print("{:<10}{}: {} to {}\n", end.arithmetic, end.outcome, end.lower, end.upper);
  }
  fmt::print("picture   {}\n", printable(picture.string()));
  if (options.page != nullptr) {
    options.page->sections.push_back(report::picture(page_file(options, "search_strip.png"), title));
  }
  if (!options.video) return kDemoDone;
  const render::Size size{options.width, options.height};
  return write_search_film(search, SearchPictures(search, render::panel_size(size, 1)), renderer, size,
                           folder / "search.mp4");
}

}  // namespace

int run_difference(const DemoOptions& options) {
  if (!options.inputs.empty() && options.inputs.size() != 2) {
    complain("the demo difference takes two meshes, or none");
    return kDemoBadUsage;
  }
  if (!options.trace.empty() && !options.inputs.empty()) {
    complain("a trace names its bodies itself: give meshes or --trace, not both");
    return kDemoBadUsage;
  }
  try {
    std::optional<query::SearchFile> search;
    if (!options.trace.empty()) search.emplace(query::read_search_file(options.trace));
    std::filesystem::path folder;
    if (const int code = open_output_folder(options, "difference", folder); code != kDemoDone) return code;
    if (search) return draw_search(*search, options, folder);
    const Bodies bodies = options.inputs.empty() ? own_pair() : read_pair(options.inputs);
    return answer_and_draw(bodies, options, folder);
  } catch (const query::Refusal& refusal) {
    complain("{}", refusal.message);
    return kDemoBadUsage;
  }
}

}  // namespace pd::demo
