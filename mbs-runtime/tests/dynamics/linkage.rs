//! Rods between points in natural coordinates, written by hand: what the macro would emit, without the macro.

use mbs_runtime::__private::accelerations;
use mbs_runtime::dynamics::Transformed;
use mbs_runtime::{
    Block, BlockSolver, Direct1, Dynamic, DynamicState, Energy, Entry, Factorization, Limit, Margin,
    Mechanism, Outcome, OutputValue, Partitioned, Phase, StateSlope,
};

/// One end of a rod.
#[derive(Clone, Copy, Debug)]
pub enum End {
    /// On the ground, which moves along x by `Linkage::shake`.
    Ground([f64; 2]),
    /// A point with two coordinates.
    Point(usize),
}

/// A uniform rod of constant length: one row d·d = L².
#[derive(Clone, Copy, Debug)]
pub struct Rod {
    pub from: End,
    pub to: End,
    pub length: f64,
    pub mass: f64,
}

/// Points, N coordinates, and rods, M rows.
#[derive(Clone, Copy, Debug)]
pub struct Linkage<const N: usize, const M: usize> {
    pub rods: [Rod; M],
    /// Mass at the point that a coordinate belongs to: N.
    pub masses: [f64; N],
    pub gravity: [f64; 2],
    /// Viscous force −d q̇ on each coordinate.
    pub damping: f64,
    /// Amplitude (m) and frequency (rad/s) of the ground's motion along x.
    pub shake: [f64; 2],
    /// A force on the first coordinate, set from outside.
    pub push: f64,
}

const LENGTH: Entry = Entry { name: "x", unit: "m", line: 10 };
const ROW: Entry = Entry { name: "rod", unit: "m^2", line: 20 };
const PUSH: Entry = Entry { name: "push", unit: "N", line: 5 };

/// Ground offset, velocity, acceleration along x.
type Shake = [f64; 3];

impl<const N: usize, const M: usize> Linkage<N, M> {
    pub fn new(rods: [Rod; M], masses: [f64; N], gravity: [f64; 2]) -> Self {
        Linkage { rods, masses, gravity, damping: 0.0, shake: [0.0; 2], push: 0.0 }
    }

    /// The same with lengths in a unit that a metre has `unit` of.
    pub fn in_unit(mut self, unit: f64) -> Self {
        self.gravity = self.gravity.map(|g| g * unit);
        for rod in &mut self.rods {
            rod.length *= unit;
            for end in [&mut rod.from, &mut rod.to] {
                if let End::Ground(place) = end {
                    *place = place.map(|x| x * unit);
                }
            }
        }
        self
    }

    fn end(end: End, q: &[f64; N], shake: f64) -> [f64; 2] {
        match end {
            End::Ground([x, y]) => [x + shake, y],
            End::Point(i) => [q[2 * i], q[2 * i + 1]],
        }
    }

    fn difference(rod: &Rod, q: &[f64; N], shake: f64) -> [f64; 2] {
        let (from, to) = (Self::end(rod.from, q, shake), Self::end(rod.to, q, shake));
        [to[0] - from[0], to[1] - from[1]]
    }

    /// Derivative of a rod's end by coordinate `j`, in the direction of that coordinate: 1 or 0.
    fn share(end: End, j: usize) -> f64 {
        if matches!(end, End::Point(i) if i == j / 2) { 1.0 } else { 0.0 }
    }

    /// Velocity of the difference of both ends.
    fn rate(rod: &Rod, qd: &[f64; N], shake: f64) -> [f64; 2] {
        let moving = |end: End| match end {
            End::Ground(_) => [shake, 0.0],
            End::Point(i) => [qd[2 * i], qd[2 * i + 1]],
        };
        let (from, to) = (moving(rod.from), moving(rod.to));
        [to[0] - from[0], to[1] - from[1]]
    }
}

/// A Jacobian without structural zeros, row by row.
#[derive(Clone, Copy)]
pub struct Rows<const N: usize, const M: usize>([[f64; N]; M]);

impl<const N: usize, const M: usize> Rows<N, M> {
    const PLACES: [[(u16, u16); N]; M] = {
        let mut places = [[(0, 0); N]; M];
        let mut index = 0;
        while index < N * M {
            places[index / N][index % N] = ((index / N) as u16, (index % N) as u16);
            index += 1;
        }
        places
    };
}

