// The tab of polygons: drawn with the mouse or a finger, taken from an SVG file or from a list. P moves, and the place where it fits follows.

const plane = byId('plane');
const kRings = {
  'Hook': [[-1, -1], [1, -1], [1, 0.9], [0.35, 0.9], [0.35, -0.35], [-0.4, -0.35], [-0.4, 0.2], [-1, 0.2]],
  'Corner': [[-1, -1], [0.9, -1], [0.9, -0.3], [-0.2, -0.3], [-0.2, 1], [-1, 1]],
  'Star': Array.from({length: 10}, (_, i) => { const r = i % 2 ? 0.45 : 1.1, turn = Math.PI * (i / 5 + 0.5); return [rounded(r * Math.cos(turn)), rounded(r * Math.sin(turn))]; }),
  'Comb': [[-1, -0.8], [1, -0.8], [1, 0.8], [0.6, 0.8], [0.6, -0.3], [0.2, -0.3], [0.2, 0.8], [-0.2, 0.8], [-0.2, -0.3], [-0.6, -0.3], [-0.6, 0.8], [-1, 0.8]],
  'Arrow': [[-1, -0.25], [0.1, -0.25], [0.1, -0.7], [1, 0], [0.1, 0.7], [0.1, 0.25], [-1, 0.25]],
  'Square': [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]],
  'Hexagon': ring(6, 1, 0).map(([x, y]) => [x, y]),
};
const polygons = {};  // p, q: {name, ring, t, body, pieces}
let planeAnswer = null;
let drawing = null;   // {role, points}

async function attemptPlane(step) {
  const box = byId('refusal_plane');
  try {
    box.hidden = true;
    await step();
  } catch (error) {
    box.hidden = false;
    box.textContent = error instanceof PdepthError ? error.message : `The page met a fault: ${error.message}`;
    if (!(error instanceof PdepthError)) console.error(error);
  }
}
const reachOf = points => points.reduce((most, [x, y]) => Math.max(most, Math.hypot(x, y)), 0);

/** Takes a new polygon. Both bodies are made anew, since the height of their prisms follows the larger one. */
function setPolygon(role, name, points, t = polygons[role]?.t ?? [0, 0]) {
  const taken = {...polygons, [role]: {name, ring: cleanRing(points, name), t}};
  const rings = Object.values(taken).map(each => each.ring);
  const height = 2 ** Math.ceil(Math.log2(rings.reduce((sum, each) => sum + reachOf(each), 0)));
  const made = Object.entries(taken).map(([key, each]) => {
    const pieces = convexPieces(each.ring);
    const parts = pieces.map(piece => ({shape: {type: 'convex', vertices: piece.flatMap(([x, y]) => [[x, y, -height], [x, y, height]])}}));
    return [key, {...each, pieces, body: makeBody({type: 'compound', parts}, each.name, key)}];
  });
  for (const old of Object.values(polygons)) freeBody(old.body);
  Object.assign(polygons, Object.fromEntries(made));
  const select = byId(`shape_${role}`);
  if (![...select.options].some(each => each.value === name)) select.add(new Option(name, name));
  select.value = name;
}
const planePose = role => ({t: [...polygons[role].t, 0], q: [0, 0, 0, 1]});

