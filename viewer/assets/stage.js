// The stage in three dimensions: ground, light, figures, trails.
class Stage extends View {
  // Throws when the browser has no WebGL.
  constructor(canvas, names, motions) {
    const renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true});
    super(canvas, names, motions);
    this.renderer = renderer;
    renderer.gammaOutput = true;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFShadowMap;
    this.pixels = Math.min(window.devicePixelRatio || 1, 2);
    this.scene = new THREE.Scene();
    this.trails = [];
    const given = cssValue('--given');
    for (const actor of this.actors) {
      actor.figure = new Figure(actor, given);
      this.scene.add(actor.figure.group);
    }
    this.buildLight();
    this.ground = new Ground(this.actors);
    this.scene.add(this.ground.group);
    this.paint();
    this.resize();
    this.arrange(false);
  }

  buildLight() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x77748a, .58));
    const key = this.key = new THREE.DirectionalLight(0xfff4e6, .88);
    key.castShadow = true;
    key.shadow.mapSize.set(1024, 1024);
    key.shadow.radius = 4;
    key.shadow.bias = -0.0006;
    const rim = new THREE.DirectionalLight(0xbfd0ff, .5);
    rim.position.set(-2, 3, -4);
    this.scene.add(key, key.target, rim);
  }

  arranged() {
    this.actors.forEach(({figure, at}, i) => {
      figure.group.position.copy(at);
      figure.setGhost(this.over && i === 0);
    });
    for (const {mesh, actor} of this.trails) mesh.position.copy(actor.at);
    const size = this.box.getSize(new THREE.Vector3()), {key} = this;
    const reach = Math.min(Math.max(size.x, size.z) / 2 + 1.5, 30);
    Object.assign(
        key.shadow.camera, {left: -reach, right: reach, top: reach, bottom: -reach, far: 60});
    key.shadow.camera.updateProjectionMatrix();
    this.box.getCenter(key.target.position).setY(0);
    key.position.copy(key.target.position).add(new THREE.Vector3(6, 15, 9));
    this.ground.reach(this.box);
  }

  paint() {
    this.ground.paint();
    for (const {figure} of this.actors)
      figure.materials.given.color.set(cssValue('--given')).convertSRGBToLinear();
  }

  resized(width, height) {
    this.renderer.setPixelRatio(this.pixels);
    this.renderer.setSize(width, height, false);
  }

  // Trails of `joints(motion)`, so long as Trail.show says; none where the length is 0.
  setTrails(joints, length) {
    this.trailLength = length;
    for (const trail of this.trails) {
      this.scene.remove(trail.mesh);
      trail.dispose();
    }
    this.trails = [];
    for (const actor of length ? this.actors : []) {
      joints(actor.motion).forEach((joint, nth) => {
        const colour = trailColour(actor, joint, nth, cssValue('--given'));
        const trail = new Trail(actor, joint, colour);
        trail.mesh.position.copy(actor.at);
        this.scene.add(trail.mesh);
        this.trails.push(trail);
      });
    }
    this.draw();
  }

  // Where drawing is slow (no graphics card) the picture gets coarser instead of stuttering.
  lighten() {
    if (this.pixels <= .6) return;
    this.pixels *= .8;
    this.resize();
  }

  draw() {
    this.placeCamera();
    for (const {figure} of this.actors) figure.move();
    for (const trail of this.trails) trail.show(this.seconds, this.trailLength);
    this.ground.move(this);
    this.renderer.render(this.scene, this.camera);
    this.placeNames();
  }
}
