#include "report/scene_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/html_text.hpp"

namespace pd::report {

namespace {

constexpr double kSceneLeft = 54;
constexpr double kSceneWidth = 336;
constexpr double kSceneTop = 10;
constexpr double kSceneHeight = 120;
constexpr int kSeriesColours = 4;

/// 1, 2 or 5 times a power of ten, at least `value`; 1 of nothing.
double round_number_above(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {1.0, 2.0, 5.0}) {
    if (digit * power >= value) return digit * power;
  }
  return 10 * power;
}

struct Axis {
  double low = 0;
  double high = 1;
};

Axis axis_of(const Quantity& quantity) {
  double low = 0;
  double high = 0;
  for (const auto& values : quantity.values) {
    for (const double value : values) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  return {low < 0 ? -round_number_above(-low) : 0, high > 0 || low == 0 ? round_number_above(high) : 0};
}

/// Where a time of the scene and a value stand.
struct Plot {
  const SceneSection& scene;
  Axis axis;
  [[nodiscard]] double x(double time) const {
    const double span = scene.times.back() - scene.times.front();
    return kSceneLeft + (span > 0 ? kSceneWidth * (time - scene.times.front()) / span : 0);
  }
  [[nodiscard]] double y(double value) const {
    return kSceneTop + kSceneHeight * (axis.high - value) / (axis.high - axis.low);
  }
};

std::size_t time_of_frame(const SceneSection& scene, std::size_t frame) {
  return scene.frames.empty() ? frame : scene.frames[frame].at;
}

std::size_t num_frames(const SceneSection& scene) {
  return scene.frames.empty() ? scene.times.size() : scene.frames.size();
}

/// A line for each contender. Where the steps lie closer than the pixels, the extremes of each pixel.
void draw_lines(const Quantity& quantity, const Plot& plot, std::string& text) {
  const auto out = std::back_inserter(text);
  for (std::size_t c = 0; c < quantity.values.size(); ++c) {
    const auto& values = quantity.values[c];
    fmt::format_to(out, "<path class=\"s{}\" d=\"", c % kSeriesColours);
    const std::size_t chunk = std::max<std::size_t>(1, values.size() / 400);
    for (std::size_t first = 0; first < values.size(); first += chunk) {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(first + chunk, values.size()));
      const auto [low, high] = std::minmax_element(begin, end);
      const char* verb = first == 0 ? "M" : "L";
      fmt::format_to(out, "{}{:.1f} {:.1f}", verb, plot.x(plot.scene.times[first]), plot.y(*low));
      if (high != low) fmt::format_to(out, "L{:.1f} {:.1f}", plot.x(plot.scene.times[first]), plot.y(*high));
    }
    text += "\"/>\n";
  }
}

std::string chart(const Quantity& quantity, const SceneSection& scene) {
  const Plot plot{scene, axis_of(quantity)};
  std::string text = fmt::format(
      "<figure><figcaption>{0}</figcaption>\n<svg class=\"chart\" viewBox=\"0 0 400 156\" role=\"img\" "
      "aria-label=\"{0} over time\" data-left=\"{1}\" data-width=\"{2}\">\n",
      escaped(quantity.name), kSceneLeft, kSceneWidth);
  const auto out = std::back_inserter(text);
  for (const double share : {0.0, 0.5, 1.0}) {
    const double value = plot.axis.low + share * (plot.axis.high - plot.axis.low);
    fmt::format_to(out,
                   "<line class=\"rule\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3}\" "
                   "y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
                   kSceneLeft, kSceneLeft + kSceneWidth, plot.y(value), kSceneLeft - 5, plot.y(value) + 4,
                   escaped(report::quantity(value, quantity.unit)));
  }
  for (const double share : {0.0, 0.5, 1.0}) {
    const double time = scene.times.front() + share * (scene.times.back() - scene.times.front());
    fmt::format_to(out, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", kSceneLeft + share * kSceneWidth,
                   kSceneTop + kSceneHeight + 17, share == 1 ? "end" : "middle",
                   escaped(report::quantity(time, scene.time_unit)));
  }
  draw_lines(quantity, plot, text);
  const double now = plot.x(scene.times[time_of_frame(scene, scene.shown)]);
  fmt::format_to(out, "<line class=\"cursor\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>\n</svg></figure>\n",
                 now, kSceneTop, kSceneTop + kSceneHeight);
  return text;
}

/// The figures at the cursor: quantities down, contenders across.
std::string figures(const SceneSection& scene) {
  std::string text = "<div class=\"scroll\" tabindex=\"0\"><table class=\"now\"><thead><tr><th>at the cursor</th>";
  for (std::size_t c = 0; c < scene.contenders.size(); ++c) {
    text += fmt::format("<th><span class=\"key k{}\"></span>{}</th>", c % kSeriesColours, escaped(scene.contenders[c]));
  }
  text += "</tr></thead>\n<tbody>\n";
  const std::size_t at = time_of_frame(scene, scene.shown);
  for (const Quantity& quantity : scene.quantities) {
    text += fmt::format("<tr><td>{}</td>", escaped(quantity.name));
    for (const auto& values : quantity.values) {
      text += fmt::format("<td class=\"value\">{}</td>", escaped(report::quantity(values[at], quantity.unit)));
    }
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

std::string json_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : escaped(text)) result += c == '\\' || c == '\n' || c == '\t' ? ' ' : c;
  return result + "\"";
}

/// What the script moves, at the frames alone.
std::string data_of(const SceneSection& scene) {
  std::vector<std::string> files;
  std::vector<std::string> contenders;
  std::vector<double> times;
  for (const SceneSection::Frame& frame : scene.frames) files.push_back(json_string(frame.file));
  for (const std::string& name : scene.contenders) contenders.push_back(json_string(name));
  for (std::size_t i = 0; i < num_frames(scene); ++i) times.push_back(scene.times[time_of_frame(scene, i)]);
  std::string text = fmt::format(
      "{{\"alt\":{},\"time_unit\":{},\"files\":[{}],\"contenders\":[{}],\"times\":[{:.6g}],\"quantities\":[",
      json_string(scene.title), json_string(scene.time_unit), fmt::join(files, ","), fmt::join(contenders, ","),
      fmt::join(times, ","));
  for (std::size_t q = 0; q < scene.quantities.size(); ++q) {
    const Quantity& quantity = scene.quantities[q];
    text += fmt::format("{}{{\"name\":{},\"unit\":{},\"values\":[", q > 0 ? "," : "", json_string(quantity.name),
                        json_string(quantity.unit));
    for (std::size_t c = 0; c < quantity.values.size(); ++c) {
      std::vector<double> at_frames;
      for (std::size_t i = 0; i < times.size(); ++i) at_frames.push_back(quantity.values[c][time_of_frame(scene, i)]);
      text += fmt::format("{}[{:.5g}]", c > 0 ? "," : "", fmt::join(at_frames, ","));
    }
    text += "]}";
  }
  return text + "]}";
}

}  // namespace

