/// @file
/// Opens the page to play with in headless Chromium, from a file. The page shows the answers of the command for every
/// body of its list, after drags, keys, dropped files and pasted lines. It survives wrong input and fits a phone.
/// packaging/wasm.sh makes the page.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "pages/browser.hpp"

namespace pd::test {
namespace {

namespace fs = std::filesystem;

class PlayPage : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (Browser::program().empty() || !fs::exists(kPage)) return;
    std::string name = (fs::temp_directory_path() / "pdepth_play_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    browser_ = std::make_unique<Browser>(folder_ / "profile");
  }
  static void TearDownTestSuite() {
    browser_.reset();
    std::error_code error;
    if (!folder_.empty()) fs::remove_all(folder_, error);
  }
  void SetUp() override {
    if (Browser::program().empty())
      GTEST_SKIP() << "Chromium is not installed (Debian: chromium), so no page is opened";
    if (!fs::exists(kPage)) GTEST_SKIP() << "packaging/wasm.sh was not run, so there is no page to play with";
  }

  static Browser& open(int width = 1280, const std::string& scheme = "light") {
    browser_->look(width, 900, scheme);
    browser_->open("/nowhere");  // another address, so that the same file is loaded anew
    browser_->open(kPage);
    settled();
    return *browser_;
  }
  /// Waits until the answer to the last change is shown.
  static void settled(const std::string& picture = "space") {
    browser_->evaluate("(async () => { const c = document.getElementById('" + picture +
                       "');"
                       "const two = () => new Promise(go => requestAnimationFrame(() => requestAnimationFrame(go)));"
                       "for (let i = 0; i < 2000 && !c.dataset.frames; ++i) await two(); await two(); })()");
  }
  static nlohmann::json of(const std::string& expression) { return browser_->evaluate(expression); }
  static std::string text(const std::string& id) { return of("document.getElementById('" + id + "').textContent"); }
  static void click(const std::string& id) { of("document.getElementById('" + id + "').click()"); }
  static bool is_refused() { return !of("document.getElementById('refusal').hidden").get<bool>(); }

  /// Runs a line that the page shows, as a visitor would.
  static nlohmann::json native(const std::string& shown) {
    std::string line = of("document.getElementById('" + shown + "').value");
    line.replace(line.rfind("pdepth query"), 6, std::string("'") + PDEPTH_PROGRAM + "'");
    line = "cd '" + folder_.string() + "' && " + line;  // where the dropped files lie
    std::FILE* const pipe = ::popen(line.c_str(), "r");
    std::string answer;
    std::array<char, 4096> bytes{};
    while (std::fgets(bytes.data(), bytes.size(), pipe) != nullptr) answer += bytes.data();
    ::pclose(pipe);
    return nlohmann::json::parse(answer);
  }
  /// The depth (or distance) that is shown has the bits of the command's.
  /// @param tab  what the names of the tab's elements end in
  static void expect_native(const std::string& what, const std::string& tab = "") {
    settled(tab.empty() ? "space" : "plane");
    const nlohmann::json found = native("line" + tab);
    const std::string depth = "document.getElementById('depth" + tab + "').dataset.";
    ASSERT_TRUE(found.contains("class")) << what << ": " << found;
    const std::string contact = of(depth + "contact");
    EXPECT_EQ(contact, found.at("class")) << what;
    const auto shown = nlohmann::json::parse(of(depth + "value").get<std::string>());
    EXPECT_EQ(shown.get<double>(), found.at(contact == "separated" ? "distance" : "depth").get<double>()) << what;
  }
  static void expect_quiet() {
    for (const std::string& complaint : browser_->complaints()) ADD_FAILURE() << complaint;
    for (const std::string& request : browser_->requests()) {
      EXPECT_TRUE(request.rfind("file://", 0) == 0 || request.rfind("blob:", 0) == 0 || request.rfind("data:", 0) == 0)
          << request;
    }
  }
  static void choose(const std::string& role, const std::string& name) {
    of("(() => { const s = document.getElementById('shape_" + role + "'); s.value = '" + name +
       "'; s.dispatchEvent(new Event('change')); })()");
  }
  static void drop(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name) << content;
    of("(() => { const data = new DataTransfer(); data.items.add(new File([" + nlohmann::json(content).dump() + "], '" +
       name + "')); dispatchEvent(new DragEvent('drop', {dataTransfer: data, clientX: 5, clientY: 5})); })()");
    of("new Promise(go => setTimeout(go, 200))");
    settled();
  }
  static void paste(const std::string& line) {
    of("(() => { document.getElementById('paste').value = " + nlohmann::json(line).dump() +
       "; document.getElementById('take').click(); })()");
    settled();
  }

