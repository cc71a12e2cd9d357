//! Steps of the study.

use core::f64::consts::{PI, TAU};

use mbs_workbench::cams::limits::{Limit, Limits, Verdict, examine};
use mbs_workbench::cams::noise;
use mbs_workbench::study::{Picture, Section, StudyError, Table};

use super::super::design::Curve;
use super::super::motion::{FORCES, Misfit, Ordinary, Permanent, Turn, against_law};
use super::{Case, Chain, TOLERANCE, case, failed, moving, pictures, tables};

/// Said with tables of peaks.
const LARGEST: &str = "Largest values are those of all steps of the motion. Curves and arrows have the largest value from one shown cam angle to the next.";

/// Points of the tables whose mismatch is drawn.
const SHOWN: u32 = 180;

/// Places of the comparison with the law, beside the points of every table, as a share of their distance.
const OFFSET: f64 = 0.37;

/// A number with these decimals, in powers of ten where they show less than two digits of it.
fn figure(value: f64, decimals: usize) -> String {
    let is_small = value != 0.0 && value.abs() < 10_f64.powi(1 - decimals as i32);
    if is_small { format!("{value:.1e}") } else { format!("{value:.decimals$}") }
}

fn revolutions(speed: f64) -> f64 {
    speed * 30.0 / PI
}

/// Both cams from the law: sizes, curvature, pressure angle; the second part says which of them is undercut.
pub fn synthesis(chain: &Chain) -> Result<(Section, String), StudyError> {
    /// Bounds that all values are compared with: any ones, for the values themselves are shown.
    const ALL: Limits = Limits {
        radius: Some(1e-3),
        wheel: Some(1.0),
        pressure_angle: Some(1.0),
        hertz: None,
        half_face: None,
        outer: Some(1.0),
        shaft: None,
    };
    let mut table = Table::new([
        "cam",
        "radii (mm)",
        "least convex R (mm)",
        "hollow R (mm)",
        "pressure angle (deg)",
        "sliding (mm/rad)",
        "undercut",
    ]);
    let mut undercut = String::new();
    for (name, cam) in ["opening", "closing"].into_iter().zip(&chain.cams) {
        let verdicts = examine(cam, &ALL);
        let [whole, near, convex, hollow, pressure, far] = [
            Limit::Undercut,
            Limit::Shaft(0.0),
            Limit::Radius(1e-3),
            Limit::Wheel(1.0),
            Limit::PressureAngle(1.0),
            Limit::Outer(1.0),
        ]
        .map(|limit| verdicts.iter().find(|one| one.limit == limit));
        let value = |one: Option<&Verdict>| one.map_or(f64::NAN, |one| one.value);
        let sliding = (0..1440)
            .fold(0.0, |most: f64, k| most.max(cam.place(TAU * f64::from(k) / 1440.0 - PI).sliding.abs()));
        let radius = |value: f64, digits: usize| match value.is_finite() && value > 0.0 {
            true => format!("{:.digits$}", 1e3 * value),
            false => "-".to_string(),
        };
        let broken = [whole, near].into_iter().flatten().find(|one| !one.kept);
        if let Some(one) = broken {
            undercut += &format!(
                " The {name} cam is undercut at {:.1}°: no contour makes this motion, and all forces are those of a pad led along its pitch curve.",
                one.angle.to_degrees()
            );
        }
        table.push([
            name.to_string(),
            format!("{:.3} to {:.3}", 1e3 * value(near), 1e3 * value(far)),
            radius(value(convex), 3),
            radius(value(hollow), 2),
            format!("{:.2}", value(pressure).to_degrees()),
            format!("{:.2}", 1e3 * sliding),
            if broken.is_none() { "none" } else { "yes" }.to_string(),
        ]);
    }
    let text = "Closed forms from the lift law to both pitch curves and contours; derivatives are exact. A hollow flank needs a smaller grinding wheel than its R.";
    let section = Section {
        title: "Synthesis of both cams".to_string(),
        text: vec![text.to_string() + &undercut],
        tables: vec![table],
        pictures: [moving::kinematic(chain)?, pictures::law(chain)]
            .into_iter()
            .chain(pictures::cams(chain))
            .collect(),
    };
    Ok((section, undercut))
}

/// Curves of permanent contact: the motion against the law, and the distance of the rockers in closed form and on the tables `of`.
fn permanent(chain: &Chain, exact: &[Curve; 2], of: &str) -> Result<Vec<Picture>, StudyError> {
    let places = |curves: &[Curve; 2]| Permanent::of(&chain.design, curves, 720, OFFSET).map_err(failed);
    let (closed, tabled) = (places(exact)?, format!("of {of}"));
    let mut drawn = Vec::new();
    let on_tables = if chain.values.get("points") > 0.0 {
        let own = places(&chain.curves)?;
        drawn.extend(pictures::permanent(chain, &tabled, &own));
        own
    } else {
        drawn.extend(pictures::permanent(chain, "in closed form", &closed));
        places(&tables(exact, SHOWN)?)?
    };
    drawn.push(pictures::distance("in closed form", &closed));
    drawn.push(pictures::distance(&tabled, &on_tables));
    Ok(drawn)
}

