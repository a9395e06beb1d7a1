// The shapes of the figure, on the points of assets/motion.js.

// From a point to a point, the joint whose rotation carries it, and [share of the way, radius].
// The left side; every left joint or point is followed by the right one, the neck is between.
const LEFT_LIMBS = [
  [1, 4, 1, [[0, .088], [.2, .086], [.55, .068], [.9, .053], [1, .0515]]],
  [4, 7, 4, [[0, .0505], [.12, .052], [.3, .056], [.55, .046], [.85, .032], [1, .034]]],
  [7, 26, 7, [[0, .0345], [1, .031]]],
  [13, 16, 13, [[0, .06], [.5, .06], [1, .053]]],
  [12, 16, 13, [[0, .056], [.35, .054], [.7, .052], [1, .048]]],
  [16, 18, 16, [[0, .058], [.15, .058], [.4, .05], [.7, .043], [1, .037]]],
  [18, 20, 18, [[0, .0345], [.12, .039], [.3, .0405], [.6, .033], [1, .0255]]],
  [20, 22, 20, [[0, .0245], [.3, .028], [.7, .035], [1.1, .036], [1.5, .03], [1.8, .022]]],
];
const right = (point) => point === 12 ? 12 : point + 1;
const LIMBS =
    LEFT_LIMBS.concat(LEFT_LIMBS.map(([a, b, owner, shape]) => [right(a), b + 1, owner + 1, shape]))
        .concat([[12, 15, 12, [[0, .055], [.4, .054], [1, .053]]]]);

// The trunk is a skin over rings: centre as [point, weight] pairs, half width, half depth, how far
// the ring turns from the hips' axis (0) to the shoulders' (1), and the joints that carry it.
const TRUNK = [
  [[[1, .93], [2, .93], [0, -.86]], .02, .02, 0, [0, 1, 2]],
  [[[1, .85], [2, .85], [0, -.7]], .1, .086, 0, [0, 1, 2]],
  [[[1, .62], [2, .62], [0, -.24]], .153, .112, 0, [0, 1, 2]],
  [[[1, .25], [2, .25], [0, .5]], .164, .121, 0, [0]],
  [[[0, .5], [3, .5]], .148, .11, .15, [0]],
  [[[3, .6], [6, .4]], .134, .101, .4, [3]],
  [[[6, .45], [9, .3], [13, .125], [14, .125]], .15, .111, .7, [6]],
  [[[9, .45], [13, .275], [14, .275]], .163, .112, .9, [9]],
  [[[9, .1], [13, .45], [14, .45]], .156, .104, 1, [9]],
  [[[12, .3], [13, .35], [14, .35]], .146, .093, 1, [9]],
  [[[12, .74], [13, .13], [14, .13]], .1, .073, 1, [9]],
  [[[12, .84], [15, .16]], .056, .055, 1, [12]],
];

// A foot lies along a line between two points, its up is from heel to ankle: [share of the way,
// height above the line, half width, half height] of its rings.
const FOOT = [
  [-.24, .006, .004, .004],
  [-.2, .005, .022, .022],
  [-.08, .003, .032, .033],
  [.15, .012, .035, .043],
  [.4, .009, .037, .041],
  [.7, .002, .041, .034],
  [1, -.002, .043, .031],
  [1.1, -.005, .034, .024],
  [1.16, -.006, .004, .004],
];
const TOES = [
  [-.25, -.004, .034, .025],
  [.1, -.004, .044, .0295],
  [.6, -.003, .042, .025],
  [1, -.002, .034, .02],
  [1.2, -.004, .022, .014],
  [1.28, -.005, .003, .003],
];

const RING_POINTS = 24;

// A value of the smooth (Catmull-Rom) curve through `values`, as weights of its neighbours.
function curveWeights(count, at) {
  const k = Math.min(Math.floor(at), count - 2), t = at - k;
  const weights = [
    (-t + 2 * t * t - t * t * t) / 2, (2 - 5 * t * t + 3 * t * t * t) / 2,
    (t + 4 * t * t - 3 * t * t * t) / 2, (t * t * t - t * t) / 2
  ];
  return weights.map((weight, i) => [Math.min(Math.max(k - 1 + i, 0), count - 1), weight]);
}

// The trunk's rings and two more between each pair, so that the skin is smooth.
function smoothTrunk() {
  const rings = [];
  for (let i = 0; i <= 3 * (TRUNK.length - 1); i++) {
    const mix = new Map(), sizes = [0, 0, 0];
    for (const [key, weight] of curveWeights(TRUNK.length, i / 3)) {
      for (const [point, share] of TRUNK[key][0])
        mix.set(point, (mix.get(point) || 0) + weight * share);
      for (let s = 0; s < 3; s++) sizes[s] += weight * TRUNK[key][s + 1];
    }
    rings.push([[...mix], ...sizes, TRUNK[Math.round(i / 3)][4]]);
  }
  return rings;
}
const RINGS = smoothTrunk();

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

// A skin over `rings` closed rings, its points still to be set by setRing.
function skinGeometry(rings) {
  const geometry = new THREE.BufferGeometry(), index = [];
  for (let i = 0; i < (rings - 1) * RING_POINTS; i++) {
    const next = i % RING_POINTS === RING_POINTS - 1 ? i + 1 - RING_POINTS : i + 1;
    index.push(i, i + RING_POINTS, next, next, i + RING_POINTS, next + RING_POINTS);
  }
  geometry.setIndex(index);
  const points = new Float32Array(3 * rings * RING_POINTS);
  geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
  return geometry;
}

// An ellipse about `centre`; `side`, `front` and the way along the skin are a right-handed system.
function setRing(geometry, ring, centre, side, width, front, depth) {
  const position = geometry.attributes.position;
  for (let i = 0; i < RING_POINTS; i++) {
    const angle = i / RING_POINTS * 2 * Math.PI;
    const a = width * Math.cos(angle), b = depth * Math.sin(angle);
    position.setXYZ(
        ring * RING_POINTS + i, centre.x + a * side.x + b * front.x,
        centre.y + a * side.y + b * front.y, centre.z + a * side.z + b * front.z);
  }
}

// An egg with chin and nose, facing +Z, its origin at the head joint.
function headGeometry() {
  const geometry = new THREE.SphereBufferGeometry(1, 40, 32);
  const position = geometry.attributes.position;
  for (let i = 0; i < position.count; i++) {
    const x = position.getX(i), y = position.getY(i), z = position.getZ(i);
    const low = Math.max(-y, 0), front = Math.max(z, 0);
    const nose = .013 * Math.exp(-(x * x * 40 + (y + .14) ** 2 * 26)) * front;
    position.setXYZ(
        i, .079 * x * (1 - .16 * low * low), .087 + .116 * y - .006 * low * front,
        .012 + .097 * z * (1 - .16 * low) + .016 * low + nose);
  }
  geometry.computeVertexNormals();
  return geometry;
}

function material(colour) {
  return new THREE.MeshStandardMaterial(
      {color: new THREE.Color(colour).convertSRGBToLinear(), roughness: .5, metalness: 0});
}
