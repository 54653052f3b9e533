// answers.mjs PACKAGE FILE: asks the package what web_answers asked libpdepth.so, and prints the same line if all bits are the same.
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const [folder, file] = process.argv.slice(2);
const {Capsule, Cone, Convex, Cylinder, Ellipsoid, HullOfSpheres, Sphere, depth} = await import(pathToFileURL(`${folder}/index.js`));
const raw = readFileSync(file);
const numbers = new Float64Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));

let first = 0x811C9DC5 | 0, second = 0x9747B28C | 0;
const scratch = new Float64Array(1), words = new Int32Array(scratch.buffer);
function addWord(word) {
  first = Math.imul(first ^ word, 0x01000193);
  second = Math.imul(second ^ word ^ first >>> 15, 0x85EBCA6B);
}
function add(x) {
  scratch[0] = x;
  addWord(words[0]);
  addWord(words[1]);
}
const kContacts = ['separated', 'touching', 'overlapping'], kFeatures = ['none', 'vertex', 'edge', 'facet'];
const kMethods = ['automatic', 'expansion', 'overlay', 'decomposition', 'shallow', 'grid'];
function addAnswer(x) {
  addWord(kContacts.indexOf(x.contact));
  addWord(kMethods.indexOf(x.method));
  addWord(x.bracketReached ? 1 : 0);
  for (const number of [x.depth, x.lower, x.upper, x.distance, x.distanceLower, x.distanceUpper]) add(number);
  for (const vector of [x.translation, x.normal, x.witnessA, x.witnessB]) vector.forEach(add);
  for (const feature of [x.featureA, x.featureB]) {
    for (const word of [kFeatures.indexOf(feature.kind), feature.part, feature.first, feature.second]) addWord(word);
  }
}

let next = 0;
const take = count => numbers.subarray(next, next += count);
function body() {
  const [kind, count] = take(2);
  const given = take(count);
  const [margin] = take(1);
  const axis = 'xyz'[given[2]];
  const core = [() => new Convex(given), () => new Sphere(given[0]), () => new Capsule(given[0], given[1], axis), () => new Cylinder(given[0], given[1], axis),
                () => new Cone(given[0], given[1], axis), () => new Ellipsoid(given), () => new HullOfSpheres(given)][kind]();
  if (margin === 0) return core;
  const swept = core.withMargin(margin);
  core.free();
  return swept;
}
const pose = () => take(take(1)[0]);

const kSharp = [undefined, {bracket: 'certified'}, {bracket: 'contact', contactTolerance: 1e-6}, {bracket: 'contact', contactTolerance: 1e-6, beyond: 1e-3}];
let answers = 0, spent = 0;
for (let pair = 0; next < numbers.length; ++pair) {
  const a = body(), b = body(), poseA = pose(), poseB = pose();
  const begin = performance.now();
  for (const settings of pair % 2 === 0 ? kSharp : [{delta: 1e-3}]) {
    addAnswer(depth(a, poseA, b, poseB, settings));
    ++answers;
  }
  spent += performance.now() - begin;
  a.free();
  b.free();
}
const hex = x => (x >>> 0).toString(16).padStart(8, '0');
console.log(`${answers} answers, hash ${hex(first)}${hex(second)}`);
console.error(`${(1000 * spent / answers).toFixed(1)} us an answer`);
