/* pd_record.h: writes the contacts of any physics engine or planner for `pdepth audit`.
 *
 * One header, C99 (or C++), nothing but the C library. A record is a text file of one JSON object a line
 * ("pdepth-contacts/1"): shapes once, then a line a contact with the poses that the engine used and what it reported:
 *
 *   pd_record record;
 *   pd_record_open(&record, "contacts.jsonl", "my engine 1.0", PD_RECORD_FLOAT32, "m");
 *   const double half[3] = {0.5, 0.5, 0.5};
 *   pd_record_box(&record, "crate", half, 0);
 *   ...for each pair that the engine looked at, with the poses that it used:
 *   pd_record_report report = {depth, normal, 0, 0};          (depth > 0 overlaps; the normal points from B to A)
 *   pd_record_contact(&record, "crate", &pose_a, "crate", &pose_b, touched ? &report : NULL);
 *   ...
 *   if (!pd_record_close(&record)) perror("contacts.jsonl");
 *
 * Lengths are in the unit that is named. Numbers read back to the same bits, whatever the locale; a number that is not
 * finite is written as a string, and the audit names its line. Float coordinates become doubles exactly. Nothing is
 * written after the first failure, which pd_record_close reports. Not for several threads at once. */
#ifndef PD_RECORD_H
#define PD_RECORD_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the engine computes in: sets the tolerance of the audit, 1e-6 or 1e-12. */
typedef enum { PD_RECORD_FLOAT32, PD_RECORD_FLOAT64 } pd_record_scalar;

typedef struct {
  FILE* file;
  int good;           /* 0 once something could not be written */
  long long contacts; /* lines so far: the id of the next contact */
  double time;        /* written with each contact where has_time is set */
  int has_time;
} pd_record;

typedef enum { PD_RECORD_NO_ROTATION, PD_RECORD_MATRIX, PD_RECORD_QUATERNION } pd_record_rotation;

/* World point = R * local + translation. `rotation` says which of the two is read; R is a rotation up to
 * 1e-6, a quaternion (scalar first) of length 1 up to 1e-6. */
typedef struct {
  double translation[3];
  pd_record_rotation rotation;
  double matrix_row_major[9];
  double quaternion_wxyz[4];
} pd_record_pose;

typedef struct {
  const double* position_a; /* 3 numbers in the world, on the surface of A; or NULL */
  const double* position_b;
  double depth;
} pd_record_point;

typedef struct {
  double depth;                  /* > 0 overlapping by that much, < 0 a gap, 0 touching */
  const double* normal;          /* from B to A, any length but 0; or NULL */
  const pd_record_point* points; /* or NULL */
  size_t num_points;
} pd_record_report;

static inline void pd_record_text(pd_record* r, const char* text) {
  if (r->good && fputs(text, r->file) < 0) r->good = 0;
}

static inline void pd_record_number(pd_record* r, double value) {
  char text[40];
  char* comma;
  if (value != value) {
    pd_record_text(r, "\"nan\"");
    return;
  }
  if (value - value != 0) {
    pd_record_text(r, value > 0 ? "\"inf\"" : "\"-inf\"");
    return;
  }
  /* Nine digits hold every float; seventeen every double. */
  snprintf(text, sizeof text, "%.9g", value);
  if (strtod(text, NULL) != value) snprintf(text, sizeof text, "%.17g", value);
  comma = strchr(text, ',');
  if (comma != NULL) *comma = '.';
  pd_record_text(r, text);
}

static inline void pd_record_numbers(pd_record* r, const char* before, const double* values, size_t count) {
  size_t i;
  pd_record_text(r, before);
  for (i = 0; i < count; ++i) {
    pd_record_text(r, i == 0 ? "[" : ",");
    pd_record_number(r, values[i]);
  }
  pd_record_text(r, "]");
}

/* A quoted string. */
static inline void pd_record_string(pd_record* r, const char* before, const char* text) {
  pd_record_text(r, before);
  pd_record_text(r, "\"");
  for (; *text != 0; ++text) {
    char piece[8] = {*text, 0};
    if (*text == '"' || *text == '\\') {
      piece[0] = '\\';
      piece[1] = *text;
      piece[2] = 0;
    } else if ((unsigned char)*text < 0x20) {
      snprintf(piece, sizeof piece, "\\u%04x", (unsigned)(unsigned char)*text);
    }
    pd_record_text(r, piece);
  }
  pd_record_text(r, "\"");
}

/* Creates the file and writes its first line. 0 when it cannot be created. `unit`: NULL for metres. */
static inline int pd_record_open(pd_record* r, const char* path, const char* engine, pd_record_scalar scalar,
                                 const char* unit) {
  memset(r, 0, sizeof *r);
  r->file = fopen(path, "wb");
  r->good = r->file != NULL;
  pd_record_string(r, "{\"record\":\"pdepth-contacts/1\",\"engine\":", engine);
  pd_record_text(r, scalar == PD_RECORD_FLOAT32 ? ",\"scalar\":\"float32\"" : ",\"scalar\":\"float64\"");
  if (unit != NULL) pd_record_string(r, ",\"unit\":", unit);
  pd_record_text(r, "}\n");
  return r->good;
}

/* Closes the file. 0 when something could not be written. */
static inline int pd_record_close(pd_record* r) {
  if (r->file != NULL && fclose(r->file) != 0) r->good = 0;
  r->file = NULL;
  return r->good;
}

/* Shapes: each id once, before the first contact that names it. `margin` >= 0 is swept round the shape. */

