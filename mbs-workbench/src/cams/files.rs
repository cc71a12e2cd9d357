//! Profiles as files: CSV, DXF, a spline as a Rust constant.

use core::f64::consts::TAU;
use core::fmt::Write;

use super::follower::{Cam, Follower, Place};
use crate::output::svg::{COLOURS, label, open};
use crate::tables::{Columns, Points, Spline, SplineKind, constant};

/// Cam angles (rad) with their places.
pub type Places = [(f64, Place<f64>)];

/// Places of one turn at equal cam angles, from its beginning on.
pub fn turn(cam: &Cam, count: usize) -> Vec<(f64, Place<f64>)> {
    let place = |k: usize| cam.lift.origin() + TAU * k as f64 / count as f64;
    (0..count).map(|k| (place(k), cam.place(place(k)))).collect()
}

/// One line a place: cam angle, lift with derivatives, contour, pitch curve, radii, pressure angle, sliding, polar angle and radius of
/// the pitch curve; the angle of a rocker from its place at lift 0. A flat face has its contour for a pitch curve.
pub fn csv(places: &Places, follower: &Follower) -> String {
    let unit = if follower.lifts_by_angle() { "rad" } else { "m" };
    let is_rocker = matches!(follower, Follower::Rocker { .. });
    let mut text = format!(
        "theta (rad),lift ({unit}),velocity ({unit}/rad),acceleration ({unit}/rad^2),jerk ({unit}/rad^3),contour x (m),contour y (m),\
         pitch x (m),pitch y (m),polar radius (m),polar angle (rad),d2r (m/rad^2),radius of curvature (m),pressure angle (rad),\
         sliding (m/rad),pitch angle (rad),pitch radius (m){}\n",
        if is_rocker { ",rocker (rad)" } else { "" }
    );
    for (theta, p) in places {
        let pitch = [p.pitch[1].atan2(p.pitch[0]), p.pitch[0].hypot(p.pitch[1])];
        let more = [p.radius, p.pressure, p.sliding];
        let numbers = [&[*theta][..], &p.lift, &p.contour, &p.pitch, &p.polar, &more, &pitch];
        let rocker = is_rocker.then_some(p.angle[0]);
        let cells: Vec<String> = numbers.concat().iter().chain(&rocker).map(|x| format!("{x:?}")).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// The contour as a closed polyline of DXF R12, in millimetres.
///
/// Source: Autodesk, DXF Reference, release 12 (entities POLYLINE, VERTEX, SEQEND).
pub fn dxf(places: &Places) -> String {
    let mut text =
        String::from("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    text += "0\nPOLYLINE\n8\nCAM\n66\n1\n70\n1\n10\n0.0\n20\n0.0\n30\n0.0\n";
    for (_, place) in places {
        let [x, y] = place.contour.map(|x| 1e3 * x);
        let _ = write!(text, "0\nVERTEX\n8\nCAM\n10\n{x:.9}\n20\n{y:.9}\n30\n0.0\n");
    }
    text + "0\nSEQEND\n8\nCAM\n0\nENDSEC\n0\nEOF\n"
}

/// Contours, each with the radius of its base circle, to scale as a picture, with a scale of ten millimetres.
pub fn svg(contours: &[(&Places, f64)]) -> String {
    const SIDE: f64 = 460.0;
    let radii = contours.iter().flat_map(|(places, base)| {
        places.iter().map(|(_, place)| place.polar[0]).chain(core::iter::once(*base))
    });
    let pixels = 0.45 * SIDE / radii.fold(0.0, f64::max);
    let mut svg = open(SIDE as usize, SIDE as usize);
    let (centre, [blue, orange, third, ..]) = (0.5 * SIDE, COLOURS);
    let see_through = if contours.len() > 1 { " fill-opacity=\"0.6\"" } else { "" };
    for ((places, base), colour) in contours.iter().zip([blue, third]) {
        let mut path = String::new();
        for (k, (_, place)) in places.iter().enumerate() {
            let [x, y] = place.contour.map(|x| pixels * x);
            let pen = if k == 0 { "M" } else { "L" };
            let _ = write!(path, "{pen}{:.2} {:.2}", centre + x, centre - y);
        }
        let _ = writeln!(
            svg,
            "<path d=\"{path}Z\" fill=\"#d8e3ee\"{see_through} stroke=\"{colour}\" stroke-width=\"2\"/>"
        );
        let _ = writeln!(
            svg,
            "<circle cx=\"{centre}\" cy=\"{centre}\" r=\"{:.2}\" fill=\"none\" stroke=\"{orange}\" stroke-dasharray=\"5 4\"/>",
            base * pixels
        );
    }
    let _ = writeln!(svg, "<path d=\"M{0} {centre}h16m-8 -8v16\" stroke=\"black\"/>", centre - 8.0);
    let _ = writeln!(
        svg,
        "<path d=\"M12 {}h{:.2}\" stroke=\"black\" stroke-width=\"3\"/>",
        SIDE - 12.0,
        0.01 * pixels
    );
    label(&mut svg, 12, SIDE as usize - 20, "", "10 mm");
    svg + "</svg>\n"
}

/// The polar radius of the pitch curve, of a flat face that of the contour, as a periodic quintic over the polar angle.
///
/// It goes through `places`; its documentation has its largest error beside them, at four times as many.
///
/// # Errors
/// A message where the curve is not star-shaped about the cam's centre.
pub fn rust(name: &str, source: &str, cam: &Cam, places: &Places) -> Result<String, String> {
    let polar = |p: &Place<f64>| (p.pitch[1].atan2(p.pitch[0]), p.pitch[0].hypot(p.pitch[1]));
    let mut points: Vec<(f64, f64)> = places.iter().map(|(_, p)| polar(p)).collect();
    let step = |pair: &[(f64, f64)]| (pair[1].0 - pair[0].0 + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
    let steps: Vec<f64> = points.windows(2).map(step).collect();
    if !(steps.iter().all(|step| *step > 0.0) || steps.iter().all(|step| *step < 0.0)) {
        return Err(
            "the curve runs back about the cam's centre: it has no polar radius; take the CSV".to_string()
        );
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let spline =
        Spline::fit(&x, &y, SplineKind::PeriodicQuintic(TAU), None).map_err(|error| error.to_string())?;
    let columns = Columns::parse("rad, m")?;
    let names = ["polar angle", "radius of the pitch curve"].map(String::from);
    let lines = (1..=x.len()).collect();
    let beside = turn(cam, 4 * places.len());
    let errors = beside.iter().map(|(_, p)| polar(p)).map(|(w, r)| (spline.derivatives(w)[0] - r).abs());
    let largest = errors.fold(0.0, f64::max);
    Ok(constant::rust(name, source, &Points { columns, names, x, y, lines }, &spline, largest))
}

#[cfg(test)]
mod tests {
    use super::super::follower::Direction;
    use super::super::lift::{Flank, Lift};
    use super::*;

    fn cam() -> Cam {
        let law = Lift::flanks(Flank::Polynomial345, 0.006, [1.2, 0.5, 1.2]).expect("a law");
        let follower = Follower::Roller { base: 0.02, radius: 0.006, offset: 0.0 };
        Cam::new(law, follower, Direction::CounterClockwise).expect("a cam")
    }

    #[test]
    fn files_have_every_point() {
        let places = turn(&cam(), 90);
        let text = csv(&places, &cam().follower);
        assert_eq!(text.lines().count(), 91);
        let columns = text.lines().next().expect("a header").split(',').count();
        assert!(text.lines().all(|line| line.split(',').count() == columns));
        // The polar radius of the pitch curve: the base circle and the roller at lift 0.
        let last = |line: &str| line.rsplit(',').next().and_then(|cell| cell.parse::<f64>().ok());
        let radii: Vec<f64> = text.lines().filter_map(last).collect();
        assert_eq!(radii.len(), 90);
        assert!(
            (radii[0] - 0.026).abs() < 1e-15
                && radii.iter().all(|r| (0.026 - 1e-9..0.032 + 1e-9).contains(r))
        );
        let drawing = dxf(&places);
        assert_eq!(drawing.matches("VERTEX").count(), 90);
        // Pairs of code and value.
        let codes: Vec<&str> = drawing.lines().step_by(2).collect();
        assert!(
            codes.iter().all(|code| code.parse::<u16>().is_ok()) && drawing.lines().count().is_multiple_of(2)
        );
    }

    #[test]
    fn the_constant_is_rust() {
        let code = rust("PITCH", "cam", &cam(), &turn(&cam(), 90)).expect("code");
        assert!(syn::parse_file(&code).is_ok() && code.contains("PeriodicQuintic<90>"), "{code}");
        // Through every point a spline is exact; between them it is not.
        let error = code.split("off by at most ").nth(1).and_then(|rest| rest.split(' ').next());
        let error: f64 = error.and_then(|number| number.parse().ok()).expect("an error");
        assert!((1e-9..1e-6).contains(&error), "{error:e}");
    }
}
