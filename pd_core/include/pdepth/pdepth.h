/// @file
/// The C interface of pdepth: exact, certified penetration depth of bodies. C99 and C++98 read this header.
///
/// Every query is the C++ library's own, and every answer has its bits. A moves by `translation`, B stays; `normal` is
/// the way on which A leaves B. Lengths are in the unit of the input. Points and directions are in the frame that the
/// two poses share.
///
/// Rules that hold for every function:
/// - A function that can fail returns a status, PDEPTH_OK or the reason. `pdepth_last_error` then says what is wrong
///   and where. Nothing throws, aborts or prints.
/// - The first field of a struct with a field `size` is sizeof the struct, set by the caller, so that the struct can
///   grow. All other fields may be 0, which always means the default. C99: `pdepth_question q = {.size = sizeof q};`.
/// - The fields named `reserved` have to be 0; other values are refused.
/// - The library keeps no pointer of a struct or array after the call. It shares ownership of shapes that it needs.
/// - A context or a pair is used by one thread at a time; a second thread gets PDEPTH_IN_USE. Threads may share shapes.
/// - An answer that doubles cannot hold is refused as out_of_range: sizes of bodies may lie too far apart.
/// - If a call fails, its results are not written, except for the rows of a batch.
#ifndef PDEPTH_PDEPTH_H_
#define PDEPTH_PDEPTH_H_

#include <stddef.h>
#include <stdint.h>

#define PDEPTH_VERSION_MAJOR 0
#define PDEPTH_VERSION_MINOR 1
#define PDEPTH_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/// The version of the library at run time: 10000 major + 100 minor + patch.
int32_t pdepth_version(void);

// ---- Status and errors

typedef int32_t pdepth_status;
enum { PDEPTH_OK = 0, PDEPTH_BAD_VALUE = 1, PDEPTH_NON_FINITE = 2, PDEPTH_OUT_OF_RANGE = 3 };
enum { PDEPTH_TOO_FEW_POINTS = 4, PDEPTH_NOT_FULL_DIMENSIONAL = 5, PDEPTH_NOT_CONVEX = 6, PDEPTH_BAD_FACES = 7 };
enum { PDEPTH_NOT_CLOSED = 8, PDEPTH_NOT_A_ROTATION = 9, PDEPTH_ZERO_DIRECTION = 10, PDEPTH_UNBOUNDED = 11 };
enum { PDEPTH_UNSUPPORTED = 12, PDEPTH_LIMIT_EXCEEDED = 13 };
enum {
  PDEPTH_NULL_ARGUMENT = 100,  ///< a pointer that has to name something is NULL
  PDEPTH_OUT_OF_MEMORY = 101,  ///< the allocator returned NULL; the context may be used on
  PDEPTH_IN_USE = 102,         ///< another thread is in a call with the same context or pair
  PDEPTH_INTERNAL = 103        ///< a fault of the library; the message says which
};

/// The word for a status, for example "not_convex". Never NULL; static storage.
const char* pdepth_status_name(pdepth_status status);

/// Everything that a thread keeps between queries: buffers, and the last error. One for each thread.
typedef struct pdepth_context pdepth_context;

typedef struct pdepth_error {
  pdepth_status status;  ///< PDEPTH_OK when no call with the context has failed
  int32_t reserved;
  const char* message;  ///< what is wrong and what would be right
  const char* where;    ///< the argument, for example "points[3]" or "rows[17].pose_a.translation[0]"
} pdepth_error;
/// The error of the last call with this context that failed. A NULL context, and one that another thread uses, leave
/// none. The texts belong to the context and live until the next call that fails, or until the context is destroyed.
pdepth_status pdepth_last_error(const pdepth_context* context, pdepth_error* error);

// ---- Context

