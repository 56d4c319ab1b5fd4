//! Annotations of an agent: which boxes, how far they are seen, and their chains.

use std::collections::BTreeMap;

use frames::{Object, Pose, World};
use scene::LabelledBox;
use schema::table::Row as _;
use schema::tables::{ActorRow, AgentRow, BOXES_2D_TABLE, Box2dRow, CameraRow, VISIBLE_TABLE};
use schema::{ActorKind, AgentId, Attributes, DetectionClass, nuscenes_attribute};
use store::keys;

use super::options::NuScenesOptions;
use super::rows::{Annotation, BOX_STEPS, Instance, POSE_STEPS, Row, rounded, token};
use super::vocabulary::{category, category_index, index_of_tag, is_told_by_object, visibility};
use crate::{ExportError, SceneSource};

schema::columns! {
    /// What an object is.
    Actor of ActorRow { id: u16, kind: ActorKind, semantic_tags: Vec<u8>, attributes: Attributes }
}

schema::columns! {
    /// How much of an object a picture shows.
    Shown of Box2dRow { frame: u32, id: u16, pixels: u32, occlusion: f32 }
}

/// What the objects of a scene are, by id.
pub(crate) struct Objects {
    kinds: BTreeMap<u16, ActorKind>,
    categories: BTreeMap<u16, u8>,
}

impl Objects {
    pub(crate) fn read(scene: &SceneSource) -> Result<Self, ExportError> {
        let actors: Vec<Actor> = scene.reader().rows()?;
        let (mut kinds, mut categories) = (BTreeMap::new(), BTreeMap::new());
        for actor in actors {
            if let Some(class) = DetectionClass::from_tags(&actor.semantic_tags) {
                categories.insert(actor.id, category_index(category(class, &actor.attributes)));
                kinds.insert(actor.id, actor.kind);
            }
        }
        Ok(Self { kinds, categories })
    }

    /// The lidarseg label of a return.
    pub(crate) fn label(&self, id: u16, tag: u8) -> u8 {
        let own = self.categories.get(&id).filter(|_| is_told_by_object(tag));
        own.copied().unwrap_or_else(|| index_of_tag(tag))
    }
}

/// How much of each object the cameras show.
pub(crate) enum Sight {
    /// Pixels that show it and pixels that it would have unhidden, by frame and object.
    Shares(BTreeMap<(u32, u16), (f64, f64)>),
    /// Nothing is known but pixels: what is in a picture counts as seen.
    Pixels,
    /// There are no instance images: everything counts as seen.
    Unknown,
}

impl Sight {
    pub(crate) fn read(scene: &SceneSource, agent: AgentId) -> Result<Self, ExportError> {
        if !has_table(scene, agent, BOXES_2D_TABLE) {
            return Ok(if has_table(scene, agent, VISIBLE_TABLE) { Self::Pixels } else { Self::Unknown });
        }
        let mut shares: BTreeMap<(u32, u16), (f64, f64)> = BTreeMap::new();
        for Shown { frame, id, pixels, occlusion } in
            scene::agent_rows::<Shown>(scene.reader(), agent, BOXES_2D_TABLE)?
        {
            let (shown, hidden) = (f64::from(pixels), f64::from(occlusion).clamp(0.0, 0.999));
            let entry = shares.entry((frame, id)).or_default();
            entry.0 += shown;
            entry.1 += shown / (1.0 - hidden);
        }
        Ok(Self::Shares(shares))
    }

    /// The token of an object's visibility.
    fn token(&self, frame: u32, id: u16, pixels: u32) -> &'static str {
        match self {
            Self::Shares(shares) => {
                let (shown, all) = shares.get(&(frame, id)).copied().unwrap_or_default();
                visibility(if all > 0.0 { shown / all } else { 0.0 })
            }
            Self::Pixels => visibility(f64::from(u8::from(pixels > 0))),
            Self::Unknown => visibility(1.0),
        }
    }
}

/// Whether an agent has a table of its own.
pub(crate) fn has_table(scene: &SceneSource, agent: AgentId, name: &str) -> bool {
    let key = keys::sensor(scene.number(), agent, name);
    scene.reader().manifest(CameraRow::STAGE).is_ok_and(|manifest| manifest.output(&key).is_some())
}

/// Whether a box becomes an annotation: not the agent's own, near, and seen by a point.
pub(crate) fn is_annotated(found: &LabelledBox, agent: &AgentRow, options: &NuScenesOptions) -> bool {
    let away = [0, 1].map(|axis| found.raw.center_m[axis] - agent.xyz_m[axis]);
    let points = found.seen.as_ref().map_or(0, |seen| seen.num_lidar_pts + seen.num_radar_pts);
    found.raw.id != agent.id
        && (away[0] * away[0] + away[1] * away[1]).sqrt() <= options.radius_m
        && (options.empty_boxes || points > 0)
}

