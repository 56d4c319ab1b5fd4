//! Objects, signals, controllers and junctions at random.

use opendrive::*;

use super::Any;

impl Any {
    pub(crate) fn place(&mut self, height_m: f64) -> Corner {
        let [a, b, c] = [self.metres(), self.metres(), self.metres()];
        if self.flag() {
            Corner::Local { u_m: a, v_m: b, z_m: c, height_m }
        } else {
            Corner::Road { s: a, t: b, dz_m: c, height_m }
        }
    }

    pub(crate) fn object(&mut self) -> Object {
        let outlines = self.some(|any| {
            let corners = 1 + any.below(3);
            Outline {
                closed: any.flag(),
                corners: (0..corners)
                    .map(|_| {
                        let height = any.metres();
                        any.place(height)
                    })
                    .collect(),
                outer: any.flag(),
                fill: any.text(),
                lane_type: any.maybe(|any| any.word(LaneType::ALL)),
            }
        });
        let corners = |any: &mut Self| match outlines.len() {
            0 => Vec::new(),
            n => any.some(|any| {
                let outline = any.below(n);
                CornerReference { outline, corner: any.below(outlines[outline].corners.len()) }
            }),
        };
        Object {
            markings: self.some(|any| ObjectMarking {
                side: any.maybe(|any| any.word(BoxSide::ALL)),
                corners: corners(any),
                colour: any.word(MarkColour::ALL),
                bold: any.flag(),
                width_m: any.maybe(Self::metres),
                z_offset_m: any.metres(),
                line_m: any.metres(),
                space_m: any.metres(),
                start_offset_m: any.metres(),
                stop_offset_m: any.metres(),
            }),
            borders: if outlines.is_empty() {
                Vec::new()
            } else {
                self.some(|any| ObjectBorder {
                    kind: any.text(),
                    width_m: any.metres(),
                    outline: any.below(outlines.len()),
                    complete: any.flag(),
                    corners: corners(any),
                })
            },
            id: self.text(),
            name: self.text(),
            kind: self.text(),
            subtype: self.text(),
            s: self.metres(),
            t: self.metres(),
            z_offset_m: self.metres(),
            hdg_rad: self.metres(),
            pitch_rad: self.metres(),
            roll_rad: self.metres(),
            orientation: self.word(Orientation::ALL),
            length_m: self.maybe(Self::metres),
            width_m: self.maybe(Self::metres),
            height_m: self.maybe(Self::metres),
            radius_m: self.maybe(Self::metres),
            outlines,
            repeats: self.some(|any| Repeat {
                s: any.metres(),
                length_m: any.metres(),
                distance_m: any.metres(),
                t_m: any.pair(),
                t_cubic: any.maybe(|any| [any.small(), any.small(), any.small()]),
                z_offset_m: any.pair(),
                height_m: any.maybe(Self::pair),
                width_m: any.maybe(Self::pair),
                object_length_m: any.maybe(Self::pair),
                radius_m: any.maybe(Self::pair),
                detached: any.flag(),
            }),
            validity: self.validity(),
            valid_length_m: self.maybe(Self::metres),
            dynamic: self.flag(),
            perpendicular: self.flag(),
            parking: self.maybe(|any| ParkingSpace { access: any.text(), restrictions: any.text() }),
            materials: self.some(|any| ObjectMaterial {
                surface: any.text(),
                friction: any.maybe(Self::metres),
                roughness: any.maybe(Self::metres),
                paint: any.maybe(|any| any.word(MarkColour::ALL)),
            }),
            skeleton: self.some(|any| SkeletonLine {
                vertices: any.some(|any| SkeletonVertex {
                    place: any.place(0.0),
                    radius_m: any.maybe(Self::metres),
                    on_ground: any.flag(),
                }),
            }),
            kept: self.some(|any| any.element(1)),
        }
    }

