/* A record written from C99: each kind of shape, poses of both kinds, a pair that was missed, strings that need care. */
#include <math.h>
#include <stddef.h>

#include "pd/record/pd_record.h"

static pd_record_pose at(double x, double y, double z) {
  pd_record_pose pose = {{0, 0, 0}, PD_RECORD_NO_ROTATION, {0}, {0}};
  pose.translation[0] = x;
  pose.translation[1] = y;
  pose.translation[2] = z;
  return pose;
}

static void write_shapes(pd_record* record) {
  const double half[3] = {1, 1, 1};
  const double radii[3] = {1, 2, 3};
  const double up[3] = {0, 1, 0};
  const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  pd_record_box(record, "a \"box\"\\\n", half, 0);
  pd_record_sphere(record, "ball", 1);
  pd_record_ellipsoid(record, "egg", radii, 0);
  pd_record_round(record, "pill", "capsule", 0.5, 1, 'y', 0);
  pd_record_round(record, "can", "cylinder", 0.5, 1, 'z', 0.25);
  pd_record_round(record, "hat", "cone", 0.5, 1, 'x', 0);
  pd_record_convex(record, "corner", corners, 4, 0.125);
  pd_record_plane(record, "floor", up, 0);
}

int main(int argc, char** argv) {
  pd_record record;
  const double right[3] = {1, 0, 0};
  const double up[3] = {0, 2, 0};
  const double tenth = 0.1;
  pd_record_pose pose_a;
  pd_record_pose pose_b;
  if (argc < 2) return 2;
  if (!pd_record_open(&record, argv[1], "an engine, written in C", PD_RECORD_FLOAT64, "mm")) return 1;
  write_shapes(&record);

  /* 0: two boxes, 0.1 deep along x, B turned by a quarter about x. */
  {
    const double on_a[3] = {0, 0.25, 0.25};
    const pd_record_point point = {on_a, NULL, tenth};
    const pd_record_report report = {tenth, right, &point, 1};
    pose_a = at(1, 0, 0);
    pose_b = at(-0.9, 0, 0);
    pose_b.rotation = PD_RECORD_QUATERNION;
    pose_b.quaternion_wxyz[0] = sqrt(0.5);
    pose_b.quaternion_wxyz[1] = sqrt(0.5);
    pd_record_contact(&record, "a \"box\"\\\n", &pose_a, "a \"box\"\\\n", &pose_b, &report);
  }
  /* 1: a ball on the floor, given by a matrix. 2: the same, not seen. */
  {
    const pd_record_report report = {0.25, up, NULL, 0};
    pose_a = at(100, 0.75, 0);
    pose_a.rotation = PD_RECORD_MATRIX;
    pose_a.matrix_row_major[1] = pose_a.matrix_row_major[5] = pose_a.matrix_row_major[6] = 1;
    record.has_time = 1;
    record.time = 1e-300;
    pd_record_contact(&record, "ball", &pose_a, "floor", NULL, &report);
    pd_record_contact(&record, "ball", &pose_a, "floor", NULL, NULL);
  }
  /* 3 to 7: the other shapes, each in a ball above it: reported for the first three, 0.1 deep. */
  {
    const char* shapes[5] = {"egg", "pill", "can", "hat", "corner"};
    const double heights[5] = {2, 1.5, 0.75, 0.25, 1.125};
    size_t i;
    for (i = 0; i < 5; ++i) {
      const pd_record_report report = {i < 3 ? tenth : 0, NULL, NULL, 0};
      pose_a = at(0, heights[i] + 1 - 0.1, 0);
      pd_record_contact(&record, "ball", &pose_a, shapes[i], NULL, &report);
    }
  }
  /* 8: not a number, which the audit refuses by name. */
  pose_a = at(0, (double)NAN, 0);
  pd_record_contact(&record, "ball", &pose_a, "floor", NULL, NULL);
  return pd_record_close(&record) ? 0 : 1;
}
