//! K3: `4m^2` was 16 m², `2mm^2` 4e-6 m², silently.

use mbs_codegen::expand_source;
use mbs_runtime::{Stepper, mechanism};

/// The report of a text whose constant has this unit and value.
fn report(unit: &str, value: &str) -> String {
    let text = format!("mechanism M; const k: {unit} = {value}; coord x: 1; drive d: x == k*t/k/1s;");
    expand_source(&text).err().unwrap_or_default()
}

#[test]
fn a_power_of_a_number_with_a_unit_is_refused_with_both_readings() {
    for (unit, value, [of_unit, of_number]) in [
        ("m^2", "4m^2", ["4 [m^2]", "(4m)^2"]),
        ("m^2", "2mm^2", ["2 [mm^2]", "(2mm)^2"]),
        ("m^2", "4m ^ 2", ["4 [m^2]", "(4m)^2"]),
        ("m^2", "1m^2", ["1 [m^2]", "(1m)^2"]),
        ("m^2", "3*4m^2", ["4 [m^2]", "(4m)^2"]),
        ("m^2", "-1.5e-3cm^2", ["1.5e-3 [cm^2]", "(1.5e-3cm)^2"]),
        ("1/m", "3m^-1", ["3 [m^-1]", "(3m)^-1"]),
        ("1", "30deg^2", ["30 [deg^2]", "(30deg)^2"]),
        ("m", "sqrt(4m^2)", ["4 [m^2]", "(4m)^2"]),
        ("m^2/s^2", "2 [m/s]^2", ["2 [(m/s)^2]", "(2 [m/s])^2"]),
        ("m", "2 [m^2]^0.5", ["2 [(m^2)^…]", "(2 [m^2])^…"]),
    ] {
        let report = report(unit, value);
        assert_eq!(report.lines().count(), 2, "{value}: {report}");
        assert!(report.contains("two ways"), "{value}: {report}");
        assert!(report.contains(&format!("`{of_unit}`")), "{value}: {report}");
        assert!(report.contains(&format!("`{of_number}`")), "{value}: {report}");
    }
}

#[test]
fn both_readings_are_accepted() {
    for (unit, value) in [
        ("m^2", "4 [m^2]"),
        ("m^2", "(4m)^2"),
        ("m^2", "(4 [m])^2"),
        ("m^2", "4m*4m"),
        ("m^2", "4[mm^2]"),
        ("1", "2^3"),
        ("m^2", "(2mm + 1m)^2"),
        ("1/m", "3 [m^-1]"),
    ] {
        assert_eq!(report(unit, value), "", "{value}");
    }
}

#[test]
fn a_unit_apart_from_its_number_is_told_its_form() {
    for (unit, value, meant) in [
        ("m/s^2", "9.81 m/s^2", "9.81 [m/s^2]"),
        ("m/s^2", "-2*9.81 m/s^2*2", "9.81 [m/s^2]"),
        ("N*m", "5 Nm", "5 [N*m]"),
        ("N*m", "5Nm", "5 [N*m]"),
        ("m^2", "4 m^2", "4 [m^2]"),
        ("m", "9 mm", "9mm"),
        ("1", "sin(30 deg)", "30deg"),
        ("m/s", "3 km/h", "3 [km/h]"),
    ] {
        let report = report(unit, value);
        assert_eq!(report.lines().count(), 2, "{value}: {report}");
        assert!(report.contains(&format!("`{meant}`")), "{value}: {report}");
    }
}

/// `$length^2` is the square of the whole argument.
macro_rules! plate {
    ($name:ident, $length:expr) => {
        mechanism! {
            mechanism $name;
            coord x: m;
            drive d: x == 1m*t/1s;
            out area: m^2 = $length^2;
        }
    };
}
plate!(Plate, (4m));
plate!(PlateOfANumber, 4m);
macro_rules! plate_of_a_literal {
    ($name:ident, $length:literal) => {
        plate!($name, $length);
    };
}
plate_of_a_literal!(PlateOfALiteral, 4m);
macro_rules! with_area {
    ($name:ident, $area:expr) => {
        mechanism! {
            mechanism $name;
            coord x: m;
            drive d: x == 1m*t/1s;
            out area: m^2 = $area [mm^2];
        }
    };
}
with_area!(OwnArea, -4);

mechanism! {
    mechanism Readings;
    coord x: m;
    drive d: x == 1m*t/1s;
    out of_unit: m^2 = 4 [m^2];
    out of_number: m^2 = (4m)^2;
    out small_of_unit: m^2 = 2 [mm^2];
    out small_of_number: m^2 = (2mm)^2;
}

#[test]
fn a_power_is_of_what_stands_before_it() {
    let motion = Stepper::assemble(Readings::default(), [0.0], 0.0).expect("assembled");
    let values: Vec<f64> = motion.outputs().iter().map(|output| output.value).collect();
    assert_eq!(values, [4.0, 16.0, 2e-6, 2e-3 * 2e-3]);
}

#[test]
fn an_argument_of_a_macro_is_one_operand() {
    macro_rules! area {
        ($mechanism:expr) => {
            Stepper::assemble($mechanism, [0.0], 0.0).expect("assembled").outputs()[0].value
        };
    }
    assert_eq!(area!(Plate::default()), 16.0);
    assert_eq!(area!(PlateOfANumber::default()), 16.0);
    assert_eq!(area!(PlateOfALiteral::default()), 16.0);
    assert_eq!(area!(OwnArea::default()), -4e-6);
}
