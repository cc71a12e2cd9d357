//! A four-bar linkage: text, assembly, one turn of the crank. The README shows this program.

use mbs_runtime::{Mechanism, Stepper, mechanism};

mechanism! {
    /// A crank turns at constant speed, a rocker swings.
    pub mechanism FourBar;
    param crank: m = 100mm;
    param coupler: m = 250mm;
    param rocker: m = 200mm;
    param omega: rad/s = 60rpm;
    coord phi1: rad = 0;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { crank*unit(phi1) + coupler*unit(phi2) == [300mm, 0] + rocker*unit(phi3); }
    drive motor: phi1 == omega*t;
    branch open: sin(phi3 - phi2) > 0;
    out swing: rad = phi3;
}

fn main() -> Result<(), mbs_runtime::Failure> {
    let four_bar = FourBar { crank: 0.09, ..FourBar::default() };
    // `parameters`: what is computed once from the fields, and needed at every instant.
    let guess = four_bar.guess(&four_bar.parameters());
    let mut motion = Stepper::assemble(four_bar, guess, 0.0)?;
    println!("time      rocker      speed         acceleration");
    for _ in 0..5 {
        let [swing] = motion.outputs();
        let [rate, acceleration] = [swing.rate, swing.acceleration].map(|x| x.unwrap_or(f64::NAN));
        println!("{:.2} s  {:.4} rad  {rate:7.4} rad/s  {acceleration:8.3} rad/s²", motion.t(), swing.value);
        motion.advance(0.2)?;
    }
    Ok(())
}
