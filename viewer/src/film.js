// Records what the 3-D view shows while it plays, as WebM.

const TYPES = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm']
/** Of the stream, a second; what is drawn less often is repeated. */
const FRAME_RATE = 30
const BITS_PER_S = 12e6

export function canFilm() {
  return typeof MediaRecorder !== 'undefined' && TYPES.some(type => MediaRecorder.isTypeSupported(type))
}

export class Film {
  /** `size` is of the pictures in pixels. */
  constructor({ width, height }) {
    this.canvas = Object.assign(document.createElement('canvas'), { width, height })
    this.context = this.canvas.getContext('2d')
    this.parts = []
    const mimeType = TYPES.find(type => MediaRecorder.isTypeSupported(type))
    this.recorder = new MediaRecorder(this.canvas.captureStream(FRAME_RATE), { mimeType, videoBitsPerSecond: BITS_PER_S })
    this.recorder.ondataavailable = e => this.parts.push(e.data)
    this.recorder.start(1000)
  }

  /** Takes what canvases over one another show. */
  take(...layers) {
    for (const layer of layers) this.context.drawImage(layer, 0, 0, this.canvas.width, this.canvas.height)
  }

  /** Ends the film and gives it. */
  end() {
    return new Promise((resolve, reject) => {
      this.recorder.onstop = () => resolve(new Blob(this.parts, { type: 'video/webm' }))
      this.recorder.onerror = e => reject(e.error)
      this.recorder.stop()
    })
  }
}
