//! Writes glTF files: what tests read, whole or damaged.

use serde_json::{Value, json};

/// A glTF file in the making.
pub(crate) struct Maker {
    pub(crate) json: Value,
    pub(crate) binary: Vec<u8>,
}

/// Triangles of one material: corners with normals and places in a picture, three for each.
#[derive(Clone, Default)]
pub(crate) struct Faces {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) uv: Vec<[f32; 2]>,
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Faces {
    /// A flat quad, counter-clockwise, with its picture's lower left corner at the first one.
    pub(crate) fn quad(&mut self, corners: [[f32; 3]; 4], uv: [[f32; 2]; 4]) {
        let side = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|k| b[k] - a[k]);
        let normal = cross(side(corners[0], corners[1]), side(corners[0], corners[3]));
        let length = normal.iter().map(|v| v * v).sum::<f32>().sqrt();
        for k in [0, 1, 2, 0, 2, 3] {
            self.positions.push(corners[k]);
            self.normals.push(normal.map(|v| v / length));
            self.uv.push(uv[k]);
        }
    }

    /// A box from corner to corner; each side shows a part of the picture: left, top, right, bottom.
    pub(crate) fn cuboid(&mut self, low: [f32; 3], high: [f32; 3], [u0, v0, u1, v1]: [f32; 4]) {
        let uv = [[u0, v1], [u1, v1], [u1, v0], [u0, v0]];
        let [a, b] = [low, high];
        let p = |x: f32, y: f32, z: f32| [x, y, z];
        self.quad([p(b[0], a[1], b[2]), p(b[0], a[1], a[2]), p(b[0], b[1], a[2]), p(b[0], b[1], b[2])], uv);
        self.quad([p(a[0], a[1], a[2]), p(a[0], a[1], b[2]), p(a[0], b[1], b[2]), p(a[0], b[1], a[2])], uv);
        self.quad([p(a[0], b[1], b[2]), p(b[0], b[1], b[2]), p(b[0], b[1], a[2]), p(a[0], b[1], a[2])], uv);
        self.quad([p(a[0], a[1], a[2]), p(b[0], a[1], a[2]), p(b[0], a[1], b[2]), p(a[0], a[1], b[2])], uv);
        self.quad([p(a[0], a[1], b[2]), p(b[0], a[1], b[2]), p(b[0], b[1], b[2]), p(a[0], b[1], b[2])], uv);
        self.quad([p(b[0], a[1], a[2]), p(a[0], a[1], a[2]), p(a[0], b[1], a[2]), p(b[0], b[1], a[2])], uv);
    }

    /// A drum about the x axis (`axis` 0) or the y axis (1) of some radius, from `from` to `to` along it; its
    /// picture goes round once.
    pub(crate) fn drum(&mut self, axis: usize, radius: f32, [from, to]: [f32; 2], sides: u32) {
        let ring = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i % sides) / f64::from(sides);
            let (s, c) = frames::math::sin_cos(angle);
            [radius * c as f32, radius * s as f32]
        };
        let at = |along: f32, [a, b]: [f32; 2]| if axis == 0 { [along, a, b] } else { [b, along, a] };
        for i in 0..sides {
            let (here, next) = (ring(i), ring(i + 1));
            let [u0, u1] = [i, i + 1].map(|i| i as f32 / sides as f32);
            let corners = [at(from, here), at(from, next), at(to, next), at(to, here)];
            self.quad(corners, [[u0, 1.0], [u1, 1.0], [u1, 0.0], [u0, 0.0]]);
            for (along, turned) in [(to, false), (from, true)] {
                let (a, b) = if turned { (next, here) } else { (here, next) };
                let middle = at(along, [0.0; 2]);
                for (corner, u) in [(middle, u0), (at(along, a), u0), (at(along, b), u1)] {
                    self.positions.push(corner);
                    let way = if turned { -1.0 } else { 1.0 };
                    self.normals.push(if axis == 0 { [way, 0.0, 0.0] } else { [0.0, way, 0.0] });
                    self.uv.push([u, 0.0]);
                }
            }
        }
    }
}

