//! Bounds of a closed curve and its derivatives over a part of a turn.

use core::f64::consts::TAU;

use crate::mechanism::function::Function;
use crate::scalar::interval::Interval;
use crate::scalar::number::Scalar;

/// Largest number of halvings of a turn: 6e-12 rad.
pub(super) const FINEST: u32 = 40;

/// Places for parts that wait while one is divided: three of each halving.
const WAITING: usize = 3 * FINEST as usize + 4;

/// A part of a turn: number `index` of 2^`level` equal ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    pub index: u64,
    pub level: u32,
}

impl Cell {
    /// The whole turn.
    pub const TURN: Cell = Cell { index: 0, level: 0 };

    /// Number of cells of its level in a turn.
    pub fn count(self) -> u64 {
        1 << self.level.min(FINEST)
    }

    /// The angle (rad) at which the cell of this number begins. The same bits at every level.
    pub fn border(self, index: u64) -> f64 {
        TAU * index as f64 / self.count() as f64
    }

    pub fn ends(self) -> [f64; 2] {
        [self.border(self.index), self.border(self.index.saturating_add(1))]
    }

    pub fn middle(self) -> f64 {
        let [from, to] = self.ends();
        0.5 * (from + to)
    }

    pub fn halves(self) -> [Cell; 2] {
        let (index, level) = (self.index.saturating_mul(2), self.level.saturating_add(1));
        [Cell { index, level }, Cell { index: index.saturating_add(1), level }]
    }
}

/// Bounds of a curve over a part of a turn.
pub trait CurvePart: Copy {
    /// Largest magnitude of a coordinate.
    fn largest(&self) -> f64;

    /// Largest magnitude of the derivative of a place, for widths of rounding.
    fn fastest(&self) -> f64;

    /// `true` if the way has a direction everywhere; of a polar curve, if the radius is above zero.
    fn is_regular(&self) -> bool;

    /// Places.
    fn points(&self) -> [Interval<f64>; 2];

    /// Derivatives of the place: tangents, as long as the arc over the parameter.
    fn tangents(&self) -> [Interval<f64>; 2];

    /// Turn of the tangent over that of the parameter.
    fn turning(&self) -> Interval<f64>;

    /// Square of the tangents' length.
    fn squares(&self) -> Interval<f64>;

    /// Lengths of the parameter.
    fn width(&self) -> f64;

    /// The squared distance of a point, half its first and half its second derivative.
    fn beside(&self, point: [f64; 2]) -> [Interval<f64>; 3];

    /// Curvature, positive where convex.
    fn curvature(&self) -> Interval<f64> {
        self.turning() / self.squares().sqrt()
    }

    /// Largest angle by which the tangent turns.
    fn most_turned(&self) -> f64 {
        self.turning().abs().high() * self.width()
    }

    /// `true` if all tangents are within a quarter of a turn of each other: no normal meets the part a second time at a right angle.
    fn is_nearly_straight(&self) -> bool {
        /// A quarter of a turn less its rounding.
        const QUARTER: f64 = core::f64::consts::FRAC_PI_2 * (1.0 - 1e-9);
        self.is_regular() && self.most_turned() < QUARTER
    }
}

/// Polar radius and its derivatives over a part of a turn.
#[derive(Clone, Copy, Debug)]
pub struct CurveBounds {
    angles: [f64; 2],
    radius: Interval<f64>,
    slope: Interval<f64>,
    bend: Interval<f64>,
}

impl CurveBounds {
    /// `None` where the function has no bounds.
    pub(super) fn of<T: Scalar, F: Function<T>>(function: &F, angles: [f64; 2]) -> Option<Self> {
        let [from, to] = angles;
        let [radius, slope, bend] = function.enclosure::<3>(from, to)?;
        Some(CurveBounds { angles, radius, slope, bend })
    }

    /// Direction from the centre, and a quarter of a turn ahead of it.
    fn frame(&self) -> [[Interval<f64>; 2]; 2] {
        let [from, to] = self.angles;
        let ([sine], [cosine]) = Scalar::sin_cos([Interval::between(from, to)]);
        [[cosine, sine], [-sine, cosine]]
    }
}

impl CurvePart for CurveBounds {
    fn largest(&self) -> f64 {
        self.radius.high().max(-self.radius.low())
    }

    fn fastest(&self) -> f64 {
        self.largest()
    }

    fn is_regular(&self) -> bool {
        self.radius.low() > 0.0
    }

    fn points(&self) -> [Interval<f64>; 2] {
        let [along, _] = self.frame();
        along.map(|part| part * self.radius)
    }