function askPlane() {
  return pdepth.depth(polygons.p.body.shape, libraryPose(planePose('p')), polygons.q.body.shape, libraryPose(planePose('q')));
}
function framePlane() {
  const {p, q} = polygons;
  const ends = [p, q].flatMap(({ring, t}) => ring.map(([x, y]) => [x + t[0], y + t[1]]));
  ends.push(...p.ring.map(([x, y]) => [x + p.t[0] + planeAnswer.translation[0], y + p.t[1] + planeAnswer.translation[1]]));
  const [left, right] = [Math.min(...ends.map(e => e[0])), Math.max(...ends.map(e => e[0]))];
  const [low, high] = [Math.min(...ends.map(e => e[1])), Math.max(...ends.map(e => e[1]))];
  const width = 1.35 * Math.max(right - left, (high - low) * 4 / 3);
  plane.setAttribute('viewBox', `${(left + right - width) / 2} ${(-low - high - 0.75 * width) / 2} ${width} ${0.75 * width}`);
}
const outline = (points, [x, y]) => points.map((p, i) => `${i ? 'L' : 'M'}${p[0] + x} ${-(p[1] + y)}`).join('');
function drawPlane() {
  const {p, q} = polygons, isDeep = planeAnswer.contact === 'overlapping';
  const way = planeAnswer.translation, size = plane.viewBox.baseVal.width;
  const drawn = [['q', outline(q.ring, q.t) + 'Z'], ['p', outline(p.ring, p.t) + 'Z']];
  for (const {pieces, t} of [p, q]) drawn.push(['cut', pieces.map(piece => outline(piece, t) + 'Z').join('')]);
  if (isDeep) {
    drawn.push(['place', outline(p.ring, [p.t[0] + way[0], p.t[1] + way[1]]) + 'Z']);
    const [x, y] = [planeAnswer.witnessA[0], -planeAnswer.witnessA[1]], [dx, dy] = [way[0], -way[1]];
    const long = Math.hypot(dx, dy), head = Math.min(0.03 * size, long / 2) / long;
    const wing = side => `L${x + dx - head * (dx - side * 0.6 * dy)} ${y + dy - head * (dy + side * 0.6 * dx)}`;
    drawn.push(['way', `M${x} ${y}L${x + dx} ${y + dy}${wing(1)}M${x + dx} ${y + dy}${wing(-1)}`]);
  }
  if (drawing?.points.length > 1) drawn.push(['drawn', outline(drawing.points, [0, 0])]);
  plane.replaceChildren(...drawn.map(([name, d]) => {
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    path.setAttribute('class', name);
    path.setAttribute('d', d);
    return path;
  }));
}
function showPlane() {
  const isApart = planeAnswer.contact === 'separated';
  const [value, lower, upper] = isApart ? [planeAnswer.distance, planeAnswer.distanceLower, planeAnswer.distanceUpper] : [planeAnswer.depth, planeAnswer.lower, planeAnswer.upper];
  byId('word_plane').textContent = kindOf[planeAnswer.contact].replace('bodies', 'polygons');
  const depth = byId('depth_plane');
  depth.textContent = fixed(value, 6);
  depth.dataset.value = JSON.stringify(value);
  depth.dataset.contact = planeAnswer.contact;
  depth.classList.toggle('apart', isApart);
  byId('bracket_plane').textContent = `proved: ${lower} \u2264 ${isApart ? 'distance' : 'depth'} \u2264 ${upper}`;
  byId('way_plane').textContent = planeAnswer.contact === 'overlapping' ? triple(planeAnswer.translation.slice(0, 2)) : 'none needed';
  for (const key of ['ring', 'pieces']) byId(key === 'ring' ? 'corners_plane' : 'pieces_plane').textContent = `${polygons.p[key].length} and ${polygons.q[key].length}`;
  byId('line_plane').value = `echo '${lineOf({a: {body: polygons.p.body, pose: planePose('p')}, b: {body: polygons.q.body, pose: planePose('q')}}).replaceAll("'", '\\u0027')}' | pdepth query`;
}
let planeWaits = false, planeTimer = 0, isNewView = false;
/** Asks and draws before the next frame. @param frames  true to look at everything anew */
function changePlane(frames = false) {
  isNewView ||= frames;
  if (planeWaits) return;
  planeWaits = true;
  requestAnimationFrame(() => attemptPlane(() => {
    planeWaits = false;
    planeAnswer = askPlane();
    if (isNewView) framePlane();
    isNewView = false;
    showPlane();
    drawPlane();
    plane.dataset.frames = String(Number(plane.dataset.frames ?? 0) + 1);
    clearTimeout(planeTimer);
    planeTimer = setTimeout(() => {
      byId('time_plane').textContent = timeOfAnswer(askPlane);
      byId('spoken_plane').textContent = planeAnswer.contact === 'overlapping' ? `Depth ${fixed(planeAnswer.depth, 4)}; P fits after moving by ${triple(planeAnswer.translation.slice(0, 2))}`
          : planeAnswer.contact === 'touching' ? 'The polygons touch' : `Apart by ${fixed(planeAnswer.distance, 4)}`;
    }, 600);
  }));
}

// ---- The mouse, fingers and keys

