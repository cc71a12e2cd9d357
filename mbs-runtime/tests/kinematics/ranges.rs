//! Working ranges: a warning before, a failure beyond, the state as it was.

use mbs_runtime::{Budget, Failure, FailureKind, Mechanism, Saved, Step, Stepper, WARNING_SHARE, mechanism};

mechanism! {
    /// A crank that may swing, and a slide that must stay on its rail.
    pub mechanism Slide;
    param r: m = 0.1;
    param reach: m = 0.15;
    input theta: rad, rates;
    coord phi: rad;
    coord x: m;
    drive crank: phi == theta;
    constraint slide { x == r*(1 + sin(phi)); }
    limit stroke: 0.02m <= x <= reach;
    limit swing: -30deg <= 2*phi <= 90deg;
    for i in 0..2 { limit each: -1m <= x*(i + 1) <= 2*reach; }
}

type Rail = Stepper<Slide, f64, 2>;

fn at(theta: f64) -> Result<Rail, Failure> {
    let mut slide = Slide::default();
    slide.theta.value = theta;
    Stepper::assemble(slide, [theta, 0.1], 0.0)
}

fn bits(rail: &Rail) -> Vec<u64> {
    rail.q().iter().chain(rail.qd()).chain(rail.qdd()).chain([&rail.t()]).map(|x| x.to_bits()).collect()
}

#[test]
fn limits_are_listed_with_units_and_bounds() {
    let names: Vec<_> = Slide::<f64>::LIMITS.iter().map(|limit| (limit.name, limit.unit)).collect();
    assert_eq!(names, [("stroke", "m"), ("swing", "1"), ("each.0", "m"), ("each.1", "m")]);
    let limits = at(0.2).unwrap().limits();
    assert_eq!((limits[0].low, limits[0].high), (0.02, 0.15));
    assert!((limits[0].value - 0.1 * (1.0 + 0.2_f64.sin())).abs() < 1e-15);
    assert!((limits[1].value - 0.4).abs() < 1e-15 && limits[3].high == 0.3);
}

#[test]
fn every_call_that_moves_refuses_what_lies_beyond() {
    let mut rail = at(0.5).unwrap();
    let edge = (0.5_f64).asin();
    for theta in [edge + 1e-6, edge + 1e-13] {
        rail.change(|slide| slide.theta.value = theta);
        let before = bits(&rail);
        let failure = rail.advance(1e-3).unwrap_err();
        let Failure { kind: FailureKind::BeyondLimit { limit, value, bound }, time: Some(time) } = failure
        else {
            panic!("{failure}")
        };
        assert_eq!((limit.name, bound, time), ("stroke", 0.15, 1e-3));
        assert!(value > 0.15 && limit.line > 0);
        assert!(failure.to_string().starts_with("limit `stroke` (line "), "{failure}");
        for budget in [Budget { newton: 1, fallback: 0 }, Budget { newton: 9, fallback: 9 }] {
            assert_eq!(rail.step(1e-3, budget), Step::Refused(failure));
            assert!(matches!(
                rail.skip(1e-3, 3, budget),
                Step::Refused(Failure { kind: FailureKind::BeyondLimit { .. }, .. })
            ));
        }
        assert_eq!(bits(&rail), before);
        assert!(matches!(at(theta), Err(Failure { kind: FailureKind::BeyondLimit { .. }, .. })));
    }
    let saved: Saved<2, _> = rail.save();
    let failure = Rail::assemble_near(*rail.mechanism(), &saved, 0.0).unwrap_err();
    assert!(matches!(failure, Failure { kind: FailureKind::BeyondLimit { .. }, .. }));
    // The bound itself belongs to the range, whatever rounding makes of it.
    rail.change(|slide| slide.theta.value = edge);
    rail.advance(1e-3).unwrap();
}

#[test]
fn a_quantity_is_warned_of_before_it_passes_its_bound() {
    let mut rail = at(0.0).unwrap();
    let (mut warned, mut last) = (0, 1.0);
    for k in 1.. {
        rail.change(|slide| slide.theta.value = 1e-3 * f64::from(k));
        if rail.advance(1e-3).is_err() {
            break;
        }
        let warnings: Vec<_> = rail.warnings().filter(|warning| warning.limit.name == "stroke").collect();
        let left = (0.15 - rail.q()[1]) / 0.13;
        assert_eq!(warnings.len(), usize::from(left < WARNING_SHARE), "{left}");
        if let [warning] = warnings[..] {
            assert!((warning.left - left).abs() < 1e-12 && warning.left < last);
            assert_eq!((warning.bound, warning.value), (0.15, rail.q()[1]));
            (warned, last) = (warned + 1, warning.left);
        }
    }
    assert!(warned > 50 && last < 1e-2, "{warned} {last}");
    // Several at once, of either bound.
    let mut low = at(-0.26).unwrap();
    assert_eq!(low.warnings().map(|warning| warning.limit.name).collect::<Vec<_>>(), ["swing"]);
    low.change(|slide| slide.reach = 0.075);
    low.advance(0.0).unwrap();
    let names: Vec<_> = low.warnings().map(|warning| warning.limit.name).collect();
    assert_eq!(names, ["stroke", "swing", "each.1"]);
}

#[test]
fn a_bound_that_is_no_number_is_reported() {
    let mut rail = at(0.1).unwrap();
    rail.change(|slide| slide.reach = f64::NAN);
    assert!(matches!(
        rail.advance(0.0),
        Err(Failure { kind: FailureKind::NonFinite { name: "reach", .. }, .. })
    ));
    rail.change(|slide| slide.reach = 0.01);
    assert!(
        matches!(rail.advance(0.0), Err(Failure { kind: FailureKind::BeyondLimit { .. }, .. })),
        "an empty range holds nothing"
    );
}
