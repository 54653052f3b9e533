// A depth, a batch and an error through libpdepth from C#.
using System;
using System.Linq;
using System.Runtime.InteropServices;

static class Client {
  static IntPtr context;

  static string ErrorOf(int status) {
    Pdepth.Error error;
    Pdepth.pdepth_last_error(context, out error);
    return Marshal.PtrToStringAnsi(Pdepth.pdepth_status_name(status)) + ": " + Marshal.PtrToStringAnsi(error.message) +
           " (" + Marshal.PtrToStringAnsi(error.where) + ")";
  }

  static void Require(int status) {
    if (status != Pdepth.Ok) throw new ArgumentException(ErrorOf(status));
  }

  static unsafe void Main() {
    IntPtr cube, none;
    if (Pdepth.pdepth_context_create(IntPtr.Zero, out context) != Pdepth.Ok) throw new OutOfMemoryException();
    Require(Pdepth.pdepth_box(context, new[] {0.5, 0.5, 0.5}, out cube));

    // One pair: the cubes overlap by a quarter.
    var question = new Pdepth.Question {size = (uint)Marshal.SizeOf(typeof(Pdepth.Question)), a = cube, b = cube};
    question.pose_a.numbers = new double[12];
    question.pose_b.numbers = new double[12];
    question.pose_b.numbers[0] = 0.75;
    var answer = new Pdepth.Answer {size = (uint)Marshal.SizeOf(typeof(Pdepth.Answer))};
    Require(Pdepth.pdepth_depth(context, ref question, ref answer));
    var way = answer.translation;
    Console.WriteLine("depth {0}, A moves by {1} {2} {3}", answer.depth, way.x, way.y, way.z);

    // A thousand places of B on two threads.
    var positions = Enumerable.Range(0, 3000).Select(i => i % 3 == 0 ? i / 3 / 128.0 : 0).ToArray();
    var answers = new Pdepth.Answer[1000];
    answers[0].size = answer.size;
    fixed (double* numbers = positions) {
      var batch = new Pdepth.Batch {size = (uint)Marshal.SizeOf(typeof(Pdepth.Batch)), threads = 2, count = 1000};
      batch.a = batch.b = new IntPtr(&cube);
      batch.poses_b.numbers = new IntPtr(numbers);
      batch.poses_b.stride = new IntPtr(3 * sizeof(double));
      Require(Pdepth.pdepth_depth_batch(context, ref batch, answers, new IntPtr(answer.size)));
    }
    Console.WriteLine("1000 places: {0} overlap, {1} touch", answers.Count(x => x.contact == Pdepth.Overlapping),
                      answers.Count(x => x.contact == Pdepth.Touching));

    // Bad input is a named error.
    Console.WriteLine(ErrorOf(Pdepth.pdepth_box(context, new[] {0.5, -0.5, 0.5}, out none)));

    Pdepth.pdepth_shape_release(cube);
    Pdepth.pdepth_context_destroy(context);
  }
}
