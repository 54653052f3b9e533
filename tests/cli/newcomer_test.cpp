/// @file
/// The command as a newcomer types it: bodies without a file, what a terminal shows, manual pages and completion.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "protocol/handlers.hpp"
#include "protocol_lines.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

constexpr const char* kCubeText =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

class Newcomer : public ::testing::Test, protected TemporaryFolder {
 protected:
  void SetUp() override { write("cube.obj", kCubeText); }

  /// Runs a command of the shell, in which `pdepth` is the program. @return its exit code
  int shell(const std::string& command) {
    const int status = std::system(in_folder("(" + command + ") > out 2> err").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  Json json_of(const std::string& command) {
    EXPECT_EQ(shell(command), 0) << command << "\n" << read("err");
    return Json::parse(read("out"), nullptr, false);
  }
  /// The output of a command to a terminal on which nothing but the end of the input is typed.
  std::string on_terminal(const std::string& command) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      ::execl("/bin/sh", "sh", "-c", in_folder(command).c_str(), nullptr);
      ::_exit(127);
    }
    constexpr char kEndOfInput = 4;
    EXPECT_EQ(::write(terminal, &kEndOfInput, 1), 1);
    std::string text;
    char buffer[1024];
    for (ssize_t got = 0; (got = ::read(terminal, buffer, sizeof(buffer))) > 0;) {
      text.append(buffer, static_cast<std::size_t>(got));
    }
    ::close(terminal);
    int status = 0;
    ::waitpid(child, &status, 0);
    return text;
  }
  [[nodiscard]] bool says(const std::string& words) const { return read("err").find(words) != std::string::npos; }

 private:
  [[nodiscard]] std::string in_folder(const std::string& command) const {
    return "cd '" + path().string() + "'; pdepth() { '" PDEPTH_PROGRAM "' \"$@\"; }; " + command;
  }
};

TEST_F(Newcomer, AsksAboutBodiesWithoutAFile) {
  EXPECT_EQ(json_of("pdepth depth box:1,1,1 sphere:0.5 --pose-b 1.25,0,0 --json").at("depth"), 0.25);
  EXPECT_EQ(json_of("pdepth depth cube.obj box:1,1,1 --pose-b 1.5,0,0 --json").at("depth"), 0.5);
  EXPECT_NEAR(json_of("pdepth depth capsule:0.2,1 cylinder:1,1 --pose-b 0,0,2 --json").at("depth").get<double>(), 0.2,
              1e-6);
  EXPECT_EQ(json_of("pdepth depth cone:1,1 ellipsoid:1,2,3 --pose-b 9,0,0 --json").at("class"), "separated");
  EXPECT_EQ(shell("pdepth depth box:1,1,1 sphere:0.5"), 0);
  EXPECT_NE(read("out").find("sphere:0.5"), std::string::npos);
  EXPECT_NE(read("out").find("overlap"), std::string::npos);
  for (const char* bad : {"box:1,1", "box:1,1,0", "sphere:", "sphere:x", "capsule:1", "cone:1,2,3", "sphere:nan"}) {
    EXPECT_EQ(shell(std::string("pdepth depth box:1,1,1 ") + bad), 2) << bad;
    EXPECT_TRUE(says(bad)) << bad << ": " << read("err");
  }
  EXPECT_TRUE(says("sphere:nan"));
  EXPECT_EQ(shell("pdepth depth box:1,1,1 ellipsoid:1,2,3 --method overlay"), 2);
  EXPECT_TRUE(says("auto does")) << read("err");
  EXPECT_EQ(shell("pdepth depth box:1,1,1 sphere:1 --trace t.jsonl"), 2);
  EXPECT_TRUE(says("--trace: both bodies must be meshes or boxes")) << read("err");
}

TEST_F(Newcomer, SweepsBodiesAndAsksAlongADirection) {
  const std::string pair = "pdepth depth box:1,1,1 box:1,1,1 --pose-b 2.25,0,0 --json ";
  EXPECT_EQ(json_of(pair).at("distance"), 0.25);
  EXPECT_EQ(json_of(pair + "--margin 0.25").at("depth"), 0.25);
  EXPECT_EQ(json_of(pair + "--margin 0.5,0").at("depth"), 0.25);
  EXPECT_EQ(shell(pair + "--margin -1"), 2);
  EXPECT_EQ(shell(pair + "--margin 1,2,3"), 2);
  EXPECT_TRUE(says("--margin takes at most 2 values, not 3: Radius")) << read("err");
  EXPECT_EQ(json_of("pdepth depth box:1,1,1 box:1,1,1 --direction 0,0,3 --json").at("depth"), 2.0);
  EXPECT_EQ(json_of("pdepth depth box:1,1,1 box:1,1,1 --pose-b 1,0,0 --direction=-1,0,0 --json").at("depth"), 1.0);
  EXPECT_EQ(shell("pdepth depth box:1,1,1 box:1,1,1 --direction 0,0,3"), 0);
  EXPECT_NE(read("out").find("along the direction"), std::string::npos) << read("out");
  EXPECT_EQ(shell("pdepth depth box:1,1,1 box:1,1,1 --direction 0,0,0"), 2);
  EXPECT_EQ(shell("pdepth depth box:1,1,1 box:1,1,1 --direction 0,0"), 2);
  EXPECT_TRUE(says("X,Y,Z")) << read("err");
  EXPECT_EQ(shell("pdepth depth box:1,1,1 box:1,1,1 --direction 0,0,1 --method grid"), 2);
}

