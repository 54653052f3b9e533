/// @file
/// `pdepth demo difference [A B]`: one pair with its Minkowski difference; two meshes, or a pair of its own.
#include "difference.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "pd/render/video.hpp"
#include "protocol/pair_reader.hpp"
#include "scenes/shape_families.hpp"
#include "support/demo_output.hpp"
#include "support/demo_registry.hpp"

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
  return {query::load_mesh_shape(files[0], limits),
          query::load_mesh_shape(files[1], limits),
          Pose(),
          Pose(),
          files[0],
          files[1]};
}

/// The answer beside the picture, as `pdepth query` gives it.
std::string figures_of(const Bodies& bodies, const PenetrationDepth& answer, std::int64_t nanoseconds) {
  std::string text;
  query::JsonWriter writer(text);
  writer.begin_object();
  writer.key("a").string(bodies.name_a);
  writer.key("b").string(bodies.name_b);
  query::write_depth_answer(answer, bodies.a, bodies.b, nanoseconds, writer);
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

int answer_and_draw(const Bodies& bodies, const DemoOptions& options, const std::filesystem::path& folder) {
  const std::filesystem::path picture = folder / "difference.png";
  const std::filesystem::path figures = folder / "difference.json";
  const std::filesystem::path film = folder / "difference.mp4";
  Scratch scratch;
  const query::Stopwatch watch;
  const PenetrationDepth answer =
      penetration_depth({&bodies.a.shape, bodies.pose_a}, {&bodies.b.shape, bodies.pose_b}, scratch);
  if (!write_text(figures, figures_of(bodies, answer, watch.nanoseconds()))) {
    return report_failure({ErrorCode::bad_value, figures.string() + " cannot be written", ""});
  }
  const render::Size size{options.width, options.height};
  if (const int code = write_difference_picture(bodies.pair(), answer, picture, size); code != kDemoDone) return code;
  fmt::print("{} and {}: {}\n", bodies.name_a, bodies.name_b, to_string(answer.contact));
  fmt::print("depth     {} in [{}, {}]\n", answer.depth, answer.lower, answer.upper);
  fmt::print("distance  {} in [{}, {}]\n", answer.distance, answer.distance_lower, answer.distance_upper);
  fmt::print("picture   {}\nfigures   {}\n", picture.string(), figures.string());
  if (!options.video) return kDemoDone;
  constexpr int kFrames = 120;
  const int code = write_film(bodies, answer, size, options.steps > 0 ? options.steps : kFrames, film);
  if (code != kDemoFailed) fmt::print("film      {}\n", film.string());
  return code;
}

}  // namespace

int run_difference(const DemoOptions& options) {
  if (!options.inputs.empty() && options.inputs.size() != 2) {
    fmt::print(stderr, "pdepth: the demo difference takes two meshes, or none\n");
    return kDemoBadUsage;
  }
  try {
    const Bodies bodies = options.inputs.empty() ? own_pair() : read_pair(options.inputs);
    const auto folder = open_output_folder(options, "difference");
    if (!folder) {
      fmt::print(stderr, "pdepth: {}\n", folder.error().message);
      return kDemoBadUsage;
    }
    return answer_and_draw(bodies, options, *folder);
  } catch (const query::Refusal& refusal) {
    fmt::print(stderr, "pdepth: {}\n", refusal.message);
    return kDemoBadUsage;
  }
}

}  // namespace pd::demo
