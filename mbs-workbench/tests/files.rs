//! Files that a user gives: measured tables, and texts that are laid out.
#![cfg(feature = "program")]

mod program;

use std::fs;

use program::{data, failure, scratch, text, wiper};

/// Measured angle 2 t + 0.3 sin 3 t with its rates at instants of 10 ms, in degrees, as a table.
fn measured(columns: usize) -> String {
    let names = ["theta (deg)", "theta_d (deg/s)", "theta_dd (deg/s^2)"];
    let head = names[..columns].join(",");
    let line = |k: i32| {
        let t = 0.01 * f64::from(k);
        let cells = law(t).map(|value| value.to_degrees().to_string());
        format!("{t},{}\n", cells[..columns].join(","))
    };
    format!("# an encoder\nt (s),{head}\n{}", (0..=200).map(line).collect::<String>())
}

fn law(t: f64) -> [f64; 3] {
    let (sine, cosine) = (3.0 * t).sin_cos();
    [2.0 * t + 0.3 * sine, 2.0 + 0.9 * cosine, -2.7 * sine]
}

#[test]
fn an_input_follows_a_measured_table_with_its_rates() {
    let folder = scratch("measured");
    fs::create_dir_all(&folder).expect("a folder");
    let table = folder.join("theta.csv");
    let place = folder.to_str().expect("a path");
    let input = format!("theta={}", table.display());
    // A cubic spline of steps h = 10 ms through values, splines through rates, polynomials of degree 5.
    for (columns, bounds) in [(1, [1e-7, 1e-5, 4e-3]), (2, [1e-10, 1e-8, 1e-5]), (3, [1e-13, 1e-11, 1e-8])] {
        fs::write(&table, measured(columns)).expect("a table");
        text(&["run", "probe", "--steps", "73", "--input", &input, "--out", place]);
        let data = data(&folder);
        let numbers = |values: &serde_json::Value| -> Vec<f64> {
            values.as_array().expect("values").iter().map(|value| value.as_f64().expect("a number")).collect()
        };
        let run = &data["runs"][0];
        let time = numbers(&run["time"]);
        assert_eq!((time.len(), time[73]), (74, 2.0));
        let csv = fs::read_to_string(folder.join("motion.csv")).expect("a table");
        let header = csv.lines().find(|line| line.starts_with("run,")).expect("a header");
        assert!(header.starts_with("run,t (s),phi (rad),phi_d (rad/s),phi_dd (rad/s^2),"), "{header}");
        let rows = csv.lines().skip_while(|line| !line.starts_with("run,")).skip(1);
        for (row, line) in rows.enumerate() {
            let cells: Vec<f64> =
                line.split(',').skip(1).map(|cell| cell.parse().expect("a number")).collect();
            for ((found, exact), bound) in cells[1..4].iter().zip(law(cells[0])).zip(bounds) {
                // Ends of a spline without slopes are parabolas, of lower order.
                let bound = if columns < 3 && !(10..64).contains(&row) { 3000.0 * bound } else { bound };
                assert!(
                    (found - exact).abs() < bound,
                    "{columns} columns, t = {}: {found} {exact}",
                    cells[0]
                );
            }
        }
        // A drawn point that is no output moves with the input.
        let place = run["places"].as_array().expect("places").iter().find(|place| place["name"] == "A.0");
        for (x, t) in numbers(&place.expect("a place")["value"]).iter().zip(&time) {
            assert!((x - 0.1 * law(*t)[0].cos()).abs() < 1e-6, "{t}: {x}");
        }
        let facts = data["facts"].as_array().expect("facts");
        assert!(facts.iter().any(|fact| fact[0] == "theta" && fact[1].as_str().is_some_and(|is| is.contains("theta.csv"))));
    }
}

/// Thrust 4 + 3 t − 2 t² of a measurement, which a cubic spline with parabolas at its ends meets.
fn thrust(t: f64) -> f64 {
    4.0 + t * (3.0 - 2.0 * t)
}

/// Columns of a run's CSV by name.
fn columns<const K: usize>(folder: &std::path::Path, names: [&str; K]) -> Vec<[f64; K]> {
    let csv = fs::read_to_string(folder.join("motion.csv")).expect("a table");
    let mut lines = csv.lines().skip_while(|line| !line.starts_with("run,"));
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let at = names.map(|name| {
        header.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name}: {header:?}"))
    });
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        at.map(|index| cells[index].parse().expect("a number"))
    };
    lines.map(row).collect()
}

