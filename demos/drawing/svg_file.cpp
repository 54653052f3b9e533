#include "drawing/svg_file.hpp"

#include <algorithm>
#include <cstring>
#include <numbers>
#include <optional>
#include <pugixml.hpp>

#include "drawing/svg_page.hpp"
#include "support/refusal.hpp"

namespace pd::drawing {

namespace {

using Words = std::initializer_list<std::string_view>;

bool is_one_of(std::string_view word, Words words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The name without its namespace.
std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos || name.starts_with("svg:")) return name.substr(colon + 1);
  return {};  // an editor's own element
}

std::string described(const pugi::xml_node& node) {
  std::string words = "<";
  words += node.name();
  if (const char* id = node.attribute("id").value(); *id != '\0') {
    words += " id=\"";
    words += id;
    words += '"';
  }
  return words + ">";
}

[[noreturn]] void unsupported(const pugi::xml_node& node, const std::string& message) {
  query::refuse("unsupported", described(node) + ": " + message, "");
}

/// An attribute, or the property of that name in the attribute `style`.
std::optional<std::string> property(const pugi::xml_node& node, const std::string& name) {
  const std::string_view style = node.attribute("style").value();
  for (std::size_t at = 0; at < style.size();) {
    const std::size_t end = std::min(style.find(';', at), style.size());
    const std::string_view part = style.substr(at, end - at);
    const std::size_t colon = part.find(':');
    const auto trimmed = [](std::string_view s) {
      const std::size_t first = s.find_first_not_of(" \t\r\n");
      if (first == std::string_view::npos) return std::string();
      return std::string(s.substr(first, s.find_last_not_of(" \t\r\n") - first + 1));
    };
    if (colon != std::string_view::npos && trimmed(part.substr(0, colon)) == name) {
      return trimmed(part.substr(colon + 1));
    }
    at = end + 1;
  }
  const pugi::xml_attribute attribute = node.attribute(name.c_str());
  if (!attribute) return std::nullopt;
  return std::string(attribute.value());
}

double length(const pugi::xml_node& node, const char* name, double otherwise) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return otherwise;
  return parse_user_length(attribute.value(), described(node) + " " + name);
}

PlaneCurve quarter(const Point2& from, const Point2& to, const Point2& radii) {
  return elliptical_arc(from, to, radii, 0, false, true);
}

SvgRing rectangle(const pugi::xml_node& node) {
  const double x = length(node, "x", 0), y = length(node, "y", 0);
  const double w = length(node, "width", 0), h = length(node, "height", 0);
  if (w <= 0 || h <= 0) query::refuse("bad_value", described(node) + ": width and height must be greater than 0", "");
  const bool has_x = !node.attribute("rx").empty(), has_y = !node.attribute("ry").empty();
  double rx = length(node, "rx", 0), ry = length(node, "ry", 0);
  if (!has_x) rx = ry;
  if (!has_y) ry = rx;
  rx = std::min(rx, 0.5 * w);
  ry = std::min(ry, 0.5 * h);
  SvgRing ring;
  const auto line = [&](const Point2& a, const Point2& b) {
    if (a != b) ring.push_back({.from = a, .to = b});
  };
  const auto corner = [&](const Point2& a, const Point2& b) {
    if (a != b) ring.push_back(quarter(a, b, {rx, ry}));
  };
  line({x + rx, y}, {x + w - rx, y});
  corner({x + w - rx, y}, {x + w, y + ry});
  line({x + w, y + ry}, {x + w, y + h - ry});
  corner({x + w, y + h - ry}, {x + w - rx, y + h});
  line({x + w - rx, y + h}, {x + rx, y + h});
  corner({x + rx, y + h}, {x, y + h - ry});
  line({x, y + h - ry}, {x, y + ry});
  corner({x, y + ry}, {x + rx, y});
  return ring;
}

