/// @file
/// Pages of `--report` in headless Chromium: no complaint, no request but for files beside them, one cursor for
/// picture, charts and figures, keys, a phone's width, dark, pairs turned in space.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>

#include "pages/browser.hpp"

namespace pd::test {
namespace {

namespace fs = std::filesystem;

/// Pixels of an image or a canvas that differ from its first one, as a share.
constexpr const char* kInked = R"((drawn => {
  const copy = document.createElement('canvas');
  copy.width = copy.height = 96;
  const context = copy.getContext('2d');
  context.drawImage(drawn, 0, 0, 96, 96);
  const bytes = context.getImageData(0, 0, 96, 96).data;
  let different = 0;
  for (let i = 4; i < bytes.length; i += 4) {
    if (Math.abs(bytes[i] - bytes[0]) + Math.abs(bytes[i + 1] - bytes[1]) + Math.abs(bytes[i + 2] - bytes[2]) > 24) ++different;
  }
  return different / (96 * 96);
}))";

class ReportPage : public ::testing::Test {
 protected:
  /// Pages are made once for all tests.
  static void SetUpTestSuite() {
    if (Browser::program().empty()) return;
    std::string name = (fs::temp_directory_path() / "pdepth_pages_XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    std::ofstream(folder_ / "record.jsonl") << kRecord;
    status_audit_ = run("audit record.jsonl --worst 4 --report audit");
#ifdef PDEPTH_WITH_DEMOS
    status_demo_ = run("demo stacking --steps 48 --size 320x180 --report stacking");
#endif
#ifdef PDEPTH_BENCH_PROGRAM
    status_bench_ = run(
        "pairs --quick --families box,sphere --vertices 8,32 --pairs 3 --solvers pdepth-auto,pdepth-tightest --seed 3 "
        "--report pairs",
        PDEPTH_BENCH_PROGRAM);
    status_claims_ = run("agarwal --quick --chapters sizes --report claims", PDEPTH_BENCH_PROGRAM);
#endif
    browser_ = std::make_unique<Browser>(folder_ / "profile");
  }
  static void TearDownTestSuite() {
    browser_.reset();
    std::error_code error;
    if (!folder_.empty()) fs::remove_all(folder_, error);
  }
  void SetUp() override {
    if (browser_ == nullptr) GTEST_SKIP() << "Chromium is not installed (Debian: chromium), so no page is opened";
  }

  static int run(const std::string& arguments, const std::string& program = PDEPTH_PROGRAM) {
    const std::string command = "cd '" + folder_.string() + "' && '" + program + "' " + arguments + " > out 2> err";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  Browser& open(const std::string& page, int width = 1280, const std::string& scheme = "light") {
    browser_->look(width, 900, scheme);
    browser_->open(folder_ / page / "report.html");
    return *browser_;
  }
  /// Nothing went wrong, and nothing was fetched but files of the report.
  static void expect_quiet() {
    for (const std::string& complaint : browser_->complaints()) ADD_FAILURE() << complaint;
    for (const std::string& request : browser_->requests()) {
      EXPECT_TRUE(request.starts_with("file://" + folder_.string()) || request.starts_with("data:")) << request;
    }
  }

  static constexpr const char* kRecord = R"({"record":"pdepth-contacts/1","engine":"E <1> & co","scalar":"float32"}
{"shape":"s","is":{"type":"box","half_extents":[1,0.7,0.5]}}
{"shape":"c","is":{"type":"cylinder","radius":0.6,"half_height":0.5,"axis":"z"}}
{"shape":"g","is":{"type":"plane","normal":[0,0,1],"offset":0}}
{"contact":"</script>","a":"s","pose_a":{"translation":[0.2,0.1,0.8],"quaternion_wxyz":[0.8,0.48,0.36,0.0]},"b":"s","reported":{"depth":0.6,"normal":[0.3,0.1,1]}}
{"contact":2,"a":"c","pose_a":{"translation":[0.2,0.1,0.8],"quaternion_wxyz":[0.8,0.48,0.36,0.0]},"b":"s","reported":null}
{"contact":3,"a":"c","pose_a":{"translation":[0,0,0.4]},"b":"g","reported":{"depth":0.2,"normal":[0,0,1]}}
)";

  static inline fs::path folder_;
  static inline std::unique_ptr<Browser> browser_;
  static inline int status_audit_ = -1;
  static inline int status_demo_ = -1;
  static inline int status_bench_ = -1;
  static inline int status_claims_ = -1;
};

TEST_F(ReportPage, AnAuditShowsTheWorstContactsAndTheirLines) {
  ASSERT_EQ(status_audit_, 0);
  Browser& page = open("audit");
  EXPECT_EQ(page.evaluate("document.title"), "Contacts of E <1> & co");
  EXPECT_EQ(page.evaluate("document.querySelectorAll('figure.pair').length"), 3);
  EXPECT_EQ(page.evaluate("document.querySelectorAll('figure.pair svg.drawing').length"), 5) << "no P for a plane";
  EXPECT_GT(page.evaluate("document.querySelector('svg.drawing').querySelectorAll('polygon').length"), 6);
  EXPECT_EQ(page.evaluate("[...document.querySelectorAll('svg')].every(s => s.getAttribute('aria-label'))"), true);
  // The link is the pair's line: `pdepth query` answers it as the page says.
  const std::string line = page.evaluate(
      "decodeURIComponent(document.querySelector('figure.pair a[download]').href.split(',').slice(1).join(','))");
  std::ofstream(folder_ / "pair.jsonl") << line;
  ASSERT_EQ(run("query pair.jsonl"), 0);
  std::ifstream answers(folder_ / "out");
  const auto answer = nlohmann::json::parse(answers);
  const std::string words =
      page.evaluate("document.querySelector('figure.pair a[download]').closest('figcaption').textContent");
  EXPECT_NE(words.find(nlohmann::json(answer.at("depth")).dump()), std::string::npos) << words;
  expect_quiet();
}

TEST_F(ReportPage, APairIsTurnedWithMouseAndKeys) {
  Browser& page = open("audit");
  page.evaluate("document.querySelectorAll('figure.pair .turn')[1].click()");
  const std::string inked = std::string(kInked) + "(document.querySelector('canvas.space'))";
  EXPECT_GT(page.evaluate(inked), 0.1) << "the canvas is blank";
  const std::string look = "document.querySelector('canvas.space').toDataURL()";
  const auto before = page.evaluate(look);
  const auto box = page.evaluate(
      "(c => (c.scrollIntoView({block: 'center'}), c = c.getBoundingClientRect(), [c.x + c.width / 4, c.y + c.height / "
      "2]))(document.querySelector('canvas.space'))");
  page.drag(box[0], box[1], double(box[0]) + 60, double(box[1]) + 20);
  const auto dragged = page.evaluate(look);
  EXPECT_NE(before, dragged) << "the mouse does not turn it";
  page.evaluate("document.querySelector('canvas.space').focus()");
  page.press("ArrowLeft");
  EXPECT_NE(page.evaluate(look), dragged) << "the keys do not turn it";
  EXPECT_NE(page.evaluate("document.querySelector('canvas.space').getAttribute('aria-label')"), "");
  // Another pair takes the canvas; the first one's drawing comes back.
  page.evaluate("document.querySelectorAll('figure.pair .turn')[0].click()");
  EXPECT_EQ(page.evaluate("document.querySelectorAll('canvas.space').length"), 1);
  EXPECT_EQ(page.evaluate("[...document.querySelectorAll('.views')].map(v => v.hidden)"),
            nlohmann::json::parse("[true,false,false]"));
  expect_quiet();
}

TEST_F(ReportPage, FitsAPhoneAndTheDark) {
  for (const char* name : {"audit", "stacking", "pairs", "claims"}) {
    if (!fs::exists(folder_ / name / "report.html")) continue;
    Browser& page = open(name, 390, "dark");
    EXPECT_LE(page.evaluate("document.documentElement.scrollWidth"), 390) << name;
    const std::string ink = page.evaluate("getComputedStyle(document.body).color");
    const std::string paper = page.evaluate("getComputedStyle(document.body).backgroundColor");
    open(name, 1280, "light");
    EXPECT_NE(page.evaluate("getComputedStyle(document.body).color"), ink);
    EXPECT_NE(page.evaluate("getComputedStyle(document.body).backgroundColor"), paper);
    expect_quiet();
  }
}

#ifdef PDEPTH_BENCH_PROGRAM

TEST_F(ReportPage, ABenchShowsItsFiguresAndSortsItsTables) {
  ASSERT_EQ(status_bench_, 0);
  Browser& page = open("pairs");
  EXPECT_EQ(page.evaluate("document.querySelector('.cards .good').textContent"), "0of pdepth's answers wrong");
  EXPECT_EQ(page.evaluate("document.querySelectorAll('.bars li').length"), 4) << "two solvers in two charts";
  EXPECT_EQ(page.evaluate("[...document.querySelectorAll('svg.chart')].every(s => s.getAttribute('aria-label'))"),
            true);
  EXPECT_EQ(page.evaluate("document.querySelectorAll('#sizes svg.chart').length"), 1) << "only spheres come in sizes";
  // The command that makes the page again.
  EXPECT_NE(page.evaluate("document.querySelector('#reproduce pre').textContent")
                .get<std::string>()
                .find("pdepth-bench pairs --quick --families box,sphere --vertices 8,32 --pairs 3 --solvers "
                      "pdepth-auto,pdepth-tightest --seed 3 --report pairs"),
            std::string::npos);
  // Sorted by a press of a key: the largest time first, then the smallest, then as the program has them.
  const std::string times =
      "[...document.querySelectorAll('#cells tbody tr')].map(r => Number(r.cells[5].dataset.value))";
  const auto given = page.evaluate(times).get<std::vector<double>>();
  ASSERT_EQ(given.size(), 18U) << "three cells of sizes, three depths, two solvers";
  auto sorted = given;
  std::sort(sorted.begin(), sorted.end());
  page.evaluate("document.querySelectorAll('#cells th button')[5].focus()");
  page.press("Enter");
  EXPECT_EQ(page.evaluate(times).get<std::vector<double>>(), std::vector<double>(sorted.rbegin(), sorted.rend()));
  EXPECT_EQ(page.evaluate("document.querySelectorAll('#cells th')[5].getAttribute('aria-sort')"), "descending");
  page.press("Enter");
  EXPECT_EQ(page.evaluate(times).get<std::vector<double>>(), sorted);
  page.press("Enter");
  EXPECT_EQ(page.evaluate(times).get<std::vector<double>>(), given);
  // Filtered by words of a row.
  page.evaluate(
      "(f => { f.value = 'tightest 8'; f.dispatchEvent(new Event('input')); })(document.querySelector('.filter "
      "input'))");
  EXPECT_EQ(page.evaluate("[...document.querySelectorAll('#cells tbody tr')].filter(r => !r.hidden).length"), 6);
  EXPECT_EQ(page.evaluate("document.querySelector('.filter output').textContent"), "6 of 18");
  // The table lies beside the page.
  std::ifstream csv(folder_ / "pairs" / page.evaluate("document.querySelector('#cells a').getAttribute('href')"));
  std::string line;
  int lines = 0;
  while (std::getline(csv, line)) ++lines;
  EXPECT_EQ(lines, 1 + 18);
  expect_quiet();
}

TEST_F(ReportPage, ClaimsShowWhatGrows) {
  ASSERT_EQ(status_claims_, 0);
  Browser& page = open("claims");
  EXPECT_GE(page.evaluate("document.querySelectorAll('#growth svg.chart path').length"), 2);
  const auto findings = page.evaluate("document.querySelectorAll('#findings tbody tr').length");
  std::vector<int> counted;
  for (int card = 0; card < 4; ++card) {
    const std::string value =
        page.evaluate("document.querySelectorAll('.cards b')[" + std::to_string(card) + "].textContent");
    counted.push_back(std::stoi(value));
  }
  EXPECT_EQ(std::accumulate(counted.begin(), counted.end(), 0), findings);
  EXPECT_TRUE(fs::exists(folder_ / "claims" / "points.csv"));
  expect_quiet();
}

#endif

#ifdef PDEPTH_WITH_DEMOS

TEST_F(ReportPage, OneCursorMovesPictureChartsAndFigures) {
  ASSERT_EQ(status_demo_, 0);
  Browser& page = open("stacking");
  const auto state = [&] {
    return page.evaluate(R"((s => ({frame: s.dataset.frame, file: s.querySelector('.stage img').src.split('/').pop(),
      alt: s.querySelector('.stage img').alt, said: s.querySelector('input').getAttribute('aria-valuetext'),
      figures: [...s.querySelectorAll('.now td.value')].map(c => c.textContent),
      cursors: [...s.querySelectorAll('.chart .cursor')].map(c => Number(c.getAttribute('x1'))),
      ends: [...s.querySelectorAll('.chart')].map(c => Number(c.dataset.left) + Number(c.dataset.width))
    }))(document.querySelector('section.scene')))");
  };
  page.evaluate("document.querySelector('section.scene input').focus()");
  page.press("Home");
  const auto first = state();
  EXPECT_EQ(first["frame"], "0");
  EXPECT_EQ(first["file"], "towers_0000.png");
  page.press("ArrowRight");
  const auto next = state();
  EXPECT_EQ(next["frame"], "1");
  EXPECT_EQ(next["file"], "towers_0001.png");
  EXPECT_NE(next["alt"], first["alt"]);
  EXPECT_NE(next["said"], first["said"]);
  EXPECT_NE(next["figures"], first["figures"]);
  page.press("End");
  const auto last = state();
  EXPECT_EQ(last["frame"], "6") << "48 steps, 8 to a frame";
  ASSERT_EQ(last["cursors"].size(), 6U);
  EXPECT_EQ(last["cursors"], last["ends"]) << "every chart's cursor stands at its end";
  // The figure at the end is the one in the demo's own table.
  std::ifstream csv(folder_ / "stacking/stacking/towers_exact.csv");
  std::string row;
  std::string at_end;
  while (std::getline(csv, row)) at_end = row;
  const double depth = std::strtod(at_end.substr(at_end.find(',', at_end.find(',') + 1) + 1).c_str(), nullptr);
  const double shown = std::strtod(last["figures"][0].get<std::string>().c_str(), nullptr);
  const std::string unit = last["figures"][0].get<std::string>();
  const double scale = unit.ends_with(" mm")        ? 1e-3
                       : unit.ends_with(" \u00b5m") ? 1e-6
                       : unit.ends_with(" nm")      ? 1e-9
                                                    : 1;
  EXPECT_NEAR(shown * scale, depth, 0.006 * depth) << unit;
  // A press on a chart moves it, too.
  const auto at = page.evaluate(
      "(c => (c.scrollIntoView({block: 'center'}), c = c.getBoundingClientRect(), [c.x + c.width * 0.5, c.y + c.height "
      "/ "
      "2]))(document.querySelectorAll('section.scene .chart')[1])");
  page.drag(at[0], at[1], at[0], at[1]);
  EXPECT_NE(state()["frame"], "6");
  page.evaluate("document.querySelector('section.scene .controls button').click()");
  EXPECT_EQ(page.evaluate("document.querySelector('section.scene .controls button').textContent"), "Pause");
  expect_quiet();
}

TEST_F(ReportPage, EveryPictureIsThereAndNotBlank) {
  ASSERT_EQ(status_demo_, 0);
  Browser& page = open("stacking");
  // file: pictures may be drawn but not read back by scripts: sizes tell that they are there, the PNGs what they hold.
  EXPECT_EQ(page.evaluate("Promise.all([...document.images].map(i => (i.loading = 'eager', i.decode().then(() => "
                          "i.naturalWidth > 100)))).then(all => all.every(x => x))"),
            true);
  page.picture(folder_ / "page.png");
  EXPECT_GT(fs::file_size(folder_ / "page.png"), 50'000U);
  EXPECT_GE(page.evaluate("document.querySelectorAll('figure.pair').length"), 4);
  EXPECT_NE(
      page.evaluate("document.querySelector('#towers table:not(.now)').textContent").get<std::string>().find("Bullet"),
      std::string::npos);
  expect_quiet();
}

#endif

}  // namespace
}  // namespace pd::test
