// The two pictures, on one canvas: bodies on the left (or above), their difference on the right (or below), from one camera.

const kColours = {a: 0x4c8dbf, b: 0xe0a93b, kinds: [0x5b9bc8, 0xe3bb66, 0xa9b2bb, 0x9fb3c4], way: 0xd1420f, ball: 0xb05a8c, shared: 0xe2603a, dark: 0x1b1e24};
const canvas = document.getElementById('space');
const isDark = matchMedia('(prefers-color-scheme: dark)');

const renderer = (() => {
  try {
    return new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch (error) {
    return null;  // play.js says so, and the figures go on
  }
})();
const camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
camera.up.set(0, 0, 1);
const eye = {yaw: 0.62, pitch: 0.3, distance: 1};

function lit() {
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0x9a948c, 2.4));
  const key = new THREE.DirectionalLight(0xffffff, 1.7);
  key.position.set(-0.5, -0.4, 0.81);
  scene.add(key);
  return scene;
}
const scenes = [lit(), lit()];
const groups = {a: new THREE.Group(), b: new THREE.Group(), shared: new THREE.Group(), marks: new THREE.Group(), floor: new THREE.Group(),
                difference: new THREE.Group(), facets: new THREE.Group(), ball: new THREE.Group(), way: new THREE.Group()};
for (const name of ['floor', 'a', 'b', 'shared', 'marks']) scenes[0].add(groups[name]);
groups.difference.add(groups.facets);
for (const name of ['difference', 'ball', 'way']) scenes[1].add(groups[name]);

function clear(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    child.geometry.dispose();
  }
}
/** Returns the material of these options, which is kept: when the last one of a kind goes, its shaders go, and compiling takes a frame's time. */
function materialOf(Material, options) {
  if (!materials.has(Material)) materials.set(Material, new Map());
  const made = materials.get(Material), key = JSON.stringify(options);
  if (!made.has(key)) made.set(key, new Material(options));
  return made.get(key);
}
const materials = new Map();
const linear = hex => [hex >> 16 & 255, hex >> 8 & 255, hex & 255].map(c => Math.pow(c / 255, 2.2));
/** Makes the triangles of a surface. @param colour  of a facet's number */
function solid({points, loops}, colour) {
  const positions = [], colours = [];
  loops.forEach((loop, f) => {
    const rgb = linear(colour(f));
    for (let i = 2; i < loop.length; ++i) {
      for (const v of [loop[0], loop[i - 1], loop[i]]) {
        positions.push(...points[v]);
        colours.push(...rgb);
      }
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
  geometry.computeVertexNormals();
  return geometry;
}
function addSolid(group, surface, colour, {opacity, order}) {
  const geometry = solid(surface, colour);
  [THREE.BackSide, THREE.FrontSide].forEach((side, i) => {
    const material = materialOf(THREE.MeshLambertMaterial, {vertexColors: true, transparent: opacity < 1, opacity, side, depthWrite: opacity === 1});
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = order + i;
    group.add(mesh);
  });
}
function addLines(group, ends, colour, opacity, order) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(ends.flat(), 3));
  const lines = new THREE.LineSegments(geometry, materialOf(THREE.LineBasicMaterial, {color: colour, transparent: true, opacity}));
  lines.renderOrder = order;
  group.add(lines);
}
function addMark(group, geometry, colour, at, {along, order, opacity = 1, lit: shaded = false, through = true}) {
  const Material = shaded ? THREE.MeshLambertMaterial : THREE.MeshBasicMaterial;
  const mesh = new THREE.Mesh(geometry, materialOf(Material, {color: colour, transparent: true, opacity, depthTest: !through, depthWrite: false}));
  mesh.position.set(...at);
  if (along) mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...along));
  mesh.renderOrder = order;
  group.add(mesh);
}
/** Draws an arrow that is seen through the bodies before it. @param unit  size of the picture */
function addArrow(group, from, to, colour, unit) {
  const way = minus(to, from), size = length(way);
  addMark(group, new THREE.SphereGeometry(0.026 * unit, 20, 14), kColours.dark, from, {order: 30});
  if (size < 1e-9 * unit) return;
  const along = times(1 / size, way), head = Math.min(0.13 * unit, 0.55 * size), thick = 0.017 * unit;
  addMark(group, new THREE.CylinderGeometry(thick, thick, size - head, 18), colour, add(from, times((size - head) / 2, along)), {along, order: 31});
  addMark(group, new THREE.ConeGeometry(0.4 * head, head, 24), colour, add(from, times(size - head / 2, along)), {along, order: 32});
}