static inline void pd_record_shape_begin(pd_record* r, const char* id, const char* type) {
  pd_record_string(r, "{\"shape\":", id);
  pd_record_string(r, ",\"is\":{\"type\":", type);
}
static inline void pd_record_shape_end(pd_record* r, double margin) {
  if (margin != 0) {
    pd_record_text(r, ",\"margin\":");
    pd_record_number(r, margin);
  }
  pd_record_text(r, "}}\n");
}

static inline void pd_record_box(pd_record* r, const char* id, const double half_extents[3], double margin) {
  pd_record_shape_begin(r, id, "box");
  pd_record_numbers(r, ",\"half_extents\":", half_extents, 3);
  pd_record_shape_end(r, margin);
}
static inline void pd_record_sphere(pd_record* r, const char* id, double radius) {
  pd_record_shape_begin(r, id, "sphere");
  pd_record_text(r, ",\"radius\":");
  pd_record_number(r, radius);
  pd_record_shape_end(r, 0);
}
static inline void pd_record_ellipsoid(pd_record* r, const char* id, const double radii[3], double margin) {
  pd_record_shape_begin(r, id, "ellipsoid");
  pd_record_numbers(r, ",\"radii\":", radii, 3);
  pd_record_shape_end(r, margin);
}
/* type: "capsule" (half height of its segment), "cylinder" or "cone" (apex at +half_height); axis: 'x', 'y' or 'z'. */
static inline void pd_record_round(pd_record* r, const char* id, const char* type, double radius, double half_height,
                                   char axis, double margin) {
  char axis_text[2] = {axis, 0};
  pd_record_shape_begin(r, id, type);
  pd_record_text(r, ",\"radius\":");
  pd_record_number(r, radius);
  pd_record_text(r, ",\"half_height\":");
  pd_record_number(r, half_height);
  pd_record_string(r, ",\"axis\":", axis_text);
  pd_record_shape_end(r, margin);
}
/* The convex hull of points, 3 numbers each. */
static inline void pd_record_convex(pd_record* r, const char* id, const double* points, size_t num_points,
                                    double margin) {
  size_t i;
  pd_record_shape_begin(r, id, "convex");
  pd_record_text(r, ",\"vertices\":[");
  for (i = 0; i < num_points; ++i) pd_record_numbers(r, i == 0 ? "" : ",", points + 3 * i, 3);
  pd_record_text(r, "]");
  pd_record_shape_end(r, margin);
}
/* The convex hull of spheres, 4 numbers each: centre and radius >= 0. */
static inline void pd_record_spheres(pd_record* r, const char* id, const double* spheres, size_t num_spheres,
                                     double margin) {
  size_t i;
  pd_record_shape_begin(r, id, "sphere_hull");
  pd_record_text(r, ",\"spheres\":[");
  for (i = 0; i < num_spheres; ++i) pd_record_numbers(r, i == 0 ? "" : ",", spheres + 4 * i, 4);
  pd_record_text(r, "]");
  pd_record_shape_end(r, margin);
}
/* The half-space of the points x with normal.x <= offset. */
static inline void pd_record_plane(pd_record* r, const char* id, const double normal[3], double offset) {
  pd_record_shape_begin(r, id, "plane");
  pd_record_numbers(r, ",\"normal\":", normal, 3);
  pd_record_text(r, ",\"offset\":");
  pd_record_number(r, offset);
  pd_record_shape_end(r, 0);
}

/* Contacts. */

static inline void pd_record_write_pose(pd_record* r, const char* key, const pd_record_pose* pose) {
  if (pose == NULL) return;
  pd_record_text(r, key);
  pd_record_numbers(r, "{\"translation\":", pose->translation, 3);
  if (pose->rotation == PD_RECORD_MATRIX) {
    pd_record_numbers(r, ",\"rotation_row_major\":", pose->matrix_row_major, 9);
  } else if (pose->rotation == PD_RECORD_QUATERNION) {
    pd_record_numbers(r, ",\"quaternion_wxyz\":", pose->quaternion_wxyz, 4);
  }
  pd_record_text(r, "}");
}

/* What the engine said of the pair; `report` NULL: no contact. Poses: NULL for the identity. */
static inline void pd_record_contact(pd_record* r, const char* a, const pd_record_pose* pose_a, const char* b,
                                     const pd_record_pose* pose_b, const pd_record_report* report) {
  char id[40];
  size_t i;
  snprintf(id, sizeof id, "{\"contact\":%lld", r->contacts++);
  pd_record_text(r, id);
  if (r->has_time) {
    pd_record_text(r, ",\"time\":");
    pd_record_number(r, r->time);
  }
  pd_record_string(r, ",\"a\":", a);
  pd_record_write_pose(r, ",\"pose_a\":", pose_a);
  pd_record_string(r, ",\"b\":", b);
  pd_record_write_pose(r, ",\"pose_b\":", pose_b);
  if (report == NULL) {
    pd_record_text(r, ",\"reported\":null}\n");
    return;
  }
  pd_record_text(r, ",\"reported\":{\"depth\":");
  pd_record_number(r, report->depth);
  if (report->normal != NULL) pd_record_numbers(r, ",\"normal\":", report->normal, 3);
  if (report->points != NULL) {
    pd_record_text(r, ",\"points\":[");
    for (i = 0; i < report->num_points; ++i) {
      const pd_record_point* point = &report->points[i];
      pd_record_text(r, i == 0 ? "{\"depth\":" : ",{\"depth\":");
      pd_record_number(r, point->depth);
      if (point->position_a != NULL) pd_record_numbers(r, ",\"position_a\":", point->position_a, 3);
      if (point->position_b != NULL) pd_record_numbers(r, ",\"position_b\":", point->position_b, 3);
      pd_record_text(r, "}");
    }
    pd_record_text(r, "]");
  }
  pd_record_text(r, "}}\n");
}

#endif /* PD_RECORD_H */