/// A source of memory. Both functions may be called from any thread, and must not call this library.
///
/// They and `user` are used until every context and shape made with this allocator is gone.
typedef struct pdepth_allocator {
  uint32_t size;
  uint32_t reserved;
  void* user;
  /// @return memory for `bytes` > 0 at a multiple of `alignment`, a power of two; NULL if there is none.
  void* (*allocate)(void* user, size_t bytes, size_t alignment);
  /// Takes back a block, with the numbers that it was asked for.
  void (*release)(void* user, void* block, size_t bytes, size_t alignment);
} pdepth_allocator;
/// @param allocator  for all memory of the context and of what is made with it; NULL: malloc.
/// The caller owns the context: `pdepth_context_destroy`.
pdepth_status pdepth_context_create(const pdepth_allocator* allocator, pdepth_context** context);
/// Shapes and pairs made with the context live on. NULL is ignored.
void pdepth_context_destroy(pdepth_context* context);

// ---- Poses

enum {
  PDEPTH_POSE_TRANSLATION = 0,      ///< 3 numbers: position. The rotation is the identity.
  PDEPTH_POSE_QUATERNION_WXYZ = 1,  ///< 7 numbers: position, w, x, y, z. | |q| - 1 | <= 1e-6.
  PDEPTH_POSE_QUATERNION_XYZW = 2,  ///< 7 numbers: position, x, y, z, w.
  PDEPTH_POSE_MATRIX = 3            ///< 12 numbers: position, then R by rows. max|R^T R - I| <= 1e-6 and det R > 0.
};

/// world point = R * local + position, in real arithmetic on the stored numbers. All zeros are the identity.
///
/// Coordinates are finite and at most 1e300. Errors: bad_value, non_finite, out_of_range, not_a_rotation.
typedef struct pdepth_pose {
  int32_t form;  ///< PDEPTH_POSE_...
  int32_t reserved;
  double numbers[12];
} pdepth_pose;

// ---- Shapes

/// A body in a frame of its own: immutable, counted by references, shared by any number of threads.
///
/// A function that makes a shape gives the caller one reference, which `pdepth_shape_release` gives back.
typedef struct pdepth_shape pdepth_shape;

/// Takes one more reference. NULL is ignored.
void pdepth_shape_retain(pdepth_shape* shape);
/// Gives one reference back; the last one frees the shape. NULL is ignored.
void pdepth_shape_release(pdepth_shape* shape);

// Errors of sizes: non_finite, bad_value (not above 0), out_of_range (above 1e300; of curved shapes outside 2^-900 to
// 2^900).

/// The box [-h0, h0] x [-h1, h1] x [-h2, h2]; numbers of its points are the bits of (x, y, z) > 0, x lowest.
pdepth_status pdepth_box(pdepth_context* context, const double half_extents[3], pdepth_shape** shape);
pdepth_status pdepth_sphere(pdepth_context* context, double radius, pdepth_shape** shape);
/// {x : sum (x_i / radii_i)^2 <= 1}.
pdepth_status pdepth_ellipsoid(pdepth_context* context, const double radii[3], pdepth_shape** shape);
/// A segment from -half_height to +half_height along the axis (0, 1, 2 = x, y, z), swept by a ball.
pdepth_status pdepth_capsule(pdepth_context* context, double radius, double half_height, int32_t axis,
                             pdepth_shape** shape);
pdepth_status pdepth_cylinder(pdepth_context* context, double radius, double half_height, int32_t axis,
                              pdepth_shape** shape);
/// Base at -half_height, apex at +half_height along the axis.
pdepth_status pdepth_cone(pdepth_context* context, double radius, double half_height, int32_t axis,
                          pdepth_shape** shape);
/// The convex hull of points, of any dimension from a point to a solid.
/// @param points  [count x 3], 1 <= count <= 3e8. Errors: too_few_points, limit_exceeded, non_finite, out_of_range.
/// Time O(n log n), O(n^2) at worst.
pdepth_status pdepth_convex_hull(pdepth_context* context, const double* points, int64_t count, pdepth_shape** shape);