  static constexpr const char* kPage = PROJECT_SOURCE_DIR "/build/npm/play.html";
  static inline fs::path folder_;
  static inline std::unique_ptr<Browser> browser_;
};

TEST_F(PlayPage, ADragMovesABodyAndTheAnswerFollows) {
  open();
  expect_native("at first");
  const std::string before = of("document.getElementById('depth').dataset.value");
  const std::string picture = of("document.getElementById('space').toDataURL()");
  const int frames = std::stoi(of("document.getElementById('space').dataset.frames").get<std::string>());
  const auto box =
      of("(() => { const b = document.getElementById('space').getBoundingClientRect(); return [b.left, b.top, b.width, "
         "b.height]; })()");
  const double x = box[0].get<double>() + box[2].get<double>() / 4, y = box[1].get<double>() + box[3].get<double>() / 2;
  browser_->drag(x, y, x + 24, y - 18);
  settled();
  EXPECT_NE(of("document.getElementById('depth').dataset.value"), before);
  EXPECT_NE(of("document.getElementById('space').toDataURL()"), picture);
  EXPECT_GT(std::stoi(of("document.getElementById('space').dataset.frames").get<std::string>()), frames);
  expect_native("after a drag");
  click("out");
  settled();
  EXPECT_NE(of("document.getElementById('depth').dataset.contact"), "overlapping");
  expect_quiet();
}

TEST_F(PlayPage, EveryBodyOfTheListIsAnsweredAsByTheCommand) {
  open();
  const auto names = of("[...document.getElementById('shape_a').options].map(o => o.value)");
  ASSERT_GE(names.size(), 12U);
  for (std::size_t i = 0; i < names.size(); ++i) {
    choose("a", names[i]);
    choose("b", names[(i + 5) % names.size()]);
    ASSERT_FALSE(is_refused()) << names[i] << ": " << text("refusal");
    expect_native(names[i]);
  }
  expect_quiet();
}

TEST_F(PlayPage, KeysMoveAndTurn) {
  open();
  of("document.getElementById('space').focus()");
  const std::string first = of("document.getElementById('line').value");
  browser_->press("ArrowRight");
  settled();
  const std::string moved = of("document.getElementById('line').value");
  EXPECT_NE(moved, first);
  of("document.getElementById('space').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', shiftKey: "
     "true}))");
  settled();
  EXPECT_NE(of("document.getElementById('line').value"), moved);
  expect_native("after keys");
  // Compiling shaders takes longer than a frame may.
  of("(() => { const p = WebGL2RenderingContext.prototype, link = p.linkProgram; window.links = 0;"
     "p.linkProgram = function (program) { ++window.links; return link.call(this, program); }; })()");
  for (const char* key : {"ArrowRight", "ArrowUp", "PageDown"}) browser_->press(key);
  settled();
  EXPECT_EQ(of("window.links"), 0);
  expect_quiet();
}

