// The stacking and rollback demos end to end: their figures, their files, their manners.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, gone afterwards.
class Demos : public ::testing::Test {
 protected:
  Demos() : folder_(fs::temp_directory_path() / ("pdepth_demo_test_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
  }
  ~Demos() override { fs::remove_all(folder_); }

  /// Exit code of `pdepth demo ARGUMENTS --out FOLDER`.
  int run(const std::string& arguments) const {
    const std::string command = std::string(PDEPTH_PROGRAM) + " demo " + arguments + " --size 320x180 --out " +
                                folder_.string() + " > " + (folder_.string() + ".log") + " 2>&1";
    const int status = std::system(command.c_str());
    fs::remove(folder_.string() + ".log");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json read(const std::string& name) const {
    std::ifstream file(folder_ / name);
    return nlohmann::json::parse(file);
  }
  std::size_t frames() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "frames")) {
      count += entry.path().extension() == ".png" ? 1 : 0;
    }
    return count;
  }

  fs::path folder_;
};

TEST_F(Demos, StackingStandsWhereBulletFalls) {
  // The pile is at rest after some 130 steps.
  ASSERT_EQ(run("stacking --steps 180"), 0);
  const nlohmann::json figures = read("stacking.json");
  ASSERT_EQ(figures.size(), 2u);
  for (const auto& scene : figures) {
    const auto& ours = scene["solvers"][0];
    const auto& theirs = scene["solvers"][1];
    EXPECT_EQ(ours["solver"], "exact");
    EXPECT_EQ(theirs["solver"], "bullet-epa");
    EXPECT_GT(ours["solver_calls_per_step"], 1);
    EXPECT_LT(ours["late_mean_penetration_m"], 2e-4);
    EXPECT_GT(theirs["late_mean_penetration_m"], 5 * double(ours["late_mean_penetration_m"]));
  }
  EXPECT_LT(figures[0]["solvers"][0]["final_drift_m"], 0.003);
  EXPECT_GT(figures[0]["solvers"][1]["final_drift_m"], 0.01);
  EXPECT_EQ(frames(), 2 * (1 + 180 / 8));
  for (const char* name : {"towers_strip.png", "pile_strip.png", "towers_exact.csv", "pile_bullet-epa.csv"}) {
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  }
}

TEST_F(Demos, ABoxKeepsItsSpeedOverAMeshThatBrakesItUnderBullet) {
  ASSERT_EQ(run("stacking --scene slide --steps 60"), 0);
  const nlohmann::json figures = read("stacking.json");
  ASSERT_EQ(figures.size(), 1u);
  const auto& ours = figures[0]["solvers"][0];
  const auto& theirs = figures[0]["solvers"][1];
  EXPECT_NEAR(double(ours["final_forward_speed_m_s"]), 3, 0.005);
  EXPECT_EQ(ours["braking_contacts"], 0);
  EXPECT_LT(double(theirs["final_forward_speed_m_s"]), 2.5);
  EXPECT_GT(theirs["braking_contacts"], 0);
  EXPECT_TRUE(fs::exists(folder_ / "slide_strip.png"));
}

TEST_F(Demos, NoRodPassesAWallOfAMillimetre) {
  ASSERT_EQ(run("rollback --scene foil --steps 6"), 0);
  const nlohmann::json figures = read("rollback.json");
  EXPECT_GT(figures["deepest_plain_m"], 0.1);
  EXPECT_LT(figures["deepest_rollback_m"], 0.005);
}

TEST_F(Demos, ScenesAreChosenByName) {
  EXPECT_EQ(run("stacking --scene list"), 0);
  EXPECT_FALSE(fs::exists(folder_)) << "nothing is drawn";
  EXPECT_EQ(run("stacking --scene foil"), 2);
  EXPECT_EQ(run("dobkin --scene slide"), 2);
  EXPECT_EQ(run("stacking --scene peg --steps 4"), 0);
  EXPECT_EQ(run("stacking --scene gears --steps 4 --force"), 0);
  EXPECT_EQ(read("stacking.json")[0]["scene"], "gears");
  EXPECT_EQ(run("stacking --scene decomposed --steps 2 --force"), 0);
  EXPECT_EQ(read("stacking.json")[0]["bodies"], 50);
}

TEST_F(Demos, RollbackMeetsAtFirstContactAndReplaysTheSameBits) {
  ASSERT_EQ(run("rollback --steps 10"), 0);
  const nlohmann::json figures = read("rollback.json");
  EXPECT_EQ(figures["replay_bit_for_bit"], true);
  EXPECT_GT(figures["deepest_plain_m"], 0.1);
  EXPECT_LT(figures["deepest_rollback_m"], 0.005);
  ASSERT_GE(figures["impacts"].size(), 2u);
  for (const auto& impact : figures["impacts"]) {
    EXPECT_GT(impact["gap_m"], 0);
    EXPECT_LE(impact["gap_m"], 1e-5);
    EXPECT_LE(impact["trials"], 6);
    const auto& exact = impact["methods"][0];
    EXPECT_EQ(exact["hit"], true);
    EXPECT_LE(std::abs(double(exact["depth_then_m"])), 1e-9);
  }
  // In free flight the motion that was searched is the one that was made; a body that leans on another moves otherwise
  // in a shorter step.
  const auto& free_flight = figures["impacts"][0];
  EXPECT_NEAR(double(free_flight["methods"][0]["time_in_step_s"]), double(free_flight["time_in_step_s"]), 1e-5);
  EXPECT_EQ(frames(), 11u);
  EXPECT_TRUE(fs::exists(folder_ / "impact_1.png"));
  EXPECT_TRUE(fs::exists(folder_ / "rollback_strip.png"));
}

TEST_F(Demos, OutputIsNotOverwrittenUnasked) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "mine.txt") << "keep";
  EXPECT_EQ(run("stacking --steps 8"), 2);
  EXPECT_EQ(run("stacking --steps 8 --force"), 0);
  EXPECT_TRUE(fs::exists(folder_ / "mine.txt"));
}

TEST_F(Demos, AFolderThatCannotBeMadeIsNoBadUsage) {
  // README's table: 1, the work could not be finished (output that cannot be written).
  fs::create_directories(folder_.parent_path());
  std::ofstream(folder_) << "a file stands where the folder should be";
  EXPECT_EQ(run("stacking --steps 8"), 1);
  EXPECT_EQ(run("agarwal"), 1);
  fs::remove(folder_);
}

TEST_F(Demos, InterruptLeavesWhatIsDone) {
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execl(PDEPTH_PROGRAM, PDEPTH_PROGRAM, "demo", "stacking", "--steps", "100000", "--size", "320x180", "--out",
          folder_.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  // The signal is sent when the demo has begun its work: its folder is there, its handlers follow within the context's
  // start.
  for (int i = 0; i < 200 && !fs::exists(folder_); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::this_thread::sleep_for(std::chrono::seconds(3));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_EQ(read("stacking.json").size(), 1u);
  EXPECT_TRUE(fs::exists(folder_ / "towers_exact.csv"));
}

}  // namespace
