// A worker: gets its files once, then one request after another.

import { Decoder } from './data/decode.js'
import { HttpFiles, MemoryFiles } from './data/files.js'

let decoder = null

self.onmessage = async ({ data }) => {
  if (data.files) {
    decoder = new Decoder(data.files.base ? new HttpFiles(data.files.base) : new MemoryFiles(data.files.memory))
    return
  }
  const { number, request } = data
  try {
    const [result, transfer] = await decoder.run(request)
    self.postMessage({ number, result }, transfer)
  } catch (error) {
    self.postMessage({ number, error: { message: String(error.message ?? error), path: error.path } })
  }
}
