// Voxels: one square for each face that meets free space, drawn as instances.

import { BufferAttribute, DoubleSide, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, ShaderMaterial, Vector3 } from 'three'

const VERTEX = `
uniform vec3 first;
uniform float cell;
uniform sampler2D tags;
attribute vec4 place;
varying vec3 color;
void main() {
  float side = floor(place.w / 256.0);
  float tag = place.w - 256.0 * side;
  vec2 q = position.xy;
  vec3 corner = side < 0.5 ? vec3(q, 1.0) : side < 1.5 ? vec3(1.0, q) : side < 2.5 ? vec3(0.0, q) : side < 3.5 ? vec3(q.x, 1.0, q.y) : vec3(q.x, 0.0, q.y);
  float light = side < 0.5 ? 1.0 : side < 2.5 ? 0.78 : 0.62;
  color = texture2D(tags, vec2((tag + 0.5) / 32.0, 0.5)).rgb * light;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(first + cell * (place.xyz + corner), 1.0);
}`

export class VoxelFaces {
  constructor(style) {
    const material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: 'varying vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }', side: DoubleSide,
      uniforms: { first: { value: new Vector3() }, cell: { value: 1 }, tags: style.shared.tags },
    })
    this.object = new Mesh(new InstancedBufferGeometry(), material)
    this.object.frustumCulled = false
    this.object.matrixAutoUpdate = false
    this.shown = null
  }

  /** Faces of a grid `about` that hangs on an agent. */
  show(faces, about, worldFromAgent) {
    this.object.visible = true
    this.object.matrix.copy(worldFromAgent)
    this.object.matrixWorldNeedsUpdate = true
    if (faces === this.shown) return
    this.shown = faces
    const geometry = new InstancedBufferGeometry()
    geometry.setAttribute('position', new BufferAttribute(new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]), 3))
    geometry.setIndex([0, 1, 2, 0, 2, 3])
    geometry.setAttribute('place', new InstancedBufferAttribute(faces.cells, 4))
    geometry.instanceCount = faces.count
    this.object.geometry.dispose()
    this.object.geometry = geometry
    const { first, cell } = this.object.material.uniforms
    cell.value = faces.merge * about.voxel_m
    first.value.set(faces.first[0] * about.voxel_m - about.range_m, faces.first[1] * about.voxel_m - about.range_m, about.lower_m + (about.mount_z_m ?? 0))
  }

  hide() {
    this.object.visible = false
  }
}
