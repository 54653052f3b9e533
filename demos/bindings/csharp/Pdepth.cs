// pdepth.h for C#: the structs and functions that Client.cs uses, by P/Invoke.
using System;
using System.Runtime.InteropServices;

static class Pdepth {
  public const int Ok = 0, Touching = 1, Overlapping = 2;
  const string Library = "pdepth";

  public struct Error {
    public int status, reserved;
    public IntPtr message, where;
  }

  public struct Pose {
    public int form, reserved;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 12)] public double[] numbers;
  }

  public struct Question {
    public uint size;
    public int reserved;
    public IntPtr a, b;
    public Pose pose_a, pose_b;
    public IntPtr settings, pair;
  }

  public struct Feature {
    public int kind, part, first, second;
  }

  public struct Vector {
    public double x, y, z;
  }

  public struct Answer {
    public uint size;
    public int status, contact, method, warm, bracket_reached;
    public double depth, lower, upper, distance, distance_lower, distance_upper;
    public Vector translation, normal, witness_a, witness_b;
    public Feature feature_a, feature_b;
    public long support_calls, facets_visited, exact_signs;
  }

  public struct PoseArray {
    public int form, reserved;
    public IntPtr numbers;
    public IntPtr stride;
  }

  public struct Batch {
    public uint size;
    public int threads;
    public long count;
    public IntPtr a, stride_a, b, stride_b;
    public PoseArray poses_a, poses_b;
    public IntPtr settings, pairs, stride_pairs;
  }

  [DllImport(Library)] public static extern IntPtr pdepth_status_name(int status);
  [DllImport(Library)] public static extern int pdepth_last_error(IntPtr context, out Error error);
  [DllImport(Library)] public static extern int pdepth_context_create(IntPtr allocator, out IntPtr context);
  [DllImport(Library)] public static extern void pdepth_context_destroy(IntPtr context);
  [DllImport(Library)] public static extern void pdepth_shape_release(IntPtr shape);
  [DllImport(Library)] public static extern int pdepth_box(IntPtr context, double[] half_extents, out IntPtr shape);
  [DllImport(Library)]
  public static extern int pdepth_depth(IntPtr context, ref Question question, ref Answer answer);
  [DllImport(Library)]
  public static extern int pdepth_depth_batch(IntPtr context, ref Batch batch, [In, Out] Answer[] answers, IntPtr stride);
}
