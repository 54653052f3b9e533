// build.mjs MODULES FOLDER: makes the npm package around pdepth.wasm, pdepth-convex.wasm and pdepth-lines.wasm of the folder MODULES, and prints
// the sizes in its last line.
//
// module.js, shapes.js and queries.js are parts of one text, in this order. It becomes an ES module beside the binary, a classic
// script with the binary inside (`pdepth.ready`, for pages opened from a file), and an ES module around that script.
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';

const [modules, folder] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '../..');
const out = join(resolve(folder), 'package');
rmSync(out, {recursive: true, force: true});
mkdirSync(out, {recursive: true});

const [binary, convex, lines] = ['pdepth.wasm', 'pdepth-convex.wasm', 'pdepth-lines.wasm'].map(name => readFileSync(join(modules, name)));
const text = ['module.js', 'shapes.js', 'queries.js'].map(name => readFileSync(join(here, name), 'utf8')).join('\n');
const names = [...text.matchAll(/^export (?:async )?(?:class|function) (\w+)/gm)].map(found => found[1]);
const gzipped = bytes => gzipSync(bytes, {level: 9});
const packed = gzipped(binary);

writeFileSync(join(out, 'pdepth.wasm'), binary);
writeFileSync(join(out, 'pdepth-convex.wasm'), convex);
writeFileSync(join(out, 'pdepth-lines.wasm'), lines);
// Each module has a script of its own, so that a program can hold both; their shapes do not mix.
for (const name of ['pdepth', 'pdepth-convex']) writeFileSync(join(out, `${name}.js`), text);
const loader = name => `import {start} from './${name}.js';
export * from './${name}.js';

async function load(name) {
  const address = new URL(name, import.meta.url);
  if (address.protocol !== 'file:' || typeof process === 'undefined' || !process.versions?.node) return fetch(address);
  return (await import('node:fs/promises')).readFile(address);
}
await start(await load('${name}.wasm'), () => load('pdepth-lines.wasm'));
/** Resolves when the library may be used; a module that imports this one need not wait for it. */
export const ready = Promise.resolve();
`;
writeFileSync(join(out, 'index.js'), loader('pdepth'));
writeFileSync(join(out, 'convex.js'), loader('pdepth-convex'));
writeFileSync(join(out, 'single.js'), `(() => {
'use strict';
${text.replace(/^export /gm, '')}
const packed = Uint8Array.from(atob('${packed.toString('base64')}'), c => c.charCodeAt(0));
const unpacked = new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
globalThis.pdepth = {${names.join(', ')}, ready: unpacked.then(start)};
})();
`);
writeFileSync(join(out, 'single.mjs'), `import './single.js';
const {pdepth} = globalThis;
await pdepth.ready;
export const {${[...names, 'ready'].join(', ')}} = pdepth;
`);
for (const file of ['index.d.ts', 'README.md']) copyFileSync(join(here, file), join(out, file));
copyFileSync(join(root, 'LICENSE'), join(out, 'LICENSE'));

const version = readFileSync(join(root, 'CMakeLists.txt'), 'utf8').match(/^project\(pdepth VERSION ([\d.]+)/m)[1];
const manifest = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));
writeFileSync(join(out, 'package.json'), JSON.stringify({...manifest, version}, null, 2) + '\n');

let tarball = 'not packed: npm is not installed';
try {
  tarball = execFileSync('npm', ['pack', '--silent', '--pack-destination', '..'], {cwd: out, encoding: 'utf8'}).trim();
} catch (error) {
  if (error.code !== 'ENOENT') throw error;
}
const kilobytes = size => `${(size / 1000).toFixed(0)} kB`;
console.log(`${tarball}: module ${kilobytes(binary.length)}, gzipped ${kilobytes(packed.length)}; ` +
            `for convex bodies ${kilobytes(convex.length)}, gzipped ${kilobytes(gzipped(convex).length)}; ` +
            `for lines ${kilobytes(lines.length)}, gzipped ${kilobytes(gzipped(lines).length)}; ` +
            `single file gzipped ${kilobytes(gzipped(readFileSync(join(out, 'single.js'))).length)}`);