/// Faces over points: face f is the loop vertices[offsets[f]] .. vertices[offsets[f + 1] - 1] of point numbers,
/// counter-clockwise seen from outside.
typedef struct pdepth_faces {
  uint32_t size;
  int32_t reserved;
  const double* points;  ///< [num_points x 3]
  int64_t num_points;
  const int32_t* offsets;  ///< [num_faces + 1], from 0 upwards
  int64_t num_faces;
  const int32_t* vertices;  ///< [offsets[num_faces]]
} pdepth_faces;
/// The solid that the faces bound, which are checked and not trusted. Errors: as `pdepth_convex_hull`, and bad_faces,
/// not_closed, not_convex, not_full_dimensional. Time: that of the hull, and O(c log c) for c corners of faces.
pdepth_status pdepth_convex_faces(pdepth_context* context, const pdepth_faces* faces, pdepth_shape** shape);
/// The solid {x : <n, x> <= offset for all planes}.
/// @param planes  [count x 4]: n (any length), offset; 4 <= count <= 8192. Errors: too_few_points, limit_exceeded,
/// non_finite, out_of_range, zero_direction, unbounded, bad_value (empty), not_full_dimensional. Time O(n^2).
pdepth_status pdepth_halfspaces(pdepth_context* context, const double* planes, int64_t count, pdepth_shape** shape);
/// The convex hull of spheres.
/// @param spheres  [count x 4]: centre, radius >= 0. Time at most O(count + 2^18) a sphere.
pdepth_status pdepth_hull_of_spheres(pdepth_context* context, const double* spheres, int64_t count,
                                     pdepth_shape** shape);
/// The solid that a closed mesh bounds: not convex in general, with cavities and several shells.
/// @param turn_faces  not 0: a mesh that is wholly inside out is turned; 0: it is refused.
/// Errors: as `pdepth_convex_hull`, and bad_faces, not_closed, limit_exceeded; the message begins with the fault
/// (open_edge, flipped_face, not_manifold, self_crossing, inside_out, not_planar, degenerate_face). Time O(n log n).
///
/// Depth and apart, of solids and of a solid and a convex shape that is not flat, ask the mesh itself. All else needs
/// the solid as convex parts, which its first such query cuts: unsupported where no doubles hold their corners,
/// limit_exceeded above 512 parts or 20,000 pieces of faces.
pdepth_status pdepth_mesh_solid(pdepth_context* context, const pdepth_faces* mesh, int32_t turn_faces,
                                pdepth_shape** shape);
/// The shape swept by a ball of radius `margin` >= 0, in addition to the margin that it has.
pdepth_status pdepth_with_margin(pdepth_context* context, const pdepth_shape* body, double margin,
                                 pdepth_shape** shape);

typedef struct pdepth_part {
  const pdepth_shape* shape;
  pdepth_pose pose;  ///< in the compound's frame
} pdepth_part;
/// The union of shapes, which may be compounds themselves: their parts follow each other.
pdepth_status pdepth_compound(pdepth_context* context, const pdepth_part* parts, int64_t count, pdepth_shape** shape);

typedef struct pdepth_shape_info {
  uint32_t size;
  int32_t is_convex;  ///< 0: a compound or a mesh solid
  int32_t parts;      ///< 1 for a convex shape; 0 where the mesh is asked about
  // The rest is about one part. Counts are 0 where its core is curved.
  int32_t dimension;  ///< of the core without its margin: 0 a point, 1 a segment, 2 a polygon, 3 a solid
  int32_t vertices;
  int32_t facets;
  double margin;
} pdepth_shape_info;
enum { PDEPTH_PART_MESH = -1 };  ///< in place of a part: the mesh of a solid, its facets cut into triangles
/// @param part  from 0; 0 for a convex shape. Error: out_of_range. The parts of a solid whose corners no doubles hold
/// lie in the solid, up to rounding.
pdepth_status pdepth_shape_describe(pdepth_context* context, const pdepth_shape* shape, int32_t part,
                                    pdepth_shape_info* info);

