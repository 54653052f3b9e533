#include "pd/record/pd_record.h"

int main(int argc, char** argv) {
  pd_record record;
  if (argc != 2 || !pd_record_open(&record, argv[1], "my engine 1.0", PD_RECORD_FLOAT32, "m")) return 1;
  const double half_extents[3] = {0.5, 0.5, 0.5};
  const double up[3] = {0, 1, 0};
  pd_record_box(&record, "crate", half_extents, 0); /* every shape once */
  pd_record_plane(&record, "ground", up, 0);
  for (int step = 0; step < 60; ++step) { /* the engine's loop: after its narrow phase, before bodies move */
    record.has_time = 1;
    record.time = step / 60.0;
    pd_record_pose pose = {{0, 0.5 - 0.001 * step, 0}, PD_RECORD_QUATERNION, {0}, {1, 0, 0, 0}};
    const double normal[3] = {0, 1, 0}; /* from B to A */
    const pd_record_report report = {0.001 * step, normal, NULL, 0};
    pd_record_contact(&record, "crate", &pose, "ground", NULL, step > 0 ? &report : NULL); /* NULL: no contact */
  }
  return pd_record_close(&record) ? 0 : 1;
}
