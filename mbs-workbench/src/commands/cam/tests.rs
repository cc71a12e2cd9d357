//! `mbs cam` for rockers: cams, limits, files and faults of the command.

use core::f64::consts::TAU;

use clap::Parser;

use super::super::law_options;
use super::*;
use crate::cams::follower::Side;
use crate::cams::tests::solved_lift;

#[derive(Parser)]
#[command(no_binary_name = true)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

const LAW: &str = "even:2,6,8,10,12 --lift 11mm --duration 160deg";
const OPENER: &str = "--base 12mm --pivot 19mm,-19mm --arm 18.7mm --roller 12mm --valve-pad -12mm,-12mm";
const CLOSER: &str =
    "--base 17mm --pivot 23mm,-29mm --arm 29mm --roller 12mm --side right --valve-pad -12mm,-32mm";

/// Options in one text, and the closer's in another.
fn parsed(options: &str, closer: Option<&str>) -> Arguments {
    let words = options.split_whitespace().chain(closer.iter().flat_map(|text| ["--closer", text]));
    Line::try_parse_from(words).unwrap_or_else(|why| panic!("{why}")).arguments
}

fn rocker(options: &str) -> Arguments {
    parsed(&format!("{LAW} --follower rocker {options}"), None)
}

fn pair(options: &str, closer: &str) -> Arguments {
    parsed(&format!("{LAW} --follower desmodromic {OPENER} {options}"), Some(closer))
}

fn made(arguments: &Arguments) -> Result<Vec<Made>, CommandError> {
    cams(arguments, &arguments.law().expect("a law").lift)
}

#[track_caller]
fn refused(arguments: &Arguments) -> String {
    match made(arguments) {
        Ok(all) => panic!("{} cams", all.len()),
        Err(error) => error.to_string(),
    }
}

/// Law → profile → lift by the contact in two unknowns, and the distance of both rockers over a turn.
#[test]
fn rockers_of_the_command_move_the_valve_by_the_law() {
    for direction in ["ccw", "cw"] {
        let all = made(&pair(&format!("--direction {direction}"), CLOSER)).expect("both cams");
        let lifts: Vec<Vec<f64>> = all
            .iter()
            .map(|one| (0..60).map(|k| solved_lift(&one.cam, TAU * (f64::from(k) + 0.37) / 60.0)).collect())
            .collect();
        for (k, (open, close)) in lifts[0].iter().zip(&lifts[1]).enumerate() {
            let law = all[0].cam.lift.jet::<f64>(TAU * (k as f64 + 0.37) / 60.0)[0];
            assert!((open - law).abs() < 1e-14 && (close - law).abs() < 1e-14, "{direction} {k}");
        }
        assert_eq!(all.iter().map(|one| one.cam.opens()).collect::<Vec<_>>(), [Some(true), Some(false)]);
    }
}

/// Arm, base circle and side say where the pad is.
#[test]
fn a_rocker_has_the_dimensions_that_are_said() {
    for (options, [base, arm], pivot, is_left) in
        [(OPENER, [0.012, 0.0187], [0.019, -0.019], true), (CLOSER, [0.017, 0.029], [0.023, -0.029], false)]
    {
        let all = made(&rocker(options)).expect("a cam");
        let Follower::Rocker { cam_pad: [x, y], radius, .. } = all[0].cam.follower else { panic!() };
        assert!((x.hypot(y) - radius - base).abs() < 1e-16, "{options}");
        let [dx, dy] = [x - pivot[0], y - pivot[1]];
        assert!((dx.hypot(dy) - arm).abs() < 1e-16, "{options}");
        // Left of the line from the pivot to the cam's centre.
        assert_eq!(-pivot[0] * dy + pivot[1] * dx > 0.0, is_left, "{options}");
    }
}

/// The active limit is met with equality and named, of both sizes and both cams.
#[test]
fn the_least_rockers_meet_their_limits() {
    for (options, name, bound) in [
        (format!("{CLOSER} --least base --shaft 6mm"), "shaft", 0.006),
        (format!("{CLOSER} --least pad --wheel 60mm"), "grinding wheel", 0.06),
    ] {
        let all = made(&rocker(&options)).expect("a cam");
        let least = all[0].least.as_ref().expect("a size");
        let active = least.active.expect("a limit");
        assert_eq!(active.name(), name, "{options}");
        let verdict = all[0].verdicts.iter().find(|one| one.limit == active).expect("its verdict");
        assert!(verdict.kept && (verdict.value / bound - 1.0).abs() < 1e-12, "{options}: {verdict:?}");
        assert!(all[0].verdicts.iter().all(|one| one.kept), "{options}");
        // A smaller one breaks it.
        let Follower::Rocker { pivot, cam_pad, radius, valve_pad } = least.cam.follower else { panic!() };
        let arm = (cam_pad[0] - pivot[0]).hypot(cam_pad[1] - pivot[1]);
        let (side, smaller) = (if options.contains("right") { Side::Right } else { Side::Left }, 0.999);
        let [base, radius] = if options.contains("--least pad") {
            [least.cam.follower.base(), smaller * radius]
        } else {
            [smaller * least.size, radius]
        };
        let follower = Follower::rocker(base, pivot, arm, radius, side, valve_pad).expect("a rocker");
        let cam = Cam::new(least.cam.lift.clone(), follower, least.cam.direction).expect("a cam");
        let rocker = rocker(&options);
        let broken = examine(&cam, &rocker.limits()).into_iter().find(|one| !one.kept).map(|one| one.limit);
        assert_eq!(broken.map(|limit| limit.name()), Some(name), "{options}");
    }
    let message = refused(&pair("--least base --outer 15mm --shaft 9mm", CLOSER));
    assert!(
        message.starts_with("opener: the limits on shaft and outer radius contradict each other"),
        "{message}"
    );
}

