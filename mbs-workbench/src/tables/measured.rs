//! Measured quantities over the time: a column of times, one of values, and their rates where the file has them.

use core::f64::consts::{PI, TAU};

use mbs_codegen::{Quantity, quantity};
use mbs_runtime::driver::End;

use super::Unit;
use super::reader::{Head, ReadFault, read_columns};
use super::spline::{Spline, SplineKind};
use crate::motion::course::Course;

/// Rows that an interpolation needs at least: a cubic spline with parabolas at its ends.
const LEAST: usize = 4;

/// A quantity over the time, in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Times (s), increasing.
    pub time: Vec<f64>,
    /// Values.
    pub value: Vec<f64>,
    /// Rates (1/s), where the file has them.
    rate: Option<Vec<f64>>,
    /// Accelerations (1/s²), where the file has them beside rates.
    acceleration: Option<Vec<f64>>,
    /// Line of each row in the file.
    pub lines: Vec<usize>,
    /// Jumps by a turn that were taken out of the values.
    pub wraps: usize,
}

impl Measured {
    /// Reads the quantity `name`, which is in `unit`, from a file with a header as `t (s), theta (deg)`.
    ///
    /// The times are in the column called `t` or `time`, else in the first one in a unit of time. The values are in the column called
    /// `name`, else in the one that is left beside times and rates. Rates and accelerations are in columns called as the values with
    /// `_d` and `_dd` behind, as in tables of `mbs`. Else they are in those with the units of rates.
    ///
    /// Angles within one turn that jump by more than half a turn are those of an encoder. Whole turns are added, so that they go on.
    ///
    /// # Errors
    /// The first fault.
    pub fn read(bytes: &[u8], name: &str, unit: &str) -> Result<Self, ReadFault> {
        let mut has_rates = [false; 2];
        let table = read_columns(bytes, |head| {
            let (columns, found) = columns(head, name, unit)?;
            has_rates = found;
            Ok(columns)
        })?;
        let mut values = table.values.into_iter();
        let mut next = |is_there: bool| if is_there { values.next() } else { None };
        let (time, mut value) = (next(true).unwrap_or_default(), next(true).unwrap_or_default());
        let (rate, acceleration) = (next(has_rates[0]), next(has_rates[1]));
        let wraps = if matches!(unit, "rad" | "deg" | "turn") { unwrapped(&mut value) } else { 0 };
        Ok(Measured { time, value, rate, acceleration, lines: table.lines, wraps })
    }

    /// A smooth course through all points.
    ///
    /// Without rates it is the cubic spline through the values whose ends are parabolas, rate and acceleration its derivatives. With rates
    /// values and rates are met, accelerations are those of the spline through the rates, or those of the file. Between the points there
    /// are polynomials of degree 5 ([`Course`]).
    ///
    /// # Errors
    /// Too few rows.
    pub fn course(&self) -> Result<Course, ReadFault> {
        let fault = |message: String| {
            ReadFault::new(
                0,
                0,
                message,
                &format!("measure {LEAST} points at least, more where the motion bends"),
            )
        };
        if self.time.len() < LEAST {
            return Err(fault(format!("the file has {} rows alone", self.time.len())));
        }
        let spline = |values: &[f64]| {
            Spline::fit(&self.time, values, SplineKind::Cubic([End::Parabolic; 2]), None)
                .map_err(|error| fault(format!("no spline goes through the points: {error:?}")))
        };
        let fitted = spline(self.rate.as_ref().unwrap_or(&self.value))?;
        let jet = |(k, t): (usize, &f64)| {
            let [value, first, second, _] = fitted.derivatives(*t);
            match (&self.rate, &self.acceleration) {
                (None, _) => [value, first, second],
                (Some(rate), None) => [self.value[k], rate[k], first],
                (Some(rate), Some(acceleration)) => [self.value[k], rate[k], acceleration[k]],
            }
        };
        let jets = self.time.iter().enumerate().map(jet).collect();
        Course::new(self.time.clone(), jets).ok_or_else(|| fault("the times do not increase".to_string()))
    }
}

/// Adds whole turns to angles (rad) that stay within one turn and jump by more than half of one. Number of jumps.
fn unwrapped(angles: &mut [f64]) -> usize {
    let least = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let most = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most - least > TAU * (1.0 + 1e-9) {
        return 0;
    }
    let (mut turns, mut jumps, mut before) = (0.0, 0, None);
    for angle in angles {
        let change = *angle - before.unwrap_or(*angle);
        before = Some(*angle);
        if change.abs() > PI {
            turns -= change.signum();
            jumps += 1;
        }
        *angle += TAU * turns;
    }
    jumps
}

