// A ghost lies a few centimetres deeper than it is: where it and another figure are in one place,
// the other one is seen.
const DEEPER = {polygonOffset: true, polygonOffsetFactor: 0, polygonOffsetUnits: 3000};
const DEPTH_ALONE =
    new THREE.MeshBasicMaterial({colorWrite: false, transparent: true, ...DEEPER});

// The figure of one actor (assets/view.js): meshes in a group of their own, moved to where its
// points are.
class Figure {
  constructor({motion, colour, now}, given) {
    this.now = now;
    this.group = new THREE.Group();
    this.materials = {own: material(colour), given: material(given)};
    const highlighted = new Set(motion.highlighted);
    const skin = (joint) => highlighted.has(joint) ? this.materials.given : this.materials.own;

    this.limbs = LIMBS.map(([from, to, owner, shape]) => {
      const length = this.point(from).distanceTo(this.point(to));
      return {mesh: this.add(limbGeometry(length, shape), skin(owner)), from, to};
    });
    this.feet = [];
    for (const side of [0, 1]) {
      const [ankle, ball, heel, toe] = [7 + side, 10 + side, 26 + side, 28 + side];
      for (const [from, to, owner, rings] of [[heel, ball, ankle, FOOT], [ball, toe, ball, TOES]]) {
        const geometry = this.add(skinGeometry(rings.length), skin(owner)).geometry;
        this.feet.push({geometry, from, to, heel, ankle, rings});
      }
    }
    this.head = this.add(headGeometry(), skin(15));
    this.buildTrunk(highlighted);
    this.move();
  }

  add(geometry, skin) {
    const mesh = new THREE.Mesh(geometry, skin);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  point(index, out = new THREE.Vector3()) {
    return out.fromArray(this.now, 3 * index);
  }

  // One skin in two colours: faces whose joints are all highlighted are groups with the second
  // material.
  buildTrunk(highlighted) {
    this.trunk = skinGeometry(RINGS.length);
    const faces = 6 * RING_POINTS;
    RINGS.slice(0, -1).forEach(([, , , , owners], ring) => {
      const given = owners.every((joint) => highlighted.has(joint));
      this.trunk.addGroup(ring * faces, faces, given ? 1 : 0);
    });
    this.add(this.trunk, [this.materials.own, this.materials.given]);
  }

  // A ghost is seen through, but only its front: its depth is drawn before its colour.
  setGhost(on) {
    for (const skin of Object.values(this.materials)) {
      Object.assign(
          skin, DEEPER,
          {transparent: on, opacity: on ? .45 : 1, polygonOffset: on, needsUpdate: true});
    }
    for (const mesh of this.group.children) {
      mesh.remove(...mesh.children);
      mesh.renderOrder = on ? 6 : 0;
      mesh.castShadow = !on;
      if (!on) continue;
      const depth = new THREE.Mesh(mesh.geometry, DEPTH_ALONE);
      depth.renderOrder = 5;
      depth.frustumCulled = false;
      mesh.add(depth);
    }
  }

  // Puts the whole body where its points are.
  move() {
    this.moveLimbs();
    this.moveHead();
    this.moveTrunk();
    this.feet.forEach((foot) => this.moveFoot(foot));
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
    RINGS.forEach(([, width, depth, turn], ring) => {
      const before = centres[Math.max(ring - 1, 0)];
      const way = centres[Math.min(ring + 1, RINGS.length - 1)].clone().sub(before).normalize();
      const side = hips.clone().lerp(shoulders, turn);
      side.addScaledVector(way, -side.dot(way)).normalize();
      setRing(this.trunk, ring, centres[ring], side, width, side.clone().cross(way), depth);
    });
    this.finish(this.trunk);
  }

  moveFoot({geometry, from, to, heel, ankle, rings}) {
    const start = this.point(from), way = this.point(to).sub(start);
    const side = this.point(ankle).sub(this.point(heel)).cross(way).normalize();
    const up = way.clone().cross(side).normalize();
    rings.forEach(([share, height, width, depth], ring) => {
      const centre = start.clone().addScaledVector(way, share).addScaledVector(up, height);
      setRing(geometry, ring, centre, side, width, up.clone().negate(), depth);
    });
    this.finish(geometry);
  }

  finish(geometry) {
    geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
  }
}
