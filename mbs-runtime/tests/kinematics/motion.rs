//! Positions, velocities and accelerations that are right.

use core::f64::consts::TAU;

use approx::assert_relative_eq;
use mbs_runtime::{Failure, FailureKind, Mechanism, Stepper, assemble, newton_raphson};

use crate::four_bar::{FourBar, GUESS};

/// t, q, q̇, q̈ of `four_bar_coupler_point.json`, case `const`.
const REFERENCE: [[f64; 16]; 8] = [
    [
        0.01,
        0.23417670299612847,
        0.3608465206723574,
        0.06283185307179587,
        0.9482609174000743,
        1.5718694685755306,
        1.1678458054442447,
        1.1304040092693284,
        TAU,
        -3.579650196140352,
        -3.3319330273864516,
        -9.493703580079858,
        -4.842510205103857,
        0.0,
        3.36102657996433,
        28.01483456226762,
    ],
    [
        0.135,
        0.2799174959801882,
        0.46735164003848545,
        0.8482300164692441,
        0.6116887319158334,
        1.4233222868612585,
        -0.44429232212458636,
        0.5991556202904332,
        TAU,
        -1.570371378007306,
        0.8119031867522004,
        -10.918452181475372,
        -4.223806617008664,
        0.0,
        16.80529830516752,
        24.61660958244715,
    ],
    [
        0.26,
        0.16324844443627792,
        0.5022471431294684,
        1.6336281798666925,
        0.5209358058965221,
        1.6551880918720694,
        -1.2390785316128257,
        -0.08766429028531983,
        TAU,
        -0.04982406184849301,
        2.4874106806884724,
        -2.17683794898236,
        -6.328570656600351,
        0.0,
        8.829499471526614,
        4.822975983670988,
    ],
    [
        0.385,
        0.00858998916227676,
        0.4442594388064679,
        2.419026343264141,
        0.5768706419295114,
        1.9760329283336076,
        -1.115302369183128,
        -0.7980992627382361,
        TAU,
        0.9111411653000053,
        2.4574137122256348,
        3.574856376315252,
        -4.353904117953371,
        0.0,
        7.102973333413113,
        -4.3315650413829125,
    ],
    [
        0.51,
        -0.09509369587745196,
        0.32147380333410097,
        3.204424506661589,
        0.743967218888611,
        2.234788118643799,
        -0.4998870244048461,
        -1.0730653987870422,
        TAU,
        1.7327444049720717,
        1.5876215722338933,
        5.69563775524531,
        0.07817234182256295,
        0.0,
        5.60030131329809,
        -8.894567466732441,
    ],
    [
        0.635,
        -0.11329009794385118,
        0.19946319746719882,
        3.9898226700590373,
        0.9929644694585092,
        2.3589802299361993,
        0.19638391726491353,
        -0.7905187348596935,
        TAU,
        2.1352349159613184,
        0.3702242860478713,
        5.126726504206915,
        4.329705581871784,
        0.0,
        0.023702741186184307,
        -10.400364278257149,
    ],
    [
        0.76,
        -0.05277439582837691,
        0.14424297040514114,
        4.775220833456486,
        1.2349632019471677,
        2.317763783995022,
        0.7388702447487592,
        -0.01900163849999178,
        TAU,
        1.4985884949390917,
        -1.1045534923532758,
        3.6068537734321007,
        7.859537196028387,
        0.0,
        -11.504800388776973,
        -14.072763514112511,
    ],
    [
        0.885,
        0.06747850289679695,
        0.20786486161298878,
        5.560618996853934,
        1.2852795617511499,
        2.051013247403505,
        1.2008069382961384,
        1.0323568567046681,
        TAU,
        -1.0871753316475679,
        -3.2854551335704865,
        4.1969275502912335,
        7.251683959496238,
        0.0,
        -29.46545758144948,
        -18.82491917020728,
    ],
];

/// Compares with an error relative to the largest value that the column takes.
fn assert_matches(stepper: &Stepper<FourBar<f64>, f64, 5>, row: &[f64; 16], tolerance: f64) {
    let found = stepper.q().iter().chain(stepper.qd()).chain(stepper.qdd());
    for (column, found) in (1..16).zip(found) {
        let scale = REFERENCE.iter().fold(0.0, |largest: f64, row| largest.max(row[column].abs()));
        assert!((found - row[column]).abs() <= tolerance * scale, "column {column}: {found} {}", row[column]);
    }
}

#[test]
fn assembled_at_each_reference_time_all_values_agree() {
    for row in &REFERENCE {
        let guess = [row[1], row[2], row[3], row[4] + 0.2, row[5] - 0.2];
        let stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), guess, row[0]).unwrap();
        assert_matches(&stepper, row, 1e-12);
    }
}