function planePoint(event) {
  const box = plane.getBoundingClientRect(), view = plane.viewBox.baseVal, scale = view.width / box.width;
  return [view.x + (event.clientX - box.left) * scale, -(view.y + (event.clientY - box.top) * scale)];
}
const holds = ({ring, t}, [x, y]) => {
  let inside = false;
  ring.forEach((p, i) => {
    const q = ring[(i + 1) % ring.length], [px, py, qx, qy] = [p[0] + t[0], p[1] + t[1], q[0] + t[0], q[1] + t[1]];
    if ((py > y) !== (qy > y) && x < px + (y - py) / (qy - py) * (qx - px)) inside = !inside;
  });
  return inside;
};
function arm(role) {
  drawing = drawing?.role === role ? null : role && {role, points: []};
  for (const each of ['p', 'q']) byId(`draw_${each}`).setAttribute('aria-pressed', String(drawing?.role === each));
  plane.classList.toggle('drawing', drawing !== null);
}
let planeHeld = null, planeChosen = 'p';
plane.addEventListener('pointerdown', event => {
  plane.setPointerCapture(event.pointerId);
  const at = planePoint(event);
  if (drawing) {
    drawing.points = [at];
  } else {
    const role = ['p', 'q'].find(each => holds(polygons[each], at));
    if (role) planeChosen = role;
    planeHeld = role && {role, at};
  }
});
plane.addEventListener('pointermove', event => {
  const at = planePoint(event);
  if (drawing?.points.length) {
    drawing.points.push(at);
    drawPlane();
  } else if (planeHeld) {
    const thing = polygons[planeHeld.role];
    thing.t = [thing.t[0] + at[0] - planeHeld.at[0], thing.t[1] + at[1] - planeHeld.at[1]];
    planeHeld.at = at;
    changePlane();
  }
});
plane.addEventListener('pointerup', () => attemptPlane(() => {
  planeHeld = null;
  if (!drawing?.points.length) return;
  const {role, points} = drawing, [x, y] = points[0];
  arm(null);
  drawPlane();
  const thinned = simplified([...points, points[0]], 0.006 * plane.viewBox.baseVal.width).slice(0, -1);
  setPolygon(role, 'Drawn', thinned.map(p => [rounded(p[0] - x), rounded(p[1] - y)]), [x, y]);
  changePlane(true);
}));
plane.addEventListener('pointercancel', () => { planeHeld = null; arm(null); });
plane.addEventListener('keydown', event => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const step = 0.01 * plane.viewBox.baseVal.width, {key} = event;
  const way = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step]}[key];
  if (way) {
    const thing = polygons[planeChosen];
    thing.t = [thing.t[0] + way[0], thing.t[1] + way[1]];
    changePlane();
  } else if (['p', 'q'].includes(key.toLowerCase())) {
    planeChosen = key.toLowerCase();
    byId('spoken_plane').textContent = `Polygon ${planeChosen.toUpperCase()}`;
  } else if (key.toLowerCase() === 'o') {
    movePlaneOut();
  } else {
    return;
  }
  event.preventDefault();
});
function movePlaneOut() {
  if (planeAnswer?.contact !== 'overlapping') return;
  const {p, q} = polygons, {t} = p;
  const last = 2 ** -52 * Math.max(...t.map(Math.abs), ...q.t.map(Math.abs), planeAnswer.depth);
  for (let bits = 0; bits < 64; bits = 2 * bits + 1) {
    p.t = [0, 1].map(k => t[k] + planeAnswer.translation[k] + bits * last * planeAnswer.normal[k]);
    if (askPlane().contact !== 'overlapping') break;
  }
  changePlane();
}

// ---- Drawings as files