TEST_F(PlayPage, DroppedFilesAndPastedLines) {
  open();
  drop("wedge.obj", "v 0 0 0\nv 1.25 0 0\nv 0 1.5 0\nv 0 0 1.125\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf -4 -1 -2\n");
  EXPECT_EQ(of("document.getElementById('shape_a').value"), "wedge.obj");
  expect_native("a dropped OBJ");
  drop("cube.ply",
       "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n");
  expect_native("a dropped PLY");
  of("document.getElementById('files_as').value = 'hull'");
  drop("corner.stl",
       "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\nendloop\nendfacet\n"
       "facet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 0\nvertex 0 1 0.5\nendloop\nendfacet\nendsolid\n");
  expect_native("a dropped STL");
  paste(
      R"({"query":"depth","a":{"type":"box","half_extents":[1,1,1]},"b":{"type":"sphere","radius":1},"pose_b":{"translation":[1.5,0,0]}})");
  EXPECT_EQ(of("document.getElementById('depth').dataset.value"), "0.5");
  expect_native("a pasted line");
  const std::string line = of("document.getElementById('line').value");
  click("copy_link");
  settled();
  const std::string link = of("location.hash");
  open();
  of("location.hash = " + nlohmann::json(link).dump());
  settled();
  EXPECT_EQ(of("document.getElementById('line').value"), line);
  expect_quiet();
}

/// A prism of the shape of an L, as OBJ.
constexpr const char* kCornerObj =
    "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
    "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

/// That prism as glTF: single precision, triangles, a node that moves it by (0.25, 0, 0).
std::string corner_gltf() {
  const std::string make =
      "(() => { const xy = [[0,0],[2,0],[2,1],[1,1],[1,2],[0,2]];"
      "const points = new Float32Array([0, 1].flatMap(z => xy.flatMap(p => [...p, z])));"
      "const flat = [[0,1,2],[0,2,3],[0,3,4],[0,4,5]], sides = [0,1,2,3,4,5].flatMap(i => { const j = (i + 1) % 6;"
      "return [[i, j, j + 6], [i, j + 6, i + 6]]; });"
      "const order = new Uint16Array([...flat.map(t => [...t].reverse()), ...flat.map(t => t.map(v => v + 6)), "
      "...sides].flat());"
      "const bytes = [...new Uint8Array(points.buffer), ...new Uint8Array(order.buffer)];"
      "return JSON.stringify({asset: {version: '2.0'}, scenes: [{nodes: [0]}], nodes: [{mesh: 0, translation: [0.25, "
      "0, 0]}],"
      "meshes: [{primitives: [{attributes: {POSITION: 0}, indices: 1}]}],"
      "accessors: [{bufferView: 0, componentType: 5126, count: 12, type: 'VEC3'}, {bufferView: 1, componentType: 5123, "
      "count: order.length, type: 'SCALAR'}],"
      "bufferViews: [{buffer: 0, byteLength: 144}, {buffer: 0, byteOffset: 144, byteLength: 2 * order.length}],"
      "buffers: [{byteLength: bytes.length, uri: 'data:application/octet-stream;base64,' + "
      "btoa(String.fromCharCode(...bytes))}]}); })()";
  return make;
}

TEST_F(PlayPage, MeshesAreSolids) {
  open();
  choose("b", "Box");
  drop("corner.obj", kCornerObj);
  ASSERT_FALSE(is_refused()) << text("refusal");
  EXPECT_EQ(of("document.getElementById('shape_a').value"), "corner.obj");
  expect_native("a solid");
  of("document.getElementById('space').focus()");
  for (const char* key : {"ArrowRight", "PageDown", "PageDown"}) browser_->press(key);
  expect_native("a solid that was moved");
  click("copy_link");
  settled();
  EXPECT_NE(text("refusal").find("a link holds no file"), std::string::npos) << text("refusal");
  const std::string line = of("document.getElementById('line').value");
  click("reset");
  settled();
  paste(line);
  ASSERT_FALSE(is_refused()) << text("refusal");
  EXPECT_EQ(of("document.getElementById('line').value"), line) << "the page knows the file that was dropped";
  const std::string gltf = of(corner_gltf());
  drop("corner.gltf", gltf);
  ASSERT_FALSE(is_refused()) << text("refusal");
  expect_native("a dropped glTF");
  const std::string depth = of("document.getElementById('depth').dataset.value");
  // The file is dropped once more, as GLB.
  of("(() => { const json = " + nlohmann::json(gltf).dump() +
     ", pad = json + ' '.repeat(-json.length & 3), head = new Uint32Array([0x46546c67, 2, 20 + pad.length, pad.length, "
     "0x4e4f534a]), data = new DataTransfer(); data.items.add(new File([head, pad], 'corner.glb'));"
     "dispatchEvent(new DragEvent('drop', {dataTransfer: data, clientX: 5, clientY: 5})); })()");
  of("new Promise(go => setTimeout(go, 200))");
  settled();
  ASSERT_FALSE(is_refused()) << text("refusal");
  EXPECT_EQ(of("document.getElementById('shape_a').value"), "corner.glb");
  EXPECT_EQ(of("document.getElementById('depth').dataset.value"), depth);
  of("document.getElementById('files_as').value = 'hull'");
  drop("corner.obj", kCornerObj);
  EXPECT_NE(of("document.getElementById('line').value").get<std::string>().find("\"convex\""), std::string::npos);
  expect_native("the hull of the mesh");
  expect_quiet();
}