impl<const N: usize, const M: usize> AsRef<[f64]> for Rows<N, M> {
    fn as_ref(&self) -> &[f64] {
        self.0.as_flattened()
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl<const N: usize, const M: usize> Mechanism<f64, N, M> for Linkage<N, M> {
    type Parameters = ();
    type Position = ([f64; N], Shake);
    type Entries = Rows<N, M>;
    type Branches = [f64; 0];
    type Limits = [Limit<f64>; 0];
    type Phases = [Phase<f64>; 0];
    type Values = [f64; 1];
    type Kept = [f64; 1];
    type Outputs = [OutputValue<f64>; 0];
    type Lane = Self;

    const NAME: &'static str = "Linkage";
    const SOURCE: &'static str = "";
    const COORDINATES: &'static [Entry] = &[LENGTH; N];
    const ROWS: &'static [Entry] = &[ROW; M];
    const SPARSITY: &'static [(u16, u16)] = Rows::<N, M>::PLACES.as_flattened();
    const VARIABLES: &'static [Entry] = &[PUSH];
    const BRANCHES: &'static [Entry] = &[];
    const OUTPUTS: &'static [Entry] = &[];

    fn get(&self, index: usize) -> Option<f64> {
        (index == 0).then_some(self.push)
    }
    fn set(&mut self, index: usize, value: f64) -> bool {
        self.push = if index == 0 { value } else { self.push };
        index == 0
    }
    fn values(&self) -> [f64; 1] {
        [self.push]
    }
    fn phases(&self) -> [Phase<f64>; 0] {
        []
    }
    fn set_phases(&mut self, _: [Phase<f64>; 0]) {}
    fn lane(&self, _: usize) -> Self {
        *self
    }
    fn parameters(&self) {}
    fn guess(&self, _: &()) -> [f64; N] {
        [0.0; N]
    }
    fn coordinate_scales(&self, _: &()) -> [f64; N] {
        [self.rods.iter().map(|rod| rod.length).fold(0.0, f64::max); N]
    }
    fn row_scales(&self, _: &()) -> [f64; M] {
        [self.rods.iter().map(|rod| rod.length * rod.length).fold(0.0, f64::max); M]
    }
    fn position(&self, _: &(), q: &[f64; N], t: f64) -> Self::Position {
        let [amplitude, frequency] = self.shake;
        let (sine, cosine) = (frequency * t).sin_cos();
        let offset = amplitude * sine;
        (*q, [offset, amplitude * frequency * cosine, -frequency * frequency * offset])
    }
    fn phi(&self, _: &(), (q, [shake, ..]): &Self::Position) -> [f64; M] {
        self.rods.map(|rod| {
            let d = Self::difference(&rod, q, *shake);
            dot(d, d) - rod.length * rod.length
        })
    }
    fn phi_q(&self, _: &(), (q, [shake, ..]): &Self::Position) -> [[f64; N]; M] {
        self.rods.map(|rod| {
            let d = Self::difference(&rod, q, *shake);
            std::array::from_fn(|j| 2.0 * d[j % 2] * (Self::share(rod.to, j) - Self::share(rod.from, j)))
        })
    }
    fn phi_q_entries(&self, parameters: &(), position: &Self::Position) -> Rows<N, M> {
        Rows(self.phi_q(parameters, position))
    }
    fn phi_t(&self, _: &(), (q, [shake, rate, _]): &Self::Position) -> [f64; M] {
        self.rods.map(|rod| 2.0 * dot(Self::difference(&rod, q, *shake), Self::rate(&rod, &[0.0; N], *rate)))
    }
    fn phi_tt(&self, _: &(), (q, [shake, rate, second]): &Self::Position) -> [f64; M] {
        self.rods.map(|rod| {
            let v = Self::rate(&rod, &[0.0; N], *rate);
            let a = Self::rate(&rod, &[0.0; N], *second);
            2.0 * dot(v, v) + 2.0 * dot(Self::difference(&rod, q, *shake), a)
        })
    }
    fn phi_qt_qd(&self, _: &(), (_, [_, rate, _]): &Self::Position, qd: &[f64; N]) -> [f64; M] {
        self.rods.map(|rod| 2.0 * dot(Self::rate(&rod, qd, 0.0), Self::rate(&rod, &[0.0; N], *rate)))
    }
    fn gamma(&self, _: &(), (q, [shake, rate, second]): &Self::Position, qd: &[f64; N]) -> [f64; M] {
        self.rods.map(|rod| {
            let v = Self::rate(&rod, qd, *rate);
            let a = Self::rate(&rod, &[0.0; N], *second);
            -2.0 * dot(v, v) - 2.0 * dot(Self::difference(&rod, q, *shake), a)
        })
    }
    fn branches(&self, _: &(), _: &Self::Position) -> [f64; 0] {
        []
    }
    fn limits(&self, _: &(), _: &Self::Position) -> [Limit<f64>; 0] {
        []
    }
    fn outputs(&self, _: &(), _: &Self::Position, _: &[f64; N], _: &[f64; N]) -> [OutputValue<f64>; 0] {
        []
    }
}

/// Of a pendulum with x as its independent coordinate: a turning point at either end of a wide swing. Others have no blocks.
impl<const N: usize, const M: usize> Partitioned<f64, N, M> for Linkage<N, M> {
    type Partition = (Direct1<f64>, f64);

    const IS_PARTITIONED: bool = N == 2 && M == 1;
    const INDEPENDENT: &'static [u16] = if N == 2 && M == 1 { &[0] } else { &[] };

    fn solve_dependent<S: BlockSolver<f64>>(
        &self,
        _: &(),
        q: &mut [f64; N],
        _: f64,
        solver: &mut S,
    ) -> [Outcome; 1] {
        let block = Block {
            rows: [0],
            coordinates: [1],
            angles: [false],
            row_scales: [1.0],
            coordinate_scales: [1.0],
        };
        let x = q[0];
        let ([y], outcome) =
            solver.solve::<1, Direct1<f64>>(&block, [q[1]], |[y]| ([x * x + y * y - 1.0], [[2.0 * y]]));
        q[1] = y;
        outcome
    }

    fn partition(&self, _: &(), position: &Self::Position) -> (Self::Partition, Margin<f64>) {
        let row = self.phi_q(&(), position)[0];
        let (factors, margin) = Direct1::factorize(&[[row[1]]], &[1.0], &[1.0]);
        ((factors, row[0]), Margin::regular().with_block(margin, 0, 1))
    }

    fn complete(&self, (factors, independent): &Self::Partition, b: &[f64; M], x: &mut [f64; N]) {
        [x[1]] = factors.solve(&[b[0] - independent * x[0]]);
    }

    fn reduce(&self, (factors, independent): &Self::Partition, y: &mut [f64; N]) -> [f64; M] {
        let [lambda] = factors.solve(&[y[1]]);
        y[0] -= independent * lambda;
        [lambda; M]
    }

    fn accelerations(
        &self,
        parameters: &<Self as Mechanism<f64, N, M>>::Parameters,
        position: &<Self as Mechanism<f64, N, M>>::Position,
        partition: &<Self as Partitioned<f64, N, M>>::Partition,
        force: &[f64; N],
        gamma: &[f64; M],
    ) -> Transformed<f64, N, M> {
        accelerations::<Self, f64, N, M, 1>(self, parameters, position, partition, force, gamma)
    }
}

impl<const N: usize, const M: usize> Dynamic<f64, N, M> for Linkage<N, M> {
    type States = [f64; 0];
    type StateSlopes = [StateSlope<f64, N, [f64; 0]>; 0];
    type Powers = [f64; 2];
    type Loads = [f64; 0];

    const FORCE_USES_MULTIPLIERS: bool = false;
    const STATES: &'static [Entry] = &[];
    const FORCES: &'static [Entry] = &[PUSH, PUSH];
    const LOADS: &'static [Entry] = &[];

    fn start_states(&self, _: &()) -> [f64; 0] {
        []
    }
    fn start_rates(&self, _: &()) -> [f64; N] {
        [0.0; N]
    }
    fn mass(&self, _: &(), _: &Self::Position) -> [[f64; N]; N] {
        let mut mass = [[0.0; N]; N];
        for (j, row) in mass.iter_mut().enumerate() {
            row[j] = self.masses[j];
        }
        for rod in &self.rods {
            for (one, other, share) in [
                (rod.from, rod.from, 3.0),
                (rod.to, rod.to, 3.0),
                (rod.from, rod.to, 6.0),
                (rod.to, rod.from, 6.0),
            ] {
                if let (End::Point(one), End::Point(other)) = (one, other) {
                    mass[2 * one][2 * other] += rod.mass / share;
                    mass[2 * one + 1][2 * other + 1] += rod.mass / share;
                }
            }
        }
        mass
    }
    fn mass_times(&self, parameters: &(), position: &Self::Position, x: &[f64; N]) -> [f64; N] {
        self.mass(parameters, position).map(|row| row.iter().zip(x).map(|(m, x)| m * x).sum())
    }
    fn force(&self, _: &(), _: &Self::Position, qd: &[f64; N], _: &[f64; 0], _: &[f64; M]) -> [f64; N] {
        let mut force: [f64; N] =
            std::array::from_fn(|j| self.masses[j] * self.gravity[j % 2] - self.damping * qd[j]);
        for rod in &self.rods {
            for end in [rod.from, rod.to] {
                if let End::Point(i) = end {
                    force[2 * i] += rod.mass / 2.0 * self.gravity[0];
                    force[2 * i + 1] += rod.mass / 2.0 * self.gravity[1];
                }
            }
        }
        force[0] += self.push;
        force
    }
    fn force_q(&self, _: &(), _: &Self::Position, _: &[f64; N], _: &[f64; 0], _: &[f64; M]) -> [[f64; N]; N] {
        [[0.0; N]; N]
    }
    fn force_qd(
        &self,
        _: &(),
        _: &Self::Position,
        _: &[f64; N],
        _: &[f64; 0],
        _: &[f64; M],
    ) -> [[f64; N]; N] {
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { -self.damping } else { 0.0 }))
    }
    fn mass_times_q(&self, _: &(), _: &Self::Position, _: &[f64; N]) -> [[f64; N]; N] {
        [[0.0; N]; N]
    }
    fn reaction(&self, parameters: &(), position: &Self::Position, lambda: &[f64; M]) -> [f64; N] {
        let phi_q = self.phi_q(parameters, position);
        std::array::from_fn(|j| phi_q.iter().zip(lambda).map(|(row, lambda)| row[j] * lambda).sum())
    }
    fn reaction_q(&self, _: &(), _: &Self::Position, lambda: &[f64; M]) -> [[f64; N]; N] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let share = |rod: &Rod, j: usize| Self::share(rod.to, j) - Self::share(rod.from, j);
                let pairs = self.rods.iter().zip(lambda);
                let sum = pairs.map(|(rod, lambda)| 2.0 * lambda * share(rod, i) * share(rod, j)).sum();
                if i % 2 == j % 2 { sum } else { 0.0 }
            })
        })
    }
    fn third_derivative(
        &self,
        parameters: &(),
        position: &Self::Position,
        qd: &[f64; N],
        lambda: &[f64; M],
    ) -> Option<([f64; N], f64)> {
        let (_, [_, rate, second]) = position;
        let rates = self.reaction_q(parameters, position, lambda);
        let row = rates.map(|row| row.iter().zip(qd).map(|(entry, qd)| entry * qd).sum());
        // Rows are quadratic; the third derivative of a moving ground is not known.
        (*rate == 0.0 && *second == 0.0).then_some((row, 0.0))
    }
    fn energy(&self, parameters: &(), position: &Self::Position, qd: &[f64; N]) -> Energy<f64> {
        let q = &position.0;
        let momentum = self.mass_times(parameters, position, qd);
        let kinetic = 0.5 * momentum.iter().zip(qd).map(|(p, qd)| p * qd).sum::<f64>();
        let still = Linkage { push: 0.0, ..*self };
        let weight = still.force(parameters, position, &[0.0; N], &[], &[0.0; M]);
        let potential = -weight.iter().zip(q).map(|(force, q)| force * q).sum::<f64>();
        Energy { kinetic, potential }
    }
    fn powers(&self, _: &(), _: &Self::Position, qd: &[f64; N], _: &[f64; 0], _: &[f64; M]) -> [f64; 2] {
        [self.push * qd[0], -self.damping * qd.iter().map(|qd| qd * qd).sum::<f64>()]
    }
    fn state_rates(&self, _: &(), _: &Self::Position, _: &[f64; N], _: &[f64; 0], _: &[f64; M]) -> [f64; 0] {
        []
    }
    fn loads(&self, _: &(), _: &Self::Position, _: &DynamicState<'_, f64, N, M, [f64; 0]>) -> [f64; 0] {
        []
    }
}

