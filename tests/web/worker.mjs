// Asks the package, or the entry that workerData names, and tries to make a compound.
import {parentPort, workerData} from 'node:worker_threads';

const {Box, Compound, depth} = await import(workerData ?? 'pdepth');
const cube = new Box([0.5, 0.5, 0.5]);
let refusal = null;
try {
  new Compound([{shape: cube}]).free();
} catch ({code, place}) {
  refusal = [code, place];
}
parentPort.postMessage({depth: depth(cube, null, cube, [0.75, 0, 0]), refusal});