TEST_F(PlayPage, WrongMeshesAreNamedAndThePageLivesOn) {
  open();
  const std::string before = of("document.getElementById('line').value");
  const auto refused = [](const std::string& name, const std::string& content, const std::string& words) {
    drop(name, content);
    EXPECT_TRUE(is_refused()) << words;
    EXPECT_NE(text("refusal").find(words), std::string::npos) << text("refusal");
  };
  const std::string corner = kCornerObj;
  refused("open.obj", corner.substr(0, corner.find("f 6 5")) + "f 7 8 9 10 11 12\n", "open_edge");
  refused("open.obj", corner.substr(0, corner.find("f 6 5")) + "f 7 8 9\n", "Choose \"convex hulls\"");
  refused("wrong.obj", corner + "f 1 2 99\n", "bad_faces");
  refused("word.obj", corner + "f a b c\n", "word.obj, line 21");
  refused("zero.obj", corner + "f 0 1 2\n", "\"0\" is no vertex");
  refused("cut.gltf", R"({"asset":)", "bad_file");
  refused("old.gltf", R"({"asset":{"version":"1.0"}})", "only glTF 2 is read");
  refused("empty.gltf", R"({"asset":{"version":"2.0"}})", "too_few_points");
  refused(
      "outside.gltf",
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0}],)"
      R"("buffers":[{"uri":"corner.bin"}]})",
      "is a file of its own");
  refused(
      "short.gltf",
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0}],)"
      R"("buffers":[{"uri":"data:;base64,AAAA"}]})",
      "reaches beyond its buffer (short.gltf, accessors[0])");
  refused("cut.glb", std::string("glTF"), "ends in the header");
  // A file that is too large is not read at all.
  of("(() => { const file = new File(['v'], 'huge.obj'), data = {files: [file]};"
     "Object.defineProperty(file, 'size', {value: 3e9});"
     "const event = new Event('drop'); Object.assign(event, {dataTransfer: data, clientX: 5}); dispatchEvent(event); "
     "})()");
  of("new Promise(go => setTimeout(go, 200))");
  EXPECT_NE(text("refusal").find("has 3000 MB"), std::string::npos) << text("refusal");
  settled();
  EXPECT_EQ(of("document.getElementById('line').value"), before);
  expect_native("after all that");
  expect_quiet();
}

TEST_F(PlayPage, WrongInputIsNamedAndThePageLivesOn) {
  open();
  const std::string before = of("document.getElementById('line').value");
  const auto refused = [](const std::string& words) {
    EXPECT_TRUE(is_refused()) << words;
    EXPECT_NE(text("refusal").find(words), std::string::npos) << text("refusal");
  };
  paste("{\"query\":");
  refused("bad_json");
  paste(R"({"query":"depth","a":{"type":"box","half_extents":[1,-1,1]},"b":{"type":"sphere","radius":1}})");
  refused("(a.half_extents[1])");
  paste(R"({"query":"depth","a":{"type":"mesh","path":"x.obj"},"b":{"type":"sphere","radius":1}})");
  refused("\"x.obj\" was not dropped");
  paste(
      R"({"query":"depth","a":{"type":"sphere","radius":1},"b":{"type":"sphere","radius":1},"pose_b":{"translation":[1,null,0]}})");
  refused("(pose_b.translation)");
  drop("nan.obj", "v 0 0 0\nv 1 x 0\n");
  refused("nan.obj, line 2");
  drop("empty.obj", "# nothing\n");
  refused("too_few_points");
  drop("x.doc", "nothing");
  refused("none of obj, stl, ply, gltf, glb");
  drop("cut.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 800\nproperty float x\nproperty float y\nproperty float "
       "z\nend_header\n0");
  refused("ends before its 800 vertices");
  settled();
  EXPECT_EQ(of("document.getElementById('line').value"), before);
  click("reset");
  settled();
  EXPECT_FALSE(is_refused());
  expect_native("after all that");
  expect_quiet();
}

