// Pairs of a report, turned in space: one WebGL canvas for the page, which stands in the figure that asked for it last.
(() => {
  'use strict';
  const kColours = {a: 0x4c8dbf, b: 0xe0a93b, kinds: [0x5b9bc8, 0x7db89c, 0xd6be7c], exact: 0xd1420f, reported: 0x9c5486, ball: 0xb05a8c};
  const kBodies = 'drag, or use the arrow keys, to turn; plus and minus to come nearer or to go away';
  const turns = [...document.querySelectorAll('figure.pair .turn')];
  if (turns.length === 0 || typeof THREE === 'undefined') return;

  function facets(body) {
    const positions = [];
    const colours = [];
    body.polygons.forEach((loop, f) => {
      const hex = body.role === 'difference' ? kColours.kinds[body.kinds.length ? body.kinds[f] : 0] : kColours[body.role];
      const rgb = [hex >> 16 & 255, hex >> 8 & 255, hex & 255].map(c => Math.pow(c / 255, 2.2));
      for (let i = 2; i < loop.length; ++i) {
        for (const v of [loop[0], loop[i - 1], loop[i]]) {
          positions.push(...body.points[v]);
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

  function addBody(scene, body) {
    const geometry = facets(body);
    const opacity = body.role === 'difference' ? 0.5 : 0.62;
    [THREE.BackSide, THREE.FrontSide].forEach((side, order) => {
      const material = new THREE.MeshLambertMaterial({vertexColors: true, transparent: true, opacity, side, depthWrite: false});
      const mesh = new THREE.Mesh(geometry, material);
      mesh.renderOrder = order;
      scene.add(mesh);
    });
    const ends = [];
    for (const [i, j] of body.edges) ends.push(...body.points[i], ...body.points[j]);
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.Float32BufferAttribute(ends, 3));
    const ink = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({color: 0x23272e, transparent: true, opacity: 0.7}));
    ink.renderOrder = 2;
    scene.add(ink);
  }

  function addWay(scene, way) {
    const from = new THREE.Vector3(...way.from);
    const along = new THREE.Vector3(...way.to).sub(from);
    const length = along.length();
    // Drawn through what stands before it.
    const material = new THREE.MeshBasicMaterial({color: way.reported ? kColours.reported : kColours.exact, depthTest: false, transparent: true});
    const add = (geometry, at) => {
      const mesh = new THREE.Mesh(geometry, material);
      mesh.position.copy(at);
      if (length > 0) mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.clone().normalize());
      mesh.renderOrder = way.reported ? 5 : 6;
      scene.add(mesh);
    };
    add(new THREE.SphereGeometry(0.022, 16, 12), from);
    if (length < 1e-3) return;
    const head = Math.min(0.13, 0.6 * length);
    const radius = way.reported ? 0.012 : 0.018;
    add(new THREE.CylinderGeometry(radius, radius, length - head, 16), from.clone().addScaledVector(along, (length - head) / 2 / length));
    add(new THREE.ConeGeometry(0.42 * head, head, 20), from.clone().addScaledVector(along, 1 - head / 2 / length));
  }

  function addBall(scene, ball) {
    const add = (radius, material, order) => {
      const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 32, 20), material);
      mesh.position.set(...ball.centre);
      mesh.renderOrder = order;
      scene.add(mesh);
    };
    add(0.025, new THREE.MeshBasicMaterial({color: 0x1b1e24, depthTest: false, transparent: true}), 4);
    if (ball.radius > 0) add(ball.radius, new THREE.MeshLambertMaterial({color: kColours.ball, transparent: true, opacity: 0.4, depthWrite: false}), 3);
  }

  function sceneOf(view) {
    const scene = new THREE.Scene();
    scene.add(new THREE.HemisphereLight(0xffffff, 0x9a948c, 2.6));
    const key = new THREE.DirectionalLight(0xffffff, 1.5);
    key.position.set(-0.3, -0.5, 0.81);
    scene.add(key);
    view.bodies.forEach(body => addBody(scene, body));
    if (view.ball) addBall(scene, view.ball);
    view.ways.forEach(way => addWay(scene, way));
    return scene;
  }

  let renderer = null;
  let shown = null;  // {figure, scenes, yaw, pitch, distance}
  const camera = new THREE.PerspectiveCamera(30, 1, 0.1, 50);
  camera.up.set(0, 0, 1);

  function draw() {
    const {scenes, yaw, pitch, distance} = shown;
    const canvas = renderer.domElement;
    const width = canvas.parentElement.clientWidth;
    const wide = width >= 430 || scenes.length === 1;
    const cell = scenes.length === 1 ? width : wide ? width / scenes.length : width;
    const tall = Math.min(0.8 * cell, 420);
    const height = wide ? tall : scenes.length * tall;
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.position.set(Math.sin(yaw) * Math.cos(pitch), -Math.cos(yaw) * Math.cos(pitch), Math.sin(pitch)).multiplyScalar(distance);
    camera.lookAt(0, 0, 0);
    camera.aspect = cell / tall;
    camera.updateProjectionMatrix();
    scenes.forEach((scene, i) => {
      const x = wide ? i * cell : 0;
      const y = wide ? 0 : (scenes.length - 1 - i) * tall;
      renderer.setViewport(x, y, cell, tall);
      renderer.setScissor(x, y, cell, tall);
      renderer.render(scene, camera);
    });
  }

  function turn(yaw, pitch, zoom) {
    shown.yaw += yaw;
    shown.pitch = Math.min(1.5, Math.max(-1.5, shown.pitch + pitch));
    shown.distance = Math.min(12, Math.max(1.5, shown.distance * zoom));
    draw();
  }

  function makeRenderer() {
    renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
    renderer.setScissorTest(true);
    const canvas = renderer.domElement;
    canvas.className = 'space';
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', event => {
      if (event.buttons) turn(-0.008 * event.movementX, 0.008 * event.movementY, 1);
    });
    canvas.addEventListener('wheel', event => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;  // the page scrolls
      event.preventDefault();
      turn(0, 0, Math.exp(0.001 * event.deltaY));
    }, {passive: false});
    canvas.addEventListener('keydown', event => {
      const step = {ArrowLeft: [0.1, 0, 1], ArrowRight: [-0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1], '+': [0, 0, 0.9], '-': [0, 0, 1.1]}[event.key];
      if (!step) return;
      event.preventDefault();
      turn(...step);
    });
    addEventListener('resize', () => { if (shown) draw(); });
  }

  function leave() {
    if (!shown) return;
    shown.figure.querySelector('.views').hidden = false;
    shown.figure.querySelector('.turn').textContent = 'Turn in space';
    renderer.domElement.remove();
    shown = null;
  }

  function enter(figure) {
    try {
      if (!renderer) makeRenderer();
    } catch (error) {
      figure.querySelector('.turn').textContent = 'No WebGL here';
      figure.querySelector('.turn').disabled = true;
      return;
    }
    const views = JSON.parse(figure.querySelector('script').textContent);
    const canvas = renderer.domElement;
    canvas.setAttribute('aria-label', figure.querySelector('h3').textContent + ', in space; ' + kBodies);
    figure.querySelector('.views').hidden = true;
    figure.querySelector('.turn').textContent = 'Back to the drawing';
    figure.querySelector('.views').after(canvas);
    shown = {figure, scenes: views.map(sceneOf), yaw: 0.6, pitch: 0.28, distance: 4.4};
    draw();
  }

  for (const button of turns) {
    button.hidden = false;
    button.addEventListener('click', () => {
      const figure = button.closest('figure');
      const again = shown && shown.figure === figure;
      leave();
      if (!again) enter(figure);
    });
  }
})();
