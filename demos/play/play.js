// A visitor changes the state of the page, and the state is asked and drawn once a frame.

const byId = id => document.getElementById(id);
const calm = matchMedia('(prefers-reduced-motion: reduce)');
const state = {};  // a, b: {body, pose, eye}
let memory = new pdepth.Pair();
let answer = null;
let pieces = [];
let turnedAs = '';
let unit = 1;
let frames = [{centre: [0, 0, 0], radius: 1}, {centre: [0, 0, 0], radius: 1}];
let growth = 1;  // share of its radius that the ball has grown to
let grownFrom = 0;
let isWaiting = false;

function say(error) {
  const box = byId('refusal');
  box.hidden = error === null;
  if (error) box.textContent = error instanceof PdepthError ? error.message : `The page met a fault: ${error.message}`;
}
/** Runs what a visitor asked for; a refusal is shown, and the page lives on. */
async function attempt(step) {
  try {
    say(null);
    await step();
  } catch (error) {
    say(error);
    if (!(error instanceof PdepthError)) console.error(error);
  }
}

function setBody(role, body, pose) {
  const old = state[role];
  const parts = eyeOf(body);
  const thing = {body, pose, eye: parts, skin: body.skin ?? parts};  // the skin is what is seen from outside
  state[role] = thing;
  if (old && old.body !== body) freeBody(old.body);
  const select = byId(`shape_${role}`);
  let option = [...select.options].find(each => each.value === body.name);
  if (!option) select.add(option = new Option(body.name, body.name));
  select.value = body.name;
  memory.clear();
  turnedAs = '';
  if (renderer) drawBody(role, thing);
}
function frameAll() {
  const reach = ({skin}) => greatestLength(skin.flatMap(each => each.points));
  unit = Math.max(reach(state.a), reach(state.b));
  const centre = times(0.5, add(state.a.pose.t, state.b.pose.t));
  const radius = Math.max(reach(state.a) + length(minus(state.a.pose.t, centre)), reach(state.b) + length(minus(state.b.pose.t, centre)));
  const offset = minus(state.b.pose.t, state.a.pose.t);
  frames = [{centre, radius: 1.05 * radius}, {centre: times(0.5, offset), radius: reach(state.a) + reach(state.b) + 0.3 * length(offset)}];
  eye.distance = 1;
  if (renderer) drawFloor(unit, centre[2] - 1.25 * radius);
}

// ---- Asking and drawing

function ask() {
  return pdepth.depth(state.a.body.shape, libraryPose(state.a.pose), state.b.body.shape, libraryPose(state.b.pose), {pair: memory});
}
/** Tells what one answer costs. Clocks of browsers are coarse, so the question is repeated. */
function timeOfAnswer(question) {
  const begin = performance.now();
  let count = 0;
  for (; count < 1000 && performance.now() - begin < 15; ++count) question();
  const milliseconds = (performance.now() - begin) / count;
  return milliseconds < 1 ? `${(1000 * milliseconds).toFixed(0)} \u00b5s` : `${milliseconds.toFixed(1)} ms`;
}
const fixed = (x, digits = 5) => x === 0 ? '0' : Math.abs(x) >= 1e6 || Math.abs(x) < 1e-4 ? x.toExponential(digits - 2) : x.toFixed(digits);
const triple = v => v.map(x => fixed(x, 4).replace('-', '\u2212')).join(', ');
const featureWords = (feature, thing) => feature.kind === 'none' ? thing.body.skin ? 'mesh' : 'curved' : feature.part === 'mesh' ? `face ${feature.first} of the mesh` : thing.body.parts.length > 1 ? `${feature.kind} of part ${feature.part}` : feature.kind;
const kindOf = {overlapping: 'depth', touching: 'depth: the bodies touch', separated: 'distance'};

