//! The lecture's four-bar with coupler point, written by hand as the macro would emit it.

use mbs_runtime::{
    __private::first_failure, Block, BlockSolver, Direct2, Entry, Factorization, Kinematic, Limit, Margin,
    Mechanism, Outcome, OutputValue, Phase, Scalar,
};

/// q = [x2 y2 φ1 φ2 φ3]; `B` is 1 with the declared branch `side · sin(φ3 − φ2) > 0`, 0 without.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar<T, const B: usize = 1> {
    pub lengths: [T; 5],
    pub alpha: T,
    pub omega: T,
    pub side: T,
}

thread_local! {
    /// Evaluations of the dyad's residual and Jacobian in this thread.
    pub static EVALUATIONS: std::cell::Cell<u32> = const { std::cell::Cell::new(0) };
}

pub const GUESS: [f64; 5] = [0.24, 0.36, 0.06, 0.9, 1.6];

impl<T: Scalar, const B: usize> FourBar<T, B> {
    /// The dimensions of `four_bar_coupler_point.json`, lengths times `unit`.
    pub fn reference(unit: f64) -> Self {
        FourBar {
            lengths: [0.2, 0.6, 0.5, 0.55, 0.35].map(|length| T::constant(length * unit)),
            alpha: T::constant(core::f64::consts::FRAC_PI_6),
            omega: T::constant(core::f64::consts::TAU),
            side: T::constant(1.0),
        }
    }

    /// Crank, coupler, rocker and ground, turning at 1 rad/s.
    pub fn dimensioned(crank: f64, coupler: f64, rocker: f64, ground: f64) -> Self {
        let lengths = [crank, coupler, rocker, ground, 1.0].map(T::constant);
        FourBar { lengths, omega: T::constant(1.0), ..Self::reference(1.0) }
    }

    fn block(&self) -> Block<T, 2> {
        Block {
            rows: [2, 3],
            coordinates: [3, 4],
            angles: [true; 2],
            row_scales: [self.reference_length(); 2],
            coordinate_scales: [T::constant(1.0); 2],
        }
    }

    fn reference_length(&self) -> T {
        self.lengths.into_iter().fold(T::constant(0.0), |largest, length| largest.max(length))
    }

    fn closure(&self, c: [T; 3], s: [T; 3]) -> [T; 2] {
        let [l1, l2, l3, l4, _] = self.lengths;
        [l3 * c[2] + l4 - l1 * c[0] - l2 * c[1], l1 * s[0] + l2 * s[1] - l3 * s[2]]
    }

    fn dyad(&self, c: [T; 3], s: [T; 3]) -> [[T; 2]; 2] {
        let [_, l2, l3, ..] = self.lengths;
        [[l2 * s[1], -l3 * s[2]], [l2 * c[1], -l3 * c[2]]]
    }
}

const fn entry(name: &'static str, unit: &'static str, line: u32) -> Entry {
    Entry { name, unit, line }
}

/// Cosines and sines of φ1, φ2, φ3, φ2 + α; q and t.
#[derive(Clone, Copy)]
pub struct Position<T> {
    c: [T; 4],
    s: [T; 4],
    q: [T; 5],
    t: T,
}

impl<T: Scalar, const B: usize> Mechanism<T, 5, 5> for FourBar<T, B> {
    type Parameters = ();
    type Position = Position<T>;
    type Entries = [T; 13];
    type Branches = [T; B];
    type Limits = [Limit<T>; 0];
    type Phases = [Phase<T>; 0];
    type Values = [T; 8];
    type Kept = [f64; 8];
    type Outputs = [OutputValue<T>; 1];
    type Lane = FourBar<T::Real, B>;

