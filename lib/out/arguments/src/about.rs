//! What stages say of themselves: what each does and costs; what it reads and makes stands in
//! `pipeline.toml`.

use runner::{Graph, StageSpec};

/// A stage in words.
struct About {
    stage: &'static str,
    does: &'static str,
    costs: &'static str,
}

const STAGES: [About; 8] = [
    About {
        stage: "spawn-planner",
        does: "Plans the dataset: which scenes on which maps, their agents, routes, weather and hazards.",
        costs: "seconds, and minutes for hundreds of scenes on large maps",
    },
    About {
        stage: "simulate-and-log",
        does: "Simulates the traffic of scenes and writes their logs, from which all else is made: actors, signals, weather, \
               raw boxes, HD-map records, and the tiles of the static world.",
        costs: "some 4 ms of a core for an agent's frame, and seconds for tiles that are not there yet",
    },
    About {
        stage: "render-sensors",
        does: "Renders cameras, lidars, radars, GNSS and IMU of all agents from the log.",
        costs: "most of a dataset: at the published sensors about half a second of two cores for an agent's frame, and most \
                of its bytes; a GPU takes a part of it (--device)",
    },
    About {
        stage: "bev-gt",
        does: "Draws bird's-eye-view masks around every agent from the log: 14 classes.",
        costs: "some 20 ms of a core for an agent's frame",
    },
    About {
        stage: "occupancy-gt",
        does: "Makes the voxel grids around every agent from the log: which class fills which voxel.",
        costs: "some 0.1 s of a core for an agent's frame at the published size",
    },
    About {
        stage: "postprocess-valid",
        does: "Counts the points in every box, judges what is valid and how difficult, and fills voxel grids.",
        costs: "some 0.1 s of a core for an agent's frame at the published size, 10 ms without voxels",
    },
    About {
        stage: "merge-tracks",
        does: "Merges the boxes of all agents of a scene into one list of objects a frame, and makes tracks of them.",
        costs: "some 10 ms of a core for an agent's frame",
    },
    About {
        stage: "stats",
        does: "Adds up what stages counted: tables, figures, a report for the browser and a dataset card.",
        costs: "seconds, whatever the size of the sensors: it reads counts and boxes alone",
    },
];

/// The first lines of a stage's help.
#[must_use]
pub(crate) fn of_stage(name: &str) -> String {
    let found = STAGES.iter().find(|about| about.stage == name).zip(Graph::get().stage(name));
    found.map_or_else(String::new, |(about, spec)| lines(about, spec))
}

fn lines(about: &About, spec: &StageSpec) -> String {
    let read: Vec<&str> = spec.inputs().map(|input| input.name).collect();
    let reads = match &read[..] {
        [] => "the configuration and the maps that it names".to_owned(),
        read => format!("what {} made", read.join(", ")),
    };
    format!(
        "{}\n\nReads: {reads}\nMakes: {}\nCosts: {}\n\nOnly what is missing or stale is made: of all scenes of the plan, or \
         of some. `convoy run` runs all stages.",
        about.does,
        spec.writes.join(", "),
        about.costs
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_says_what_it_is() {
        let told: Vec<&str> = STAGES.iter().map(|about| about.stage).collect();
        let known: Vec<&str> = Graph::get().stages.iter().map(|stage| stage.name).collect();
        assert_eq!(told, known);
        assert!(of_stage("bev-gt").contains("Reads: what simulate-and-log made\nMakes: bev/, "));
        assert!(of_stage("spawn-planner").contains("Reads: the configuration"));
    }
}
