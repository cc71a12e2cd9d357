//! Texts that several files take: each is compiled once.

use mbs_runtime::mechanism;

mechanism! {
    /// A ball in free fall.
    pub mechanism Ball;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
}

mechanism! {
    /// A mass of 1 kg on a spring of 1 N/m.
    pub mechanism Oscillator;
    coord x: m = 1;
    body mass { mass: 1, com: [x, 0] }
    tsda spring { from: [0, 0], to: [x + 5m, 0], stiffness: 1, length: 5m }
}

mechanism! {
    /// A ball under a roof 1.9 m high.
    pub mechanism Roofed;
    coord y: m = 0;
    body ball { mass: 1, com: [0, y] }
    gravity weight { acceleration: [0, -9.81] }
    contact roof { gap: 1.9m - y, stiffness: 1e6 }
}
