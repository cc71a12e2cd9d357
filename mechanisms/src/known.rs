//! Tables of motions as the third leg of `mbs cost`.

use mbs_workbench::known_motion::KnownState;

/// Rows of numbers of a table with `#` comments and one line of column names.
pub fn table(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect()
}

/// States of a table `t, q.., q̇..` with `count` coordinates of each kind; further columns are left out.
pub fn states(text: &str, count: usize) -> Vec<KnownState> {
    let rows = table(text).into_iter();
    let state = |row: Vec<f64>| {
        let part = |from: usize| row.iter().copied().skip(from).take(count).collect();
        KnownState { t: row[0], q: part(1), qd: part(1 + count) }
    };
    rows.map(state).collect()
}