std::string scene_section(const SceneSection& scene) {
  std::string text =
      fmt::format("<section class=\"scene\" id=\"{0}\" aria-labelledby=\"{0}-title\">\n<h2 id=\"{0}-title\">{1}</h2>\n",
                  scene.name, escaped(scene.title));
  if (!scene.text.empty()) text += fmt::format("<p class=\"quiet\">{}</p>\n", escaped(scene.text));
  if (!scene.frames.empty()) {
    const SceneSection::Frame& frame = scene.frames[scene.shown];
    text += fmt::format("<div class=\"stage\"><img src=\"{}\" alt=\"{} at {}\"/></div>\n", escaped(frame.file),
                        escaped(scene.title), escaped(quantity(scene.times[frame.at], scene.time_unit)));
  }
  text += fmt::format(
      "<div class=\"controls\" hidden=\"hidden\"><button type=\"button\" aria-pressed=\"false\">Play</button>"
      "<input type=\"range\" min=\"0\" max=\"{}\" step=\"1\" value=\"{}\" aria-label=\"Time in {}\"/>"
      "<output>{}</output></div>\n",
      num_frames(scene) - 1, scene.shown, escaped(scene.title),
      escaped(quantity(scene.times[time_of_frame(scene, scene.shown)], scene.time_unit)));
  text += figures(scene) + "<div class=\"charts\">\n";
  for (const Quantity& quantity : scene.quantities) text += chart(quantity, scene);
  text += "</div>\n" + scene.more;
  return text + fmt::format("<script type=\"application/json\" class=\"scene-data\">{}</script>\n</section>\n",
                            script_json(data_of(scene)));
}

}  // namespace pd::report