/// The annotations of an agent, in the making.
pub(crate) struct Annotations {
    /// What tokens begin with: the agent of the scene.
    agent_words: String,
    rows: Vec<Annotation>,
    /// Rows of each instance, ascending, and its category.
    instances: BTreeMap<u16, (&'static str, Vec<usize>)>,
}

impl Annotations {
    pub(crate) fn new(agent_words: &str) -> Self {
        Self { agent_words: agent_words.to_owned(), rows: Vec::new(), instances: BTreeMap::new() }
    }

    /// Adds a box at a frame; a class that no devkit knows is an error.
    pub(crate) fn add(
        &mut self,
        (frame, sample_token): (u32, &str),
        found: &LabelledBox,
        (objects, sight): (&Objects, &Sight),
    ) -> Result<(), String> {
        let LabelledBox { raw, seen } = found;
        let class = DetectionClass::from_name(&raw.class).ok_or_else(|| {
            format!("object {} is of the class `{}`, which this version does not know", raw.id, raw.class)
        })?;
        let category = category(class, &raw.attributes);
        let kind = objects.kinds.get(&raw.id).copied().unwrap_or_default();
        let [vx, vy, vz] = raw.velocity_mps.map(f64::from);
        let speed_mps = (vx * vx + vy * vy + vz * vz).sqrt();
        let attribute = nuscenes_attribute(class, kind, &raw.semantic_tags, &raw.attributes, speed_mps);
        let [length, width, height] = raw.size_m;
        let pose = Pose::<World, Object>::from_xyz_rpy(raw.center_m, raw.rpy_rad);
        let (_, rows) = self.instances.entry(raw.id).or_insert_with(|| (category, Vec::new()));
        rows.push(self.rows.len());
        let counts = seen.as_ref().map_or((0, 0, 0), |s| (s.num_lidar_pts, s.num_radar_pts, s.num_pixels));
        self.rows.push(Annotation {
            token: token(&format!("annotation {} {frame} {}", self.agent_words, raw.id)),
            sample_token: sample_token.to_owned(),
            instance_token: token(&format!("instance {} {}", self.agent_words, raw.id)),
            visibility_token: sight.token(frame, raw.id, counts.2).to_owned(),
            attribute_tokens: attribute.map(attribute_token).into_iter().collect(),
            translation: raw.center_m,
            size: rounded([width, length, height], BOX_STEPS),
            rotation: rounded(pose.wxyz(), POSE_STEPS),
            prev: String::new(),
            next: String::new(),
            num_lidar_pts: counts.0,
            num_radar_pts: counts.1,
        });
        Ok(())
    }

    /// Least and greatest x and y of all centres, m, in the world.
    pub(crate) fn bounds(&self) -> Option<[f64; 4]> {
        super::mask::bounds(self.rows.iter().map(|row| [row.translation[0], row.translation[1]]))
    }

    /// The rows with their chains, and those of their instances.
    pub(crate) fn finish(mut self) -> Vec<Row> {
        let mut instances = Vec::with_capacity(self.instances.len());
        for (category, rows) in self.instances.into_values() {
            for pair in rows.windows(2) {
                let (before, after) = (self.rows[pair[0]].token.clone(), self.rows[pair[1]].token.clone());
                self.rows[pair[0]].next = after;
                self.rows[pair[1]].prev = before;
            }
            let (Some(first), Some(last)) = (rows.first(), rows.last()) else { continue };
            instances.push(Row::Instance(Instance {
                token: self.rows[*first].instance_token.clone(),
                category_token: category_token(category),
                nbr_annotations: rows.len() as u32,
                first_annotation_token: self.rows[*first].token.clone(),
                last_annotation_token: self.rows[*last].token.clone(),
            }));
        }
        instances.extend(self.rows.into_iter().map(Row::Annotation));
        instances
    }
}

pub(crate) fn category_token(name: &str) -> String {
    token(&format!("category {name}"))
}

pub(crate) fn attribute_token(name: &str) -> String {
    token(&format!("attribute {name}"))
}

#[cfg(test)]
mod tests {
    use schema::tables::{BoxRow, ValidBoxRow};

    use super::*;