function showFigures() {
  const isApart = answer.contact === 'separated';
  const value = isApart ? answer.distance : answer.depth;
  const [lower, upper] = isApart ? [answer.distanceLower, answer.distanceUpper] : [answer.lower, answer.upper];
  byId('word').textContent = kindOf[answer.contact];
  const depth = byId('depth');
  depth.textContent = fixed(value, 6);
  depth.dataset.value = JSON.stringify(value);
  depth.dataset.contact = answer.contact;
  depth.classList.toggle('apart', isApart);
  byId('bracket').textContent = `proved: ${lower} \u2264 ${isApart ? 'distance' : 'depth'} \u2264 ${upper}`;
  byId('way').textContent = answer.contact === 'overlapping' ? triple(answer.translation) : 'none needed';
  byId('witness_a').textContent = triple(answer.witnessA);
  byId('witness_b').textContent = triple(answer.witnessB);
  byId('features').textContent = `${featureWords(answer.featureA, state.a)} against ${featureWords(answer.featureB, state.b)}`;
}
function showTag() {
  const tag = byId('tag');
  tag.hidden = !renderer;
  if (!renderer) return;
  const isApart = answer.contact === 'separated';
  tag.classList.toggle('apart', isApart);
  tag.textContent = isApart ? `apart by ${fixed(answer.distance, 4)}` : fixed(answer.depth, 4);
  const [x, y] = onCanvas(times(0.5, add(answer.witnessA, answer.witnessB)), frames[0]);
  const pane = panes().cells[0];
  const held = (at, size, most) => Math.max(6, Math.min(at, most - size - 6));
  tag.style.transform = `translate(${held(x + 18, tag.offsetWidth, pane.w)}px, ${held(y - 34, tag.offsetHeight, pane.h)}px)`;
}
function showPictures() {
  placeBody('a', state.a);
  placeBody('b', state.b);
  drawShared(answer.contact === 'overlapping' ? overlapOf(state.a, state.b) : []);
  drawMarks(answer, unit);
  const turns = [rotationOf(state.a.pose), rotationOf(state.b.pose)];
  if (turnedAs !== turns.join()) {
    turnedAs = turns.join();
    pieces = differenceOf(state.a, state.b, ...turns);
    drawDifference(pieces);
  }
  const offset = minus(state.b.pose.t, state.a.pose.t);
  groups.difference.position.set(...offset);
  clear(groups.way);
  drawNearest(pieces, offset, answer, unit);
}
let changed = true;
function frame(now) {
  isWaiting = false;
  try {
    if (changed) {
      answer = ask();
      showFigures();
      if (renderer) showPictures();
      changed = false;
      spoken.settle();
      byId('line').value = `echo '${lineOf(state).replaceAll("'", '\\u0027')}' | pdepth query`;  // a quote would end the shell's word
    }
    if (growth < 1) {
      growth = Math.min(1, (now - grownFrom) / 1100);
      wake();
    }
    if (renderer) {
      const eased = growth < 1 ? 1 - (1 - growth) ** 3 : 1;
      drawBall(answer.contact === 'overlapping' ? eased * answer.depth : 0, unit);
      render(frames);
      showTag();
    }
    canvas.dataset.frames = String(Number(canvas.dataset.frames ?? 0) + 1);
  } catch (error) {
    say(error);
    if (!(error instanceof PdepthError)) console.error(error);
  }
}
function wake() {
  if (isWaiting) return;
  isWaiting = true;
  requestAnimationFrame(frame);
}
function change() {
  changed = true;
  wake();
}
function grow() {
  if (calm.matches) return wake();
  growth = 0;
  grownFrom = performance.now();
  wake();
}
/** Tells a screen reader the answer, and shows what it costs, when nothing has changed for a while. */
const spoken = {
  timer: 0,
  settle() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      byId('time').textContent = timeOfAnswer(ask);
      const {contact} = answer;
      byId('spoken').textContent = contact === 'separated' ? `Apart by ${fixed(answer.distance, 4)}` : contact === 'touching' ? 'The bodies touch'
          : `Depth ${fixed(answer.depth, 4)}; A leaves by ${triple(answer.translation)}`;
      canvas.setAttribute('aria-label', `Bodies A (${state.a.body.name}) and B (${state.b.body.name}), and their Minkowski difference. ${byId('spoken').textContent}`);
    }, 600);
  },
};

// ---- Moving and turning

function moveBody(role, by) {
  const {pose} = state[role];
  state[role].pose = {...pose, t: add(pose.t, by)};
  change();
}
function turnBody(role, axis, angle) {
  const {t, q, m} = state[role].pose;
  state[role].pose = {t, q: product(aboutAxis(axis, angle), q ?? quaternionOf(m))};
  change();
}
function look(yaw, pitch, nearer = 1) {
  eye.yaw += yaw;
  eye.pitch = Math.min(1.5, Math.max(-1.5, eye.pitch + pitch));
  eye.distance = Math.min(6, Math.max(0.3, eye.distance * nearer));
  wake();
}
const fingers = new Map();
let held = null;  // {role or 'look', distance}
let chosen = 'a';

