// Scenes of a report: one cursor moves the picture, the lines in all charts and the figures together.
(() => {
  'use strict';
  const kPrefixes = [[1, ''], [1e-3, 'm'], [1e-6, '\u00b5'], [1e-9, 'n']];

  function digits(value) {
    if (value === 0) return '0';
    const size = Math.abs(value);
    return size >= 1e-3 && size < 1e4 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
  }

  // 0.00124 and "m": "1.24 mm".
  function quantity(value, unit) {
    if (value === null) return '\u2013';
    const size = Math.abs(value);
    if (!['m', 'J', 's'].includes(unit)) return digits(value) + (unit ? ' ' + unit : '');
    if (value === 0 || size < 1e-10 || size >= 1e4) return digits(value) + ' ' + unit;
    const [scale, prefix] = kPrefixes.find(([from]) => size >= from) || kPrefixes[3];
    return String(Number((value / scale).toPrecision(3))) + ' ' + prefix + unit;
  }

  // Fetches the pictures that come next, so that playing does not flicker.
  function prefetcher(files) {
    const kept = new Map();
    return at => {
      for (let i = at; i < Math.min(at + 10, files.length); ++i) {
        if (kept.has(i)) continue;
        const image = new Image();
        image.src = files[i];
        kept.set(i, image);
      }
    };
  }

  function startScene(section) {
    const data = JSON.parse(section.querySelector('script.scene-data').textContent);
    const image = section.querySelector('.stage img');
    const slider = section.querySelector('.controls input');
    const output = section.querySelector('.controls output');
    const play = section.querySelector('.controls button');
    const cells = [...section.querySelectorAll('.now tbody tr')].map(row => [...row.querySelectorAll('td.value')]);
    const charts = [...section.querySelectorAll('svg.chart')];
    const prefetch = prefetcher(data.files);
    const first = data.times[0];
    const span = data.times[data.times.length - 1] - first || 1;

    function show(frame) {
      const time = data.times[frame];
      const clock = quantity(time, data.time_unit);
      slider.value = frame;
      output.textContent = clock;
      section.dataset.frame = frame;
      if (image && data.files[frame]) {
        image.src = data.files[frame];
        image.alt = data.alt + ' at ' + clock;
      }
      const words = [clock];
      data.quantities.forEach((q, i) => q.values.forEach((values, c) => {
        const text = quantity(values[frame], q.unit);
        if (cells[i] && cells[i][c]) cells[i][c].textContent = text;
        if (i === 0) words.push(data.contenders[c] + ': ' + q.name + ' ' + text);
      }));
      slider.setAttribute('aria-valuetext', words.join(', '));
      for (const chart of charts) {
        const x = Number(chart.dataset.left) + Number(chart.dataset.width) * (time - first) / span;
        const line = chart.querySelector('.cursor');
        line.setAttribute('x1', x);
        line.setAttribute('x2', x);
      }
    }

    let timer = 0;
    function stop() {
      clearInterval(timer);
      timer = 0;
      play.textContent = 'Play';
      play.setAttribute('aria-pressed', 'false');
    }
    play.addEventListener('click', () => {
      if (timer) return stop();
      if (Number(slider.value) === data.times.length - 1) show(0);
      play.textContent = 'Pause';
      play.setAttribute('aria-pressed', 'true');
      timer = setInterval(() => {
        const next = Number(slider.value) + 1;
        if (next >= data.times.length) return stop();
        prefetch(next + 1);
        show(next);
      }, 1000 / 15);
    });
    slider.addEventListener('input', () => {
      if (timer) stop();
      prefetch(Number(slider.value));
      show(Number(slider.value));
    });
    for (const chart of charts) {
      const follow = event => {
        if (event.type === 'pointermove' && event.buttons === 0) return;
        const box = chart.getBoundingClientRect();
        const x = (event.clientX - box.left) * chart.viewBox.baseVal.width / box.width;
        const share = Math.min(1, Math.max(0, (x - Number(chart.dataset.left)) / Number(chart.dataset.width)));
        const wanted = first + share * span;
        let nearest = 0;
        data.times.forEach((t, i) => { if (Math.abs(t - wanted) < Math.abs(data.times[nearest] - wanted)) nearest = i; });
        if (timer) stop();
        show(nearest);
      };
      chart.addEventListener('pointerdown', follow);
      chart.addEventListener('pointermove', follow);
    }
    section.querySelectorAll('[hidden]').forEach(part => { if (!part.matches('.turn')) part.hidden = false; });
    stop();
    show(Number(slider.value));
  }

  document.querySelectorAll('section.scene').forEach(startScene);
})();
