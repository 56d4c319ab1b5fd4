//! Streets between blocks: a grid with gaps, whose corners become bends.

use random::Stream;
use std::collections::{BTreeMap, BTreeSet};

use crate::layout::NodeId;

/// A column and a row.
pub(super) type Cell = [usize; 2];

/// A grid of places and the streets between neighbours.
pub(super) struct Blocks {
    draws: Stream,
    at_m: BTreeMap<Cell, [f64; 2]>,
    links: BTreeMap<Cell, BTreeSet<Cell>>,
}

/// Streets in a row from crossing to crossing, without another crossing between.
pub(super) struct Chain {
    cells: Vec<Cell>,
    /// Corners on the way, metres east and north.
    pub(super) corners_m: Vec<[f64; 2]>,
}

impl Chain {
    /// Its first crossing and the place behind it.
    pub(super) fn first_pair(&self) -> Option<[Cell; 2]> {
        Some([*self.cells.first()?, *self.cells.get(1)?])
    }

    /// The place before its last crossing, and that crossing.
    pub(super) fn last_pair(&self) -> Option<[Cell; 2]> {
        let last = self.cells.len().checked_sub(2)?;
        Some([self.cells[last], self.cells[last + 1]])
    }
}

impl Blocks {
    pub(super) fn new(draws: Stream) -> Self {
        Self { draws, at_m: BTreeMap::new(), links: BTreeMap::new() }
    }

    /// Adds a place, metres east and north.
    pub(super) fn place(&mut self, cell: Cell, at_m: [f64; 2]) {
        self.at_m.insert(cell, at_m);
    }

    /// Adds a street between two places.
    pub(super) fn link(&mut self, a: Cell, b: Cell) {
        self.links.entry(a).or_default().insert(b);
        self.links.entry(b).or_default().insert(a);
    }

    fn degree(&self, cell: Cell) -> usize {
        self.links.get(&cell).map_or(0, BTreeSet::len)
    }

    /// Takes streets away, each with the given probability: those that `may` go and whose ends keep three
    /// streets.
    pub(super) fn leave_out(&mut self, probability: f64, may: impl Fn(Cell, Cell) -> bool) {
        let all: Vec<[Cell; 2]> = self
            .links
            .iter()
            .flat_map(|(a, others)| others.iter().filter(move |b| *b > a).map(|b| [*a, *b]))
            .collect();
        for [a, b] in all {
            let wished = self.draws.chance(probability);
            if wished && may(a, b) && self.degree(a) > 3 && self.degree(b) > 3 {
                self.unlink(a, b);
            }
        }
    }

    fn unlink(&mut self, a: Cell, b: Cell) {
        for (from, to) in [(a, b), (b, a)] {
            if let Some(others) = self.links.get_mut(&from) {
                others.remove(&to);
            }
        }
    }

    /// The crossings: places of three streets or more, and `kept` ones, where the caller adds more.
    pub(super) fn crossings(&self, kept: &BTreeSet<Cell>) -> Vec<(Cell, [f64; 2])> {
        let is_node = |cell: &Cell| self.degree(*cell) > 2 || kept.contains(cell);
        self.at_m.iter().filter(|(cell, _)| is_node(cell)).map(|(cell, at_m)| (*cell, *at_m)).collect()
    }

    /// The streets between crossings.
    pub(super) fn chains(&self, nodes: &BTreeMap<Cell, NodeId>) -> Vec<Chain> {
        let mut chains = Vec::new();
        let mut seen: BTreeSet<[Cell; 2]> = BTreeSet::new();
        for start in nodes.keys() {
            for next in self.links.get(start).into_iter().flatten() {
                if seen.contains(&[*start, *next]) {
                    continue;
                }
                let mut cells = vec![*start, *next];
                while let [.., before, here] = cells[..]
                    && !nodes.contains_key(&here)
                    && let Some(on) = self.links.get(&here).and_then(|all| all.iter().find(|c| **c != before))
                {
                    cells.push(*on);
                }
                if let [.., before, end] = cells[..] {
                    seen.insert([end, before]);
                }
                seen.insert([*start, *next]);
                let inner = &cells[1..cells.len() - 1];
                let corners_m = inner.iter().filter_map(|cell| self.at_m.get(cell).copied()).collect();
                chains.push(Chain { cells, corners_m });
            }
        }
        chains
    }
}
