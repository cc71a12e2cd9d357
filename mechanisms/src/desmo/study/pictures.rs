//! Plots of the study.

use mbs_workbench::cams::follower::{Cam, Place};
use mbs_workbench::study::Picture;
use mbs_workbench::study::plot::{Curve as Line, Plot, Timeline};

use super::super::motion::{FORCES, Misfit, Permanent, Turn};
use super::Chain;

const ANGLE: &str = "cam angle (deg)";

/// Lift with its derivatives over the cam angle, each over its largest magnitude.
pub fn law(chain: &Chain) -> Picture {
    let angles: Vec<f64> = (0..=720).map(|k| f64::from(k) / 2.0 - 180.0).collect();
    let jets: Vec<[f64; 4]> = angles.iter().map(|angle| chain.design.law.jet(angle.to_radians())).collect();
    let curve = |order: usize, name: &str, unit: &str| {
        let most = jets.iter().fold(0.0, |most: f64, jet| most.max(jet[order].abs()));
        let values: Vec<f64> = jets.iter().map(|jet| jet[order] / most).collect();
        Line::new(&format!("{name}, 1 is {:.4} {unit}", 1e3 * most), &angles, &values)
    };
    let plot = Plot {
        caption: "Lift law".to_string(),
        x: ANGLE.to_string(),
        y: "over the largest magnitude".to_string(),
        curves: vec![curve(0, "s", "mm"), curve(1, "s'", "mm/rad"), curve(2, "s''", "mm/rad²")],
        ..Plot::default()
    };
    plot.picture()
}

/// A quantity of both cams over the cam angle.
fn of_cams(chain: &Chain, caption: &str, y: &str, of: impl Fn(&Place<f64>) -> f64) -> Picture {
    let angles: Vec<f64> = (0..=720).map(|k| f64::from(k) / 2.0 - 180.0).collect();
    let curve = |(name, cam): (&str, &Cam)| {
        let values: Vec<f64> = angles.iter().map(|angle| of(&cam.place(angle.to_radians()))).collect();
        Line::new(name, &angles, &values)
    };
    let plot = Plot {
        caption: caption.to_string(),
        x: ANGLE.to_string(),
        y: y.to_string(),
        curves: ["opening cam", "closing cam"].into_iter().zip(&chain.cams).map(curve).collect(),
        ..Plot::default()
    };
    plot.picture()
}

/// Curvature of the contour, pressure angle and sliding of both cams over the cam angle.
pub fn cams(chain: &Chain) -> Vec<Picture> {
    vec![
        of_cams(
            chain,
            "Curvature of the contours, below 0 where they are hollow",
            "curvature (1/mm)",
            |place| 1e-3 / place.radius,
        ),
        of_cams(chain, "Pressure angle", "pressure angle (deg)", |place| place.pressure.to_degrees()),
        of_cams(chain, "Sliding velocity", "sliding (mm/rad)", |place| 1e3 * place.sliding),
    ]
}

/// Lift, velocity and acceleration of permanent contact over those of the law; `of` says which pitch curves.
pub fn permanent(chain: &Chain, of: &str, found: &Permanent) -> Vec<Picture> {
    let law = found.law(&chain.design.law);
    let scaled = |values: &[f64]| values.iter().map(|value| 1e3 * value).collect::<Vec<_>>();
    let picture = |(order, (name, unit)): (usize, (&str, &str))| {
        let plot = Plot {
            caption: format!("{name} of the valve against the law, pitch curves {of}"),
            x: ANGLE.to_string(),
            y: format!("{} ({unit})", name.to_lowercase()),
            curves: vec![
                Line::new("valve", &found.angle, &scaled(&found.columns[order])),
                Line::new("law", &found.angle, &scaled(&law[order])).dashed(),
            ],
            ..Plot::default()
        };
        plot.picture()
    };
    let orders = [("Lift", "mm"), ("Velocity", "mm/rad"), ("Acceleration", "mm/rad²")];
    orders.into_iter().enumerate().map(picture).collect()
}

/// Distance of both rockers at the valve over the cam angle; `of` says which pitch curves.
pub fn distance(of: &str, found: &Permanent) -> Picture {
    let largest = found.apart.iter().fold(0.0, |most: f64, apart| most.max(apart.abs()));
    // A power of ten in the unit: the numbers of the axis are short.
    let power = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
    let values: Vec<f64> = found.apart.iter().map(|apart| apart * 10.0_f64.powi(-power)).collect();
    let plot = Plot {
        caption: format!("Distance of the rockers, pitch curves {of}"),
        x: ANGLE.to_string(),
        y: format!("distance (1e{power} m)"),
        curves: vec![Line::new("fork from the opener's place of the valve", &found.angle, &values)],
        ..Plot::default()
    };
    plot.picture()
}

/// Mismatch of the row that yields, over the cam angle: position, rate and acceleration; `of` says which tables.
pub fn misfits(of: &str, misfit: &Misfit) -> Vec<Picture> {
    let largest = misfit.largest();
    let picture = |(order, (name, unit)): (usize, (&str, &str))| {
        let plot = Plot {
            caption: format!("Mismatch of the fork's row, {name}, pitch curves of {of}"),
            x: ANGLE.to_string(),
            y: format!("over its largest value, {:.2e} {unit}", largest[order]),
            curves: vec![Line::new(
                name,
                &misfit.angle,
                &misfit.columns[order]
                    .iter()
                    .map(|value| value / largest[order].max(f64::MIN_POSITIVE))
                    .collect::<Vec<_>>(),
            )],
            ..Plot::default()
        };
        plot.picture()
    };
    let orders = [("position", "m"), ("rate", "m/rad"), ("acceleration", "m/rad²")];
    orders.into_iter().enumerate().map(picture).collect()
}