TEST_F(Newcomer, ReadsAMeshFromStandardInput) {
  write("spike.off", "OFF\n4 4 6\n0 0 0.5\n2 0 4\n-1 2 4\n-1 -2 4\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n");
  write("flat.stl",
        "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid x\n");
  EXPECT_EQ(json_of("pdepth depth - box:1,1,1 --pose-b 1.5,0,0 --json < cube.obj").at("depth"), 0.5);
  EXPECT_EQ(json_of("pdepth depth box:1,1,1 - --json < spike.off").at("depth"), 0.5);
  EXPECT_EQ(json_of("pdepth depth - box:1,1,1 --hull --json < flat.stl").at("class"), "overlapping");
  EXPECT_EQ(shell("pdepth depth - - < cube.obj"), 2);
  EXPECT_EQ(shell("pdepth depth - box:1,1,1 < /dev/null"), 2);
  EXPECT_TRUE(says("standard input: it is empty")) << read("err");
  EXPECT_EQ(shell("echo 1 2 3 | pdepth depth - box:1,1,1"), 2);
  EXPECT_TRUE(says("standard input: no vertices; a mesh without a name is OBJ, OFF")) << read("err");
  EXPECT_EQ(shell("echo '{\"asset\":{}}' | pdepth depth - box:1,1,1"), 2);
  EXPECT_TRUE(says("standard input: glTF")) << read("err");
}

TEST_F(Newcomer, IsToldOnATerminalWhatTheCommandWaitsFor) {
  EXPECT_NE(on_terminal("pdepth query").find("reading lines from standard input"), std::string::npos);
  EXPECT_EQ(shell("pdepth query < /dev/null"), 0);
  EXPECT_EQ(read("err"), "");
  // Longer than the half second after which a line says how far the work is.
  write("record.jsonl", R"({"record":"pdepth-contacts/1","engine":"none","scalar":"float64"})"
                        "\n");
  const std::string slow = "(cat record.jsonl; sleep 0.7) | pdepth audit - > out";
  const std::string shown = on_terminal(slow);
  EXPECT_NE(shown.find("audit -"), std::string::npos) << shown;
  EXPECT_TRUE(shown.ends_with("\r\x1b[K")) << "the line is taken away: " << shown;
  EXPECT_EQ(shell(slow), 0);
  EXPECT_EQ(read("err"), "") << "nothing where no terminal is";
  const std::string asked = on_terminal("(sleep 0.7; cat cube.obj) | pdepth depth - box:1,1,1 > out");
  EXPECT_NE(asked.find("reading - and box:1,1,1"), std::string::npos) << asked;
  EXPECT_TRUE(asked.ends_with("\r\x1b[K")) << "the line is taken away: " << asked;
}

TEST_F(Newcomer, FindsQueriesVersionAndSchema) {
  EXPECT_EQ(shell("pdepth query --list"), 0);
  for (const query::QueryEntry& entry : query::queries()) {
    EXPECT_NE(read("out").find("  " + std::string(entry.name) + " "), std::string::npos) << entry.name;
  }
  EXPECT_TRUE(json_of("pdepth query --schema").at("$defs").contains("error_code"));
  EXPECT_EQ(shell("pdepth --version"), 0);
  EXPECT_NE(read("out").find(", commit "), std::string::npos) << read("out");
}

struct Mistake {
  const char* typed;
  const char* answer;  ///< words of the complaint
};

