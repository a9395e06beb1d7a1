// The stage: ground, light, camera, the figures on their places and the names under them.
const COLOURS = ['#4f79ea', '#12a391', '#9a62e6', '#dd5582', '#6a9e2c', '#6b7a94'];
const SPACE = 0.35;  // metres between the boxes that two figures reach

function cssValue(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// The names without the words that all begin with, the middle of long ones left out.
function shortNames(names) {
  if (names.length < 2) return names;
  let same = 0;
  while (names.every((n) => n[same] && n[same] === names[0][same])) same++;
  const word = names[0].slice(0, same).search(/[^_\/ ]*$/);
  const rest = names.map((name) => name.slice(word) || name);
  return rest.map((n) => n.length > 24 ? n.slice(0, 12) + '\u2026' + n.slice(-10) : n);
}

// Where each motion stands: rows of at most `columns`, the first row in front, all centred.
function places(motions, columns) {
  const found = [];
  let z = 0;
  for (let start = 0; start < motions.length; start += columns) {
    const row = motions.slice(start, start + columns);
    const width = (m) => m.high[0] - m.low[0] + SPACE;
    let x = -row.reduce((sum, m) => sum + width(m), 0) / 2;
    const front = Math.max(...row.map((m) => m.high[2]));
    const back = Math.min(...row.map((m) => m.low[2]));
    for (const m of row) {
      found.push(new THREE.Vector3(x - m.low[0] + SPACE / 2, 0, start ? z - front : 0));
      x += width(m);
    }
    z = (start ? z - front : 0) + back - SPACE;
  }
  return found;
}

class Stage {
  // Throws when the browser has no WebGL.
  constructor(canvas, names, motions) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true});
    this.renderer.gammaOutput = true;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.pixels = Math.min(window.devicePixelRatio || 1, 2);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(24, 1, 0.1, 400);
    this.following = 'none';

    const portrait = canvas.clientWidth < canvas.clientHeight;
    const wide = motions.length > 8 ? Math.ceil(Math.sqrt(2 * motions.length)) : 4;
    const columns = portrait ? Math.ceil(wide / 2) : wide;
    this.rows = Math.ceil(motions.length / columns);
    const spots = places(motions, columns);
    const shorter = shortNames(motions.map((motion) => motion.title));
    const given = cssValue('--given');
    this.figures = motions.map((motion, i) => {
      const figure = new Figure(motion, COLOURS[i % COLOURS.length], given);
      figure.group.position.copy(spots[i]);
      this.scene.add(figure.group);
      figure.name = document.createElement('span');
      figure.name.textContent = shorter[i];
      names.appendChild(figure.name);
      return figure;
    });
    this.box = new THREE.Box3();
    for (const {motion, group} of this.figures) {
      this.box.expandByPoint(new THREE.Vector3(...motion.low).add(group.position));
      this.box.expandByPoint(new THREE.Vector3(...motion.high).add(group.position));
    }
    this.buildLight();
    this.buildGround();
    this.orbit = new Orbit(canvas, () => this.draw());
    this.paint();
    this.resize();
    this.resetView();
  }

  buildLight() {
    const size = this.box.getSize(new THREE.Vector3());
    const reach = Math.min(Math.max(size.x, size.z) / 2 + 1.5, 30);
    this.scene.add(this.sky = new THREE.HemisphereLight(0xffffff, 0x9a96a2, .62));
    const key = this.key = new THREE.DirectionalLight(0xfff4e6, .82);
    key.castShadow = true;
    key.shadow.mapSize.set(2048, 2048);
    key.shadow.radius = 2.5;
    key.shadow.bias = -0.0006;
    Object.assign(
        key.shadow.camera, {left: -reach, right: reach, top: reach, bottom: -reach, far: 60});
    const rim = new THREE.DirectionalLight(0xbfd0ff, .4);
    rim.position.set(-2, 3, -4);
    this.scene.add(key, key.target, rim);
  }

  // A soft round floor with a grid of half metres that fades out, and what catches the shadows.
  buildGround() {
    this.floor = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      extensions: {derivatives: true},
      uniforms:
          {floor: {value: new THREE.Color()}, grid: {value: new THREE.Color()}, reach: {value: 1}},
      vertexShader: `varying vec2 spot;
        void main() {
          spot = (modelMatrix * vec4(position, 1.)).xz;
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.);
        }`,
      fragmentShader: `uniform vec3 floor, grid; uniform float reach; varying vec2 spot;
        float lines(float size) {
          vec2 at = spot / size, wide = fwidth(at);
          vec2 line = 1. - smoothstep(vec2(0.), 1.3 * wide, abs(fract(at - .5) - .5));
          return max(line.x, line.y) * (1. - smoothstep(.15, .5, max(wide.x, wide.y)));
        }
        void main() {
          float away = 1. - smoothstep(.35, 1., length(spot) / reach);
          float line = max(.30 * lines(.5), .55 * lines(2.));
          gl_FragColor = vec4(mix(floor, grid, line), away * max(.55, line));
        }`,
    });
    const plane = new THREE.PlaneBufferGeometry(160, 160).rotateX(-Math.PI / 2);
    this.scene.add(new THREE.Mesh(plane, this.floor));
    this.shade = new THREE.ShadowMaterial();
    const shade = new THREE.Mesh(plane, this.shade);
    shade.position.y = 0.001;
    shade.receiveShadow = true;
    this.scene.add(shade);
    this.buildContacts();
  }

  // A dark patch under each foot and under the pelvis, darker the closer they are to the ground.
  buildContacts() {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 64;
    const pen = canvas.getContext('2d');
    const fade = pen.createRadialGradient(32, 32, 0, 32, 32, 32);
    fade.addColorStop(0, 'rgba(0,0,0,1)');
    fade.addColorStop(.5, 'rgba(0,0,0,.45)');
    fade.addColorStop(1, 'rgba(0,0,0,0)');
    pen.fillStyle = fade;
    pen.fillRect(0, 0, 64, 64);
    const map = new THREE.CanvasTexture(canvas);
    const shape = new THREE.PlaneBufferGeometry(1, 1).rotateX(-Math.PI / 2);
    this.contacts = [];
    for (const figure of this.figures) {
      for (const [joint, size, height, dark] of [
               [10, .34, .12, .5], [11, .34, .12, .5], [0, 1.1, 1.2, .42]]) {
        const patch = new THREE.Mesh(
            shape, new THREE.MeshBasicMaterial({map, transparent: true, depthWrite: false}));
        patch.scale.set(size, 1, size);
        patch.renderOrder = 1;
        figure.group.add(patch);
        this.contacts.push({figure, joint, height, dark, patch});
      }
    }
  }

  // Takes the colours of the light or dark style sheet.
  paint() {
    this.floor.uniforms.floor.value.set(cssValue('--floor'));
    this.floor.uniforms.grid.value.set(cssValue('--grid'));
    this.shade.opacity = Number(cssValue('--shadow'));
    for (const {materials, beads} of this.figures) {
      for (const {color} of [materials.given, beads.given]) {
        color.set(cssValue('--given')).convertSRGBToLinear();
      }
    }
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.pixels);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  // The middle of those that the camera follows; null when it follows nobody.
  leader() {
    const chosen = this.figures.filter((f, i) => ['all', String(i)].includes(this.following));
    if (!chosen.length) return null;
    const middle = new THREE.Vector3();
    for (const figure of chosen) middle.add(figure.point(0)).add(figure.group.position);
    return middle.multiplyScalar(1 / chosen.length).setY(0.95);
  }

  // Looks from the front, a little from the left and above, at all paths or at those it follows.
  resetView() {
    const box = this.box.clone();
    const chosen = this.figures.filter((f, i) => ['all', String(i)].includes(this.following));
    if (chosen.length) {
      box.makeEmpty();
      for (const f of chosen) {
        const at = f.point(0).add(f.group.position).setY(0);
        box.expandByPoint(at.clone().add(new THREE.Vector3(-.9, 0, -.9)));
        box.expandByPoint(at.add(new THREE.Vector3(.9, 1.9, .9)));
      }
    }
    box.expandByPoint(box.getCenter(new THREE.Vector3()).setY(1.8));
    box.expandByPoint(box.getCenter(new THREE.Vector3()).setY(-.12));
    this.orbit.look(
        box, this.camera, this.figures.length > 1 ? -.12 : -.3, this.rows > 1 ? .3 : .17);
    this.draw();
  }

  follow(who) {
    this.following = who;
    this.resetView();
  }

  showTrails(visible) {
    for (const {trails} of this.figures)
      for (const {mesh} of trails) mesh.visible = visible;
  }

  show(seconds) {
    for (const figure of this.figures) figure.show(seconds);
    this.draw();
  }

  draw() {
    const leader = this.leader();
    if (leader) this.orbit.target.copy(leader);
    this.orbit.place(this.camera);
    this.key.target.position.copy(this.box.getCenter(new THREE.Vector3())).setY(0);
    this.key.position.copy(this.key.target.position).add(new THREE.Vector3(6, 15, 9));
    this.floor.uniforms.reach.value =
        Math.max(this.box.getSize(new THREE.Vector3()).length(), 4) * 1.5;
    for (const {figure, joint, height, dark, patch} of this.contacts) {
      const at = figure.point(joint, patch.position);
      patch.material.opacity = dark * Math.exp(-Math.max(at.y - .03, 0) / height);
      at.y = .002;
    }
    this.renderer.render(this.scene, this.camera);
    this.placeNames();
  }

  placeNames() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    for (const figure of this.figures) {
      const at = figure.point(0).add(figure.group.position).setY(-.02).project(this.camera);
      const x = (at.x + 1) / 2 * width, y = (1 - at.y) / 2 * height + 14;
      figure.name.style.transform =
          `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translateX(-50%)`;
      figure.name.style.visibility = at.z > 1 ? 'hidden' : 'visible';
    }
  }
}

