/// @file
/// Polygons out of files: path data against points worked out by hand, transforms, units, holes, named refusals.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "drawing/polygon_file.hpp"
#include "drawing/svg_file.hpp"
#include "support/refusal.hpp"

namespace pd::drawing {
namespace {

std::string svg(const std::string& body, const std::string& attributes = "") {
  return "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" " + attributes + ">" + body + "</svg>\n";
}

/// The ends of the pieces of the only ring, its first point first.
std::vector<Point2> ends(const std::string& path) {
  const std::vector<SvgRing> rings = parse_path(path);
  EXPECT_EQ(rings.size(), 1u) << path;
  std::vector<Point2> points;
  for (const PlaneCurve& c : rings.at(0)) points.push_back(c.from);
  return points;
}

TEST(SvgPath, RelativeAndAbsoluteFormsAreTheSame) {
  const std::vector<Point2> square = {{1, 2}, {4, 2}, {4, 6}, {1, 6}};
  for (const char* path : {"M1 2L4 2L4 6L1 6Z", "m1 2l3 0l0 4l-3 0z", "M1,2 4,2 4,6 1,6z", "m1,2 3,0 0,4-3,0z",
                           "M1 2H4V6H1V2", "m1 2h3v4h-3v-4z", " M 1e0 +2 h.3e1 v4.0 H1 Z "}) {
    std::vector<Point2> found = ends(path);
    found.resize(4);
    EXPECT_EQ(found, square) << path;
  }
  EXPECT_EQ(ends("M0 0l1.5.5.5-1z"), (std::vector<Point2>{{0, 0}, {1.5, 0.5}, {2, -0.5}}));
}

TEST(SvgPath, TwoSubpathsTheSecondFromWhereTheFirstBegan) {
  const auto rings = parse_path("m1 1 h2 v2 z m10 0 h2 v2 z M5 5 z");
  ASSERT_EQ(rings.size(), 2u);  // a point is none
  EXPECT_EQ(rings[1][0].from, (Point2{11, 1}));
  const auto after_close = parse_path("M1 1h2v2z l5 0 0 5z");
  ASSERT_EQ(after_close.size(), 2u);
  EXPECT_EQ(after_close[1][0].from, (Point2{1, 1}));
}

TEST(SvgPath, SmoothCurvesReflectTheLastControlPoint) {
  const SvgRing cubic = parse_path("M0 0C1 2 3 2 4 0S7-2 8 0").at(0);
  EXPECT_EQ(cubic[1].control[0], (Point2{5, -2}));
  const SvgRing quadratic = parse_path("M0 0q1 2 2 0t2 0 2 0").at(0);
  EXPECT_EQ(quadratic[1].control[0], (Point2{3, -2}));
  EXPECT_EQ(quadratic[2].control[0], (Point2{5, 2}));
  // After another family there is nothing to reflect.
  EXPECT_EQ(parse_path("M0 0Q1 2 2 0S3 2 4 0").at(0)[1].control[0], (Point2{2, 0}));
}

TEST(SvgPath, ArcsLieOnTheirEllipse) {
  for (const char* flags : {"0 0", "0 1", "1 0", "1 1", "00", "11"}) {
    const PlaneCurve arc = parse_path("M3 1A5 3 30 " + std::string(flags) + " 6-1z").at(0).at(0);
    ASSERT_EQ(arc.kind, PlaneCurve::Kind::arc);
    const bool large = flags[0] == '1', sweep = std::string(flags).back() == '1';
    EXPECT_EQ(std::abs(arc.sweep) > M_PI, large) << flags;
    EXPECT_EQ(arc.sweep > 0, sweep) << flags;
    std::vector<Point2> points;
    ASSERT_TRUE(append_flattened(arc, 1e-4, 100000, points));
    const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
    for (const Point2& p : points) {
      const double x = p[0] - arc.centre[0], y = p[1] - arc.centre[1];
      EXPECT_NEAR(std::pow((c * x + s * y) / 5, 2) + std::pow((-s * x + c * y) / 3, 2), 1, 1e-12);
    }
    EXPECT_EQ(points.back(), (Point2{6, -1}));
  }
  EXPECT_EQ(parse_path("M0 0A0 3 0 0 1 4 0z").at(0).at(0).kind, PlaneCurve::Kind::line);
  // Radii that do not reach are scaled up: half a turn about the middle.
  const PlaneCurve wide = parse_path("M0 0A1 1 0 0 1 4 0L2 5z").at(0).at(0);
  EXPECT_NEAR(wide.centre[0], 2, 1e-15);
  EXPECT_NEAR(std::hypot(wide.control[0][0], wide.control[0][1]), 2, 1e-15);
}

/// Largest distance of points of the curve from the polyline, by dense sampling of a finer polyline.
double farthest(const PlaneCurve& curve, const std::vector<Point2>& coarse) {
  std::vector<Point2> fine = {curve.from};
  EXPECT_TRUE(append_flattened(curve, 1e-9, 1'000'000, fine));
  double most = 0;
  for (std::size_t i = 0; i < fine.size(); i += 7) {
    double least = 1e300;
    for (std::size_t k = 0; k + 1 < coarse.size(); ++k) {
      const Point2 &a = coarse[k], &b = coarse[k + 1];
      const double dx = b[0] - a[0], dy = b[1] - a[1], px = fine[i][0] - a[0], py = fine[i][1] - a[1];
      const double t = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
      least = std::min(least, std::hypot(px - t * dx, py - t * dy));
    }
    most = std::max(most, least);
  }
  return most;
}

TEST(SvgPath, FlatnessIsKeptAndNotWasted) {
  for (const char* path : {"M0 0C10 30 20-30 30 0z", "M0 0Q10 30 30 0z", "M3 1A25 3 30 1 1 6-1z"}) {
    const PlaneCurve curve =
        parse_path(path).at(0).at(0).mapped(PlaneMap{2, 0.5, -1, 1, 3, 4});  // sheared: no circle stays one
    for (const double flatness : {1.0, 0.1, 0.01}) {
      std::vector<Point2> points = {curve.from};
      ASSERT_TRUE(append_flattened(curve, flatness, 100000, points));
      const double found = farthest(curve, points);
      EXPECT_LE(found, flatness) << path;
      EXPECT_GE(found, 0.05 * flatness) << path;
    }
    std::vector<Point2> points;
    EXPECT_FALSE(append_flattened(curve, 1e-9, 50, points));
    EXPECT_TRUE(points.empty());
  }
}

TEST(SvgFile, TransformsAreAppliedFromTheInside) {
  const SvgOutline o = read_svg(svg("<g transform=\"translate(10,20) scale(2)\"><path transform=\"rotate(90)\" "
                                    "d=\"M1 0L2 0L2 3z\"/></g>"),
                                "");
  EXPECT_EQ(o.rings.at(0)[0].from, (Point2{10, 22}));
  EXPECT_EQ(o.rings.at(0)[1].to, (Point2{4, 24}));
  const SvgOutline about = read_svg(svg("<rect width='2' height='4' transform='rotate(180 1 2)'/>"), "");
  EXPECT_EQ(about.rings.at(0)[0].from, (Point2{2, 4}));
  const SvgOutline skewed =
      read_svg(svg("<polygon points='0,0 0,1 1,1' transform='skewX(45)matrix(1 0 0 1 5 6)'/>"), "");
  EXPECT_NEAR(skewed.rings.at(0)[0].from[0], 11, 1e-14);
}

TEST(SvgFile, UnitsComeFromThePage) {
  const std::string square = "<rect x='10' y='10' width='20' height='20'/>";
  const auto corner = [&](const std::string& attributes) {
    const SvgOutline o = read_svg(svg(square, attributes), "");
    return std::tuple(o.unit, o.rings.at(0)[0].from[0], o.rings.at(0)[0].from[1]);
  };
  EXPECT_EQ(corner(""), std::tuple("", 10.0, 10.0));
  EXPECT_EQ(corner("viewBox='0 0 5 5' width='100%'"), std::tuple("", 10.0, 10.0));
  EXPECT_EQ(corner("width='210mm' height='297mm' viewBox='0 0 210 297'"), std::tuple("mm", 10.0, 10.0));
  EXPECT_EQ(corner("width='4in' viewBox='10 0 40 40'"), std::tuple("in", 0.0, 1.0));
  EXPECT_EQ(corner("width='200' height='100' viewBox='0 0 100 100'"), std::tuple("px", 60.0, 10.0));  // xMid
  EXPECT_EQ(corner("width='200' height='100' viewBox='0 0 100 100' preserveAspectRatio='none'"),
            std::tuple("px", 20.0, 10.0));
  EXPECT_EQ(corner("width='200' height='100' viewBox='0 0 100 100' preserveAspectRatio='xMaxYMin slice'"),
            std::tuple("px", 20.0, 20.0));
  EXPECT_NEAR(std::get<1>(corner("width='10cm' height='10cm'")), 10 * 2.54 / 96, 1e-15);
}

TEST(SvgFile, ShapesHaveTheirArea) {
  const auto area = [&](const std::string& body) {
    const SvgOutline o = read_svg(svg(body), "");
    double sum = 0;
    std::vector<Point2> points;
    for (const PlaneCurve& c : o.rings.at(0)) EXPECT_TRUE(append_flattened(c, 1e-6, 100000, points));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point2 &a = points[i], &b = points[(i + 1) % points.size()];
      sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    }
    return sum;
  };
  EXPECT_NEAR(area("<circle cx='1' cy='2' r='3'/>"), 9 * M_PI, 1e-4);
  EXPECT_NEAR(area("<ellipse rx='3' ry='2' cx='1in'/>"), 6 * M_PI, 1e-4);
  EXPECT_NEAR(area("<rect width='10' height='8' rx='2'/>"), 80 - 16 + 4 * M_PI, 1e-4);
  EXPECT_EQ(area("<rect width='10' height='8' x='3'/>"), 80);
  EXPECT_EQ(area("<polyline points='0 0 4 0 4 3'/>"), 6);
}

class Files : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("pd_drawing_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  PolygonFile read(const std::string& path, std::optional<double> flatness = {}, const std::string& unit = "") {
    return read_polygon_file(path, flatness, unit, {});
  }
  /// The refusal of a file, "code|message|where".
  std::string refusal(const std::string& path, const std::string& unit = "") {
    try {
      (void)read(path, {}, unit);
    } catch (const query::Refusal& r) {
      return r.code + "|" + r.message + "|" + r.where;
    }
    return "none";
  }
  std::filesystem::path folder_;
};