TEST_F(Newcomer, IsToldWhatIsWrongAndWhatWouldBeRight) {
  write("part.stl",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n# not the text of an STL\n");
  write("list.json", "[[0,0],[1,0],[1,1]]\n");
  write("empty.off", "");
  write("big.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n");
  write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n");
  write("inf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 inf\nf 1 2 3\nf 1 2 4\n");
  write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n");
  write("square.json", R"({"outer":[[0,0],[1,0],[1,1],[0,1]]})");
  write("bow.json", R"({"outer":[[0,0],[4,4],[4,0],[0,4]]})");
  std::filesystem::create_directory(path() / "folder");
  constexpr Mistake kMistakes[] = {
      {"pdepth deph a b", R"(no subcommand "deph"; did you mean "depth"?)"},
      {"pdepth --verson", "there is no option --verson; did you mean --version?"},
      {"pdepth depth", "A is missing: Body that moves"},
      {"pdepth depth cube.obj", "B is missing: Body that stays"},
      {"pdepth depth a b --jsn", "there is no option --jsn; did you mean --json?"},
      {"pdepth depth a b -json", "there is no option -json; did you mean --json?"},
      {"pdepth depth a b --pose 1,2,3", "there is no option --pose; did you mean --pose-a?"},
      {"pdepth depth my cube.obj box:1,1,1", "box:1,1,1 is one word too many; a name with blanks needs quotes"},
      {"pdepth depth sphere:1 sphere:1 --pose-b 1 2 3", "2 and 3 are words too many"},
      {"pdepth depth sphere:1 sphere:1 --margin 1mm", R"(--margin: "1mm" is no number)"},
      {"pdepth depth sphere:1 sphere:1 --margin -1", "--margin: -1 must be 0 or more"},
      {"pdepth depth sphere:1 sphere:1 --delta 5", "--delta: 5 must lie in [1e-06, 1]"},
      {"pdepth depth sphere:1 sphere:1 --method overlap",
       R"(--method: there is no "overlap"; did you mean "overlay"?)"},
      {"pdepth depth sphere:1 sphere:1 --pose-b 0,0,0,0,0,0,90", "a unit quaternion w,x,y,z"},
      {"pdepth depth cube:1 box:1,1,1", "neither a file nor a primitive; the primitives are box:X,Y,Z, sphere:R"},
      {"pdepth depth Box:1,1,1 box:1,1,1", "neither a file nor a primitive"},
      {"pdepth depth box:1 box:1,1,1", "expected is box:X,Y,Z, half extents"},
      {"pdepth depth sphere:0 box:1,1,1", "sphere:R is the radius"},
      {"pdepth depth folder box:1,1,1", "folder: a folder; a file is expected"},
      {"pdepth check folder", "folder: a folder; a file is expected"},
      {"pdepth check part.stl", "neither a text STL"},
      {"pdepth simplify cube.obj", "--output is missing: The hull, as OBJ"},
      {"pdepth simplify cube.obj -o x.obj --epsilon 1mm", R"(--epsilon: "1mm" is no number)"},
      {"pdepth simplify cube.obj -o x.obj --side out", R"(there is no "out"; did you mean)"},
      {"pdepth audit", "RECORD is missing: The record, JSON lines"},
      {"pdepth audit r.jsonl --report", "--report needs a value: Write report.html"},
      {"pdepth query --threads many", R"(--threads: "many" is no number)"},
      {"pdepth query --max-time 0.5", "--max-time: 0.5 must be a whole number"},
      {"pdepth check - < cube.obj", "-: a file is expected; `pdepth depth` alone reads a mesh from standard input"},
      {"pdepth check empty.off", "empty.off: the file is empty"},
      {"pdepth query --record-above 3 lines.jsonl", "--record-above requires --record"},
      {"pdepth depth a b --direction 1,0,0 --method grid", "--direction and --method do not go together"},
      {"pdepth polygon list.json list.json", R"(the file must be one JSON object, {"outer": [[x,y],...]})"},
      {"pdepth minimise none.jsonl --predicate true", "none.jsonl: there is no such file"},
      {"pdepth accuracy --recorder none", "none: no recorder"},
      {"pdepth accuracy --seed -1", "--seed: -1 must lie in [0, 9007199254740992]"},
      {"pdepth accuracy --seed 99999999999999999999999", "must lie in [0, 9007199254740992]"},
      {"pdepth demo difference --seed -1", "--seed: -1 must lie in [0, 9007199254740992]"},
      {"pdepth depth box:1,1,1 sphere:1 --pose-b ''", "--pose-b is empty: Where B stands"},
      {"pdepth depth box:1,1,1 sphere:1 --direction ''", "--direction is empty: How far A must move"},
      {"pdepth depth box:1,1,1 sphere:1 --pose-b ,", "a pose is x,y,z with no rotation"},
      {"pdepth depth '' box:1,1,1", "A is empty: Body that moves"},
      {"pdepth query ''", "FILE is empty: Lines to answer"},
      {"pdepth check ''", "FILE is empty: Mesh or points"},
      {"pdepth --json depth box:1,1,1 sphere:1", "--json belongs behind `depth`"},
      {"pdepth --jsn depth box:1,1,1 sphere:1", "there is no option --jsn"},
      {"pdepth decompose cube.obj -o -", "-: meshes are written as OBJ"},
      {"pdepth depth cube.obj box:1,1,1 --trace -", "--trace: - names no file; /dev/stdout is standard output"},
      {"pdepth depth cube.obj cube.obj --trace a.png --picture ./a.png",
       "--trace and --picture name one file, ./a.png"},
      {"pdepth simplify cube.obj --epsilon 2 -o o.obj", "--epsilon: 2 must lie in [1e-06, 1)"},
      {"pdepth simplify cube.obj --epsilon 1 -o o.obj", "--epsilon: 1 must lie in [1e-06, 1)"},
      {"pdepth simplify cube.obj --epsilon 1e-7 -o o.obj", "--epsilon: 1e-7 must lie in [1e-06, 1)"},
      {"pdepth simplify flat.obj -o o.obj",
       "flat.obj: the body is flat, or within rounding of a flat one; it must have an interior in R^3\n"},
      {"pdepth decompose points.obj -o o.obj",
       "there are points alone; or ask for the convex hull of its vertices (`pdepth simplify`)\n"},
      {"pdepth check inf.obj", "inf.obj: vertices[3]: coordinates must be finite numbers\n"},
      {"pdepth depth inf.obj cube.obj", "inf.obj: vertices[3]: "},
      {"pdepth decompose inf.obj -o o.obj", "inf.obj: vertices[3]: "},
      {"pdepth check cube.obj --fail-on closed", R"(there is no "closed"; known: solid, not_convex, duplicate_points)"},
      {"pdepth check big.ply", "vertices; the limit is 50000000\n"},
      {"pdepth depth big.ply cube.obj", "vertices; the limit is 50000000\n"},
      {"pdepth polygon square.json square.json --complete=foo", R"(there is no "foo"; known: straight, escape)"
                                                                "\n"},
      {"pdepth polygon square.json square.json --place-q 1e308,0", "--place-q: the numbers must be at most 1e300"},
      {"pdepth polygon bow.json square.json", "bow.json: outer[0], the edge from (0.0, 0.0) to (4.0, 4.0): the edges"},
      {"pdepth help --man", "--man needs one folder"},
      {"pdepth help --completion zsh", "--completion takes one word: bash"},
      {"pdepth help --foo", "help has no option --foo"},
      {"pdepth help depth x", "x is one word too many behind `help`"},
      {"pdepth query --list x", "FILE and --list do not go together"},
      {"pdepth query --list --schema", "--list and --schema do not go together"},
  };
  for (const Mistake& mistake : kMistakes) {
    EXPECT_EQ(shell(mistake.typed), 2) << mistake.typed;
    EXPECT_TRUE(says(mistake.answer)) << mistake.typed << ": " << read("err");
  }
}

TEST_F(Newcomer, HasManualPagesAndCompletion) {
  EXPECT_EQ(shell("pdepth help --man pages"), 0);
  EXPECT_EQ(shell("pdepth --help | sed -n 's/^  \\([a-z]*\\)  .*/\\1/p'"), 0);
  std::set<std::string> pages;
  for (const auto& entry : std::filesystem::directory_iterator(path() / "pages")) pages.insert(entry.path().filename());
  for (const char* name : {"pdepth.1", "pdepth-depth.1", "pdepth-query.1", "pdepth-audit.1", "pdepth-simplify.1"}) {
    EXPECT_TRUE(pages.contains(name)) << name;
  }
  const std::string page = read("pages/pdepth-simplify.1");
  for (const char* words : {".TH pdepth-simplify 1", "\\fB\\-\\-epsilon\\fR", "outer|inner", "[0.001]", "Examples:"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words << "\n" << page;
  }
  EXPECT_EQ(shell("grep -qF '\\-\\-complete\\fR[=straight|escape]' pages/pdepth-polygon.1"), 0)
      << read("pages/pdepth-polygon.1");
  EXPECT_EQ(shell("pdepth polygon --help | grep -E '^ *--complete or --complete=WORD$'"), 0) << read("out");
  EXPECT_EQ(shell("pdepth help --completion bash"), 0);
  write("my part.obj", kCubeText);
  write("complete.sh", read("out") + R"(
complete_words() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _pdepth; (IFS='|'; echo "${COMPREPLY[*]}"); }
complete_words pdepth dep
complete_words pdepth simplify --ep
complete_words pdepth simplify scan.ply --side ''
complete_words pdepth check cube
complete_words pdepth help aud
complete_words pdepth check my
complete_words pdepth polygon --com
complete_words pdepth polygon --complete =
complete_words pdepth polygon --complete = str
complete_words pdepth simplify --side = o
complete_words pdepth polygon --complete my
)");
  EXPECT_EQ(shell("bash complete.sh"), 0);
  EXPECT_EQ(read("out"),
            "depth\n--epsilon\nouter|inner\ncube.obj\naudit\nmy part.obj\n"
            "--complete|--complete=straight|--complete=escape\nstraight|escape\nstraight\nouter\nmy part.obj\n")
      << read("err");
}

}  // namespace
}  // namespace pd::test
