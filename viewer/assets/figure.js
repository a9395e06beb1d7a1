'use strict';

// A motion's frames and the figure drawn from them. Points of a frame: SMPL's 24 joints, then
// crown, face, heels and toe tips (viewer/figure.h). Metres, Y up.
const POINTS = 30;
const CROWN = 24, FACE = 25;

class Motion {
  constructor(data) {
    Object.assign(this, data);
    const bytes = Uint8Array.from(atob(data.points), (c) => c.charCodeAt(0));
    this.points = new Int16Array(bytes.buffer);
    this.seconds = (data.frames - 1) / data.fps;
    this.measure();
  }

  // The box around everything that the body reaches: {low: [x, y, z], high: [x, y, z]}.
  measure() {
    this.low = [0, 0, 0];
    this.high = [0, 0, 0];
    for (let i = 0; i < this.points.length; i++) {
      const value = this.points[i] * this.unit;
      this.low[i % 3] = Math.min(this.low[i % 3], value);
      this.high[i % 3] = Math.max(this.high[i % 3], value);
    }
  }

  // The frame shown at a time, with a fraction between frames; held at both ends.
  frameAt(seconds) {
    const at = Math.min(Math.max(seconds * this.fps, 0), this.frames - 1);
    return Math.abs(at - Math.round(at)) < 1e-4 ? Math.round(at) : at;
  }

  // Fills `out` with (POINTS, 3) metres; between two frames on the straight line.
  sample(seconds, out) {
    const at = this.frameAt(seconds), frame = Math.floor(at), share = at - frame;
    const size = 3 * POINTS, a = frame * size, b = share > 0 ? a + size : a;
    for (let i = 0; i < size; i++) {
      out[i] = this.unit * (this.points[a + i] * (1 - share) + this.points[b + i] * share);
    }
    return out;
  }
}

// From a point to a point, the joint whose rotation carries it, and [share of the way, radius].
// The left side:
const LEFT_LIMBS = [
  [1, 4, 1, [[0, .088], [.2, .086], [.55, .068], [.9, .053], [1, .052]]],
  [4, 7, 4, [[0, .052], [.12, .052], [.3, .056], [.55, .046], [.85, .032], [1, .033]]],
  [7, 26, 7, [[0, .034], [1, .032]]],
  [26, 10, 7, [[0, .032], [.5, .036], [1, .034]]],
  [7, 10, 7, [[0, .036], [1, .032]]],
  [10, 28, 10, [[0, .034], [1, .024]]],
  [13, 16, 13, [[0, .066], [.5, .062], [1, .056]]],
  [16, 18, 16, [[0, .055], [.3, .049], [.6, .044], [1, .036]]],
  [18, 20, 18, [[0, .037], [.2, .041], [.5, .035], [1, .025]]],
  [20, 22, 20, [[0, .025], [.6, .034], [1.1, .035], [1.6, .026], [1.9, .016]]],
];
// Every left joint or point is followed by the right one.
const LIMBS = LEFT_LIMBS
  .concat(LEFT_LIMBS.map(([a, b, owner, shape]) => [a + 1, b + 1, owner + 1, shape]))
  .concat([[12, 15, 12, [[0, .052], [1, .047]]]]);

// The trunk is a skin over rings: centre as [point, weight] pairs, half width, half depth, how far
// the ring turns from the hips' axis (0) to the shoulders' (1), and the joint that carries it.
const RINGS = [
  [[[1, .95], [2, .95], [0, -.9]], .02, .02, 0, 0],
  [[[1, .88], [2, .88], [0, -.76]], .085, .078, 0, 0],
  [[[1, .65], [2, .65], [0, -.3]], .147, .106, 0, 0],
  [[[1, .45], [2, .45], [0, .1]], .164, .118, 0, 0],
  [[[0, 1]], .157, .117, .05, 0],
  [[[0, .5], [3, .5]], .143, .108, .15, 0],
  [[[3, 1]], .132, .1, .3, 3],
  [[[3, .5], [6, .5]], .132, .099, .45, 3],
  [[[6, .75], [3, .25]], .14, .103, .6, 6],
  [[[9, .6], [6, .2], [3, .2]], .152, .108, .75, 6],
  [[[9, .6], [13, .2], [14, .2]], .163, .11, .9, 9],
  [[[9, .25], [13, .375], [14, .375]], .155, .1, 1, 9],
  [[[13, .5], [14, .5]], .128, .084, 1, 9],
  [[[13, .34], [14, .34], [12, .32]], .084, .066, 1, 9],
  [[[12, .8], [13, .1], [14, .1]], .053, .052, 1, 12],
];
const RING_POINTS = 24;

// A body of revolution about +Y with round ends.
function limbGeometry(length, shape) {
  const outline = [];
  const [first, last] = [shape[0], shape[shape.length - 1]];
  for (let i = 0; i < 6; i++) {
    const angle = i / 6 * Math.PI / 2;
    outline.push([first[1] * Math.sin(angle), first[0] * length - first[1] * Math.cos(angle)]);
  }
  for (const [share, radius] of shape) outline.push([radius, share * length]);
  for (let i = 1; i <= 6; i++) {
    const angle = i / 6 * Math.PI / 2;
    outline.push([last[1] * Math.cos(angle), last[0] * length + last[1] * Math.sin(angle)]);
  }
  const points = outline.map(([x, y]) => new THREE.Vector2(Math.max(x, 0), y));
  return new THREE.LatheBufferGeometry(points, 20);
}

