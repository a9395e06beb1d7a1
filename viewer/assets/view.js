// What both ways of drawing (assets/stage.js, assets/flat.js) share: the actors and their places,
// the camera, the names.
const COLOURS = [
  '#4f79ea', '#12a391', '#9a62e6', '#dd5582', '#6a9e2c', '#6b7a94', '#2b9bd1', '#b8654a', '#c04fc0',
  '#3d8a5c'
];
const SPACE = 0.35;  // metres between the boxes that two figures reach
const ROW_SPACE = 0.7;
const NAME_HEIGHT = 24;  // pixels

function cssValue(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// The names without the words that all begin with, the middle of long ones left out.
function shortNames(names) {
  let same = 0;
  if (names.length > 1)
    while (names.every((n) => n[same] && n[same] === names[0][same])) same++;
  const word = names[0].slice(0, same).search(/[^_\/ ]*$/);
  const rest = names.map((name) => name.slice(word) || name);
  return rest.map((n) => n.length > 24 ? n.slice(0, 12) + '\u2026' + n.slice(-10) : n);
}

// Where each motion stands: `rows` of about as many each, the first in front, all centred; every
// second one is shifted by half a place, so that it is seen between those before it.
function placesBeside(motions, rows) {
  const columns = Math.ceil(motions.length / rows), found = [];
  for (let start = 0, row = 0, edge = 0; start < motions.length; start += columns, row++) {
    const line = motions.slice(start, start + columns);
    const width = (m) => m.high[0] - m.low[0] + SPACE;
    const whole = line.reduce((sum, m) => sum + width(m), 0);
    let x = -whole / 2;
    if (row % 2 && line.length % 2 === columns % 2) x += whole / line.length / 2;
    const z = row ? edge - Math.max(...line.map((m) => m.high[2])) : 0;
    for (const m of line) {
      found.push({row, at: new THREE.Vector3(x - m.low[0] + SPACE / 2, 0, z)});
      x += width(m);
    }
    edge = z + Math.min(...line.map((m) => m.low[2])) - ROW_SPACE;
  }
  return found;
}

// All begin at one spot.
function placesOver(motions) {
  const first = motions[0].place(0, 0, new THREE.Vector3());
  const place = (m) => first.clone().sub(m.place(0, 0, new THREE.Vector3())).setY(0);
  return motions.map((m) => ({row: 0, at: place(m)}));
}

class View {
  constructor(canvas, names, motions) {
    this.canvas = canvas;
    this.camera = new THREE.PerspectiveCamera(24, 1, 0.3, 400);
    this.orbit = new Orbit(canvas, () => this.draw());
    this.following = 'none';
    this.over = false;
    this.seconds = 0;
    const shorter = shortNames(motions.map((motion) => motion.title));
    this.actors = motions.map((motion, i) => {
      const name = document.createElement('span');
      name.textContent = shorter[i];
      names.appendChild(name);
      const actor = {motion, name, colour: COLOURS[i % COLOURS.length], at: new THREE.Vector3()};
      name.style.setProperty('--tint', actor.colour);
      actor.now = motion.sample(0, new Float32Array(3 * POINTS));
      return actor;
    });
  }

  place() {
    const motions = this.actors.map((actor) => actor.motion), count = motions.length;
    const wide = count > 8 ? Math.ceil(Math.sqrt(2 * count)) : 4;
    const columns = this.portrait() ? Math.ceil(wide / 2) : wide;
    this.rows = this.over ? 1 : Math.ceil(count / columns);
    const places = this.over ? placesOver(motions) : placesBeside(motions, this.rows);
    this.box = new THREE.Box3();
    this.actors.forEach((actor, i) => {
      const {motion, at} = actor;
      at.copy(places[i].at);
      actor.row = places[i].row;
      this.box.expandByPoint(new THREE.Vector3(...motion.low).add(at));
      this.box.expandByPoint(new THREE.Vector3(...motion.high).add(at));
    });
  }

  portrait() {
    return this.canvas.clientWidth < this.canvas.clientHeight;
  }

  // Side by side, or one over the other; then the first is a ghost behind the others.
  arrange(over) {
    this.over = over;
    this.place();
    this.arranged();
    this.resetView();
  }
  arranged() {}

  // A point of an actor where it is now.
  point(actor, index, out = new THREE.Vector3()) {
    return out.fromArray(actor.now, 3 * index).add(actor.at);
  }

  followed() {
    return this.actors.filter((_, i) => ['all', String(i)].includes(this.following));
  }

  follow(who) {
    this.following = who;
    this.resetView();
  }

  // Looks at all paths, or at those it follows: from the front, a little from the left and above,
  // unless it is told from where (radians).
  resetView(turn, tilt) {
    if (turn === undefined) turn = this.actors.length > 1 && !this.over ? -.12 : -.3;
    if (tilt === undefined) tilt = this.rows < 2 ? .17 : this.portrait() ? .46 : .34;
    const box = this.box.clone(), chosen = this.followed();
    if (chosen.length) {
      box.makeEmpty();
      for (const actor of chosen) {
        const at = this.point(actor, 0).setY(0);
        box.expandByPoint(at.clone().add(new THREE.Vector3(-.9, 0, -.9)));
        box.expandByPoint(at.add(new THREE.Vector3(.9, 1.9, .9)));
      }
    }
    box.expandByPoint(box.getCenter(new THREE.Vector3()).setY(1.8));
    box.expandByPoint(box.getCenter(new THREE.Vector3()).setY(-.12));
    this.orbit.look(box, this.camera, turn, tilt);
    this.draw();
  }

  show(seconds) {
    this.seconds = seconds;
    for (const {motion, now} of this.actors) motion.sample(seconds, now);
    this.draw();
  }

  placeCamera() {
    const chosen = this.followed();
    if (chosen.length) {
      const middle = new THREE.Vector3();
      for (const actor of chosen) middle.add(this.point(actor, 0));
      this.orbit.target.copy(middle.multiplyScalar(1 / chosen.length).setY(0.95));
    }
    this.orbit.place(this.camera);
    this.camera.updateMatrixWorld();
  }

  // In pixels of the page, with the depth in z: above 1 it is behind the camera.
  project(point) {
    point.project(this.camera);
    point.x = (point.x + 1) / 2 * this.canvas.clientWidth;
    point.y = (1 - point.y) / 2 * this.canvas.clientHeight;
    return point;
  }

  // Where a name begins and its depth: under the feet of the first row, over the heads of the
  // others; of overlaid figures in a list in the corner.
  nameSpot(actor, index) {
    if (this.over) return {actor, x: 12, y: 12 + 28 * index, z: 0};
    const at = this.point(actor, 0);
    this.project(at.setY(actor.row ? at.y + .9 : -.02));
    const y = actor.row ? at.y - NAME_HEIGHT : at.y + 14;
    return {actor, x: at.x - actor.nameWidth / 2, y, z: at.z};
  }

  // A name that would cover one of a nearer figure moves away from its own figure.
  placeNames() {
    const spots = this.actors.map((actor, i) => this.nameSpot(actor, i)), placed = [];
    for (const spot of spots.sort((a, b) => a.z - b.z)) {
      const {style} = spot.actor.name, right = spot.x + spot.actor.nameWidth;
      const covers = (other) => spot.x < other.x + other.actor.nameWidth && other.x < right &&
          Math.abs(spot.y - other.y) < NAME_HEIGHT;
      for (let other = placed.find(covers); other; other = placed.find(covers)) {
        spot.y = other.y + (spot.actor.row ? -1 : 1) * (NAME_HEIGHT + .1);
      }
      style.visibility = spot.z > 1 ? 'hidden' : 'visible';
      style.transform = `translate(${spot.x.toFixed(1)}px, ${spot.y.toFixed(1)}px)`;
      if (spot.z <= 1) placed.push(spot);
    }
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    for (const actor of this.actors) actor.nameWidth = actor.name.offsetWidth;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.resized(width, height);
  }
}
