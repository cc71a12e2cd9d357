#![deny(warnings)]
use mbs_runtime::{Mechanism, mechanism};

mechanism! {
    pub mechanism Torn;
    coord r: [m; 2] = [0.1, 0];
    coord phi: rad = 0.1;
    body c { mass: 1, com: r, inertia: 0.1, angle: phi }
    constraint reach { dot(r, r) == 100mm*100mm; r[0]^2 + r[1]^2 == 1m*1m; }
    pin knee: ground, c at [0, 0];
    out force: [N; 2] = reaction(knee, c);
}

fn main() {
    let torn: Torn = Torn::default();
    println!("{:?}", torn.guess(&torn.parameters()));
}