    pub(crate) fn signal(&mut self) -> Signal {
        let unit = self.maybe(|any| any.word(SpeedUnit::ALL));
        Signal {
            id: self.text(),
            name: self.text(),
            s: self.metres(),
            t: self.metres(),
            z_offset_m: self.metres(),
            h_offset_rad: self.metres(),
            pitch_rad: self.metres(),
            roll_rad: self.metres(),
            orientation: self.word(Orientation::ALL),
            dynamic: self.flag(),
            country: self.text(),
            country_revision: self.text(),
            kind: self.text(),
            subtype: self.text(),
            value: self.maybe(Self::metres),
            unit,
            other_unit: if unit.is_some() { String::new() } else { self.text() },
            text: self.text(),
            height_m: self.maybe(Self::metres),
            width_m: self.maybe(Self::metres),
            length_m: self.maybe(Self::metres),
            validity: self.validity(),
            dependencies: self.some(|any| SignalDependency { id: any.text(), kind: any.text() }),
            references: self.some(|any| ElementReference {
                element: any.text(),
                id: any.text(),
                kind: any.text(),
            }),
            position: self.maybe(|any| {
                let (pitch_rad, roll_rad) = (any.metres(), any.metres());
                if any.flag() {
                    let xyz_m = [any.metres(), any.metres(), any.metres()];
                    SignalPosition::Inertial { xyz_m, hdg_rad: any.metres(), pitch_rad, roll_rad }
                } else {
                    SignalPosition::Road {
                        road: any.text(),
                        s: any.metres(),
                        t: any.metres(),
                        z_offset_m: any.metres(),
                        h_offset_rad: any.metres(),
                        pitch_rad,
                        roll_rad,
                    }
                }
            }),
            kept: self.some(|any| any.element(2)),
        }
    }

    pub(crate) fn controller(&mut self) -> Controller {
        let mut signals = self.some(Self::name);
        signals.sort();
        signals.dedup();
        let types = signals.iter().filter(|_| self.flag()).map(|id| (id.clone(), format!("type {id}")));
        Controller {
            control_types: types.collect(),
            id: self.text(),
            name: self.text(),
            sequence: self.maybe(|any| any.bits() as u32),
            signals,
        }
    }

    pub(crate) fn junction(&mut self) -> Junction {
        Junction {
            id: self.text(),
            name: self.text(),
            kind: self.word(JunctionKind::ALL),
            connections: self.some(|any| Connection {
                id: any.text(),
                incoming_road: any.text(),
                connecting_road: any.text(),
                contact: any.word(ContactPoint::ALL),
                lane_links: any.some(|any| LaneLink {
                    from: any.bits() as i16,
                    to: any.bits() as i16,
                    overlap_m: any.maybe(Self::metres),
                }),
                kind: any.word(ConnectionKind::ALL),
                predecessor: any.maybe(Self::link),
                successor: any.maybe(Self::link),
            }),
            controllers: self.some(|any| JunctionController {
                id: any.text(),
                kind: any.text(),
                sequence: any.maybe(|any| any.bits() as u32),
            }),
            main_road: self.maybe(|any| VirtualStretch {
                road: any.text(),
                s_start: any.metres(),
                s_end: any.metres(),
                orientation: any.word(Orientation::ALL),
            }),
            priorities: self.some(|any| Priority { high: any.maybe(Self::text), low: any.maybe(Self::text) }),
            cross_paths: self.some(|any| CrossPath {
                id: any.text(),
                crossing_road: any.text(),
                start: any.path_end(),
                end: any.path_end(),
            }),
            crossing: self.some(|any| CrossingStretch {
                id: any.text(),
                road: any.text(),
                s_start: any.metres(),
                s_end: any.metres(),
            }),
            boundary: self.some(|any| {
                let road = any.text();
                if any.flag() {
                    BoundarySegment::Lane {
                        road,
                        lane: any.bits() as i16,
                        from: any.segment_end(),
                        to: any.segment_end(),
                    }
                } else {
                    BoundarySegment::Joint {
                        road,
                        contact: any.word(ContactPoint::ALL),
                        from_lane: any.maybe(|any| any.bits() as i16),
                        to_lane: any.maybe(|any| any.bits() as i16),
                        transition_m: any.metres(),
                    }
                }
            }),
            plan_view: self.starts().into_iter().map(|s| self.geometry(s)).collect(),
            elevation_grid: self.maybe(|any| ElevationGrid {
                s_start: any.metres(),
                spacing_m: any.metres(),
                rows: any.some(|any| GridRow {
                    centre_m: any.metres(),
                    left_m: any.some(Self::metres),
                    right_m: any.some(Self::metres),
                }),
            }),
            kept: self.some(|any| any.element(1)),
        }
    }

    pub(crate) fn path_end(&mut self) -> CrossPathEnd {
        CrossPathEnd { road: self.text(), s: self.metres(), from: self.bits() as i16, to: self.bits() as i16 }
    }

    pub(crate) fn segment_end(&mut self) -> SegmentEnd {
        match self.below(3) {
            0 => SegmentEnd::Begin,
            1 => SegmentEnd::End,
            _ => SegmentEnd::At(self.metres()),
        }
    }
}
