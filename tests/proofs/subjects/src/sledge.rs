//! Rigid contacts with impacts, frictions that stick on one of them and on a belt, an event with a latched value.

use mbs_runtime::mechanism;

mechanism! {
    /// A sledge with a load on a rod is thrown onto rough ground; beside it a block rides on a belt.
    pub mechanism Sledge;

    param mu: 1 = 0.3;
    param belt_speed: m/s = 0.1;

    coord p: [m; 2] = [0, 0.02];
    coord r: [m; 2] = [0, 0.22];
    coord s: m = 0;

    body sledge { mass: 2, com: p }
    body load { mass: 0.5, com: r }
    body block { mass: 1, com: [s, 0] }
    gravity weight { acceleration: [0, -9.81] }
    constraint rod { dot(r - p, r - p) == (0.2m)^2; }
    contact ground { gap: p[1], restitution: 0.5 }
    contact roof { gap: r[1] - 1cm, restitution: 0.2 }
    friction rub { along: p[0], normal: normal(ground), coefficient: mu, sticks: 0.4 }
    friction belt { along: s - belt_speed*t, normal: 9.81N, coefficient: 0.1, sticks: 0.15 }
    tsda spring { from: [0, 0], to: [s + 1m, 0], stiffness: 2, length: 1 }
    event low: p[1] < 1cm until p[1] > 3cm;
    latch since: s = t at low;
    force wind: [1N*low, 0] on p;
    out age: s = (t - since)*low;
    out push: N = force(ground);
    start p = [0, 0.02] rate [1, 0];
}