// A camera on a sphere around `target`, moved by mouse, fingers, wheel and keys.
class Orbit {
  constructor(canvas, changed) {
    this.target = new THREE.Vector3(0, .95, 0);
    this.turn = 0;
    this.tilt = 0;
    this.distance = 6;
    this.canvas = canvas;
    this.changed = changed;
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', (e) => this.down(e));
    canvas.addEventListener('pointermove', (e) => this.move(e));
    for (const end of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(end, (e) => this.pointers.delete(e.pointerId));
    }
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    // The wheel belongs to the page until the stage has been clicked.
    canvas.addEventListener('wheel', (e) => {
      if (document.activeElement !== canvas && !e.ctrlKey) return;
      e.preventDefault();
      this.zoom(Math.exp(e.deltaY * (e.deltaMode ? .03 : .001)));
    }, {passive: false});
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const x = event.clientX - before[0], y = event.clientY - before[1];
    if (this.pointers.size > 1)
      this.pinch(event, x, y);
    else if (event.buttons & 2 || event.shiftKey)
      this.shift(x, y);
    else
      this.rotate(-x * .008, y * .006);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  // One of two fingers has moved by (x, y): apart zooms, together shifts and tilts.
  pinch(event, x, y) {
    const [, other] = [...this.pointers].find(([id]) => id !== event.pointerId);
    const [px, py] = this.pointers.get(event.pointerId);
    const was = Math.hypot(px - other[0], py - other[1]);
    const is = Math.hypot(event.clientX - other[0], event.clientY - other[1]);
    this.shift(x / 2, 0);
    this.tilt = Math.min(Math.max(this.tilt + y * .003, -.05), 1.5);
    this.zoom(was / Math.max(is, 1));
  }

  rotate(turn, tilt) {
    this.turn += turn;
    this.tilt = Math.min(Math.max(this.tilt + tilt, -.05), 1.5);
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, .8), 150);
    this.changed();
  }

  shift(x, y) {
    const scale = this.distance / this.canvas.clientHeight * .55;
    this.target.x -= x * scale * Math.cos(this.turn);
    this.target.z += x * scale * Math.sin(this.turn);
    this.target.y = Math.min(Math.max(this.target.y + y * scale, 0), 4);
    this.changed();
  }

  // The nearest place from which the whole box is seen, looking from `turn` and `tilt` (radians).
  look(box, camera, turn, tilt) {
    this.turn = turn;
    this.tilt = tilt;
    box.getCenter(this.target);
    const up = Math.tan(camera.fov * Math.PI / 360), across = up * camera.aspect;
    const toEye = this.direction(),
          right = new THREE.Vector3(Math.cos(this.turn), 0, -Math.sin(this.turn));
    const top = toEye.clone().cross(right);
    this.distance = 1;
    for (let i = 0; i < 8; i++) {
      const corner = new THREE
                         .Vector3(
                             i & 1 ? box.min.x : box.max.x, i & 2 ? box.min.y : box.max.y,
                             i & 4 ? box.min.z : box.max.z)
                         .sub(this.target);
      const need = Math.max(Math.abs(corner.dot(right)) / across, Math.abs(corner.dot(top)) / up);
      this.distance = Math.max(this.distance, corner.dot(toEye) + need * 1.06);
    }
  }

  direction() {
    return new THREE.Vector3(
        Math.sin(this.turn) * Math.cos(this.tilt), Math.sin(this.tilt),
        Math.cos(this.turn) * Math.cos(this.tilt));
  }

  place(camera) {
    camera.position.copy(this.target).addScaledVector(this.direction(), this.distance);
    camera.position.y = Math.max(camera.position.y, .05);
    camera.lookAt(this.target);
  }
}