/// Room for the facets of a part's core. A NULL array is left out; `pdepth_shape_describe` gives the sizes.
typedef struct pdepth_surface {
  uint32_t size;
  int32_t reserved;
  double* points;    ///< [vertices x 3], in the frame of the shape; rounded for parts of compounds
  int32_t* offsets;  ///< [facets + 1]: facet f is corners[offsets[f]] .. corners[offsets[f + 1] - 1]
  /// [2 (vertices + facets - 2)], 0 without facets, [3 facets] for a mesh: vertices, counter-clockwise from outside.
  int32_t* corners;
} pdepth_surface;
/// Writes the facets, for drawing. Errors: out_of_range; unsupported where the core is curved.
pdepth_status pdepth_shape_surface(pdepth_context* context, const pdepth_shape* shape, int32_t part,
                                   const pdepth_surface* surface);

// ---- Depth

enum {
  PDEPTH_SEPARATED = 0,   ///< the bodies have no common point
  PDEPTH_TOUCHING = 1,    ///< they meet, their interiors do not
  PDEPTH_OVERLAPPING = 2  ///< their interiors meet
};

enum { PDEPTH_METHOD_AUTOMATIC = 0 };  ///< exact for (rounded) polytopes, within (1 + delta) for curved bodies
enum { PDEPTH_METHOD_EXPANSION = 1, PDEPTH_METHOD_OVERLAY = 2, PDEPTH_METHOD_DECOMPOSITION = 3 };
enum { PDEPTH_METHOD_SHALLOW = 4, PDEPTH_METHOD_GRID = 5 };

enum {
  PDEPTH_BRACKET_TIGHTEST = 0,   ///< lower and upper are the exact depth rounded down and up
  PDEPTH_BRACKET_CERTIFIED = 1,  ///< upper - lower within 2e-14 of the size of the numbers given, from doubles: quicker
  /// For physics engines: as fine as `contact_tolerance`, at a bounded cost. A pair that the bracket cannot tell apart
  /// from touching is called touching.
  PDEPTH_BRACKET_CONTACT = 2
};

/// How a depth is asked for. All zeros but the size are the default.
typedef struct pdepth_settings {
  uint32_t size;
  int32_t method;   ///< PDEPTH_METHOD_...; compounds are answered by PDEPTH_METHOD_AUTOMATIC alone
  int32_t bracket;  ///< PDEPTH_BRACKET_...; compounds are answered as tightly as they can be
  /// Not 0: bodies farther apart than `beyond` need not be told apart any further. The answer is then `separated` with
  /// distance_lower > beyond, and witnesses that are no closest points. Compounds ignore it.
  int32_t use_beyond;
  double beyond;
  /// Relative error in (0, 1] where the answer is approximate. 0: 1e-6 for curved bodies, 1e-2 for solids and for
  /// compounds with curved or swept parts, and exact for the rest.
  double delta;
  double contact_tolerance;  ///< for PDEPTH_BRACKET_CONTACT: an interval of this width is narrow enough; >= 0
  uint64_t seed;             ///< the decomposition's random order: times depend on it, answers do not
  int64_t max_points;        ///< budget of a bracket of solids, 5 to 15 us a point; 0: 500,000; >= 0
} pdepth_settings;

/// The memory of one pair of bodies from frame to frame, opaque. It makes the next answer quicker.
///
/// Nothing in it is trusted: a warm answer has the proof of a cold one. Given to another pair of shapes it starts
/// afresh. It shares ownership of the two shapes. Some 4 KB for convex bodies, under 1 MB for large compounds.
typedef struct pdepth_pair pdepth_pair;

pdepth_status pdepth_pair_create(pdepth_context* context, pdepth_pair** pair);
/// Forgets everything.
pdepth_status pdepth_pair_clear(pdepth_context* context, pdepth_pair* pair);
/// NULL is ignored.
void pdepth_pair_destroy(pdepth_pair* pair);

/// Two bodies, where they stand, and how they are asked about.
typedef struct pdepth_question {
  uint32_t size;
  int32_t reserved;
  const pdepth_shape* a;
  const pdepth_shape* b;
  pdepth_pose pose_a;
  pdepth_pose pose_b;
  const pdepth_settings* settings;  ///< NULL: the default
  pdepth_pair* pair;                ///< NULL: no memory
} pdepth_question;

