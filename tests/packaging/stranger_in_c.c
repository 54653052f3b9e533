/* A stranger's program on the C interface: two unit cubes, one a quarter deep in the other. */
#include <pdepth/pdepth.h>
#include <stdio.h>

int main(void) {
  const double half[3] = {0.5, 0.5, 0.5};
  pdepth_context* context = NULL;
  pdepth_shape* cube = NULL;
  if (pdepth_context_create(NULL, &context) != PDEPTH_OK || pdepth_box(context, half, &cube) != PDEPTH_OK) return 1;
  pdepth_question question = {.size = sizeof question, .a = cube, .b = cube};
  question.pose_b.numbers[0] = 0.75;
  pdepth_answer answer = {.size = sizeof answer};
  if (pdepth_depth(context, &question, &answer) != PDEPTH_OK) return 1;
  printf("depth %g\n", answer.depth);
  pdepth_shape_release(cube);
  pdepth_context_destroy(context);
  return 0;
}
