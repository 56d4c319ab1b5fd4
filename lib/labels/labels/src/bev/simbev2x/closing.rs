//! Morphological closing of masks.

/// Closes gaps of a cell: a dilation, then an erosion, each by a cell and its four neighbours. What lies
/// outside the grid is empty for the first and full for the second.
pub(crate) fn close(mask: &mut [bool], side: usize) {
    let dilated = around(mask, side, |cell, near| cell || near.contains(&Some(true)));
    let eroded = around(&dilated, side, |cell, near| cell && !near.contains(&Some(false)));
    mask.copy_from_slice(&eroded);
}

/// Asks for the new value of every cell, given its own and those of its neighbours (none beyond the border).
fn around(mask: &[bool], side: usize, new: impl Fn(bool, [Option<bool>; 4]) -> bool) -> Vec<bool> {
    let value = |at: usize| {
        let (row, column) = (at / side, at % side);
        let near = [
            (row > 0).then(|| mask[at - side]),
            (row + 1 < side).then(|| mask[at + side]),
            (column > 0).then(|| mask[at - 1]),
            (column + 1 < side).then(|| mask[at + 1]),
        ];
        new(mask[at], near)
    };
    (0..mask.len()).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closed<const N: usize>(rows: [&str; N]) -> Vec<String> {
        let mut mask: Vec<bool> = rows.iter().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        close(&mut mask, N);
        let text = |row: &[bool]| row.iter().map(|&cell| if cell { '#' } else { '.' }).collect();
        mask.chunks(N).map(text).collect()
    }

    // Expected masks are those of scikit-image 0.26 (`binary_closing`).
    #[test]
    fn holes_and_cracks_are_closed_and_corners_stay() {
        assert_eq!(
            closed(["......", ".###..", ".#.##.", ".###..", "......", "......"]),
            ["..#...", ".###..", "#####.", ".###..", "......", "......"],
        );
        // Cracks of one and of two cells; three stay.
        assert_eq!(closed(["##.##..##"; 9]), ["#########"; 9]);
        assert_eq!(closed(["##...##"; 7]), ["##...##"; 7]);
        assert_eq!(closed(["#...", "....", "....", "...#"]), ["#...", "....", "....", "...#"]);
    }

    #[test]
    fn beyond_the_border_all_is_full_for_the_erosion() {
        assert_eq!(closed(["#.#.", ".#..", "....", "...."]), ["###.", ".#..", "....", "...."]);
        assert_eq!(closed([".#..", ".#..", ".#..", ".#.."]), ["##..", "##..", "##..", "##.."]);
    }
}
