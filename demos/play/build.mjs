// build.mjs SINGLE PAGE: writes the page with everything inside. SINGLE is the package's classic script (build/npm/package/single.js).
// A page that was opened from a file may fetch nothing.
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [single, page] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url));
const three = join(here, '../report/page');
const read = (folder, name) => readFileSync(join(folder, name), 'utf8');
const escaped = text => text.replace(/&/g, '&amp;').replace(/</g, '&lt;');
// A replacement as a function keeps $ as it is.
const script = text => `<script>\n${text.replace(/<\/script/g, '<\\/script')}</script>\n`;
const own = ['rotation.js', 'bodies.js', 'files.js', 'gltf.js', 'drawn.js', 'views.js', 'play.js', 'plane.js', 'polygons.js'].map(name => read(here, name)).join('\n');
const licence = read(three, 'three.LICENSE');
writeFileSync(page, read(here, 'index.html')
  .replace('<!-- style -->', () => `<style>\n${read(here, 'play.css')}</style>`)
  .replace('<!-- licence -->', () => escaped(licence))
  .replace('<!-- scripts -->', () => script(readFileSync(single, 'utf8')) +
      script(`/* three.js\n${licence}*/\n${read(three, 'three.min.js')}`) +
      script(`(async () => {\n'use strict';\nawait pdepth.ready;\n${own}})();`)));
console.log(`${page}: ${(readFileSync(page).length / 1e6).toFixed(2)} MB`);
