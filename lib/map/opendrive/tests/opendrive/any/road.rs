//! Roads, lanes and markings at random.

use opendrive::*;

use super::Any;

impl Any {
    pub(crate) fn curve(&mut self) -> Curve {
        let four = |any: &mut Self| [any.small(), any.small(), any.small(), any.small()];
        match self.below(5) {
            0 => Curve::Line,
            1 => Curve::Arc { curvature: self.small() },
            2 => Curve::Spiral { curvature_start: self.small(), curvature_end: self.small() },
            3 => Curve::Poly3 { v: four(self) },
            _ => Curve::ParamPoly3 { u: four(self), v: four(self), normalised: self.flag() },
        }
    }

    pub(crate) fn geometry(&mut self, s: f64) -> Geometry {
        Geometry {
            s,
            x_m: self.metres(),
            y_m: self.metres(),
            hdg_rad: self.metres(),
            length_m: self.metres().abs(),
            curve: self.curve(),
        }
    }

    pub(crate) fn road(&mut self) -> Road {
        let mut starts = self.starts();
        starts.push(1e4);
        let mut shape: Vec<Shape> = self.some(|any| {
            let t = any.metres();
            Shape { s: any.metres(), cubic_of_t: any.cubic(t) }
        });
        shape.sort_by(|a, b| a.s.total_cmp(&b.s).then(a.cubic_of_t.s.total_cmp(&b.cubic_of_t.s)));
        Road {
            id: self.name(),
            name: self.text(),
            length_m: self.positive(),
            junction: self.maybe(Self::name),
            rule: self.word(TrafficRule::ALL),
            predecessor: self.maybe(Self::link),
            successor: self.maybe(Self::link),
            neighbours: self.some(|any| Neighbour {
                side: any.word(RoadSide::ALL),
                id: any.text(),
                direction: any.word(NeighbourDirection::ALL),
            }),
            types: self
                .starts()
                .into_iter()
                .map(|s| RoadType {
                    s,
                    kind: self.text(),
                    speed: self.maybe(Self::speed),
                    country: self.text(),
                })
                .collect(),
            plan_view: starts.into_iter().map(|s| self.geometry(s)).collect(),
            elevation: self.cubics(),
            superelevation: self.cubics(),
            crossfall: self
                .cubics()
                .into_iter()
                .map(|angle_rad| Crossfall { side: self.word(RoadSide::ALL), angle_rad })
                .collect(),
            shape,
            cross_section_surface: self
                .some(|any| Element { name: "crossSectionSurface".to_owned(), ..any.element(2) }),
            lane_offset: self.cubics(),
            sections: self.starts().into_iter().map(|s| self.section(s)).collect(),
            objects: self.some(Self::object),
            signals: self.some(Self::signal),
            signal_references: self.some(|any| SignalReference {
                id: any.text(),
                s: any.metres(),
                t: any.metres(),
                orientation: any.word(Orientation::ALL),
                validity: any.validity(),
            }),
            bridges: self.some(|any| Bridge {
                id: any.text(),
                name: any.text(),
                kind: any.text(),
                s: any.metres(),
                length_m: any.metres(),
                validity: any.validity(),
            }),
            tunnels: self.some(|any| Tunnel {
                id: any.text(),
                name: any.text(),
                kind: any.word(TunnelType::ALL),
                s: any.metres(),
                length_m: any.metres(),
                lighting: any.maybe(Self::metres),
                daylight: any.maybe(Self::metres),
                validity: any.validity(),
            }),
            object_references: self.some(|any| ObjectReference {
                id: any.text(),
                s: any.metres(),
                t: any.metres(),
                z_offset_m: any.maybe(Self::metres),
                valid_length_m: any.maybe(Self::metres),
                orientation: any.word(Orientation::ALL),
                validity: any.validity(),
            }),
            switches: self.some(|any| Switch {
                id: any.text(),
                name: any.text(),
                position: any.word(SwitchPosition::ALL),
                main: any.track(),
                side: any.track(),
                partner: any.maybe(|any| (any.text(), any.text())),
            }),
            kept: self.some(|any| any.element(2)),
        }
    }