function bodyAt(x, y) {
  const pane = panes().cells[0];
  if (x < pane.x || x > pane.x + pane.w || y < pane.y || y > pane.y + pane.h) return null;
  const {back, right, up, distance, scale} = aim(pane, frames[0]);
  const across = (x - pane.x - pane.w / 2) * scale, along = (pane.h / 2 - (y - pane.y)) * scale;
  const from = add(frames[0].centre, times(distance, back));
  const way = add(add(times(across, right), times(along, up)), times(-distance, back));
  const [a, b] = ['a', 'b'].map(role => rayMeets(from, way, state[role]));
  return a === Infinity && b === Infinity ? null : {role: a <= b ? 'a' : 'b', depth: Math.min(a, b)};
}
const placeOf = event => {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};
canvas.addEventListener('pointerdown', event => {
  canvas.setPointerCapture(event.pointerId);
  const [x, y] = placeOf(event);
  fingers.set(event.pointerId, [x, y]);
  if (fingers.size === 1) {
    const met = bodyAt(x, y);
    const mode = document.querySelector('input[name=drag]:checked').value;
    held = met && mode !== 'look' ? {role: met.role, depth: met.depth, turns: mode === 'turn' || event.shiftKey || event.button === 2} : {role: 'look'};
    if (met) chosen = met.role;
    canvas.classList.add('holding');
  }
});
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('pointermove', event => {
  const before = fingers.get(event.pointerId);
  if (!before || !held) return;
  const [x, y] = placeOf(event);
  const [dx, dy] = [x - before[0], y - before[1]];
  const others = [...fingers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
  fingers.set(event.pointerId, [x, y]);
  if (others.length > 0) {
    const [other] = others;
    const gap = at => Math.hypot(at[0] - other[0], at[1] - other[1]);
    if (held.role === 'look') return look(0, 0, gap(before) / Math.max(gap([x, y]), 1));
    held.turns = true;
  }
  if (held.role === 'look') return look(-0.008 * dx, 0.008 * dy);
  const {right, up, scale} = aim(panes().cells[0], frames[0]);
  if (held.turns) {
    turnBody(held.role, up, 0.01 * dx);
    turnBody(held.role, right, 0.01 * dy);
  } else {
    moveBody(held.role, times(scale * held.depth, add(times(dx, right), times(-dy, up))));
  }
});
for (const name of ['pointerup', 'pointercancel']) {
  canvas.addEventListener(name, event => {
    fingers.delete(event.pointerId);
    if (fingers.size > 0) return;
    canvas.classList.remove('holding');
    if (held && held.role !== 'look') grow();
    held = null;
  });
}
canvas.addEventListener('wheel', event => {
  if (!event.ctrlKey && document.activeElement !== canvas) return;  // the page scrolls
  event.preventDefault();
  look(0, 0, Math.exp(0.001 * event.deltaY));
}, {passive: false});
canvas.addEventListener('keydown', event => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const {right, up, back} = aim(panes().cells[0], frames[0]);
  const step = 0.04 * unit;
  const ways = {ArrowLeft: [times(-1, right), times(-1, up)], ArrowRight: [right, up], ArrowUp: [[-back[0], -back[1], 0], times(-1, right)],
                ArrowDown: [[back[0], back[1], 0], right], PageUp: [[0, 0, 1], back], PageDown: [[0, 0, -1], times(-1, back)]};
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (ways[key]) {
    const [along, about] = ways[key];
    if (event.shiftKey) turnBody(chosen, about, 0.07);
    else moveBody(chosen, times(step / (length(along) || 1), along));
  } else if (key === 'a' || key === 'b') {
    chosen = key;
    byId('spoken').textContent = `Body ${key.toUpperCase()}`;
  } else if (key === 'o') {
    moveOut();
  } else if (key === '+' || key === '-') {
    look(0, 0, key === '+' ? 0.9 : 1 / 0.9);
  } else {
    return;
  }
  event.preventDefault();
});

// ---- Controls