TEST_F(PlayPage, FitsAPhoneInLightAndDark) {
  for (const char* scheme : {"light", "dark"}) {
    open(390, scheme);
    for (const char* tab : {"tab_polygons", "tab_bodies"}) {
      click(tab);
      EXPECT_LE(of("document.documentElement.scrollWidth").get<int>(), 390) << scheme << ", " << tab;
      const auto small =
          of("[...document.querySelectorAll('button, select')].filter(e => e.offsetParent && (e.offsetHeight < 36 || "
             "e.getBoundingClientRect().right > 390)).map(e => e.id)");
      EXPECT_TRUE(small.empty()) << small;
    }
    expect_quiet();
  }
  const auto unnamed =
      of("[...document.querySelectorAll('select, textarea, input, button, canvas')].filter(e => !e.labels?.length && "
         "!e.textContent.trim() && !e.getAttribute('aria-label')).map(e => e.outerHTML)");
  EXPECT_TRUE(unnamed.empty()) << unnamed;
}

TEST_F(PlayPage, PolygonsFitWhereTheirTabSays) {
  open();
  click("tab_polygons");
  expect_native("at first", "_plane");
  for (const char* name : {"Comb", "Corner"}) {
    of("(() => { const s = document.getElementById('shape_p'); s.value = '" + std::string(name) +
       "'; s.dispatchEvent(new Event('change')); })()");
    expect_native(name, "_plane");
  }
  drop("wedge.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L2 0L1 1.5Z'/></svg>");
  EXPECT_EQ(of("document.getElementById('shape_p').value"), "wedge.svg");
  EXPECT_EQ(text("corners_plane").substr(0, 2), "3 ");
  expect_native("a dropped SVG", "_plane");
  click("draw_p");
  of("(() => { const s = document.getElementById('plane'), b = s.getBoundingClientRect();"
     "const send = (kind, x, y) => s.dispatchEvent(new PointerEvent(kind, {pointerId: 1, clientX: b.left + x * "
     "b.width, "
     "clientY: b.top + y * b.height}));"
     "s.setPointerCapture = () => {};"
     "send('pointerdown', 0.3, 0.3);"
     "for (const [x, y] of [[0.7, 0.3], [0.7, 0.7], [0.5, 0.45], [0.3, 0.7]]) send('pointermove', x, y);"
     "send('pointerup', 0.3, 0.7); })()");
  expect_native("a drawn polygon", "_plane");
  EXPECT_EQ(text("corners_plane").substr(0, 2), "5 ");
  click("out_plane");
  expect_native("after the way out", "_plane");
  EXPECT_NE(of("document.getElementById('depth_plane').dataset.contact"), "overlapping");
  drop("eight.svg", "<svg xmlns='http://www.w3.org/2000/svg'><polygon points='0,0 2,2 2,0 0,2'/></svg>");
  EXPECT_NE(text("refusal_plane").find("crosses itself (eight.svg)"), std::string::npos) << text("refusal_plane");
  drop("wrong.svg", "<svg");
  EXPECT_NE(text("refusal_plane").find("no well-formed SVG"), std::string::npos) << text("refusal_plane");
  expect_native("after all that", "_plane");
  expect_quiet();
}

/// The licence goes wherever the code goes.
TEST_F(PlayPage, HoldsTheLicenceOfThreeJs) {
  open();
  EXPECT_NE(text("licence").find("Permission is hereby granted"), std::string::npos);
}

}  // namespace
}  // namespace pd::test
