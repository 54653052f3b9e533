/// <reference lib="esnext.disposable" />
/**
 * Exact, certified penetration depth of bodies.
 *
 * A moves by `translation`, B stays. Lengths are in the unit of the input; points and directions are in the frame that the two poses
 * share. Every answer has the bits of the C and C++ libraries. A refusal is a {@link PdepthError}.
 */

/** Numbers as an array or a typed array. */
export type Numbers = ArrayLike<number>;
/** Rows of numbers: one flat array, or an array for each row. */
export type Rows = Numbers | ReadonlyArray<Numbers>;
export type Vector = [number, number, number];

/**
 * The place and attitude of a body; nothing is the identity. An array holds 3 (position), 7 (position, then x, y, z, w) or 12 (position, then a
 * rotation matrix by rows).
 */
export type Pose = null | undefined | Numbers | {
  position?: Numbers;
  /** x, y, z, w, as in three.js; | |q| - 1 | <= 1e-6. */
  quaternion?: Numbers;
  /** 9 numbers by rows; a rotation within 1e-6. */
  matrix?: Numbers;
};

/** The error of everything that is refused. */
export class PdepthError extends Error {
  /**
   * The word of pdepth.h's status ("non_finite", "not_a_rotation", ...), or one of this package: "freed" (a shape or pair was used
   * after `free`) and "not_ready" (the library has not been started).
   */
  readonly code: string;
  /** The argument that is wrong, for example "points[3]"; "" where there is none. */
  readonly place: string;
}

/** Resolves when the library may be used. Modules that import it wait by themselves; scripts write `await pdepth.ready`. */
export const ready: Promise<void>;
/** What a module is made from. */
export type ModuleSource = BufferSource | WebAssembly.Module | Response;
/**
 * Starts the library from bytes, a compiled module or a response. For "pdepth/core" in hosts that load binaries in a way of their own.
 * @param lines returns such a source of pdepth-lines.wasm, which the first {@link query} needs
 */
export function start(source: ModuleSource, lines?: () => ModuleSource | Promise<ModuleSource>): Promise<void>;
/**
 * Answers a line of the protocol, as `pdepth query` does, without files: any of its queries, polygons and mesh-free bodies of 2 to 5 dimensions
 * among them. The first call loads a module of its own. A line that cannot be answered is answered by an error object.
 */
export function query(line: string): Promise<string>;
/** The version of the library, "0.1.0". */
export function version(): string;

export interface Description {
  /** False: a compound or a solid of a mesh. */
  isConvex: boolean;
  /** 0 where the mesh of a solid was asked about. */
  parts: number;
  /** Dimension of the part's core without its margin: 0 a point, 1 a segment, 2 a polygon, 3 a solid. */
  dimension: number;
  /** 0 where the core is curved. */
  vertices: number;
  facets: number;
  margin: number;
}

/** Facet f is corners[offsets[f]] .. corners[offsets[f + 1] - 1], counter-clockwise from outside; corners are rows of points. */
export interface Surface {
  points: Float64Array;
  offsets: Int32Array;
  corners: Int32Array;
}

/** A vertex, edge or facet of one body, in the library's own numbers; {@link Shape.pointsOf} leads back to the caller's. */
export interface Feature {
  /** "none" where the body is curved, and often for solids that overlap. */
  kind: 'none' | 'vertex' | 'edge' | 'facet';
  /** Of a compound, from 0; "mesh": `first` is a face of the mesh that a {@link Solid} was made from. */
  part: number | 'mesh';
  first: number;
  second: number;
}

/** An immutable body in a frame of its own. Its memory lies in the module: `free` it, or let the garbage collector do so. */
export abstract class Shape {
  /** Gives the memory back. Compounds and pairs that use the shape live on. A second call does nothing. */
  free(): void;
  /** For `using shape = new Box(...)`. */
  [Symbol.dispose](): void;
  readonly freed: boolean;
  /** The shape swept by a ball, in addition to the margin that it has. Rounded corners are exact, too. */
  withMargin(margin: number): Shape;
  /** Tells what the shape is made of. @param part of a compound, from 0; "mesh": the mesh of a solid, its faces as triangles */
  describe(part?: number | 'mesh'): Description;
  /** Facets for drawing. Refused with "unsupported" where the core is curved. */
  surface(part?: number | 'mesh'): Surface;
  /** The points of a feature of an answer, as numbers of the rows that the shape was made from. */
  pointsOf(feature: Feature): number[];
}

