// The path of a joint as a ribbon that faces the camera: all of it lies in the graphics memory, of
// which a stretch around now is drawn.
const TRAIL_VERTEX = `
attribute vec3 way; attribute float side, when;
uniform float now, span, width;
varying float across, age;
void main() {
  age = now - when;
  across = side;
  vec4 eye = modelViewMatrix * vec4(position, 1.);
  vec3 out_ = cross((modelViewMatrix * vec4(way, 0.)).xyz, normalize(eye.xyz));
  float size = length(out_);
  float thin = age < 0. ? .45 : mix(1., .3, clamp(age / span, 0., 1.));
  if (size > 1e-9) eye.xyz += out_ / size * side * width * thin;
  gl_Position = projectionMatrix * eye;
}`;
const TRAIL_FRAGMENT = `
uniform vec3 colour; uniform float span, tail;
varying float across, age;
void main() {
  float round_ = sqrt(max(1. - across * across, 0.));
  float alpha = age < 0. ? tail * .6 : mix(1., tail, clamp(age / span, 0., 1.));
  gl_FragColor = vec4(colour * (.72 + .28 * round_), alpha);
}`;

class Trail {
  constructor(actor, joint, colour) {
    Object.assign(this, {actor, joint});
    this.skin = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      side: THREE.DoubleSide,
      vertexShader: TRAIL_VERTEX,
      fragmentShader: TRAIL_FRAGMENT,
      uniforms: {
        colour: {value: new THREE.Color(colour)},
        now: {value: 0},
        span: {value: 1},
        tail: {value: 0},
        width: {value: .014},
      },
    });
    this.mesh = new THREE.Mesh(this.ribbon(), this.skin);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 3;
  }

  // A smooth curve through the frames' places; slow clips get points between them.
  curve(at, out) {
    const {motion} = this.actor, place = new THREE.Vector3();
    out.set(0, 0, 0);
    for (const [frame, weight] of curveWeights(motion.frames, at)) {
      out.addScaledVector(motion.place(frame, this.joint, place), weight);
    }
    return out;
  }

  ribbon() {
    const {motion} = this.actor, {frames, fps} = motion, index = [];
    const steps = this.steps = Math.max(1, Math.round(60 / fps)), last = (frames - 1) * steps;
    const position = new Float32Array(6 * (last + 1)), way = new Float32Array(6 * (last + 1));
    const side = new Float32Array(2 * (last + 1)), when = new Float32Array(2 * (last + 1));
    const at = new THREE.Vector3(), before = new THREE.Vector3(), after = new THREE.Vector3();
    for (let f = 0; frames > 1 && f <= last; f++) {
      this.curve(f / steps, at);
      this.curve(Math.max(f - 1, 0) / steps, before);
      this.curve(Math.min(f + 1, last) / steps, after).sub(before);
      for (const k of [2 * f, 2 * f + 1]) {
        at.toArray(position, 3 * k);
        after.toArray(way, 3 * k);
        side[k] = k % 2 ? 1 : -1;
        when[k] = f / steps / fps;
      }
      if (f) index.push(2 * f - 2, 2 * f - 1, 2 * f, 2 * f, 2 * f - 1, 2 * f + 1);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setIndex(index);
    geometry.setAttribute('position', new THREE.BufferAttribute(position, 3));
    geometry.setAttribute('way', new THREE.BufferAttribute(way, 3));
    geometry.setAttribute('side', new THREE.BufferAttribute(side, 1));
    geometry.setAttribute('when', new THREE.BufferAttribute(when, 1));
    return geometry;
  }

  // `length`: seconds up to now, 'past' or 'whole'.
  show(seconds, length) {
    const {motion} = this.actor, {now, span, tail} = this.skin.uniforms;
    const {steps} = this, all = (motion.frames - 1) * steps;
    const fixed = length === 'past' || length === 'whole';
    const first = fixed ? 0 : Math.max(Math.ceil((seconds - length) * motion.fps) * steps, 0);
    const end = length === 'whole' ? all : Math.floor(motion.frameAt(seconds) * steps);
    now.value = Math.min(seconds, motion.seconds);
    span.value = fixed ? 2.5 : length;
    tail.value = fixed ? .5 : 0;
    this.mesh.geometry.setDrawRange(6 * Math.min(first, end), 6 * Math.max(end - first, 0));
  }

  dispose() {
    this.mesh.geometry.dispose();
    this.skin.dispose();
  }
}

// The joints' trails in an actor's colours: the prompt's own for prompted joints, and of two joints
// the second lighter.
function trailColour(actor, joint, nth, given) {
  if (actor.motion.highlighted.includes(joint)) return given;
  const colour = new THREE.Color(actor.colour), light = new THREE.Color('#ffffff');
  return '#' + colour.lerp(light, [0, .42, .22, .6][nth % 4]).getHexString();
}