impl Maker {
    pub(crate) fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "buffers": [{ "byteLength": 0 }],
        });
        Self { json, binary: Vec::new() }
    }

    pub(crate) fn list(&mut self, name: &str) -> &mut Vec<Value> {
        if self.json.get(name).is_none() {
            self.json[name] = json!([]);
        }
        self.json[name].as_array_mut().expect("is a list")
    }

    pub(crate) fn put(&mut self, name: &str, value: Value) -> usize {
        self.list(name).push(value);
        self.list(name).len() - 1
    }

    /// Bytes as a view of the buffer.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.binary.len());
        self.put("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub(crate) fn floats<const N: usize>(&mut self, values: &[[f32; N]], bounds: bool) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let kind = if N == 3 { "VEC3" } else { "VEC2" };
        let mut accessor =
            json!({ "bufferView": view, "componentType": 5126, "count": values.len(), "type": kind });
        if bounds {
            let of = |start: f32, f: fn(f32, f32) -> f32| {
                (0..N).map(|k| values.iter().map(|v| v[k]).filter(|v| v.is_finite()).fold(start, f)).collect()
            };
            let [low, high]: [Vec<f32>; 2] = [of(1e9, f32::min), of(-1e9, f32::max)];
            accessor["min"] = json!(low);
            accessor["max"] = json!(high);
        }
        self.put("accessors", accessor)
    }

    /// A mesh of faces, each with the number of its material.
    pub(crate) fn mesh(&mut self, parts: &[(usize, &Faces)]) -> usize {
        let mut primitives = Vec::new();
        for (material, faces) in parts {
            let positions = self.floats(&faces.positions, true);
            let normals = self.floats(&faces.normals, false);
            let uv = self.floats(&faces.uv, false);
            let indices: Vec<u8> = (0..faces.positions.len() as u16).flat_map(u16::to_le_bytes).collect();
            let view = self.view(&indices);
            let indices = self.put(
                "accessors",
                json!({ "bufferView": view, "componentType": 5123, "count": faces.positions.len(), "type": "SCALAR" }),
            );
            primitives.push(json!({
                "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uv },
                "indices": indices,
                "material": material,
            }));
        }
        self.put("meshes", json!({ "primitives": primitives }))
    }

    /// A node of the scene with a mesh at a place.
    pub(crate) fn node(&mut self, name: &str, mesh: usize, at: [f32; 3]) -> usize {
        let node = self.put("nodes", json!({ "name": name, "mesh": mesh, "translation": at }));
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(node));
        node
    }

    /// A material of a colour, or of a picture.
    pub(crate) fn material(&mut self, name: &str, rgb: [f32; 3], picture: Option<usize>) -> usize {
        let mut pbr = json!({
            "baseColorFactor": [rgb[0], rgb[1], rgb[2], 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.6,
        });
        if let Some(texture) = picture {
            pbr["baseColorTexture"] = json!({ "index": texture });
        }
        self.put("materials", json!({ "name": name, "pbrMetallicRoughness": pbr }))
    }

    /// A texture with a picture in the buffer.
    pub(crate) fn picture(&mut self, bytes: &[u8], mime: &str) -> usize {
        let view = self.view(bytes);
        let image = self.put("images", json!({ "bufferView": view, "mimeType": mime }));
        self.put("textures", json!({ "source": image }))
    }

    pub(crate) fn glb(&self) -> Vec<u8> {
        let mut json = serde_json::to_vec(&self.json).expect("is JSON");
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = self.binary.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut bytes = b"glTF".to_vec();
        let word = |n: usize| (n as u32).to_le_bytes();
        bytes.extend(word(2));
        bytes.extend(word(28 + json.len() + binary.len()));
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
            bytes.extend(word(chunk.len()));
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }
}

/// A PNG of pixels.
pub(crate) fn png(width: u32, height: u32, of: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    encoded(width, height, png::ColorType::Rgb, of)
}

/// A PNG of pixels with alpha.
pub(crate) fn png_with_alpha(width: u32, height: u32, of: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    encoded(width, height, png::ColorType::Rgba, of)
}

fn encoded<const N: usize>(
    width: u32,
    height: u32,
    colours: png::ColorType,
    of: impl Fn(u32, u32) -> [u8; N],
) -> Vec<u8> {
    let pixels: Vec<u8> =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| of(x, y)).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colours);
    // The same bytes with every compressor.
    encoder.set_compression(png::Compression::NoCompression);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().expect("writes");
    writer.write_image_data(&pixels).expect("writes");
    writer.finish().expect("writes");
    bytes
}