TEST_F(Files, HolesByTheFillRule) {
  const std::string turned = "M0 0H10V10H0z M3 3V7H7V3z", same = "M0 0H10V10H0z M3 3H7V7H3z";
  EXPECT_EQ(read(write("a.svg", svg("<path d='" + turned + "'/>"))).polygon.num_rings(), 2);
  EXPECT_EQ(read(write("a.svg", svg("<path fill-rule='evenodd' d='" + same + "'/>"))).polygon.num_rings(), 2);
  EXPECT_EQ(read(write("a.svg", svg("<g style='fill:red;fill-rule: evenodd'><path d='" + same + "'/></g>")))
                .polygon.num_rings(),
            2);
  EXPECT_NE(refusal(write("a.svg", svg("<path d='" + same + "'/>"))).find("subpath 2 runs the same way round"),
            std::string::npos);
}

TEST_F(Files, OneOfSeveralByItsId) {
  const std::string body =
      "<rect id='a' width='1' height='1'/><g><circle id='b' r='2'/></g><defs><rect id='c'/></defs>";
  const std::string file = write("many.svg", svg(body));
  EXPECT_NE(refusal(file).find("2 elements have an outline (<rect id=\"a\">, <circle id=\"b\">); name one"),
            std::string::npos)
      << refusal(file);
  EXPECT_EQ(read(file + "#a").polygon.num_vertices(), 4);
  EXPECT_EQ(read(file + "#a").flatness, 0);
  EXPECT_EQ(read(file + "#b", 0.01).flatness, 0.01);
  EXPECT_NE(refusal(file + "#x").find("no outline has the id \"x\""), std::string::npos);
}