    const NAME: &'static str = "FourBar";
    const SOURCE: &'static str = "";
    const COORDINATES: &'static [Entry] = &[
        entry("x2", "m", 11),
        entry("y2", "m", 12),
        entry("phi1", "rad", 13),
        entry("phi2", "rad", 14),
        entry("phi3", "rad", 15),
    ];
    const ROWS: &'static [Entry] = &[
        entry("coupler_point.0", "m", 17),
        entry("coupler_point.1", "m", 18),
        entry("closure.0", "m", 21),
        entry("closure.1", "m", 22),
        entry("crank", "rad", 24),
    ];
    const SPARSITY: &'static [(u16, u16)] = &[
        (0, 0),
        (0, 2),
        (0, 3),
        (1, 1),
        (1, 2),
        (1, 3),
        (2, 2),
        (2, 3),
        (2, 4),
        (3, 2),
        (3, 3),
        (3, 4),
        (4, 2),
    ];
    const VARIABLES: &'static [Entry] = &[
        entry("lengths.0", "m", 1),
        entry("lengths.1", "m", 1),
        entry("lengths.2", "m", 1),
        entry("lengths.3", "m", 1),
        entry("lengths.4", "m", 1),
        entry("alpha", "rad", 2),
        entry("omega", "rad/s", 3),
        entry("side", "1", 4),
    ];
    const BRANCHES: &'static [Entry] = &[entry("open", "1", 25)];
    const OUTPUTS: &'static [Entry] = &[entry("transmission_angle", "rad", 26)];

    fn get(&self, index: usize) -> Option<T> {
        match index {
            0..5 => self.lengths.get(index).copied(),
            5 => Some(self.alpha),
            6 => Some(self.omega),
            7 => Some(self.side),
            _ => None,
        }
    }
    fn set(&mut self, index: usize, value: T) -> bool {
        let place = match index {
            0..5 => &mut self.lengths[index],
            5 => &mut self.alpha,
            6 => &mut self.omega,
            7 => &mut self.side,
            _ => return false,
        };
        *place = value;
        true
    }
    fn values(&self) -> [T; 8] {
        core::array::from_fn(|index| self.get(index).unwrap_or(T::constant(0.0)))
    }
    fn phases(&self) -> [Phase<T>; 0] {
        []
    }
    fn set_phases(&mut self, _: [Phase<T>; 0]) {}
    fn lane(&self, lane: usize) -> Self::Lane {
        FourBar {
            lengths: self.lengths.map(|length| length.lane(lane)),
            alpha: self.alpha.lane(lane),
            omega: self.omega.lane(lane),
            side: self.side.lane(lane),
        }
    }
    fn parameters(&self) {}
    fn guess(&self, (): &()) -> [T; 5] {
        GUESS.map(T::constant)
    }
    fn coordinate_scales(&self, (): &()) -> [T; 5] {
        let (length, one) = (self.reference_length(), T::constant(1.0));
        [length, length, one, one, one]
    }
    fn row_scales(&self, (): &()) -> [T; 5] {
        let length = self.reference_length();
        [length, length, length, length, T::constant(1.0)]
    }
    fn position(&self, (): &(), q: &[T; 5], t: T) -> Position<T> {
        let (s, c) = T::sin_cos([q[2], q[3], q[4], q[3] + self.alpha]);
        Position { c, s, q: *q, t }
    }
    fn phi(&self, (): &(), p: &Position<T>) -> [T; 5] {
        let [l1, .., l5] = self.lengths;
        let [x, y] = self.closure([p.c[0], p.c[1], p.c[2]], [p.s[0], p.s[1], p.s[2]]);
        [
            p.q[0] - l1 * p.c[0] - l5 * p.c[3],
            p.q[1] - l1 * p.s[0] - l5 * p.s[3],
            x,
            y,
            p.q[2] - self.omega * p.t,
        ]
    }
    fn phi_q(&self, (): &(), p: &Position<T>) -> [[T; 5]; 5] {
        let (o, i) = (T::constant(0.0), T::constant(1.0));
        let [l1, l2, l3, _, l5] = self.lengths;
        [
            [i, o, l1 * p.s[0], l5 * p.s[3], o],
            [o, i, -l1 * p.c[0], -l5 * p.c[3], o],
            [o, o, l1 * p.s[0], l2 * p.s[1], -l3 * p.s[2]],
            [o, o, l1 * p.c[0], l2 * p.c[1], -l3 * p.c[2]],
            [o, o, i, o, o],
        ]
    }
    fn phi_q_entries(&self, (): &(), p: &Position<T>) -> [T; 13] {
        let rows = self.phi_q(&(), p);
        core::array::from_fn(|k| {
            let (row, column) = Self::SPARSITY[k];
            rows[usize::from(row)][usize::from(column)]
        })
    }
    fn phi_t(&self, (): &(), _: &Position<T>) -> [T; 5] {
        let o = T::constant(0.0);
        [o, o, o, o, -self.omega]
    }
    fn phi_tt(&self, (): &(), _: &Position<T>) -> [T; 5] {
        [T::constant(0.0); 5]
    }
    fn phi_qt_qd(&self, (): &(), _: &Position<T>, _: &[T; 5]) -> [T; 5] {
        [T::constant(0.0); 5]
    }
    fn gamma(&self, (): &(), p: &Position<T>, qd: &[T; 5]) -> [T; 5] {
        let [l1, l2, l3, _, l5] = self.lengths;
        let [w1, w2, w3] = [qd[2] * qd[2], qd[3] * qd[3], qd[4] * qd[4]];
        [
            -(l1 * p.c[0] * w1 + l5 * p.c[3] * w2),
            -(l1 * p.s[0] * w1 + l5 * p.s[3] * w2),
            -(l1 * p.c[0] * w1 + l2 * p.c[1] * w2 - l3 * p.c[2] * w3),
            l1 * p.s[0] * w1 + l2 * p.s[1] * w2 - l3 * p.s[2] * w3,
            T::constant(0.0),
        ]
    }
    fn branches(&self, (): &(), p: &Position<T>) -> [T; B] {
        [self.side * (p.s[2] * p.c[1] - p.c[2] * p.s[1]); B]
    }
    fn limits(&self, (): &(), _: &Position<T>) -> [Limit<T>; 0] {
        []
    }
    fn outputs(&self, (): &(), p: &Position<T>, qd: &[T; 5], qdd: &[T; 5]) -> [OutputValue<T>; 1] {
        [OutputValue {
            value: p.q[4] - p.q[3],
            rate: Some(qd[4] - qd[3]),
            acceleration: Some(qdd[4] - qdd[3]),
        }]
    }
}