/** The box [-x, x] x [-y, y] x [-z, z]. */
export class Box extends Shape { constructor(halfExtents: Numbers); }
export class Sphere extends Shape { constructor(radius: number); }
export class Ellipsoid extends Shape { constructor(radii: Numbers); }
/** A segment from -halfHeight to halfHeight along the axis, swept by a ball. */
export class Capsule extends Shape { constructor(radius: number, halfHeight: number, axis?: 'x' | 'y' | 'z'); }
export class Cylinder extends Shape { constructor(radius: number, halfHeight: number, axis?: 'x' | 'y' | 'z'); }
/** Base at -halfHeight, apex at halfHeight. */
export class Cone extends Shape { constructor(radius: number, halfHeight: number, axis?: 'x' | 'y' | 'z'); }
/** The convex hull of points; with faces (loops of point numbers, counter-clockwise from outside) they are checked and not trusted. */
export class Convex extends Shape { constructor(points: Rows, faces?: ReadonlyArray<ArrayLike<number>> | Uint16Array | Int32Array | Uint32Array); }
/** The solid of all x with n x <= d. @param planes rows of 4 numbers: n (any length), d */
export class Halfspaces extends Shape { constructor(planes: Rows); }
/** The convex hull of spheres. @param spheres rows of 4 numbers: centre, radius >= 0 */
export class HullOfSpheres extends Shape { constructor(spheres: Rows); }
/**
 * The solid that a closed mesh bounds: not convex in general, with cavities and several shells.
 *
 * Depth and `apart`, of solids and of a solid and a convex shape that is not flat, ask the mesh itself. All else needs the solid as convex
 * parts: refused with "unsupported" where no doubles hold their corners, with "limit_exceeded" above 512 parts. A mesh that bounds no solid
 * is refused by its fault (open_edge, flipped_face, self_crossing, inside_out ...) and the face.
 */
export class Solid extends Shape {
  /**
   * @param faces loops of point numbers, counter-clockwise from outside, or triangles in a typed array
   * @param options turnFaces: a mesh that is wholly inside out is turned
   */
  constructor(points: Rows, faces: ReadonlyArray<ArrayLike<number>> | Uint16Array | Int32Array | Uint32Array, options?: {turnFaces?: boolean});
}
/** The union of shapes, each at a pose in the compound's frame. */
export class Compound extends Shape { constructor(parts: ReadonlyArray<{shape: Shape; pose?: Pose}>); }

/** The memory of one pair from frame to frame: `depth(a, poseA, b, poseB, {pair})` becomes quicker, and its answer stays proved. */
export class Pair {
  constructor();
  clear(): void;
  free(): void;
  [Symbol.dispose](): void;
  readonly freed: boolean;
}

export interface Settings {
  /** Compounds and contact manifolds take "automatic". */
  method?: 'automatic' | 'expansion' | 'overlay' | 'decomposition' | 'shallow' | 'grid';
  /** The gap between `lower` and `upper`: the exact depth rounded down and up; within 2e-14 of the size of the numbers given; or as `contactTolerance` says. */
  bracket?: 'tightest' | 'certified' | 'contact';
  /** Bodies farther apart than this are not told apart any further. */
  beyond?: number;
  /** Relative error in (0, 1] of answers about curved bodies; 1e-6 by default. */
  delta?: number;
  contactTolerance?: number;
  seed?: number | bigint;
  /** The budget of solids with many convex parts; 500,000 by default. Where it ends the search, `bracketReached` is false. */
  maxPoints?: number;
}
export interface PairOptions extends Settings { pair?: Pair; }

export type Contact = 'separated' | 'touching' | 'overlapping';

export interface Answer {
  contact: Contact;
  /** Length of the shortest move of A that separates the bodies; 0 unless overlapping. */
  depth: number;
  /** Certified: lower <= depth <= upper. */
  lower: number;
  upper: number;
  /** 0 unless separated. */
  distance: number;
  distanceLower: number;
  distanceUpper: number;
  /** Moves A clear of B, exactly as stored. */
  translation: Vector;
  /** Unit; the way on which A leaves B. */
  normal: Vector;
  /** witnessB - witnessA is the translation. */
  witnessA: Vector;
  witnessB: Vector;
  featureA: Feature;
  featureB: Feature;
  method: NonNullable<Settings['method']>;
  /** The memory of the pair held. */
  warm: boolean;
  /** False: the bracket is certified, but wider than asked. */
  bracketReached: boolean;
  supportCalls: number;
  facetsVisited: number;
  exactSigns: number;
}

