/// @file
/// What the command writes: whole or not at all, never over its own input, and nothing of a name that a terminal obeys.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pd/numeric/whole_file.hpp"
#include "protocol_lines.hpp"
#include "support/printable.hpp"
#include "temporary_folder.hpp"

namespace pd::test {
namespace {

constexpr const char* kCubeText =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
constexpr const char* kSquareText = R"({"outer":[[0,0],[1,0],[1,1],[0,1]]})";
constexpr const char* kFaultyRecord =
    R"({"record":"pdepth-contacts/1","engine":"none","scalar":"float64"})"
    "\n"
    R"({"shape":"s","is":{"type":"box","half_extents":[1,1,1]}})"
    "\n"
    R"({"contact":1,"a":"s","b":"s","pose_b":{"translation":[1.5,0,0]},"reported":{"depth":0.25,"normal":[-1,0,0]}})"
    "\n";

class Outputs : public ::testing::Test, protected TemporaryFolder {
 protected:
  void SetUp() override {
    write("cube.obj", kCubeText);
    write("square.json", kSquareText);
    write("record.jsonl", kFaultyRecord);
    write("lines.jsonl", std::string(R"({"query":"hull","a":)") + kUnitBox + "}\n");
  }

  /// Runs the program with what follows its name. @return its exit code
  int run(const std::string& arguments) {
    const int status =
        std::system(("cd '" + path().string() + "' && '" PDEPTH_PROGRAM "' " + arguments + " 2> err").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::vector<std::string> parts_left() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path())) {
      if (entry.path().filename().string().starts_with(".pdepth-")) names.push_back(entry.path().string());
    }
    return names;
  }
};

constexpr const char* kAnswering[] = {"depth cube.obj cube.obj",
                                      "depth cube.obj cube.obj --json",
                                      "depth box:1,1,1 sphere:1 --direction 0,0,1",
                                      "polygon square.json square.json",
                                      "polygon square.json square.json --json",
                                      "query lines.jsonl",
                                      "query lines.jsonl --threads 2",
                                      "query --list",
                                      "query --schema",
                                      "help --completion bash",
                                      "query lines.jsonl --max-time 10000",
                                      "simplify cube.obj -o small.obj",
                                      "audit record.jsonl",
                                      "audit record.jsonl --json",
                                      "minimise lines.jsonl --predicate true",
                                      "--help",
                                      "--version",
                                      "--licenses",
                                      "depth --help"};

TEST_F(Outputs, AFullOrClosedStandardOutputIsOne) {
  for (const char* arguments : kAnswering) {
    EXPECT_EQ(run(std::string(arguments) + " > out"), 0) << arguments << "\n" << read("err");
    for (const char* output : {" > /dev/full", " >&-"}) {
      EXPECT_EQ(run(arguments + std::string(output)), 1) << arguments << output;
      EXPECT_NE(read("err").find("cannot be written"), std::string::npos) << arguments << output << read("err");
    }
  }
}

TEST_F(Outputs, FullFilesAreOne) {
  for (const char* arguments :
       {"depth cube.obj cube.obj --method expansion --trace /dev/full", "simplify cube.obj -o /dev/full",
        "audit record.jsonl --csv /dev/full", "audit record.jsonl --junit /dev/full",
        "query lines.jsonl --record /dev/full", "simplify cube.obj -o /nowhere/small.obj"}) {
    EXPECT_EQ(run(arguments + std::string(" > out")), 1) << arguments << "\n" << read("err");
  }
}

/// In /sys nobody makes files, root neither. The reason depends on how it is mounted, and is none of those of missing
/// names.
TEST_F(Outputs, APlaceWhereNobodyMayWriteIsTold) {
  if (!std::filesystem::is_directory("/sys")) GTEST_SKIP() << "/sys is not here";
  for (const char* arguments : {"query lines.jsonl --record /sys/pdepth_x", "audit record.jsonl --report /sys/pdepth_x",
                                "audit record.jsonl --junit /sys/pdepth_x", "help --man /sys/pdepth_x",
                                "depth cube.obj cube.obj --picture /sys/pdepth_x.png"}) {
    EXPECT_EQ(run(arguments + std::string(" > out")), 1) << arguments;
    const std::string told = read("err");
    EXPECT_TRUE(told.find("Permission denied") != std::string::npos ||
                told.find("Operation not permitted") != std::string::npos ||
                told.find("Read-only file system") != std::string::npos)
        << arguments << "\n"
        << told;
  }
}

TEST_F(Outputs, AMissingInputIsToldInTheSameWords) {
  for (const char* command : {"depth none.obj cube.obj", "check none.obj", "query none.obj", "audit none.obj"}) {
    EXPECT_EQ(run(command + std::string(" > out")), 2) << command;
    EXPECT_NE(read("err").find("none.obj: there is no such file"), std::string::npos) << command << read("err");
  }
}

TEST_F(Outputs, AMissingFolderForTemporaryFilesIsTold) {
  write("recorder", "#!/bin/sh\n[ \"$1\" != --list ] || echo somebody\n");
  std::filesystem::permissions(path() / "recorder", std::filesystem::perms::owner_all);
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  for (const std::string folder : {"/nowhere", "/sys"}) {
    ::setenv("TMPDIR", folder.c_str(), 1);
    EXPECT_EQ(run("accuracy --recorder ./recorder --pairs 1 --families box > out"), 2);
    EXPECT_NE(read("err").find(folder == "/sys" ? "/sys: no temporary file" : "TMPDIR names no folder"),
              std::string::npos)
        << read("err");
  }
  if (before == nullptr) {
    ::unsetenv("TMPDIR");
  } else {
    ::setenv("TMPDIR", kept.c_str(), 1);
  }
}

TEST_F(Outputs, AMissingFolderIsNotMade) {
  std::filesystem::create_directory(path() / "folder");
  for (const std::string arguments :
       {"depth cube.obj cube.obj --trace ", "depth cube.obj cube.obj --picture ", "simplify cube.obj -o ",
        "simplify cube.obj -o small.obj --picture ", "decompose cube.obj -o ",
        "polygon square.json square.json --picture ", "audit record.jsonl --csv ", "audit record.jsonl --junit ",
        "query lines.jsonl --record "}) {
    const std::string ending = arguments.ends_with("--picture ") ? ".png" : arguments.ends_with("-o ") ? ".obj" : "";
    EXPECT_EQ(run(arguments + "none/x" + ending + " > out"), 1) << arguments;
    EXPECT_NE(read("err").find("none/x" + ending + " cannot be written: there is no folder none (--"),
              std::string::npos)
        << arguments << read("err");
    EXPECT_FALSE(std::filesystem::exists(path() / "none")) << arguments;
    if (!ending.empty()) continue;
    EXPECT_EQ(run(arguments + "folder > out"), 1) << arguments;
    EXPECT_NE(read("err").find("folder cannot be written: a folder has this name (--"), std::string::npos)
        << arguments << read("err");
  }
  EXPECT_EQ(run("simplify cube.obj -o /dev/full > out"), 1);
  EXPECT_NE(read("err").find("/dev/full cannot be written: No space left on device (--output)"), std::string::npos)
      << read("err");
  for (const char* threads : {"", " --threads 2"}) {
    EXPECT_EQ(run(std::string("query lines.jsonl --record /dev/full > out") + threads), 1);
    EXPECT_NE(read("err").find("/dev/full cannot be written: No space left on device (--record)"), std::string::npos)
        << read("err");
  }
}

TEST_F(Outputs, AFullOutputIsSaidOnce) {
  for (const char* arguments : {"query --schema", "query --list", "help --completion bash", "--licenses"}) {
    EXPECT_EQ(run(arguments + std::string(" > /dev/full")), 1) << arguments;
    const std::string said = read("err");
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << arguments << said;
    EXPECT_NE(said.find("No space left on device"), std::string::npos) << arguments << said;
  }
}

TEST_F(Outputs, AReaderThatHasEnoughEndsTheCommand) {
  const std::string command = "cd '" + path().string() +
                              "' && bash -c 'set -o pipefail; yes \"$(cat lines.jsonl)\" | \"" PDEPTH_PROGRAM
                              "\" query | head -1 > out'";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 141);
  EXPECT_NE(read("out").find("facets"), std::string::npos) << read("out");
}