class Figure {
  constructor(motion, colour, given) {
    this.motion = motion;
    this.now = new Float32Array(3 * POINTS);
    this.group = new THREE.Group();
    this.materials = {own: material(colour), given: material(given)};
    const highlighted = new Set(motion.highlighted);
    const skin = (joint) => highlighted.has(joint) ? this.materials.given : this.materials.own;

    motion.sample(0, this.now);
    this.limbs = LIMBS.map(([from, to, owner, shape]) => {
      const length = this.point(from).distanceTo(this.point(to));
      const mesh = new THREE.Mesh(limbGeometry(length, shape), skin(owner));
      return {mesh: this.add(mesh), from, to};
    });
    this.buildHead(skin(15));
    this.buildTrunk(highlighted);
    this.buildTrails(motion.trails.length ? motion.trails : [20, 21]);
    this.show(0);
  }

  add(mesh) {
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  point(index, out = new THREE.Vector3()) {
    return out.fromArray(this.now, 3 * index);
  }

  buildHead(skin) {
    this.head = new THREE.Group();
    const part = (radius, x, y, z, position) => {
      const mesh = this.add(new THREE.Mesh(new THREE.SphereBufferGeometry(radius, 28, 20), skin));
      mesh.scale.set(x, y, z);
      mesh.position.set(...position);
      this.head.add(mesh);
    };
    part(.1, .8, 1.02, .98, [0, .105, .012]);    // skull
    part(.1, .62, .8, .66, [0, .055, .036]);     // jaw
    part(.02, .62, 1.1, .9, [0, .07, .104]);     // nose
    this.group.add(this.head);
  }

  buildTrunk(highlighted) {
    const geometry = this.trunk = new THREE.BufferGeometry();
    const count = RINGS.length * RING_POINTS, index = [];
    for (let i = 0; i < count - RING_POINTS; i++) {
      const next = i % RING_POINTS === RING_POINTS - 1 ? i + 1 - RING_POINTS : i + 1;
      index.push(i, i + RING_POINTS, next, next, i + RING_POINTS, next + RING_POINTS);
    }
    geometry.setIndex(index);
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * count), 3));
    // One skin in two colours: the faces of the highlighted joints' rings are a second group.
    const perRing = 6 * RING_POINTS;
    RINGS.slice(0, -1).forEach(([, , , , owner], ring) => {
      geometry.addGroup(ring * perRing, perRing, highlighted.has(owner) ? 1 : 0);
    });
    this.add(new THREE.Mesh(geometry, [this.materials.own, this.materials.given]));
  }

  buildTrails(joints) {
    const beads = 36, ball = new THREE.SphereBufferGeometry(1, 8, 6);
    this.trails = joints.map((joint) => {
      const skin = this.motion.highlighted.includes(joint) ? 'given' : 'own';
      const mesh = new THREE.InstancedMesh(ball, this.materials[skin], beads);
      mesh.frustumCulled = false;
      mesh.visible = false;
      this.group.add(mesh);
      return {mesh, joint, beads};
    });
  }

  // Puts the whole body where it is at a time.
  show(seconds) {
    this.motion.sample(seconds, this.now);
    this.moveLimbs();
    this.moveHead();
    this.moveTrunk();
    this.moveTrails(seconds);
  }

  moveLimbs() {
    const up = new THREE.Vector3(0, 1, 0), way = new THREE.Vector3();
    for (const {mesh, from, to} of this.limbs) {
      this.point(from, mesh.position);
      this.point(to, way).sub(mesh.position).normalize();
      mesh.quaternion.setFromUnitVectors(up, way);
    }
  }

  moveHead() {
    const origin = this.point(15, this.head.position);
    const up = this.point(CROWN).sub(origin).normalize();
    const side = up.clone().cross(this.point(FACE).sub(origin)).normalize();
    const basis = new THREE.Matrix4().makeBasis(side, up, side.clone().cross(up));
    this.head.quaternion.setFromRotationMatrix(basis);
  }

  moveTrunk() {
    const centres = RINGS.map(([mix]) => {
      const centre = new THREE.Vector3();
      for (const [index, weight] of mix) centre.addScaledVector(this.point(index), weight);
      return centre;
    });
    const hips = this.point(1).sub(this.point(2)).normalize();
    const shoulders = this.point(16).sub(this.point(17)).normalize();
    const position = this.trunk.attributes.position;
    RINGS.forEach(([, width, depth, turn], ring) => {
      const before = centres[Math.max(ring - 1, 0)];
      const way = centres[Math.min(ring + 1, RINGS.length - 1)].clone().sub(before).normalize();
      const side = hips.clone().lerp(shoulders, turn);
      side.addScaledVector(way, -side.dot(way)).normalize();
      const front = side.clone().cross(way);
      for (let i = 0; i < RING_POINTS; i++) {
        const angle = i / RING_POINTS * 2 * Math.PI;
        const point = centres[ring].clone().addScaledVector(side, width * Math.cos(angle));
        point.addScaledVector(front, depth * Math.sin(angle));
        position.setXYZ(ring * RING_POINTS + i, point.x, point.y, point.z);
      }
    });
    position.needsUpdate = true;
    this.trunk.computeVertexNormals();
  }

  moveTrails(seconds) {
    const past = new Float32Array(3 * POINTS), matrix = new THREE.Matrix4();
    for (const {mesh, joint, beads} of this.trails) {
      if (!mesh.visible) continue;
      for (let i = 0; i < beads; i++) {
        const then = seconds - i * 0.03;
        this.motion.sample(then, past);
        const radius = then < 0 ? 0 : .017 * (1 - i / beads);
        matrix.makeScale(radius, radius, radius).setPosition(
          past[3 * joint], past[3 * joint + 1], past[3 * joint + 2]);
        mesh.setMatrixAt(i, matrix);
      }
      mesh.instanceMatrix.needsUpdate = true;
    }
  }
}

function material(colour) {
  return new THREE.MeshStandardMaterial({
    color: new THREE.Color(colour).convertSRGBToLinear(), roughness: .62, metalness: 0});
}