/// A point mass of 1 kg on a massless rod of 1 m.
pub fn pendulum() -> Linkage<2, 1> {
    let rod = Rod { from: End::Ground([0.0; 2]), to: End::Point(0), length: 1.0, mass: 0.0 };
    Linkage::new([rod], [1.0; 2], [0.0, -9.81])
}

/// `count` loops of uniform rods of 1 m and 1 kg side by side, upright, the frame turned by `angle` (rad): uprights
/// first, then the bars between their heads, then the first `M` − (2 `count` + 1) uprights once more without mass.
/// Returns the linkage, positions and velocities with the heads moving at `speed` (m/s) to the right.
pub fn parallel_loops<const N: usize, const M: usize>(
    angle: f64,
    speed: f64,
) -> (Linkage<N, M>, [f64; N], [f64; N]) {
    let uprights = N / 2;
    let (sine, cosine) = angle.sin_cos();
    let turned = |x: f64, y: f64| [cosine * x - sine * y, sine * x + cosine * y];
    let upright = |i: usize, mass: f64| Rod {
        from: End::Ground(turned(i as f64, 0.0)),
        to: End::Point(i),
        length: 1.0,
        mass,
    };
    let rods = std::array::from_fn(|row| {
        if row < uprights {
            upright(row, 1.0)
        } else if row < 2 * uprights - 1 {
            let i = row - uprights;
            Rod { from: End::Point(i), to: End::Point(i + 1), length: 1.0, mass: 1.0 }
        } else {
            upright(row - (2 * uprights - 1), 0.0)
        }
    });
    let q = std::array::from_fn(|j| turned((j / 2) as f64, 1.0)[j % 2]);
    let qd = std::array::from_fn(|j| turned(speed, 0.0)[j % 2]);
    (Linkage::new(rods, [0.0; N], turned(0.0, -9.81)), q, qd)
}