TEST_F(Outputs, NoCommandWritesOverItsInput) {
  std::filesystem::create_hard_link(path() / "cube.obj", path() / "hard.obj");
  std::filesystem::create_symlink("cube.obj", path() / "soft.obj");
  std::filesystem::create_symlink("record.jsonl", path() / "soft.jsonl");
  for (const char* arguments : {"simplify cube.obj -o cube.obj", "simplify cube.obj -o hard.obj",
                                "simplify cube.obj -o ./soft.obj", "depth cube.obj cube.obj --trace cube.obj",
                                "depth soft.obj cube.obj --trace hard.obj", "audit record.jsonl --csv record.jsonl",
                                "audit record.jsonl --junit soft.jsonl", "audit - --csv record.jsonl < record.jsonl"}) {
    EXPECT_EQ(run(arguments + std::string(" > out")), 2) << arguments;
    EXPECT_NE(read("err").find("itself"), std::string::npos) << arguments << read("err");
    EXPECT_EQ(read("cube.obj"), kCubeText) << arguments;
    EXPECT_EQ(read("record.jsonl"), kFaultyRecord) << arguments;
  }
}

TEST_F(Outputs, AForeignPageStays) {
  std::filesystem::create_directories(path() / "site");
  std::filesystem::create_directories(path() / "linked");
  write("site/report.html", "<html>mine</html>");
  write("precious", "precious");
  std::filesystem::create_symlink("../precious", path() / "linked" / "report.html");
  for (const char* folder : {"site", "linked"}) {
    EXPECT_EQ(run(std::string("audit record.jsonl --report ") + folder + " > out"), 2);
    EXPECT_NE(read("err").find("--force"), std::string::npos) << read("err");
  }
  EXPECT_EQ(read("site/report.html"), "<html>mine</html>");
  EXPECT_EQ(read("precious"), "precious");
  for (const char* folder : {"site", "linked"}) {
    EXPECT_EQ(run(std::string("audit record.jsonl --force --report ") + folder + " > out"), 0) << read("err");
    EXPECT_NE(read(std::string(folder) + "/report.html").find("<!DOCTYPE html>"), std::string::npos);
  }
  EXPECT_EQ(read("precious"), "precious") << "the link is replaced, not what it names";
  // A page of ours is replaced without a word, as a nightly job needs it.
  EXPECT_EQ(run("audit record.jsonl --report site > out"), 0) << read("err");
  EXPECT_NE(read("out").find("site/report.html"), std::string::npos);
}

