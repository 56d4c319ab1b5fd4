//! How often classes occur, beside the published dataset.

use std::fmt::Write;

use schema::{BevClass, DetectionClass, Published, Tag};

/// Occurrences of classes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shares {
    /// Frames of scenes whose merged boxes were read.
    pub(crate) frames: u64,
    /// Merged boxes of a class: all, valid ones, and frames with fewer than five valid ones.
    pub(crate) boxes: [[u64; 3]; DetectionClass::ALL.len()],
    pub(crate) bev_grids: u64,
    pub(crate) bev_cells: [u64; BevClass::COUNT],
    pub(crate) voxel_grids: u64,
    /// Voxels of a tag, unfilled.
    pub(crate) voxels: [u64; Tag::COUNT],
    /// Voxels of a tag in filled grids.
    pub(crate) filled: [u64; Tag::COUNT],
}

impl Shares {
    pub(crate) fn take(&mut self, other: Self) {
        self.frames += other.frames;
        self.bev_grids += other.bev_grids;
        self.voxel_grids += other.voxel_grids;
        for (mine, other) in self.boxes.iter_mut().flatten().zip(other.boxes.iter().flatten()) {
            *mine += other;
        }
        let pairs = self.bev_cells.iter_mut().zip(other.bev_cells);
        let pairs = pairs.chain(self.voxels.iter_mut().zip(other.voxels));
        for (mine, other) in pairs.chain(self.filled.iter_mut().zip(other.filled)) {
            *mine += other;
        }
    }

    /// The tables of a report.
    pub(crate) fn tables(&self) -> String {
        let mut text = String::new();
        if self.frames > 0 {
            self.tell_boxes(&mut text);
        }
        if self.bev_grids > 0 {
            self.tell_cells(&mut text);
        }
        if self.voxel_grids > 0 {
            self.tell_voxels(&mut text);
        }
        text
    }

    fn tell_boxes(&self, text: &mut String) {
        let frames = self.frames as f64;
        let _ = writeln!(
            text,
            "Boxes per frame, {} frames (published beside)\n{:15}{:>10}{:>10}{:>8}{:>10}{:>10}{:>8}{:>11}{:>11}",
            self.frames, "class", "all", "publ.", "ratio", "valid", "publ.", "ratio", "under 5 %", "publ. %"
        );
        for (class, counts) in DetectionClass::ALL.into_iter().zip(&self.boxes) {
            let here = counts.map(|count| count as f64 / frames);
            let there = Published::boxes(class).map(|count| count / Published::FRAMES);
            let _ = writeln!(
                text,
                "{:15}{:>10.2}{:>10.2}{}{:>10.2}{:>10.2}{}{:>11.1}{:>11.1}",
                class.name(),
                here[0],
                there[0],
                ratio(here[0], there[0]),
                here[1],
                there[1],
                ratio(here[1], there[1]),
                100.0 * here[2],
                100.0 * there[2]
            );
        }
    }

    fn tell_cells(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\nBEV cells per mask, {} masks (published beside: 400 x 400 cells of 0.4 m)\n{:15}{:>12}{:>12}{:>8}",
            self.bev_grids, "class", "cells", "publ.", "ratio"
        );
        for (class, &cells) in BevClass::ALL.into_iter().zip(&self.bev_cells) {
            let here = cells as f64 / self.bev_grids as f64;
            let there = Published::bev_cells(class) / Published::GRIDS;
            let _ = writeln!(text, "{:15}{here:>12.2}{there:>12.2}{}", class.name(), ratio(here, there));
        }
    }

    fn tell_voxels(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\nShare of occupied voxels, {} grids (published beside: 1280 x 1280 x 80 voxels of 0.1 m)\n{:15}{:>12}{:>10}{:>8}{:>12}{:>10}{:>8}",
            self.voxel_grids, "tag", "unfilled %", "publ. %", "ratio", "filled %", "publ. %", "ratio"
        );
        let sum = |counts: &[u64]| counts.iter().skip(1).sum::<u64>() as f64;
        let there_sum =
            [0, 1].map(|k| Tag::ALL.into_iter().map(|tag| Published::voxels(tag)[k]).sum::<f64>());
        for (k, tag) in Tag::ALL.into_iter().enumerate().skip(1) {
            let there = Published::voxels(tag);
            if self.voxels[k] == 0 && self.filled[k] == 0 && there[0] == 0.0 {
                continue;
            }
            let percent = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
            let plain = percent(self.voxels[k] as f64, sum(&self.voxels));
            let filled = percent(self.filled[k] as f64, sum(&self.filled));
            let (there_filled, there_plain) =
                (percent(there[0], there_sum[0]), percent(there[1], there_sum[1]));
            let _ = writeln!(
                text,
                "{:15}{plain:>12.3}{there_plain:>10.3}{}{filled:>12.3}{there_filled:>10.3}{}",
                tag.name(),
                ratio(plain, there_plain),
                ratio(filled, there_filled)
            );
        }
    }
}

/// Here by there, if there is anything.
fn ratio(here: f64, there: f64) -> String {
    if there > 0.0 { format!("{:>8.2}", here / there) } else { format!("{:>8}", "-") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_is_told_beside_its_published_rate() {
        let mut shares = Shares { frames: 10, ..Shares::default() };
        shares.boxes[DetectionClass::Bus as usize] = [40, 20, 5];
        let mut twice = shares.clone();
        twice.take(shares);
        let text = twice.tables();
        let bus: Vec<_> =
            text.lines().find(|l| l.starts_with("bus")).expect("a line").split_whitespace().collect();
        // 206,571 and 146,310 of 102,200 frames; 96,743 frames with under five.
        assert_eq!(bus, ["bus", "4.00", "2.02", "1.98", "2.00", "1.43", "1.40", "50.0", "94.7"]);
        assert!(!text.contains("BEV") && !text.contains("voxels"));
    }
}
