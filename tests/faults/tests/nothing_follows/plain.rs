use mbs_runtime::{Failure, Kinematic, Mechanism, Stepper};
pub struct Machine { motion: Stepper<FourBar, f64, 5>, design: FourBar<f64> }
impl FourBar { pub fn longest(&self) -> f64 { self.L[0].max(self.L[1]).max(self.rocker) } }
impl core::fmt::Display for FourBar<f32> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result { write!(f, "{}", self.omega) }
}
impl From<FourBar> for [f64; 2] { fn from(bar: FourBar) -> Self { bar.L } }
fn build(rocker: f64) -> FourBar { FourBar { L: [0.1, 0.3], rocker, ..FourBar::default() } }
fn whole() -> FourBar { FourBar { L: [0.1, 0.3], rocker: 0.2, omega: 3.0 } }
fn generic<S: Kinematic<f64, N>, const N: usize>(s: S) -> Result<[f64; N], Failure> {
    let guess = s.guess(&s.parameters());
    Ok(*Stepper::assemble(s, guess, 0.0)?.q())
}
fn turn() -> Result<f64, Failure> {
    let mut bar = build(0.2);
    bar.omega *= 2.0;
    let FourBar { L: [first, _], rocker, .. } = bar;
    let mut motion = Stepper::assemble(bar, bar.guess(&bar.parameters()), 0.0)?;
    motion.advance(0.1)?;
    let [angle, x, y] = motion.outputs();
    let named = FourBarCoordinates::from(*motion.q());
    let FourBarCoordinates { phi1, p: [px, _], .. } = named;
    let array: [f64; 5] = FourBarCoordinates { phi1, phi2: 0.9, phi3: 1.8, p: [0.1, 0.1] }.into();
    let q = generic(bar)?;
    let machine = Machine { motion, design: bar };
    let names: Vec<&str> = <FourBar as Mechanism<f64, 5, 5>>::COORDINATES.iter().map(|c| c.name).collect();
    assert_eq!(machine.design, bar);
    Ok(angle.value + x.rate.unwrap_or(0.0) + y.value + named.p[1] + px + array[4] + q[0] + first + rocker)
}