/** Moves A out by the answer's translation. The sum with its position is rounded, so that some last bits may have to follow. */
function moveOut() {
  if (answer?.contact !== 'overlapping') return;
  const {a, b} = state, {t} = a.pose;
  const last = 2 ** -52 * Math.max(...t.map(Math.abs), ...b.pose.t.map(Math.abs), answer.depth);
  for (let bits = 0; bits < 64; bits = 2 * bits + 1) {
    a.pose = {...a.pose, t: add(t, add(answer.translation, times(bits * last, answer.normal)))};
    if (pdepth.depth(a.body.shape, libraryPose(a.pose), b.body.shape, libraryPose(b.pose)).contact !== 'overlapping') break;
  }
  change();
}
function start() {
  for (const role of ['a', 'b']) setBody(role, makeBody(kShapes[kStart[role].name], kStart[role].name, role), kStart[role].pose);
}
function take(text) {
  const found = readLine(text);
  for (const role of ['a', 'b']) setBody(role, found[role].body, found[role].pose);
  frameAll();
  change();
}
for (const role of ['a', 'b']) {
  const select = byId(`shape_${role}`);
  for (const name of Object.keys(kShapes)) select.add(new Option(name, name));
  select.addEventListener('change', () => attempt(() => {
    if (!kShapes[select.value]) return;  // a file's or a line's body stays as it is
    setBody(role, makeBody(kShapes[select.value], select.value, role), state[role].pose);
    frameAll();
    change();
    grow();
  }));
  byId(`file_${role}`).addEventListener('change', event => attempt(() => takeFile(event.target.files[0], role)));
}
async function takeFile(file, role) {
  if (!file) return;
  const body = await bodyOfFile(file, byId('files_as').value);
  // The file's body stands where the old one stood, with its own size.
  setBody(role, body, state[role].pose);
  frameAll();
  change();
  grow();
}
byId('out').addEventListener('click', () => attempt(moveOut));
byId('grow').addEventListener('click', grow);
byId('reset').addEventListener('click', () => attempt(() => {
  start();
  frameAll();
  change();
  grow();
}));
byId('take').addEventListener('click', () => attempt(() => take(byId('paste').value)));
async function copy(text, what) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.body.appendChild(Object.assign(document.createElement('textarea'), {value: text}));
    area.select();
    document.execCommand('copy');
    area.remove();
  }
  byId('copied').textContent = `${what} copied`;
}
byId('copy_line').addEventListener('click', () => copy(byId('line').value, 'Line'));
byId('copy_link').addEventListener('click', () => attempt(() => {
  for (const role of ['a', 'b']) if (state[role].body.skin) refuse('unsupported', 'a link holds no file; copy the line, and give it to the command beside the file', `${role}.path`);
  const link = location.href.replace(/#.*/, '') + '#' + encodeURIComponent(lineOf(state));
  if (link.length > 32000) refuse('limit_exceeded', `the link would have ${link.length} letters; copy the line instead`, 'link');
  history.replaceState(null, '', link);
  return copy(link, 'Link');
}));
addEventListener('dragover', event => {
  event.preventDefault();
  document.body.classList.add('dropping');
});
addEventListener('dragleave', event => { if (!event.relatedTarget) document.body.classList.remove('dropping'); });
addEventListener('drop', event => {
  event.preventDefault();
  document.body.classList.remove('dropping');
  const isLeft = event.clientX < innerWidth / 2, [file] = event.dataTransfer.files;
  if (byId('bodies').hidden) attemptPlane(() => takeDrawing(file, isLeft ? 'p' : 'q'));
  else attempt(() => takeFile(file, isLeft ? 'a' : 'b'));
});
addEventListener('resize', wake);
isDark.addEventListener('change', () => {
  for (const role of ['a', 'b']) drawBody(role, state[role]);
  turnedAs = '';
  frameAll();
  change();
});
addEventListener('hashchange', () => attempt(() => { if (location.hash.length > 1) take(decodeURIComponent(location.hash.slice(1))); }));

byId('legend').innerHTML = [['facet of A', kColours.kinds[0]], ['facet of B', kColours.kinds[1]], ['edge and edge', kColours.kinds[2]], ['nearest', kColours.way], ['ball of the depth', kColours.ball]]
    .map(([words, colour]) => `<li><span class="key" style="background:#${colour.toString(16).padStart(6, '0')}"></span>${words}</li>`).join('');
byId('version').textContent = pdepth.version();
start();
frameAll();
if (location.hash.length > 1) await attempt(() => take(decodeURIComponent(location.hash.slice(1))));
if (!renderer) say(new PdepthError('unsupported', 'this browser draws no WebGL; the figures go on without pictures', 'canvas'));
change();
grow();
