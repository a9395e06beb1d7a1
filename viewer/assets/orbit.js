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
