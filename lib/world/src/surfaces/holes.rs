//! Asphalt for the places of a junction that its connecting lanes surround without covering them.

use std::collections::VecDeque;

use nalgebra::Point3;
use opendrive::{JunctionInfo, Map};
use schema::Tag;
use schema::geometry::{Part, Surface};

use super::cover::Cover;
use super::tiles::Tiles;
use super::{Layer, Region};
use crate::build::part;

/// Side of a test cell, metres.
const CELL_M: f64 = 1.0;
/// Larger junctions have islands rather than holes.
const MAX_CELLS: usize = 160 * 160;
/// Patches lie this far under the lanes around them, metres.
const BELOW_M: f64 = 0.015;
/// Larger enclosed areas are land, square metres.
const MAX_AREA_M2: usize = 150;

const ASPHALT: Part = part(Tag::Road, Surface::Asphalt, [0.085, 0.085, 0.09]);

pub(crate) fn fill(map: &Map, region: &Region, cover: &Cover, tiles: &mut Tiles) {
    for junction in map.junctions() {
        let [low, high] = junction.bounds;
        if region.contains(low.x, low.y) && region.contains(high.x, high.y) {
            fill_one(junction, cover, tiles);
        }
    }
}

fn fill_one(junction: &JunctionInfo, cover: &Cover, tiles: &mut Tiles) {
    let [low, high] = junction.bounds;
    let (x0, y0) = (low.x.floor() - 1.0, low.y.floor() - 1.0);
    let columns = ((high.x - x0) / CELL_M).ceil() as usize + 2;
    let rows = ((high.y - y0) / CELL_M).ceil() as usize + 2;
    // Decks over one another are no matter for patches at one height.
    if columns * rows > MAX_CELLS || high.z - low.z > 3.0 {
        return;
    }
    let middle =
        |i: usize| (x0 + ((i % columns) as f64 + 0.5) * CELL_M, y0 + ((i / columns) as f64 + 0.5) * CELL_M);
    let heights: Vec<Option<f64>> = (0..columns * rows)
        .map(|i| {
            let (x, y) = middle(i);
            let near = cover.at(x, y).map(|(_, z)| z).filter(|z| (z - junction.centre.z).abs() < 4.0);
            near.min_by(f64::total_cmp)
        })
        .collect();
    let neighbours = |i: usize| {
        let (c, r) = (i % columns, i / columns);
        let mut near = Vec::with_capacity(4);
        if c > 0 {
            near.push(i - 1);
        }
        if c + 1 < columns {
            near.push(i + 1);
        }
        if r > 0 {
            near.push(i - columns);
        }
        if r + 1 < rows {
            near.push(i + columns);
        }
        near
    };
    // What can be reached from outside is land; other uncovered cells are holes.
    let mut seen: Vec<bool> = heights.iter().map(Option::is_some).collect();
    let mut flood = |start: usize| -> Vec<usize> {
        let mut found = Vec::new();
        if std::mem::replace(&mut seen[start], true) {
            return found;
        }
        let mut queue = VecDeque::from([start]);
        while let Some(i) = queue.pop_front() {
            found.push(i);
            for n in neighbours(i) {
                if !std::mem::replace(&mut seen[n], true) {
                    queue.push_back(n);
                }
            }
        }
        found
    };
    for i in (0..heights.len()).filter(|i| {
        let (c, r) = (i % columns, i / columns);
        c == 0 || r == 0 || c + 1 == columns || r + 1 == rows
    }) {
        flood(i);
    }
    let holes: Vec<Vec<usize>> = (0..heights.len()).map(&mut flood).filter(|h| !h.is_empty()).collect();
    for hole in holes.into_iter().filter(|h| h.len() <= MAX_AREA_M2) {
        let around: Vec<f64> = hole.iter().flat_map(|i| neighbours(*i)).filter_map(|n| heights[n]).collect();
        if around.is_empty() {
            continue;
        }
        // One cell more on every side, under the lanes' edges.
        let mut cells: Vec<usize> =
            hole.iter().flat_map(|i| neighbours(*i)).chain(hole.iter().copied()).collect();
        cells.sort_unstable();
        cells.dedup();
        let fallback = around.iter().sum::<f64>() / around.len() as f64;
        let corner = |x: f64, y: f64| {
            let covered =
                cover.at(x, y).map(|(_, z)| z).filter(|z| (z - fallback).abs() < 2.0).min_by(f64::total_cmp);
            Point3::new(x, y, covered.unwrap_or(fallback) - BELOW_M)
        };
        for i in cells {
            let (x, y) = middle(i);
            let h = 0.5 * CELL_M;
            let quad =
                [corner(x - h, y - h), corner(x + h, y - h), corner(x + h, y + h), corner(x - h, y + h)];
            tiles.quad(Layer::Road, ASPHALT, quad);
        }
    }
}
