// Bundles the page into bins/view/assets: index.html, style.css, app.js and worker.js. `node build.mjs FOLDER` writes elsewhere.

import { mkdir, readFile, writeFile } from 'node:fs/promises'
import path from 'node:path'
import { fileURLToPath } from 'node:url'
import { build } from 'esbuild'

const here = path.dirname(fileURLToPath(import.meta.url))
const out = path.resolve(process.argv[2] ?? path.join(here, '../bins/view/assets'))
await mkdir(out, { recursive: true })

const bundle = (entry, outfile) => build({
  absWorkingDir: here,
  entryPoints: [entry],
  outfile: path.join(out, outfile),
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome110', 'firefox115', 'safari16.4'],
  legalComments: 'eof',
  charset: 'utf8',
  logLevel: 'warning',
})
await bundle('src/main.js', 'app.js')
await bundle('src/worker.js', 'worker.js')
await bundle('src/style.css', 'style.css')
// The server and the maker of excerpts put style and scripts where the marks are.
await writeFile(path.join(out, 'index.html'), await readFile(path.join(here, 'src/index.html')))