/// The dyad's inverse, and columns φ1 and φ2 of the explicit rows.
#[derive(Clone, Copy)]
pub struct Factors<T> {
    dyad: Direct2<T>,
    crank: [T; 4],
    coupler: [T; 2],
}

impl<T: Scalar, const B: usize> Kinematic<T, 5> for FourBar<T, B> {
    type Factors = Factors<T>;
    type GroupNumber = <T::Real as mbs_runtime::Real>::Register;
    type Group = FourBar<Self::GroupNumber, B>;

    fn group(&self, first: usize) -> Self::Group {
        FourBar {
            lengths: self.lengths.map(|length| length.part(first)),
            alpha: self.alpha.part(first),
            omega: self.omega.part(first),
            side: self.side.part(first),
        }
    }

    fn solve_blocks<S: BlockSolver<T>>(
        &self,
        (): &(),
        q: &mut [T; 5],
        t: T,
        solver: &mut S,
    ) -> T::Lanes<Outcome> {
        q[2] = self.omega * t;
        let ([s1], [c1]) = T::sin_cos([q[2]]);
        let (x, outcome) = solver.solve::<2, Direct2<T>>(&self.block(), [q[3], q[4]], |x| {
            EVALUATIONS.set(EVALUATIONS.get() + 1);
            let ([s2, s3], [c2, c3]) = T::sin_cos(*x);
            (self.closure([c1, c2, c3], [s1, s2, s3]), self.dyad([c1, c2, c3], [s1, s2, s3]))
        });
        [q[3], q[4]] = x;
        let ([s4], [c4]) = T::sin_cos([q[3] + self.alpha]);
        let [l1, .., l5] = self.lengths;
        q[0] = l1 * c1 + l5 * c4;
        q[1] = l1 * s1 + l5 * s4;
        first_failure::<T>(T::per_lane(|_| Outcome::Converged), outcome)
    }

    fn factorize(&self, (): &(), p: &Position<T>) -> (Factors<T>, Margin<T>) {
        let [l1, .., l5] = self.lengths;
        let dyad = self.dyad([p.c[0], p.c[1], p.c[2]], [p.s[0], p.s[1], p.s[2]]);
        let (dyad, margin) = Direct2::factorize(&dyad, &[self.reference_length(); 2], &[T::constant(1.0); 2]);
        let crank = [l1 * p.s[0], -l1 * p.c[0], l1 * p.s[0], l1 * p.c[0]];
        (
            Factors { dyad, crank, coupler: [l5 * p.s[3], -l5 * p.c[3]] },
            Margin::regular().with_block(margin, 2, 3).oriented(dyad.reverses()),
        )
    }

    fn solve_linear(&self, f: &Factors<T>, b: &[T; 5]) -> [T; 5] {
        let x1 = b[4];
        let [x2, x3] = f.dyad.solve(&[b[2] - f.crank[2] * x1, b[3] - f.crank[3] * x1]);
        let x = b[0] - f.crank[0] * x1 - f.coupler[0] * x2;
        let y = b[1] - f.crank[1] * x1 - f.coupler[1] * x2;
        [x, y, x1, x2, x3]
    }
}