/// Acceleration of the valve with and without play over that of the law.
pub fn accelerations(chain: &Chain, speed: f64, tight: &Turn, loose: &Turn) -> Picture {
    let law = |angle: &f64| chain.design.law.jet::<f64>(angle.to_radians())[2] * speed * speed * 1e-3;
    let scaled = |turn: &Turn| turn.acceleration.iter().map(|a| 1e-3 * a).collect::<Vec<_>>();
    let plot = Plot {
        caption: "Acceleration of the valve".to_string(),
        x: ANGLE.to_string(),
        y: "acceleration (km/s²)".to_string(),
        curves: vec![
            Line::new("with play", &loose.angle, &scaled(loose)),
            Line::new("no play", &tight.angle, &scaled(tight)),
            Line::new("law", &loose.angle, &loose.angle.iter().map(law).collect::<Vec<_>>()).dashed(),
        ],
        marks: Some(("with play the valve touches nothing".to_string(), loose.flights())),
        ..Plot::default()
    };
    plot.picture()
}

/// Contact forces of a turn, and where the valve flies.
pub fn forces(caption: &str, turn: &Turn) -> Picture {
    let curve = |force: usize| {
        let values: Vec<f64> = turn.forces[force].iter().map(|value| 1e-3 * value).collect();
        Line::new(FORCES[force], &turn.angle, &values)
    };
    let plot = Plot {
        caption: caption.to_string(),
        x: ANGLE.to_string(),
        y: "contact force (kN)".to_string(),
        curves: [0, 3, 2].map(curve).to_vec(),
        marks: Some(("valve touches nothing".to_string(), turn.flights())),
        ..Plot::default()
    };
    plot.picture()
}

/// Contacts over the cam angle: closed where there is a bar.
pub fn contacts(caption: &str, turn: &Turn) -> Picture {
    let row = |force: usize| (FORCES[force].to_string(), turn.touches(force));
    let mut rows = [0, 1, 2, 3, 4].map(row).to_vec();
    rows.push(("valve touches nothing".to_string(), turn.flights()));
    let ends = [-180.0, 180.0];
    Timeline { caption: caption.to_string(), x: ANGLE.to_string(), ends, rows }.picture()
}

/// Lift with a valve spring over that of the law.
pub fn lifts(chain: &Chain, turns: &[(String, Turn)]) -> Picture {
    let Some((_, first)) = turns.first() else { return Picture::default() };
    let law: Vec<f64> =
        first.angle.iter().map(|angle| 1e3 * chain.design.law.jet::<f64>(angle.to_radians())[0]).collect();
    let curve = |(name, turn): &(String, Turn)| {
        let lift: Vec<f64> = turn.lift().iter().map(|lift| 1e3 * lift).collect();
        Line::new(name, &turn.angle, &lift)
    };
    let mut curves: Vec<Line> = turns.iter().map(curve).collect();
    curves.push(Line::new("law", &first.angle, &law).dashed());
    let plot = Plot {
        caption: "Lift with a valve spring".to_string(),
        x: ANGLE.to_string(),
        y: "lift (mm)".to_string(),
        curves,
        ..Plot::default()
    };
    plot.picture()
}

/// Torque of the cams.
pub fn torques(tight: &Turn, loose: &Turn) -> Picture {
    let plot = Plot {
        caption: "Torque that the cams need".to_string(),
        x: ANGLE.to_string(),
        y: "torque (N·m)".to_string(),
        curves: vec![
            Line::new("with play", &loose.angle, &loose.torque),
            Line::new("no play", &tight.angle, &tight.torque),
        ],
        ..Plot::default()
    };
    plot.picture()
}

/// Median and range of the acceleration over perturbed runs.
pub fn envelope(angle: &[f64], quantiles: &[[f64; 3]]) -> Picture {
    let band = angle.iter().zip(quantiles).map(|(angle, [low, _, high])| [*angle, 1e-3 * low, 1e-3 * high]);
    let median: Vec<f64> = quantiles.iter().map(|[_, median, _]| 1e-3 * median).collect();
    let plot = Plot {
        caption: "Acceleration of the valve over all perturbed runs".to_string(),
        x: ANGLE.to_string(),
        y: "acceleration (km/s²)".to_string(),
        bands: vec![("5 to 95 % of the runs".to_string(), band.collect())],
        curves: vec![Line::new("median", angle, &median)],
        ..Plot::default()
    };
    plot.picture()
}

/// Errors over evaluations, both in logarithmic scale.
pub fn costs(points: &[[f64; 2]]) -> Picture {
    let [x, y] = [0, 1].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    let plot = Plot {
        caption: "Error of the lift over right-hand sides of a turn".to_string(),
        x: "right-hand sides".to_string(),
        y: "error of the lift (m)".to_string(),
        curves: vec![Line::new("Dormand and Prince, order 8", &x, &y)],
        is_logarithmic: true,
        ..Plot::default()
    };
    plot.picture()
}