TEST_F(Files, WhatLiesBesideTheElementDoesNotMatter) {
  const std::string body =
      "<text id='t'>label</text><g transform='turn(3)'><rect id='far' width='1' height='1'/></g>"
      "<g><use href='#r'/><rect id='r' width='1' height='1'/></g>";
  const std::string file = write("LABELS.SVG", svg(body));
  EXPECT_EQ(read(file + "#r").polygon.num_vertices(), 4);
  EXPECT_NE(refusal(file).find("letters"), std::string::npos) << refusal(file);
  EXPECT_NE(refusal(file + "#t").find("letters"), std::string::npos) << refusal(file + "#t");
  EXPECT_NE(refusal(file + "#far").find("unknown function \"turn\""), std::string::npos) << refusal(file + "#far");
  EXPECT_NE(refusal(file + "#x").find("no outline has the id \"x\"; there are <rect id=\"r\">"), std::string::npos)
      << refusal(file + "#x");
  const std::string sheet = write("sheet.svg", svg(body + "<g><style>rect{transform:scale(2)}</style></g>"));
  EXPECT_NE(refusal(sheet + "#r").find("style sheet"), std::string::npos) << refusal(sheet + "#r");
}

TEST_F(Files, UnitsAreTurnedIntoEachOther) {
  const std::string inches = write("in.svg", svg("<rect width='1' height='1'/>", "width='8in' viewBox='0 0 8 8'"));
  EXPECT_NEAR(read(inches, {}, "mm").polygon.point(2)[0], 25.4, 1e-13);
  EXPECT_EQ(read(inches, {}, "mm").unit, "mm");
  const std::string none = write("none.svg", svg("<rect width='1' height='1'/>"));
  EXPECT_NE(refusal(none, "mm").find("no unit"), std::string::npos);
}