const inkColour = () => isDark.matches ? 0xdfe5ec : 0x23272e;
function drawBody(role, thing) {
  clear(groups[role]);
  for (const surface of thing.skin) {
    addSolid(groups[role], surface, () => kColours[role], {opacity: role === 'a' ? 0.6 : 0.68, order: role === 'a' ? 4 : 2});
    if (surface.exact) addLines(groups[role], edgesOf(surface), inkColour(), 0.75, 8);
  }
}
function placeBody(role, {pose}) {
  const {t, q, m} = pose, [x, y, z, w] = q ?? quaternionOf(m);
  groups[role].position.set(...t);
  groups[role].quaternion.set(x, y, z, w);
}
/** Draws a metric grid below the bodies that fades with the distance. */
function drawFloor(unit, depth) {
  clear(groups.floor);
  const step = 10 ** Math.floor(Math.log10(1.2 * unit)), reach = Math.ceil(3.2 * unit / step) * step;
  const positions = [], colours = [], rgb = linear(inkColour());
  const fade = (x, y) => 0.28 * Math.max(0, 1 - Math.hypot(x, y) / reach) ** 1.5;
  for (let i = -reach; i <= reach + step / 2; i += step) {
    for (let k = -reach; k < reach - step / 2; k += step) {
      for (const [x, y] of [[i, k], [i, k + step], [k, i], [k + step, i]]) {
        positions.push(x, y, depth);
        colours.push(...rgb, fade(x, y));
      }
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colours, 4));
  groups.floor.add(new THREE.LineSegments(geometry, materialOf(THREE.LineBasicMaterial, {vertexColors: true, transparent: true, depthWrite: false})));
}
function drawShared(solids) {
  clear(groups.shared);
  for (const surface of solids) {
    addSolid(groups.shared, surface, () => kColours.shared, {opacity: 0.55, order: 12});
    addLines(groups.shared, edgesOf(surface), kColours.way, 0.9, 14);
  }
}
function drawMarks(answer, unit) {
  clear(groups.marks);
  const isApart = answer.contact === 'separated';
  addArrow(groups.marks, answer.witnessA, answer.witnessB, isApart ? kColours.dark : kColours.way, unit);
}
/** Draws the difference of the bodies as if both stood at the origin. */
function drawDifference(pieces) {
  clear(groups.facets);
  for (const piece of pieces) {
    // Edges of many pieces, most of which lie inside others, would hide the union's shape.
    addSolid(groups.facets, piece, f => kColours.kinds[piece.kinds[f]], {opacity: pieces.length > 4 ? 0.24 : pieces.length > 1 ? 0.3 : 0.5, order: 2});
    if (piece.exact && pieces.length <= 4) addLines(groups.facets, edgesOf(piece), inkColour(), pieces.length > 1 ? 0.35 : 0.6, 6);
  }
}
function drawNearest(pieces, offset, answer, unit) {
  clear(groups.way);
  const target = minus(answer.witnessB, answer.witnessA);
  if (answer.contact !== 'separated') {
    for (const piece of pieces.filter(each => each.exact)) {
      const at = f => dot(answer.normal, add(piece.points[f], offset));
      const near = piece.loops.filter(loop => loop.every(v => Math.abs(at(v) - answer.depth) < 1e-6 * unit));
      if (near.length) addSolid(groups.way, {points: piece.points.map(p => add(p, offset)), loops: near}, () => kColours.way, {opacity: 0.6, order: 8});
    }
  }
  addArrow(groups.way, [0, 0, 0], target, answer.contact === 'separated' ? kColours.dark : kColours.way, unit);
}
function drawBall(radius, unit) {
  clear(groups.ball);
  addMark(groups.ball, new THREE.SphereGeometry(0.035 * unit, 20, 14), kColours.dark, [0, 0, 0], {order: 29});
  if (radius > 0) addMark(groups.ball, new THREE.SphereGeometry(radius, 48, 32), kColours.ball, [0, 0, 0], {order: 5, opacity: 0.45, lit: true, through: false});
}

/** Returns the places of the two pictures on the canvas, in CSS pixels. */
function panes() {
  const width = canvas.parentElement.clientWidth, isWide = width >= 560;
  const tall = isWide ? Math.max(300, Math.min(0.74 * width, 0.78 * innerHeight)) : 0.9 * width;
  const cell = isWide ? width / 2 : width;
  return {width, height: isWide ? tall : 2 * tall, cells: [{x: 0, y: 0, w: cell, h: tall}, isWide ? {x: cell, y: 0, w: cell, h: tall} : {x: 0, y: tall, w: cell, h: tall}]};
}
function aim(pane, {centre, radius}) {
  // The whole of a ball of this radius is seen, whichever side of the picture is the shorter.
  const half = Math.tan(camera.fov / 2 * Math.PI / 180) * Math.min(1, pane.w / pane.h);
  const distance = eye.distance * radius / half;
  const back = [Math.sin(eye.yaw) * Math.cos(eye.pitch), -Math.cos(eye.yaw) * Math.cos(eye.pitch), Math.sin(eye.pitch)];
  camera.position.set(...add(centre, times(distance, back)));
  camera.lookAt(...centre);
  camera.near = distance / 100;
  camera.far = 20 * distance;
  camera.aspect = pane.w / pane.h;
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  const right = [Math.cos(eye.yaw), Math.sin(eye.yaw), 0];
  return {back, right, up: cross(back, right), distance, scale: 2 * distance * Math.tan(camera.fov / 2 * Math.PI / 180) / pane.h};
}
function render(frames) {
  if (!renderer) return;
  const {width, height, cells} = panes();
  if (width === 0) return;  // another tab is shown
  const ratio = Math.min(devicePixelRatio, 2);
  if (canvas.width !== Math.floor(width * ratio) || canvas.height !== Math.floor(height * ratio)) {
    renderer.setPixelRatio(ratio);
    renderer.setSize(width, height, false);
    canvas.style.height = `${height}px`;
  }
  renderer.setScissorTest(true);
  scenes.forEach((scene, i) => {
    const pane = cells[i];
    aim(pane, frames[i]);
    renderer.setViewport(pane.x, height - pane.y - pane.h, pane.w, pane.h);
    renderer.setScissor(pane.x, height - pane.y - pane.h, pane.w, pane.h);
    renderer.render(scene, camera);
  });
}
/** Projects a point of the left picture to CSS pixels of the canvas. */
function onCanvas(point, frame) {
  const pane = panes().cells[0];
  aim(pane, frame);
  const seen = new THREE.Vector3(...point).project(camera);
  return [pane.x + (seen.x + 1) / 2 * pane.w, pane.y + (1 - seen.y) / 2 * pane.h];
}