/// A pad that covers the cam's centre has no cam, whatever the curvature of its path.
#[test]
fn a_pad_over_the_centre_of_the_cam_breaks_the_shaft() {
    let all = made(&rocker(&CLOSER.replace("17mm", "6mm"))).expect("a profile");
    let shaft = all[0].verdicts.iter().find(|one| one.limit.name() == "shaft").expect("the limit");
    assert!(!shaft.kept && shaft.value < 0.0, "{shaft:?}");
}

#[test]
fn faults_of_rockers_name_their_cure() {
    let swapped = refused(&pair("", &CLOSER.replace("--side right", "--side left")));
    assert!(swapped.contains("closer: its cam opens the valve") && swapped.contains("--side"), "{swapped}");
    let short = refused(&rocker(&OPENER.replace("18.7mm", "1mm")));
    assert!(short.contains("does not reach the base circle"), "{short}");
    let alone = refused(&parsed(&format!("{LAW} --follower desmodromic {OPENER}"), None));
    assert!(alone.contains("needs the rocker that closes") && alone.contains("--closer"), "{alone}");
    let misspelt = refused(&pair("", &CLOSER.replace("--arm", "--amr")));
    assert!(misspelt.contains("--closer") && misspelt.contains("--amr"), "{misspelt}");
    let missing = refused(&pair("", &CLOSER.replace("--arm 29mm", "")));
    assert!(missing.contains("`--closer`: this follower needs `--arm"), "{missing}");
    let foreign = refused(&parsed(&format!("{LAW} --follower rocker {OPENER}"), Some(CLOSER)));
    assert!(foreign.contains("`--closer` belongs to another follower"), "{foreign}");
    let foreign = refused(&parsed(&format!("{LAW} --follower flat --base 20mm --valve-pad 1mm,1mm"), None));
    assert!(foreign.contains("`--valve-pad` belongs to another follower"), "{foreign}");
}

/// Every place of a rocker's CSV: the pad touches the contour where the rocker's angle puts it.
#[test]
fn files_of_a_pair_have_both_cams() {
    let folder = target_directory().join("tmp").join("pair_of_cams");
    let arguments = pair(&format!("--out {}", folder.display()), CLOSER);
    let mut text = Vec::new();
    run(&arguments, &mut Output::new(&mut text, None)).expect("files");
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(text.contains("opening cam") && text.contains("closing cam"), "{text}");
    let page = fs::read_to_string(folder.join("cam.html")).expect("the page");
    assert!(page.contains("\"name\":\"opener\"") && page.contains("\"name\":\"closer\""));
    let all = made(&arguments).expect("both cams");
    for one in &all {
        assert!(
            fs::read_to_string(folder.join(format!("{}.dxf", one.name)))
                .expect("a drawing")
                .contains("VERTEX")
        );
        let table = fs::read_to_string(folder.join(format!("{}.csv", one.name))).expect("a table");
        let head: Vec<&str> = table.lines().nth(1).expect("a header").split(',').collect();
        let column = |name: &str| head.iter().position(|known| known.starts_with(name)).expect(name);
        let columns = ["theta", "lift", "contour x", "contour y", "rocker"].map(column);
        let Follower::Rocker { pivot, cam_pad, radius, valve_pad } = one.cam.follower else { panic!() };
        for line in table.lines().skip(2) {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let [theta, lift, x, y, angle] = columns.map(|at| cells[at]);
            let turned = |[x, y]: [f64; 2], angle: f64| {
                let (s, c) = angle.sin_cos();
                [c * x - s * y, s * x + c * y]
            };
            let placed = |pad: [f64; 2]| {
                let arm = turned([pad[0] - pivot[0], pad[1] - pivot[1]], angle);
                [pivot[0] + arm[0], pivot[1] + arm[1]]
            };
            let centre = turned(placed(cam_pad), -theta);
            assert!(((centre[0] - x).hypot(centre[1] - y) - radius).abs() < 1e-16, "{line}");
            assert!((valve_pad[1] - placed(valve_pad)[1] - lift).abs() < 1e-16, "{line}");
        }
        assert_eq!(table.lines().count(), 722);
    }
    let mut code = Vec::new();
    let arguments = pair("--rust PITCH", CLOSER);
    run(&arguments, &mut Output::new(&mut code, None)).expect("code");
    let code = String::from_utf8(code).expect("UTF-8");
    assert!(
        syn::parse_file(&code).is_ok() && code.contains("PITCH_OPENER:") && code.contains("PITCH_CLOSER:")
    );
}