TEST_F(Files, JsonIsTheProtocolsPolygon) {
  const std::string file =
      write("p.json", "{\"outer\":[[0,0],[4,0],[4,4],[0,4]],\n \"holes\":[[[1,1],[2,1],[2,2]]]}\n");
  EXPECT_EQ(read(file).polygon.num_rings(), 2);
  EXPECT_FALSE(read(file).drawing);
}

TEST_F(Files, RefusalsNameWhatIsWrongAndWhere) {
  const auto expect = [&](const std::string& name, const std::string& text, const std::string& code,
                          const std::string& words) {
    const std::string found = refusal(write(name, text));
    EXPECT_TRUE(found.starts_with(code + "|")) << found;
    EXPECT_NE(found.find(words), std::string::npos) << words << " in " << found;
  };
  const std::string crossing = ": outer[0], the edge from (0.0, 0.0) to (4.0, 4.0): the edges";
  expect("x.json", "{\"outer\":[[0,0],[4,4],[4,0],[0,4]]}", "bad_value", crossing);
  expect("x.svg", svg("<path id='bow' d='M0 0L4 4L4 0L0 4z'/>"), "bad_value", crossing);
  expect("x.svg", svg("<path id='bow' d='M0 0L4 4L4 0L0 4z'/>"), "bad_value", "<path id=\"bow\">: outer[0]");
  expect("x.svg", svg("<path fill-rule='evenodd' d='M0 0H9V9H0zM8 1H20V5H8z'/>"), "bad_value", "cross");
  // Clockwise: edges are named as the caller's ring runs.
  expect("x.json", "{\"outer\":[[0,4],[4,0],[5,9],[4,4],[0,0]]}", "bad_value",
         ": outer[3], the edge from (4.0, 4.0) to (0.0, 0.0): ");
  expect("x.json", "{\"outer\":[[0,0],[1,1]]}", "too_few_points", "outer");
  expect("x.json", "{\"outer\":[[0,0],[1,\"nan\"],[2,0]]}", "non_finite", "outer[1]");
  expect("x.json", "[1,2]", "bad_json", "JSON object");
  expect("x.json", "{\"outer\":[[0,0],[4,0],[0,4]],\"colour\":1}", "bad_value", "colour");
  expect("x.svg", svg("<path d='M0 0L4 x'/>"), "bad_value", "path data, character 8: a number is missing");
  expect("x.svg", svg("<path d='L4 4'/>"), "bad_value", "a path begins with M");
  expect("x.svg", svg("<path d='M0 0A1 1 0 2 0 3 3'/>"), "bad_value", "flag");
  expect("x.svg", svg("<path d='M0 0L1e400 0 1 1z'/>"), "bad_value", "range of doubles");
  expect("x.svg", svg("<path d='M0 0B1 1'/>"), "bad_value", "a command is expected");
  expect("x.svg", svg("<path transform='turn(3)' d='M0 0H1V1z'/>"), "bad_value", "unknown function \"turn\"");
  expect("x.svg", svg("<path transform='rotate(1,2)' d='M0 0H1V1z'/>"), "bad_value", "rotate takes 1 or 3 numbers");
  expect("x.svg", svg("<rect width='3em' height='1'/>"), "unsupported", "unit \"em\"");
  expect("x.svg", svg("<rect width='1' height='1'/>", "width='50%'"), "unsupported", "percentage");
  expect("x.svg", svg("<rect width='1' height='1'/>", "viewBox='0 0 0 4' width='1mm'"), "bad_value", "viewBox");
  expect("x.svg", svg("<use href='#a'/>"), "unsupported", "a copy by reference");
  expect("x.svg", svg("<text>a</text>"), "unsupported", "Object to Path");
  expect("x.svg", svg("<svg><rect width='1' height='1'/></svg>"), "unsupported", "<svg>");
  expect("x.svg", svg("<rect width='1' height='1' clip-path='url(#c)'/>"), "unsupported", "clip-path");
  expect("x.svg", svg("<style>path{transform:scale(2)}</style><path d='M0 0H1V1z'/>"), "unsupported", "style sheet");
  expect("x.svg", svg("<path style='transform:scale(2)' d='M0 0H1V1z'/>"), "unsupported", "a transform in a style");
  expect("x.svg", svg("<g display='none'><path d='M0 0H1V1z'/></g>"), "bad_value", "holds no path");
  expect("x.svg", "<html/>", "unreadable_file", "<html>");
  expect("x.svg", "<svg><path", "unreadable_file", "no XML at byte");
  expect("x.txt", "", "unreadable_file", ".svg or .json");
  EXPECT_NE(refusal((folder_ / "nowhere.svg").string()).find("no such file"), std::string::npos);
}

}  // namespace
}  // namespace pd::drawing
