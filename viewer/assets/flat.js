// The figures without WebGL: thick lines on a plain canvas, seen by the same camera.

// From joint to joint, the joint whose colour it has, half its width in metres.
const STROKES = [
  [1, 4, 1, .075], [4, 7, 4, .05], [7, 10, 7, .036], [2, 5, 2, .075], [5, 8, 5, .05],
  [8, 11, 8, .036], [16, 18, 16, .047], [18, 20, 18, .037], [20, 22, 20, .03], [17, 19, 17, .047],
  [19, 21, 19, .037], [21, 23, 21, .03], [1, 2, 0, .11], [0, 6, 3, .13], [6, 9, 6, .135],
  [16, 17, 9, .06], [9, 12, 9, .07], [12, 15, 12, .045], [15, CROWN, 15, .098],
  [10, 28, 10, .03], [11, 29, 11, .03],
];

class FlatView extends View {
  constructor(canvas, names, motions) {
    super(canvas, names, motions);
    this.pen = canvas.getContext('2d');
    this.trails = [];
    this.resize();
    this.arrange(false);
  }

  paint() {}
  lighten() {}

  resized(width, height) {
    const pixels = this.pixels = window.devicePixelRatio || 1;
    this.canvas.width = width * pixels;
    this.canvas.height = height * pixels;
  }

  setTrails(joints, length) {
    this.trailLength = length;
    this.trails = length ? this.actors.map((a) => [a, joints(a.motion)]) : [];
    this.draw();
  }

  draw() {
    this.placeCamera();
    const {pen, pixels, canvas} = this;
    pen.setTransform(pixels, 0, 0, pixels, 0, 0);
    pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    pen.lineCap = pen.lineJoin = 'round';
    for (const actor of this.actors) this.drawShadow(actor);
    for (const [actor, joints] of this.trails) {
      joints.forEach((joint, nth) => this.drawTrail(actor, joint, nth));
    }
    const far = (a) => -this.camera.position.distanceTo(this.point(a, 0));
    for (const actor of [...this.actors].sort((a, b) => far(a) - far(b))) this.drawFigure(actor);
    pen.globalAlpha = 1;
    this.placeNames();
  }

  // Pixels of a metre at a point.
  scale(point) {
    const away = this.camera.position.distanceTo(point);
    return this.canvas.clientHeight / (2 * Math.tan(this.camera.fov * Math.PI / 360) * away);
  }

  drawShadow(actor) {
    const at = this.point(actor, 0).setY(0), size = .42 * this.scale(at), {pen} = this;
    const high = Math.max(Math.sin(this.orbit.tilt), .04), spot = this.project(at);
    if (spot.z > 1) return;
    pen.globalAlpha = .16;
    pen.fillStyle = '#000';
    pen.beginPath();
    pen.ellipse(spot.x, spot.y, size, size * high, 0, 0, 7);
    pen.fill();
  }

  drawFigure(actor) {
    const {pen} = this, given = cssValue('--given');
    pen.globalAlpha = this.over && actor === this.actors[0] ? .35 : 1;
    const strokes = STROKES.map(([from, to, owner, width]) => {
      const a = this.point(actor, from), b = this.point(actor, to);
      const size = 2 * width * this.scale(a), middle = a.clone().add(b).multiplyScalar(.5);
      const far = this.camera.position.distanceTo(middle);
      return {far, a, b, owner, size, head: to === CROWN};
    });
    strokes.sort((s, t) => t.far - s.far);
    const edge = cssValue('--panel');
    for (const {a, b, owner, size, head} of strokes) {
      if (head) b.copy(a.lerp(b, .55));
      this.project(a);
      this.project(b);
      if (a.z > 1 || b.z > 1) continue;
      const own = actor.motion.highlighted.includes(owner) ? given : actor.colour;
      for (const [colour, width] of [[edge, size + 3], [own, size]]) {
        pen.strokeStyle = colour;
        pen.lineWidth = width;
        pen.beginPath();
        pen.moveTo(a.x, a.y);
        pen.lineTo(b.x, b.y + .01);  // a line without length is none, and so no head
        pen.stroke();
      }
    }
  }

  drawTrail(actor, joint, nth) {
    const {motion, at} = actor, {pen, trailLength: length} = this;
    const fixed = length === 'past' || length === 'whole';
    const first = fixed ? 0 : Math.max(Math.ceil((this.seconds - length) * motion.fps), 0);
    const last = length === 'whole' ? motion.frames - 1 : Math.floor(motion.frameAt(this.seconds));
    pen.globalAlpha = .7;
    pen.lineWidth = 2.5;
    pen.strokeStyle = trailColour(actor, joint, nth, cssValue('--given'));
    pen.beginPath();
    for (let f = first; f <= last; f++) {
      const spot = this.project(motion.place(f, joint, new THREE.Vector3()).add(at));
      pen.lineTo(spot.x, spot.y);
    }
    pen.stroke();
  }
}
