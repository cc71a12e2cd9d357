//! Eight designs at once in lanes: the length of a crank for a rocker that swings by 50°.

use mbs_runtime::{Batch, Lanes, mechanism};

mechanism! {
    /// A four-bar whose crank is to be chosen.
    pub mechanism Chosen;
    param crank: m = 0.1;
    coord phi1: rad;
    coord phi2: rad = 0.9;
    coord phi3: rad = 1.8;
    constraint closure { crank*unit(phi1) + 0.25m*unit(phi2) == [0.3m, 0] + 0.2m*unit(phi3); }
    drive motor: phi1 == TAU*t/1s;
    branch open: sin(phi3 - phi2) > 0;
}

fn main() {
    let cranks = Lanes([0.05, 0.06, 0.07, 0.08, 0.1, 0.12, 0.14, 0.18]);
    let designs = Chosen { crank: cranks };
    let batch = Batch::assemble_each(designs, &[[0.0, 0.9, 1.8]; 8], [0.0; 8]);
    let mut batch = batch.expect("one of them can be assembled");
    let mut swing = [(f64::INFINITY, f64::NEG_INFINITY); 8];
    for k in 1..=720 {
        for (lane, step) in batch.advance_to([f64::from(k) / 720.0; 8]).into_iter().enumerate() {
            if let Err(failure) = step {
                batch.retire(lane, failure);
            }
        }
        for ((low, high), angle) in swing.iter_mut().zip(batch.q()[2].0) {
            (*low, *high) = (low.min(angle), high.max(angle));
        }
    }
    println!("crank     swing of the rocker");
    for ((crank, (low, high)), failure) in cranks.0.iter().zip(swing).zip(batch.failures()) {
        match failure {
            None => println!("{crank:.2} m  {:6.2}°", (high - low).to_degrees()),
            Some(failure) => println!("{crank:.2} m  does not turn around: {failure}"),
        }
    }
}