/** Penetration depth of two bodies, or their distance when apart. */
export function depth(a: Shape, poseA: Pose, b: Shape, poseB: Pose, options?: PairOptions): Answer;
/** True if the bodies are proved to be apart by more than `distance` >= 0. */
export function apart(a: Shape, poseA: Pose, b: Shape, poseB: Pose, distance?: number, options?: PairOptions): boolean;

export interface DirectionalAnswer {
  contact: Contact;
  /** The least t >= 0 after which A, moved by t along the direction, is free of B. */
  depth: number;
  lower: number;
  upper: number;
  normal: Vector;
  featureA: Feature;
  featureB: Feature;
}
/** Depth along a direction of any length but zero. */
export function depthAlong(a: Shape, poseA: Pose, b: Shape, poseB: Pose, direction: Numbers): DirectionalAnswer;

export interface ContactPoint {
  positionA: Vector;
  positionB: Vector;
  /** > 0 inside, < 0 a gap. */
  depth: number;
  /** Stays the same while the same two features meet. */
  featureId: bigint;
}
/** The contact of two convex bodies as at most four pairs of points. @param breakingThreshold wider gaps are left out */
export function manifold(a: Shape, poseA: Pose, b: Shape, poseB: Pose, breakingThreshold?: number, options?: PairOptions):
    {contact: Contact; normal: Vector; points: ContactPoint[]};

export interface Motion {
  linearVelocity?: Numbers;
  /** Radians per unit of time. */
  angularVelocity?: Numbers;
  /** From the point about which the body turns to the origin of its frame. */
  arm?: Numbers;
}
/** Finds when two moving convex bodies first touch; the poses are those at time 0. `certified`: no contact happens before, proved. */
export function timeOfImpact(a: Shape, poseA: Pose, b: Shape, poseB: Pose,
    movement: {a?: Motion; b?: Motion; duration: number; distanceTolerance?: number; allowedDepth?: number}, options?: PairOptions):
    {hit: boolean; reached: boolean; queries: number; time: number; certified: number; contact: Answer};

/** Derivatives of depth (or minus the distance) by a pose's translation (3) and rotation vector (3). What does not exist is NaN. */
export function derivatives(a: Shape, poseA: Pose, b: Shape, poseB: Pose):
    {uniqueDirection: boolean; uniqueWitness: boolean; stableFeatures: boolean; signedDepth: number; byA: number[]; byB: number[];
     answer: Answer};

/** The least distance of two parallel planes that hold a convex body between them. */
export function width(shape: Shape, pose?: Pose): {width: number; lower: number; upper: number; normal: Vector};
/** The point of a body that is farthest along a direction. */
export function support(shape: Shape, pose: Pose, direction: Numbers): {part: number; vertex: number; value: number; point: Vector};

export type PoseForm = 'position' | 'quaternion' | 'matrix';
export interface Batch {
  /** One shape, or one for each row. */
  a: Shape | Shape[];
  b: Shape | Shape[];
  /** Rows of 3, 7 or 12 numbers, as `formA` says; one row stands for all; nothing is the identity. */
  posesA?: Rows | null;
  posesB?: Rows | null;
  /** "quaternion" by default: position, x, y, z, w. */
  formA?: PoseForm;
  formB?: PoseForm;
  settings?: Settings;
  /** Rows, where no array tells. */
  count?: number;
}
/** Columns of answers. Rows that were refused are NaN, and their status is not 0. */
export interface BatchAnswer {
  count: number;
  /** pdepth.h's status of each row. */
  status: Uint8Array;
  /** The error of the first row that was refused, or null. */
  error: PdepthError | null;
  /** 0 separated, 1 touching, 2 overlapping. */
  contact: Uint8Array;
  depth: Float64Array;
  lower: Float64Array;
  upper: Float64Array;
  distance: Float64Array;
  distanceLower: Float64Array;
  distanceUpper: Float64Array;
  /** 3 numbers a row, as are normal, witnessA and witnessB. */
  translation: Float64Array;
  normal: Float64Array;
  witnessA: Float64Array;
  witnessB: Float64Array;
}
/** `depth` for many rows in one call: arrays go into the module once. */
export function depthBatch(batch: Batch): BatchAnswer;