enum { PDEPTH_FEATURE_NONE = 0, PDEPTH_FEATURE_VERTEX = 1, PDEPTH_FEATURE_EDGE = 2, PDEPTH_FEATURE_FACET = 3 };

/// A face of one body, in the library's own numbers; `pdepth_feature_points` leads back to the caller's.
typedef struct pdepth_feature {
  int32_t kind;    ///< PDEPTH_FEATURE_...; none where the body is curved; of overlapping solids often none
  int32_t part;    ///< of a compound, from 0; PDEPTH_PART_MESH: `first` is a face of the caller's mesh
  int32_t first;   ///< vertex, first vertex of the edge, or facet
  int32_t second;  ///< second vertex of the edge, or -1
} pdepth_feature;

typedef struct pdepth_answer {
  uint32_t size;
  pdepth_status status;  ///< what the call returned, for each row of a batch
  int32_t contact;       ///< PDEPTH_SEPARATED, ..., exact for polytopes and swept polytopes
  int32_t method;        ///< that answered
  int32_t warm;          ///< 1: the memory of the pair held
  /// 0: rounding or a budget ended the search with a bracket that is certified, but wider than asked.
  int32_t bracket_reached;
  double depth;  ///< length of the shortest move of A that separates the bodies; 0 unless overlapping
  double lower;  ///< certified: lower <= depth <= upper
  double upper;
  double distance;  ///< 0 unless separated
  double distance_lower;
  double distance_upper;
  double translation[3];  ///< moves A clear of B, exactly as stored
  double normal[3];       ///< unit
  double witness_a[3];    ///< a point of A; witness_b - witness_a = translation
  double witness_b[3];
  pdepth_feature feature_a;
  pdepth_feature feature_b;
  int64_t support_calls;  ///< work done: supports of the difference of the bodies
  int64_t facets_visited;
  int64_t exact_signs;  ///< decisions that needed exact arithmetic, which allocates memory
} pdepth_answer;

/// Penetration depth of two bodies, or their distance when apart.
///
/// Deterministic: the same bits for every run, number of threads, order of vertices and instruction set.
/// Errors: unsupported (the method does not answer for these shapes), bad_value (settings); of compounds out_of_range
/// and limit_exceeded, too.
/// Once the context has grown, two convex bodies allocate nothing, unless exact arithmetic is needed (`exact_signs`).
/// Compounds and solids allocate. Time: near-linear in the number of vertices at worst, as measured; logarithmic for
/// shallow contacts. With compounds: one query for each pair of parts whose boxes meet, then at worst O(m^3 n^3) cuts.
/// Solids: pairs of triangles whose boxes meet; where they overlap, the parts of both, or `max_points` points.
pdepth_status pdepth_depth(pdepth_context* context, const pdepth_question* question, pdepth_answer* answer);

/// Tells if two bodies are apart by more than `distance` >= 0: the question of a broadphase.
/// @param apart  1 if that is certified, else 0. Time: some supports where a plane tells it, else a depth query.
pdepth_status pdepth_apart(pdepth_context* context, const pdepth_question* question, double distance, int32_t* apart);

/// The points of a feature, as numbers of the rows that the shape was made from.
/// @param count  on entry the room in `points`, on return how many points the feature has (0 for none). Points beyond
/// the room are not written. Error: out_of_range for a feature that the shape has not.
pdepth_status pdepth_feature_points(pdepth_context* context, const pdepth_shape* shape, const pdepth_feature* feature,
                                    int32_t* points, int32_t* count);

// ---- Other queries of a pair. Of the settings they use what their comment names.