/// Permanent contact against the law, with tables of the cams and with noise in a table of the lift.
pub fn kinematics(chain: &Chain) -> Result<Section, StudyError> {
    let mut table = Table::new([
        "pitch curves",
        "lift (m)",
        "velocity (m/rad)",
        "acceleration (m/rad²)",
        "rockers' distance, peak to peak (m)",
    ]);
    let exact = chain.design.curves().map_err(failed)?;
    let mut row = |name: String, curves: &[Curve; 2]| -> Result<(), StudyError> {
        let found =
            against_law(&chain.design, curves, OFFSET).map_err(failed)?.map(|error| format!("{error:.1e}"));
        let [lift, velocity, acceleration, apart] = found;
        table.push([name, lift, velocity, acceleration, apart]);
        Ok(())
    };
    row("closed form".to_string(), &exact)?;
    for points in [90, 180, 360, 720, 1440] {
        row(format!("quintic spline, {points} points"), &tables(&exact, points)?)?;
    }
    let mut misfits = Table::new([
        "pitch curves",
        "position (m)",
        "rate (m/rad)",
        "acceleration (m/rad²)",
        "acceleration at speed (m/s²)",
    ]);
    let speed = chain.values.get("speed");
    let mut held = |name: String, curves: &[Curve; 2]| -> Result<Misfit, StudyError> {
        let misfit = Misfit::of(&chain.design, curves, 1440, OFFSET).map_err(failed)?;
        let [position, rate, acceleration] = misfit.largest();
        let at_speed = acceleration * speed * speed;
        let [position, rate, acceleration] =
            [position, rate, acceleration].map(|figure| format!("{figure:.1e}"));
        // A reader compares it with that of the law.
        let at_speed = if at_speed < 1e-3 { format!("{at_speed:.1e}") } else { format!("{at_speed:.3}") };
        misfits.push([name, position, rate, acceleration, at_speed]);
        Ok(misfit)
    };
    held("closed form".to_string(), &exact)?;
    let mut shown = None;
    for points in [90, SHOWN, 720] {
        let misfit = held(format!("quintic spline, {points} points"), &tables(&exact, points)?)?;
        shown = if points == SHOWN { Some(misfit) } else { shown };
    }
    let own = format!("the {} points of this study", chain.values.get("points"));
    let (of, shown) = match chain.values.get("points") > 0.0 {
        true => (own.clone(), Some(held(own, &chain.curves)?)),
        false => (format!("{SHOWN} points"), shown),
    };
    let mut noisy = Table::new([
        "points a turn",
        "noise of the acceleration (mm/rad²)",
        "√3 q N²/4π²",
        "least-squares fit, 60 knots",
    ]);
    let study = noise::study(&chain.design.law, 1e-6).map_err(failed)?;
    for one in &study.rows {
        let fitted = one.fitted[2].map_or("-".to_string(), |error| format!("{:.4}", 1e3 * error));
        noisy.push([
            one.points.to_string(),
            format!("{:.4}", 1e3 * one.through),
            format!("{:.4}", 1e3 * one.expected),
            fitted,
        ]);
    }
    let mut drawn = permanent(chain, &exact, &of)?;
    drawn.extend(shown.map_or_else(Vec::new, |misfit| pictures::misfits(&of, &misfit)));
    Ok(Section {
        title: "Kinematic check".to_string(),
        text: vec![
            "No play, permanent contact: largest differences from the law over a turn, with the pitch curves in closed form and as tables.".to_string(),
            "Second table: the fork held on the valve by one row more than there are coordinates. That row yields, the others are closed; its largest mismatch over a turn is what both cams contradict each other by.".to_string(),
            "Third table: uniform noise of 1 µm in a table of the lift. More points make a spline through all of them worse; fewer knots keep the noise out.".to_string(),
        ],
        tables: vec![table, misfits, noisy],
        pictures: drawn,
    })
}

fn row(name: String, turn: &Turn) -> [String; 9] {
    let force = |force: usize| figure(turn.peak(force), 0);
    let torque = turn.torque.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    [
        name,
        figure(1e-3 * turn.hardest(), 1),
        force(0),
        force(1),
        force(2),
        force(3),
        force(4),
        figure(torque, 1),
        format!("{:.1}", 100.0 * turn.in_flight()),
    ]
}

fn peaks(first: &str) -> Table {
    let [opener, tip, seat, closer, fork] = FORCES.map(|name| format!("{name} (N)"));
    Table::new([
        first,
        "valve (km/s²)",
        &opener,
        &tip,
        &seat,
        &closer,
        &fork,
        "torque (N·m)",
        "in flight (%)",
    ])
}