    fn tangents(&self) -> [Interval<f64>; 2] {
        let [[a, b], [c, d]] = self.frame();
        [a * self.slope + c * self.radius, b * self.slope + d * self.radius]
    }

    fn turning(&self) -> Interval<f64> {
        let bent = squared(self.slope) - self.radius * self.bend;
        Interval::of(1.0) + bent / self.squares()
    }

    fn squares(&self) -> Interval<f64> {
        squared(self.radius) + squared(self.slope)
    }

    fn width(&self) -> f64 {
        let [from, to] = self.angles;
        to - from
    }

    fn beside(&self, [x, y]: [f64; 2]) -> [Interval<f64>; 3] {
        let point = [x, y].map(Interval::of);
        let [along, across] = self.frame().map(|[a, b]| a * point[0] + b * point[1]);
        let off = along - self.radius;
        let falling = off * self.slope + across * self.radius;
        let twice = across * self.slope * Interval::of(2.0);
        let curved = squared(self.slope) + squared(self.radius) - off * (self.bend - self.radius) - twice;
        [squared(off) + squared(across), falling, curved]
    }
}

/// Two components and their derivatives over a part of the parameter.
#[derive(Clone, Copy, Debug)]
pub struct ParametricBounds {
    width: f64,
    /// Place, first and second derivative.
    x: [Interval<f64>; 3],
    y: [Interval<f64>; 3],
}

impl ParametricBounds {
    /// `None` where a function has no bounds.
    pub(super) fn of<T: Scalar, X: Function<T>, Y: Function<T>>(
        x: &X,
        y: &Y,
        [from, to]: [f64; 2],
    ) -> Option<Self> {
        Some(ParametricBounds { width: to - from, x: x.enclosure(from, to)?, y: y.enclosure(from, to)? })
    }
}

impl CurvePart for ParametricBounds {
    fn largest(&self) -> f64 {
        let [[x, ..], [y, ..]] = [self.x, self.y];
        x.abs().high().max(y.abs().high())
    }

    fn fastest(&self) -> f64 {
        let [[_, u, _], [_, v, _]] = [self.x, self.y];
        u.abs().high() + v.abs().high()
    }

    fn is_regular(&self) -> bool {
        self.squares().low() > 0.0
    }

    fn points(&self) -> [Interval<f64>; 2] {
        let [[x, ..], [y, ..]] = [self.x, self.y];
        [x, y]
    }

    fn tangents(&self) -> [Interval<f64>; 2] {
        let [[_, u, _], [_, v, _]] = [self.x, self.y];
        [u, v]
    }

    fn turning(&self) -> Interval<f64> {
        let [[_, u, bend_x], [_, v, bend_y]] = [self.x, self.y];
        (u * bend_y - v * bend_x) / self.squares()
    }

    fn squares(&self) -> Interval<f64> {
        let [u, v] = self.tangents();
        squared(u) + squared(v)
    }

    fn width(&self) -> f64 {
        self.width
    }

    fn beside(&self, point: [f64; 2]) -> [Interval<f64>; 3] {
        let [[x, u, bend_x], [y, v, bend_y]] = [self.x, self.y];
        let [off, beside] = [Interval::of(point[0]) - x, Interval::of(point[1]) - y];
        let curved = self.squares() - off * bend_x - beside * bend_y;
        [squared(off) + squared(beside), off * u + beside * v, curved]
    }
}

/// Parts that wait to be looked at: the last one first.
pub(super) struct Waiting<X> {
    parts: [Option<X>; WAITING],
    count: usize,
}

impl<X: Copy> Waiting<X> {
    pub fn from(part: X) -> Self {
        let mut parts = [None; WAITING];
        if let Some(place) = parts.first_mut() {
            *place = Some(part);
        }
        Waiting { parts, count: 1 }
    }

    /// `false` where there is no place; none is lost silently.
    pub fn add<const N: usize>(&mut self, parts: [X; N]) -> bool {
        parts.into_iter().all(|part| {
            let place = self.parts.get_mut(self.count);
            self.count = self.count.saturating_add(1);
            place.map(|place| *place = Some(part)).is_some()
        })
    }

    pub fn next(&mut self) -> Option<X> {
        self.count = self.count.checked_sub(1)?;
        self.parts.get_mut(self.count)?.take()
    }
}

/// The square, which is not negative.
pub(super) fn squared(value: Interval<f64>) -> Interval<f64> {
    let size = value.abs();
    size * size
}
