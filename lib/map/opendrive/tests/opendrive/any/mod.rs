//! Networks at random: every field of every type takes any value that a file can state.

mod furniture;
mod road;

use std::collections::BTreeMap;

use opendrive::*;

/// A generator of networks from a seed.
pub(crate) struct Any(pub(crate) u64);

impl Any {
    /// The next 64 random bits (splitmix64).
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub(crate) fn flag(&mut self) -> bool {
        self.below(2) == 0
    }

    /// A number with all its bits random, but of a magnitude of at most `2^exponent`; now and then a round
    /// one, or a zero.
    pub(crate) fn number(&mut self, exponent: i64) -> f64 {
        let sign = if self.flag() { 1.0 } else { -1.0 };
        match self.below(8) {
            0 => sign * 0.0,
            1 => sign * f64::from_bits(self.bits() & 0xf_ffff_ffff_ffff),
            2 => sign * f64::from_bits(((1023 + exponent.min(0)) as u64) << 52),
            _ => {
                let down = self.below(60) as i64;
                let exponent = (1022 + exponent - down) as u64;
                sign * f64::from_bits((exponent << 52) | (self.bits() & 0xf_ffff_ffff_ffff))
            }
        }
    }

    pub(crate) fn metres(&mut self) -> f64 {
        self.number(9)
    }

    /// Small enough for a coefficient of d^3.
    pub(crate) fn small(&mut self) -> f64 {
        self.number(-9)
    }

    pub(crate) fn positive(&mut self) -> f64 {
        self.metres().abs() + 0.25
    }

    pub(crate) fn maybe<T>(&mut self, one: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.flag().then(|| one(self))
    }

    pub(crate) fn some<T>(&mut self, mut one: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.below(3)).map(|_| one(self)).collect()
    }

    pub(crate) fn pair(&mut self) -> [f64; 2] {
        [self.metres(), self.metres()]
    }

    pub(crate) fn word<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    pub(crate) fn text(&mut self) -> String {
        let pieces = [
            "",
            "a",
            "road 7",
            "<&>\"'",
            "\t\n\r",
            " edge ",
            "ünï\u{10ffff}",
            "]]>",
            "-1",
            "\u{a0}x",
            "&amp;",
        ];
        (0..self.below(3)).map(|_| pieces[self.below(pieces.len())]).collect()
    }

    /// An id, which must not be nothing.
    pub(crate) fn name(&mut self) -> String {
        format!("{}{}", self.below(5), self.text())
    }

    pub(crate) fn cubic(&mut self, s: f64) -> Cubic {
        Cubic { s, a: self.small(), b: self.small(), c: self.small(), d: self.small() }
    }

    /// Starts of records, in order.
    pub(crate) fn starts(&mut self) -> Vec<f64> {
        let mut starts = self.some(|any| any.metres());
        starts.sort_by(f64::total_cmp);
        starts
    }

    pub(crate) fn cubics(&mut self) -> Vec<Cubic> {
        self.starts().into_iter().map(|s| self.cubic(s)).collect()
    }

    pub(crate) fn element(&mut self, depth: usize) -> Element {
        let names = ["surface", "foo", "_x-1.y", "élan", "xmlns"];
        let attributes = ["a", "b-c", "ö"].map(|key| (key.to_owned(), self.text()));
        Element {
            name: names[self.below(names.len())].to_owned(),
            attributes: attributes[..self.below(4)].to_vec(),
            text: self.text().trim().to_owned(),
            children: if depth == 0 { Vec::new() } else { self.some(|any| any.element(depth - 1)) },
        }
    }

    pub(crate) fn validity(&mut self) -> Vec<LaneValidity> {
        self.some(|any| LaneValidity { from: any.bits() as i16, to: any.bits() as i16 })
    }

    pub(crate) fn network(&mut self) -> Network {
        Network {
            header: self.header(),
            roads: self.some(Self::road),
            junctions: self.some(Self::junction),
            controllers: self.some(Self::controller),
            junction_groups: self.some(|any| JunctionGroup {
                id: any.text(),
                name: any.text(),
                kind: any.text(),
                junctions: any.some(Self::text),
            }),
            stations: self.some(|any| Station {
                id: any.text(),
                name: any.text(),
                kind: any.text(),
                platforms: any.some(|any| Platform {
                    id: any.text(),
                    name: any.text(),
                    segments: any.some(|any| PlatformSegment {
                        road: any.text(),
                        s_start: any.metres(),
                        s_end: any.metres(),
                        side: any.word(RoadSide::ALL),
                    }),
                }),
            }),
            kept: self.some(|any| any.element(2)),
            unknown_elements: BTreeMap::new(),
            warnings: Vec::new(),
        }
    }

    pub(crate) fn header(&mut self) -> Header {
        Header {
            revision: (1, self.below(9) as u32),
            name: self.text(),
            version: self.text(),
            date: self.text(),
            vendor: self.text(),
            bounds_m: self.maybe(|any| [any.metres(), any.metres(), any.metres(), any.metres()]),
            geo_reference: self.maybe(Self::name).map(|t| t.trim().to_owned()),
            offset: HeaderOffset {
                x_m: self.metres(),
                y_m: self.metres(),
                z_m: self.metres(),
                hdg_rad: self.metres(),
            },
            kept: self.some(|any| any.element(1)),
        }
    }

    pub(crate) fn link(&mut self) -> RoadLink {
        match self.below(3) {
            0 => RoadLink::Road { id: self.text(), contact: self.word(ContactPoint::ALL) },
            1 => RoadLink::Junction { id: self.text() },
            _ => RoadLink::Along {
                id: self.text(),
                s: self.metres(),
                direction: self.word(TrackDirection::ALL),
            },
        }
    }
}