#[test]
fn a_measured_profile_is_of_one_rocker() {
    let mut text = Vec::new();
    let arguments = parsed(&format!("profile.csv --measured --follower desmodromic {OPENER}"), Some(CLOSER));
    let refused = run(&arguments, &mut Output::new(&mut text, None)).expect_err("two followers").to_string();
    assert!(refused.contains("has one follower") && refused.contains("--follower rocker"), "{refused}");
}

/// Page and terminal name the file of a table and its points.
#[test]
fn a_table_of_the_lift_is_named() {
    let folder = target_directory().join("tmp").join("cam_of_a_table");
    fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("lift.csv");
    let line = |k: u32| format!("{},{:.9}\n", 4 * k, 2.0 * (1.0 - f64::from(4 * k).to_radians().cos()));
    let table: String = (0..90).map(line).collect();
    fs::write(&file, format!("angle (deg),lift (mm)\n{table}")).expect("a table");
    let words = format!("--follower flat --base 20mm --knots 60 --out {}", folder.display());
    let words: Vec<&str> = words.split_whitespace().collect();
    let words = [&[file.to_str().expect("a path")], &words[..]].concat();
    let arguments = Line::try_parse_from(words).unwrap_or_else(|why| panic!("{why}")).arguments;
    let mut text = Vec::new();
    run(&arguments, &mut Output::new(&mut text, None)).expect("files");
    let said = "table lift.csv, 90 points, a fit with 60 knots";
    assert!(String::from_utf8(text).expect("UTF-8").contains(said));
    let page = fs::read_to_string(folder.join("cam.html")).expect("the page");
    assert!(page.contains(&format!("Lift law: {said}.")));
}

/// No option is left aside silently, and none takes a value that it cannot have.
#[test]
fn options_of_other_laws_and_values_out_of_range_are_refused_with_a_cure() {
    let flat = "--follower flat --base 20mm";
    for (law, expected) in [
        (
            "345 --lift 5mm --rise 90deg --duration 50deg",
            "help: leave it out; this law has `--lift`, `--rise`",
        ),
        ("even:2,4 --lift 5mm --duration 90deg --knots 9", "an even-power law has `--lift`, `--duration`"),
        ("lift.csv --lift 5mm", "`--lift` belongs to another law than `lift.csv`"),
        ("cyclod --lift 5mm", "did you mean `cycloid`?"),
        ("lft.csv", "lft.csv: cannot be read: there is no such file\nhelp: "),
        ("345 --lift -5mm --rise 90deg", "`-5mm` is not above 0"),
        ("345 --lift 5mm --rise 90deg --ramp -1mm,5deg", "`-1mm` is not above 0"),
        ("345 --lift 5mm --rise 300deg", "help: rise, dwell and return together"),
    ] {
        let refused = parsed(&format!("{law} {flat}"), None).law().map(|_| ()).expect_err(law).to_string();
        assert!(refused.contains(expected), "{law}: {refused}");
    }
    for (options, expected) in [
        ("--base 0mm", "`0mm` is not above 0: write it as `12mm`"),
        ("--base -5mm", "`-5mm` is not above 0"),
        ("--base 20mm --pressure-angle 95deg", "not below 90deg"),
        ("--base 20mm --shaft -1mm", "`-1mm` is negative"),
        ("--base 20mm --hertz 1GPa --width 1mm --force 0N", "`0N` is not above 0"),
        ("--base 20mm --force 5N", "--hertz"),
        ("--base 20mm --measured --rise 90deg", "cannot be used with"),
    ] {
        let words = format!("345 --lift 5mm --follower flat {options}");
        let refused = Line::try_parse_from(words.split_whitespace()).map(|_| ()).expect_err(options);
        assert!(refused.to_string().contains(expected), "{options}: {refused}");
    }
}

