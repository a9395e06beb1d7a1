// A soft round floor with a grid of half metres that fades out, what catches the shadows, and the
// dark patches under feet and pelvis.
const FLOOR_VERTEX = `
varying vec2 spot;
void main() {
  spot = (modelMatrix * vec4(position, 1.)).xz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.);
}`;
const FLOOR_FRAGMENT = `
uniform vec3 floor_, grid; uniform float reach; uniform vec2 centre; varying vec2 spot;
float lines(float size) {
  vec2 at = spot / size, wide = fwidth(at);
  vec2 line = 1. - smoothstep(vec2(0.), 1.3 * wide, abs(fract(at - .5) - .5));
  return max(line.x, line.y) * (1. - smoothstep(.15, .5, max(wide.x, wide.y)));
}
void main() {
  float away = 1. - smoothstep(.35, 1., length(spot - centre) / reach);
  float line = max(.30 * lines(.5), .55 * lines(2.));
  gl_FragColor = vec4(mix(floor_, grid, line), away * max(.55, line));
}`;

class Ground {
  constructor(actors) {
    this.group = new THREE.Group();
    this.floor = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      extensions: {derivatives: true},
      uniforms: {
        floor_: {value: new THREE.Color()},
        grid: {value: new THREE.Color()},
        reach: {value: 1},
        centre: {value: new THREE.Vector2()},
      },
      vertexShader: FLOOR_VERTEX,
      fragmentShader: FLOOR_FRAGMENT,
    });
    const plane = new THREE.PlaneBufferGeometry(160, 160).rotateX(-Math.PI / 2);
    this.group.add(new THREE.Mesh(plane, this.floor));
    // Without depth: the patches lie a millimetre above, too little for some depth buffers.
    this.shade = new THREE.ShadowMaterial({depthWrite: false});
    const shade = new THREE.Mesh(plane, this.shade);
    shade.position.y = 0.001;
    shade.receiveShadow = true;
    this.group.add(shade);
    this.buildContacts(actors);
  }

  buildContacts(actors) {
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
    for (const actor of actors) {
      for (const [joint, size, height, dark] of [
               [10, .34, .12, .5], [11, .34, .12, .5], [0, 1.1, 1.2, .42]]) {
        const patch = new THREE.Mesh(
            shape, new THREE.MeshBasicMaterial({map, transparent: true, depthWrite: false}));
        patch.scale.set(size, 1, size);
        patch.renderOrder = 1;
        this.group.add(patch);
        this.contacts.push({actor, joint, height, dark, patch});
      }
    }
  }

  // Takes the colours of the light or dark style sheet.
  paint() {
    this.floor.uniforms.floor_.value.set(cssValue('--floor'));
    this.floor.uniforms.grid.value.set(cssValue('--grid'));
    this.shade.opacity = Number(cssValue('--shadow'));
  }

  // Under this box of all paths.
  reach(box) {
    const centre = box.getCenter(new THREE.Vector3());
    this.floor.uniforms.centre.value.set(centre.x, centre.z);
    this.floor.uniforms.reach.value = Math.max(box.getSize(new THREE.Vector3()).length(), 4) * 1.5;
  }

  // The patches are darker the closer the joint is to the ground.
  move(view) {
    for (const {actor, joint, height, dark, patch} of this.contacts) {
      const at = view.point(actor, joint, patch.position);
      patch.material.opacity = dark * Math.exp(-Math.max(at.y - .03, 0) / height);
      at.y = .002;
    }
  }
}
