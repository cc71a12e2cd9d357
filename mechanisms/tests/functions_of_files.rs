//! Functions of texts in files, through the forge: a compiler's time, so behind the feature `long`.
#![cfg(feature = "long")]

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Two followers of cams, and a slider on a spring by a table.
const TEXT: &str = "pub mechanism Valves;
function lift: [m; 2](rad), C3, periodic TAU;
function push: N(m), C1;
coord theta: rad;
coord y: [m; 2];
coord x: m = 1mm;
drive shaft: theta == 10 [rad/s]*t;
constraint faces { for i in 0..2 { y[i] == lift[i](theta); } }
body slide { mass: 1kg, com: [x, 0] }
force spring: -push(x) on x;
";

/// Lift (mm) of the table.
fn lift(theta: f64) -> f64 {
    4.0 * (1.0 - theta.cos())
}

/// 4-5-6-7 polynomial: 8 mm up within 75 deg, and down again (mm).
fn law(theta: f64) -> f64 {
    let u = theta.rem_euclid(TAU) / 75_f64.to_radians();
    let rise = |u: f64| 8.0 * u.powi(4) * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)));
    match u {
        u if u <= 1.0 => rise(u),
        u if u <= 2.0 => rise(2.0 - u),
        _ => 0.0,
    }
}

#[test]
fn a_text_in_a_file_runs_with_tables_and_laws_of_the_command_line() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("functions-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a directory");
    fs::write(folder.join("valves.mbs"), TEXT).expect("a text");
    let line = |k: u32| format!("{},{:.15}\n", 2 * k, lift(f64::from(2 * k).to_radians()));
    let table: String = (0..180).map(line).collect();
    fs::write(folder.join("lift.csv"), format!("angle (deg),lift (mm)\n{table}")).expect("a table");
    // 2 N/mm.
    let table: String = (-10..=10).map(|k| format!("{k},{}\n", 2 * k)).collect();
    fs::write(folder.join("push.csv"), table).expect("a table");
    let run = |law: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_mbs-catalogue"))
            .current_dir(&folder)
            .args(["simulate", "valves.mbs", "--until", "1", "--steps", "100", "--out", "."])
            .args(["--function", "lift[0]=lift.csv", "--function", law, "--function=push=push.csv:mm,N"])
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let table = fs::read_to_string(folder.join("motion.csv")).expect("a table");
        let mut lines = table.lines().filter(|line| !line.starts_with('#'));
        let head: Vec<&str> = lines.next().expect("names").split(',').collect();
        let at = ["t (s)", "y.0 (m)", "y.1 (m)", "x (m)"].map(|name| {
            head.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}: {head:?}"))
        });
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            at.map(|index| cells[index].parse::<f64>().expect("a number"))
        };
        lines.map(row).collect::<Vec<_>>()
    };
    let rows = run("lift[1]=4567 --lift 8mm --rise 75deg");
    assert_eq!(rows.len(), 101);
    let mut errors = [0.0_f64; 3];
    for [t, one, other, x] in rows {
        let exact = [1e-3 * lift(10.0 * t), 1e-3 * law(10.0 * t), 1e-3 * (2000_f64.sqrt() * t).cos()];
        for (error, (found, exact)) in errors.iter_mut().zip([one, other, x].into_iter().zip(exact)) {
            *error = error.max((found - exact).abs());
        }
    }
    println!(
        "table {:.1e} m of 1e-10, law {:.1e} m of 1e-14, motion {:.1e} m of 1e-9",
        errors[0], errors[1], errors[2]
    );
    assert!(errors[0] < 1e-10 && errors[1] < 1e-14 && errors[2] < 1e-9, "{errors:?}");
    // The page names tables with their points, and laws.
    let page = fs::read_to_string(folder.join("report.html")).expect("the page");
    for part in
        ["table lift.csv, 180 points", "table push.csv, 21 points", "law 4567 --lift 8mm --rise 75deg"]
    {
        assert!(page.contains(part), "{part}");
    }
    // Another function in the same program.
    let rows = run("lift[1]=lift.csv");
    assert!(rows.iter().all(|[_, one, other, _]| one == other));
    fs::remove_dir_all(&folder).expect("the directory");
}
