// film.mjs PAGE CLIP: films the page in headless Chromium and writes an animated WebP that loops without a jump; or, with a name that ends
// in .png, some frames side by side. Needs chromium and ffmpeg (Debian's packages of these names).
//
// Body A is moved by the page's own keys and returns to its place. The page's clock runs by the film's frames, so that the same commands
// give the same frames up to the rasteriser's tolerance.
import {execFileSync} from 'node:child_process';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {openPage} from './chromium.mjs';

const [page, clip] = process.argv.slice(2);
const kFrameRate = 15;
const {folder, ask, value, close} = await openPage(page, {width: 1320, height: 900, before: 'globalThis.filmTime = 0; performance.now = () => filmTime;'});

let frames = 0, box;
async function record(count = 1) {
  for (let i = 0; i < count; ++i) {
    // The page draws in the frame after a change; the next one has it on the screen.
    await value(`filmTime += ${1000 / kFrameRate}; new Promise(go => requestAnimationFrame(() => requestAnimationFrame(go)))`);
    const {data} = await ask('Page.captureScreenshot', {format: 'png', clip: {...box, scale: 1}});
    writeFileSync(join(folder, `${String(frames++).padStart(4, '0')}.png`), Buffer.from(data, 'base64'));
  }
}
const press = (key, shiftKey = false) =>
  value(`document.getElementById('space').dispatchEvent(new KeyboardEvent('keydown', {key: '${key}', shiftKey: ${shiftKey}}))`);
async function move(steps, key, shiftKey) {
  for (let i = 0; i < steps; ++i) {
    await press(key, shiftKey);
    await record();
  }
}

try {
  box = await value(`(() => { const b = document.querySelector('.stage').getBoundingClientRect();
    return {x: Math.round(b.left), y: Math.round(b.top), width: 2 * Math.floor(b.width / 2), height: 2 * Math.floor(b.height / 2)}; })()`);
  for (let i = 0; i < 12; ++i) await press('PageUp');
  await value('filmTime += 5000');
  await record(8);
  await move(16, 'PageDown');
  await value(`document.getElementById('grow').click()`);
  await record(22);
  await move(12, 'ArrowLeft', true);
  await record(4);
  await move(12, 'ArrowRight', true);
  await move(16, 'PageUp');
  if (clip.endsWith('.png')) {
    execFileSync('ffmpeg', ['-v', 'error', '-y', '-framerate', '1', '-i', join(folder, '%04d.png'), '-vf', "select='not(mod(n\\,14))',scale=480:-1,tile=3x2:padding=6:color=white", '-frames:v', '1', clip]);
  } else {
    execFileSync('ffmpeg', ['-v', 'error', '-y', '-framerate', String(kFrameRate), '-i', join(folder, '%04d.png'), '-vf', 'scale=840:-2:flags=lanczos',
      '-c:v', 'libwebp_anim', '-loop', '0', '-quality', '72', '-compression_level', '6', clip]);
  }
  console.log(`${clip}: ${frames} frames of ${box.width} x ${box.height}`);
} finally {
  await close();
}
