import {parentPort} from 'node:worker_threads';
import {Box, depth} from 'pdepth';

const cube = new Box([0.5, 0.5, 0.5]);
parentPort.postMessage(depth(cube, null, cube, [0.75, 0, 0]));
