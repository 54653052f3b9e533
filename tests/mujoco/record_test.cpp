/// @file
/// Records of MuJoCo's contacts: the pairs that its narrow phase was asked about, with what it said.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/contact_recorder.hpp"
#include "pd/mujoco/install.hpp"

namespace pd {
namespace {

std::string whole_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

int count_of(const std::string& text, const std::string& word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

const char* kWorld =
    "<worldbody><geom type='plane' size='1 1 .1'/>"
    "<body pos='0 0 .24'><freejoint/><geom type='box' size='.5 .5 .25'/></body>"
    "<body pos='0 0 .74'><freejoint/><geom type='box' size='.5 .5 .25'/></body>"
    "<body pos='.7 .7 .36'><freejoint/><geom type='capsule' size='.1 .2'/></body></worldbody>";

std::string path_of(const char* name) { return testing::TempDir() + name + std::to_string(mj_version()) + ".jsonl"; }

TEST(MujocoRecord, OneStateInOneCall) {
  const auto model = test::mujoco_model(kWorld);
  const auto data = test::mujoco_data(model);
  mj_forward(model.get(), data.get());
  const int contacts = data->ncon;
  const std::string path = path_of("state");
  unsigned char table[sizeof mjCOLLISIONFUNC];
  std::memcpy(table, mjCOLLISIONFUNC, sizeof table);
  ASSERT_TRUE(record_mujoco(model.get(), data.get(), path.c_str()));
  EXPECT_EQ(std::memcmp(table, mjCOLLISIONFUNC, sizeof table), 0);
  EXPECT_EQ(data->ncon, contacts);
  const std::string text = whole_file(path);
  EXPECT_NE(text.find("\"engine\":\"MuJoCo " + std::string(mj_versionString())), std::string::npos);
  EXPECT_EQ(count_of(text, "{\"shape\":"), 3) << "two boxes of one size are one shape";
  EXPECT_EQ(count_of(text, "\"reported\":{\"depth\":0.01"), 1) << "the lower box in the plane: " << text;
  EXPECT_EQ(count_of(text, "\"normal\":[-0,-0,-1]"), 2) << "from B, the upper one, to A";
  EXPECT_GE(count_of(text, "\"reported\":null"), 1) << "the capsule and a box were looked at";
  EXPECT_FALSE(record_mujoco(model.get(), data.get(), "/nowhere/contacts.jsonl"));
  std::remove(path.c_str());
}

TEST(MujocoRecord, ARunOfStepsWithWhoeverAnswers) {
  const auto model = test::mujoco_model(kWorld);
  const auto data = test::mujoco_data(model);
  const std::string path = path_of("run");
  ASSERT_TRUE(install_mujoco());
  {
    MujocoRecorder recorder(model.get(), path.c_str());
    ASSERT_TRUE(recorder.good());
    EXPECT_FALSE(MujocoRecorder(model.get(), path.c_str()).good()) << "one recorder a model";
    const auto other = test::mujoco_data(model);
    for (int step = 0; step < 10; ++step) mj_step(model.get(), data.get());
    EXPECT_EQ(recorder.contacts(), mujoco_report().answered - recorder.unsupported());
    data->geom_xpos[3] = std::numeric_limits<double>::quiet_NaN();
    const std::int64_t before = recorder.unsupported();
    mj_collision(model.get(), data.get());
    EXPECT_GT(recorder.unsupported(), before);
    EXPECT_TRUE(recorder.close());
    EXPECT_TRUE(recorder.close());
  }
  uninstall_mujoco();
  EXPECT_NE(whole_file(path).find("\"time\":0.002"), std::string::npos);
  std::remove(path.c_str());
}

TEST(MujocoRecord, InstalledAndUninstalledMeanwhile) {
  const auto model = test::mujoco_model(kWorld);
  const auto data = test::mujoco_data(model);
  mj_forward(model.get(), data.get());
  unsigned char table[sizeof mjCOLLISIONFUNC];
  std::memcpy(table, mjCOLLISIONFUNC, sizeof table);
  const std::string path = path_of("meanwhile");
  for (int round = 0; round < 2; ++round) {
    MujocoRecorder recorder(model.get(), path.c_str());
    for (int again = 0; again < 2; ++again) {
      const auto installed = install_mujoco();
      ASSERT_TRUE(installed);
      EXPECT_EQ(*installed, 27);
      const std::int64_t before = recorder.contacts();
      mj_collision(model.get(), data.get());
      EXPECT_GT(mujoco_report().answered, 0);
      EXPECT_EQ(recorder.contacts() - before, mujoco_report().answered);
    }
    // A refused pair is handed on to MuJoCo, and to nobody twice.
    const mjtNum was = data->geom_xmat[9];
    data->geom_xmat[9] = std::numeric_limits<mjtNum>::quiet_NaN();
    const std::int64_t unsupported = recorder.unsupported();
    mj_collision(model.get(), data.get());
    EXPECT_GT(recorder.unsupported(), unsupported);
    data->geom_xmat[9] = was;
    uninstall_mujoco();
    const std::int64_t answered = mujoco_report().answered, before = recorder.contacts();
    mj_collision(model.get(), data.get());
    EXPECT_EQ(mujoco_report().answered, answered);
    EXPECT_GT(recorder.contacts(), before);
    EXPECT_TRUE(recorder.close());
    EXPECT_EQ(std::memcmp(table, mjCOLLISIONFUNC, sizeof table), 0);
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace pd