SvgRing ellipse(const pugi::xml_node& node, double rx, double ry) {
  if (rx <= 0 || ry <= 0) query::refuse("bad_value", described(node) + ": a radius must be greater than 0", "");
  const double x = length(node, "cx", 0), y = length(node, "cy", 0);
  PlaneCurve round{.kind = PlaneCurve::Kind::arc, .from = {x + rx, y}, .to = {x + rx, y}};
  round.control = {Point2{rx, 0}, Point2{0, ry}};
  round.centre = {x, y};
  round.sweep = 2 * std::numbers::pi;
  return {round};
}

SvgRing points_ring(const pugi::xml_node& node) {
  SvgScanner scanner(node.attribute("points").value(), "points");
  std::vector<Point2> points;
  scanner.skip_blanks();
  while (!scanner.done()) {
    const double x = scanner.number();
    scanner.skip_separator();
    points.push_back({x, scanner.number()});
    scanner.skip_separator();
  }
  SvgRing ring;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ring.push_back({.from = points[i], .to = points[(i + 1) % points.size()]});
  }
  return ring;
}

std::vector<SvgRing> rings_of(const pugi::xml_node& node) {
  const std::string_view name = local_name(node);
  if (name == "path") {
    try {
      return parse_path(node.attribute("d").value());
    } catch (const query::Refusal& refusal) {
      query::refuse(refusal.code, described(node) + ": " + refusal.message, "");
    }
  }
  if (name == "rect") return {rectangle(node)};
  if (name == "circle") {
    const double r = length(node, "r", 0);
    return {ellipse(node, r, r)};
  }
  if (name == "ellipse") return {ellipse(node, length(node, "rx", 0), length(node, "ry", 0))};
  return {points_ring(node)};
}

struct Found {
  pugi::xml_node node;
  PlaneMap map;
  bool even_odd;
};

struct Outlines {
  std::string id;  ///< of the element that is asked for; empty: the drawing holds one
  std::vector<Found> found;
};

/// What a walk down the tree inherits.
struct Inherited {
  PlaneMap map;
  bool even_odd = false;
  int depth = 0;  ///< groups around
};

/// Editors nest layers and groups some ten deep; the walk takes stack for each.
constexpr int kMaxGroups = 200;

void refuse_unknown_effects(const pugi::xml_node& node) {
  for (const char* name : {"clip-path", "mask"}) {
    const auto value = property(node, name);
    if (value && *value != "none") unsupported(node, std::string(name) + " cuts the outline; apply it in the editor");
  }
  const std::string_view style = node.attribute("style").value();
  if (style.find("transform") != std::string_view::npos) {
    unsupported(node, "a transform in a style; write it as the attribute transform");
  }
}

void collect(const pugi::xml_node& parent, const Inherited& inherited, Outlines& outlines);

void visit(const pugi::xml_node& node, const Inherited& inherited, Outlines& outlines) {
  const std::string_view name = local_name(node);
  if (name.empty() || is_one_of(name, {"defs", "metadata", "title", "desc", "symbol", "clipPath", "mask", "marker",
                                       "pattern", "linearGradient", "radialGradient", "filter", "script", "view"})) {
    return;
  }
  if (name == "style") {
    const std::string_view sheet = node.text().get();
    for (const std::string_view word : {"transform", "display", "fill-rule", "clip-path", "mask"}) {
      if (sheet.find(word) != std::string_view::npos) {
        unsupported(node, "a style sheet with \"" + std::string(word) + "\"; write it as attributes of the elements");
      }
    }
    return;
  }
  const auto display = property(node, "display");
  if (display && *display == "none") return;
  if (is_one_of(name, {"use", "text", "image", "svg", "foreignObject", "switch", "line", "animate"})) {
    unsupported(node, name == "use"    ? "a copy by reference; replace it by its path (Unlink Clone)"
                      : name == "text" ? "letters; turn them into a path (Object to Path)"
                      : name == "line" ? "a line bounds no area"
                                       : "only path, rect, circle, ellipse, polygon and polyline have an outline here");
  }
  refuse_unknown_effects(node);
  Inherited own = inherited;
  if (++own.depth > kMaxGroups) {
    query::refuse("limit_exceeded", "groups nest deeper than " + std::to_string(kMaxGroups) + " levels", "");
  }
  if (const pugi::xml_attribute transform = node.attribute("transform")) {
    try {
      own.map = inherited.map.after(parse_transform(transform.value()));
    } catch (const query::Refusal& refusal) {
      query::refuse(refusal.code, described(node) + ": " + refusal.message, "");
    }
  }
  if (const auto rule = property(node, "fill-rule"); rule && *rule != "inherit") own.even_odd = *rule == "evenodd";
  if (name == "g" || name == "a") {
    collect(node, own, outlines);
  } else if (is_one_of(name, {"path", "rect", "circle", "ellipse", "polygon", "polyline"})) {
    outlines.found.push_back({node, own.map, own.even_odd});
  } else {
    unsupported(node, "an element that is not understood");
  }
}