    fn car(frame: u32, id: u16, at: [f64; 3]) -> LabelledBox {
        let raw = BoxRow {
            frame,
            id,
            class: "car".into(),
            semantic_tags: vec![14],
            center_m: at,
            size_m: [4.0, 1.8, 1.5],
            rpy_rad: [0.0, 0.0, std::f64::consts::FRAC_PI_2],
            velocity_mps: [0.0, 3.0, 0.0],
            ..BoxRow::default()
        };
        let seen = ValidBoxRow { frame, id, num_lidar_pts: 5, num_radar_pts: 1, ..ValidBoxRow::default() };
        LabelledBox { raw, seen: Some(seen) }
    }

    fn nothing() -> (Objects, Sight) {
        (Objects { kinds: BTreeMap::new(), categories: BTreeMap::new() }, Sight::Unknown)
    }

    #[test]
    fn boxes_become_rows_in_chains() {
        let (objects, sight) = nothing();
        let mut rows = Annotations::new("here");
        for frame in [0, 10, 30] {
            let here = [10.0, f64::from(frame), 0.75];
            rows.add((frame, "sample"), &car(frame, 7, here), (&objects, &sight)).expect("a car");
        }
        rows.add((10, "sample"), &car(10, 9, [-3.0, 0.0, 0.0]), (&objects, &sight)).expect("a car");
        assert_eq!(rows.bounds(), Some([-3.0, 0.0, 10.0, 30.0]));
        let (mut instances, mut boxes) = (Vec::new(), Vec::new());
        for row in rows.finish() {
            match row {
                Row::Instance(row) => instances.push(row),
                Row::Annotation(row) => boxes.push(row),
                _ => panic!("boxes make no other rows"),
            }
        }
        assert_eq!([instances[0].nbr_annotations, instances[1].nbr_annotations], [3, 1]);
        // Rows 0, 1 and 2 are of the first car: the second car was added last.
        let links = |i: usize| (boxes[i].prev.as_str(), boxes[i].next.as_str());
        assert_eq!(links(0), ("", boxes[1].token.as_str()));
        assert_eq!(links(1), (boxes[0].token.as_str(), boxes[2].token.as_str()));
        assert_eq!(links(2), (boxes[1].token.as_str(), ""));
        assert_eq!(links(3), ("", ""));
        assert_eq!(instances[0].last_annotation_token, boxes[2].token);
        // Width before length; a quarter turn to the left.
        assert_eq!(boxes[0].size, [1.8, 4.0, 1.5]);
        let half = rounded([std::f64::consts::FRAC_1_SQRT_2], POSE_STEPS)[0];
        assert_eq!(boxes[0].rotation, [half, 0.0, 0.0, half]);
        assert_eq!(boxes[0].attribute_tokens, [attribute_token("vehicle.moving")]);
        assert_eq!((boxes[0].num_lidar_pts, boxes[0].num_radar_pts), (5, 1));
    }

    #[test]
    fn only_other_near_and_seen_boxes_are_annotated() {
        let agent = AgentRow { id: 3, xyz_m: [100.0, 0.0, 0.0], ..AgentRow::default() };
        let options = crate::command::usual::<NuScenesOptions>();
        let at = |x: f64| car(0, 7, [x, 0.0, 50.0]);
        assert!(is_annotated(&at(159.9), &agent, &options) && !is_annotated(&at(160.1), &agent, &options));
        assert!(!is_annotated(&LabelledBox { seen: None, ..at(110.0) }, &agent, &options));
        let all = NuScenesOptions { empty_boxes: true, ..options.clone() };
        assert!(is_annotated(&LabelledBox { seen: None, ..at(110.0) }, &agent, &all));
        assert!(!is_annotated(&car(0, 3, [100.0, 0.0, 0.0]), &agent, &all));
    }

    #[test]
    fn visibility_is_of_all_cameras_together() {
        // 60 of 100 pixels in one picture, 10 of 100 in another: 35 % of all.
        let sight = Sight::Shares(BTreeMap::from([((10, 7), (70.0, 200.0)), ((10, 8), (90.0, 100.0))]));
        assert_eq!(sight.token(10, 7, 70), "1");
        assert_eq!(sight.token(10, 8, 90), "4");
        assert_eq!(sight.token(20, 8, 0), "1");
        assert_eq!([Sight::Pixels.token(0, 1, 0), Sight::Pixels.token(0, 1, 9)], ["1", "4"]);
    }

    #[test]
    fn labels_follow_the_object_where_the_tag_says_less() {
        let objects = Objects { kinds: BTreeMap::new(), categories: BTreeMap::from([(5, 14), (6, 3)]) };
        // A rider is of the bicycle; a child is no adult; a road is a road; an object that nobody knows goes
        // by its tag.
        assert_eq!([objects.label(5, 13), objects.label(6, 12)], [14, 3]);
        assert_eq!([objects.label(5, 1), objects.label(9, 12)], [24, 2]);
    }
}
