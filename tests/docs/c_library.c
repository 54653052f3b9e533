/* The samples of the page about C. */
#include <pdepth/pdepth.h>
#include <stdio.h>

/* [fail] */
/* Says why the last call with the context has failed. */
static int fail(pdepth_context* context) {
  pdepth_error error;
  pdepth_last_error(context, &error);
  fprintf(stderr, "%s: %s (%s)\n", pdepth_status_name(error.status), error.message, error.where);
  return 1;
}
/* [/fail] */

static int print_depth(pdepth_context* context) {
  /* [depth] */
  const double half_extents[3] = {0.5, 0.5, 0.5};
  pdepth_shape* cube = NULL;
  if (pdepth_box(context, half_extents, &cube) != PDEPTH_OK) return fail(context);

  pdepth_question question = {.size = sizeof question, .a = cube, .b = cube};
  question.pose_b.numbers[0] = 0.75; /* a pose of zeros is the identity */
  pdepth_answer answer = {.size = sizeof answer};
  if (pdepth_depth(context, &question, &answer) != PDEPTH_OK) return fail(context);
  printf("depth %.2f, A moves by %.2f along x\n", answer.depth, answer.translation[0]);
  /* [/depth] */
  pdepth_shape_release(cube);
  return 0;
}

/* [batch] */
struct body {
  const pdepth_shape* shape;
  float colour[3];
  double pose[7]; /* position, w, x, y, z */
};

/* Depths of many bodies in a still one, on four threads. */
static pdepth_status depths(pdepth_context* context, const struct body* bodies, int count, const pdepth_shape* still,
                            pdepth_answer* answers) {
  pdepth_batch batch = {.size = sizeof batch, .threads = 4, .count = count};
  batch.a = &bodies->shape;
  batch.stride_a = sizeof *bodies;
  batch.poses_a.form = PDEPTH_POSE_QUATERNION_WXYZ;
  batch.poses_a.numbers = bodies->pose;
  batch.poses_a.stride = sizeof *bodies;
  batch.b = &still; /* a stride of 0: one shape for all rows */
  answers->size = sizeof *answers;
  return pdepth_depth_batch(context, &batch, answers, sizeof *answers);
}
/* [/batch] */

static int print_batch(pdepth_context* context) {
  pdepth_shape* ball = NULL;
  if (pdepth_sphere(context, 1, &ball) != PDEPTH_OK) return fail(context);
  struct body bodies[3] = {{.shape = ball, .pose = {0.5, 0, 0, 1, 0, 0, 0}},
                           {.shape = ball, .pose = {2, 0, 0, 1, 0, 0, 0}},
                           {.shape = ball, .pose = {3, 0, 0, 1, 0, 0, 0}}};
  pdepth_answer answers[3];
  if (depths(context, bodies, 3, ball, answers) != PDEPTH_OK) return fail(context);
  for (int i = 0; i < 3; ++i) printf("ball %d: depth %.2f, distance %.2f\n", i, answers[i].depth, answers[i].distance);
  pdepth_shape_release(ball);
  return 0;
}

int main(void) {
  pdepth_context* context = NULL;
  if (pdepth_context_create(NULL, &context) != PDEPTH_OK) return 1;
  const int failed = print_depth(context) + print_batch(context);
  pdepth_context_destroy(context);
  return failed;
}