#[test]
fn motions_from_forces_and_forces_of_motions_have_measured_inputs_at_every_instant() {
    let folder = scratch("measured-forces");
    fs::create_dir_all(&folder).expect("a folder");
    let (angle, force) = (folder.join("theta.csv"), folder.join("thrust.csv"));
    fs::write(&angle, measured(3)).expect("a table");
    // Ten instants: far less than the steps of a method.
    let line = |k: i32| format!("{},{}\n", 0.25 * f64::from(k), 1e-3 * thrust(0.25 * f64::from(k)));
    fs::write(&force, format!("t (s),thrust (kN)\n{}", (0..=8).map(line).collect::<String>()))
        .expect("a table");
    let [theta, push] =
        [("theta", &angle), ("thrust", &force)].map(|(name, path)| format!("{name}={}", path.display()));
    let place = folder.to_str().expect("a path");
    let given = ["--input", &theta, "--input", &push, "--steps", "60", "--out", place];
    for (method, bound) in [("projection", 1e-9), ("velocity", 1e-9), ("radau", 1e-7)] {
        text(&[&["simulate", "pushed_free:Free"][..], &given, &["--method", method]].concat());
        let names = ["t (s)", "x (m)", "x_d (m/s)", "x_dd (m/s^2)", "phi (rad)"];
        let rows = columns(&folder, names);
        assert_eq!((rows.len(), rows[60][0]), (61, 2.0));
        for [t, x, rate, acceleration, phi] in rows {
            // Of a mass of 2 kg.
            let exact = [
                t * t * (1.0 + t * (0.25 - t / 12.0)),
                t * (2.0 + t * (0.75 - t / 3.0)),
                0.5 * thrust(t),
                law(t)[0],
            ];
            for (found, exact) in [x, rate, acceleration, phi].into_iter().zip(exact) {
                assert!((found - exact).abs() < bound, "{method}, t = {t}: {found} {exact}");
            }
        }
    }
    text(&[&["inverse", "pushed_guided:Guided"][..], &given].concat());
    for [t, torque, rail] in columns(&folder, ["t (s)", "torque (N*m)", "rail_force (N)"]) {
        assert!(
            (torque - 0.3 * law(t)[2]).abs() < 1e-8 && (rail + thrust(t)).abs() < 1e-9,
            "{t}: {torque} {rail}"
        );
    }
}

#[test]
fn measured_points_are_drawn_and_compared() {
    let folder = scratch("overlaid");
    fs::create_dir_all(&folder).expect("a folder");
    let (theta, angle) = (folder.join("theta.csv"), folder.join("angle.csv"));
    fs::write(&theta, measured(3)).expect("a table");
    let line = |k: i32| {
        let t = 0.125 * f64::from(k);
        format!("{};{}\n", 1e3 * t, (law(t)[0] + 0.01 * f64::from(k % 2)).to_degrees())
    };
    fs::write(&angle, format!("time (ms);measured (deg)\n{}", (0..20).map(line).collect::<String>()))
        .expect("a table");
    let [input, overlay] =
        [("theta", &theta), ("angle", &angle)].map(|(name, path)| format!("{name}={}", path.display()));
    let place = folder.to_str().expect("a path");
    let said = text(&["kinematics", "probe", "--input", &input, "--overlay", &overlay, "--out", place]);
    let compared =
        "17 points, largest difference 0.01 rad, root mean square 0.00686 rad, 3 outside of the motion";
    assert!(said.contains(compared), "{said}");
    let data = data(&folder);
    assert_eq!(data["overlays"][0]["of"], "angle");
    assert_eq!(data["overlays"][0]["time"][1], 0.125);
    assert!(data["command"].as_str().is_some_and(|command| command.contains("--input theta=") && command.contains("--overlay angle=")));
}