TEST_F(Outputs, NamesAreShownWithoutControlCharacters) {
  const std::string name = "a\nv 9 9 9\x1b[31m\xC2\x9B.obj";
  write(name, kCubeText);
  EXPECT_EQ(run("simplify \"$(printf 'a\\nv 9 9 9\\033[31m\\302\\233.obj')\" -o small.obj > out"), 0) << read("err");
  const auto harmless = [](const std::string& text) {
    return text.find('\x1b') == std::string::npos && text.find("\xC2\x9B") == std::string::npos;
  };
  EXPECT_EQ(read("small.obj").find("\nv 9 9 9"), std::string::npos) << read("small.obj");
  EXPECT_TRUE(harmless(read("small.obj")));
  EXPECT_TRUE(harmless(read("out"))) << read("out");
  const std::string quoted = "\"$(printf 'a\\nv 9 9 9\\033[31m\\302\\233.obj')\"";
  for (const std::string& arguments : {"depth " + quoted + " cube.obj", "check " + quoted, "check --json " + quoted,
                                       "decompose " + quoted + " --error 0.1 -o parts.obj"}) {
    EXPECT_EQ(run(arguments + " > out"), 0) << arguments << read("err");
    EXPECT_TRUE(harmless(read("out"))) << arguments << read("out");
  }
  EXPECT_TRUE(harmless(read("parts.obj")));
  for (const char* arguments :
       {"depth \"$(printf 'no\\033[2Jsuch')\" cube.obj", "\"$(printf 'de\\033[2Jph')\"",
        "query \"$(printf 'no\\033[2J')\"", "depth cube.obj cube.obj --method \"$(printf 'x\\033[2J')\"",
        "audit \"$(printf 'no\\033[2J')\""}) {
    EXPECT_EQ(run(arguments + std::string(" > out")), 2) << arguments;
    EXPECT_TRUE(harmless(read("err"))) << arguments << read("err");
  }
}

TEST_F(Outputs, PagesHoldTheLicenceOfTheCodeInThem) {
  EXPECT_EQ(run("--licenses > out"), 0);
  for (const char* words : {"three.js authors", "Permission is hereby granted", "WITHOUT WARRANTY OF ANY KIND"}) {
    EXPECT_NE(read("out").find(words), std::string::npos) << words;
  }
  ASSERT_EQ(run("audit record.jsonl > out"), 0) << read("err");
  EXPECT_NE(read("out").find("--report DIR"), std::string::npos) << read("out");
  ASSERT_EQ(run("audit record.jsonl --report page > out"), 0) << read("err");
  EXPECT_EQ(read("out").find("--report DIR"), std::string::npos) << "the page is there";
  const std::string page = read("page/report.html");
  ASSERT_NE(page.find("THREE="), std::string::npos) << "the page turns a pair";
  const std::size_t code = page.find("var THREE=");
  const std::size_t licence = page.find("Permission is hereby granted");
  EXPECT_LT(licence, code);
  EXPECT_LT(page.find("three.js authors"), code);
}