/// Elements beside the one that is asked for may be unreadable. A style sheet rules the whole drawing, so that it may
/// not.
bool matters(const pugi::xml_node& node, const std::string& id) {
  const auto rules = [&](const pugi::xml_node& inner) {
    return id == inner.attribute("id").value() || local_name(inner) == "style";
  };
  return id.empty() || rules(node) || node.find_node(rules);
}

void collect(const pugi::xml_node& parent, const Inherited& inherited, Outlines& outlines) {
  for (const pugi::xml_node& node : parent.children()) {
    if (node.type() != pugi::node_element) continue;
    try {
      visit(node, inherited, outlines);
    } catch (const query::Refusal&) {
      if (matters(node, outlines.id)) throw;
    }
  }
}

const Found& chosen(const std::vector<Found>& found, const std::string& id) {
  std::string known;
  for (const Found& f : found) {
    if (!id.empty() && id == f.node.attribute("id").value()) return f;
    known += (known.empty() ? "" : ", ") + described(f.node);
  }
  if (found.empty()) {
    query::refuse("bad_value", "the drawing holds no path, rect, circle, ellipse, polygon or polyline", "");
  }
  if (!id.empty()) query::refuse("bad_value", "no outline has the id \"" + id + "\"; there are " + known, "");
  if (found.size() > 1) {
    constexpr std::size_t kShown = 300;
    if (known.size() > kShown) known = known.substr(0, kShown) + ", ...";
    query::refuse("bad_value",
                  std::to_string(found.size()) + " elements have an outline (" + known +
                      "); name one, FILE.svg#ID, or combine them into one path",
                  "");
  }
  return found.front();
}

}  // namespace

SvgOutline read_svg(std::string_view text, const std::string& id) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) {
    query::refuse("unreadable_file",
                  "no XML at byte " + std::to_string(parsed.offset) + ": " + std::string(parsed.description()), "");
  }
  const pugi::xml_node root = document.document_element();
  if (local_name(root) != "svg") {
    query::refuse("unreadable_file", "the root element is <" + std::string(root.name()) + ">; an SVG file has <svg>",
                  "");
  }
  refuse_unknown_effects(root);
  const SvgPage page = read_page(root);
  Inherited inherited{page.map, false};
  if (const auto rule = property(root, "fill-rule")) inherited.even_odd = *rule == "evenodd";
  if (const pugi::xml_attribute transform = root.attribute("transform")) {
    inherited.map = page.map.after(parse_transform(transform.value()));
  }
  Outlines outlines{id, {}};
  collect(root, inherited, outlines);
  const Found& one = chosen(outlines.found, id);
  SvgOutline outline{rings_of(one.node), page.unit, one.even_odd, described(one.node)};
  if (outline.rings.empty()) query::refuse("bad_value", outline.element + " bounds no area", "");
  for (SvgRing& ring : outline.rings) {
    for (PlaneCurve& curve : ring) curve = curve.mapped(one.map);
  }
  return outline;
}

}  // namespace pd::drawing