#[test]
fn faults_of_measured_tables_name_file_line_column_and_cure() {
    let folder = scratch("faulty-tables");
    fs::create_dir_all(&folder).expect("a folder");
    let table = folder.join("theta.csv");
    let run = |option: &str, name: &str, content: &str, rest: &[&str], code: i32| {
        fs::write(&table, content).expect("a table");
        let given = format!("{name}={}", table.display());
        let out = folder.join("none");
        let place = ["run", "probe", option, &given, "--out", out.to_str().expect("a path")];
        let said = failure(&[&place[..], rest].concat(), code);
        assert!(!out.exists(), "{said}");
        said
    };
    let good = measured(1);
    for (name, content, rest, code, parts) in [
        ("thet", good.as_str(), &[][..], 2, &["no input `thet`", "did you mean `theta`?"][..]),
        ("arm", &good, &[], 2, &["`arm` is a parameter", "--param arm="]),
        ("theta.rate", &good, &[], 2, &["column of its own"]),
        ("theta", &good, &["--until", "2.5"], 2, &["ends at 2.5 s", "theta.csv at 2 s", "--until 2"]),
        (
            "theta",
            "t (s),theta (deg)\n1,2\n2,3\n3,4\n4,5\n",
            &[],
            2,
            &["begins at 0 s", "at 1 s", "subtract 1 s"],
        ),
        (
            "theta",
            "t (s),theta (deg)\n0,2\n2,3\n2,4\n4,5\n",
            &[],
            1,
            &["theta.csv: line 4, column 1", "help: sort"],
        ),
        (
            "theta",
            "t (s),theta (deg)\n0,2\n2,NaN\n3,4\n4,5\n",
            &[],
            1,
            &["theta.csv: line 3, column 2", "help: "],
        ),
        ("theta", "t (s),theta (deg)\n0,2\n2,3\n", &[], 1, &["theta.csv: the file has 2 rows", "help: "]),
        (
            "theta",
            "t (s),theta (mm)\n0,2\n2,3\n",
            &[],
            1,
            &["theta.csv: line 1, column 2: `theta` is in `mm`"],
        ),
    ] {
        let said = run("--input", name, content, rest, code);
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
    let said = run("--overlay", "angel", &good, &[], 2);
    assert!(said.contains("did you mean `angle`?"), "{said}");
    let said = run("--overlay", "tip", &good, &[], 2);
    assert!(said.contains("tip.0"), "{said}");
    let given = format!("theta={}", table.display());
    assert!(failure(&["run", "probe", "--input", &given, "--input", &given], 2).contains("twice"));
}

#[test]
fn a_motion_that_an_input_locks_is_told_with_its_time() {
    let folder = scratch("locked-input");
    fs::create_dir_all(&folder).expect("a folder");
    let theta = folder.join("theta.csv");
    fs::write(&theta, measured(3)).expect("a table");
    let (input, place) = (format!("theta={}", theta.display()), folder.to_str().expect("a path"));
    let arguments = ["run", "probe", "--param", "reach=80mm", "--input", &input, "--out", place];
    let output = wiper(&arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    // The slider is at 0 where the sine is 0.8.
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if law(middle)[0] < 0.8_f64.asin() { low = middle } else { high = middle }
    }
    assert!(said.contains(&format!("the motion ends at t = {low:.4} s: ")), "{low} {said}");
    assert!(said.contains(" | norm([x, arm*sin(phi)]) == reach;"), "{said}");
    assert!(folder.join("report.html").exists());
}

#[test]
fn a_slider_has_the_ends_of_the_text_and_motions_at_its_stops() {
    let folder = scratch("slider");
    let place = folder.to_str().expect("a path");
    text(&["run", "wiper", "--slide", "rocker=6", "--steps", "90", "--out", place]);
    let data = data(&folder);
    assert_eq!(data["command"], "mbs run wiper --steps 90 --slide rocker=6");
    let slider = &data["slider"];
    assert_eq!(slider["range"], serde_json::json!([0.02, 0.12]));
    assert_eq!((slider["name"].as_str(), slider["value"].as_f64()), (Some("rocker"), Some(0.08)));
    assert_eq!(slider["tolerance"], 1e-4);
    let stops = slider["stops"].as_array().expect("stops");
    let values: Vec<f64> = stops.iter().filter_map(|stop| stop["value"].as_f64()).collect();
    assert_eq!(values, [0.02, 0.04, 0.06, 0.1, 0.12]);
    for (value, stop) in values.iter().zip(stops) {
        let motions = stop["runs"].as_array().expect("motions");
        // The rod of 250 mm is longer than 200 mm from crank to base and the rocker together.
        if *value < 0.05 {
            let reason = stop["reason"].as_str().expect("a reason");
            assert!(motions.is_empty() && reason.contains("closure"), "{value}: {reason}");
            continue;
        }
        assert_eq!(motions.len(), data["runs"].as_array().expect("runs").len(), "{}", stop["reason"]);
        for motion in motions {
            let output = |name: &str| {
                let of =
                    motion["outputs"].as_array().expect("outputs").iter().find(|one| one["name"] == name);
                of.expect(name)["value"][30].as_f64().expect("a number")
            };
            let length = (output("B.0") - 0.24).hypot(output("B.1"));
            assert!((length - value).abs() < 1e-7, "{value}: {length}");
        }
    }
    // The present value is no even stop.
    text(&["run", "wiper", "--slide", "rocker=6", "--param", "rocker=70mm", "--steps", "9", "--out", place]);
    let slider = &self::data(&folder)["slider"];
    assert_eq!((slider["value"].as_f64(), slider["stops"].as_array().map(Vec::len)), (Some(0.07), Some(6)));
    for (name, code, parts) in [
        ("rod", 2, &["`rod` has no range", "param rod: m = … in LEAST..LARGEST;"][..]),
        ("krank", 2, &["no parameter `krank`", "did you mean `crank`?"][..]),
        ("crank=1", 2, &["number of stops from 2 to 41"][..]),
    ] {
        let said = failure(&["run", "wiper", "--slide", name, "--out", place], code);
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    }
    let said = failure(&["run", "probe", "--slide", "theta", "--out", place], 2);
    assert!(said.contains("`theta` is an input") && said.contains("--input theta="), "{said}");
}

#[test]
fn a_command_line_without_sense_has_a_document_too() {
    for (arguments, part) in [
        (&["run", "wiper", "--stepz", "9"][..], "--stepz"),
        (&["basins", "wiper", "--out", "picture"], "FILE.svg"),
        (&["Wiper"], "mbs run wiper"),
        (&["rn", "wiper"], "did you mean `run`?"),
        (&["run", "wiper", "--guess", "rod=20deg"], "it is an option of `mbs equilibrium`, "),
        (&["run", "wiper", "--analysis", "inverse"], "`mbs run` has no such option, no command has it"),
    ] {
        let output = wiper(&[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a document");
        assert_eq!(
            (&document["schema"], &document["error"]["exit_code"]),
            (&"mbs/usage/1".into(), &2.into())
        );
        let message = document["error"]["message"].as_str().expect("a message");
        assert!(message.contains(part) && !message.starts_with("error"), "{message}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(part));
    }
    let folder = scratch("near");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("pump.mbs"), "mechanism Pump;\n").expect("a file");
    let said = failure(&["check", folder.join("pmp.mbs").to_str().expect("a path")], 2);
    assert!(said.contains("near/pump.mbs`?"), "{said}");
    // Help is no error.
    let help = wiper(&["run", "--help", "--json"]);
    assert!(help.status.success() && !help.stdout.starts_with(b"{"));
}

#[test]
fn files_are_laid_out_or_left_with_their_faults() {
    let folder = scratch("laid-out");
    fs::create_dir_all(&folder).expect("a folder");
    let place = |name: &str, content: &str| {
        let path = folder.join(name);
        fs::write(&path, content).expect("a file");
        path.to_str().expect("a path").to_string()
    };
    let (rough, smooth) = ("mechanism A;coord phi:rad;\n", "mechanism A;\ncoord phi: rad;\n");
    let bare = place("a.mbs", rough);
    let rust = place("a.rs", &format!("//! Rust.\nmechanism! {{ {rough} }}\n"));
    let bad = place("bad.mbs", "mechanism A;\ncoord phi:rad\n");
    let output = wiper(&["fmt", "--check", &bare, &rust]);
    let (shown, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(shown.contains(&format!("{bare}:1\n- mechanism A;coord phi:rad;\n+ mechanism A;\n")), "{shown}");
    assert!(said.contains("2 files are laid out in another way"), "{said}");
    assert_eq!(fs::read_to_string(&bare).expect("a file"), rough);
    // The others are laid out, whatever one of them is like.
    let output = wiper(&["fmt", &bad, &bare, &rust]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("bad.mbs:2:") && said.contains("help: "), "{said}");
    assert_eq!(fs::read_to_string(&bad).expect("a file"), "mechanism A;\ncoord phi:rad\n");
    assert_eq!(fs::read_to_string(&bare).expect("a file"), smooth);
    let indented = "//! Rust.\nmechanism! {\n    mechanism A;\n    coord phi: rad;\n}\n";
    assert_eq!(fs::read_to_string(&rust).expect("a file"), indented);
    assert_eq!(text(&["fmt", "--check", &bare, &rust]), "");
    assert_eq!(text(&["fmt", &bare, &rust]), "");
    assert!(failure(&["fmt", "wiper"], 2).contains("is no file"));
    assert!(failure(&["fmt", "a.txt"], 2).contains("a.txt"));
    assert!(failure(&["fmt"], 2).contains("FILE"));
}