TEST_F(Outputs, AWholeFileIsThereOrNot) {
  const std::filesystem::path file = path() / "whole.txt";
  {
    WholeFile dropped(file);
    dropped.write("half");
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  ASSERT_TRUE(write_whole_file(file, "one"));
  EXPECT_EQ(read("whole.txt"), "one");
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  {
    WholeFile first(file), second(file);  // two writers: one of them wins, whole
    first.write("first");
    second.write("second");
    EXPECT_EQ(read("whole.txt"), "one");
    EXPECT_TRUE(first.finish());
    EXPECT_TRUE(second.finish());
    EXPECT_FALSE(second.finish());
  }
  EXPECT_EQ(read("whole.txt"), "second");
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink("whole.txt", path() / "link");
  EXPECT_TRUE(write_whole_file(path() / "link", "through"));
  EXPECT_TRUE(std::filesystem::is_symlink(path() / "link"));
  EXPECT_EQ(read("whole.txt"), "through");
  EXPECT_TRUE(write_whole_file("/dev/null", "gone"));
  EXPECT_FALSE(write_whole_file("/dev/full", "full"));
  EXPECT_FALSE(write_whole_file("/nowhere/file", "x"));
  EXPECT_FALSE(write_whole_file(path(), "a folder"));
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  EXPECT_FALSE(write_whole_file(file, "against the owner's word"));
  EXPECT_EQ(read("whole.txt"), "through");
  EXPECT_TRUE(parts_left().empty());
}

TEST(Printable, KeepsLettersAndShowsTheRest) {
  EXPECT_EQ(printable("part \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80.obj"),
            "part \xC3\xA9 \xE2\x82\xAC \xF0\x9F\x98\x80.obj");
  EXPECT_EQ(printable("a\nb\x1b\x7f"), "a\\x0ab\\x1b\\x7f");
  EXPECT_EQ(printable("a\nb\r", "\n"), "a\nb\\x0d");
  EXPECT_EQ(printable("\xE2\x80\xAE\xE2\x81\xA9\xE2\x80\xA6"), "\\xe2\\x80\\xae\\xe2\\x81\\xa9\xE2\x80\xA6");
  EXPECT_EQ(printable("\xC2\x9B\x9B\xC2\xA0\xFF\xE2\x82"), "\\xc2\\x9b\\x9b\xC2\xA0\\xff\\xe2\\x82");
}

TEST_F(Outputs, NewcomersAreHelped) {
  EXPECT_EQ(run("deph a b > out"), 2);
  EXPECT_NE(read("err").find("did you mean \"depth\"?"), std::string::npos) << read("err");
  EXPECT_EQ(run("qurey > out"), 2);
  EXPECT_NE(read("err").find("did you mean \"query\"?"), std::string::npos) << read("err");
  EXPECT_EQ(run("dance > out"), 2);
  EXPECT_EQ(read("err").find("did you mean"), std::string::npos) << read("err");
  EXPECT_EQ(run("> out"), 2);
  EXPECT_NE(read("out").find("simplify"), std::string::npos);
  EXPECT_EQ(run("help depth > out"), 0);
  EXPECT_NE(read("out").find("--pose-a"), std::string::npos);
  EXPECT_EQ(run("help > out"), 0);
  EXPECT_NE(read("out").find("simplify"), std::string::npos);
  EXPECT_EQ(run("help dance > out"), 2);
  EXPECT_EQ(run("audit cube.obj > out"), 2);
  EXPECT_NE(read("err").find("no record"), std::string::npos) << read("err");
  EXPECT_EQ(run("query cube.obj > out"), 2);
  EXPECT_NE(read("err").find("is a mesh"), std::string::npos) << read("err");
  EXPECT_EQ(read("out"), "") << "one sentence, and no answer for each line of the mesh";
  EXPECT_EQ(run("simplify cube.obj -o small.stl > out"), 2);
  EXPECT_NE(read("err").find(".obj"), std::string::npos) << read("err");
}

}  // namespace
}  // namespace pd::test
