/// @file
/// A stranger's program on the door to MuJoCo: two cubes of a model, their contact by pdepth.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <pd/mujoco/install.hpp>

int main() {
  const char model_text[] =
      "<mujoco><worldbody><body><freejoint/><geom type='box' size='.5 .5 .5'/></body>"
      "<body pos='.75 0 0'><freejoint/><geom type='box' size='.5 .5 .5'/></body></worldbody></mujoco>";
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "cubes.xml", sizeof model_text - 1);
  std::memcpy(files->filedata[0], model_text, sizeof model_text - 1);
  char error[1000] = "";
  mjModel* model = mj_loadXML("cubes.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr || !pd::install_mujoco()) return 1;
  mjData* data = mj_makeData(model);
  mj_forward(model, data);
  double least = 0;
  for (int i = 0; i < data->ncon; ++i) least = std::min(least, static_cast<double>(data->contact[i].dist));
  std::printf("depth %g, %d points, %lld pair answered\n", -least, data->ncon,
              static_cast<long long>(pd::mujoco_report().answered));
  mj_deleteData(data);
  mj_deleteModel(model);
}