#[test]
fn followed_from_the_first_reference_time_all_values_agree() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, REFERENCE[0][0]).unwrap();
    for row in &REFERENCE {
        let until = row[0];
        assert!(stepper.sweep(until, 7).all(|frame| frame.is_ok()));
        assert_matches(&stepper, row, 1e-12);
    }
}

#[test]
fn a_fine_step_costs_two_evaluations_and_a_turn_closes() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
    let first = *stepper.q();
    let mut frames = 0;
    let mut second_order = 0;
    for frame in stepper.sweep(1.0, 1000) {
        let frame = frame.unwrap();
        assert!(frame.closure_error < 1e-13);
        assert!(frame.statistics.residual_over_tolerance <= 1.0 && !frame.statistics.fallback);
        second_order += u32::from(frames > 0 && frame.statistics.evaluations > 2);
        frames += 1;
    }
    assert_eq!(frames, 1001);
    assert_eq!(second_order, 0);
    assert_eq!(stepper.t(), 1.0);
    for (end, start) in stepper.q()[3..].iter().zip(&first[3..]) {
        assert_relative_eq!(end, start, epsilon = 1e-12);
    }
}

#[test]
fn the_prediction_halves_the_iterations_of_the_plain_method() {
    let mechanism = FourBar::<f64>::reference(1.0);
    let mut stepper = Stepper::assemble(mechanism, GUESS, 0.0).unwrap();
    let (mut q, mut plain, mut predicted) = (*stepper.q(), 0, 0);
    for k in 1..=1000 {
        let t = f64::from(k) / 1000.0;
        // An iteration is a factorization; the last evaluation only finds that there is nothing left to do.
        predicted += stepper.advance_to(t).unwrap().evaluations - 1;
        let (next, iterations) = newton_raphson(&mechanism, q, t).unwrap();
        (q, plain) = (next, plain + iterations);
        assert_relative_eq!(q[4], stepper.q()[4], epsilon = 1e-12);
    }
    assert!(2 * predicted <= plain, "{predicted} against {plain}");
}

#[test]
fn both_assemblies_are_found_from_either_guess_when_declared() {
    for side in [1.0, -1.0] {
        for guess in [[0.0, 0.0, 0.06, 0.9, 1.6], [0.0, 0.0, 0.06, -1.5, -2.5]] {
            let mechanism = FourBar::<f64> { side, ..FourBar::reference(1.0) };
            let q = assemble(&mechanism, guess, 0.01).unwrap().q;
            assert!(side * (q[4] - q[3]).sin() > 0.0);
        }
    }
}

#[test]
fn without_a_declared_branch_the_guess_picks_the_assembly() {
    let mechanism = FourBar::<f64, 0>::reference(1.0);
    let open = assemble(&mechanism, [0.0, 0.0, 0.06, 0.9, 1.6], 0.01).unwrap();
    let crossed = assemble(&mechanism, [0.0, 0.0, 0.06, -0.4, -1.1], 0.01).unwrap();
    assert_eq!((open.start, crossed.start), (0, 0));
    assert!((open.q[4] - open.q[3]).sin() > 0.0 && (crossed.q[4] - crossed.q[3]).sin() < 0.0);
}

#[test]
fn backwards_is_the_way_back_and_a_zero_step_stays() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
    let first = *stepper.q();
    stepper.advance(0.01).unwrap();
    stepper.advance(0.0).unwrap();
    assert_eq!(stepper.t(), 0.01);
    stepper.advance(-0.01).unwrap();
    for (end, start) in stepper.q().iter().zip(first) {
        assert_relative_eq!(*end, start, epsilon = 1e-13);
    }
}

#[test]
fn millimetres_and_kilometres_give_the_same_angles_with_the_same_effort() {
    let metres: Vec<_> = {
        let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
        stepper.sweep(1.0, 100).map(|frame| frame.unwrap()).collect()
    };
    for unit in [1e-9, 1e-3, 1e3] {
        let guess = [GUESS[0] * unit, GUESS[1] * unit, GUESS[2], GUESS[3], GUESS[4]];
        let mut stepper = Stepper::assemble(FourBar::<f64>::reference(unit), guess, 0.0).unwrap();
        for (frame, metres) in stepper.sweep(1.0, 100).zip(&metres) {
            let frame = frame.unwrap();
            assert_relative_eq!(frame.q[0], metres.q[0] * unit, epsilon = 1e-12 * unit);
            assert_relative_eq!(frame.q[3], metres.q[3], epsilon = 1e-12);
            assert_relative_eq!(frame.qdd[4], metres.qdd[4], max_relative = 1e-9);
            assert_eq!(frame.statistics.evaluations, metres.statistics.evaluations);
            assert_relative_eq!(frame.margin, metres.margin, max_relative = 1e-9);
        }
    }
}

