//! Noise of readings.

/// Four standard normal numbers of one index.
pub(crate) fn normals(stream: &random::Stream, index: u64) -> [f64; 4] {
    let [a, b, c, d] = stream.at(index);
    let (n0, n1) = random::normal_pair_f32(a, b);
    let (n2, n3) = random::normal_pair_f32(c, d);
    [n0, n1, n2, n3].map(f64::from)
}
