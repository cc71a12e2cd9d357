//! D16: an equilibrium on the edge of a free play is indifferent, from whichever side the search came, and names the coordinate.

use mbs_runtime::dynamics::equilibrium;
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    /// A slider between two buffers 0.2 m apart, beside one on a spring.
    mechanism Buffers;
    coord x: m = 0;
    coord y: m = 0;
    body slider { mass: 1, com: [x, y] }
    gravity weight { acceleration: [0, -9.81] }
    force hold: -1000N/1m*y on y;
    contact left { gap: x + 0.1m, stiffness: 1e5 }
    contact right { gap: 0.1m - x, stiffness: 1e5 }
}

#[test]
fn both_ends_of_a_play_between_contacts_are_indifferent() {
    for (from, at) in
        [(0.3, 0.1), (0.1001, 0.1), (-0.3, -0.1), (-0.5, -0.1), (0.05, 0.05), (0.1, 0.1), (-0.1, -0.1)]
    {
        let found = equilibrium(&Buffers::<f64>::default(), 0.0, &[from, 0.0]).expect("a rest");
        assert!((found.q[0] - at).abs() < 1e-12 && (found.q[1] + 9.81e-3).abs() < 1e-12, "{found:?}");
        assert_eq!(found.indifferent, [true, false], "from {from}: {found:?}");
    }
}

#[test]
fn the_play_is_found_in_single_precision_too() {
    for from in [0.3, -0.3, 0.02] {
        let found = equilibrium(&Buffers::<f32>::default(), 0.0, &[from, 0.0]).expect("a rest");
        assert_eq!(found.indifferent, [true, false], "from {from}: {found:?}");
    }
}

mechanism! {
    /// A shaft with play against another that a spring holds: the moment is written by `max`, `min` and `abs`.
    mechanism Shafts;
    param kind: 1 = 0;
    coord a: rad = 0;
    coord b: rad = 0;
    body first { mass: 1, inertia: 0.1, com: [0, 0], angle: a }
    body second { mass: 1, inertia: 0.1, com: [0, 0], angle: b }
    torque hold: -50 [N*m]*b on b;
    torque stepped: (1 - kind)*400 [N*m]*(max(b - a - 0.05, 0) + min(b - a + 0.05, 0)) on a - b;
    torque bent: kind*200 [N*m]*(abs(b - a - 0.05) - abs(b - a + 0.05) + 2*(b - a)) on a - b;
}

#[test]
fn a_play_of_max_min_and_abs_is_indifferent_at_both_ends() {
    for kind in [0.0, 1.0] {
        for from in [0.4, -0.4, 0.05, -0.05, 0.01] {
            let found = equilibrium(&Shafts { kind }, 0.0, &[from, 0.0]).expect("a rest");
            let play = if from < 0.0 { f64::max(from, -0.05) } else { f64::min(from, 0.05) };
            assert!((found.q[0] - found.q[1] - play).abs() < 1e-12 && found.q[1].abs() < 1e-12, "{found:?}");
            assert_eq!(found.indifferent, [true, false], "{kind}, from {from}: {found:?}");
        }
    }
}

mechanism! {
    /// A ball on a floor that takes it in by much less than the look to both sides.
    mechanism Floor;
    param stiffness: N/m = 1e12;
    param load: N = 1;
    coord x: m = 1;
    coord y: m = 0.1;
    body ball { mass: 1e-9, com: [x, y] }
    force push: -load on y;
    force hold: -1e5N/1m*(x - 1m) on x;
    contact floor { gap: y, stiffness: stiffness }
}

#[test]
fn a_load_that_presses_leaves_no_play() {
    for (stiffness, load) in [(1e12_f64, 1.0_f64), (1e9, 1e-3), (1e4, 100.0), (1e6, 1e-6)] {
        let found = equilibrium(&Floor { stiffness, load }, 0.0, &[1.0, -1e-3]).expect("a rest");
        assert!((found.q[1] + load / stiffness).abs() < 1e-9 * (1.0 + load / stiffness), "{found:?}");
        assert_eq!(found.indifferent, [false, false], "{stiffness}, {load}: {found:?}");
    }
}

mechanism! {
    /// A block in a corner: both walls must be left at once, or one of them.
    mechanism Corner;
    param tilt: 1 = 0.5;
    coord x: m = -0.01;
    coord y: m = -0.02;
    body block { mass: 1, com: [x, y] }
    contact floor { gap: y, stiffness: 1e5 }
    contact wall { gap: x - tilt*y, stiffness: 2e5 }
}