#[test]
fn single_precision_follows_a_turn_to_its_own_accuracy() {
    let guess = GUESS.map(|x| x as f32);
    let mut single = Stepper::assemble(FourBar::<f32>::reference(1.0), guess, 0.0).unwrap();
    let mut double = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.0).unwrap();
    for (single, double) in single.sweep(1.0, 200).zip(double.sweep(1.0, 200)) {
        let (single, double) = (single.unwrap(), double.unwrap());
        for (s, d) in single.q.into_iter().zip(double.q) {
            assert!((f64::from(s) - d).abs() < 2e-5, "{s} {d}");
        }
    }
}

#[test]
fn a_crank_after_a_hundred_thousand_turns_still_converges() {
    let turn = 1e5;
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, turn).unwrap();
    for frame in stepper.sweep(turn + 1.0, 100).skip(1) {
        let frame = frame.unwrap();
        assert!(frame.statistics.evaluations <= 4, "{:?}", frame.statistics);
        assert!(frame.closure_error < 1e-12);
    }
}

#[test]
fn angles_of_a_far_guess_keep_their_turns() {
    let far = 1e5 * TAU;
    let guess = [0.2, 0.3, 0.0, 0.9 + far, 1.6 + far];
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), guess, 0.0).unwrap();
    for frame in stepper.sweep(1.0, 100) {
        let frame = frame.unwrap();
        assert!((frame.q[3] - far).abs() < 4.0 && (frame.q[4] - far).abs() < 4.0);
        assert!(frame.closure_error < 1e-9);
    }
}

#[test]
fn changed_parameters_take_effect_and_the_output_has_its_rates() {
    let mut stepper = Stepper::assemble(FourBar::<f64>::reference(1.0), GUESS, 0.3).unwrap();
    let before = stepper.outputs()[0];
    assert!(stepper.change(|mechanism| mechanism.set(0, 0.21)));
    stepper.advance(0.0).unwrap();
    assert!(stepper.outputs()[0].value != before.value);
    assert!(stepper.closure_error() < 1e-14);
    // Rates against central differences, wrong by h²/6 of the third derivative.
    let (h, middle) = (1e-4, stepper.outputs()[0]);
    stepper.advance(h).unwrap();
    let after = stepper.outputs()[0];
    stepper.advance(-2.0 * h).unwrap();
    let before = stepper.outputs()[0];
    assert_relative_eq!(middle.rate.unwrap(), (after.value - before.value) / (2.0 * h), max_relative = 1e-5);
    let second = (after.value - 2.0 * middle.value + before.value) / (h * h);
    assert_relative_eq!(middle.acceleration.unwrap(), second, max_relative = 1e-4);
}

#[test]
fn the_plain_method_diverges_with_a_value() {
    let mechanism = FourBar::<f64>::dimensioned(3.0, 2.0, 2.0, 4.0);
    let failure = newton_raphson(&mechanism, [0.0, 0.0, 1.5, 0.2, 1.0], 1.5).unwrap_err();
    assert!(
        matches!(
            failure,
            Failure { kind: FailureKind::NotConverged { .. }, .. }
                | Failure { kind: FailureKind::Singular { .. }, .. }
        ),
        "{failure}"
    );
}

#[cfg(feature = "nalgebra")]
#[test]
fn nalgebra_vectors_go_in_and_matrices_come_out() {
    use mbs_runtime::{Matrices, nalgebra};
    let mechanism = FourBar::<f64>::reference(1.0);
    let guess = nalgebra_vector();
    let stepper = Stepper::assemble(mechanism, guess, 0.01).unwrap();
    let phi_q = mechanism.phi_q_matrix(&stepper.q_vector(), 0.01);
    let residual = phi_q * stepper.qd_vector() + mechanism.phi_t_vector(&stepper.q_vector(), 0.01);
    assert!(residual.amax() < 1e-13);
    let gamma = mechanism.gamma_vector(&stepper.q_vector(), 0.01, &stepper.qd_vector());
    assert!((phi_q * stepper.qdd_vector() - gamma).amax() < 1e-12 * gamma.amax());
    let rows = nalgebra::rows(&phi_q);
    assert_eq!(rows[2][3], phi_q[(2, 3)]);
    assert_eq!(nalgebra::matrix(&rows), phi_q);
}

#[cfg(feature = "nalgebra")]
fn nalgebra_vector() -> impl Into<[f64; 5]> {
    mbs_runtime::nalgebra::vector(GUESS)
}