typedef struct pdepth_directional {
  uint32_t size;
  pdepth_status status;
  int32_t contact;
  int32_t reserved;
  double depth;  ///< the least t >= 0 after which A, moved by t d / |d|, is free of B
  double lower;
  double upper;
  double normal[3];  ///< of the facet through which A leaves; (1, 0, 0) unless overlapping
  pdepth_feature feature_a;
  pdepth_feature feature_b;
} pdepth_directional;
/// Depth along a direction of any length but zero. Exact for polytopes; certified bracket for curved convex bodies.
/// Errors: zero_direction, non_finite; unsupported for compounds with curved or swept parts. No settings, no pair.
/// Time: some 1.3 supports for each doubling of the vertices, as measured.
pdepth_status pdepth_depth_along(pdepth_context* context, const pdepth_question* question, const double direction[3],
                                 pdepth_directional* answer);

typedef struct pdepth_contact_point {
  double position_a[3];  ///< on A's surface
  double position_b[3];  ///< position_b - position_a = depth * normal, up to rounding
  double depth;          ///< > 0 inside, < 0 a gap
  int64_t feature_id;    ///< stays the same while the same two features meet
} pdepth_contact_point;

typedef struct pdepth_manifold {
  uint32_t size;
  pdepth_status status;
  int32_t contact;
  int32_t count;  ///< of the points, 0 to 4
  double normal[3];
  pdepth_contact_point points[4];
} pdepth_manifold;
/// The contact of two convex bodies as at most four pairs of points.
/// @param breaking_threshold  finite, >= 0: pairs of points with a wider gap are left out.
/// Settings and pair: all. Error: unsupported for compounds. Time: a depth query, and O(k m) for faces of k and m
/// vertices.
pdepth_status pdepth_contact_manifold(pdepth_context* context, const pdepth_question* question,
                                      double breaking_threshold, pdepth_manifold* manifold);

/// How a body moves: unit of length and radians per unit of time, common frame.
typedef struct pdepth_motion {
  double linear_velocity[3];
  double angular_velocity[3];
  /// From the point about which the body turns to the origin of its frame, at time 0. The velocity is that point's.
  double arm[3];
} pdepth_motion;

typedef struct pdepth_movement {
  uint32_t size;
  int32_t max_queries;  ///< 0: 1000
  pdepth_motion a;
  pdepth_motion b;
  double duration;            ///< >= 0
  double distance_tolerance;  ///< the gap at which the bodies count as meeting; 0: 1e-9
  double allowed_depth;       ///< >= 0: a hit is to be deeper than this
} pdepth_movement;

typedef struct pdepth_impact {
  uint32_t size;
  int32_t hit;
  int32_t reached;   ///< 0: a gap above the tolerance was left at `time`, and `hit` is 1 to be on the safe side
  int32_t queries;   ///< distance queries made
  double time;       ///< the bodies are apart by at most the tolerance then; the duration without a hit
  double certified;  ///< no contact happens before, proved
} pdepth_impact;
/// When two moving convex bodies first touch; the question's poses are those at time 0.
/// @param contact  the answer at `time`, or NULL.
/// Settings: all; no pair. Errors: unsupported for compounds, out_of_range where a body leaves the range, passes a
/// speed of 1e150 or turns by more than 1e6 radians. Time: 3 to 14 distance queries in the mean, at most `max_queries`.
pdepth_status pdepth_time_of_impact(pdepth_context* context, const pdepth_question* question,
                                    const pdepth_movement* movement, pdepth_impact* impact, pdepth_answer* contact);

/// Derivatives of the signed depth s (depth, or minus the distance), by a pose's translation t and a rotation vector w
/// about t. What does not exist is NaN.
typedef struct pdepth_derivatives {
  uint32_t size;
  pdepth_status status;
  int32_t unique_direction;
  int32_t unique_witness;
  int32_t stable_features;
  int32_t reserved;
  double signed_depth;
  double by_a[6];  ///< ds/dt (3), where unique_direction; ds/dw (3), where unique_witness
  double by_b[6];
  // Matrices by rows [3 x 6], columns t then w, where stable_features.
  double normal_by_a[18];
  double normal_by_b[18];
  double witness_a_by_a[18];
  double witness_a_by_b[18];
  double witness_b_by_a[18];
  double witness_b_by_b[18];
} pdepth_derivatives;