/// The words of harmonics: mean, then cosine and sine of each.
#[test]
fn harmonics_of_the_command_are_their_sum() {
    let law = law_options::written("harmonics:4mm, -4mm 0.5mm, 0.2mm").expect("a law").lift;
    for k in 0..24 {
        let theta = TAU * f64::from(k) / 24.0;
        let expected = 4.0 - 4.0 * theta.cos() + 0.5 * theta.sin() + 0.2 * (2.0 * theta).cos();
        assert!((1e3 * law.jet(theta)[0] - expected).abs() < 1e-14, "{theta}");
    }
    for (text, expected) in [
        ("harmonics:4mm", "one amplitude is needed"),
        ("harmonics:4mm, 1", "a unit is needed"),
        ("harmonics:4mm, 0mm", "moves nothing"),
        ("harmonics:4mm, 1mm 2mm 3mm", "is no cosine and sine"),
        ("", "no law is written"),
        ("4567 --lift 8mm --ris 75deg", "'--rise'"),
    ] {
        let refused = law_options::written(text).map(|_| ()).expect_err(text).to_string();
        assert!(refused.contains(expected), "{text}: {refused}");
    }
}

/// Profile → lift by `--measured` → law by its file, and the page's heading of a law that has a `/` in it.
#[test]
fn the_lift_of_a_measured_profile_is_a_law_and_a_law_is_no_path() {
    let folder = target_directory().join("tmp").join("cam_there_and_back");
    let roller = format!("--follower roller --base 17mm --roller 12mm --out {}", folder.display());
    let mut text = Vec::new();
    run(&parsed(&format!("{LAW} {roller}"), None), &mut Output::new(&mut text, None)).expect("a profile");
    let file = |name: &str| folder.join(name).display().to_string();
    let contour = ["--columns", "-,-,-,-,-,m,m"];
    let profile = file("profile.csv");
    let measured = |words: String| {
        let words: Vec<&str> =
            [profile.as_str()].into_iter().chain(words.split(' ')).chain(contour).collect();
        let arguments = Line::try_parse_from(words).unwrap_or_else(|why| panic!("{why}")).arguments;
        let mut text = Vec::new();
        run(&arguments, &mut Output::new(&mut text, None)).expect("a lift");
        String::from_utf8(text).expect("text")
    };
    // Of another base circle than that of the profile.
    let off = measured(format!("--measured {}", roller.replace("17mm", "16mm")));
    assert!(
        off.contains("base         the least lift is ") && off.contains(" mm, not 0: check `--base`"),
        "{off}"
    );
    let own = measured(format!("--measured {roller}"));
    assert!(!own.contains("the least lift"), "{own}");
    let law = law_options::written(LAW).expect("a law").lift;
    let read = law_options::written(&file("lift.csv")).expect("all its columns have units").lift;
    for k in 0..36 {
        let theta = f64::from(10 * k).to_radians();
        let [found, exact] = [&read, &law].map(|lift| lift.jet::<f64>(theta)[0]);
        assert!((found - exact).abs() < 1e-6, "{theta}: {found} {exact}");
    }
    // A file of more columns is asked for two of them.
    let many = law_options::written(&profile).map(|_| ()).expect_err("many columns").to_string();
    assert!(many.contains("columns with units, and two are read"), "{many}");
    let spline = "bspline:degree 5; knots 0deg 80deg 80deg 80deg 160deg; at 0deg: s = 0, v = 0, a = 0; \
                  at 80deg: s = 11mm, v = 0, a = -15mm/rad^2; at 160deg: s = 0, v = 0, a = 0";
    assert_eq!(law_options::written(spline).expect("a law").name, spline);
    assert_eq!(law_options::written(&file("lift.csv")).expect("a law").name, "lift.csv");
}

/// Columns stay apart: an arm that outruns its cam has radii without bound, and a rest that rounding leaves is 0 without a sign.
#[test]
fn columns_of_limits_stay_apart() {
    assert_eq!(shown("undercut", -5.7e22), "-5.700e25 mm");
    assert_eq!(shown("undercut", -0.999), "-999.00000 mm");
    assert_eq!(shown("Hertz pressure", 1e9), "1000.00 MPa");
    assert!(unsigned_zero(-1e-6).is_sign_positive() && unsigned_zero(-1e-4) == -1e-4);
    let folder = target_directory().join("tmp").join("cam_of_a_quick_arm");
    let words = "cycloid --lift 50deg --rise 30deg --follower oscillating-flat --base 20mm --pivot 80mm,0mm --half-face 60mm";
    let mut text = Vec::new();
    run(&parsed(&format!("{words} --out {}", folder.display()), None), &mut Output::new(&mut text, None))
        .expect("a page");
    let text = String::from_utf8(text).expect("UTF-8");
    let rows = text.lines().skip_while(|line| !line.starts_with("limit")).skip(1);
    for row in rows.take_while(|line| !line.starts_with("files")) {
        assert!(row.chars().count() <= 80 && !row.contains("mm-"), "{row}");
        let gaps = row.matches("mm ").count();
        assert_eq!(gaps, 2, "{row}");
    }
}
