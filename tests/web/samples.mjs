// samples.mjs FOLDER DOCUMENT...: runs each block marked `js` of the documents in the folder, where the package is installed. What
// stands behind "//" after console.log(...) is what is printed; a block that says "import" stands alone, others follow it.
import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

const [folder, ...documents] = process.argv.slice(2);
let run = 0, wrong = 0;
for (const document of documents) {
  let before = '';
  for (const [, block] of readFileSync(document, 'utf8').matchAll(/^```js\n([\s\S]*?)^```$/gm)) {
    before = /^import /m.test(block) ? block : before + block;
    const expected = [...before.matchAll(/console\.log\(.*\);\s*\/\/ (.*)$/gm)].map(found => found[1]);
    const file = join(folder, 'sample.mjs');
    writeFileSync(file, before);
    const printed = execFileSync('node', [file], {cwd: folder, encoding: 'utf8'}).trim().split('\n');
    ++run;
    if (JSON.stringify(printed) !== JSON.stringify(expected)) {
      ++wrong;
      console.log(`${document}: prints\n  ${printed.join('\n  ')}\ninstead of\n  ${expected.join('\n  ')}`);
    }
  }
}
console.log(`${run} samples run, ${wrong} print something else`);
process.exit(run > 0 && wrong === 0 ? 0 : 1);