/// `true` where a column in `unit` has quantities in `declared`, over a power of seconds.
fn fits(unit: &Unit, declared: &str, seconds: usize) -> bool {
    let per = ["", "/s", "/s^2"][seconds];
    let found: Option<Quantity> = quantity(&format!("1 [{}]", unit.coherent)).ok();
    found.is_some_and(|found| found.fits(&format!("{declared}{per}")))
}

/// Columns with their indices and units, and `true` where those of rates and accelerations are among them.
type Chosen = (Vec<(usize, Unit)>, [bool; 2]);

/// Columns of times, values, rates and accelerations.
fn columns(head: &Head, name: &str, unit: &str) -> Result<Chosen, ReadFault> {
    let fault = |message: String, cure: &str| ReadFault::new(head.line, 0, message, cure);
    let header = format!("write a header with units: `t (s), {name} ({unit})`");
    if !head.is_header {
        return Err(fault("the first line is no header".to_string(), &header));
    }
    let known = head.with_units();
    let called = |names: &[&str]| known.iter().find(|(_, column, _)| names.contains(&column.as_str()));
    let time = called(&["t", "time"]).or_else(|| known.iter().find(|(.., unit)| fits(unit, "s", 0)));
    let Some(time) = time.filter(|(.., unit)| fits(unit, "s", 0)) else {
        return Err(fault("no column has times with their unit".to_string(), &header));
    };
    let others: Vec<_> = known.iter().filter(|(index, ..)| *index != time.0).collect();
    let of_values: Vec<_> = others.iter().filter(|(.., found)| fits(found, unit, 0)).collect();
    let value = match others.iter().find(|(_, column, _)| column == name) {
        Some(value) if fits(&value.2, unit, 0) => *value,
        Some((index, column, found)) => {
            let message = format!("`{column}` is in `{}`, `{name}` in `{unit}`", found.name);
            return Err(ReadFault::new(
                head.line,
                index + 1,
                message,
                "correct the unit, or name another column",
            ));
        }
        None => match of_values.as_slice() {
            [only] => **only,
            [] => return Err(fault(format!("no column is in `{unit}`, as `{name}` is"), &header)),
            several => {
                let names: Vec<&str> = several.iter().map(|(_, column, _)| column.as_str()).collect();
                let message = format!("several columns are in `{unit}`: {}", names.join(", "));
                return Err(fault(message, &format!("call the one that is meant `{name} ({unit})`")));
            }
        },
    };
    let derivative = |order: usize| {
        let named = format!("{}{}", value.1, ["", "_d", "_dd"][order]);
        let fitting = |column: &&&(usize, String, Unit)| column.0 != value.0 && fits(&column.2, unit, order);
        let by_name = others.iter().filter(fitting).find(|column| column.1 == named);
        let mut by_unit = others.iter().filter(fitting);
        let only = by_unit.next().filter(|_| by_unit.next().is_none());
        by_name.or(only)
    };
    let rate = derivative(1);
    let acceleration = rate.and(derivative(2));
    let chosen = [Some(time), Some(value), rate.copied(), acceleration.copied()];
    let columns = chosen.into_iter().flatten().map(|(index, _, unit)| (*index, unit.clone())).collect();
    Ok((columns, [rate.is_some(), acceleration.is_some()]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Measured {
        Measured::read(text.as_bytes(), "theta", "rad").expect(text)
    }

    fn fault(text: &str) -> ReadFault {
        Measured::read(text.as_bytes(), "theta", "rad").and_then(|read| read.course()).expect_err(text)
    }

    #[test]
    fn columns_are_found_by_names_and_by_units() {
        let degree = core::f64::consts::PI / 180.0;
        for text in [
            "t (s),theta (deg)\n0,1\n1,2\n",
            "angle [deg];time [ms]\n1;0\n2;1000\n",
            "run,t (s),phi (rad),theta (deg)\na,0,9,1\nb,1,9,2\n",
            "t (s),load (N),theta (deg)\n0,7,1\n1,7,2\n",
        ] {
            let found = read(text);
            assert_eq!((found.time.as_slice(), found.rate), (&[0.0, 1.0][..], None), "{text}");
            assert!((found.value[1] / degree - 2.0).abs() < 1e-14);
        }
        let found = read("t (s),theta (rad),theta_d (rpm),theta_dd (rad/s^2)\n0,1,30,5\n1,2,60,6\n");
        assert!((found.rate.expect("rates")[0] - core::f64::consts::PI).abs() < 1e-14);
        assert_eq!(found.acceleration, Some(vec![5.0, 6.0]));
        let found = read("t (s),angle (deg),speed (deg/s)\n0,1,180\n1,2,90\n");
        assert!((found.rate.expect("rates")[0] - core::f64::consts::PI).abs() < 1e-14);
    }

    #[test]
    fn an_encoder_goes_on_where_it_wraps() {
        for (start, speed) in [(0.1, 0.9), (-3.0, -2.9), (6.2, 3.0)] {
            let angle = |k: i32| start + speed * f64::from(k);
            for low in [0.0, -PI] {
                let line = |k: i32| format!("{k},{}\n", (angle(k) - low).rem_euclid(TAU) + low);
                let found = read(&format!("t (s),theta (rad)\n{}", (0..50).map(line).collect::<String>()));
                let offset = found.value[0] - angle(0);
                for (k, value) in (0..50).zip(&found.value) {
                    assert!((value - offset - angle(k)).abs() < 1e-12, "{start} {speed} {low}: {k}");
                }
                let turns = found.wraps as f64 * TAU;
                assert!((turns - (angle(49) - angle(0)).abs()).abs() < TAU, "{turns}");
            }
        }
        // Numbers that go on, and quantities that are no angles, are taken as they are.
        let found = read("t (s),theta (deg)\n0,0\n1,200\n2,400\n3,600\n");
        assert_eq!((found.wraps, found.value[3] > 10.0), (0, true));
        let found = Measured::read(b"t (s),x (m)\n0,0\n1,5\n2,1\n3,0\n", "x", "m").expect("lengths");
        assert_eq!((found.wraps, found.value), (0, vec![0.0, 5.0, 1.0, 0.0]));
    }

    #[test]
    fn a_sine_comes_back_with_its_rates() {
        let time: Vec<f64> = (0..=40).map(|k| 0.05 * f64::from(k)).collect();
        let line = |t: &f64| format!("{t},{},{},{}\n", t.sin(), t.cos(), -t.sin());
        let text = time.iter().map(line).collect::<String>();
        let all = read(&format!("t (s),theta (rad),theta_d (rad/s),theta_dd (rad/s^2)\n{text}"));
        let without = Measured { acceleration: None, ..all.clone() };
        let values = Measured { rate: None, acceleration: None, ..all.clone() };
        // Orders of the interpolations: 4, 3, 2 of the spline; one more with rates; those of degree 5.
        for (measured, bounds) in
            [(values, [2e-6, 1e-4, 1e-2]), (without, [2e-9, 2e-7, 1e-4]), (all, [1e-11, 1e-9, 1e-7])]
        {
            let course = measured.course().expect("a course");
            for k in 0..=200 {
                let t = 0.5 + 0.005 * f64::from(k);
                let exact = [t.sin(), t.cos(), -t.sin()];
                for ((found, exact), bound) in course.at(t).into_iter().zip(exact).zip(bounds) {
                    assert!((found - exact).abs() < bound, "{t}: {found} {exact}");
                }
            }
        }
    }

    #[test]
    fn faults_name_line_and_column_and_a_cure() {
        for (text, place, words) in [
            ("0,1\n1,2\n", (1, 0), "t (s), theta (rad)"),
            ("t,theta\n0,1\n", (1, 0), "t (s), theta (rad)"),
            ("t (s),theta (mm)\n0,1\n", (1, 2), "`theta` is in `mm`"),
            ("t (s),x (mm)\n0,1\n", (1, 0), "no column is in `rad`"),
            ("t (s),a (deg),b (deg)\n0,1,2\n", (1, 0), "several columns are in `rad`: a, b"),
            ("t (s),theta (deg)\n0,1\n0,2\n", (3, 1), "not above the line before"),
            ("t (s),theta (deg)\n0,1\n1,NaN\n", (3, 2), "not a finite number"),
            ("t (s),theta (deg)\n0,1\n1,\n", (3, 2), "empty"),
            ("t (s),theta (deg)\n0,1\n1,2\n2,3\n", (0, 0), "3 rows alone"),
        ] {
            let found = fault(text);
            assert_eq!((found.line, found.column), place, "{text}: {found}");
            assert!(found.to_string().contains(words), "{text}: {found}");
        }
    }
}