/// Derivatives of two convex bodies.
/// @param answer  the depth with the tightest bracket, or NULL.
/// No settings, no pair. Error: unsupported for compounds.
/// Time: a depth query and some hundred supports; more for near ties, at most 2e5 parts of the sphere of directions.
pdepth_status pdepth_depth_derivatives(pdepth_context* context, const pdepth_question* question,
                                       pdepth_derivatives* derivatives, pdepth_answer* answer);

// ---- Queries of one body

typedef struct pdepth_width_answer {
  uint32_t size;
  int32_t bracket_reached;
  double width;
  double lower;
  double upper;
  double normal[3];  ///< unit, of the two planes
} pdepth_width_answer;

/// The least distance of two parallel planes that hold a convex body between them.
/// Settings: `method` (automatic, overlay, expansion, grid) and `delta`; NULL: the default. Errors: unsupported for
/// compounds and other methods. Time O(m + K) for m vertices and K facets of the difference of the body with itself.
pdepth_status pdepth_width(pdepth_context* context, const pdepth_shape* shape, const pdepth_pose* pose,
                           const pdepth_settings* settings, pdepth_width_answer* answer);

typedef struct pdepth_support_answer {
  uint32_t size;
  int32_t part;    ///< of a compound
  int32_t vertex;  ///< in the library's numbers, exact, the lowest of several; -1 where the core is curved
  int32_t reserved;
  double value;     ///< max <x, direction>
  double point[3];  ///< that attains it, rounded
} pdepth_support_answer;

/// The point of a body that is farthest along a direction of any length but zero.
/// Errors: zero_direction, non_finite. Time: hill climbing, a few steps on round bodies, at worst every vertex.
pdepth_status pdepth_support(pdepth_context* context, const pdepth_shape* shape, const pdepth_pose* pose,
                             const double direction[3], pdepth_support_answer* answer);

// ---- Batches: many rows in one call. Strides are in bytes; a stride of 0 means one thing for all rows.

typedef struct pdepth_pose_array {
  int32_t form;  ///< PDEPTH_POSE_..., of every row
  int32_t reserved;
  const double* numbers;  ///< of row 0, as many as the form has; NULL: the identity for all rows
  ptrdiff_t stride;
} pdepth_pose_array;

typedef struct pdepth_batch {
  uint32_t size;
  int32_t threads;  ///< 0 or 1: the calling thread; up to 256. Threads live as long as the call.
  int64_t count;    ///< of the rows, >= 0
  const pdepth_shape* const* a;
  ptrdiff_t stride_a;
  const pdepth_shape* const* b;
  ptrdiff_t stride_b;
  pdepth_pose_array poses_a;
  pdepth_pose_array poses_b;
  const pdepth_settings* settings;  ///< of all rows
  pdepth_pair* const* pairs;        ///< NULL: no memories. Else one for each row, each of them once
  ptrdiff_t stride_pairs;
} pdepth_batch;

/// `pdepth_depth` for every row, the same bits for any number of threads.
/// @param answers  of row 0, its size set by the caller; the other rows are taken to have that size.
/// Rows that fail keep their status in their answer, and the other rows are answered all the same. The call returns the
/// status of the first row that failed, and the error names it: "rows[17].pose_a.translation[0]".
pdepth_status pdepth_depth_batch(pdepth_context* context, const pdepth_batch* batch, pdepth_answer* answers,
                                 ptrdiff_t stride);
/// `pdepth_contact_manifold` for every row; as `pdepth_depth_batch`.
pdepth_status pdepth_manifold_batch(pdepth_context* context, const pdepth_batch* batch, double breaking_threshold,
                                    pdepth_manifold* manifolds, ptrdiff_t stride);
/// `pdepth_depth_derivatives` for every row; as `pdepth_depth_batch`.
pdepth_status pdepth_derivatives_batch(pdepth_context* context, const pdepth_batch* batch,
                                       pdepth_derivatives* derivatives, ptrdiff_t stride);

#ifdef __cplusplus
}
#endif

#endif  // PDEPTH_PDEPTH_H_
