/* A depth, a batch and an error through libpdepth from C99. */
#include <pdepth/pdepth.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROWS = 1000 };

/* Ends the program with the reason where a call has failed. */
static void require(pdepth_context* context, pdepth_status status) {
  if (status == PDEPTH_OK) return;
  pdepth_error error = {0};
  pdepth_last_error(context, &error);
  fprintf(stderr, "%s: %s (%s)\n", pdepth_status_name(status), error.message, error.where);
  exit(1);
}

int main(void) {
  static double positions[ROWS][3];
  static pdepth_answer answers[ROWS];
  const double half[3] = {0.5, 0.5, 0.5}, wrong[3] = {0.5, -0.5, 0.5};
  pdepth_context* context = NULL;
  pdepth_shape *cube = NULL, *none = NULL;
  if (pdepth_context_create(NULL, &context) != PDEPTH_OK) return 1;
  require(context, pdepth_box(context, half, &cube));

  /* One pair: the cubes overlap by a quarter. */
  pdepth_question question = {.size = sizeof question, .a = cube, .b = cube};
  question.pose_b.numbers[0] = 0.75;
  pdepth_answer answer = {.size = sizeof answer};
  require(context, pdepth_depth(context, &question, &answer));
  printf("depth %g, A moves by %g %g %g\n", answer.depth, answer.translation[0], answer.translation[1],
         answer.translation[2]);

  /* A thousand places of B on two threads. */
  for (int i = 0; i < ROWS; ++i) positions[i][0] = i / 128.0;
  const pdepth_shape* shape = cube;
  pdepth_batch batch = {.size = sizeof batch, .threads = 2, .count = ROWS, .a = &shape, .b = &shape};
  batch.poses_b.numbers = positions[0];
  batch.poses_b.stride = sizeof positions[0];
  answers[0].size = sizeof answers[0];
  require(context, pdepth_depth_batch(context, &batch, answers, sizeof answers[0]));
  int overlapping = 0, touching = 0;
  for (int i = 0; i < ROWS; ++i) {
    overlapping += answers[i].contact == PDEPTH_OVERLAPPING;
    touching += answers[i].contact == PDEPTH_TOUCHING;
  }
  printf("%d places: %d overlap, %d touch\n", (int)ROWS, overlapping, touching);

  /* Bad input is a named error. */
  pdepth_status status = pdepth_box(context, wrong, &none);
  pdepth_error error = {0};
  pdepth_last_error(context, &error);
  printf("%s: %s (%s)\n", pdepth_status_name(status), error.message, error.where);

  pdepth_shape_release(cube);
  pdepth_context_destroy(context);
  return 0;
}