#[test]
fn a_corner_is_left_in_both_coordinates() {
    for tilt in [0.0_f64, 0.5, -2.0, 5.0] {
        let found = equilibrium(&Corner { tilt }, 0.0, &[-0.01 - 0.03 * tilt.abs(), -0.02])
            .unwrap_or_else(|failure| panic!("{tilt}: {failure}"));
        assert!(found.q[0].abs() < 1e-9 && found.q[1].abs() < 1e-9, "{tilt}: {found:?}");
        assert_eq!(found.indifferent, [true, true], "{tilt}: {found:?}");
    }
}

mechanism! {
    /// A crank whose rod has play at a stop; a curve of points that balance, through constraints.
    mechanism Stopped;
    param load: N = 0;
    coord phi: rad = 0.4;
    coord psi: rad = -0.2;
    coord s: m = 1.2;
    body slider { mass: 1, com: [s, 0] }
    force press: load on s;
    contact stop { gap: 1.2m - s, stiffness: 1e5 }
    constraint loop { 0.5m*unit(phi) + 0.8m*unit(psi) == [s, 0]; }
}

#[test]
fn a_play_of_a_closed_loop_names_all_coordinates_that_move() {
    let started = |load: f64| equilibrium(&Stopped { load }, 0.0, &[0.354, -0.218, 1.25]);
    let found = started(0.0).expect("a rest");
    // Newton's method takes the loop over the edge, into the play.
    assert!(found.q[2] < 1.2, "{found:?}");
    assert_eq!(found.indifferent, [true; 3], "{found:?}");
    let found = started(10.0).expect("a rest");
    assert!((found.q[2] - 1.2 - 1e-4).abs() < 1e-9, "{found:?}");
    assert_eq!(found.indifferent, [false; 3], "{found:?}");
}

mechanism! {
    /// Eight masses that hang on each other, each with play: together they may rise, and none alone.
    mechanism Chain;
    param g: m/s^2 = 0;
    coord y: [m; 8] = [-0.1, -0.2, -0.3, -0.4, -0.5, -0.6, -0.7, -0.8];
    for i in 0..8 { body link { mass: 1, com: [0, y[i]] } }
    gravity weight { acceleration: [0, -g] }
    contact top { gap: 0.1m + y[0], stiffness: 1e4 }
    for i in 0..7 { contact joint { gap: 0.1m - y[i] + y[i + 1], stiffness: 1e4 } }
}

#[test]
fn a_play_to_which_eight_freedoms_move_together_is_indifferent() {
    // Exactly at the end of every play, and pulled farther.
    let ends: [f64; 8] = core::array::from_fn(|index| -0.125 * (index + 1) as f64);
    let hanging = |y: [f64; 8], g: f64| equilibrium(&Chain::<f64> { g }, 0.0, &y).expect("a rest");
    for start in
        [Chain::<f64>::default().guess(&Chain::<f64>::default().parameters()), ends, ends.map(|y| 1.5 * y)]
    {
        let found = hanging(start, 0.0);
        assert_eq!(found.indifferent, [true; 8], "{found:?}");
    }
    assert_eq!(hanging(ends, 9.81).indifferent, [false; 8]);
}

mechanism! {
    /// A mass whose position an integral control holds, beside one between buffers, and one that a spring holds.
    mechanism Controlled;
    coord x: m = 0;
    coord y: m = 0;
    coord z: m = 0.1;
    body first { mass: 1, com: [x, 0] }
    body second { mass: 1, com: [y, 1m] }
    body third { mass: 1, com: [z, 2m] }
    state held: N = 0;
    der(held) == 10 [N/(m*s)]*(0.5m - x);
    force control: [held - 3N, 0] on [x, 0];
    force hold: [-1e3 [N/m]*z, 0] on [z, 2m];
    contact left { gap: y, stiffness: 1e4 }
    contact right { gap: 0.2m - y, stiffness: 1e4 }
}

#[test]
fn a_play_beside_a_state_that_integrates_is_indifferent_at_both_ends() {
    for (from, at) in [(-0.01, 0.0), (0.0, 0.0), (0.1, 0.1), (0.2, 0.2), (0.3, 0.2)] {
        let found = equilibrium(&Controlled::<f64>::default(), 0.0, &[0.0, from, 0.1]).expect("a rest");
        assert!((found.q[0] - 0.5).abs() < 1e-12 && (found.q[1] - at).abs() < 1e-12, "{found:?}");
        assert_eq!(found.indifferent, [false, true, false], "from {from}: {found:?}");
    }
}
