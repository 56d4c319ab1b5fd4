// Starts the page: over a server's store, or over the files that the page itself holds.

import { App } from './app.js'
import { Cache } from './data/cache.js'
import { StoreView } from './data/store.js'
import { $, note } from './ui.js'

const MEGABYTE = 1 << 20
/** Decoded frames that are kept, bytes: less where the device says that it has little memory. */
const BUDGET = (navigator.deviceMemory ?? 8) < 4 ? 128 * MEGABYTE : 384 * MEGABYTE

/** `<script type="text/plain" data-file="PATH">` elements: base64 of each file of an excerpt. */
function embeddedFiles() {
  const elements = document.querySelectorAll('script[data-file]')
  if (!elements.length) return null
  const files = new Map()
  for (const element of elements) {
    const text = atob(element.textContent.trim())
    const bytes = new Uint8Array(text.length)
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i)
    files.set(element.dataset.file, bytes)
    element.remove()
  }
  return files
}

function overServer() {
  const readJson = async path => {
    const response = await fetch(path)
    if (!response.ok) throw new Error((await response.text()) || `${path}: the server answered ${response.status}`)
    return response.json()
  }
  const base = new URL('store/', location.href).href
  const cache = new Cache(() => new Worker('worker.js'), () => ({ base }), BUDGET)
  return new StoreView(readJson, cache)
}

function overFiles(files) {
  const text = new TextDecoder()
  const readJson = async path => {
    if (!files.has(path)) throw new Error(`this excerpt has no ${path}`)
    return JSON.parse(text.decode(files.get(path)))
  }
  const source = URL.createObjectURL(new Blob([$('worker-source').textContent], { type: 'text/javascript' }))
  // One worker: each would hold a copy of all files.
  const cache = new Cache(() => new Worker(source), () => ({ memory: files }), BUDGET, 1)
  return new StoreView(readJson, cache)
}

async function start() {
  const files = embeddedFiles()
  const store = await (files ? overFiles(files) : overServer()).open()
  const app = new App(store)
  // For tests, and for who looks under the bonnet.
  window.convoy = app
  await app.start()
}

start().catch(error => {
  console.error(error)
  $('notes').replaceChildren(note('bad', `The store cannot be shown: ${error.message}`))
})