/// Rigid dynamics at a speed, without and with play; the second part is the result in a sentence.
pub fn dynamics(chain: &Chain, speed: f64) -> Result<(Section, String), StudyError> {
    let [tight, loose] = [false, true].map(|has_play| chain.turn(&case(speed, has_play)));
    let (tight, loose) = (tight?, loose?);
    let law = chain.design.law.range(2).map(f64::abs).into_iter().fold(0.0, f64::max) * speed * speed;
    let mut table = peaks("last turn, largest values");
    table.push(row("no play".to_string(), &tight));
    table.push(row("with play".to_string(), &loose));
    let said = format!(
        "At {:.0} 1/min the law asks for {} km/s²; the valve has {} km/s² without play and {} km/s² with it, and the opener's cam bears {} N and {} N.",
        revolutions(speed),
        figure(1e-3 * law, 1),
        figure(1e-3 * tight.hardest(), 1),
        figure(1e-3 * loose.hardest(), 1),
        figure(tight.peak(0), 0),
        figure(loose.peak(0), 0),
    );
    let balance = format!(
        "Work of the cams since the start: {:.4} J without play, {:.4} J with it; energy, contacts and guide account for it to {:.0e} and {:.0e} of the work.",
        tight.work, loose.work, tight.defect, loose.defect
    );
    let section = Section {
        title: format!("Rigid dynamics at {:.0} 1/min", revolutions(speed)),
        text: vec![said.clone(), balance, LARGEST.to_string()],
        tables: vec![table],
        pictures: vec![
            pictures::accelerations(chain, speed, &tight, &loose),
            pictures::torques(&tight, &loose),
            pictures::forces("Contact forces without play", &tight),
            pictures::forces("Contact forces with play", &loose),
            pictures::contacts("Closed contacts without play", &tight),
            pictures::contacts("Closed contacts with play", &loose),
            moving::with_forces(chain, "Without play", &tight)?,
            moving::with_forces(chain, "With play", &loose)?,
        ],
    };
    Ok((section, said))
}

/// A valve spring in place of the closing cam, at both speeds.
pub fn spring(chain: &Chain) -> Result<Section, StudyError> {
    let mut table = Table::new([
        "last turn, largest values",
        "valve (km/s²)",
        "opener on its cam (N)",
        "opener on the valve (N)",
        "seat (N)",
        "off the law (mm)",
        "off the opener (%)",
    ]);
    let mut turns = Vec::new();
    for name in ["slow", "speed"] {
        let speed = chain.values.get(name);
        let valvetrain: Ordinary = chain.ordinary(&case(speed, true));
        let turn = Turn::of_spring(&valvetrain, chain.turns(), super::SAMPLES, TOLERANCE).map_err(failed)?;
        let law: Vec<f64> =
            turn.angle.iter().map(|angle| chain.design.law.jet::<f64>(angle.to_radians())[0]).collect();
        let off =
            turn.lift().iter().zip(&law).fold(0.0, |most: f64, (lift, law)| most.max((lift - law).abs()));
        let is_open = |k: &usize| turn.lift()[*k] > 5e-4;
        let flies = |k: &usize| !turn.closed[0][*k] || !turn.closed[1][*k];
        let open = (0..law.len()).filter(is_open).count();
        let flying = (0..law.len()).filter(is_open).filter(flies).count();
        table.push([
            format!("{:.0} 1/min", revolutions(speed)),
            figure(1e-3 * turn.hardest(), 1),
            figure(turn.peak(0), 0),
            figure(turn.peak(1), 0),
            figure(turn.peak(2), 0),
            figure(1e3 * off, 3),
            format!("{:.1}", 100.0 * flying as f64 / open.max(1) as f64),
        ]);
        turns.push((format!("{:.0} 1/min", revolutions(speed)), turn));
    }
    let picture = pictures::lifts(chain, &turns);
    Ok(Section {
        title: "Ordinary valvetrain with a spring".to_string(),
        text: vec!["The same text without the closing cam: a valve spring, of the parameters spring and spring_preload, keeps the valve on the opener. Where the law asks for more deceleration than the spring gives, the valve leaves its law. Off the opener: part of the time with a lift above 0.5 mm in which the opener does not touch its cam or the valve.".to_string()],
        tables: vec![table],
        pictures: vec![picture],
    })
}