/** Returns the corners of a path's first outline if it has straight edges alone, else null. */
function straightPath(d) {
  if (!/^[MmLlHhVvZz\d\s,.eE+-]*$/.test(d)) return null;
  const points = [];
  let [x, y] = [0, 0];
  for (const [, command, rest] of d.matchAll(/([MmLlHhVvZz])([^MmLlHhVvZz]*)/g)) {
    const kind = command.toUpperCase(), isRelative = kind !== command;
    if (kind === 'Z' || (kind === 'M' && points.length > 0)) break;
    const numbers = (rest.match(/[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?/g) ?? []).map(Number);
    for (let i = 0; i < numbers.length;) {
      const [fromX, fromY] = isRelative ? [x, y] : [0, 0];
      if (kind !== 'V') x = fromX + numbers[i++];
      if (kind !== 'H') y = fromY + (numbers[i++] ?? NaN);
      points.push([finite(x, 'path'), 0 - finite(y, 'path')]);
    }
  }
  return points;
}
/** Reads the first outline of an SVG file, y up. The browser walks along a curved one; nothing of the file is shown or run. */
async function ringOfSvg(file) {
  if (!/\.svg$/i.test(file.name)) refuse('bad_file', `${file.name} is no svg`, file.name);
  if (file.size > 4e6) refuse('limit_exceeded', 'a drawing may have 4 MB here', file.name);
  const found = new DOMParser().parseFromString(await file.text(), 'image/svg+xml');
  if (found.querySelector('parsererror')) refuse('bad_file', 'is no well-formed SVG', file.name);
  const source = found.querySelector('polygon, polyline, path, rect, circle, ellipse') ?? refuse('too_few_points', 'has no outline', file.name);
  const numbers = (source.getAttribute('points') ?? '').trim().split(/[\s,]+/).filter(Boolean).map(Number);
  if (numbers.length >= 6) {
    if (!numbers.every(Number.isFinite)) refuse('non_finite', 'has a point that is no number', file.name);
    return Array.from({length: Math.floor(numbers.length / 2)}, (_, i) => [numbers[2 * i], 0 - numbers[2 * i + 1]]);
  }
  const straight = source.localName === 'path' ? straightPath(source.getAttribute('d') ?? '') : null;
  if (straight) return straight;
  const shape = document.createElementNS('http://www.w3.org/2000/svg', source.localName);
  for (const key of ['d', 'points', 'x', 'y', 'width', 'height', 'cx', 'cy', 'r', 'rx', 'ry']) if (source.hasAttribute(key)) shape.setAttribute(key, source.getAttribute(key));
  const long = shape.getTotalLength();
  if (!(long > 0) || !Number.isFinite(long)) refuse('too_few_points', 'has an outline of no length', file.name);
  const steps = 400, walked = Array.from({length: steps + 1}, (_, i) => { const {x, y} = shape.getPointAtLength(long * i / steps); return [rounded(x), rounded(-y)]; });
  return simplified(walked, 0.004 * long).slice(0, -1);
}
async function takeDrawing(file, role) {
  if (!file) return;
  const points = await ringOfSvg(file);
  const [left, right, low, high] = [0, 1].flatMap(k => [Math.min(...points.map(p => p[k])), Math.max(...points.map(p => p[k]))]);
  setPolygon(role, file.name, points.map(([x, y]) => [x - (left + right) / 2, y - (low + high) / 2]));
  changePlane(true);
}

// ---- Controls

for (const role of ['p', 'q']) {
  const select = byId(`shape_${role}`);
  for (const name of Object.keys(kRings)) select.add(new Option(name, name));
  select.addEventListener('change', () => attemptPlane(() => {
    if (!kRings[select.value]) return;  // a drawn polygon stays as it is
    setPolygon(role, select.value, kRings[select.value]);
    changePlane(true);
  }));
  byId(`file_${role}`).addEventListener('change', event => attemptPlane(() => takeDrawing(event.target.files[0], role)));
  byId(`draw_${role}`).addEventListener('click', () => arm(role));
}
byId('out_plane').addEventListener('click', () => attemptPlane(movePlaneOut));
const kHints = {bodies: byId('hint').textContent, polygons: 'Drag a polygon to move it, or draw one yourself. P moves out by the arrow to the dashed place, Q stays.'};
for (const name of ['bodies', 'polygons']) {
  byId(`tab_${name}`).addEventListener('click', () => attemptPlane(() => {
    for (const other of ['bodies', 'polygons']) {
      byId(other).hidden = other !== name;
      byId(`tab_${other}`).setAttribute('aria-selected', String(other === name));
    }
    byId('hint').textContent = kHints[name];
    if (name === 'bodies') return wake();
    if (!polygons.p) {
      setPolygon('p', 'Hook', kRings.Hook, [0.5, 0.25]);
      setPolygon('q', 'Star', kRings.Star);
    }
    changePlane(true);
  }));
}