    pub(crate) fn track(&mut self) -> SwitchTrack {
        SwitchTrack { road: self.text(), s: self.metres(), direction: self.word(TrackDirection::ALL) }
    }

    pub(crate) fn speed(&mut self) -> Speed {
        let max = if self.below(4) == 0 { f64::INFINITY } else { self.metres() };
        Speed { max, unit: self.word(SpeedUnit::ALL) }
    }

    pub(crate) fn section(&mut self, s: f64) -> LaneSection {
        let left = self.below(3) as i16;
        let right = self.below(3) as i16;
        LaneSection {
            s,
            single_side: self.flag(),
            left: (1..=left).map(|id| self.lane(id)).collect(),
            centre: self.lane(0),
            right: (1..=right).map(|id| self.lane(-id)).collect(),
        }
    }

    pub(crate) fn lane(&mut self, id: i16) -> Lane {
        let ids = |any: &mut Self| {
            let mut ids = any.some(|any| any.below(6) as i16 - 3);
            ids.dedup();
            ids
        };
        Lane {
            id,
            predecessors: ids(self),
            successors: ids(self),
            lane_type: self.word(LaneType::ALL),
            level: self.flag(),
            direction: self.word(TravelDirection::ALL),
            advisory: self.word(LaneAdvisory::ALL),
            dynamic_type: self.flag(),
            dynamic_direction: self.flag(),
            road_works: self.flag(),
            widths: self.cubics(),
            borders: self.cubics(),
            marks: self.starts().into_iter().map(|s| self.mark(s)).collect(),
            speeds: self
                .starts()
                .into_iter()
                .map(|s_offset| LaneSpeed { s_offset, speed: self.speed() })
                .collect(),
            heights: self
                .starts()
                .into_iter()
                .map(|s_offset| LaneHeight { s_offset, inner_m: self.metres(), outer_m: self.metres() })
                .collect(),
            materials: self
                .starts()
                .into_iter()
                .map(|s_offset| LaneMaterial {
                    s_offset,
                    surface: self.text(),
                    friction: self.maybe(Self::metres),
                    roughness: self.maybe(Self::metres),
                })
                .collect(),
            accesses: self
                .starts()
                .into_iter()
                .map(|s_offset| LaneAccess {
                    s_offset,
                    rule: self.word(AccessRule::ALL),
                    restrictions: self.some(Self::text),
                })
                .collect(),
            rules: self
                .starts()
                .into_iter()
                .map(|s_offset| LaneRule { s_offset, value: self.text() })
                .collect(),
            kept: self.some(|any| any.element(1)),
        }
    }

    pub(crate) fn mark(&mut self, s_offset: f64) -> RoadMark {
        RoadMark {
            s_offset,
            mark_type: self.word(MarkType::ALL),
            colour: self.word(MarkColour::ALL),
            bold: self.flag(),
            width_m: self.maybe(Self::metres),
            height_m: self.maybe(Self::metres),
            lane_change: self.maybe(|any| any.word(MarkChange::ALL)),
            material: self.text(),
            lines: self.some(|any| MarkLine {
                length_m: any.metres(),
                space_m: any.metres(),
                t_offset_m: any.metres(),
                s_offset: any.metres(),
                width_m: any.maybe(Self::metres),
                colour: any.maybe(|any| any.word(MarkColour::ALL)),
                rule: any.word(LineRule::ALL),
            }),
            strokes: self.some(|any| MarkStroke {
                s_offset: any.metres(),
                length_m: any.metres(),
                t_offset_m: any.metres(),
                width_m: any.maybe(Self::metres),
                rule: any.word(LineRule::ALL),
            }),
            sway: self.cubics(),
        }
    }
}
