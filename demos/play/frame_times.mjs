// frame_times.mjs PAGE: what a frame of the page costs while body A is moved. The script's own time is that of the frame's callback, by
// performance.now around it: once without pictures (the query and the figures), once with them (their geometry and the calls of WebGL, which
// return before anything is drawn). The time from frame to frame holds the rasteriser, too, which is software here.
import {openPage} from './chromium.mjs';

const [page] = process.argv.slice(2);
const kMoves = 60;
const kTimed = `globalThis.frameTimes = []; globalThis.requestAnimationFrame = (ask => call => ask(now => {
  const begin = performance.now(); call(now); frameTimes.push(performance.now() - begin); }))(requestAnimationFrame.bind(globalThis));`;
const kBlind = `HTMLCanvasElement.prototype.getContext = () => null;`;
const quantile = (numbers, share) => numbers.sort((x, y) => x - y)[Math.floor(share * (numbers.length - 1))];

for (const [what, before] of [['query and figures', kTimed + kBlind], ['with pictures', kTimed]]) {
  const browser = await openPage(page, {width: 1320, height: 900, before});
  try {
    for (const [a, b] of [['Prism', 'Box'], ['Gem of 40 points', 'Gem of 40 points'], ['Gear', 'Cross of boxes']]) {
      const found = await browser.value(`(async () => {
        for (const [role, name] of [['a', '${a}'], ['b', '${b}']]) {
          const select = document.getElementById('shape_' + role);
          select.value = name;
          select.dispatchEvent(new Event('change'));
        }
        const canvas = document.getElementById('space'), drawn = () => Number(canvas.dataset.frames);
        await new Promise(go => setTimeout(go, 2500));  // the ball has grown
        frameTimes.length = 0;
        const begin = performance.now();
        for (let i = 0; i < ${kMoves}; ++i) {
          const seen = drawn();
          canvas.dispatchEvent(new KeyboardEvent('keydown', {key: i % 2 ? 'ArrowLeft' : 'ArrowRight', shiftKey: i % 4 < 2}));
          while (drawn() === seen) await new Promise(go => setTimeout(go, 0));
        }
        return {times: frameTimes, apart: (performance.now() - begin) / ${kMoves}};
      })()`);
      console.log(`${what}, ${a} and ${b}: script ${quantile(found.times, 0.5).toFixed(1)} ms a frame in the middle, ${quantile(found.times, 0).toFixed(1)} at least; ` +
                  `from frame to frame ${found.apart.toFixed(0)} ms`);
    }
  } finally {
    await browser.close();
  }
}
