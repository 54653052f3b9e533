/// @file
/// Measures a call of the C interface beside the C++ call that it makes: the two by turns in one process, the least
/// of many rounds. `c_call_cost [rounds]`.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pdepth/pdepth.h"

namespace {

constexpr int kCalls = 20'000;

double user_nanoseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

template <class Call>
double nanoseconds_a_call(Call&& call) {
  const double start = user_nanoseconds();
  for (int i = 0; i < kCalls; ++i) call(1e-7 * i);
  return (user_nanoseconds() - start) / kCalls;
}

struct Numbers {
  double position[3];
  double rotation[9];
};

pd::Pose pose_of(const Numbers& n, int form) {
  const pd::Vec3 place(n.position[0], n.position[1], n.position[2]);
  if (form == PDEPTH_POSE_QUATERNION_WXYZ) {
    return *pd::Pose::from_quaternion({n.rotation[0], n.rotation[1], n.rotation[2], n.rotation[3]}, place);
  }
  pd::Mat3 rotation = pd::Mat3::Identity();
  if (form == PDEPTH_POSE_MATRIX) {
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = n.rotation[i];
  }
  return *pd::Pose::from_matrix(rotation, place);
}

/// A shape through both doors, and how often it is asked.
struct Door {
  const pd::ConvexShape& shape;
  pdepth_context* context;
  const pdepth_shape* of_c;
  int rounds;
};

/// Prints the least of many rounds of each door, by turns.
void compare(const char* name, const Door& door, int form) {
  const auto& [shape, context, of_c, rounds] = door;
  pd::Scratch scratch;
  const Numbers still{{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Numbers moving = still;
  pdepth_question question{};
  question.size = sizeof question;
  question.a = question.b = of_c;
  question.pose_a.form = question.pose_b.form = form;
  std::copy_n(&still.position[0], 12, question.pose_a.numbers);
  std::copy_n(&still.position[0], 12, question.pose_b.numbers);
  pdepth_answer answer{};
  answer.size = sizeof answer;
  double sum_of_cpp = 0, sum_of_c = 0, made = 1e9, of_cpp = 1e9, through_c = 1e9;
  const pd::Pose ready = pose_of(still, form);
  for (int round = 0; round < rounds; ++round) {
    const auto call_cpp = [&](const pd::Pose& a, const pd::Pose& b) {
      sum_of_cpp += pd::penetration_depth({&shape, a}, {&shape, b}, scratch).depth;
    };
    of_cpp = std::min(of_cpp, nanoseconds_a_call([&](double x) {
                        call_cpp(ready, pd::Pose::from_trusted_matrix(ready.rotation(), {0.9 + x, 0.1, 0}));
                      }));
    made = std::min(made, nanoseconds_a_call([&](double x) {
                      moving.position[0] = 0.9 + x, moving.position[1] = 0.1;
                      call_cpp(pose_of(still, form), pose_of(moving, form));
                    }));
    through_c = std::min(through_c, nanoseconds_a_call([&](double x) {
                           question.pose_b.numbers[0] = 0.9 + x, question.pose_b.numbers[1] = 0.1;
                           pdepth_depth(context, &question, &answer);
                           sum_of_c += answer.depth;
                         }));
  }
  std::printf("%-34s C++ %7.1f ns, with poses from numbers %7.1f ns, C %7.1f ns: %+6.1f ns\n", name, of_cpp, made,
              through_c, through_c - made);
  if (sum_of_cpp == sum_of_c) std::printf(" ");  // keeps the sums
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 20;
  pdepth_context* context = nullptr;
  pdepth_shape *ball = nullptr, *cube = nullptr;
  const double half[3] = {0.5, 0.5, 0.5};
  if (pdepth_context_create(nullptr, &context) != PDEPTH_OK || pdepth_sphere(context, 0.5, &ball) != PDEPTH_OK ||
      pdepth_box(context, half, &cube) != PDEPTH_OK) {
    return 1;
  }
  const pd::ConvexShape sphere = *pd::ConvexShape::sphere(0.5), box = *pd::ConvexPolytope::box({0.5, 0.5, 0.5});
  const Door balls{sphere, context, ball, rounds}, cubes{box, context, cube, rounds};
  compare("two balls, translations", balls, PDEPTH_POSE_TRANSLATION);
  compare("two balls, quaternions", balls, PDEPTH_POSE_QUATERNION_WXYZ);
  compare("two balls, matrices", balls, PDEPTH_POSE_MATRIX);
  compare("two cubes, translations", cubes, PDEPTH_POSE_TRANSLATION);
  compare("two cubes, matrices", cubes, PDEPTH_POSE_MATRIX);
  pdepth_shape_release(ball);
  pdepth_shape_release(cube);
  pdepth_context_destroy(context);
}