/// Stiffness, damping, play and points of tables.
pub fn sensitivity(chain: &Chain) -> Result<Section, StudyError> {
    let speed = chain.values.get("speed");
    let base = case(speed, true);
    let mut table = peaks("change");
    let variants = [
        ("none", [1.0, 1.0, 1.0]),
        ("K/2", [0.5, 1.0, 1.0]),
        ("2 K", [2.0, 1.0, 1.0]),
        ("D/2", [1.0, 0.5, 1.0]),
        ("2 D", [1.0, 2.0, 1.0]),
        ("play/2", [1.0, 1.0, 0.5]),
        ("2 play", [1.0, 1.0, 2.0]),
    ];
    for (name, factors) in variants {
        table.push(row(name.to_string(), &chain.turn(&Case { factors, ..base })?));
    }
    let exact = chain.design.curves().map_err(failed)?;
    for points in [180, 720] {
        let turn = chain.turn_on(&tables(&exact, points)?, &base)?;
        table.push(row(format!("cams of {points} points"), &turn));
    }
    Ok(Section {
        title: format!("Sensitivity at {:.0} 1/min with play", revolutions(speed)),
        text: vec!["One number changed at a time. Impacts follow each other, so a small change shifts later ones: see the envelope before a difference is read as a trend.".to_string()],
        tables: vec![table],
        pictures: Vec::new(),
    })
}

/// Number in [0, 1) of a sequence that fills the cube evenly. Source: Roberts 2018, the R3 sequence.
fn spread(run: u32, axis: i32) -> f64 {
    const GOLDEN: f64 = 1.220_744_084_605_759_6;
    (0.5 + f64::from(run) * GOLDEN.powi(-axis)).fract()
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|share| quantile(&values, share))
}

/// Median and 5 to 95 % of perturbed runs.
pub fn envelope(chain: &Chain) -> Result<Section, StudyError> {
    let (speed, width) = (chain.values.get("speed"), chain.values.get("spread"));
    let runs = chain.values.get("runs") as u32;
    let mut turns = Vec::new();
    for run in 0..runs.max(1) {
        let factors = [1, 2, 3].map(|axis| 1.0 + width * (2.0 * spread(run, axis) - 1.0));
        turns.push(chain.turn(&Case { factors, tolerance: 1e-9, ..case(speed, true) })?);
    }
    let angle = turns[0].angle.clone();
    let at = |k: usize| quantiles(turns.iter().map(|turn| turn.acceleration[k]).collect());
    let found: Vec<[f64; 3]> = (0..angle.len()).map(at).collect();
    let mut table = Table::new(["largest value of a turn", "5 %", "median", "95 %", "95 % over 5 %"]);
    let mut line = |name: String, values: Vec<f64>| {
        let [low, median, high] = quantiles(values);
        table.push([name, figure(low, 1), figure(median, 1), figure(high, 1), format!("{:.2}", high / low)]);
    };
    line("valve (km/s²)".to_string(), turns.iter().map(|turn| 1e-3 * turn.hardest()).collect());
    for (force, name) in FORCES.iter().enumerate() {
        line(format!("{name} (N)"), turns.iter().map(|turn| turn.peak(force)).collect());
    }
    Ok(Section {
        title: format!("Envelope of {} runs at {:.0} 1/min", turns.len(), revolutions(speed)),
        text: vec![format!(
            "K, D and both clearances vary by ±{:.0} %, evenly spread. Peaks of a motion full of impacts are a distribution.",
            100.0 * width
        )],
        tables: vec![table],
        pictures: vec![pictures::envelope(&angle, &found)],
    })
}

/// Errors of the lift and time over the tolerance, without play.
pub fn accuracy(chain: &Chain) -> Result<Section, StudyError> {
    let speed = chain.values.get("speed");
    let turn = |tolerance: f64| {
        let valvetrain = chain.valvetrain(&chain.curves, &Case { tolerance, ..case(speed, false) });
        Turn::of(&valvetrain, 1, 720, tolerance).map_err(failed)
    };
    let exact = turn(1e-12)?;
    let mut table = Table::new([
        "tolerance",
        "right-hand sides",
        "time (ms)",
        "error of the lift (m)",
        "energy unaccounted for",
    ]);
    let mut points = Vec::new();
    for tolerance in [1e-6, 1e-7, 1e-8, 1e-9, TOLERANCE, 1e-11] {
        let found = turn(tolerance)?;
        let error =
            found.lift().iter().zip(exact.lift()).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        points.push([found.evaluations as f64, error.max(1e-18)]);
        table.push([
            format!("{tolerance:.0e}"),
            found.evaluations.to_string(),
            format!("{:.1}", 1e3 * found.time.as_secs_f64()),
            format!("{error:.1e}"),
            format!("{:.1e}", found.defect),
        ]);
    }
    Ok(Section {
        title: format!("Cost of accuracy at {:.0} 1/min", revolutions(speed)),
        text: vec!["The first turn without play by Dormand and Prince's method of order 8, against a tolerance of 1e-12. Times contain 720 instants that are shown.".to_string()],
        tables: vec![table],
        pictures: vec![pictures::costs(&points)],
    })
}
